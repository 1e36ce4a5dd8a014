//! Daemons that are killed, and disks that are full, as processes see them.

use crate::daemon::{Daemon, PROGRAM, device};
use crate::scenes::SOFT_DROP as SCENE;
use palpate_client::proto::messages::EventKind;
use palpate_client::proto::rpc::Call;
use palpate_client::{Connect, Palpate, pose_at};
use palpate_record::{Session, replay};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Runs the program; gives stdout, stderr and the exit code.
fn palpate(arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(PROGRAM)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code().unwrap_or(-1),
    )
}

// `palpate-bench recording --only kill` does the same a hundred times, and on disks that take seconds for a
// sync; what they leave then is in `slow_disk`.
#[test]
fn a_killed_daemon_leaves_all_but_a_quarter_of_a_second() {
    let directory = tempfile::tempdir().unwrap();
    for (k, after_ms) in [150, 700].into_iter().enumerate() {
        let file = directory.path().join(format!("{k}.mcap"));
        let mut daemon = Daemon::start(
            directory.path(),
            SCENE,
            &["--record", file.to_str().unwrap()],
        );
        let client = daemon.connect();
        let mut tool = client.tool("ball").unwrap();
        let (begun, mut first) = (Instant::now(), None);
        while first.is_none_or(|first: Instant| first.elapsed() < Duration::from_millis(after_ms)) {
            tool.send(pose_at([0.05, 0.003, 0.045])).unwrap();
            if tool.force().is_some() {
                first.get_or_insert_with(Instant::now);
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "no force");
            std::thread::sleep(Duration::from_millis(1));
        }
        daemon.child.kill().unwrap();
        daemon.child.wait().unwrap();
        let seen = tool.force().unwrap().tick;
        let part = format!("{}.part", file.display());
        // A quarter of a second, and what a loaded machine may keep the recorder's thread waiting.
        let (text, words, code) = palpate(&["recover", &part, "--json"]);
        assert_eq!(code, 0, "{words}");
        let told: serde_json::Value = serde_json::from_str(&text).unwrap();
        let last = told["last_tick"].as_u64().unwrap();
        assert!(
            last + 1_000 >= seen,
            "tick {seen} was seen, {last} is the last of the file"
        );
        println!("killed at tick {seen}, recovered up to {last}");
        let session = Session::open(&file).unwrap();
        assert!(session.gaps() == 0 && !session.is_clean());
        let report = replay(&session, 0, |_, _| {}).unwrap();
        assert!(
            report.first_difference.is_none() && report.ticks_matched == last,
            "{report:?}"
        );
        // It is not recovered onto itself.
        let (_, words, code) = palpate(&["recover", &part]);
        assert!(
            code == 2 && words.contains("exists already"),
            "{code}: {words}"
        );
    }
}

/// A daemon whose files may not grow beyond a quarter of a megabyte, some of it for the head of a
/// recording: what a full disk does.
#[test]
fn a_full_disk_is_told_and_the_loop_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let file = directory.path().join("full.mcap");
    let port = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let limited = format!(
        "trap '' XFSZ; ulimit -f 512; exec {PROGRAM} serve {} --listen {endpoint} --no-rt --record {}",
        scene.display(),
        file.display()
    );
    let mut child = Command::new("sh")
        .args(["-c", &limited])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let client = loop {
        match Palpate::connect(&Connect {
            timeout: Duration::from_secs(20),
            ..Connect::to(&endpoint)
        }) {
            Ok(client) => break client,
            Err(error) => assert!(begun.elapsed() < Duration::from_secs(60), "{error}"),
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let failures = Arc::new(Mutex::new(Vec::new()));
    let heard = failures.clone();
    let _events = client
        .events(move |event| {
            if let EventKind::RecordFailed { path, reason } = event.kind {
                heard.lock().unwrap().push((path, reason));
            }
        })
        .unwrap();
    let (report, code) = device(&endpoint, &["--motion", "slide", "--for", "3s"]);
    assert_eq!(code, 0, "the loop goes on: {report}");
    let begun = Instant::now();
    while failures.lock().unwrap().is_empty() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nobody was told");
        std::thread::sleep(Duration::from_millis(20));
    }
    let (path, reason) = failures.lock().unwrap()[0].clone();
    assert!(
        Path::new(&path).ends_with("full.mcap")
            && reason.contains("full.mcap.part")
            && reason.contains("File too large"),
        "{path}: {reason}"
    );
    client.rpc(Call::Shutdown).unwrap();
    client.close();
    assert_eq!(
        child.wait().unwrap().code(),
        Some(3),
        "an incomplete recording is no success"
    );
    let session = Session::open(&directory.path().join("full.mcap.part")).unwrap();
    assert!(session.tick_count() > 100 && session.gaps() == 0);
    assert!(
        replay(&session, 0, |_, _| {})
            .unwrap()
            .first_difference
            .is_none()
    );
}

#[test]
fn two_signals_end_a_daemon_and_one_ends_it_well() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("signal.mcap");
    let daemon = Daemon::start(
        directory.path(),
        SCENE,
        &["--record", file.to_str().unwrap()],
    );
    // It listens before it ticks.
    let client = daemon.connect();
    while client.status().unwrap().tick < 50 {
        std::thread::sleep(Duration::from_millis(5));
    }
    client.close();
    let pid = daemon.child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let (text, code) = daemon.end();
    assert_eq!(code, 0, "{text}");
    assert!(
        replay(&Session::open(&file).unwrap(), 0, |_, _| {})
            .unwrap()
            .passed()
    );
}
