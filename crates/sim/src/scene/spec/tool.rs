//! `[[tool]]` of a scene file: coupling, device, friction, grip.

use super::{PoseSpec, ShapeSpec};
use serde::{Deserialize, Serialize};

/// `[[tool]]`: a rigid shape that a client moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ToolSpec {
    /// Name of the tool: 1 to 64 of a-z, 0-9, `_`, `-`.
    #[cfg_attr(test, schemars(regex(pattern = r"^[a-z0-9_-]{1,64}$")))]
    pub id: String,
    /// Its shape.
    #[serde(default)]
    pub shape: ShapeSpec,
    /// Where it starts.
    #[serde(default)]
    pub pose: PoseSpec,
    /// Virtual coupling between the device and the proxy.
    #[serde(default)]
    pub coupling: CouplingSpec,
    /// What its device can render, and when its link counts as lost.
    #[serde(default)]
    pub device: DeviceSpec,
    /// Friction with every body; none when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSpec>,
    /// How firmly it holds while its grab button is pressed.
    #[serde(default, skip_serializing_if = "GripSpec::is_default")]
    pub grip: GripSpec,
    /// Of a plane: the nodes behind it at the start never move.
    #[serde(default)]
    pub fixes_nodes: bool,
    /// Of a plane: what it does when its grab button goes down; it touches nothing then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub action: Option<ActionSpec>,
}

/// `action = "cut"`: what a tool does that touches nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ActionSpec {
    /// It cuts the bodies that deform and that its plane crosses.
    Cut,
}

/// `[tool.coupling]`: spring and damper between the device and the proxy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CouplingSpec {
    /// Stiffness; `inf` holds the proxy rigidly to the device.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub stiffness_n_m: f64,
    /// Damping.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub damping_n_s_m: f64,
    /// Stiffness in rotation; `inf` turns the proxy as the device is turned. Points and spheres do not use it.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0, "x-default" = "inf")))]
    pub turning_stiffness_nm_rad: f64,
    /// Damping in rotation.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub turning_damping_nm_s_rad: f64,
    /// Reduce the stiffness to what the device renders passively in any hand, by the figures in `[tool.device]` or
    /// those that the device sends.
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

/// `[tool.device]`: limits of the device and figures of its mechanics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DeviceSpec {
    /// Greatest force.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub force_max_n: f64,
    /// Time in which the force limit rises from zero to full on connect, and falls on loss.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub ramp_s: f64,
    /// Age from which a pose is stale and the force is ramped down.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub stale_s: f64,
    /// Speed above which a pose is rejected as a jump.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub speed_max_m_s: f64,
    /// Greatest torque; 0 for devices without torque output.
    #[cfg_attr(test, schemars(range(min = 0), extend("x-default" = "inf")))]
    pub torque_max_nm: f64,
    /// Passivity controller: a damper acts whenever the loop would return more energy than it received.
    pub passivity: bool,
    /// Strongest such damper: less than the device's mass over a tick.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub passivity_damping_n_s_m: f64,
    /// Viscous damping of the device; its stiffest passive coupling follows from it.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_n_s_m: Option<f64>,
    /// Dry friction of the device.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub coulomb_n: f64,
    /// Step of its encoders, at the tool.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub encoder_m: f64,
    /// Its own rate; that of the loop when absent.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Delay from a pose to its force, beyond one tick.
    #[cfg_attr(test, schemars(range(min = 0)))]
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
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FrictionSpec {
    /// Coefficient of static friction: largest tangential over normal force; 0 for none.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub mu: f64,
    /// Coefficient while it slips, at most `mu`; `mu` when absent.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_kinetic: Option<f64>,
    /// Drag of the contact against its slip.
    #[cfg_attr(test, schemars(range(min = 0)))]
    #[serde(default, skip_serializing_if = "is_zero")]
    pub viscous_n_s_m: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// `[tool.grip]`: holding what the tool touches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct GripSpec {
    /// Pull at which what is held slips off; 0: it never holds.
    #[cfg_attr(test, schemars(range(min = 0)))]
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
