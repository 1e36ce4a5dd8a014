//! `[[body]]` of a scene file.

use super::{ModelSpec, MotionSpec, PoseSpec, SurfaceSpec};
use palpate_geometry::math::Point3;
use serde::{Deserialize, Serialize};

/// `[[body]]`: a body bounded by one B-spline surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BodySpec {
    /// Name of the body: 1 to 64 of a-z, 0-9, `_`, `-`.
    #[cfg_attr(test, schemars(regex(pattern = r"^[a-z0-9_-]{1,64}$")))]
    pub id: String,
    /// Where its surface comes from.
    pub surface: SurfaceSpec,
    /// Placement in the world.
    #[serde(default)]
    pub pose: PoseSpec,
    /// How it moves, and what moves it. When absent: `continuum` with a material, unless the body is free, moved or
    /// carried; else `rigid`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelSpec>,
    /// What it is made of; deforming models use it, and of a free rigid body its density.
    #[serde(default)]
    pub material: MaterialSpec,
    /// Parts of another material; of several that contain a cell the last counts.
    #[serde(default, rename = "region", skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionSpec>,
    /// How its nodes and cells are built.
    #[serde(default)]
    pub lattice: LatticeSpec,
    /// Time integration.
    #[serde(default)]
    pub integrator: IntegratorSpec,
    /// Nodes that never move.
    #[serde(default)]
    pub fixed: Vec<FixedSpec>,
    /// Velocity with which a body starts that nothing holds, deforming or free; in the world.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(test, schemars(extend("x-default" = "[0, 0, 0]")))]
    pub velocity_m_s: [f64; 3],
    /// Angular velocity about its centre of mass with which it starts; in the world, right-handed.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(test, schemars(extend("x-default" = "[0, 0, 0]")))]
    pub spin_rad_s: [f64; 3],
    /// Whether the body can touch itself.
    #[serde(default)]
    pub self_contact: bool,
    /// Of a rigid body with a closed surface: it has a mass, falls, turns, and contact moves it.
    #[serde(default, skip_serializing_if = "is_false")]
    #[cfg_attr(test, schemars(extend("x-default" = "false")))]
    pub free: bool,
    /// Of a rigid body: where it goes by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Of a rigid body: id of the tool whose device carries it. That tool does not touch it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carried_by: Option<String>,
}

impl BodySpec {
    /// How it moves, and what moves it.
    pub fn model(&self) -> ModelSpec {
        let goes_as_a_whole = self.free || self.motion.is_some() || self.carried_by.is_some();
        let is_solid = self.material != MaterialSpec::default() && !goes_as_a_whole;
        let default = if is_solid {
            ModelSpec::Continuum
        } else {
            ModelSpec::Rigid
        };
        self.model.unwrap_or(default)
    }

    /// How many layers its cells have. A 10 mm ball on the teardrop, 1 to 4 mm deep, has with two, three and four layers
    /// of `refine = "auto"` +4, −3 and +5 % of force too much (`continuum`), −24, −6 and +6 (`lattice`), −5, −1 and −3 (`net`).
    pub fn layers(&self) -> usize {
        self.lattice.layers.unwrap_or(3)
    }
}

/// `[body.material]`: a preset, and what differs from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MaterialSpec {
    /// Name of a material to start from; `gel` when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("enum" = crate::body::PRESETS.map(|preset| preset.name))))]
    pub preset: Option<String>,
    /// Young's modulus E; that of the preset when absent.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young_pa: Option<f64>,
    /// Poisson's ratio ν; that of the preset when absent. A lattice of springs has 1/4 and a membrane 1/3 whatever
    /// it says.
    #[cfg_attr(test, schemars(range(min = 0, max = 0.499)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// Density; that of the preset when absent.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
    /// Stiffness-proportional (Voigt) damping time: a strain rate ε̇ adds the stress of a strain
    /// of this times ε̇. That of the preset when absent.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_s: Option<f64>,
    /// Plastic flow of springs or cells; that of the preset when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plastic: Option<PlasticSpec>,
    /// Stiffening of springs with strain; that of the preset when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffening: Option<StiffeningSpec>,
    /// How the stiffness of springs follows from E; `moduli` when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub springs: Option<SpringsSpec>,
}

/// `plastic = { yield_strain = 0.02, rate_per_s = 20.0 }`: springs or cells that keep a part of their strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlasticSpec {
    /// Strain up to which nothing flows: of a spring, or of a bar of the material that is drawn.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub yield_strain: f64,
    /// Share of the strain beyond yield that flows in a second; 0 for none.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub rate_per_s: f64,
    /// Growth of the yield strain per plastic strain so far.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(default)]
    pub hardening: f64,
    /// Largest plastic change of a length, relative to that at first.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1)))]
    #[serde(default = "plastic_limit")]
    pub limit: f64,
    /// Flow is shared with springs or cells within this distance.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(default)]
    pub spread_m: f64,
}

fn plastic_limit() -> f64 {
    0.6
}

/// `stiffening = { strain = 0.3, ratio = 5.0, least_length = 0.2 }`: springs that stiffen with strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct StiffeningSpec {
    /// Strain in extension from which springs are stiffer; `inf`: never.
    #[cfg_attr(test, schemars(range(min = 0), extend("x-default" = "inf")))]
    pub strain: f64,
    /// Stiffness there, relative to that at rest.
    #[cfg_attr(test, schemars(range(min = 1, max = 1_000)))]
    pub ratio: f64,
    /// Length below which coils touch, relative to the rest length.
    #[cfg_attr(test, schemars(range(min = 0), extend("exclusiveMaximum" = 1)))]
    pub least_length: f64,
    /// Stiffness there, relative to that at rest.
    #[cfg_attr(test, schemars(range(min = 1, max = 1_000)))]
    pub least_length_ratio: f64,
}

impl Default for StiffeningSpec {
    fn default() -> Self {
        Self {
            strain: f64::INFINITY,
            ratio: 1.0,
            least_length: 0.0,
            least_length_ratio: 10.0,
        }
    }
}

/// How the stiffness of springs follows from E.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum SpringsSpec {
    /// Such that the body as a whole has that modulus.
    #[default]
    Moduli,
    /// K = E A / L for each spring by itself; for comparison.
    Seed,
}

impl SpringsSpec {
    /// As scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Moduli => "moduli",
            Self::Seed => "seed",
        }
    }
}

/// `[[body.region]]`: cells of another material, by their centres, in the body's frame. Needs one of
/// `ball`, `box`; values that are absent are those of the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Cells within a ball.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ball: Option<BallSpec>,
    /// Cells within a box along the axes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub box_: Option<BoxSpec>,
    /// Young's modulus E.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub young_pa: Option<f64>,
    /// Poisson's ratio ν.
    #[cfg_attr(test, schemars(range(min = 0, max = 0.499)))]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// Density.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
}

impl RegionSpec {
    /// Whether a cell with this centre, in the body's frame, is of the region.
    pub(crate) fn holds(&self, centre: &Point3) -> bool {
        match (&self.ball, &self.box_) {
            (Some(ball), _) => (centre - Point3::from(ball.centre)).norm() <= ball.radius_m,
            (None, Some(bounds)) => {
                (0..3).all(|c| (bounds.low[c]..=bounds.high[c]).contains(&centre[c]))
            }
            (None, None) => false,
        }
    }
}

/// A ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// Its centre.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub centre: [f64; 3],
    /// Its radius.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub radius_m: f64,
}

/// A box along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Least corner; below `high` in x, y and z.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub low: [f64; 3],
    /// Greatest corner.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub high: [f64; 3],
}

/// `[body.lattice]`: nodes and cells of a deforming body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSpec {
    /// How nodes are placed inside the surface.
    pub builder: BuilderSpec,
    /// Of `transfinite` and `som`: nodes along each axis of the cube.
    #[cfg_attr(test, schemars(inner(range(min = 2, max = 128))))]
    pub nodes: [usize; 3],
    /// Of `som`: learning cycles.
    #[cfg_attr(test, schemars(range(min = 1, max = 10_000)))]
    pub cycles: usize,
    /// Shells from the surface inwards, the surface included; for an open sheet, layers
    /// through its thickness (2 or more). 3 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1, max = 64)))]
    pub layers: Option<usize>,
    /// How the control net is refined before nodes are made.
    pub refine: RefineSpec,
    /// Thickness of an open sheet and of a membrane, which need it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub thickness_m: Option<f64>,
    /// Of the model `net`: cells across each knot span of the surface.
    #[cfg_attr(test, schemars(range(min = 1, max = 8)))]
    pub cells_per_span: usize,
    /// Of the model `net`: layers of cells in depth; twice the shells when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1, max = 64)))]
    pub cell_layers: Option<usize>,
}

impl Default for LatticeSpec {
    fn default() -> Self {
        Self {
            builder: BuilderSpec::Layers,
            nodes: [12; 3],
            cycles: 100,
            layers: None,
            refine: RefineSpec::Auto(RefineAuto::Auto),
            thickness_m: None,
            cells_per_span: 2,
            cell_layers: None,
        }
    }
}

/// How nodes are placed inside the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum BuilderSpec {
    /// Shells below the surface: its control points are the outermost nodes.
    #[default]
    Layers,
    /// A cube of nodes, drawn into the surface by a harmonic map; the outermost nodes ride on the
    /// surface.
    Transfinite,
    /// The same by a self-organising map, as in the design thesis.
    Som,
}

impl BuilderSpec {
    /// As scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Layers => "layers",
            Self::Transfinite => "transfinite",
            Self::Som => "som",
        }
    }
}

/// `refine = "auto" | "none" | [22, 23] | { focus = [points] } | { u = [knots], v = [knots] }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum RefineSpec {
    /// `"auto"` or `"none"`.
    Auto(RefineAuto),
    /// Number of distinct control points wanted in u and v.
    Counts([usize; 2]),
    /// As `"auto"` with the same number of nodes, but three times as fine around these points as
    /// far away.
    Focus {
        /// Where tools will press, on or near the surface, in the body's frame.
        #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
        focus: Vec<[f64; 3]>,
    },
    /// Knots to insert.
    Knots {
        /// In u.
        u: Vec<f64>,
        /// In v.
        v: Vec<f64>,
    },
}

/// `"auto"` or `"none"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum RefineAuto {
    /// Evenly over the surface by length, until about three control points lie across the smallest
    /// expected contact, within the node budget of a tick. Tools count by their shapes, not by
    /// where they start.
    Auto,
    /// The net as it is.
    None,
}

/// `[body.integrator]`: time stepping of a deforming body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct IntegratorSpec {
    /// Which method.
    pub method: MethodSpec,
    /// Quasi-Newton iterations of the implicit step.
    pub iterations: IterationsSpec,
    /// Matrix of the implicit step.
    pub matrix: MatrixSpec,
    /// Substeps of `xpbd`, and the fewest of `explicit`.
    #[cfg_attr(test, schemars(range(min = 1, max = 1_000)))]
    pub substeps: usize,
    /// Sweeps of the contact solve per tick.
    #[cfg_attr(test, schemars(range(min = 1, max = 1_000)))]
    pub contact_sweeps: usize,
    /// The body steps once in this many ticks, beside the loop. In between it answers with
    /// its compliance.
    #[cfg_attr(test, schemars(range(min = 1, max = 100)))]
    pub every: u32,
    /// An untouched body none of whose points is faster falls asleep; 0 keeps it awake.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub sleep_m_s: f64,
}

impl Default for IntegratorSpec {
    fn default() -> Self {
        Self {
            method: MethodSpec::Implicit,
            iterations: IterationsSpec::Count(1),
            matrix: MatrixSpec::Auto,
            substeps: 1,
            contact_sweeps: 30,
            every: 1,
            sleep_m_s: 1e-7,
        }
    }
}

/// `iterations = 2` (1 ..= 100) or `"auto"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum IterationsSpec {
    /// This many.
    Count(#[cfg_attr(test, schemars(range(min = 1, max = 100)))] usize),
    /// As few as bring the expected motion error below 2 %, within the time of a tick.
    Auto(IterationsAuto),
}

/// `"auto"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum IterationsAuto {
    /// Chosen when the scene is built.
    Auto,
}

/// Matrix of the implicit step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum MatrixSpec {
    /// The tangent where it fits, else the bounding matrix.
    #[default]
    Auto,
    /// The tangent of rest, turned with the body.
    Tangent,
    /// A scalar matrix above every tangent.
    Bounding,
}

/// Time integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum MethodSpec {
    /// Backward Euler with a constant matrix: stable at any stiffness.
    #[default]
    Implicit,
    /// Symplectic Euler in as many substeps as stability needs.
    Explicit,
    /// Extended position-based dynamics, for comparison: it softens silently.
    Xpbd,
    /// `explicit` where that is cheaper than `implicit`.
    Auto,
}

/// `[[body.fixed]]`: what is on the far side of a plane (body frame), `normal · (x − point) <= 0`, or the control points
/// of a range of parameters. A plane holds matter wherever it cuts the net.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged, deny_unknown_fields)]
pub enum FixedSpec {
    /// Behind a plane.
    Plane {
        /// A point of the plane.
        #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
        point: [f64; 3],
        /// Its normal, any length above 0, towards the free part.
        normal: [f64; 3],
    },
    /// Control points whose Greville abscissae lie in both ranges.
    Range {
        /// From and to in u.
        u: [f64; 2],
        /// From and to in v.
        v: [f64; 2],
    },
}

fn is_false(value: &bool) -> bool {
    !value
}

fn is_zero(values: &[f64; 3]) -> bool {
    *values == [0.0; 3]
}
