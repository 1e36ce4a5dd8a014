//! A place in a recording, with the state that belongs to it.

use super::PlayError;
use crate::recording::reader::{Keyframe, Session};
use palpate_geometry::math::{SavedState, StateError};
use palpate_sim::scene::{Scene, SceneState, Scratch};
use palpate_sim::tick::record::{Command, TickOutput, TickRecord};
use palpate_sim::tick::{apply, restore, step};
use std::sync::Arc;

/// What came next. Lives for a moment on the stack: its size costs less than a box.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Next {
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
    scene: Arc<Scene>,
    pub state: SceneState,
    scratch: Scratch,
    /// Ticks to play: first and last.
    range: (u64, u64),
    /// Index of the next record.
    next: usize,
    /// Index of the next command.
    command: usize,
    /// The state is what the next record needs.
    seated: bool,
    /// First tick whose output was not the recorded one.
    pub diverged: Option<u64>,
}

impl Cursor {
    /// Stands before the first tick to play.
    pub fn new(
        session: Session,
        scene: Arc<Scene>,
        start: Option<u64>,
        end: Option<u64>,
    ) -> Result<Self, PlayError> {
        let tick_of = |record: Option<&TickRecord>| record.map(|record| record.output.tick);
        let path = session.path.clone();
        let (Some(first), Some(last)) = (
            tick_of(session.ticks.first()),
            tick_of(session.ticks.last()),
        ) else {
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
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        let mut cursor = Self {
            session,
            scene,
            state,
            scratch,
            range,
            next: 0,
            command: 0,
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

    /// Back before the first tick to play. Where no state is known for it, to the first one after
    /// it.
    pub fn rewind(&mut self) -> Result<(), PlayError> {
        let first = self.index_from(self.range.0);
        (self.next, self.seated) = (first, false);
        let tick = self.range.0.saturating_sub(1);
        match self.seek(tick) {
            Err(PlayError::Seek { .. }) => {
                // `advance` finds a keyframe.
                (self.next, self.seated) = (first, false);
                Ok(())
            }
            other => other.map(drop),
        }
    }

    /// Index of the first record after a tick.
    fn after(&self, tick: u64) -> usize {
        self.session
            .ticks
            .partition_point(|record| record.output.tick <= tick)
    }

    /// Index of the first record at or after a tick.
    fn index_from(&self, tick: u64) -> usize {
        self.session
            .ticks
            .partition_point(|record| record.output.tick < tick)
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
        let fits = |keyframe: &&Keyframe| {
            keyframe.tick < tick || (keyframe.tick == tick && keyframe.commands == 0)
        };
        let Some(keyframe) = self.session.keyframes.iter().rev().find(fits) else {
            return refuse("no state is known at or before it".into());
        };
        let (from, to) = (self.after(keyframe.tick), self.after(tick));
        if (to - from) as u64 != tick - keyframe.tick {
            return refuse(format!(
                "ticks are missing between it and the last known state, {}",
                keyframe.tick
            ));
        }
        let (key_tick, commands, saved) =
            (keyframe.tick, keyframe.commands, keyframe.saved.clone());
        self.restore(key_tick, commands, &saved)?;
        let record = to
            .checked_sub(1)
            .map(|at| self.session.ticks[at].clone())
            .filter(|record| record.output.tick == tick);
        let mut output = None;
        for at in from..to {
            output = Some(self.take(at));
        }
        self.next = to;
        Ok(record.map(|record| TickRecord {
            output: output.unwrap_or(record.output),
            ..record
        }))
    }

    /// Tick of the last keyframe before the newest tick, so that going back again and again gets to
    /// the start.
    pub fn keyframe_before(&self) -> Option<u64> {
        let (now, first) = (self.state.tick, self.range.0);
        let usable =
            |k: &&Keyframe| k.tick < now && k.tick.saturating_add(1) >= first && k.commands == 0;
        self.session
            .keyframes
            .iter()
            .rev()
            .find(usable)
            .map(|keyframe| keyframe.tick)
    }

    /// One tick on.
    pub fn advance(&mut self) -> Result<Next, PlayError> {
        // A tick that is there twice is played once.
        if self.seated {
            self.next = self.next.max(self.after(self.state.tick));
        }
        let record = self.session.ticks.get(self.next);
        let Some(tick) = record
            .map(|record| record.output.tick)
            .filter(|tick| *tick <= self.range.1)
        else {
            return Ok(Next::End);
        };
        if self.seated && Some(tick) == self.state.tick.checked_add(1) {
            let at = self.next;
            let output = self.take(at);
            self.next += 1;
            let record = &self.session.ticks[at];
            return Ok(Next::Tick(TickRecord {
                input: record.input.clone(),
                output,
                ..*record
            }));
        }
        let after = self.state.tick;
        let follows = |keyframe: &&Keyframe| {
            let Some(next) = keyframe.tick.checked_add(1).filter(|next| *next >= tick) else {
                return false;
            };
            self.session
                .ticks
                .get(self.index_from(next))
                .is_some_and(|record| record.output.tick == next)
        };
        let Some(keyframe) = self
            .session
            .keyframes
            .iter()
            .find(follows)
            .filter(|k| k.tick < self.range.1)
        else {
            self.next = self.session.ticks.len();
            return Ok(Next::End);
        };
        let (to, commands, saved) = (keyframe.tick, keyframe.commands, keyframe.saved.clone());
        self.restore(to, commands, &saved)?;
        self.next = self.after(to);
        Ok(Next::Gap { after, to })
    }

    /// Takes the state of a keyframe, and finds the first command that it does not hold.
    fn restore(&mut self, tick: u64, held: u32, saved: &SavedState) -> Result<(), PlayError> {
        restore(&self.scene, &mut self.state, &mut self.scratch, saved)
            .map_err(|source| PlayError::State { tick, source })?;
        if self.state.tick != tick {
            let source = StateError::Value {
                what: "tick of a keyframe",
                value: self.state.tick,
            };
            return Err(PlayError::State { tick, source });
        }
        let commands = &self.session.commands;
        let first = commands.partition_point(|(after, _)| *after < tick);
        let end = commands.partition_point(|(after, _)| *after <= tick);
        self.command = end.min(first + held as usize);
        self.seated = true;
        Ok(())
    }

    /// Steps over the record at an index; gives its output, with what was recorded where they part.
    fn take(&mut self, at: usize) -> TickOutput {
        let record = self.session.ticks[at].clone();
        let tick = record.output.tick;
        while let Some(&(_, command)) = self
            .session
            .commands
            .get(self.command)
            .filter(|(after, _)| *after < tick)
        {
            self.apply(command);
            self.command += 1;
        }
        let stepped = step(
            &self.scene,
            &mut self.state,
            &mut self.scratch,
            &record.input,
        );
        if same(&stepped, &record.output, self.scene.tool_count()) {
            return stepped;
        }
        if self.diverged.is_none() {
            self.diverged = Some(tick);
        }
        // What was felt wins; what the recording does not hold (all contacts) is ours. The state
        // comes back at keyframes.
        let keyframe = self
            .session
            .keyframes
            .iter()
            .find(|k| k.tick == tick && k.commands == 0);
        if let Some(saved) = keyframe.map(|keyframe| keyframe.saved.clone()) {
            // Of another layout: our own state goes on.
            let _ = self.restore(tick, 0, &saved);
        }
        TickOutput {
            contacts: stepped.contacts,
            ..record.output
        }
    }

    fn apply(&mut self, command: Command) {
        apply(&self.scene, &mut self.state, &mut self.scratch, command);
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
