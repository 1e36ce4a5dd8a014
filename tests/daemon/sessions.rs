//! Sessions end to end: a daemon and a simulated device as separate processes, recordings, replay,
//! garbage.

use crate::daemon::{Daemon, device};
use crate::scenes::SOFT_DROP as SCENE;
use palpate_client::pose_at;
use palpate_client::proto::rpc::Call;
use palpate_record::{Contents, Session, info, recover, replay};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// A recorded lockstep session of two seconds.
fn lockstep(directory: &Path, name: &str) -> PathBuf {
    let file = directory.join(name);
    let daemon = Daemon::start(
        directory,
        SCENE,
        &[
            "--clock",
            "lockstep",
            "--for",
            "2s",
            "--record",
            file.to_str().unwrap(),
        ],
    );
    let (report, code) = device(
        &daemon.endpoint,
        &[
            "--motion", "press", "--for", "2s", "--seed", "5", "--tremor", "1e-4",
        ],
    );
    assert_eq!(code, 0, "{report}");
    let (text, code) = daemon.end();
    assert_eq!(code, 0, "{text}");
    file
}

#[test]
fn two_lockstep_sessions_in_separate_processes_are_equal_to_the_bit_and_replay() {
    let directory = tempfile::tempdir().unwrap();
    let first = Session::open(&lockstep(directory.path(), "a.mcap")).unwrap();
    let second = Session::open(&lockstep(directory.path(), "b.mcap")).unwrap();
    let (a, b) = (info(&first).unwrap(), info(&second).unwrap());
    assert_eq!(a.ticks, 2_000);
    assert!(a.clean && a.gaps == 0 && a.dropped_records == 0, "{a}");
    assert!(
        a.tools[0].contact_ticks > 500 && a.tools[0].peak_force_n > 0.01,
        "{a}"
    );
    assert_eq!(
        (&a.session_hash, &a.final_hash),
        (&b.session_hash, &b.final_hash)
    );

    let report = replay(&first, 0, |_, _| {}).unwrap();
    assert!(report.passed(), "{:?}", report.first_difference);
    assert_eq!(report.ticks_matched, 2_000);
    assert!(report.nets_matched > 10);
    // From a keyframe in the middle as well.
    let half = replay(&first, 1_500, |_, _| {}).unwrap();
    assert!(
        half.first_difference.is_none() && half.ticks_matched == 1_000,
        "{half:?}"
    );

    // One changed bit of one recorded pose: the tick and a field are named.
    let mut forged = Contents::of(&first).unwrap();
    let pose = forged.ticks[900].input.poses[0].as_mut().unwrap();
    pose.position.x = f64::from_bits(pose.position.x.to_bits() ^ 1 << 20);
    let difference = replay(&forged.session().unwrap(), 0, |_, _| {})
        .unwrap()
        .first_difference
        .expect("a forged pose went unnoticed");
    assert_eq!(difference.tick, 901);
    assert!(difference.field.starts_with("tools[0]."), "{difference:?}");
}

#[test]
fn a_real_time_session_runs_beside_garbage_and_its_recording_survives_a_kill() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("killed.mcap");
    let mut daemon = Daemon::start(
        directory.path(),
        SCENE,
        &["--record", file.to_str().unwrap()],
    );
    let palpate = daemon.connect();
    let scene = palpate.scene().unwrap();
    assert_eq!(
        scene.bodies[0].points.len(),
        usize::from(scene.bodies[0].count[0]) * usize::from(scene.bodies[0].count[1])
    );

    // NaN poses, bent quaternions and old numbers, among good ones.
    let mut tool = palpate.tool("ball").unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    // Poses of one moment replace each other, and a full network drops them: more are sent until
    // enough have arrived.
    while palpate
        .status()
        .unwrap()
        .tools
        .first()
        .is_none_or(|tool| tool.not_finite + tool.bad_quaternion < 500)
    {
        assert!(
            Instant::now() < deadline,
            "{:?}",
            palpate.status().unwrap().tools
        );
        for k in 0..400 {
            let mut pose = pose_at([0.06, 0.003, 0.045]);
            match k % 4 {
                0 => pose.position[1] = f64::NAN,
                1 => pose.orientation = [0.0, 0.0, 0.0, 2.0],
                _ => {}
            }
            tool.send(pose).unwrap();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let before = palpate.status().unwrap().tick;
    // The next holder's numbers start anew.
    drop(tool);
    let (text, code) = device(&daemon.endpoint, &["--motion", "tap", "--for", "2s"]);
    assert_eq!(code, 0, "{text}");
    println!("device in real time: {text}");
    let status = palpate.status().unwrap();
    println!("status: {status:?}");
    assert!(status.tick > before, "the loop stood still");
    assert!(
        status.tools[0].energy_j != 0.0,
        "the device never touched the drop: {:?}",
        status.tools
    );
    assert!(palpate.rpc(Call::Pause).unwrap() > status.tick);

    // Killed without a word.
    std::thread::sleep(Duration::from_secs(2));
    daemon.child.kill().unwrap();
    daemon.child.wait().unwrap();
    let part = directory.path().join("killed.mcap.part");
    let mended = directory.path().join("mended.mcap");
    let recovered = recover(&part, &mended).unwrap();
    assert!(
        recovered.ticks >= status.tick,
        "{recovered:?} but tick {} was seen",
        status.tick
    );
    let session = Session::open(&mended).unwrap();
    assert!(!session.is_clean() && session.gaps() == 0);
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(
        report.first_difference.is_none(),
        "{:?}",
        report.first_difference
    );
}

#[test]
fn truncated_and_foreign_files_are_told_apart_and_never_panic() {
    let directory = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(lockstep(directory.path(), "whole.mcap")).unwrap();
    let whole = Session::parse(Path::new("whole"), &bytes).unwrap();
    let mut readable = 0;
    for k in 1..100 {
        let cut = bytes.len() * k / 100;
        if let Ok(session) = Session::parse(Path::new("cut"), &bytes[..cut]) {
            readable += 1;
            assert!(session.cut_short().is_some());
            assert!(session.tick_count() <= whole.tick_count());
            assert_eq!(session.gaps(), 0, "cut at {k} %");
        }
    }
    assert!(readable > 50, "only {readable} of 99 pieces were readable");
    for (name, content) in [
        ("empty", &b""[..]),
        ("text", b"hello"),
        ("magic", mcap_magic()),
    ] {
        let path = directory.path().join(name);
        std::fs::File::create(&path)
            .unwrap()
            .write_all(content)
            .unwrap();
        let output = Command::new(crate::daemon::PROGRAM)
            .arg("replay")
            .arg(&path)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{name}: {told}");
        assert!(
            told.contains("not an MCAP file") || told.contains("not a Palpate recording"),
            "{name}: {told}"
        );
    }
}

fn mcap_magic() -> &'static [u8] {
    &[0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n']
}
