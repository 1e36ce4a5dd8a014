//! The inputs of a session, one after the other, with a simulation at its start.

use super::super::channel::{Happening, Topic};
use super::super::reader::{Follower, Place, Session, first_keyframe};
use super::super::replay::{ReplayError, recorded_scene};
use super::super::rerun::Rerun;
use super::error::RunError;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{Command, TickInput};
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Arc;

/// Where a simulation began.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// With the state of the first keyframe.
    Keyframe,
    /// With the scene's own start.
    Scene {
        /// Why the first keyframe does not fit this version, if there is one.
        reason: Option<String>,
    },
}

/// Something that goes into a session.
pub(in super::super) enum Input {
    /// Into a tick.
    Tick(u64, TickInput),
    /// After a tick.
    Command(u64, Command),
}

/// A session about to be run: each input goes into `rerun` before the next is asked for.
pub(in super::super) struct InputRun {
    pub scene: Arc<Scene>,
    pub rerun: Rerun,
    pub start: Start,
    /// First keyframe, or 0: what comes up to it is in the state.
    begun: u64,
    /// Newest tick that was given.
    tick: u64,
    follower: Follower,
    waiting: VecDeque<Input>,
}

impl InputRun {
    /// At the start of a session.
    ///
    /// # Errors
    /// A scene that does not build, no keyframe, or one that does not fit this version in a session
    /// that does not begin at tick 0.
    pub fn of(session: &Session) -> Result<Self, RunError> {
        let scene = Arc::new(recorded_scene(session)?);
        let mut rerun = Rerun::new(&scene);
        let (mut start, mut place) = (Start::Scene { reason: None }, Place::default());
        let mut begun = 0;
        match first_keyframe(session)? {
            None if session.holds_inputs_only() => {}
            None => {
                let (from, first) = (0, None);
                return Err(ReplayError::NoKeyframe { from, first }.into());
            }
            Some((at, keyframe)) => {
                begun = keyframe.tick;
                // A state of another version may have another size, or fit and mean something else:
                // then its hash is another.
                let unfit = match rerun.seat(&keyframe.saved) {
                    Ok(hash) if hash == keyframe.state_hash => None,
                    Ok(hash) => Some(format!(
                        "its state has the hash {hash:016x}, not {:016x}",
                        keyframe.state_hash
                    )),
                    Err(source) => {
                        let tick = begun;
                        Some(ReplayError::State { tick, source }.to_string())
                    }
                };
                match unfit {
                    None => (start, place) = (Start::Keyframe, at),
                    Some(reason) if begun > 0 => {
                        let tick = begun;
                        return Err(RunError::Start { tick, reason });
                    }
                    reason => {
                        rerun = Rerun::new(&scene);
                        start = Start::Scene { reason };
                    }
                }
            }
        }
        let topics = &[Topic::Tick, Topic::Command, Topic::Inputs];
        Ok(Self {
            scene,
            rerun,
            start,
            begun,
            tick: begun,
            follower: Follower::at(session, place).only(topics),
            waiting: VecDeque::new(),
        })
    }

    fn read(&mut self) -> Option<Result<(), RunError>> {
        match self.follower.next()? {
            Ok(Happening::Tick(record)) => {
                let tick = record.output.tick;
                self.waiting.push_back(Input::Tick(tick, record.input));
            }
            Ok(Happening::Command(after_tick, command)) => {
                self.waiting.push_back(Input::Command(after_tick, command));
            }
            Ok(Happening::Inputs(block)) => {
                let commands = block.commands.into_iter();
                let ticks = (block.tick..).zip(block.ticks);
                self.waiting.extend(
                    commands.map(|(after_tick, command)| Input::Command(after_tick, command)),
                );
                self.waiting
                    .extend(ticks.map(|(tick, input)| Input::Tick(tick, input)));
            }
            Ok(_) => {}
            Err(error) => return Some(Err(error.into())),
        }
        Some(Ok(()))
    }
}

impl Iterator for InputRun {
    type Item = Result<Input, RunError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.waiting.pop_front() {
                None => {
                    if let Err(error) = self.read()? {
                        return Some(Err(error));
                    }
                }
                Some(Input::Tick(tick, _)) if tick <= self.begun => {}
                Some(Input::Command(after_tick, _)) if after_tick > self.tick => {}
                Some(input) => {
                    if let Input::Tick(tick, _) = input {
                        self.tick = self.tick.saturating_add(1);
                        if tick != self.tick {
                            return Some(Err(RunError::Gap { tick: self.tick }));
                        }
                    }
                    return Some(Ok(input));
                }
            }
        }
    }
}
