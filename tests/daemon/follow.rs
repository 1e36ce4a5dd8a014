//! Ticks that follow the poses of a device, and ticks on a fixed grid.

use crate::daemon::Daemon;
use crate::editing::replays;
use palpate_client::pose_at;
use palpate_client::proto::messages::LoopStatus;
use palpate_client::proto::rpc::Call;
use palpate_record::{Contents, Session};
use std::path::Path;
use std::time::{Duration, Instant};

/// At 50 Hz, so that no machine is too busy for a client that sends once a tick.
const SCENE: &str = r#"
[loop]
rate_hz = 50

[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }

[[tool]]
id = "pen"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
"#;

/// Poses after which deadlines have come half a period, 10 ms, wherever they began, in steps of 20 µs a tick.
const POSES: u32 = 600;

/// A client that sends so many poses, one every 20 ms: the last status, and the recording, which replays.
fn session(directory: &Path, poses: u32, arguments: &[&str]) -> (LoopStatus, Session) {
    let path = directory.join("session.mcap");
    let record = ["--record", path.to_str().unwrap()];
    let daemon = Daemon::start(directory, SCENE, &[&record[..], arguments].concat());
    let palpate = daemon.connect();
    let mut tool = palpate.tool("pen").unwrap();
    let begun = Instant::now();
    for k in 1..=poses {
        let due = begun + Duration::from_millis(20) * k;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        let deep = 0.004 * (f64::from(k) / 100.0).min(1.0);
        tool.send(pose_at([0.036 - deep, 0.003, 0.045])).unwrap();
    }
    let status = palpate.status().unwrap();
    drop(tool);
    palpate.rpc(Call::Shutdown).unwrap();
    palpate.close();
    let (_, code) = daemon.end();
    assert_eq!(code, 0);
    (status, replays(&path, 0).0)
}

/// Waits and shifts of the ticks that took a pose, ns.
fn waits(session: &Session) -> Vec<(u64, i64)> {
    let ticks = Contents::of(session).unwrap().ticks;
    let waits = ticks
        .iter()
        .filter_map(|tick| Some((tick.wait_ns?, tick.shift_ns)));
    waits.collect()
}

#[test]
fn ticks_follow_a_device_unless_they_are_on_a_fixed_grid_and_both_replay_to_the_same_bits() {
    let directory = tempfile::tempdir().unwrap();
    let (status, recorded) = session(directory.path(), POSES, &[]);
    assert_eq!(status.followed_tool, "pen");
    let following = waits(&recorded);
    assert!(following.len() > 450, "{} poses", following.len());
    assert!(following.iter().any(|&(_, shift_ns)| shift_ns != 0));
    // Nearly all of a busy machine's: a pose on a fixed grid waits 10 ms in the mean.
    let mut last: Vec<u64> = following.iter().rev().take(50).map(|pose| pose.0).collect();
    last.sort_unstable();
    assert!(last[25] < 5_000_000, "{last:?}");
    assert!(status.wait.p50_ns > 0 && status.wait.max_ns >= status.wait.p50_ns);

    let directory = tempfile::tempdir().unwrap();
    let (status, recorded) = session(directory.path(), 200, &["--fixed-phase"]);
    assert_eq!((&*status.followed_tool, status.shift_s), ("", 0.0));
    let fixed = waits(&recorded);
    assert!(fixed.len() > 150 && fixed.iter().all(|&(_, shift_ns)| shift_ns == 0));
}
