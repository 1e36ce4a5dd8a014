//! A simulation that keeps a journal, as the daemon's loop does.
#![allow(dead_code)]

use crate::common::pose;
use palpate::drive::journal::Journal;
use palpate::recording::{
    Recorder, RecorderPort, RecorderSettings, RecordingReport, RecordingSummary,
};
use palpate_geometry::math::{Vector3, state_hash};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, SceneState, Scratch, file};
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use palpate_sim::tick::{apply, step};
use std::path::Path;
use std::time::Duration;

/// Presses of 6 mm every half second.
pub const RIGID: &str = r#"
name = "rigid-teardrop"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }
[record]
keyframe_s = 0.2
"#;

/// A soft drop and a soft sheet below it, a ball for the one and a pen for the other.
pub const SOFT: &str = r#"
name = "two-soft"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }
model = "lattice"
lattice = { layers = 2, refine = [12, 13] }
fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]
[[body]]
id = "sheet"
surface = { builtin = "sheet", net = [6, 6], size = 0.1 }
pose = { position = [0.0, 0.0, -0.2] }
model = "lattice"
lattice = { layers = 2, thickness_m = 0.01, refine = "none" }
fixed = [
  { point = [-0.048, 0.0, 0.0], normal = [1.0, 0.0, 0.0] },
  { point = [0.048, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] },
]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
[[tool]]
id = "pen"
shape = { point = {} }
pose = { position = [0.0, 0.0, -0.17] }
[record]
keyframe_s = 0.1
"#;

/// Poses of tick `tick`: the first tool presses from the side, the second from above; every 10th
/// tick brings no news.
pub fn poses(tick: u64, tools: usize) -> TickInput {
    let mut input = TickInput::default();
    if tick % 10 == 9 {
        return input;
    }
    let phase = std::f64::consts::TAU * tick as f64 / 500.0;
    let press = 0.5 - 0.5 * phase.cos();
    let speed = Vector3::new(-0.1 * phase.sin(), -0.0, 0.0);
    let places = [
        [0.06 - 0.036 * press, 0.003, 0.045],
        [0.002, -0.0, -0.17 - 0.035 * press],
    ];
    for (slot, place) in input.poses.iter_mut().zip(places).take(tools) {
        *slot = Some(DevicePose {
            t_client_ns: tick * 1_000_000,
            linear_velocity: speed,
            ..pose(tick, place)
        });
    }
    input
}

/// A simulation that keeps a journal, as the daemon's loop does.
pub struct Live {
    pub scene: Scene,
    pub state: SceneState,
    pub scratch: Scratch,
    pub recorder: Recorder,
    pub port: RecorderPort,
    pub records: Vec<TickRecord>,
}

impl Live {
    pub fn start(path: &Path, text: &str) -> Self {
        Self::with(text, |settings| settings.to(path))
    }

    /// With settings of its own.
    pub fn with(text: &str, change: impl FnOnce(RecorderSettings) -> RecorderSettings) -> Self {
        let loaded =
            file::parse(text, "test.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
        let settings = change(RecorderSettings::new(&loaded.text, &loaded.spec));
        let (recorder, mut port) = Recorder::start(settings, &scene).unwrap();
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        port.keyframe(&state, state_hash(&state));
        Self {
            scene,
            state,
            scratch,
            recorder,
            port,
            records: Vec::new(),
        }
    }

    pub fn tick(&mut self) {
        let input = poses(self.state.tick + 1, self.scene.tool_count());
        let output = step(&self.scene, &mut self.state, &mut self.scratch, &input);
        let stage_ns = [1, 20_000, 250_000, 50_000, 4_000].into();
        let record = TickRecord {
            input,
            output,
            late_ns: 7,
            skipped: u32::from(output.tick == 3),
            stage_ns,
        };
        self.port.tick(&self.scene, &self.state, &record);
        self.records.push(record);
        // A disk has a second for a second; a test runs faster than its recorder may write.
        if output.tick.is_multiple_of(100) {
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn command(&mut self, command: Command) {
        self.port.command(self.state.tick, command);
        apply(&self.scene, &mut self.state, &mut self.scratch, command);
        if command == Command::Reset {
            self.port.keyframe(&self.state, state_hash(&self.state));
        }
    }

    pub fn finish(self) -> (RecordingSummary, Vec<TickRecord>) {
        let (report, records) = self.report();
        (report.last().unwrap(), records)
    }

    pub fn report(self) -> (RecordingReport, Vec<TickRecord>) {
        drop(self.port);
        (self.recorder.finish(), self.records)
    }
}

pub fn record(
    path: &Path,
    text: &str,
    ticks: u64,
    commands: &[(u64, Command)],
) -> (RecordingSummary, Vec<TickRecord>) {
    let mut live = Live::start(path, text);
    for tick in 0..ticks {
        for (_, command) in commands.iter().filter(|(after, _)| *after == tick) {
            live.command(*command);
        }
        live.tick();
    }
    live.finish()
}

/// All bits of a record that are recorded: equality of floats would not tell -0.0 from 0.0, and
/// `Debug` does.
pub fn bits(record: &TickRecord) -> String {
    let mut record = *record;
    // A replay makes these again; a recording has the deepest of each tool.
    record.output.contacts = Default::default();
    for tool in &mut record.output.tools {
        (tool.device_moved, tool.device_turned) = Default::default();
    }
    format!("{record:?}")
}

pub fn in_contact(records: &[TickRecord], tool: usize) -> usize {
    records
        .iter()
        .filter(|record| record.output.tools[tool].contact.is_some())
        .count()
}
