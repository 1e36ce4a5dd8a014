//! Steps on worker threads have the bits of steps on the tick thread.

use crate::common::{Laws as _, World, pose, press};
use palpate_drive::driver::{Driver, DriverSettings};
use palpate_drive::pacer::Wake;
use palpate_drive::ports::{SenderId, ports};
use palpate_drive::workers::Workers;
use palpate_geometry::math::{Point3, SavedState, Vector3, state_hash};
use palpate_record::{RecorderSettings, Session, SteppedRecorder, info, replay};
use palpate_sim::body::{DeformableState, Field};
use palpate_sim::scene::spec::Clock;
use palpate_sim::scene::{file, inline_files};
use palpate_sim::tick::{Pipeline, restore};
use std::path::Path;
use std::sync::Arc;

const BALL: &str = r#"
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.05] }
coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }
device = { force_max_n = 1e9, ramp_s = 0.0 }
"#;

fn slab(model: &str, more: &str) -> String {
    format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [7, 7], size = 0.1 }}
model = "{model}"
lattice = {{ layers = 4, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
{more}
{BALL}"#
    )
}

#[test]
fn a_body_that_steps_every_fourth_tick_has_the_same_bits_on_a_thread() {
    let text = slab("lattice", "integrator = { every = 4 }");
    let (mut here, mut there) = (World::new(&text), World::new(&text));
    let scene = Arc::new(World::new(&text).scene);
    there.scratch.set_pipeline(Box::new(
        Workers::start(&scene)
            .unwrap()
            .expect("a body that steps apart"),
    ));
    let place = |k: u32| {
        [
            0.001 * libm::sin(f64::from(k) * 0.01),
            0.0,
            0.025 - 0.009 * (f64::from(k) / 400.0).min(1.0),
        ]
    };
    let mut saved = SavedState::default();
    for k in 0..1_001 {
        let (a, b) = (here.at(place(k)), there.at(place(k)));
        assert_eq!(a, b, "tick {k}");
        assert_eq!(
            state_hash(&here.state),
            state_hash(&there.state),
            "tick {k}"
        );
        if k == 701 {
            // In the middle of a step.
            saved.save_from(&there.state);
        }
    }
    // From there on anew, while a step of later is still under way on the thread.
    restore(&there.scene, &mut there.state, &mut there.scratch, &saved).unwrap();
    there.seq = 702;
    for k in 702..1_001 {
        there.at(place(k));
    }
    assert_eq!(state_hash(&here.state), state_hash(&there.state));
    // At rest it presses as a body does that steps every tick.
    let mut each = World::new(&slab("lattice", ""));
    let (slow, quick) = (press(&mut here, 0.003, 600), press(&mut each, 0.003, 600));
    assert!(
        (slow / quick - 1.0).abs() < 1e-3,
        "{slow} N every fourth tick, {quick} N every tick"
    );
}

/// Workers whose steps are done only when they have been asked for some times.
#[derive(Debug)]
struct Slow {
    workers: Workers,
    asked: u32,
}

impl Pipeline for Slow {
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    ) {
        self.asked = 0;
        self.workers.start(body, field, state, predicted, loads);
    }

    fn is_ready(&mut self, body: usize) -> bool {
        self.asked += 1;
        if self.asked <= 6 {
            return false;
        }
        // So late and no later, however busy the machine is.
        while !self.workers.is_ready(body) {
            std::thread::yield_now();
        }
        true
    }

    fn finish(
        &mut self,
        body: usize,
        state: &mut DeformableState,
        predicted: &mut [Point3],
    ) -> bool {
        assert!(self.asked > 6, "the tick waits for a late step");
        self.workers.finish(body, state, predicted)
    }

    fn cancel(&mut self) {
        self.workers.cancel();
    }
}

#[test]
fn a_loop_in_real_time_waits_for_no_late_worker_and_its_recording_replays() {
    let text = slab("lattice", "integrator = { every = 4 }");
    let loaded = file::parse(&text, "late.toml", Path::new(".")).unwrap();
    let scene = Arc::new(loaded.build().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("late.mcap");
    let effective = inline_files(&loaded.spec, Path::new(".")).unwrap();
    let settings = RecorderSettings::new(&loaded.text, &effective).to(&path);
    let (mut recorder, port) = SteppedRecorder::new(settings, &scene).unwrap();
    let (tick_ports, mut bus) = ports(&scene);
    let settings = DriverSettings {
        clock: Clock::Realtime,
        ticks: None,
        privileged: false,
        follow: false,
        threads: 1,
    };
    // A clock that stands still: nothing overruns.
    let mut driver = Driver::new(scene.clone(), tick_ports, Box::new(port), settings, || 0);
    driver.step_elsewhere(Box::new(Slow {
        workers: Workers::start(&scene).unwrap().unwrap(),
        asked: 0,
    }));
    let mut forces = Vec::new();
    for k in 0..1_500_u32 {
        let z = 0.025 - 0.009 * (f64::from(k) / 400.0).min(1.0);
        let pose = pose(
            u64::from(k) + 1,
            [0.001 * libm::sin(f64::from(k) * 0.01), 0.0, z],
        );
        bus.poses[0].offer(pose, SenderId::default());
        driver.turn(Wake::default());
        forces.push(driver.record().output.tools[0].force_n.norm());
        while bus.outputs.pop().is_ok() {}
        while bus.records.pop().is_ok() {}
        recorder.turn();
    }
    let put_off: Vec<_> = bus.counters.late_steps.take().collect();
    println!("{put_off:?} ticks put off, {} N", forces[1_499]);
    assert!(
        matches!(put_off[..], [(0, ticks)] if ticks > 600),
        "{put_off:?}"
    );
    assert!(bus.counters.late_steps.take().next().is_none());
    let most = forces.iter().copied().fold(0.0, f64::max);
    for (k, pair) in forces.windows(2).enumerate() {
        let jump = (pair[1] - pair[0]).abs();
        assert!(jump < 0.5 * most, "tick {k}: {jump} N of {most} N");
    }
    drop(driver);
    assert!(recorder.finish().failure.is_none());
    let session = Session::open(&path).unwrap();
    println!("{}", info(&session).unwrap());
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(report.passed(), "{report:?}");
    assert_eq!(report.ticks_matched, 1_500);
}

#[test]
fn a_step_that_was_begun_before_a_reset_is_never_taken_for_a_later_one() {
    let text = slab("lattice", "integrator = { every = 4 }");
    let (mut here, mut there) = (World::new(&text), World::new(&text));
    let scene = Arc::new(World::new(&text).scene);
    let workers = Workers::start(&scene).unwrap().unwrap();
    there.scratch.set_pipeline(Box::new(workers));
    let saved: Vec<SavedState> = (0..6)
        .map(|k| {
            let mut saved = SavedState::default();
            here.at([0.0, 0.0, 0.02 - 1e-4 * f64::from(k)]);
            saved.save_from(&here.state);
            saved
        })
        .collect();
    // Again and again, faster than the threads are done.
    for round in 0..60 {
        let from = &saved[round % 6];
        for world in [&mut here, &mut there] {
            restore(&world.scene, &mut world.state, &mut world.scratch, from).unwrap();
        }
        for k in 0..round as u32 % 7 {
            let place = [0.0, 0.0, 0.018 - 1e-5 * f64::from(k)];
            (here.seq, there.seq) = (1_000, 1_000);
            here.at(place);
            there.at(place);
        }
        assert_eq!(
            state_hash(&here.state),
            state_hash(&there.state),
            "round {round}"
        );
    }
}
