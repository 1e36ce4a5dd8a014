//! `[[body]]` of a scene file.

use super::{ModelSpec, PoseSpec, SurfaceSpec};
use serde::{Deserialize, Serialize};

/// `[[body]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySpec {
    /// `[a-z0-9_-]{1,64}`.
    pub id: String,
    /// Where its surface comes from.
    pub surface: SurfaceSpec,
    /// Placement in the world.
    #[serde(default)]
    pub pose: PoseSpec,
    /// How it moves.
    #[serde(default)]
    pub model: ModelSpec,
    /// What it is made of; used by deforming models only.
    #[serde(default)]
    pub material: MaterialSpec,
    /// Parts of another material; the last that holds a cell counts.
    #[serde(default, rename = "region", skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionSpec>,
    /// How a lattice is built.
    #[serde(default)]
    pub lattice: LatticeSpec,
    /// Time integration.
    #[serde(default)]
    pub integrator: IntegratorSpec,
    /// Nodes that never move.
    #[serde(default)]
    pub fixed: Vec<FixedSpec>,
    /// The body may touch itself.
    #[serde(default)]
    pub self_contact: bool,
}

/// `[body.material]`: a preset, and what differs from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MaterialSpec {
    /// A name of [`crate::body::PRESETS`]; `gel` when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Young's modulus E, Pa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young_pa: Option<f64>,
    /// Poisson's ratio ν in [0, 0.5); springs mean 1/4, membranes 1/3, whatever it says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// ρ, kg/m³.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
    /// Stiffness-proportional (Voigt) damping time, s: a strain rate ε̇ adds the stress of a strain
    /// of this times ε̇.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_s: Option<f64>,
    /// Springs that give for good; that of the preset when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plastic: Option<PlasticSpec>,
    /// Springs that stiffen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffening: Option<StiffeningSpec>,
    /// How the stiffness of springs follows from E.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub springs: Option<SpringsSpec>,
}

/// `plastic = { yield_strain = 0.02, rate_per_s = 20.0 }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlasticSpec {
    /// Strain that springs bear without flow.
    pub yield_strain: f64,
    /// Share of the strain beyond yield that flows away in a second, 1/s; 0 for none at all.
    pub rate_per_s: f64,
    /// Growth of the yield strain with the plastic strain so far.
    #[serde(default)]
    pub hardening: f64,
    /// Most plastic strain, in (0, 1).
    #[serde(default = "plastic_limit")]
    pub limit: f64,
    /// Flow is shared with springs within this distance, m.
    #[serde(default)]
    pub spread_m: f64,
}

fn plastic_limit() -> f64 {
    0.6
}

/// `stiffening = { strain = 0.3, ratio = 5.0, least_length = 0.2 }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StiffeningSpec {
    /// Strain in extension from which on springs are stiffer.
    pub strain: f64,
    /// Stiffness there, relative to that at rest, 1 ..= 1,000.
    pub ratio: f64,
    /// Length below which coils touch, relative to the rest length, in [0, 1).
    pub least_length: f64,
    /// Stiffness there, relative to that at rest, 1 ..= 1,000.
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
#[serde(rename_all = "lowercase")]
pub enum SpringsSpec {
    /// So that the body has that modulus.
    #[default]
    Moduli,
    /// K = E A / L for each spring, as in the thesis; for comparison.
    Seed,
}

/// `[[body.region]]`: cells of another material, by their centres, in the body's frame. What it
/// does not say is as in the rest of the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// A ball …
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ball: Option<BallSpec>,
    /// … or a box along the axes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub box_: Option<BoxSpec>,
    /// Young's modulus E, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub young_pa: Option<f64>,
    /// Poisson's ratio ν.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// ρ, kg/m³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
}

/// A ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// m.
    pub centre: [f64; 3],
    /// m.
    pub radius_m: f64,
}

/// A box along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Least corner, m.
    pub low: [f64; 3],
    /// Greatest corner, m.
    pub high: [f64; 3],
}

/// `[body.lattice]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSpec {
    /// How cells are made.
    pub builder: BuilderSpec,
    /// Of `transfinite` and `som`: nodes along each axis of the cube.
    pub nodes: [usize; 3],
    /// Of `som`: learning cycles.
    pub cycles: usize,
    /// Shells from the surface inwards, the surface included (≥ 1); for an open sheet, layers
    /// through its thickness (≥ 2).
    pub layers: usize,
    /// The net after refinement.
    pub refine: RefineSpec,
    /// Thickness of an open sheet, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness_m: Option<f64>,
    /// Of `net`: cells across each knot span of the surface.
    pub cells_per_span: usize,
    /// Of `net`: layers of cells in depth; twice the shells when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell_layers: Option<usize>,
}

impl Default for LatticeSpec {
    fn default() -> Self {
        Self {
            builder: BuilderSpec::Layers,
            nodes: [12; 3],
            cycles: 100,
            layers: 4,
            refine: RefineSpec::Auto(RefineAuto::Auto),
            thickness_m: None,
            cells_per_span: 2,
            cell_layers: None,
        }
    }
}

/// How cells are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BuilderSpec {
    /// Shells below the surface: its control points are the outermost nodes.
    #[default]
    Layers,
    /// A cube of nodes, drawn into the surface by a harmonic map; the outermost nodes ride on the
    /// surface.
    Transfinite,
    /// The same by a self-organising map, as in the thesis.
    Som,
}

/// `refine = "auto" | "none" | [22, 23] | { focus = [points] } | { u = [knots], v = [knots] }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum RefineSpec {
    /// `"auto"` or `"none"`.
    Auto(RefineAuto),
    /// Distinct control points wanted in u and v.
    Counts([usize; 2]),
    /// As `"auto"` with the same number of nodes, but three times as fine around these points as
    /// far away.
    Focus {
        /// Where tools will press, on or near the surface, in the body's frame, m.
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
#[serde(rename_all = "lowercase")]
pub enum RefineAuto {
    /// Evenly over the surface by length, until about three control points lie across the smallest
    /// expected contact, within the node budget of a tick. Tools count by their shapes, not by
    /// where they start.
    Auto,
    /// The net as it is.
    None,
}

/// `[body.integrator]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct IntegratorSpec {
    /// Which method.
    pub method: MethodSpec,
    /// Quasi-Newton iterations of the implicit step.
    pub iterations: IterationsSpec,
    /// Matrix of the implicit step.
    pub matrix: MatrixSpec,
    /// Substeps of `xpbd`, and the fewest of `explicit`, 1 ..= 1 000.
    pub substeps: usize,
    /// Sweeps of the contact solve a tick, 1 ..= 1 000.
    pub contact_sweeps: usize,
    /// The body steps once in so many ticks, beside the loop; 1 ..= 100. Between, it answers with
    /// its compliance.
    pub every: u32,
    /// An untouched body none of whose points is faster falls asleep, m/s; 0 keeps it awake.
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
#[serde(untagged)]
pub enum IterationsSpec {
    /// So many.
    Count(usize),
    /// As few as bring the expected motion error below 2 %, as far as time allows.
    Auto(IterationsAuto),
}

/// `"auto"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum IterationsAuto {
    /// Chosen when the scene is built.
    Auto,
}

/// Matrix of the implicit step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// `[[body.fixed]]`: the nodes on the far side of a plane (body frame), `normal · (x − point) <=
/// 0`, or the control points of a range of parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum FixedSpec {
    /// Behind a plane.
    Plane {
        /// A point of the plane, m.
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
