//! A simulation that keeps a journal, as the daemon's loop does.
#![allow(dead_code)]

use crate::common::pose;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_geometry::math::{Vector3, state_hash};
use palpate_record::{Recorder, RecorderPort, RecorderSettings, RecordingReport, RecordingSummary};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use palpate_sim::tick::{SceneState, Scratch};
use palpate_sim::tick::{apply, step_into};
use std::path::Path;
use std::time::{Duration, Instant};

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
pub fn poses(tick: u64, tools: usize, input: &mut TickInput) {
    input.poses.reset(tools);
    if tick % 10 == 9 {
        return;
    }
    let phase = std::f64::consts::TAU * tick as f64 / 500.0;
    let press = 0.5 - 0.5 * phase.cos();
    let speed = Vector3::new(-0.1 * phase.sin(), -0.0, 0.0);
    let places = [
        [0.06 - 0.036 * press, 0.003, 0.045],
        [0.002, -0.0, -0.17 - 0.035 * press],
    ];
    for (tool, place) in places.into_iter().enumerate().take(tools) {
        input.poses[tool] = Some(DevicePose {
            t_client_ns: tick * 1_000_000,
            linear_velocity: speed,
            ..pose(tick, place)
        });
    }
}

/// A simulation that keeps a journal, as the daemon's loop does.
pub struct Live {
    pub scene: Scene,
    pub state: SceneState,
    pub scratch: Scratch,
    pub recorder: Recorder,
    pub port: RecorderPort,
    pub nets: NetPool,
    pub records: Vec<TickRecord>,
    /// Room for further records, for tests that count allocations.
    pub spare: Vec<TickRecord>,
    /// Ticks wait until the recorder has room. Off where a test wants losses.
    pub keeps_pace: bool,
    record: TickRecord,
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
        let nets = NetPool::new(&scene, port.nets_held());
        let record = TickRecord::for_tools(scene.tool_count());
        Self {
            scene,
            state,
            scratch,
            recorder,
            port,
            nets,
            records: Vec::new(),
            spare: Vec::new(),
            keeps_pace: true,
            record,
        }
    }

    pub fn tick(&mut self) {
        let Self {
            scene,
            state,
            scratch,
            record,
            ..
        } = self;
        poses(state.tick + 1, scene.tool_count(), &mut record.input);
        record.input.skipped = u32::from(state.tick == 2);
        step_into(scene, state, scratch, &record.input, &mut record.output);
        let tick = record.output.tick;
        record.late_ns = 7;
        record.stage_ns = [1, 20_000, 250_000, 50_000, 4_000].into();
        self.nets.begin();
        self.port.tick(scene, state, record, &mut self.nets);
        let mut kept = self.spare.pop().unwrap_or_default();
        kept.clone_from(record);
        self.records.push(kept);
        // A disk has a second for a second; a test runs faster than its recorder may write.
        if tick.is_multiple_of(100) {
            std::thread::sleep(Duration::from_millis(10));
            let waits = Instant::now();
            while self.keeps_pace && !self.port.has_room() {
                assert!(
                    waits.elapsed() < Duration::from_secs(60),
                    "nothing is written"
                );
                std::thread::sleep(Duration::from_millis(1));
            }
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
    let mut record = record.clone();
    // A replay makes these again; a recording has the deepest of each tool.
    record.output.contacts = Default::default();
    for tool in record.output.tools.as_mut_slice() {
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
