//! A simulation that follows a session: from a keyframe on, the recorded inputs and commands, one
//! tick after the other.

use super::super::reader::{Keyframe, Session};
use super::ReplayError;
use palpate_geometry::math::state_hash;
use palpate_sim::scene::spec::SceneSpec;
use palpate_sim::scene::{Scene, SceneState, Scratch};
use palpate_sim::tick::record::{Command, TickInput, TickOutput};
use palpate_sim::tick::{apply, restore, step};
use std::path::Path;

/// Builds the scene that a session holds.
///
/// # Errors
/// A scene that this program cannot read or build.
pub fn recorded_scene(session: &Session) -> Result<Scene, ReplayError> {
    let spec: SceneSpec = toml::from_str(&session.header.effective_scene)
        .map_err(|e| ReplayError::SceneText(e.to_string()))?;
    Ok(Scene::build(&spec, Path::new("."))?)
}

/// See above.
pub struct Follower<'a> {
    scene: &'a Scene,
    session: &'a Session,
    state: SceneState,
    scratch: Scratch,
    /// Not applied yet.
    commands: &'a [(u64, Command)],
}

impl<'a> Follower<'a> {
    /// At the scene's own start.
    pub fn new(scene: &'a Scene, session: &'a Session) -> Self {
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        Self {
            scene,
            session,
            state,
            scratch,
            commands: &session.commands,
        }
    }

    /// Takes the state of a keyframe; gives its hash as it is after that.
    ///
    /// # Errors
    /// The state is of another scene.
    pub fn seat(&mut self, keyframe: &Keyframe) -> Result<u64, ReplayError> {
        restore(
            self.scene,
            &mut self.state,
            &mut self.scratch,
            &keyframe.saved,
        )
        .map_err(|source| ReplayError::State {
            tick: keyframe.tick,
            source,
        })?;
        let commands = &self.session.commands;
        let first = commands.partition_point(|(after, _)| *after < keyframe.tick);
        let end = commands.partition_point(|(after, _)| *after <= keyframe.tick);
        // Those up to a reset are in the state already.
        self.commands = &commands[end.min(first.saturating_add(keyframe.commands as usize))..];
        Ok(state_hash(&self.state))
    }

    /// Commands that act before tick `tick`, then one tick.
    pub fn tick(&mut self, tick: u64, input: &TickInput) -> TickOutput {
        while let Some(((_, command), rest)) = self
            .commands
            .split_first()
            .filter(|((after, _), _)| *after < tick)
        {
            apply(self.scene, &mut self.state, &mut self.scratch, *command);
            self.commands = rest;
        }
        step(self.scene, &mut self.state, &mut self.scratch, input)
    }

    /// Goes to the state of a keyframe of this very tick by the commands that it holds; gives the
    /// hash there. `done` are the commands of this tick that were applied so far.
    pub fn reach(&mut self, keyframe: &Keyframe, done: &mut u32) -> u64 {
        while *done < keyframe.commands {
            let Some(((_, command), rest)) = self
                .commands
                .split_first()
                .filter(|((after, _), _)| *after == keyframe.tick)
            else {
                break;
            };
            apply(self.scene, &mut self.state, &mut self.scratch, *command);
            (self.commands, *done) = (rest, *done + 1);
        }
        state_hash(&self.state)
    }

    /// The state now.
    pub fn state(&self) -> &SceneState {
        &self.state
    }

    /// The scene.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }
}
