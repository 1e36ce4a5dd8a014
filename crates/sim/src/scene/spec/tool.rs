//! Tools: shape, coupling, device, friction, grip.

use super::{PoseSpec, SurfaceSpec};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `[[tool]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolSpec {
    /// `[a-z0-9_-]{1,64}`.
    pub id: String,
    /// Its shape.
    #[serde(default)]
    pub shape: ShapeSpec,
    /// Where it starts.
    #[serde(default)]
    pub pose: PoseSpec,
    /// Virtual coupling between device and proxy.
    #[serde(default)]
    pub coupling: CouplingSpec,
    /// What its device can bear.
    #[serde(default)]
    pub device: DeviceSpec,
    /// Friction with every body; none unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSpec>,
    /// How fast it holds while its grab button is down.
    #[serde(default, skip_serializing_if = "GripSpec::is_default")]
    pub grip: GripSpec,
    /// A plane fixes the lattice nodes on its far side at the start.
    #[serde(default)]
    pub fixes_nodes: bool,
}

/// `shape = { point = {} }`, `{ sphere = { radius_m = 0.01 } }`, `{ plane = { normal = [0, 0, 1] }
/// }` or `{ surface = { builtin = "torus" } }`, `{ cylinder = { radius_m = 0.005 } }`, `{ mesh = {
/// file = "probe.stl" } }` …
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum ShapeSpec {
    /// A point.
    Point {},
    /// A ball around the reference point.
    Sphere {
        /// m, above 0.
        radius_m: f64,
    },
    /// Everything below a plane through the reference point.
    Plane {
        /// Outward normal in the tool's frame, any length above 0.
        normal: [f64; 3],
    },
    /// A rigid B-spline surface in the tool's frame.
    Surface(SurfaceSpec),
    /// A round bar along the tool's z axis, around its reference point.
    Cylinder {
        /// m.
        radius_m: f64,
        /// Half the length, m; without it the bar has no ends.
        #[serde(default)]
        half_length_m: Option<f64>,
    },
    /// A cone with its tip at the reference point, opening towards the tool's +z.
    Cone {
        /// Angle between axis and side, rad, below π/2.
        half_angle_rad: f64,
        /// From tip to base, m.
        height_m: f64,
    },
    /// An ellipsoid around the reference point.
    Ellipsoid {
        /// Along the tool's x, y, z, m.
        semi_axes_m: [f64; 3],
    },
    /// A ring around the tool's z axis.
    Torus {
        /// From the centre to the middle of the tube, m.
        major_radius_m: f64,
        /// Of the tube, m.
        minor_radius_m: f64,
    },
    /// A cuboid around the reference point.
    Box {
        /// Half of each edge, m.
        half_extents_m: [f64; 3],
    },
    /// The solid in which a function is at most 0.
    Implicit {
        /// Function of x, y, z in metres, tool frame: `"x^2 + y^2 + 4*z^2 - 1e-4"`.
        f: String,
        /// Distance from the reference point that holds all of the solid, m; without it the tool is
        /// near everything.
        #[serde(default)]
        reach_m: Option<f64>,
    },
    /// A closed triangle mesh in the tool's frame.
    Mesh(MeshSpec),
}

/// `mesh = { file = "probe.stl", unit = "mm" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSpec {
    /// An STL or OBJ file, relative to the scene file.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// The mesh in place, m.
    #[serde(default)]
    pub inline: Option<InlineMesh>,
    /// Length unit of the file.
    #[serde(default)]
    pub unit: MeshUnit,
}

/// A mesh in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InlineMesh {
    /// (n), m.
    pub vertices: Vec<[f64; 3]>,
    /// Corners from 0, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Length unit of a mesh file, which has none of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MeshUnit {
    /// Metres.
    #[default]
    M,
    /// Millimetres.
    Mm,
}

impl Default for ShapeSpec {
    fn default() -> Self {
        Self::Sphere { radius_m: 0.01 }
    }
}

/// `[tool.coupling]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CouplingSpec {
    /// K_c, N/m; `inf` holds the proxy rigidly to the device.
    pub stiffness_n_m: f64,
    /// B_c, N·s/m.
    pub damping_n_s_m: f64,
    /// The same for rotation, N·m/rad; `inf` turns the proxy as the device is turned. A point or a
    /// ball never minds.
    pub turning_stiffness_nm_rad: f64,
    /// N·m·s/rad.
    pub turning_damping_nm_s_rad: f64,
    /// No stiffer in translation than the device can hold: with the figures of [`DeviceSpec`], or
    /// those the device tells.
    pub bounded: bool,
}

impl Default for CouplingSpec {
    fn default() -> Self {
        Self {
            stiffness_n_m: 1_000.0,
            damping_n_s_m: 1.0,
            turning_stiffness_nm_rad: f64::INFINITY,
            turning_damping_nm_s_rad: 0.0,
            bounded: false,
        }
    }
}

/// `[tool.device]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DeviceSpec {
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Longest ramp of the limit from zero to full on connect and back on loss, s.
    pub ramp_s: f64,
    /// Poses older than this are stale, s.
    pub stale_s: f64,
    /// Faster than this is a jump, m/s.
    pub speed_max_m_s: f64,
    /// Greatest torque, N·m; 0 for devices that only push.
    pub torque_max_nm: f64,
    /// Keep the loop from giving back more energy than it got: a damper acts when it would.
    pub passivity: bool,
    /// Strongest such damper, N·s/m: less than the device's mass over a tick.
    pub passivity_damping_n_s_m: f64,
    /// Viscous damping of the device, N·s/m; what its stiffest coupling follows from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_n_s_m: Option<f64>,
    /// Dry friction of the device, N.
    pub coulomb_n: f64,
    /// Step of its encoders at the tool, m.
    pub encoder_m: f64,
    /// Its own rate, Hz; the loop's when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// From a pose to its force, beyond one tick, s.
    pub delay_s: f64,
}

impl Default for DeviceSpec {
    fn default() -> Self {
        Self {
            force_max_n: 10.0,
            ramp_s: 0.02,
            stale_s: 0.05,
            speed_max_m_s: 10.0,
            torque_max_nm: f64::INFINITY,
            passivity: false,
            passivity_damping_n_s_m: 30.0,
            damping_n_s_m: None,
            coulomb_n: 0.0,
            encoder_m: 0.0,
            rate_hz: None,
            delay_s: 0.0,
        }
    }
}

/// `friction = { mu = 0.3 }`: Coulomb's law, with drag if wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionSpec {
    /// Largest tangential over normal force, 0 or more; 0: none.
    pub mu: f64,
    /// The same while it slips, at most `mu`; `mu` when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_kinetic: Option<f64>,
    /// Drag of the contact against its slip, N·s/m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub viscous_n_s_m: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// `[tool.grip]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GripSpec {
    /// Greatest pull before what is held slips off, N; 0: it never holds.
    pub force_max_n: f64,
}

impl Default for GripSpec {
    /// A firm pinch.
    fn default() -> Self {
        Self { force_max_n: 10.0 }
    }
}

impl GripSpec {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
