//! Why the forces of a recorded tick are what they are: the tick runs once more, and is asked.

use super::super::channel::Happening;
use super::super::reader::Session;
use super::super::replay::recorded_scene;
use super::ExportError;
use super::reached::Reached;
use palpate_sim::tick::explain::Explanation;
use std::sync::Arc;

/// Explains tick `tick` of a recording. It runs from the keyframe before, and what it comes to must have the
/// recorded hash: an explanation is of the recorded tick or an error.
///
/// # Errors
/// A tick that there is not, one that no keyframe leads to, or a build that comes to another state.
pub fn explain(session: &Session, tick: u64) -> Result<Explanation, ExportError> {
    let scene = Arc::new(recorded_scene(session)?);
    let before = tick.saturating_sub(1);
    let mut reached = Reached::after(session, &scene, before)?;
    let unknown = || ExportError::UnknownTick {
        tick,
        ticks: session.tick_range(),
    };
    if tick == 0 {
        return Err(unknown());
    }
    while let Some(happening) = reached.follower.next().transpose()? {
        match happening {
            Happening::Command(after_tick, command) if after_tick <= before => {
                reached.rerun.command(command);
            }
            Happening::Tick(record) => {
                if record.output.tick != tick {
                    break;
                }
                let (output, explanation) = reached.rerun.explained(&record.input);
                return match reached.is_exact && output.state_hash == record.output.state_hash {
                    true => Ok(explanation),
                    false => Err(ExportError::Diverges { tick }),
                };
            }
            _ => {}
        }
    }
    Err(unknown())
}
