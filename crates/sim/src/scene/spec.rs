//! The scene file, as data. TOML; SI units; unknown keys are refused.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

mod body;
mod ros2;
mod surface;
mod tool;
pub use super::model::ModelSpec;
pub use super::shape::{
    Capsule, Cone, Cuboid, Cylinder, Ellipsoid, Implicit, InlineMesh, MeshSpec, MeshUnit, Plane,
    Point, ShapeSpec, Sphere, Torus,
};
pub use body::*;
pub use ros2::*;
pub use surface::SurfaceSpec;
pub use tool::*;

/// A whole scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// Name shown to people; the file's stem when absent.
    #[serde(default)]
    pub name: Option<String>,
    /// `[loop]`.
    #[serde(default, rename = "loop")]
    pub loop_: LoopSpec,
    /// `[gravity]`.
    #[serde(default)]
    pub gravity: GravitySpec,
    /// `[[body]]`, at least one.
    #[serde(rename = "body")]
    pub bodies: Vec<BodySpec>,
    /// `[[tool]]`, at most [`crate::scene::spec::MAX_TOOLS`].
    #[serde(default, rename = "tool")]
    pub tools: Vec<ToolSpec>,
    /// `[[contact]]`: exceptions to "every tool touches every body, exactly".
    #[serde(default, rename = "contact")]
    pub contacts: Vec<ContactSpec>,
    /// `[record]`.
    #[serde(default)]
    pub record: RecordSpec,
    /// `[zenoh]`.
    #[serde(default)]
    pub zenoh: ZenohSpec,
    /// `[ros2]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ros2: Option<Ros2Spec>,
}

pub use crate::solve::rows::MAX_TOOLS;

impl SceneSpec {
    /// Gives tools and bodies other ids, (old, new), wherever the scene names them. All names
    /// change at once, so two may swap; of several new ids for one old the last counts.
    pub fn rename(&mut self, ids: &[(String, String)]) {
        let bodies = self.bodies.iter_mut().map(|body| &mut body.id);
        let tools = self.tools.iter_mut().map(|tool| &mut tool.id);
        let pairs = self
            .contacts
            .iter_mut()
            .flat_map(|contact| &mut contact.pair);
        for id in bodies
            .chain(tools)
            .chain(pairs)
            .chain(&mut self.gravity.frame)
        {
            if let Some((_, new)) = ids.iter().rev().find(|(old, _)| old == id) {
                id.clone_from(new);
            }
        }
    }
}

/// `[loop]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LoopSpec {
    /// Ticks a second, 1 ..= 10 000.
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
#[serde(rename_all = "lowercase")]
pub enum Clock {
    /// The wall clock.
    #[default]
    Realtime,
    /// Every tool's next pose.
    Lockstep,
}

/// `[gravity]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GravitySpec {
    /// m/s²; zero unless given.
    pub acceleration: [f64; 3],
    /// Id of a tool that carries all bodies: the scene is seen from it, and bodies feel how it
    /// tilts and shakes. That tool touches nothing itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<String>,
    /// Time constant with which that tool's velocities are smoothed, s.
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

/// Placement: rotate, then translate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoseSpec {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion x y z w.
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

/// `[[contact]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactSpec {
    /// Tool id or body id, body id.
    pub pair: [String; 2],
    /// `exact`, `spheres` or `none`.
    #[serde(default)]
    pub method: ContactMethod,
    /// Of `spheres`: points in u and v over the whole surface, each 4 ..= 1 000.
    #[serde(default)]
    pub resolution: Option<[usize; 2]>,
    /// Friction of this pair, in place of the tool's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSpec>,
}

/// How a pair is tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// `[record]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RecordSpec {
    /// Seconds between keyframes.
    pub keyframe_s: f64,
    /// Nets a second at most, in recordings; clients get sixty.
    pub net_hz: f64,
    /// Also record what viewers show.
    pub views: bool,
    /// Pictures a second at most.
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

/// `[zenoh]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ZenohSpec {
    /// A stock Zenoh JSON5 configuration, relative to the scene file.
    pub config: Option<PathBuf>,
}
