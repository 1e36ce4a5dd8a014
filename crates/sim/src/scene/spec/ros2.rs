//! `[ros2]` of a scene file: which topics move which tool. The simulation does not read it; `palpate
//! serve --ros2` does.

use serde::{Deserialize, Serialize};

/// `[ros2]`: topics of ROS 2 that move the tools.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Ros2Spec {
    /// ROS domain.
    pub domain: u32,
    /// Name of the node.
    pub node: String,
    /// Name of the world's frame in messages.
    pub frame: String,
    /// One entry per tool; without any, each tool is a CRTK arm in the namespace of its id.
    #[serde(rename = "tool")]
    pub tools: Vec<Ros2ToolSpec>,
}

impl Default for Ros2Spec {
    fn default() -> Self {
        Self {
            domain: 0,
            node: "palpate".into(),
            frame: "world".into(),
            tools: Vec::new(),
        }
    }
}

/// `[[ros2.tool]]`: the topics of one tool. Values given here take precedence over the preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ros2ToolSpec {
    /// Id of the tool.
    pub tool: String,
    /// Driver whose topics are used.
    #[serde(default)]
    pub preset: Ros2Preset,
    /// Namespace of the preset's topics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub namespace: Option<String>,
    /// Topic of poses (PoseStamped).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<String>,
    /// Topic of velocities (TwistStamped); empty: they are differentiated from poses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<String>,
    /// Low-pass of differentiated velocities.
    #[serde(default = "cutoff_hz")]
    pub velocity_cutoff_hz: f64,
    /// Topic of forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    /// Type of forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_type: Option<Ros2Force>,
    /// Topic of buttons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub button: Option<String>,
    /// Type of buttons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub button_type: Option<Ros2Button>,
    /// Number of the button with which the tool holds what it touches.
    #[serde(default)]
    pub grab: u32,
    /// Number of the button with which the device moves without its tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutch: Option<u32>,
    /// Frame in which poses must be; any when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<String>,
    /// How many times as far as the device the tool moves.
    #[serde(default = "one")]
    pub scale: f64,
    /// Turns the axes of the device into those of the world: unit quaternion x, y, z, w.
    #[serde(default = "unturned")]
    pub rotation: [f64; 4],
    /// Origin of the device in the world.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    #[serde(default)]
    pub translation: [f64; 3],
    /// Greatest force sent; that of the preset when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_max_n: Option<f64>,
}

fn cutoff_hz() -> f64 {
    100.0
}

fn one() -> f64 {
    1.0
}

fn unturned() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

impl Ros2ToolSpec {
    /// A tool with a preset and nothing else.
    pub fn of(tool: &str, preset: Ros2Preset, namespace: &str) -> Self {
        Self {
            tool: tool.to_owned(),
            preset,
            namespace: Some(namespace.to_owned()),
            pose: None,
            velocity: None,
            velocity_cutoff_hz: cutoff_hz(),
            force: None,
            force_type: None,
            button: None,
            button_type: None,
            grab: 0,
            clutch: None,
            frame: None,
            scale: one(),
            rotation: unturned(),
            translation: [0.0; 3],
            force_max_n: None,
        }
    }
}

/// A family of drivers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Ros2Preset {
    /// A CRTK arm (Collaborative Robotics Toolkit).
    #[default]
    Crtk,
    /// sawSensablePhantom.
    Sensable,
    /// sawForceDimensionSDK.
    ForceDimension,
    /// ros2_control driver of Force Dimension devices.
    Ros2ControlFd,
    /// geomagic_touch and phantom_omni.
    GeomagicTouch,
}

/// Type of forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Ros2Force {
    /// `geometry_msgs/msg/WrenchStamped`.
    WrenchStamped,
    /// `geometry_msgs/msg/Wrench`.
    Wrench,
    /// `geometry_msgs/msg/Vector3Stamped`.
    Vector3Stamped,
    /// `std_msgs/msg/Float64MultiArray`.
    Float64MultiArray,
    /// `omni_msgs/msg/OmniFeedback`.
    OmniFeedback,
}

/// Type of buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Ros2Button {
    /// `sensor_msgs/msg/Joy`.
    Joy,
    /// `std_msgs/msg/Bool`.
    Bool,
    /// `omni_msgs/msg/OmniButtonEvent`.
    OmniButtonEvent,
}
