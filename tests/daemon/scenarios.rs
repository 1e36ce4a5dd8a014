//! Scenarios run, say what they missed, and replay; bodies move by commands of a live daemon.

use crate::daemon::{Daemon, PROGRAM};
use palpate_client::pose_at;
use palpate_experiment::scenario::{NAMES, Report, Scenario, Settings};
use palpate_record::{Session, replay};
use palpate_sim::scene::file;
use palpate_sim::tick::quantity::Number;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Some runs of a scenario, whole.
fn runs(name: &str, only: &[&str]) -> Report {
    let settings = Settings {
        only: only.iter().map(|name| (*name).to_owned()).collect(),
        ..Settings::default()
    };
    let scenario = Scenario::load(name).unwrap_or_else(|e| panic!("{e}"));
    let report = scenario.run(&settings, |_| {});
    report.unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// stdout, stderr, exit code.
fn palpate(arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(PROGRAM).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        text(output.stdout),
        text(output.stderr),
        output.status.code().unwrap_or(-1),
    )
}

/// Scene files in a folder and those below.
fn scenes_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_scene = || std::fs::read_to_string(&path).unwrap().contains("[[body]]");
        if path.is_dir() {
            scenes_in(&path, found);
        } else if path.extension().is_some_and(|e| e == "toml") && is_scene() {
            found.push(path);
        }
    }
}

#[test]
fn nothing_is_found_about_any_scene_that_comes_with_the_program() {
    let mut scenes = Vec::new();
    for folder in ["scenes", "recordings/golden", "examples", "packaging"] {
        scenes_in(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join(folder),
            &mut scenes,
        );
    }
    assert!(scenes.len() > 15, "{scenes:?}");
    for path in scenes {
        let scene = file::load(&path)
            .unwrap()
            .with(palpate_thesis::METHODS)
            .build_to_run();
        let scene = scene.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.warnings(), [], "{}", path.display());
    }
}

#[test]
fn every_scenario_is_listed_and_reads() {
    let (out, err, code) = palpate(&["scenario", "--list"]);
    assert_eq!(code, 0, "{err}");
    for name in NAMES {
        assert!(
            out.lines().any(|line| line.starts_with(name)),
            "{name}: {out}"
        );
        let scenario = Scenario::load(name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!scenario.spec.runs.is_empty() && !scenario.spec.title.is_empty());
    }
    let (_, err, code) = palpate(&["scenario", "nothing"]);
    assert!(code == 2 && err.contains("neither a scenario"), "{err}");
    let (_, err, code) = palpate(&["scenario", "brain", "--run", "fastest"]);
    assert!(code == 2 && err.contains("has no run \"fastest\""), "{err}");
}

// A twentieth of a second each: every scene of every run builds, every hand and measure finds its names.
#[test]
fn every_first_run_begins() {
    std::thread::scope(|scope| {
        for names in NAMES.chunks(NAMES.len().div_ceil(2)) {
            scope.spawn(move || names.iter().for_each(|name| first_run_begins(name)));
        }
    });
}

fn first_run_begins(name: &str) {
    let scenario = Scenario::load(name).unwrap();
    let first = &scenario.spec.runs[0];
    // Modeling steps are tested by themselves.
    if first.merge.is_some() || first.isolate.is_some() {
        return;
    }
    let settings = Settings {
        only: vec![first.name.clone()],
        most_s: Some(0.05),
        ..Settings::default()
    };
    let report = scenario.run(&settings, |_| {});
    let report = report.unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(report.text().contains("run"), "{}", report.text());
}

const PLATE: &str = r#"
[[body]]
id = "plate"
surface = { builtin = "sheet" }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.02] }
"#;

fn folder(directory: &Path, bar: f64) -> String {
    let write = |name: &str, text: &str| std::fs::write(directory.join(name), text).unwrap();
    write("scene.toml", PLATE);
    write(
        "down.toml",
        "[[waypoint]]\ntime_s = 0.0\nposition = [0.0, 0.0, 0.02]\n[[waypoint]]\ntime_s = 0.2\nposition = [0.0, 0.0, 0.008]\n",
    );
    write(
        "scenario.toml",
        &format!(
            "title = \"t\"\n[[run]]\nname = \"a\"\nfor_s = 0.3\nhands = {{ ball = {{ motion = \"down.toml\" }} }}\n\
             [[run]]\nname = \"b\"\nfor_s = 0.3\nset = {{ \"body.plate.motion\" = {{ waypoint = [ {{ time_s = 0.0, position = [0.0, 0.0, 0.0] }}, {{ time_s = 0.2, position = [0.0, 0.0, 0.001] }} ] }} }}\n\
             hands = {{ ball = {{ motion = \"down.toml\" }} }}\n\
             [[measure]]\nname = \"f\"\nunit = \"N\"\nwhat = {{ force = {{ tool = \"ball\" }} }}\nat_most = {bar:?}\n\
             [[claim]]\nsays = \"b more than a\"\nmeasure = \"f\"\ngrowing = [\"a\", \"b\"]\n"
        ),
    );
    directory.to_string_lossy().into_owned()
}

// 2 mm into a spring of 1000 N/m, and 3 mm where the plate comes a millimetre.
#[test]
fn a_missed_bar_is_marked_and_ends_with_1() {
    let directory = tempfile::tempdir().unwrap();
    let name = folder(directory.path(), 5.0);
    let (out, err, code) = palpate(&["scenario", &name, "--json"]);
    assert_eq!(code, 0, "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    for (row, force) in [(0, 2.0), (1, 3.0)] {
        let found = report["rows"][row]["cells"][0]["value"].as_f64().unwrap();
        assert!((found - force).abs() < 1e-6, "{out}");
    }
    assert_eq!(report["claims"][0]["holds"], true);
    let name = folder(directory.path(), 2.5);
    let (out, _, code) = palpate(&["scenario", &name]);
    assert_eq!(code, 1);
    assert!(out.contains("3.000 !") && !out.contains("2.000 !"), "{out}");
    std::fs::write(directory.path().join("down.toml"), "waypoint = 1").unwrap();
    let (_, err, code) = palpate(&["scenario", &name]);
    assert!(code == 2 && err.contains("down.toml"), "{err}");
}

#[test]
fn every_quantity_of_a_tool_is_measured_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let name = folder(directory.path(), 5.0);
    let file = directory.path().join("scenario.toml");
    let mut text = std::fs::read_to_string(&file).unwrap();
    let measure = |name: &str| {
        format!(
            "[[measure]]\nname = \"{name}\"\nwhat = {{ quantity = {{ tool = \"ball\", name = \"{name}\" }} }}\n"
        )
    };
    Number::names().for_each(|name| text += &measure(name));
    std::fs::write(&file, &text).unwrap();
    let report = runs(&name, &["a"]);
    for of in Number::names() {
        assert!(report.value("a", of).is_some(), "{of}");
    }
    assert_eq!(report.value("a", "force"), report.value("a", "f"));
    std::fs::write(&file, text + &measure("banana")).unwrap();
    let (_, err, code) = palpate(&["scenario", &name]);
    assert!(code == 2 && err.contains("contact_force_x_n"), "{err}");
}

#[test]
fn a_run_is_recorded_and_replays_to_the_bit() {
    let directory = tempfile::tempdir().unwrap();
    let name = folder(directory.path(), 5.0);
    let file = directory.path().join("b.mcap");
    let settings = Settings {
        only: vec!["b".into()],
        record: Some(file.clone()),
        ..Settings::default()
    };
    let scenario = Scenario::load(&name).unwrap();
    let first = scenario.run(&settings, |_| {}).unwrap();
    let again = scenario
        .run(
            &Settings {
                record: None,
                ..settings
            },
            |_| {},
        )
        .unwrap();
    assert_eq!(first.rows[0].state_hash, again.rows[0].state_hash);
    assert_eq!(first.rows[0].ticks, 300);
    let session = Session::open(&file).unwrap();
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(report.passed(), "{:?}", report.first_difference);
    assert_eq!(session.tick_count(), 300);
}

#[test]
fn organs_come_apart_and_the_pipe_is_as_wide_as_the_paper_s() {
    let brain = runs("brain", &["nearest local minimum"]);
    assert!(brain.passed, "{}", brain.text());
    let pipe = runs("vessel-probe", &["pipe"]);
    assert!(pipe.passed, "{}", pipe.text());
}

// Each is over in a second or two on an idle processor.
#[test]
fn a_handle_is_bent_and_pulled_two_hands_meet_and_a_vessel_is_probed() {
    for (name, run) in [
        ("spoon-bend", "bent"),
        ("spoon-grip", "four grips"),
        ("two-hands", "both hands"),
        ("vessel-probe", "vessel"),
    ] {
        let report = runs(name, &[run]);
        assert!(report.passed, "{}", report.text());
    }
}

#[test]
fn a_body_is_moved_by_a_command_of_a_live_daemon() {
    let directory = tempfile::tempdir().unwrap();
    let plate = PLATE.replace(
        "\"sheet\" }",
        "\"sheet\" }\npose = { position = [1.0, 0.0, 0.0] }",
    );
    let text = format!(
        "{plate}\n[[body]]\nid = \"tray\"\nsurface = {{ builtin = \"sheet\" }}\npose = {{ position = [0.0, 0.0, -0.1] }}\nmotion = {{}}\n"
    );
    let daemon = Daemon::start(directory.path(), &text, &[]);
    let rpc = |arguments: &str| palpate(&["rpc", "move_body", arguments, "-e", &daemon.endpoint]);
    for (arguments, words) in [
        (
            r#"{"body": "plate", "position": [0, 0, 0.1]}"#,
            "cannot be moved",
        ),
        (r#"{"body": "dish", "position": [0, 0, 0.1]}"#, "no body"),
        (r#"{"body": "tray", "position": [0, 0]}"#, "three numbers"),
        (
            r#"{"body": "tray", "position": [0, 0, 0], "orientation": [0, 0, 0, 2]}"#,
            "unit quaternion",
        ),
        (r#"{"body": "tray"}"#, "position"),
    ] {
        let (_, err, code) = rpc(arguments);
        assert!(code == 2 && err.contains(words), "{arguments}: {err}");
    }
    // Up through the middle of the ball's way: it lifts the ball by 6 mm, against 1000 N/m.
    let client = daemon.connect();
    let mut tool = client.tool("ball").unwrap();
    let (_, err, code) = rpc(r#"{"body": "tray", "position": [0, 0, -0.004], "seconds": 0.2}"#);
    assert_eq!(code, 0, "{err}");
    let until = Instant::now() + Duration::from_secs(20);
    let mut force = 0.0;
    while Instant::now() < until && (force - 6.0_f64).abs() > 1e-6 {
        let seq = tool.send(pose_at([0.0, 0.0, 0.0])).unwrap();
        if let Some(answer) = tool.wait_force(seq, Duration::from_millis(50)) {
            force = answer.force[2];
        }
    }
    assert!((force - 6.0).abs() < 1e-6, "{force} N");
}
