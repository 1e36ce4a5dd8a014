//! Recordings reduced to what went into their ticks: they run to the same bits, become whole again,
//! and say what is missing of them.

use crate::session::{RIGID, Script, record, record_lying, scenes};
use palpate_record::{
    Contents, Figures, Hashes, InputsError, Session, Start, info, record_again, reduce, replay,
    simulate,
};
use std::path::{Path, PathBuf};
use std::process::Command;

fn none(_: u64, _: u64) {}

fn reduced(session: &Session, target: &Path) -> Hashes {
    let reduced = reduce(session, target, none).unwrap_or_else(|e| panic!("{e}"));
    reduced.figures.hashes.unwrap()
}

// Resets, pauses, levels of quality, devices that say what they bear, and ticks without news go in
// as they were recorded.
#[test]
fn a_recording_is_reduced_to_its_inputs_and_made_whole_again() {
    let directory = tempfile::tempdir().unwrap();
    for (k, (name, text)) in scenes().into_iter().enumerate() {
        let place = |what: &str| directory.path().join(format!("{k}-{what}.mcap"));
        record(
            &place("whole"),
            &text,
            &Script::new(11 + k as u64, 150, true),
        );
        let session = Session::open(&place("whole")).unwrap();
        let hashes = reduced(&session, &place("inputs"));
        assert_eq!(
            hashes.session,
            info(&session).unwrap().session_hash,
            "{name}"
        );
        assert_eq!(
            (hashes.first_tick, hashes.every, hashes.stretches.len()),
            (1, 100, 2)
        );
        let len = |path: PathBuf| std::fs::metadata(path).unwrap().len();
        assert!(5 * len(place("inputs")) < len(place("whole")), "{name}");
        let inputs = Session::open_any(&place("inputs")).unwrap();
        assert!(inputs.is_whole() && inputs.holds_inputs_only() && inputs.tick_count() == 150);
        let told = info(&inputs).unwrap();
        assert_eq!(
            (told.ticks, told.gaps, told.commands),
            (150, 0, info(&session).unwrap().commands)
        );
        assert_eq!(
            told.tools[0].poses,
            info(&session).unwrap().tools[0].poses,
            "{name}"
        );

        let found = simulate(&inputs, none).unwrap();
        assert_eq!(
            (found.start, &found.hashes),
            (Start::Scene { reason: None }, &hashes)
        );
        record_again(&inputs, &place("again"), none).unwrap();
        let again = Session::open(&place("again")).unwrap();
        assert!(replay(&again, 0, none).unwrap().passed(), "{name}");
        let [first, second] = [&session, &again].map(|session| Contents::of(session).unwrap());
        for (a, b) in first.ticks.iter().zip(&second.ticks) {
            assert_eq!((&a.input, &a.output), (&b.input, &b.output), "{name}");
        }
        assert_eq!(first.ticks.len(), second.ticks.len());
        assert_eq!(
            (&first.commands, &first.keyframes),
            (&second.commands, &second.keyframes),
            "{name}"
        );
        assert_eq!(first.nets, second.nets, "{name}");
    }
}

// A part of a longer session begins with a state that no scene has.
#[test]
fn a_recording_that_begins_late_keeps_its_first_keyframe() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("rigid.mcap");
    record(&file, RIGID, &Script::new(4, 700, true));
    let mut late = Contents::open(&file).unwrap();
    late.keyframes.retain(|keyframe| keyframe.tick >= 200);
    let first = late.keyframes[0].tick;
    late.ticks.retain(|record| record.output.tick > first);
    let session = late.session().unwrap();
    let target = directory.path().join("late.inputs.mcap");
    let hashes = reduced(&session, &target);
    assert_eq!(hashes.first_tick, first + 1);
    assert_eq!(hashes.session, info(&session).unwrap().session_hash);
    let found = simulate(&Session::open_any(&target).unwrap(), none).unwrap();
    assert_eq!((found.start, found.hashes), (Start::Keyframe, hashes));
}

#[test]
fn what_cannot_be_made_again_is_not_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let place = |name: &str| directory.path().join(name);
    let target = place("inputs.mcap");
    let script = Script::new(3, 300, true);
    record_lying(&place("forged.mcap"), RIGID, &script, |record| {
        if record.output.tick == 230 {
            record.output.tools[0].force_n.x += 1e-9;
        }
    });
    let error = reduce(
        &Session::open(&place("forged.mcap")).unwrap(),
        &target,
        none,
    )
    .unwrap_err();
    assert!(
        matches!(
            error,
            InputsError::Differs {
                ticks: (201, 300),
                ..
            }
        ),
        "{error}"
    );
    record(&place("whole.mcap"), RIGID, &script);
    let whole = Contents::open(&place("whole.mcap")).unwrap();
    let mut torn = whole.clone();
    torn.ticks.remove(150);
    let error = reduce(&torn.session().unwrap(), &target, none).unwrap_err();
    assert!(error.to_string().contains("tick 151 is missing"), "{error}");
    let mut cut = whole.clone();
    cut.cut_short = Some(String::new());
    let error = reduce(&cut.session().unwrap(), &target, none).unwrap_err();
    assert!(matches!(error, InputsError::Incomplete { .. }), "{error}");
    let left: Vec<_> = std::fs::read_dir(directory.path()).unwrap().collect();
    assert_eq!(left.len(), 2, "{left:?}");
    std::fs::write(&target, b"mine").unwrap();
    let error = reduce(&whole.session().unwrap(), &target, none).unwrap_err();
    assert!(error.to_string().contains("exists already"), "{error}");
    assert_eq!(std::fs::read(&target).unwrap(), b"mine");
}

#[test]
fn a_replay_of_inputs_compares_hashes_and_says_where_they_part() {
    let directory = tempfile::tempdir().unwrap();
    let place = |name: &str| directory.path().join(name);
    let [whole, inputs] = ["whole.mcap", "inputs.mcap"].map(place);
    record(&whole, RIGID, &Script::new(7, 350, true));
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_palpate"))
            .args(arguments)
            .current_dir(directory.path())
            .output()
            .unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let told = text(&output.stdout) + &text(&output.stderr);
        (told, output.status.code().unwrap_or(-1))
    };
    let holds = |arguments: &[&str], code: i32, words: &[&str]| {
        let (told, ended) = run(arguments);
        let missing = words.iter().find(|word| !told.contains(**word));
        assert!(
            ended == code && missing.is_none(),
            "{arguments:?}: {ended}, without {missing:?}: {told}"
        );
    };
    let session = info(&Session::open(&whole).unwrap()).unwrap();
    let session = session.session_hash.clone();
    holds(
        &["export", "whole.mcap", "--inputs", "inputs.mcap"],
        0,
        &[&session],
    );
    let kept = std::fs::read(&inputs).unwrap();
    let replay = ["replay", "inputs.mcap"];
    let well = "no outputs recorded; 350 ticks run, 4 of 4 hashes matched";
    holds(&replay, 0, &[well, &session]);
    holds(
        &["replay", "inputs.mcap", "--check", "figures"],
        0,
        &["all figures"],
    );
    holds(
        &["info", "inputs.mcap"],
        0,
        &["inputs only", "350 ticks (0 missing), clean"],
    );
    holds(
        &["replay", "inputs.mcap", "--record", "again.mcap"],
        0,
        &[&session],
    );
    holds(&["replay", "again.mcap"], 0, &[&session]);
    // Of a whole one as well.
    holds(
        &["replay", "again.mcap", "--record", "third.mcap"],
        0,
        &[&session],
    );
    holds(
        &["replay", "inputs.mcap", "--record", "again.mcap"],
        2,
        &["exists already"],
    );

    // What wants outputs says how to come by them.
    for command in [
        &["replay", "inputs.mcap", "--check", "bits"][..],
        &["play", "inputs.mcap"],
        &["view", "inputs.mcap"],
        &["recover", "inputs.mcap", "-o", "out.mcap"],
        &["export", "inputs.mcap", "--csv", "-"],
        &["export", "inputs.mcap", "--inputs", "out.mcap"],
    ] {
        holds(
            command,
            2,
            &["palpate replay inputs.mcap --record OUT.mcap"],
        );
    }

    // Another build: the stretch is named, and the figures before and after.
    let path = Figures::path_for(&inputs);
    let true_ones = Figures::read(&path).unwrap();
    let edited = |edit: &dyn Fn(&mut Figures, &mut Hashes)| {
        let mut figures = true_ones.clone();
        let mut hashes = figures.hashes.take().unwrap();
        edit(&mut figures, &mut hashes);
        figures.hashes = Some(hashes);
        figures.write(&path).unwrap();
    };
    edited(&|figures, hashes| {
        hashes.stretches[1..].fill("0".repeat(16));
        hashes.session = "0".repeat(16);
        figures.tools[0].peak_force_n += 1e-12;
    });
    let stretch = [
        "first difference in outputs of ticks 101 to 200",
        "1 of 4 hashes",
        "tools.ball.peak_force_n",
    ];
    holds(&replay, 1, &stretch);
    let (json, code) = run(&["replay", "inputs.mcap", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(code, 1);
    assert_eq!(
        report["first_difference"]["ticks"],
        serde_json::json!([101, 200])
    );
    edited(&|_, hashes| hashes.nets = "0".repeat(16));
    holds(&replay, 1, &["nets of ticks 1 to 350"]);
    // A blessing changes the text and nothing else, and keeps what is the author's.
    edited(&|figures, hashes| {
        figures.tolerances.force = 1e-3;
        figures.tools[0].rms_force_n *= 1.01;
        hashes.stretches[3] = "0".repeat(16);
    });
    let bless = ["replay", "inputs.mcap", "--check", "hashes", "--bless"];
    holds(
        &bless,
        0,
        &["tools.ball.rms_force_n", "1 figures changed, and hashes"],
    );
    let mut expected = true_ones.clone();
    expected.tolerances.force = 1e-3;
    assert_eq!(Figures::read(&path).unwrap(), expected);
    assert_eq!(std::fs::read(&inputs).unwrap(), kept);
    holds(&bless, 0, &["0 figures changed\n"]);
    holds(&replay, 0, &[well]);

    // Hashes that are missing, or of something else.
    let mut bare = true_ones.clone();
    bare.hashes = None;
    bare.write(&path).unwrap();
    holds(&replay, 2, &["it has no hashes", "--check hashes --bless"]);
    edited(&|_, hashes| hashes.inputs = "0".repeat(16));
    holds(&replay, 2, &["another session", "hash of inputs"]);
    edited(&|figures, _| figures.ticks += 1);
    holds(&replay, 2, &["another session", "number of ticks", "351"]);
    std::fs::write(&path, "{\"format\": \"something\"}").unwrap();
    holds(&replay, 2, &["not figures of this version"]);
    std::fs::remove_file(&path).unwrap();
    holds(&replay, 2, &["--bless` writes it"]);
    true_ones.write(&path).unwrap();

    // Damaged: what is there is run, and nothing passes for the whole.
    for cut in [kept.len() / 2, kept.len() - 100] {
        std::fs::write(&inputs, &kept[..cut]).unwrap();
        holds(&replay, 3, &["the recording is incomplete"]);
        holds(&bless, 3, &["the recording is incomplete"]);
    }
    let mut flipped = kept.clone();
    let at = kept.len() * 2 / 3;
    flipped[at..at + 40].fill(0x55);
    std::fs::write(&inputs, &flipped).unwrap();
    let (told, code) = run(&replay);
    assert!(code >= 2, "{code}: {told}");
    assert_eq!(Figures::read(&path).unwrap(), true_ones);
}
