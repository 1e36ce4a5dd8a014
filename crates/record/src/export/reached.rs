//! The state after any tick of a recording, by running the ticks from the keyframe before.

use super::super::channel::{Happening, Keyframe, Topic};
use super::super::reader::{
    Follower, Session, first_keyframe, first_keyframe_where, last_keyframe_until,
};
use super::super::replay::ReplayError;
use super::super::rerun::Rerun;
use super::ExportError;
use palpate_sim::scene::Scene;
use std::sync::Arc;

/// A simulation that stands after a tick, and what was recorded next.
pub(super) struct Reached {
    pub rerun: Rerun,
    /// Commands and ticks after it.
    pub follower: Follower,
    /// The state has the recorded hash.
    pub is_exact: bool,
}

impl Reached {
    /// Runs to the state after `tick`.
    ///
    /// # Errors
    /// A tick that there is not, or that no keyframe leads to.
    pub fn after(session: &Session, scene: &Arc<Scene>, tick: u64) -> Result<Self, ExportError> {
        let first = first_keyframe(session)?.map(|(_, k)| k.tick);
        let last = session.tick_range().map(|(_, last)| last);
        let known = first.map(|first| (first, last.unwrap_or(first).max(first)));
        if known.is_none_or(|(first, last)| tick < first || tick > last) {
            return Err(ExportError::UnknownTick { tick, ticks: known });
        }
        // One of this very tick will do, unless it holds commands that came after it: then the one
        // before leads here.
        let fits = |keyframe: &Keyframe| keyframe.tick < tick || keyframe.commands == 0;
        let before = match last_keyframe_until(session, tick, fits)? {
            None => last_keyframe_until(session, tick, |_| true)?,
            found => found,
        };
        let Some((place, keyframe)) = before else {
            return Err(ExportError::UnknownTick { tick, ticks: known });
        };
        let mut rerun = Rerun::new(scene);
        let state = |source| ReplayError::State {
            tick: keyframe.tick,
            source,
        };
        let mut hash = rerun.seat(&keyframe.saved).map_err(state)?;
        let mut expected = keyframe.state_hash;
        let mut at = keyframe.tick;
        let mut follower = Follower::at(session, place).only(&[Topic::Tick, Topic::Command]);
        while at < tick {
            match follower.next().transpose()? {
                Some(Happening::Tick(record)) if record.output.tick == at + 1 => {
                    at += 1;
                    hash = rerun.tick(&record.input).state_hash;
                    expected = record.output.state_hash;
                }
                Some(Happening::Command(after_tick, command)) if after_tick <= at => {
                    rerun.command(command);
                }
                Some(Happening::Tick(_)) | None => break,
                Some(_) => {}
            }
        }
        if at != tick {
            let next = first_keyframe_where(session, |keyframe| keyframe.tick > tick)?;
            let next = next.map(|(_, keyframe)| keyframe.tick);
            return Err(ExportError::Unreached { tick, next });
        }
        Ok(Self {
            rerun,
            follower,
            is_exact: hash == expected,
        })
    }
}
