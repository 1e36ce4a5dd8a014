//! Figures by simulating a session anew, without asking for its bits.

use super::super::channel::{Happening, Topic};
use super::super::reader::{Follower, Place, Session, first_keyframe};
use super::super::replay::{ReplayError, recorded_scene};
use super::super::rerun::Rerun;
use super::{Figures, FiguresError, Sum};
use serde::Serialize;
use std::sync::Arc;

/// Where a simulation began.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// With the state of the first keyframe.
    Keyframe,
    /// With the scene's own start: the keyframe does not fit this version.
    Scene {
        /// Why it does not fit.
        reason: String,
    },
}

/// Simulates a session with its recorded inputs and sums up what comes out. `progress` is called
/// now and then with the ticks done and all.
///
/// # Errors
/// A session with ticks missing, one that does not begin at tick 0 and whose first keyframe this
/// version cannot read, or a scene that does not build.
pub fn simulate_figures(
    session: &Session,
    mut progress: impl FnMut(u64, u64),
) -> Result<(Figures, Start), FiguresError> {
    let scene = Arc::new(recorded_scene(session)?);
    let read = ReplayError::Read;
    let none = ReplayError::NoKeyframe {
        from: 0,
        first: None,
    };
    let (place, keyframe) = first_keyframe(session).map_err(read)?.ok_or(none)?;
    let mut rerun = Rerun::new(&scene);
    // A state of another version may have another size, or fit and mean something else: then its
    // hash is another.
    let unfit = match rerun.seat(&keyframe.saved) {
        Ok(hash) if hash == keyframe.state_hash => None,
        Ok(hash) => Some(format!(
            "its state has the hash {hash:016x}, not {:016x}",
            keyframe.state_hash
        )),
        Err(source) => {
            let tick = keyframe.tick;
            Some(ReplayError::State { tick, source }.to_string())
        }
    };
    let (start, place) = match unfit {
        None => (Start::Keyframe, place),
        Some(reason) if keyframe.tick == 0 => {
            rerun = Rerun::new(&scene);
            (Start::Scene { reason }, Place::default())
        }
        Some(reason) => {
            return Err(FiguresError::Start {
                tick: keyframe.tick,
                reason,
            });
        }
    };
    let mut sum = Sum::new(&scene);
    let mut tick = keyframe.tick;
    for happening in Follower::at(session, place).only(&[Topic::Tick, Topic::Command]) {
        match happening.map_err(read)? {
            Happening::Tick(record) if record.output.tick <= keyframe.tick => {}
            Happening::Tick(record) => {
                tick = tick.saturating_add(1);
                if record.output.tick != tick {
                    return Err(FiguresError::Gap { tick });
                }
                let output = rerun.tick(&record.input);
                sum.push(&output, rerun.state());
                if sum.ticks.is_multiple_of(100) {
                    progress(sum.ticks, session.tick_count());
                }
            }
            Happening::Command(after_tick, command) if after_tick <= tick => {
                rerun.command(command);
            }
            _ => {}
        }
    }
    Ok((sum.finish(), start))
}
