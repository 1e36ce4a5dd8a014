//! From the scene file to what is declared: presets filled in, every value checked.

use palpate_devices::ros2::{ButtonKind, ForceKind, Preset};
use palpate_devices::{Cap, CouplerSettings, Frame, FrameError};
use palpate_sim::scene::spec::{
    Clock, Ros2Button, Ros2Force, Ros2Preset, Ros2Spec, Ros2ToolSpec, SceneSpec,
};
use palpate_sim::scene::{Problem, SceneError};

/// Everything that a node declares.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// ROS domain.
    pub domain: u32,
    /// Name of the node.
    pub node: String,
    /// Name of the world's frame.
    pub frame: String,
    /// Ticks wait for poses.
    pub lockstep: bool,
    /// Tools and their topics.
    pub arms: Vec<ArmPlan>,
}

/// Topics of one tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmPlan {
    /// Id of the tool.
    pub tool: String,
    /// Poses.
    pub pose: String,
    /// Velocities, if they are measured.
    pub velocity: Option<String>,
    /// Forces.
    pub force: String,
    /// Their type.
    pub force_kind: ForceKind,
    /// Buttons.
    pub button: Option<(String, ButtonKind)>,
    /// CRTK: ends forces; a stamp of 0 marks a pose as not valid.
    pub free: Option<String>,
    /// CRTK: says that forces are given in the base frame.
    pub absolute: Option<String>,
    /// Frame that poses must have.
    pub frame: Option<String>,
    /// Frames, clutch, safety.
    pub coupler: CouplerSettings,
}

impl Plan {
    /// What a scene asks for. Without `[[ros2.tool]]` every tool is a CRTK arm in the namespace of
    /// its id.
    ///
    /// # Errors
    /// Every value that cannot be, with its path in the scene file.
    pub fn of(spec: &SceneSpec) -> Result<Self, SceneError> {
        let ros2 = spec.ros2.clone().unwrap_or_default();
        let tools = match ros2.tools.is_empty() {
            false => ros2.tools.clone(),
            true => {
                let crtk = |id: &str| Ros2ToolSpec::of(id, Ros2Preset::Crtk, &format!("/{id}"));
                spec.tools.iter().map(|tool| crtk(&tool.id)).collect()
            }
        };
        let mut problems = Problems::default();
        check_names(&ros2, &mut problems);
        let lockstep = spec.loop_.clock == Clock::Lockstep;
        let dt_s = 1.0 / f64::from(spec.loop_.rate_hz);
        let mut arms: Vec<ArmPlan> = Vec::new();
        for (k, tool) in tools.iter().enumerate() {
            let path = format!("ros2.tool[{k}]");
            if !spec.tools.iter().any(|known| known.id == tool.tool) {
                let known: Vec<&str> = spec.tools.iter().map(|tool| tool.id.as_str()).collect();
                let words = format!(
                    "no tool {:?}; the scene has {}",
                    tool.tool,
                    known.join(", ")
                );
                problems.add(format!("{path}.tool"), words);
            }
            if arms.iter().any(|arm| arm.tool == tool.tool) {
                let words = format!("tool {:?} has its topics already", tool.tool);
                problems.add(format!("{path}.tool"), words);
            }
            arms.push(arm(tool, &path, dt_s, &mut problems));
        }
        problems.into_result()?;
        Ok(Self {
            domain: ros2.domain,
            node: ros2.node,
            frame: ros2.frame,
            lockstep,
            arms,
        })
    }
}

#[derive(Default)]
struct Problems(Vec<Problem>);

impl Problems {
    fn add(&mut self, path: String, reason: String) {
        self.0.push(Problem {
            path,
            reason,
            place: None,
        });
    }

    fn into_result(self) -> Result<(), SceneError> {
        match self.0.is_empty() {
            true => Ok(()),
            false => Err(SceneError { problems: self.0 }),
        }
    }
}

fn check_names(ros2: &Ros2Spec, problems: &mut Problems) {
    if ros2.domain > 232 {
        let words = format!("a ROS domain is 0 to 232, not {}", ros2.domain);
        problems.add("ros2.domain".into(), words);
    }
    if !is_name(&ros2.node) {
        let words = format!(
            "{:?} is no name of a node: letters, digits and _",
            ros2.node
        );
        problems.add("ros2.node".into(), words);
    }
}

/// A name or a part of a topic's name: a letter or `_`, then letters, digits and `_`.
fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters
        .next()
        .is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && letters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn arm(spec: &Ros2ToolSpec, path: &str, dt_s: f64, problems: &mut Problems) -> ArmPlan {
    let preset = preset(spec.preset);
    let namespace = spec.namespace.as_deref().unwrap_or(preset.namespace());
    let known = preset.settings(namespace);
    let velocity = match spec.velocity.as_deref() {
        None => known.velocity,
        Some("") => None,
        Some(topic) => Some(topic.to_owned()),
    };
    let kind = spec.button_type.map(button_kind);
    let button = match (&spec.button, known.button) {
        (Some(topic), usual) => Some((
            topic.clone(),
            kind.or(usual.map(|(_, kind)| kind))
                .unwrap_or(ButtonKind::Joy),
        )),
        (None, Some((topic, usual))) => Some((topic, kind.unwrap_or(usual))),
        (None, None) => None,
    };
    // Forces of another topic are not those of the preset: neither is what goes with them.
    let own_force = spec.force.is_none() && spec.force_type.is_none();
    let plan = ArmPlan {
        tool: spec.tool.clone(),
        pose: spec.pose.clone().unwrap_or(known.pose),
        velocity,
        force: spec.force.clone().unwrap_or(known.force),
        force_kind: spec.force_type.map_or(known.force_kind, force_kind),
        button,
        free: known.free,
        absolute: known.absolute.filter(|_| own_force),
        frame: spec.frame.clone(),
        coupler: CouplerSettings {
            frame: frame(spec, path, problems),
            clutch_button: spec.clutch,
            grab_button: Some(spec.grab).filter(|grab| spec.clutch != Some(*grab)),
            velocity_cutoff_hz: spec.velocity_cutoff_hz,
            cap: Cap {
                force_n: spec.force_max_n.unwrap_or(known.force_max_n),
                torque_nm: known.torque_max_nm,
            },
            dt_s,
            ..CouplerSettings::default()
        },
    };
    check_figures(spec, path, problems);
    let topics = [
        ("pose", Some(&plan.pose)),
        ("velocity", plan.velocity.as_ref()),
        ("force", Some(&plan.force)),
        ("button", plan.button.as_ref().map(|(topic, _)| topic)),
    ];
    for (key, topic) in topics {
        if let Some(topic) = topic
            && !topic.trim_matches('/').split('/').all(is_name)
        {
            let words = format!("{topic:?} is no topic; write one like /arm/measured_cp");
            problems.add(format!("{path}.{key}"), words);
        }
    }
    plan
}

/// Each figure is checked by itself, so that all wrong ones are reported.
fn frame(spec: &Ros2ToolSpec, path: &str, problems: &mut Problems) -> Frame {
    let (unturned, origin) = ([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
    let checks = [
        Frame::new(spec.scale, unturned, origin),
        Frame::new(1.0, spec.rotation, origin),
        Frame::new(1.0, unturned, spec.translation),
    ];
    for error in checks.into_iter().filter_map(Result::err) {
        let key = match error {
            FrameError::Scale(_) => "scale",
            FrameError::Rotation(_) => "rotation",
            FrameError::Translation(_) => "translation",
        };
        problems.add(format!("{path}.{key}"), error.to_string());
    }
    Frame::new(spec.scale, spec.rotation, spec.translation).unwrap_or_default()
}

fn check_figures(spec: &Ros2ToolSpec, path: &str, problems: &mut Problems) {
    let cutoff_hz = spec.velocity_cutoff_hz;
    if cutoff_hz.is_nan() || cutoff_hz <= 0.0 {
        let words = format!("a low-pass has a frequency above 0 Hz, not {cutoff_hz}");
        problems.add(format!("{path}.velocity_cutoff_hz"), words);
    }
    if let Some(most) = spec.force_max_n
        && !(0.0..=100.0).contains(&most)
    {
        let words = format!("a device's greatest force is 0 to 100 N, not {most}");
        problems.add(format!("{path}.force_max_n"), words);
    }
    for (key, button) in [("grab", Some(spec.grab)), ("clutch", spec.clutch)] {
        if let Some(button) = button.filter(|button| *button > 31) {
            let words = format!("buttons have the numbers 0 to 31, not {button}");
            problems.add(format!("{path}.{key}"), words);
        }
    }
}

fn preset(preset: Ros2Preset) -> Preset {
    match preset {
        Ros2Preset::Crtk => Preset::Crtk,
        Ros2Preset::Sensable => Preset::Sensable,
        Ros2Preset::ForceDimension => Preset::ForceDimension,
        Ros2Preset::Ros2ControlFd => Preset::Ros2ControlFd,
        Ros2Preset::GeomagicTouch => Preset::GeomagicTouch,
    }
}

fn force_kind(kind: Ros2Force) -> ForceKind {
    match kind {
        Ros2Force::WrenchStamped => ForceKind::WrenchStamped,
        Ros2Force::Wrench => ForceKind::Wrench,
        Ros2Force::Vector3Stamped => ForceKind::Vector3Stamped,
        Ros2Force::Float64MultiArray => ForceKind::Float64MultiArray,
        Ros2Force::OmniFeedback => ForceKind::OmniFeedback,
    }
}

fn button_kind(kind: Ros2Button) -> ButtonKind {
    match kind {
        Ros2Button::Joy => ButtonKind::Joy,
        Ros2Button::Bool => ButtonKind::Bool,
        Ros2Button::OmniButtonEvent => ButtonKind::OmniButtonEvent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_sim::scene::file;
    use std::path::Path;

    const SCENE: &str = "[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\", net = [8, 8] }\n\
                         [[tool]]\nid = \"ball\"\nshape = { sphere = { radius_m = 0.01 } }\n";

    fn plan(ros2: &str) -> Result<Plan, String> {
        let loaded = file::parse(&format!("{SCENE}{ros2}"), "s.toml", Path::new("."))
            .map_err(|e| e.to_string())?;
        Plan::of(&loaded.spec).map_err(|error| loaded.locate(error).to_string())
    }

    #[test]
    fn without_a_table_every_tool_is_a_crtk_arm() {
        let plan = plan("").unwrap();
        let arm = &plan.arms[0];
        assert_eq!(
            (arm.pose.as_str(), arm.force.as_str()),
            ("/ball/measured_cp", "/ball/body/servo_cf")
        );
        assert_eq!(arm.free.as_deref(), Some("/ball/free"));
    }

    #[test]
    fn presets_have_the_topics_of_their_drivers_and_keys_go_before_them() {
        let topics = |preset: &str| {
            let plan = plan(&format!(
                "[[ros2.tool]]\ntool = \"ball\"\npreset = \"{preset}\"\n"
            ))
            .unwrap();
            let arm = plan.arms[0].clone();
            (arm.pose, arm.force, arm.button.map(|(topic, _)| topic))
        };
        let of = |pose: &str, force: &str, button: Option<&str>| {
            (pose.to_owned(), force.to_owned(), button.map(str::to_owned))
        };
        assert_eq!(
            topics("crtk"),
            of("/arm/measured_cp", "/arm/body/servo_cf", None)
        );
        assert_eq!(
            topics("sensable"),
            of("/arm/measured_cp", "/arm/servo_cf", Some("/arm/button1"))
        );
        assert_eq!(
            topics("force_dimension"),
            of("/arm/measured_cp", "/arm/body/servo_cf", None)
        );
        assert_eq!(
            topics("ros2_control_fd"),
            of("/fd/ee_pose", "/fd/fd_controller/commands", None)
        );
        assert_eq!(
            topics("geomagic_touch"),
            of(
                "/phantom/pose",
                "/phantom/force_feedback",
                Some("/phantom/button")
            )
        );
        let own = plan(
            "[ros2]\ndomain = 7\n[[ros2.tool]]\ntool = \"ball\"\npreset = \"crtk\"\nnamespace = \"/MTML\"\n\
             force_type = \"Vector3Stamped\"\nvelocity = \"\"\nclutch = 2\nforce_max_n = 1.5\n",
        )
        .unwrap();
        let arm = &own.arms[0];
        assert_eq!(
            (own.domain, arm.pose.as_str(), arm.velocity.as_deref()),
            (7, "/MTML/measured_cp", None)
        );
        assert_eq!(arm.force_kind, ForceKind::Vector3Stamped);
        assert_eq!(
            (arm.coupler.clutch_button, arm.coupler.cap.force_n),
            (Some(2), 1.5)
        );
    }

    #[test]
    fn mistakes_are_told_with_their_lines() {
        let reported = plan(
            "[ros2]\nnode = \"a b\"\n[[ros2.tool]]\ntool = \"pen\"\nscale = 0\nrotation = [1, 1, 0, 0]\n\
             pose = \"/a b\"\nforce_max_n = -1\nclutch = 40\n",
        )
        .unwrap_err();
        for words in [
            "s.toml:8:1: \"a b\" is no name of a node",
            "s.toml:10:1: no tool \"pen\"; the scene has ball",
            "s.toml:11:1: a scale is",
            "s.toml:12:1: a rotation is",
            "s.toml:13:1: \"/a b\" is no topic",
            "s.toml:14:1: a device's greatest force",
            "s.toml:15:1: buttons have",
        ] {
            assert!(reported.contains(words), "{words}\n{reported}");
        }
        let reported = plan("[[ros2.tool]]\ntool = \"ball\"\npreset = \"crkt\"\n").unwrap_err();
        assert!(reported.contains("crtk"), "{reported}");
    }
}
