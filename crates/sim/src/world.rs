//! A scene that runs, tick by tick, as fast as it is asked to: what experiments, tests and benchmarks have in common.

use crate::haptics::DevicePose;
use crate::scene::{Scene, SceneError, file};
use crate::tick::record::{Command, TickOutput, TickRecord};
use crate::tick::stage::Stage;
use crate::tick::{SceneState, Scratch, apply, deform, hash, render, step_into};
use std::path::Path;
use std::sync::Arc;

/// A scene with its state, and a record that each tick is read from and written to.
///
/// ```
/// let mut world = palpate_sim::World::parse(
///     r#"
///     [[body]]
///     id = "ball"
///     surface = { builtin = "sphere", size = 0.02 }
///     [[tool]]
///     id = "probe"
///     shape = { sphere = { radius_m = 0.01 } }
///     pose = { position = [0.0, 0.0, 0.04] }
///     coupling = { stiffness_n_m = 500.0, damping_n_s_m = 0.0 }
///     device = { ramp_s = 0.0 }
///     "#,
/// )?;
/// for k in 0..120 {
///     world.at([0.0, 0.0, 0.03 - 1e-4 * f64::from(k.min(20))]);
/// }
/// // 500 N/m × 2 mm.
/// assert!((world.record.output.tools[0].force_n.z - 1.0).abs() < 1e-9);
/// # Ok::<(), palpate_sim::scene::SceneError>(())
/// ```
pub struct World {
    /// What runs.
    pub scene: Arc<Scene>,
    /// As it is after the last tick.
    pub state: SceneState,
    /// What ticks work in.
    pub scratch: Scratch,
    /// Number of the last pose.
    pub seq: u64,
    /// Poses of the next tick, and what the last one gave.
    pub record: TickRecord,
}

impl World {
    /// A scene at its start.
    pub fn start(scene: impl Into<Arc<Scene>>) -> Self {
        let scene = scene.into();
        let state = scene.initial_state();
        Self {
            scratch: scene.scratch(&state),
            state,
            seq: 0,
            record: TickRecord::for_tools(scene.tool_count()),
            scene,
        }
    }

    /// The scene of a text in TOML, at its start. Files that it names are looked for in the working directory.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        Self::of(&file::parse(text, "scene.toml", Path::new("."))?)
    }

    /// The scene of a file, at its start.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn of(loaded: &file::Loaded) -> Result<Self, SceneError> {
        loaded.build().map(Self::start)
    }

    /// Carries out a command before the next tick.
    pub fn apply(&mut self, command: Command) {
        apply(&self.scene, &mut self.state, &mut self.scratch, command);
    }

    /// One tick with the poses of the record. Allocates nothing.
    pub fn tick(&mut self) -> &TickOutput {
        let TickRecord { input, output, .. } = &mut self.record;
        step_into(
            &self.scene,
            &mut self.state,
            &mut self.scratch,
            input,
            output,
        );
        output
    }

    /// As [`World::tick`]; `done` hears of each stage when it is, so that it can look at a clock.
    pub fn staged(&mut self, mut done: impl FnMut(Stage)) -> &TickOutput {
        let Self {
            scene,
            state,
            scratch,
            record: TickRecord { input, output, .. },
            ..
        } = self;
        render(scene, state, scratch, input, output);
        done(Stage::Render);
        deform(scene, state, scratch, output);
        done(Stage::Deform);
        hash(state, output);
        done(Stage::Hash);
        output
    }

    /// Puts poses in the record, of the first tools in their order; the others send none. Poses get the next number.
    pub fn take(&mut self, poses: impl IntoIterator<Item = DevicePose>) {
        self.seq += 1;
        let seq = self.seq;
        self.record.input.poses.reset(self.scene.tool_count());
        for (tool, pose) in poses.into_iter().enumerate() {
            self.record.input.poses[tool] = Some(DevicePose { seq, ..pose });
        }
    }

    /// As [`World::posed`]. Allocates nothing.
    pub fn posed_in_place(&mut self, pose: DevicePose) -> &TickOutput {
        self.take([pose]);
        self.tick()
    }

    /// As [`World::at`]. Allocates nothing.
    pub fn at_in_place(&mut self, position: [f64; 3]) -> &TickOutput {
        self.posed_in_place(DevicePose::at_rest(position))
    }

    /// As [`World::all`]. Allocates nothing.
    pub fn all_in_place(&mut self, tools: &[([f64; 3], u32)]) -> &TickOutput {
        self.take(tools.iter().map(|&(position, buttons)| DevicePose {
            buttons,
            ..DevicePose::at_rest(position)
        }));
        self.tick()
    }

    /// As [`World::silent`]. Allocates nothing.
    pub fn silent_in_place(&mut self) -> &TickOutput {
        self.record.input.poses.reset(self.scene.tool_count());
        self.tick()
    }

    /// One tick with the first tool in a pose.
    pub fn posed(&mut self, pose: DevicePose) -> TickOutput {
        self.posed_in_place(pose).clone()
    }

    /// One tick with the first tool at a place.
    pub fn at(&mut self, position: [f64; 3]) -> TickOutput {
        self.at_in_place(position).clone()
    }

    /// One tick with the first tools at places, with their buttons.
    pub fn all(&mut self, tools: &[([f64; 3], u32)]) -> TickOutput {
        self.all_in_place(tools).clone()
    }

    /// One tick without news of any tool.
    pub fn silent(&mut self) -> TickOutput {
        self.silent_in_place().clone()
    }

    /// [`World::at`] after so many dropped deadlines.
    pub fn late(&mut self, skipped: u32, position: [f64; 3]) -> TickOutput {
        self.record.input.skipped = skipped;
        let output = self.at(position);
        self.record.input.skipped = 0;
        output
    }
}
