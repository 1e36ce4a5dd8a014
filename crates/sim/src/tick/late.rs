//! Steps on other threads that are not done when they are due.
//!
//! A loop in real time does not wait for them: before a tick it asks which are late, and puts each off
//! by a tick with a [command](super::record::Command::PutOff), which is recorded, so that a replay does
//! the same. The surface answers with its compliance meanwhile, as between steps, and the body is
//! slower than the clock by the ticks that its step was put off. Loops that need not keep time never
//! ask: there the tick that takes a step over waits for it.

use super::{RunState, SceneState, Scratch};
use crate::party::BodyParty;
use crate::scene::Scene;

/// The first body whose step the next tick would wait for, if there is one: it is being done elsewhere,
/// is due, and is neither done nor put off.
pub fn late_step(scene: &Scene, state: &SceneState, scratch: &mut Scratch) -> Option<u32> {
    let pipeline = scratch.pipeline.as_mut()?;
    let moves = match state.run {
        RunState::Running => true,
        RunState::Paused { steps } => steps > 0,
        RunState::Stopping => false,
    };
    if !moves {
        return None;
    }
    let late =
        |(b, body): &(usize, BodyParty<'_>)| body.is_late(&state.bodies[*b], pipeline.as_mut());
    let mut bodies = scene.parties().enumerate();
    bodies.find(late).map(|(b, _)| b as u32)
}
