//! A place in a recording, with the state that belongs to it.

use super::PlayError;
use crate::channel::{Happening, Keyframe, Topic};
use crate::reader::{Follower, Place, Session, last_keyframe_until};
use crate::rerun::Rerun;
use palpate_geometry::math::{SavedState, StateError};
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{TickOutput, TickRecord};
use std::sync::Arc;

/// What came next. Lives for a moment on the stack: its size costs less than a box.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Advance {
    /// A tick; the state is that after it.
    Tick(TickRecord),
    /// Ticks are missing: the state is now that of the keyframe after them.
    Gap {
        /// Last tick before.
        after: u64,
        /// The keyframe's tick.
        to: u64,
    },
    /// No more.
    End,
}

/// A place in a recording.
pub(super) struct Cursor {
    session: Session,
    rerun: Rerun,
    follower: Follower,
    /// Ticks to play: first and last.
    range: (u64, u64),
    /// The state is what the next record needs.
    seated: bool,
    /// First tick whose output was not the recorded one.
    pub diverged: Option<u64>,
}

impl Cursor {
    /// Stands before the first tick to play.
    pub fn new(
        session: Session,
        scene: &Arc<Scene>,
        start: Option<u64>,
        end: Option<u64>,
    ) -> Result<Self, PlayError> {
        let Some((first, last)) = session.tick_range() else {
            let path = session.path.clone();
            return Err(PlayError::Empty { path });
        };
        let range = (
            start.unwrap_or(first).max(first),
            end.unwrap_or(last).min(last),
        );
        if range.0 > range.1 || start.is_some_and(|start| start > last) {
            return Err(PlayError::Range {
                start: start.unwrap_or(first),
                end: end.unwrap_or(last),
                first,
                last,
            });
        }
        let mut cursor = Self {
            follower: Follower::new(&session).reading_ahead(),
            session,
            rerun: Rerun::new(scene),
            range,
            seated: false,
            diverged: None,
        };
        cursor.rewind()?;
        Ok(cursor)
    }

    /// Ticks to play: first and last.
    pub fn range(&self) -> (u64, u64) {
        self.range
    }

    /// The state after the newest tick.
    pub fn state(&self) -> &SceneState {
        self.rerun.state()
    }

    /// Back before the first tick to play. Where no state is known for it, to the first one after
    /// it.
    pub fn rewind(&mut self) -> Result<(), PlayError> {
        let before = self.range.0.saturating_sub(1);
        match self.seek(before) {
            Err(PlayError::Seek { .. }) => {
                // `advance` finds a keyframe.
                self.follower = Follower::between(&self.session, before, u64::MAX).reading_ahead();
                self.seated = false;
                Ok(())
            }
            other => other.map(drop),
        }
    }

    /// Goes to the state after `tick`, restored from the keyframe before it and stepped silently
    /// from there. Gives the record of that tick, if there is one (before the first there is none).
    /// What cannot be reached leaves the place as it was.
    pub fn seek(&mut self, tick: u64) -> Result<Option<TickRecord>, PlayError> {
        let refuse = |reason: String| Err(PlayError::Seek { tick, reason });
        let (first, last) = self.range;
        if tick > last || tick.saturating_add(1) < first {
            return refuse(format!("the ticks played are {first} to {last}"));
        }
        // Of the state after a reset only the tick after it is known.
        let fits = |keyframe: &Keyframe| keyframe.tick < tick || keyframe.commands == 0;
        let Some((place, keyframe)) = last_keyframe_until(&self.session, tick, fits)? else {
            return refuse("no state is known at or before it".into());
        };
        if !self.all_there(place, keyframe.tick, tick)? {
            return refuse(format!(
                "ticks are missing between it and the last known state, {}",
                keyframe.tick
            ));
        }
        self.restore(keyframe.tick, &keyframe.saved)?;
        self.follower = Follower::at(&self.session, place).reading_ahead();
        // The keyframe itself.
        let _ = self.follower.next();
        let mut record = None;
        while self.state().tick < tick {
            match self.advance()? {
                Advance::Tick(played) => record = Some(played),
                Advance::Gap { .. } | Advance::End => break,
            }
        }
        Ok(match record {
            None if self.state().tick == keyframe.tick => self.record_of(tick)?,
            record => record,
        })
    }

    /// The record of a tick as it is in the file.
    fn record_of(&self, tick: u64) -> Result<Option<TickRecord>, PlayError> {
        let mut records = Follower::between(&self.session, tick, tick).only(&[Topic::Tick]);
        Ok(match records.next().transpose()? {
            Some(Happening::Tick(record)) => Some(*record),
            _ => None,
        })
    }

    /// Is every tick after `from` up to `to` there, from a place on?
    fn all_there(&self, place: Place, from: u64, to: u64) -> Result<bool, PlayError> {
        let mut last = from;
        let mut ticks = Follower::at(&self.session, place).only(&[Topic::Tick]);
        while last < to {
            match ticks.next().transpose()? {
                Some(happening) if happening.tick() == last + 1 => last += 1,
                // A tick that is there twice is played once.
                Some(happening) if happening.tick() <= last => {}
                _ => return Ok(false),
            }
        }
        Ok(true)
    }

    /// Tick of the last keyframe before the newest tick, so that going back again and again gets to
    /// the start.
    pub fn keyframe_before(&self) -> Result<Option<u64>, PlayError> {
        let (now, first) = (self.state().tick, self.range.0);
        let usable =
            |k: &Keyframe| k.tick < now && k.tick.saturating_add(1) >= first && k.commands == 0;
        let found = last_keyframe_until(&self.session, now, usable)?;
        Ok(found.map(|(_, keyframe)| keyframe.tick))
    }

    /// One tick on.
    pub fn advance(&mut self) -> Result<Advance, PlayError> {
        let after = self.state().tick;
        // A keyframe that is not of the newest tick: where play may go on after a gap.
        let mut ahead: Option<(Place, u64)> = None;
        loop {
            let place = self.follower.place();
            let Some(happening) = self.follower.next().transpose()? else {
                return Ok(Advance::End);
            };
            match happening {
                Happening::Tick(record) => {
                    let tick = record.output.tick;
                    // A tick that is there twice is played once.
                    if tick
                        <= if self.seated {
                            after
                        } else {
                            self.range.0.saturating_sub(1)
                        }
                    {
                        continue;
                    }
                    if tick > self.range.1 {
                        self.follower.step_back();
                        return Ok(Advance::End);
                    }
                    if self.seated && Some(tick) == after.checked_add(1) {
                        let output = self.take(&record)?;
                        return Ok(Advance::Tick(TickRecord { output, ..*record }));
                    }
                    if let Some((place, to)) =
                        ahead.filter(|(_, to)| Some(tick) == to.checked_add(1))
                    {
                        return self.jump(place, after, to);
                    }
                }
                Happening::Keyframe(keyframe) if !self.seated || keyframe.tick > after => {
                    ahead = Some((place, keyframe.tick));
                }
                Happening::Command(after_tick, command)
                    if self.seated && after_tick <= after && ahead.is_none() =>
                {
                    self.rerun.command(command);
                }
                _ => {}
            }
        }
    }

    /// Over a gap, to a keyframe.
    fn jump(&mut self, place: Place, after: u64, to: u64) -> Result<Advance, PlayError> {
        self.follower.go(place);
        while let Some(happening) = self.follower.next().transpose()? {
            if let Happening::Keyframe(keyframe) = happening
                && keyframe.tick == to
            {
                self.restore(to, &keyframe.saved)?;
                return Ok(Advance::Gap { after, to });
            }
        }
        Ok(Advance::End)
    }

    /// Takes the state of a keyframe.
    fn restore(&mut self, tick: u64, saved: &SavedState) -> Result<(), PlayError> {
        self.rerun
            .seat(saved)
            .map_err(|source| PlayError::State { tick, source })?;
        let value = self.state().tick;
        if value != tick {
            let what = "tick of a keyframe";
            let source = StateError::Value { what, value };
            return Err(PlayError::State { tick, source });
        }
        self.seated = true;
        Ok(())
    }

    /// Steps over a record; gives its output, with what was recorded where they part.
    fn take(&mut self, record: &TickRecord) -> Result<TickOutput, PlayError> {
        let tick = record.output.tick;
        let stepped = self.rerun.tick(&record.input);
        if same(&stepped, &record.output, self.rerun.scene().tool_count()) {
            return Ok(stepped);
        }
        self.diverged.get_or_insert(tick);
        // What was felt wins; what the recording does not hold (all contacts) is ours. The state
        // comes back at keyframes.
        while let Some(happening) = self.follower.next().transpose()? {
            match happening {
                Happening::Net(_)
                | Happening::Event(_)
                | Happening::Inputs(_)
                | Happening::Other(_) => {}
                Happening::Keyframe(keyframe)
                    if keyframe.tick == tick && keyframe.commands == 0 =>
                {
                    // Of another layout: our own state goes on.
                    let _ = self.restore(tick, &keyframe.saved);
                    break;
                }
                _ => {
                    self.follower.step_back();
                    break;
                }
            }
        }
        Ok(TickOutput {
            contacts: stepped.contacts,
            ..record.output.clone()
        })
    }
}

/// Equal states, and forces equal by bits.
fn same(stepped: &TickOutput, recorded: &TickOutput, tools: usize) -> bool {
    let bits = |output: &TickOutput, t: usize| {
        let tool = &output.tools[t];
        [tool.force_n, tool.torque_nm].map(|v| [v.x, v.y, v.z].map(f64::to_bits))
    };
    stepped.state_hash == recorded.state_hash
        && (0..tools).all(|t| bits(stepped, t) == bits(recorded, t))
}
