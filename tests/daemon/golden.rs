//! Golden recordings: what was simulated once is simulated again, bit for bit, by debug and release
//! builds alike (`cargo test` and `cargo test --release` run the same files), with every set of
//! instructions there is. All but two hold inputs only; hashes and figures of what came of them are
//! beside each.

use palpate_record::{Figures, Session, deviations, record_again, simulate};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/golden")
}

/// Golden recordings, by name.
pub fn golden() -> Vec<PathBuf> {
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

/// A golden recording with all that this build makes of its inputs: forces, nets, keyframes.
pub fn made_again(name: &str) -> PathBuf {
    static MADE: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let place = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = place.join(name).with_extension("mcap");
    let mut made = MADE.lock().unwrap();
    if !made.contains(name) {
        let mut files = golden().into_iter();
        let source = files.find(|path| file_name(path).split('.').next() == Some(name));
        let own = place.join(format!("{name}-{}.mcap", std::process::id()));
        let session = Session::open_any(&source.unwrap()).unwrap();
        record_again(&session, &own, |_, _| {}).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Another process may be reading what it has made.
        std::fs::rename(own, &path).unwrap();
        made.insert(name.to_owned());
    }
    path
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

// After a change that is meant: `recordings/golden/make.sh --bless`.
#[test]
fn golden_recordings_come_to_their_hashes_and_figures() {
    for path in golden() {
        let (name, figures) = (file_name(&path), Figures::path_for(&path));
        let expected = Figures::read(&figures).unwrap_or_else(|e| panic!("{e}"));
        let found = simulate(&Session::open_any(&path).unwrap(), |_, _| {}).unwrap();
        let hashes = expected.hashes_of_session(&found, &figures);
        let hashes = hashes.unwrap_or_else(|e| panic!("{e}"));
        let mut off: Vec<String> = deviations(&expected, &found.figures, true)
            .iter()
            .map(ToString::to_string)
            .collect();
        let first = hashes.first_difference(&found.hashes, found.figures.ticks);
        off.extend(first.map(|first| first.to_string()));
        assert!(off.is_empty(), "{name}:\n{}", off.join("\n"));
        assert_eq!(hashes, &found.hashes, "{name}");
        // A scene without tools is of bodies that touch each other.
        let tools = &found.figures.tools;
        assert!(
            tools.is_empty() || tools.iter().any(|tool| tool.contact_ticks > 0),
            "{name}: nothing is touched"
        );
    }
}

// In a process of its own: the processor is asked once.
#[test]
fn golden_recordings_come_to_their_hashes_without_avx2() {
    // Two at a time: without wide registers a tick takes longer.
    for pair in golden().chunks(2) {
        let runs = pair.iter().map(|path| {
            let run = Command::new(env!("CARGO_BIN_EXE_palpate"))
                .args(["replay", "--check", "hashes"])
                .arg(path)
                .env("PALPATE_SIMD", "baseline")
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn();
            (path, run.unwrap())
        });
        for (path, run) in runs.collect::<Vec<_>>() {
            let output = run.wait_with_output().unwrap();
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            let text = text(&output.stdout) + &text(&output.stderr);
            assert!(output.status.success(), "{}: {text}", file_name(path));
            let session = Figures::read(&Figures::path_for(path)).unwrap().hashes;
            assert!(text.contains(&session.unwrap().session), "{text}");
        }
    }
}

// Two are whole, for viewers and for readers of recordings.
#[test]
fn golden_recordings_are_small_and_described() {
    let whole: Vec<String> = golden()
        .iter()
        .filter(|path| Session::open(path).is_ok())
        .map(|path| file_name(path))
        .collect();
    assert_eq!(whole, ["rigid-teardrop-press.mcap", "teardrop-tap.mcap"]);
    let files = std::fs::read_dir(directory()).unwrap();
    let bytes: u64 = files
        .map(|file| file.unwrap().metadata().unwrap().len())
        .sum();
    assert!(bytes <= 1_100_000, "{bytes} bytes");
    let table = std::fs::read_to_string(directory().join("README.md")).unwrap();
    for path in golden() {
        let row = format!("| `{}` |", file_name(&path));
        assert!(table.contains(&row), "{row} is not described");
    }
}

// A scene that people start from is one whose bits are watched.
#[test]
fn every_scene_has_a_golden_recording() {
    let recorded: Vec<String> = golden()
        .iter()
        .map(|path| {
            let session = Session::open_any(path).unwrap();
            session.header.run["scene"].clone()
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
