//! Recordings, in process: what goes in comes out, and a replay is exact.

use crate::common::pose;
use crate::live::{SOFT, bits, in_contact, record};
use crate::scenes::RIGID;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_geometry::math::{Rotation, state_hash};
use palpate_record::{Contents, Origin, Recorder, RecorderSettings, Session, info, replay};
use palpate_sim::haptics::DeviceBounds;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use palpate_sim::tick::step;

#[test]
fn a_rigid_session_comes_back_bit_for_bit_and_replays() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("deep/er/rigid.mcap");
    let (summary, records) = record(&path, RIGID, 1_000, &[]);
    assert!(in_contact(&records, 0) > 200, "the ball hardly touches");
    assert_eq!(
        (summary.ticks, summary.dropped, &summary.path),
        (1_000, 0, &path)
    );
    assert!(!directory.path().join("deep/er/rigid.mcap.part").exists());

    let session = Session::open(&path).unwrap();
    assert!(session.has_index() && session.is_whole() && session.gaps() == 0);
    assert_eq!(session.tick_range(), Some((1, 1_000)));
    let kept = Contents::of(&session).unwrap();
    assert_eq!((kept.ticks.len(), session.tick_count()), (1_000, 1_000));
    for (was, is) in records.iter().zip(&kept.ticks) {
        assert_eq!(bits(was), bits(is));
    }
    let pose = kept.ticks[0].input.poses[0].unwrap();
    assert!(
        pose.linear_velocity.y.to_bits() == (-0.0_f64).to_bits(),
        "the sign of zero is lost"
    );
    assert_eq!(
        kept.keyframes.iter().map(|k| k.tick).collect::<Vec<_>>(),
        [0, 200, 400, 600, 800, 1_000]
    );

    let figures = info(&session).unwrap();
    assert_eq!(figures.figures_from, Origin::Index);
    assert_eq!(
        (figures.ticks, figures.skipped_ticks, figures.late_ticks),
        (1_000, 1, 0)
    );
    assert_eq!(figures.final_hash, format!("{:016x}", summary.final_hash));
    assert_eq!(
        figures.session_hash,
        format!("{:016x}", summary.session_hash)
    );
    assert_eq!(
        figures.tools[0].contact_ticks,
        in_contact(&records, 0) as u64
    );

    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(report.passed() && report.same_build, "{report:?}");
    assert_eq!(
        (report.ticks_matched, report.session_hash),
        (1_000, figures.session_hash.clone())
    );
}

#[test]
fn two_soft_bodies_replay_with_every_net_compared() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("soft.mcap");
    let (_, records) = record(&path, SOFT, 600, &[]);
    let touching = [0, 1].map(|tool| in_contact(&records, tool));
    assert!(
        touching.iter().all(|ticks| *ticks > 50),
        "the tools hardly touch: {touching:?}"
    );
    let session = Contents::open(&path).unwrap();
    let of = |id: &str| session.nets.iter().filter(|net| net.body == id).count();
    assert!(
        of("drop") > 10 && of("sheet") > 10,
        "{} and {} nets",
        of("drop"),
        of("sheet")
    );
    assert!(
        session.nets.is_sorted_by_key(|net| net.tick),
        "each list is ordered by tick"
    );
    let report = replay(&Session::open(&path).unwrap(), 0, |_, _| {}).unwrap();
    assert!(report.passed(), "{report:?}");
    assert_eq!(
        (report.ticks_matched, report.nets_matched),
        (600, session.nets.len() as u64)
    );

    // A net is compared to its last bit, whichever body it is of, and to its last point.
    for body in ["drop", "sheet"] {
        let k = session
            .nets
            .iter()
            .rposition(|net| net.body == body)
            .unwrap();
        let mut forged = session.clone();
        let last = forged.nets[k].points.last_mut().unwrap();
        *last = f64::from_bits(last.to_bits() ^ 1);
        let difference = replay(&forged.session().unwrap(), 0, |_, _| {})
            .unwrap()
            .first_difference
            .expect("a forged net went unnoticed");
        assert_eq!(
            (difference.tick, difference.ulps),
            (session.nets[k].tick, Some(1)),
            "{difference:?}"
        );
        assert!(difference.field.contains(body), "{difference:?}");
        let mut short = session.clone();
        short.nets[k].points.pop();
        assert!(
            replay(&short.session().unwrap(), 0, |_, _| {})
                .unwrap()
                .first_difference
                .is_some(),
            "a short net went unnoticed"
        );
    }
}

// The hard one is a reset and a pause between the same two ticks: the keyframe of the reset already
// holds them.
#[test]
fn commands_replay_from_every_keyframe() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("commands.mcap");
    let commands = [
        (100, Command::Pause),
        (120, Command::Step(5)),
        (150, Command::Resume),
        (200, Command::Pause),
        (200, Command::Reset),
        (200, Command::Pause),
        (230, Command::Resume),
        (333, Command::Reset),
        (380, Command::Stop),
    ];
    let (_, records) = record(&path, SOFT, 400, &commands);
    assert_eq!(
        records
            .iter()
            .filter(|record| !record.output.moving)
            .count(),
        20 + 25 + 30 + 20
    );
    let recording = Session::open(&path).unwrap();
    let session = Contents::of(&recording).unwrap();
    assert_eq!(session.commands, commands);
    let mut starts: Vec<u64> = session
        .keyframes
        .iter()
        .map(|keyframe| keyframe.tick)
        .collect();
    assert_eq!(
        starts,
        [0, 100, 200, 200, 300, 333, 400],
        "two at 200: before and after the reset"
    );
    starts.dedup();
    for from in starts {
        let report = replay(&recording, from, |_, _| {}).unwrap();
        assert!(
            report.first_difference.is_none(),
            "from {from}: {:?}",
            report.first_difference
        );
        assert_eq!(report.ticks_matched, 400 - from);
    }
    // A command that is forgotten is found at the tick that missed it.
    let mut forged = session.clone();
    forged.commands.remove(1);
    assert_eq!(
        replay(&forged.session().unwrap(), 0, |_, _| {})
            .unwrap()
            .first_difference
            .unwrap()
            .tick,
        121
    );
}

/// The scene above where quality shows: several iterations a step, nets at a tenth of the ticks.
fn soft_iterated() -> String {
    let text = SOFT.replace(
        "model = \"lattice\"\n",
        "model = \"lattice\"\nintegrator = { iterations = 4 }\n",
    );
    assert_ne!(text, SOFT);
    text
}

// A bar free to turn rests on a drop and drags over it; its device tells what it can bear while it
// presses, and another does after a reset.
#[test]
fn a_tool_that_turns_and_a_device_that_tells_replay_bit_for_bit_from_every_keyframe() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("turning.mcap");
    let told = |force_max_n, stiffness_max_n_m| {
        let bounds = DeviceBounds {
            force_max_n,
            torque_max_nm: 0.002,
            stiffness_max_n_m,
        };
        Command::Device { tool: 0, bounds }
    };
    let text = RIGID
        .replace("sphere = { radius_m = 0.01 }", "cylinder = { radius_m = 0.008, half_length_m = 0.02 }")
        .replace("damping_n_s_m = 0.0 }", "damping_n_s_m = 0.5, turning_stiffness_nm_rad = 0.3, turning_damping_nm_s_rad = 1e-4 }\nfriction = { mu = 0.3, viscous_n_s_m = 0.2 }\ndevice = { passivity = true }");
    let commands = [
        (300, told(1.5, 400.0)),
        (333, Command::Reset),
        (410, told(f64::INFINITY, f64::INFINITY)),
    ];
    let (_, records) = record(&path, &text, 800, &commands);
    assert!(in_contact(&records, 0) > 100, "the bar hardly touches");
    let turned =
        |record: &&TickRecord| record.output.tools[0].proxy_orientation != Rotation::identity();
    assert!(
        records.iter().filter(turned).count() > 100,
        "the bar hardly turns"
    );
    assert!(
        records[300..409]
            .iter()
            .all(|record| record.output.tools[0].force_n.norm() <= 1.5 + 1e-12)
    );
    assert!(
        records[410..]
            .iter()
            .any(|record| record.output.tools[0].force_n.norm() > 1.6)
    );
    let recording = Session::open(&path).unwrap();
    let session = Contents::of(&recording).unwrap();
    assert_eq!(session.commands, commands);
    for keyframe in &session.keyframes {
        let report = replay(&recording, keyframe.tick, |_, _| {}).unwrap();
        assert!(
            report.first_difference.is_none(),
            "from {}: {:?}",
            keyframe.tick,
            report.first_difference
        );
    }
    let mut forged = session.clone();
    forged.commands.remove(0);
    assert_eq!(
        replay(&forged.session().unwrap(), 0, |_, _| {})
            .unwrap()
            .first_difference
            .unwrap()
            .tick,
        301
    );
}

// Quality falls and comes back while tools press, once between the same ticks as a reset, which
// leaves it.
#[test]
fn quality_replays_bit_for_bit_from_every_keyframe() {
    let directory = tempfile::tempdir().unwrap();
    let (path, plain) = (
        directory.path().join("quality.mcap"),
        directory.path().join("plain.mcap"),
    );
    let commands = [
        (150, Command::Quality(1)),
        (210, Command::Quality(2)),
        (260, Command::Quality(3)),
        (300, Command::Reset),
        (300, Command::Quality(2)),
        (450, Command::Quality(1)),
        (550, Command::Quality(0)),
    ];
    let text = soft_iterated();
    let (_, records) = record(&path, &text, 600, &commands);
    let levels =
        |from: usize, to: usize| records[from..to].iter().map(|record| record.output.quality);
    let expected = [
        (0, 150, 0),
        (150, 210, 1),
        (210, 260, 2),
        (260, 300, 3),
        (300, 450, 2),
        (450, 550, 1),
        (550, 600, 0),
    ];
    for (from, to, level) in expected {
        assert!(
            levels(from, to).all(|at| at == level),
            "ticks {from} to {to} are not all of level {level}"
        );
    }
    let recording = Session::open(&path).unwrap();
    let session = Contents::of(&recording).unwrap();
    assert_eq!(session.commands, commands);
    for from in [0, 100, 200, 300, 400, 500] {
        let report = replay(&recording, from, |_, _| {}).unwrap();
        assert!(
            report.first_difference.is_none(),
            "from {from}: {:?}",
            report.first_difference
        );
        assert_eq!(report.ticks_matched, 600 - from);
    }
    // It is no idle number: without the commands the same poses come to other forces.
    let (_, full) = record(&plain, &text, 600, &[]);
    let force = |records: &[TickRecord], k: usize| records[k].output.tools[0].force_n;
    assert!((0..150).all(|k| force(&records, k) == force(&full, k)));
    assert!(
        (150..300).any(|k| force(&records, k) != force(&full, k)),
        "the first level changes nothing"
    );
    // And one that is forgotten is found at the tick that missed it.
    let mut forged = session.clone();
    forged.commands.remove(0);
    let difference = replay(&forged.session().unwrap(), 0, |_, _| {})
        .unwrap()
        .first_difference
        .expect("a lost command went unnoticed");
    assert_eq!(difference.tick, 151, "{difference:?}");
}

#[test]
fn a_scene_with_its_surface_in_place_replays_from_the_file_alone() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("inline.mcap");
    let surface = serde_json::json!({
        "format": "palpate.surface.v1", "degree": [1, 1], "periodic": [false, false],
        "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
        "points": [[[-0.05, -0.05, 1e-17], [-0.05, 0.05, -0.0]], [[0.05, -0.05, 0], [0.05, 0.05, 0.12345678901234568]]],
        "weights": null,
    });
    std::fs::write(directory.path().join("sheet.json"), surface.to_string()).unwrap();
    let text = r#"
[[body]]
id = "sheet"
surface = { file = "sheet.json" }
[[tool]]
id = "ball"
pose = { position = [0.0, 0.0, 0.06] }
"#;
    let loaded = file::parse(text, "test.toml", directory.path()).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::build(&loaded.spec, directory.path()).unwrap();
    let effective = palpate_sim::scene::inline_files(&loaded.spec, directory.path()).unwrap();
    let (recorder, mut port) = Recorder::start(
        RecorderSettings::new(&loaded.text, &effective).to(&path),
        &scene,
    )
    .unwrap();
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    port.keyframe(&state, state_hash(&state));
    let mut touched = 0;
    let mut nets = NetPool::new(&scene, port.nets_held());
    for tick in 1..=200 {
        let mut input = TickInput::default();
        input.poses[0] = Some(pose(tick, [0.0, 0.0, 0.06 - 2e-4 * tick as f64]));
        let output = step(&scene, &mut state, &mut scratch, &input);
        touched += u32::from(output.tools[0].contact.is_some());
        let record = TickRecord {
            input,
            output,
            ..TickRecord::default()
        };
        nets.begin();
        port.tick(&scene, &state, &record, &mut nets);
    }
    assert!(touched > 50, "only {touched} ticks in touch");
    drop(port);
    recorder.finish().last().unwrap();
    std::fs::remove_file(directory.path().join("sheet.json")).unwrap();
    let report = replay(&Session::open(&path).unwrap(), 0, |_, _| {}).unwrap();
    assert!(report.passed() && report.ticks_matched == 200, "{report:?}");
}
