//! Those who speak with us in other languages: the Python and TypeScript clients on the golden
//! messages, and public readers on the golden recordings. Each part runs where its tools are
//! (`.ci/run` fetches them) and says so where they are not.

use crate::daemon::Daemon;
use crate::golden::{golden, made_again};
use crate::scenes::RIGID_TEARDROP;
use palpate_record::{Session, info};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Whether a program starts and ends well.
fn works(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .output()
        .is_ok_and(|done| done.status.success())
}

/// Runs to the end, which must be a good one; gives stdout.
fn run(command: &mut Command) -> String {
    // Python leaves no compiled files between the sources.
    let done = command
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    let (out, err) = (
        String::from_utf8_lossy(&done.stdout),
        String::from_utf8_lossy(&done.stderr),
    );
    assert!(done.status.success(), "{command:?}\n{out}{err}");
    out.into_owned()
}

/// A Python that has these modules, from these packages: `PALPATE_PYTHON`, or else `python3`.
fn python_with(modules: &str, packages: &str) -> Option<String> {
    let name = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = works(&name, &["-c", &format!("import {modules}")]);
    if !has {
        println!("skipped: {name} lacks {modules} (pip install {packages})");
    }
    has.then_some(name)
}

fn reading_python() -> Option<String> {
    python_with("mcap, mcap_protobuf", "mcap mcap-protobuf-support")
}

/// Whole recordings: with views and without, of one tool and of several, of rigid bodies and of soft
/// ones.
fn whole_recordings() -> Vec<PathBuf> {
    let mut files = golden();
    files.retain(|path| Session::open(path).is_ok());
    assert!(files.len() >= 2, "only {files:?}");
    files.push(made_again("two-hands"));
    files
}

#[test]
fn the_python_client_reads_and_writes_every_golden_message() {
    // 3.9 is the oldest that it says it runs on.
    if !works(
        "python3",
        &["-c", "import sys; sys.exit(sys.version_info < (3, 9))"],
    ) {
        println!("skipped: no python3 of 3.9 or later");
        return;
    }
    run(Command::new("python3")
        .args(["-m", "unittest", "discover"])
        .current_dir(root().join("clients/python")));
}

#[test]
fn a_python_program_presses_a_tool_into_a_running_scene() {
    let Some(python) = python_with("zenoh", "eclipse-zenoh") else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let example = root().join("clients/python/examples/press.py");
    let text =
        run(Command::new(&python)
            .arg(&example)
            .args(["ball", "--connect", &daemon.endpoint]));
    // "916 poses, 1996 forces, 909 with contact, at most 8.00 N"
    let counts: Vec<u64> = text
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    assert!(
        matches!(counts[..], [poses, forces, contacts] if poses > 0 && forces > 0 && contacts > 0),
        "{text}"
    );
    // A tool that the scene does not have is told by name, before anything is sent.
    let other = Command::new(&python)
        .arg(&example)
        .args(["pen", "--connect", &daemon.endpoint])
        .output()
        .unwrap();
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("ball"));
}

#[test]
fn a_python_program_decodes_all_that_is_said_and_a_tool_that_leaves_is_told_once() {
    let Some(python) = python_with("zenoh", "eclipse-zenoh") else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let script = root().join("tests/readers/hear_all.py");
    let told: Value = serde_json::from_str(&run(Command::new(&python)
        .arg(script)
        .args([&daemon.endpoint, "ball"])))
    .unwrap();
    assert_eq!(told["wrong"], serde_json::json!([]), "{told}");
    for name in [
        "ToolPose.v1",
        "ToolForce.v1",
        "ToolContact.v1",
        "ContactSet.v1",
        "ControlNet.v1",
        "SimEvent.v1",
    ] {
        assert!(
            told["messages"][format!("palpate.{name}")].as_u64() > Some(0),
            "no {name}: {told}"
        );
    }
    // On a starved machine a tool may come and go, but it comes as often as it goes.
    let [joined, lost] = ["ToolJoined", "ToolLost"].map(|kind| told["events"][kind].as_u64());
    assert!(joined == lost && joined > Some(0), "{told}");
}

#[test]
fn the_typescript_client_reads_and_writes_every_golden_message() {
    let directory = root().join("clients/web");
    if !directory.join("node_modules").is_dir() {
        println!("skipped: nothing is installed in clients/web (npm ci)");
        return;
    }
    run(Command::new("npm").arg("test").current_dir(directory));
}

#[test]
fn public_readers_decode_every_message_of_every_golden_recording() {
    let Some(python) = reading_python() else {
        return;
    };
    let read = |file: &Path| -> Value {
        let script = root().join("tests/readers/read_all.py");
        serde_json::from_str(&run(Command::new(&python).arg(script).arg(file))).unwrap()
    };
    let whole = whole_recordings();
    for file in golden().iter().filter(|file| !whole.contains(file)) {
        let inputs = &read(file)["topics"]["/sim/inputs"];
        assert_eq!(inputs["schema"], "palpate.v1.Inputs", "{}", file.display());
        assert!(inputs["count"].as_u64() > Some(0), "{}", file.display());
    }
    for file in whole {
        let told = read(&file);
        let session = Session::open(&file).unwrap();
        let figures = info(&session).unwrap();
        let counted = |topic: &str| told["topics"][topic]["count"].as_u64();
        assert_eq!(
            counted("/sim/tick"),
            Some(figures.ticks),
            "{}",
            file.display()
        );
        assert_eq!(
            counted("/sim/keyframe"),
            Some(figures.keyframes),
            "{}",
            file.display()
        );
        assert_eq!(
            counted("/sim/command"),
            Some(figures.commands),
            "{}",
            file.display()
        );
    }
}

#[test]
fn the_checker_of_recordings_finds_what_is_wrong() {
    let Some(python) = reading_python() else {
        return;
    };
    run(Command::new(python)
        .args(["-m", "unittest", "test_read_all"])
        .current_dir(root().join("tests/readers")));
}

#[test]
fn the_example_that_reads_recordings_has_our_figures() {
    let Some(python) = reading_python() else {
        return;
    };
    let example = root().join("clients/python/examples/read_recording.py");
    for file in whole_recordings() {
        let text = run(Command::new(&python).arg(&example).arg("--json").arg(&file));
        let told: Value = serde_json::from_str(&text).unwrap();
        let figures = info(&Session::open(&file).unwrap()).unwrap();
        assert_eq!(told["scene"], figures.scene);
        for tool in &figures.tools {
            let peak = told["peak_force_n"][&tool.id].as_f64().unwrap();
            // The same three numbers, their squares added in another order.
            assert!(
                (peak - tool.peak_force_n).abs() <= 1e-12 * peak,
                "{}: {peak} N",
                tool.id
            );
            assert!(peak > 0.05, "{}: nothing was touched", tool.id);
        }
    }
    // What is no recording is told in one line, with the exit code of an incomplete one.
    let cut = Command::new(&python)
        .arg(&example)
        .arg(root().join("Cargo.toml"))
        .output()
        .unwrap();
    assert_eq!(cut.status.code(), Some(3));
    assert_eq!(String::from_utf8_lossy(&cut.stderr).lines().count(), 1);
}
