//! Figures by simulating a session anew, without asking for its bits.

use super::super::reader::Session;
use super::super::replay::{Follower, ReplayError, recorded_scene};
use super::{Figures, FiguresError, Sum};
use serde::Serialize;

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
    let scene = recorded_scene(session)?;
    let keyframe = session.keyframes.first().ok_or(ReplayError::NoKeyframe {
        from: 0,
        first: None,
    })?;
    let mut follower = Follower::new(&scene, session);
    // A state of another version may have another size, or fit and mean something else: then its
    // hash is another.
    let unfit = match follower.seat(keyframe) {
        Ok(hash) if hash == keyframe.state_hash => None,
        Ok(hash) => Some(format!(
            "its state has the hash {hash:016x}, not {:016x}",
            keyframe.state_hash
        )),
        Err(error) => Some(error.to_string()),
    };
    let start = match unfit {
        None => Start::Keyframe,
        Some(reason) if keyframe.tick == 0 => {
            follower = Follower::new(&scene, session);
            Start::Scene { reason }
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
    let first = session
        .ticks
        .partition_point(|record| record.output.tick <= keyframe.tick);
    let records = &session.ticks[first..];
    for record in records {
        tick = tick.saturating_add(1);
        if record.output.tick != tick {
            return Err(FiguresError::Gap { tick });
        }
        let output = follower.tick(tick, &record.input);
        sum.push(&output, follower.state());
        if sum.ticks.is_multiple_of(100) {
            progress(sum.ticks, records.len() as u64);
        }
    }
    Ok((sum.finish(), start))
}
