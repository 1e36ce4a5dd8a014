//! Levels of replay: bit for bit on any number of threads, workers and whatever the processor
//! offers (R1 to R3), by figures where bits may differ (R4), and from any state gone back to (R5).

use crate::common::{Laws as _, World};
use crate::session::{RIGID, Random, Script, record, record_lying, scenes, slab};
use palpate_drive::threads::Threads;
use palpate_drive::workers::Workers;
use palpate_geometry::math::{Point3, SavedState, Vector3, state_hash};
use palpate_record::{
    Contents, Figures, ReplayOptions, Session, SessionHash, Start, deviations, info, replay,
    replay_with, simulate_figures,
};
use palpate_sim::body::{DeformableState, Field};
use palpate_sim::tick::record::{Command, TickOutput, TickRecord};
use palpate_sim::tick::{Executor, Pipeline, SceneState};
use palpate_sim::tick::{apply, restore, step};
use std::path::Path;
use std::process::Command as Process;
use std::sync::Arc;

/// Puts a world to its start, with new buffers.
fn begin(world: &mut World) {
    world.state = world.scene.initial_state();
    world.scratch = world.scene.scratch(&world.state);
}

/// A run with its outputs, from a state on.
fn run(world: &mut World, script: &Script, from: u64, until: u64) -> Vec<TickOutput> {
    let outputs = (from..until).map(|tick| {
        for command in script.commands_after(tick) {
            apply(&world.scene, &mut world.state, &mut world.scratch, command);
        }
        let input = script.input(tick + 1, &world.scene);
        step(&world.scene, &mut world.state, &mut world.scratch, &input)
    });
    outputs.collect()
}

// R5. Pauses, resets, levels of quality, devices that tell what they bear, and steps under way on
// threads are among what is gone back to; the buffers are once those of a run that went elsewhere,
// once new.
#[test]
fn save_advance_restore_advance_comes_to_the_same_bits() {
    const TICKS: u64 = 240;
    let mut touched = 0;
    for (name, text) in scenes() {
        let [mut world, mut apart] = [(); 2].map(|()| World::new(&text));
        let scene = Arc::new(World::new(&text).scene);
        for seed in 1..=3 {
            let script = Script::new(seed, TICKS, true);
            for world in [&mut world, &mut apart] {
                begin(world);
            }
            let at = 20 + Random(seed).below(TICKS as usize - 40) as u64;
            run(&mut world, &script, 0, at);
            let mut saved = SavedState::default();
            saved.save_from(&world.state);
            let hash = state_hash(&world.state);
            let first = run(&mut world, &script, at, TICKS);
            touched += first
                .iter()
                .filter(|output| output.tools[0].contact.is_some())
                .count();
            let told = |k: usize| {
                format!(
                    "{name}, seed {seed}, saved after tick {at}, tick {}",
                    at + 1 + k as u64
                )
            };
            let same = |second: &[TickOutput], how: &str| {
                for (k, (a, b)) in first.iter().zip(second).enumerate() {
                    assert_eq!(a, b, "{}: {how}", told(k));
                }
            };
            // Used buffers; the run goes elsewhere before it comes back.
            run(
                &mut world,
                &Script::new(seed + 100, 2 * TICKS, true),
                TICKS,
                TICKS + 30,
            );
            restore(&world.scene, &mut world.state, &mut world.scratch, &saved).unwrap();
            assert_eq!(state_hash(&world.state), hash);
            same(&run(&mut world, &script, at, TICKS), "used buffers");
            begin(&mut world);
            restore(&world.scene, &mut world.state, &mut world.scratch, &saved).unwrap();
            same(&run(&mut world, &script, at, TICKS), "new buffers");
            if let Some(workers) = Workers::start(&scene).unwrap() {
                apart.scratch.set_pipeline(Box::new(workers));
                run(&mut apart, &Script::new(seed + 200, TICKS, true), 0, 30);
                restore(&apart.scene, &mut apart.state, &mut apart.scratch, &saved).unwrap();
                same(&run(&mut apart, &script, at, TICKS), "workers");
            }
        }
    }
    assert!(touched > 1_000, "only {touched} ticks in touch");
}

// A reset writes into the state and the buffers that are there: what follows has the bits of a
// state at the start with new buffers, also when steps are under way on threads.
#[test]
fn a_reset_goes_on_as_new_buffers_would() {
    const TICKS: u64 = 200;
    let mut touched = 0;
    for (name, text) in scenes() {
        let mut world = World::new(&text);
        let scene = Arc::new(World::new(&text).scene);
        for seed in 1..=2 {
            begin(&mut world);
            if let Some(workers) = Workers::start(&scene).unwrap() {
                world.scratch.set_pipeline(Box::new(workers));
            }
            let at = 60 + Random(seed).below(40) as u64;
            touched += run(&mut world, &Script::new(seed, TICKS, false), 0, at)
                .iter()
                .filter(|output| output.tools[0].contact.is_some())
                .count();
            let mut expected = world.scene.initial_state();
            expected.tick = world.state.tick;
            for (start, body) in expected.bodies.iter_mut().zip(&world.state.bodies) {
                start.revision = body.revision + 1;
            }
            apply(
                &world.scene,
                &mut world.state,
                &mut world.scratch,
                Command::Reset,
            );
            assert_eq!(world.state, expected, "{name}, seed {seed}");
            let script = Script::new(seed + 10, TICKS, false);
            let reset = run(&mut world, &script, at, TICKS);
            world.scratch = world.scene.scratch(&expected);
            world.state = expected;
            let fresh = run(&mut world, &script, at, TICKS);
            for (a, b) in reset.iter().zip(&fresh) {
                assert_eq!(a, b, "{name}, seed {seed}, reset after tick {at}");
            }
        }
    }
    assert!(touched > 200, "only {touched} ticks in touch");
}

/// Workers for the first few bodies; others step in the tick in which they are due.
#[derive(Debug)]
struct Few {
    workers: Workers,
    bodies: usize,
}

impl Pipeline for Few {
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    ) {
        if body < self.bodies {
            self.workers.start(body, field, state, predicted, loads);
        }
    }
    fn is_ready(&mut self, body: usize) -> bool {
        body >= self.bodies || self.workers.is_ready(body)
    }
    fn finish(
        &mut self,
        body: usize,
        state: &mut DeformableState,
        predicted: &mut [Point3],
    ) -> bool {
        body < self.bodies && self.workers.finish(body, state, predicted)
    }
    fn cancel(&mut self) {
        self.workers.cancel();
    }
}

/// Four slabs in a row, each with a ball of its own; `integrator`: by slab.
fn four_slabs(integrator: impl Fn(usize) -> &'static str) -> String {
    let plain = "layers = 2, refine = \"none\"";
    let slab_at = |k: usize| {
        let one = slab("continuum", plain, integrator(k));
        let (head, one) = one.split_at(one.find("[[body]]").unwrap());
        let (body, tool) = one.split_at(one.find("[[tool]]").unwrap());
        let x = 0.3 * k as f64;
        let place = format!("\npose = {{ position = [{x:?}, 0.0, 0.0] }}\nmodel");
        let body = body
            .replace("id = \"slab\"", &format!("id = \"slab{k}\""))
            .replacen("\nmodel", &place, 1);
        let tool = tool
            .replace("id = \"ball\"", &format!("id = \"ball{k}\""))
            .replace(
                "position = [0.0, 0.0, 0.03]",
                &format!("position = [{x:?}, 0.0, 0.03]"),
            );
        (head.to_owned(), body, tool)
    };
    let all = [0, 1, 2, 3].map(slab_at);
    let bodies = all.iter().map(|(_, body, _)| body.as_str());
    let tools = all.iter().map(|(_, _, tool)| tool.as_str());
    let head = std::iter::once(all[0].0.as_str());
    head.chain(bodies).chain(tools).collect()
}

/// Of a run in which all four are pressed, with what `prepare` gives the world first.
fn hash_of_four(text: &str, prepare: impl FnOnce(&mut World)) -> SessionHash {
    let script = Script::new(7, 300, true);
    let mut world = World::new(text);
    prepare(&mut world);
    let mut hash = SessionHash::default();
    let outputs = run(&mut world, &script, 0, 300);
    outputs
        .iter()
        .for_each(|output| hash.push(output.tick, output.state_hash));
    let pressed = |t: usize| {
        let touching = outputs.iter().filter(|out| out.tools[t].contact.is_some());
        touching.count()
    };
    let pressed = [0, 1, 2, 3].map(pressed);
    assert!(pressed.iter().all(|ticks| *ticks > 20), "{pressed:?}");
    hash
}

// R2.
#[test]
fn a_session_has_the_same_hash_with_any_number_of_workers() {
    let text = four_slabs(|_| "integrator = { every = 4 }");
    let alone = hash_of_four(&text, |_| {});
    for count in [1, 2, 4] {
        let hash = hash_of_four(&text, |world| {
            let scene = Arc::new(World::new(&text).scene);
            let workers = Workers::start(&scene).unwrap();
            world.scratch.set_pipeline(Box::new(Few {
                workers: workers.expect("bodies that step apart"),
                bodies: count,
            }));
        });
        assert_eq!(hash, alone, "{count} workers");
    }
}

// R2: bodies that step side by side, one of them elsewhere.
#[test]
fn a_session_has_the_same_hash_with_any_number_of_threads() {
    let text = four_slabs(|k| match k {
        2 => "integrator = { every = 4 }",
        _ => "",
    });
    let alone = hash_of_four(&text, |_| {});
    for count in [2, 3, 8] {
        let hash = hash_of_four(&text, |world| {
            let threads = Threads::start(count, false).unwrap();
            let executor = threads.map(|threads| Box::new(threads) as Box<dyn Executor>);
            world.scratch.set_executor(&world.scene, executor);
            let scene = Arc::new(World::new(&text).scene);
            let workers = Workers::start(&scene).unwrap();
            let workers = workers.expect("a body that steps apart");
            world.scratch.set_pipeline(Box::new(workers));
        });
        assert_eq!(hash, alone, "{count} threads");
    }
}

fn replayed_in_a_child(file: &Path, simd: Option<&str>) -> (serde_json::Value, i32) {
    let mut process = Process::new(env!("CARGO_BIN_EXE_palpate"));
    process
        .arg("replay")
        .arg(file)
        .args(["--json", "--jobs", "1"])
        .env_remove("PALPATE_SIMD");
    if let Some(simd) = simd {
        process.env("PALPATE_SIMD", simd);
    }
    let output = process.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    (
        serde_json::from_str(&text).unwrap_or_default(),
        output.status.code().unwrap_or(-1),
    )
}

// R3. There are two paths: the baseline, and AVX2 where the processor has it; nothing is written
// for AVX-512.
#[test]
fn the_baseline_comes_to_every_hash_that_avx2_came_to() {
    let directory = tempfile::tempdir().unwrap();
    for (k, (name, text)) in scenes().into_iter().enumerate() {
        let file = directory.path().join(format!("{k}.mcap"));
        let script = Script::new(11 + k as u64, 200, true);
        record(&file, &text, &script);
        let here = info(&Session::open(&file).unwrap()).unwrap();
        for simd in [None, Some("baseline")] {
            // Each tick's hash, force and net is compared there with what was recorded here.
            let (report, code) = replayed_in_a_child(&file, simd);
            assert_eq!(code, 0, "{name}, {simd:?}: {report}");
            assert_eq!(report["ticks_matched"], 200, "{name}, {simd:?}");
            assert_eq!(
                report["session_hash"],
                here.session_hash.as_str(),
                "{name}, {simd:?}"
            );
        }
    }
}

// R1. Differences in three stretches: the first by tick is told, whichever thread came first, and
// with it the same counts.
#[test]
fn what_is_found_does_not_depend_on_the_number_of_threads() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("rigid.mcap");
    record(&file, RIGID, &Script::new(3, 1_000, true));
    let whole = Contents::open(&file).unwrap();
    assert!(whole.keyframes.len() >= 6, "{}", whole.keyframes.len());
    let mut forged = whole.clone();
    for tick in [850, 431, 655] {
        forged.ticks[tick - 1].output.tools[0].force_n.y += 1e-9;
    }
    let mut state = whole.clone();
    let keyframe = state
        .keyframes
        .iter_mut()
        .find(|keyframe| keyframe.tick == 400)
        .unwrap();
    keyframe.saved.floats[3] += 1e-9;
    for (session, tick, matched) in [
        (&whole, None, 1_000),
        (&forged, Some((431, "tools[0].force_n.y")), 430),
        (&state, Some((400, "keyframe.state_hash")), 400),
    ] {
        let session = session.session().unwrap();
        let with = |jobs| {
            let report = replay_with(
                &session,
                &ReplayOptions {
                    jobs,
                    ..Default::default()
                },
                |_, _| {},
            )
            .unwrap();
            assert!(report.realtime_factor > 0.0);
            palpate_record::ReplayReport {
                realtime_factor: 0.0,
                jobs: 0,
                ..report
            }
        };
        let serial = with(1);
        let difference = serial.first_difference.as_ref();
        assert_eq!(
            difference.map(|found| (found.tick, found.field.as_str())),
            tick
        );
        assert_eq!(serial.ticks_matched, matched);
        for jobs in [2, 3, 8] {
            assert_eq!(with(jobs), serial, "{jobs} threads");
        }
    }
    // A stretch must reach the state of the next keyframe: one that was saved elsewhere is found,
    // though it has a true hash.
    let mut swapped = whole.clone();
    let other = swapped.keyframes[1].clone();
    let keyframe = swapped
        .keyframes
        .iter_mut()
        .find(|keyframe| keyframe.tick == 600)
        .unwrap();
    (keyframe.saved, keyframe.state_hash) = (other.saved, other.state_hash);
    let found = replay(&swapped.session().unwrap(), 0, |_, _| {})
        .unwrap()
        .first_difference
        .unwrap();
    assert_eq!(
        (found.tick, found.field.as_str()),
        (600, "keyframe.state_hash")
    );
}

#[test]
fn a_replay_runs_from_and_until_the_ticks_it_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("rigid.mcap");
    record(&file, RIGID, &Script::new(3, 1_000, false));
    let mut session = Contents::open(&file).unwrap();
    let matched = |session: &Contents, from, until| {
        let options = ReplayOptions {
            from,
            until,
            jobs: 2,
        };
        replay_with(&session.session().unwrap(), &options, |_, _| {})
            .map(|report| (report.ticks_matched, report.passed()))
    };
    assert_eq!(matched(&session, 0, u64::MAX).unwrap(), (1_000, true));
    assert_eq!(matched(&session, 450, 700).unwrap(), (300, true));
    assert_eq!(matched(&session, 400, 401).unwrap(), (1, true));
    let error = matched(&session, 1_200, 1_300).unwrap_err().to_string();
    assert!(error.contains("1 to 1000"), "{error}");
    // A part of a longer session begins with a keyframe; it is whole.
    session.ticks.retain(|record| record.output.tick > 400);
    session.keyframes.retain(|keyframe| keyframe.tick >= 400);
    session.nets.retain(|net| net.tick > 400);
    assert_eq!(matched(&session, 0, u64::MAX).unwrap(), (600, true));
    let error = matched(&session, 100, u64::MAX).unwrap_err().to_string();
    assert!(
        error.contains("at or before tick 100") && error.contains("at tick 400"),
        "{error}"
    );
    // Without it, ticks up to the next keyframe cannot be compared, and that is told.
    session.keyframes.remove(0);
    assert_eq!(matched(&session, 0, u64::MAX).unwrap(), (400, false));
}

// The recorder was handed one force that nobody felt. `palpate replay` names it, and leaves both
// runs around it.
#[test]
fn the_ticks_around_a_difference_are_written_from_both_runs() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("lie.mcap");
    record_lying(
        &file,
        RIGID,
        &Script::new(3, 600, false),
        |record: &mut TickRecord| {
            if record.output.tick == 320 {
                record.output.tools[0].force_n.x =
                    f64::from_bits(record.output.tools[0].force_n.x.to_bits() ^ 2);
            }
        },
    );
    let output = Process::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("replay")
        .arg(&file)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("tick 320: tools[0].force_n.x") && told.contains("(2 ULPs apart)"),
        "{told}"
    );
    let bytes = std::fs::read(directory.path().join("divergence-320.mcap")).unwrap();
    let mut ticks =
        std::collections::BTreeMap::<String, Vec<palpate_proto::recording::Tick>>::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        assert_eq!(
            message.channel.schema.as_ref().unwrap().name,
            "palpate.v1.Tick"
        );
        let tick = prost::Message::decode(&message.data[..]).unwrap();
        ticks
            .entry(message.channel.topic.clone())
            .or_default()
            .push(tick);
    }
    let (recorded, replayed) = (&ticks["/recorded/sim/tick"], &ticks["/replayed/sim/tick"]);
    for run in [recorded, replayed] {
        assert_eq!(
            run.iter().map(|tick| tick.tick).collect::<Vec<_>>(),
            (270..=370).collect::<Vec<_>>()
        );
    }
    for (a, b) in recorded.iter().zip(replayed) {
        assert_eq!(
            a.tools[0].values == b.tools[0].values,
            a.tick != 320,
            "tick {}",
            a.tick
        );
        assert_eq!(
            (a.state_hash, &a.tools[0].applied),
            (b.state_hash, &b.tools[0].applied)
        );
    }
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let metadata = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
    assert_eq!(
        (metadata.name.as_str(), metadata.metadata["field"].as_str()),
        ("palpate.divergence", "tools[0].force_n.x")
    );
    // A directory of one's own, with the report.
    let place = directory.path().join("report");
    let output = Process::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("replay")
        .arg(&file)
        .arg("--report")
        .arg(&place)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.join("replay.json")).unwrap()).unwrap();
    assert_eq!(report["first_difference"]["tick"], 320);
    assert!(place.join("divergence-320.mcap").exists());
}

// R4.
#[test]
fn figures_are_blessed_checked_and_told_when_they_are_off() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("slab.mcap");
    let text = slab("lattice", "layers = 2, refine = \"none\"", "");
    record(&file, &text, &Script::new(5, 400, false));
    let palpate = |more: &[&str]| {
        let output = Process::new(env!("CARGO_BIN_EXE_palpate"))
            .arg("replay")
            .arg(&file)
            .args(["--check", "figures"])
            .args(more)
            .output();
        let output = output.unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (
            text(&output.stdout) + &text(&output.stderr),
            output.status.code().unwrap_or(-1),
        )
    };
    let (told, code) = palpate(&[]);
    assert!(code == 2 && told.contains("--bless"), "{told}");
    assert_eq!(palpate(&["--bless"]).1, 0);
    assert_eq!(palpate(&[]).1, 0);
    let path = Figures::path_for(&file);
    let written = Figures::read(&path).unwrap();
    let session = Session::open(&file).unwrap();
    let (tool, seen) = (&written.tools[0], &info(&session).unwrap().tools[0]);
    assert!(
        tool.contact_ticks > 50 && tool.rms_force_n > 0.0 && tool.rms_force_n < tool.peak_force_n,
        "{tool:?}"
    );
    assert_eq!(
        (tool.peak_force_n, tool.contact_ticks),
        (seen.peak_force_n, seen.contact_ticks)
    );
    let kept = Contents::of(&session).unwrap();
    let first = kept
        .ticks
        .iter()
        .find(|record| record.output.tools[0].contact.is_some())
        .unwrap();
    assert_eq!(tool.first_contact_tick, Some(first.output.tick));
    // The ball sinks in no deeper than the body gives way and it is allowed to.
    let body = &written.bodies[0];
    assert!(
        body.peak_displacement_m > 1e-4 && body.peak_displacement_m < 0.03,
        "{body:?}"
    );

    let mut off = written.clone();
    off.tools[0].peak_force_n *= 1.0 + 1e-4;
    off.write(&path).unwrap();
    let (told, code) = palpate(&[]);
    assert!(
        code == 1 && told.contains("tools.ball.peak_force_n"),
        "{told}"
    );
    // A tolerance of its author, and it passes; a blessing says what changed and leaves the
    // tolerance.
    off.tolerances.force = 1e-3;
    off.write(&path).unwrap();
    assert_eq!(palpate(&[]).1, 0);
    let (told, code) = palpate(&["--bless"]);
    assert!(
        code == 0 && told.contains("tools.ball.peak_force_n") && told.contains("1 figures changed"),
        "{told}"
    );
    let blessed = Figures::read(&path).unwrap();
    assert_eq!(
        (blessed.tolerances.force, &blessed.tools),
        (1e-3, &written.tools)
    );
    std::fs::write(&path, "{\"format\": \"something\"}").unwrap();
    assert_eq!(palpate(&[]).1, 2);
}

// A state of another version may have another size or another meaning. From tick 0 on the scene's
// own start will do.
#[test]
fn figures_need_no_keyframe_that_fits_when_the_recording_begins_at_the_start() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("rigid.mcap");
    record(&file, RIGID, &Script::new(5, 600, true));
    let session = Contents::open(&file).unwrap();
    let (figures, start) = simulate_figures(&session.session().unwrap(), |_, _| {}).unwrap();
    assert_eq!(start, Start::Keyframe);
    let mut resized = session.clone();
    resized.keyframes[0].saved.floats.push(1.0);
    let mut meant_otherwise = session.clone();
    meant_otherwise.keyframes[0].state_hash ^= 1;
    for other in [resized, meant_otherwise] {
        let (again, start) = simulate_figures(&other.session().unwrap(), |_, _| {}).unwrap();
        assert!(matches!(start, Start::Scene { .. }));
        assert_eq!(deviations(&figures, &again, true), []);
        let mut late = other;
        let keep = late
            .keyframes
            .iter()
            .position(|keyframe| keyframe.tick >= 200)
            .unwrap();
        late.keyframes.drain(..keep);
        late.keyframes[0].saved.floats.push(1.0);
        assert!(
            simulate_figures(&late.session().unwrap(), |_, _| {})
                .unwrap_err()
                .to_string()
                .contains("tick 0")
        );
    }
    let mut torn = session.clone();
    torn.ticks.remove(300);
    assert!(
        simulate_figures(&torn.session().unwrap(), |_, _| {})
            .unwrap_err()
            .to_string()
            .contains("tick 301 is missing")
    );
}

// A state as it was before anything ran is as good as one in the middle: `SceneState` is all there
// is.
#[test]
fn two_runs_of_one_script_are_one() {
    let script = Script::new(21, 150, true);
    for (name, text) in scenes() {
        let (mut a, mut b) = (World::new(&text), World::new(&text));
        let outputs = (run(&mut a, &script, 0, 150), run(&mut b, &script, 0, 150));
        let states: (SceneState, SceneState) = (a.state, b.state);
        assert!(outputs.0 == outputs.1 && states.0 == states.1, "{name}");
    }
}
