//! The scene file, as data. TOML; SI units; unknown keys are refused.

use serde::{Deserialize, Serialize};

mod body;
mod motion;
mod ros2;
mod surface;
mod tool;
pub use super::model::ModelSpec;
pub use super::shape::{
    Capsule, Cone, Cuboid, Cylinder, Ellipsoid, Implicit, InlineMesh, MeshSpec, MeshUnit, Plane,
    Point, ShapeSpec, Sphere, Torus,
};
pub use body::*;
pub use motion::*;
pub use ros2::*;
pub use surface::SurfaceSpec;
pub use tool::*;

/// A whole scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// Name shown to people; the file's stem when absent.
    #[serde(default)]
    pub name: Option<String>,
    /// Rate and clock of the simulation.
    #[serde(default, rename = "loop")]
    pub loop_: LoopSpec,
    /// Gravity, and a tool that carries the bodies.
    #[serde(default)]
    pub gravity: GravitySpec,
    /// The bodies, at least one.
    #[serde(rename = "body")]
    #[cfg_attr(test, schemars(length(min = 1)))]
    pub bodies: Vec<BodySpec>,
    /// The tools, at most 64.
    #[serde(default, rename = "tool")]
    #[cfg_attr(test, schemars(length(max = 64)))]
    pub tools: Vec<ToolSpec>,
    /// Exceptions to the rule that every tool touches every body, found exactly.
    #[serde(default, rename = "contact")]
    pub contacts: Vec<ContactSpec>,
    /// What recordings contain.
    #[serde(default)]
    pub record: RecordSpec,
    /// Topics of ROS 2 that move the tools, for `palpate serve --ros2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ros2: Option<Ros2Spec>,
}

pub use crate::solve::rows::MAX_TOOLS;

impl SceneSpec {
    /// Gives tools and bodies other ids, (old, new), wherever the scene names them. All names
    /// change at once, so two may swap; of several new ids for one old the last counts.
    pub fn rename(&mut self, ids: &[(String, String)]) {
        let (bodies, carriers): (Vec<_>, Vec<_>) = (self.bodies.iter_mut())
            .map(|body| (&mut body.id, body.carried_by.as_mut()))
            .unzip();
        let carriers = carriers.into_iter().flatten();
        let tools = self.tools.iter_mut().map(|tool| &mut tool.id);
        let pairs = self
            .contacts
            .iter_mut()
            .flat_map(|contact| &mut contact.pair);
        for id in bodies
            .into_iter()
            .chain(tools)
            .chain(pairs)
            .chain(&mut self.gravity.frame)
            .chain(carriers)
        {
            if let Some((_, new)) = ids.iter().rev().find(|(old, _)| old == id) {
                id.clone_from(new);
            }
        }
    }
}

/// `[loop]`: rate and clock of the simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LoopSpec {
    /// Ticks per second.
    #[cfg_attr(test, schemars(range(min = 1, max = 10_000)))]
    pub rate_hz: u32,
    /// What makes a tick due.
    pub clock: Clock,
}

impl Default for LoopSpec {
    fn default() -> Self {
        Self {
            rate_hz: 1_000,
            clock: Clock::Realtime,
        }
    }
}

/// What makes a tick due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Clock {
    /// The wall clock: one tick per period.
    #[default]
    Realtime,
    /// The next pose of every tool: as fast as the clients send, with the same result every time.
    Lockstep,
}

/// `[gravity]`: acceleration of all bodies, and a tool that carries them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct GravitySpec {
    /// Acceleration of gravity in the world.
    #[cfg_attr(test, schemars(extend("x-unit" = "m/s²")))]
    pub acceleration: [f64; 3],
    /// Id of a tool that carries all bodies: the scene is seen from it, and bodies feel how it
    /// tilts and shakes. That tool touches nothing itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<String>,
    /// Time constant with which that tool's velocities are smoothed.
    #[cfg_attr(test, schemars(range(min = 0)))]
    pub smoothing_s: f64,
}

impl Default for GravitySpec {
    fn default() -> Self {
        Self {
            acceleration: [0.0; 3],
            frame: None,
            smoothing_s: 5e-3,
        }
    }
}

/// A placement: rotate, then translate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PoseSpec {
    /// Translation.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub position: [f64; 3],
    /// Rotation as a unit quaternion x, y, z, w.
    pub orientation: [f64; 4],
}

impl Default for PoseSpec {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
        }
    }
}

/// `[[contact]]`: how one pair is tested, or that it never touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ContactSpec {
    /// Id of a tool or a body, then id of a body.
    pub pair: [String; 2],
    /// How the pair is tested.
    #[serde(default)]
    pub method: ContactMethod,
    /// Of `spheres`: points in u and v over the whole surface; 82 × 82 when absent.
    #[serde(default)]
    #[cfg_attr(test, schemars(inner(range(min = 4, max = 1_000))))]
    pub resolution: Option<[usize; 2]>,
    /// Friction of this pair, in place of the tool's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSpec>,
    /// Of two rigid bodies of which one is free: with how much of the speed at which they meet they part; 0
    /// when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0, max = 1)))]
    pub restitution: Option<f64>,
    /// Of a tool and a body that deforms: the tool goes in by what the control net does not show of the contact; true
    /// when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near_field: Option<bool>,
}

/// How a pair is tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ContactMethod {
    /// Certified queries on the surface itself.
    #[default]
    Exact,
    /// Trees of spheres over sampled points: errors fall with the square of the resolution.
    Spheres,
    /// The pair never touches.
    None,
}

/// Points in u and v of the `spheres` method unless a scene gives them.
pub const SPHERES_RESOLUTION: [usize; 2] = [82, 82];

/// `[record]`: what recordings contain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RecordSpec {
    /// Time between keyframes, from which a replay can start.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub keyframe_s: f64,
    /// Control nets per second at most, in recordings; clients get 60.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub net_hz: f64,
    /// Also record what other viewers show: transforms, meshes and points in Foxglove schemas.
    pub views: bool,
    /// Rate of these views at most.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub view_hz: f64,
}

impl Default for RecordSpec {
    fn default() -> Self {
        Self {
            keyframe_s: 1.0,
            net_hz: 30.0,
            views: true,
            view_hz: 30.0,
        }
    }
}
