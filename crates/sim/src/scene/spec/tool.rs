//! `[[tool]]` of a scene file: coupling, device, friction, grip.

use super::{PoseSpec, ShapeSpec};
use serde::{Deserialize, Serialize};

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
