//! `--igtl`: trackers and viewers that speak OpenIGTLink.

use crate::daemon::{Daemon, free_port};
use crate::page::wait_for;
use palpate_devices::igtl::{HEADER, Header, transform};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::scenes::RIGID_TEARDROP as SCENE;
const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

fn start() -> (tempfile::TempDir, Daemon, u16) {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let daemon = Daemon::start(directory.path(), SCENE, &["--igtl", &port.to_string()]);
    wait_for(port);
    (directory, daemon, port)
}

fn connect(port: u16) -> TcpStream {
    let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    stream
}

#[test]
fn a_tracker_moves_a_tool_that_stops_at_the_surface_and_the_next_one_takes_over() {
    let (_files, daemon, port) = start();
    let palpate = daemon.connect();
    let newest = palpate.forces("ball").unwrap();
    let mut first = connect(port);
    let begun = Instant::now();
    let mut x: f64 = 0.06;
    while newest.get().is_none_or(|force| force.force[0] < 0.5) {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "it does not press"
        );
        x = (x - 2e-4).max(0.0255);
        first
            .write_all(&transform("ball", 0, [x, 0.003, 0.045], UNTURNED))
            .unwrap();
        std::thread::sleep(Duration::from_millis(2));
    }
    // What comes back is the proxy: at the surface, not in it.
    let mut head = [0; HEADER];
    first.read_exact(&mut head).unwrap();
    let header = Header::read(&head).unwrap();
    let mut body = vec![0; header.body as usize];
    first.read_exact(&mut body).unwrap();
    assert_eq!(header.device, "ball");
    assert!(header.pose(&body).unwrap().unwrap().position[0] > 0.024);
    // Another one has it only when the first is gone.
    let mut second = connect(port);
    let away = transform("ball", 0, [0.06, 0.003, 0.045], UNTURNED);
    second.write_all(&away).unwrap();
    drop(first);
    let begun = Instant::now();
    while newest
        .get()
        .is_none_or(|force| force.proxy_position[0] < 0.059)
    {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "the second one is not heard"
        );
        second.write_all(&away).unwrap();
        std::thread::sleep(Duration::from_millis(2));
    }
}

// Seen: eight connections that say nothing, and no tracker got in.
#[test]
fn a_tracker_gets_in_past_those_who_say_nothing() {
    let (_files, daemon, port) = start();
    let palpate = daemon.connect();
    let newest = palpate.forces("ball").unwrap();
    let _silent: Vec<TcpStream> = (0..12).map(|_| connect(port)).collect();
    let mut tracker = connect(port);
    let begun = Instant::now();
    let there = [0.061, 0.003, 0.045];
    while newest
        .get()
        .is_none_or(|force| (force.proxy_position[0] - there[0]).abs() > 1e-4)
    {
        assert!(begun.elapsed() < Duration::from_secs(30), "it is not heard");
        let _ = tracker.write_all(&transform("ball", 0, there, UNTURNED));
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn nonsense_moves_nothing_and_ends_only_its_own_connection() {
    let (_files, daemon, port) = start();
    let mut good = connect(port);
    let message = transform("ball", 0, [0.06, 0.003, 0.045], UNTURNED);
    let mut damaged = message.clone();
    damaged[70] ^= 0xff;
    let unknown = transform("saw", 0, [0.0; 3], UNTURNED);
    let mut long = message.clone();
    long[42..50].copy_from_slice(&u64::MAX.to_be_bytes());
    for bytes in [&[0xff; 200][..], &long, &message[..30]] {
        let mut stream = connect(port);
        stream.write_all(bytes).unwrap();
        stream.shutdown(std::net::Shutdown::Write).unwrap();
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
    }
    good.write_all(&damaged).unwrap();
    good.write_all(&unknown).unwrap();
    let palpate = daemon.connect();
    assert_eq!(palpate.status().unwrap().tools[0].received, 0);
    let begun = Instant::now();
    while palpate.status().unwrap().tools[0].received == 0 {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "the good one is not heard"
        );
        good.write_all(&message).unwrap();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn pyigtl_moves_the_ball_and_hears_where_it_is() {
    let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let imported = Command::new(&python).args(["-c", "import pyigtl"]).output();
    if !imported.is_ok_and(|done| done.status.success()) {
        println!("skipped: {python} lacks pyigtl (pip install pyigtl)");
        return;
    }
    let (_files, _daemon, port) = start();
    let script =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/igtl_tracker.py");
    let done = Command::new(python)
        .arg(script)
        .arg(port.to_string())
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{words}");
    let found: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    println!("{found}");
    let last = found["last"].as_f64().unwrap();
    assert!(
        found["count"].as_u64().unwrap() > 20 && last > 24.0 && last < 30.0,
        "{found}"
    );
}
