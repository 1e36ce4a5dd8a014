//! Golden recordings: what was simulated once is simulated again, bit for bit, by debug and release builds alike.

use palpate::recording::{Session, replay};
use std::path::Path;

#[test]
fn golden_recordings_replay_to_the_bit_and_to_their_hashes() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/golden");
    let table = std::fs::read_to_string(directory.join("README.md")).unwrap();
    let mut replayed = 0;
    for entry in std::fs::read_dir(&directory).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "mcap") {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let row = table
            .lines()
            .find(|line| line.starts_with('|') && line.contains(&name))
            .unwrap_or_else(|| panic!("{name} is not described"));
        let report = replay(&Session::open(&path).unwrap(), 0, |_, _| {}).unwrap();
        assert!(report.passed(), "{name}: {:?}", report.first_difference);
        assert!(row.contains(&report.session_hash), "{name}: hash {} is not the one described", report.session_hash);
        replayed += 1;
    }
    assert!(replayed >= 2, "only {replayed} recordings were found");
}
