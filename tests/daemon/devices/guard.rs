//! The guard beside a CRTK driver, and the simulated arm.

use super::peer::{Peer, pose};
use super::ros2::open_router;
use crate::daemon::{Daemon, PROGRAM, free_port};
use palpate_devices::ros2::{Empty, OperatingState, PoseStamped, WrenchStamped};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::scenes::RIGID_TEARDROP as SCENE;

struct Process(Child);

impl Process {
    fn start(arguments: &[&str]) -> Self {
        let child = Command::new(PROGRAM)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        Self(child.unwrap())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn now_ns() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.unwrap().as_nanos() as u64
}

#[test]
fn a_bridge_killed_while_pressing_leaves_zero_and_free_behind_the_guard() {
    let directory = tempfile::tempdir().unwrap();
    let router = format!("tcp/127.0.0.1:{}", free_port());
    let _router = open_router(&router);
    let text =
        format!("{SCENE}\n[[ros2.tool]]\ntool = \"ball\"\nforce = \"/arm/palpate/servo_cf\"\n");
    let mut daemon = Daemon::start(directory.path(), &text, &["--ros2", "--connect", &router]);
    let _guard = Process::start(&[
        "device",
        "--guard",
        "crtk",
        "/arm",
        "--for",
        "300s",
        "--connect",
        &router,
    ]);
    let peer = Peer::connect(&router);
    let forces = peer.hear::<WrenchStamped>("/arm/body/servo_cf");
    let free = peer.hear::<Empty>("/arm/free");
    peer.await_listener::<PoseStamped>("/arm/measured_cp");
    peer.await_listener::<WrenchStamped>("/arm/palpate/servo_cf");
    let begun = Instant::now();
    let (mut last, mut x) = (0.0, 0.036);
    while last < 0.5 {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "no force comes through the guard"
        );
        peer.put(
            "/arm/measured_cp",
            &pose(now_ns() / 1_000_000, [x, 0.003, 0.045]),
        );
        // From outside: in the body it would feel nothing.
        x = f64::max(x - 3e-4, 0.0255);
        std::thread::sleep(Duration::from_millis(1));
        for wrench in forces.take::<WrenchStamped>() {
            last = wrench.force[0];
        }
    }
    // No farewell: the daemon is killed.
    let killed_ns = now_ns();
    daemon.child.kill().unwrap();
    free.next::<Empty>();
    let heard = forces.take::<WrenchStamped>();
    let rest = heard.last().unwrap();
    assert_eq!((rest.force, rest.torque), ([0.0; 3], [0.0; 3]));
    let passed_ms = (rest.header.stamp.to_ns() as f64 - killed_ns as f64) * 1e-6;
    println!(
        "zero {passed_ms:.1} ms after the daemon was killed, of which 50 ms are the guard's patience"
    );
}

// A guard that is started beside a force that acts already, and one whose forces come again after a silence.
#[test]
fn a_guard_takes_a_force_up_from_nothing() {
    let router = format!("tcp/127.0.0.1:{}", free_port());
    let _router = open_router(&router);
    let _guard = Process::start(&[
        "device",
        "--guard",
        "crtk",
        "/arm",
        "--for",
        "300s",
        "--connect",
        &router,
    ]);
    let peer = Peer::connect(&router);
    let forces = peer.hear::<WrenchStamped>("/arm/body/servo_cf");
    let free = peer.hear::<Empty>("/arm/free");
    peer.await_listener::<WrenchStamped>("/arm/palpate/servo_cf");
    let wrench = WrenchStamped {
        header: palpate_devices::ros2::Header::new(now_ns(), "world"),
        force: [0.0, 0.0, 1.0],
        torque: [0.01, 0.0, 0.0],
    };
    for round in 0..2 {
        let begun = Instant::now();
        let mut heard = Vec::new();
        while heard.last() != Some(&(1.0, 0.01)) {
            assert!(begun.elapsed() < Duration::from_secs(60), "{heard:?}");
            peer.put("/arm/palpate/servo_cf", &wrench);
            std::thread::sleep(Duration::from_millis(1));
            let came = forces.take::<WrenchStamped>();
            heard.extend(came.iter().map(|felt| (felt.force[2], felt.torque[0])));
        }
        let first = heard.iter().find(|felt| felt.0 > 0.0).unwrap();
        assert!(first.0 < 0.5 && first.1 < 0.005, "{round}: {heard:?}");
        // Nothing any more: it fades, and is zero.
        while heard.last() != Some(&(0.0, 0.0)) {
            assert!(begun.elapsed() < Duration::from_secs(120), "{heard:?}");
            std::thread::sleep(Duration::from_millis(1));
            let came = forces.take::<WrenchStamped>();
            heard.extend(came.iter().map(|felt| (felt.force[2], felt.torque[0])));
        }
        free.next::<Empty>();
        // Zero is said more than once: one may be lost.
        let again = forces.next::<WrenchStamped>();
        assert_eq!((again.force, again.torque), ([0.0; 3], [0.0; 3]));
    }
}

pub fn the_simulated_arm_is_pressed_by_the_daemon_over_ros() {
    let directory = tempfile::tempdir().unwrap();
    let text = format!("{SCENE}\n[[ros2.tool]]\ntool = \"ball\"\n");
    let daemon = Daemon::start(directory.path(), &text, &["--ros2"]);
    let peer = Peer::connect(&daemon.endpoint);
    let states = peer.hear::<OperatingState>("/arm/operating_state");
    peer.await_listener::<PoseStamped>("/arm/measured_cp");
    let done = Command::new(PROGRAM)
        .args([
            "device", "--as", "crtk", "/arm", "--tool", "ball", "--motion", "press", "--for", "4s",
        ])
        .args(["--connect", &daemon.endpoint])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&done.stdout);
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    println!("{words}");
    let peak: f64 = words
        .split("peak ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!(peak > 0.3, "{words}");
    assert_eq!(states.next::<OperatingState>().state, "ENABLED");
}
