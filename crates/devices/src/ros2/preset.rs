//! Topics and types of drivers that exist.

/// How forces go to a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceKind {
    /// `geometry_msgs/msg/WrenchStamped`.
    WrenchStamped,
    /// `geometry_msgs/msg/Wrench`.
    Wrench,
    /// `geometry_msgs/msg/Vector3Stamped`: the force.
    Vector3Stamped,
    /// `std_msgs/msg/Float64MultiArray`: the force's three numbers.
    Float64MultiArray,
    /// `omni_msgs/msg/OmniFeedback`.
    OmniFeedback,
}

/// How buttons come from a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ButtonKind {
    /// `sensor_msgs/msg/Joy`: button k is bit k.
    Joy,
    /// `std_msgs/msg/Bool`: bit 0.
    Bool,
    /// `omni_msgs/msg/OmniButtonEvent`: grey is bit 0, white bit 1.
    OmniButtonEvent,
}

/// A family of drivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A CRTK arm (dVRK, RAVEN): `NS/measured_cp`, `NS/body/servo_cf`.
    Crtk,
    /// sawSensablePhantom: `NS/measured_cp`, `NS/servo_cf`, `NS/button1`.
    Sensable,
    /// sawForceDimensionSDK: `NS/measured_cp`, `NS/body/servo_cf`.
    ForceDimension,
    /// ICube's ros2_control driver of Force Dimension devices: `NS/ee_pose`,
    /// `NS/fd_controller/commands`.
    Ros2ControlFd,
    /// geomagic_touch and phantom_omni: `NS/pose`, `NS/force_feedback`, `NS/button`.
    GeomagicTouch,
}

/// What a preset stands for, with the namespace filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetSettings {
    /// `PoseStamped`.
    pub pose: String,
    /// `TwistStamped`, when the driver measures velocities.
    pub velocity: Option<String>,
    /// Forces.
    pub force: String,
    /// Their type.
    pub force_kind: ForceKind,
    /// Buttons.
    pub button: Option<(String, ButtonKind)>,
    /// CRTK: a stamp of 0 marks a pose as not valid, and forces are ended by `NS/free`.
    pub free: Option<String>,
    /// Bool: forces are given in the device's base frame, not in that of its handle.
    pub absolute: Option<String>,
    /// N: below what such devices bear for long.
    pub force_max_n: f64,
    /// N·m; 0 for devices that only push.
    pub torque_max_nm: f64,
}

impl Preset {
    /// Name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crtk => "crtk",
            Self::Sensable => "sensable",
            Self::ForceDimension => "force_dimension",
            Self::Ros2ControlFd => "ros2_control_fd",
            Self::GeomagicTouch => "geomagic_touch",
        }
    }

    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Crtk,
        Self::Sensable,
        Self::ForceDimension,
        Self::Ros2ControlFd,
        Self::GeomagicTouch,
    ];

    /// The namespace that the drivers themselves use.
    pub fn namespace(self) -> &'static str {
        match self {
            Self::Crtk | Self::Sensable | Self::ForceDimension => "/arm",
            Self::Ros2ControlFd => "/fd",
            Self::GeomagicTouch => "/phantom",
        }
    }

    /// Topics below a namespace, types and the greatest force.
    pub fn settings(self, namespace: &str) -> PresetSettings {
        let namespace = namespace.trim_end_matches('/');
        let topic = |name: &str| format!("{namespace}/{name}");
        let crtk = PresetSettings {
            pose: topic("measured_cp"),
            velocity: Some(topic("measured_cv")),
            force: topic("body/servo_cf"),
            force_kind: ForceKind::WrenchStamped,
            button: None,
            free: Some(topic("free")),
            absolute: Some(topic("body/set_cf_orientation_absolute")),
            force_max_n: 6.0,
            torque_max_nm: 0.1,
        };
        match self {
            Self::Crtk => crtk,
            Self::Sensable => PresetSettings {
                force: topic("servo_cf"),
                button: Some((topic("button1"), ButtonKind::Joy)),
                absolute: None,
                force_max_n: 3.0,
                torque_max_nm: 0.0,
                ..crtk
            },
            Self::ForceDimension => PresetSettings {
                force_max_n: 10.0,
                ..crtk
            },
            Self::Ros2ControlFd => PresetSettings {
                pose: topic("ee_pose"),
                velocity: None,
                force: topic("fd_controller/commands"),
                force_kind: ForceKind::Float64MultiArray,
                free: None,
                absolute: None,
                force_max_n: 10.0,
                torque_max_nm: 0.0,
                ..crtk
            },
            Self::GeomagicTouch => PresetSettings {
                pose: topic("pose"),
                velocity: None,
                force: topic("force_feedback"),
                force_kind: ForceKind::OmniFeedback,
                button: Some((topic("button"), ButtonKind::OmniButtonEvent)),
                free: None,
                absolute: None,
                force_max_n: 3.0,
                torque_max_nm: 0.0,
            },
        }
    }
}
