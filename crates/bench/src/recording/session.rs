//! A scene whose tools are moved, with a recorder.

use palpate_client::device::Motion;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_geometry::math::{Point3, Rotation, Vector3, state_hash};
use palpate_record::{Recorder, RecorderPort, RecorderSettings, RecordingSummary};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::spec::RecordSpec;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{TickInput, TickOutput, TickRecord};
use palpate_sim::tick::step;
use palpate_sim::tick::{SceneState, Scratch};
use palpate_wire as wire;
use std::path::Path;
use std::sync::atomic::Ordering;

/// One tool, one body of 8 × 8 control points.
pub(super) const TEARDROP: &str = include_str!("../../../../scenes/teardrop.toml");
/// The same body, rigid.
pub(super) const RIGID: &str = include_str!("../../../../scenes/rigid-teardrop.toml");
/// Four tools, three bodies, two of them soft.
pub(super) const FOUR_HANDS: &str = include_str!("../../../../scenes/four-hands.toml");

/// A scene at work.
pub(super) struct Simulated {
    pub scene: Scene,
    pub state: SceneState,
    scratch: Scratch,
    text: String,
    motions: Vec<Motion>,
    noise: u64,
}

impl Simulated {
    /// One of our scenes, each tool sliding over the body nearest to it.
    pub fn new(text: &str, change: impl FnOnce(&mut RecordSpec)) -> anyhow::Result<Self> {
        let mut loaded = file::parse(text, "bench.toml", Path::new("."))?;
        change(&mut loaded.spec.record);
        let scene = Scene::build(&loaded.spec, Path::new("."))?;
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        let snapshot = wire::scene_snapshot(
            &scene,
            [0; 32],
            &wire::all_nets(&scene, &state),
            &TickOutput::default(),
        );
        let motions = (0..scene.tool_count())
            .map(|tool| Motion::named("slide", &snapshot, scene.tool_id(tool), 0.004))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            scene,
            state,
            scratch,
            text: text.to_owned(),
            motions,
            noise: 1,
        })
    }

    /// Some micrometres, as a sensor has them.
    fn tremor(&mut self) -> f64 {
        self.noise = self
            .noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 1e-5
    }

    /// The next tick.
    pub fn tick(&mut self) -> TickRecord {
        let seq = self.state.tick + 1;
        let mut input = TickInput::default();
        for tool in 0..self.motions.len() {
            let at = |t: f64| Vector3::from(self.motions[tool].goal(t).position);
            let t = seq as f64 * self.scene.dt_s;
            let (now, before) = (at(t), at(t - self.scene.dt_s));
            let tremor = Vector3::new(self.tremor(), self.tremor(), self.tremor());
            input.poses[tool] = Some(DevicePose {
                seq,
                t_client_ns: seq * 1_000_000,
                position: Point3::from(now + tremor),
                orientation: Rotation::identity(),
                linear_velocity: (now - before) / self.scene.dt_s,
                angular_velocity: Vector3::zeros(),
                buttons: 0,
            });
        }
        let output = step(&self.scene, &mut self.state, &mut self.scratch, &input);
        // As a loop would have them: noise in the last bits of every number.
        let jitter = (self.noise >> 40) as u32 % 5_000;
        let stage_ns = [
            200 + jitter / 50,
            20_000 + jitter,
            100_000 + 2 * jitter,
            50_000 + jitter,
            2_000 + jitter / 3,
        ]
        .into();
        TickRecord {
            input,
            output,
            late_ns: u64::from(jitter) * 4,
            stage_ns,
            ..TickRecord::default()
        }
    }

    /// A recorder of its own; `change` says more.
    pub fn recorder(
        &self,
        change: impl FnOnce(RecorderSettings) -> RecorderSettings,
    ) -> anyhow::Result<(Recorder, RecorderPort)> {
        let settings = change(RecorderSettings::new(&self.text, &self.scene.spec));
        let (recorder, mut port) = Recorder::start(settings, &self.scene)?;
        port.keyframe(&self.state, state_hash(&self.state));
        Ok((recorder, port))
    }

    /// Records so many ticks, as fast as they come.
    pub fn record(&mut self, path: &Path, ticks: u64) -> anyhow::Result<RecordingSummary> {
        let (recorder, mut port) = self.recorder(|settings| settings.to(path))?;
        let mut nets = NetPool::new(&self.scene, port.nets_held());
        let gauges = recorder.gauges();
        let written = || gauges.bytes.load(Ordering::Relaxed);
        for _ in 0..ticks {
            let before = written();
            let record = self.tick();
            nets.begin();
            port.tick(&self.scene, &self.state, &record, &mut nets);
            // A loop gives its recorder a second for a second. Here it gets as long as it takes to
            // write something: its rings hold eight times as much.
            while record.output.tick.is_multiple_of(1_000) && written() == before {
                std::thread::sleep(std::time::Duration::from_micros(500));
            }
        }
        drop(port);
        let summary = recorder.finish().last()?;
        anyhow::ensure!(
            summary.dropped == 0,
            "{} records were lost: the disk is slower than the simulation",
            summary.dropped
        );
        Ok(summary)
    }
}
