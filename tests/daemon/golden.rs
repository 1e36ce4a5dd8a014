//! Golden recordings: what was simulated once is simulated again, bit for bit, by debug and release
//! builds alike (`cargo test` and `cargo test --release` replay the same files), with every set of
//! instructions there is, and by figures.

use palpate::recording::{
    Contents, Figures, Session, SessionHash, Start, deviations, replay, simulate_figures,
};
use std::path::{Path, PathBuf};
use std::process::Command;

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/golden")
}

/// Golden recordings, by name.
fn golden() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|e| e == "mcap"))
        .collect();
    paths.sort();
    assert!(
        paths.len() >= 2,
        "only {} recordings were found",
        paths.len()
    );
    paths
}

fn name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

#[test]
fn golden_recordings_replay_to_the_bit_and_to_their_hashes() {
    let table = std::fs::read_to_string(directory().join("README.md")).unwrap();
    for path in golden() {
        let name = name(&path);
        let row = table
            .lines()
            .find(|line| line.starts_with('|') && line.contains(&name))
            .unwrap_or_else(|| panic!("{name} is not described"));
        let report = replay(&Session::open(&path).unwrap(), 0, |_, _| {}).unwrap();
        assert!(report.passed(), "{name}: {:?}", report.first_difference);
        assert!(
            row.contains(&report.session_hash),
            "{name}: hash {} is not the one described",
            report.session_hash
        );
    }
}

// In a process of its own: the processor is asked once.
#[test]
fn golden_recordings_replay_to_the_bit_without_avx2() {
    for path in golden() {
        let output = Command::new(env!("CARGO_BIN_EXE_palpate"))
            .args(["replay", "--json"])
            .arg(&path)
            .env("PALPATE_SIMD", "baseline")
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{}: {text}", name(&path));
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        let mut hash = SessionHash::default();
        let session = Contents::open(&path).unwrap();
        session
            .ticks
            .iter()
            .for_each(|record| hash.push(record.output.tick, record.output.state_hash));
        assert_eq!(
            report["session_hash"],
            format!("{:016x}", hash.0),
            "{}",
            name(&path)
        );
    }
}

// What another version must come to as well. After a change that is meant: `palpate replay FILE
// --check figures --bless`.
#[test]
fn golden_recordings_keep_their_figures() {
    for path in golden() {
        let expected = Figures::read(&Figures::path_for(&path)).unwrap_or_else(|e| panic!("{e}"));
        let (found, start) = simulate_figures(&Session::open(&path).unwrap(), |_, _| {}).unwrap();
        assert_eq!(start, Start::Keyframe, "{}", name(&path));
        let off: Vec<String> = deviations(&expected, &found, false)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert!(off.is_empty(), "{}: {}", name(&path), off.join("\n"));
        // A scene without tools is of bodies that touch each other.
        assert!(
            found.tools.is_empty() || found.tools.iter().any(|tool| tool.contact_ticks > 0),
            "{}: nothing is touched",
            name(&path)
        );
    }
}

#[test]
fn golden_recordings_are_small() {
    for path in golden() {
        let bytes = std::fs::metadata(&path).unwrap().len();
        assert!(bytes <= 1_000_000, "{} has {bytes} bytes", name(&path));
    }
}

// A scene that people start from is one whose bits are watched.
#[test]
fn every_scene_has_a_golden_recording() {
    let recorded: Vec<String> = golden()
        .iter()
        .map(|path| {
            Session::open(path)
                .unwrap()
                .header
                .run
                .get("scene")
                .cloned()
                .unwrap_or_default()
        })
        .collect();
    let scenes = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap();
    let scenes = scenes
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"));
    let mut missing: Vec<String> = scenes
        .map(|path| {
            palpate_sim::scene::file::load(&path)
                .unwrap_or_else(|e| panic!("{e}"))
                .spec
                .name
                .unwrap_or_default()
        })
        .filter(|name| !recorded.contains(name))
        .collect();
    missing.sort();
    assert!(
        missing.is_empty(),
        "no golden recording of the scenes {}; there are {}",
        missing.join(", "),
        recorded.join(", ")
    );
}
