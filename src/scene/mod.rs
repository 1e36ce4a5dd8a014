//! Scenes: the file (`SceneSpec`), the constant (`Scene`), what a replay restores (`SceneState`), and `Scratch`.

pub mod spec;

use crate::math::{Point3, StateError, StateSink, StateSource, Stateful};
use crate::surface::Surface;
use spec::{Clock, SceneSpec};
use std::path::Path;

/// Why a scene could not be built.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A value that cannot be.
    #[error("{path}: {reason}")]
    Value {
        /// Path of the key, for example `body[0].material.young_pa`.
        path: String,
        /// What is wrong and how to mend it.
        reason: String,
    },
}

/// The constant of a simulation: built once, shared, never changed.
#[derive(Debug)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// Length of a tick, s.
    pub dt_s: f64,
    /// What makes a tick due.
    pub clock: Clock,
    /// The file it was built from.
    pub spec: SceneSpec,
}

impl Scene {
    /// Builds surfaces, bodies and tools; `directory` is where relative paths of the spec start.
    ///
    /// # Errors
    /// The first value that cannot be built, with its path.
    pub fn build(spec: &SceneSpec, directory: &Path) -> Result<Self, SceneError> {
        let _ = directory;
        Ok(Self {
            name: spec.name.clone().unwrap_or_default(),
            dt_s: 1.0 / f64::from(spec.loop_.rate_hz),
            clock: spec.loop_.clock,
            spec: spec.clone(),
        })
    }

    /// Number of tools.
    pub fn tool_count(&self) -> usize {
        self.spec.tools.len()
    }

    /// Id of a tool.
    pub fn tool_id(&self, tool: usize) -> &str {
        &self.spec.tools[tool].id
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.spec.bodies.len()
    }

    /// Id of a body.
    pub fn body_id(&self, body: usize) -> &str {
        &self.spec.bodies[body].id
    }

    /// The surface of a body at rest, refined as simulated and published (world frame).
    pub fn rest_surface(&self, body: usize) -> &Surface {
        let _ = body;
        unreachable!("contract only")
    }

    /// True when the body's net can change.
    pub fn deforms(&self, body: usize) -> bool {
        self.spec.bodies[body].model != spec::ModelSpec::Rigid
    }

    /// The state at the start.
    pub fn initial_state(&self) -> SceneState {
        SceneState { tick: 0 }
    }

    /// Buffers for the steps of one simulation, prepared for `state`.
    pub fn scratch(&self, state: &SceneState) -> Scratch {
        let _ = state;
        Scratch {}
    }
}

/// All that a replay must restore. Hashed every tick.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneState {
    /// Ticks done.
    pub tick: u64,
}

impl SceneState {
    /// Net of a body now, u-major, m; `out` is as long as the net of [`Scene::rest_surface`].
    pub fn copy_net(&self, scene: &Scene, body: usize, out: &mut [Point3]) {
        out.copy_from_slice(scene.rest_surface(body).net().points());
    }

    /// Grows with every change of that body's net.
    pub fn net_revision(&self, body: usize) -> u64 {
        let _ = body;
        0
    }
}

impl Stateful for SceneState {
    fn save(&self, sink: &mut impl StateSink) {
        sink.word(self.tick);
    }
    fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        self.tick = source.word()?;
        Ok(())
    }
}

/// Buffers of a step; nothing in it outlives a tick except what can be computed anew from the state.
#[derive(Debug)]
pub struct Scratch {}
