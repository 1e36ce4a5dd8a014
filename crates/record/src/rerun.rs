//! A simulation that runs recorded ticks once more: from a state on, the same poses and commands,
//! one tick after the other.

use palpate_geometry::math::{Point3, SavedState, StateError, state_hash};
use palpate_sim::scene::Scene;
use palpate_sim::tick::explain::Explanation;
use palpate_sim::tick::record::{Command, TickInput, TickOutput};
use palpate_sim::tick::{SceneState, Scratch};
use palpate_sim::tick::{apply, restore, step, step_explained};
use std::sync::Arc;

/// A scene at work.
pub(super) struct Rerun {
    scene: Arc<Scene>,
    state: SceneState,
    scratch: Scratch,
}

impl Rerun {
    /// At the scene's own start.
    pub fn new(scene: &Arc<Scene>) -> Self {
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        Self {
            scene: scene.clone(),
            state,
            scratch,
        }
    }

    /// Takes a saved state; gives its hash as it is after that.
    ///
    /// # Errors
    /// The state is of another scene.
    pub fn seat(&mut self, saved: &SavedState) -> Result<u64, StateError> {
        restore(&self.scene, &mut self.state, &mut self.scratch, saved)?;
        Ok(self.hash())
    }

    /// A command, before the next tick.
    pub fn command(&mut self, command: Command) {
        apply(&self.scene, &mut self.state, &mut self.scratch, command);
    }

    /// The next tick.
    pub fn tick(&mut self, input: &TickInput) -> TickOutput {
        step(&self.scene, &mut self.state, &mut self.scratch, input)
    }

    /// Runs the next tick, and explains its forces.
    pub fn explained(&mut self, input: &TickInput) -> (TickOutput, Explanation) {
        let mut output = TickOutput::for_tools(self.scene.tool_count());
        let Self {
            scene,
            state,
            scratch,
        } = self;
        let explanation = step_explained(scene, state, scratch, input, &mut output);
        (output, explanation)
    }

    /// Hash of the state now.
    pub fn hash(&self) -> u64 {
        state_hash(&self.state)
    }

    /// The state now.
    pub fn state(&self) -> &SceneState {
        &self.state
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Copies the net of a body as it is now; `points` is made to fit.
    pub fn copy_net(&self, body: usize, points: &mut Vec<Point3>) {
        let count = self.scene.skin(body).points().len();
        points.resize(count, Point3::origin());
        self.state.copy_net(&self.scene, body, points);
    }
}
