//! Programs that are not ours: zenoh-ros2-sdk, rosbags, mcap-ros2-support, websockets. Each part runs
//! where its packages are (`.ci/run` fetches them) and says so where they are not.

use crate::daemon::{Daemon, PROGRAM, free_port};
use palpate_client::pose_at;
use palpate_client::proto::messages::ToolForce;
use palpate_devices::ros2::{TYPES, schema_text};
use serde_json::{Value, json};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::scenes::RIGID_TEARDROP as SCENE;
const ARM: &str = "[[ros2.tool]]\ntool = \"ball\"\npreset = \"crtk\"\nvelocity = \"\"\n";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A Python that has these modules, from these packages.
fn python_with(modules: &str, packages: &str) -> Option<String> {
    let name = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&name)
        .args(["-c", &format!("import {modules}")])
        .output()
        .is_ok_and(|done| done.status.success());
    if !has {
        println!("skipped: {name} lacks {modules} (pip install {packages})");
    }
    has.then_some(name)
}

fn peers(python: &str, arguments: &[&str], input: &str) -> String {
    let mut child = Command::new(python)
        .arg(root().join("tests/readers/ros2_peers.py"))
        .args(arguments)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    let done = child.wait_with_output().unwrap();
    let words = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{arguments:?}: {words}");
    String::from_utf8(done.stdout).unwrap()
}

#[test]
fn rosbags_computes_the_hashes_that_stand_in_our_keys() {
    let Some(python) = python_with("rosbags", "rosbags") else {
        return;
    };
    let messages: Vec<_> = TYPES
        .iter()
        .filter(|kind| kind.name.contains("/msg/"))
        .collect();
    let asked = messages
        .iter()
        .map(|kind| json!({ "name": kind.name, "text": schema_text(kind) }));
    let answer = peers(&python, &["hashes"], &Value::from_iter(asked).to_string());
    let found: Value = serde_json::from_str(&answer).unwrap();
    for kind in messages {
        assert_eq!(found[kind.name], kind.hash, "{}", kind.name);
    }
}

#[test]
fn wrenches_that_rosbags_decodes_are_the_native_forces_bit_for_bit_in_lockstep() {
    let Some(python) = python_with("rosbags, zenoh_ros2_sdk", "rosbags zenoh-ros2-sdk") else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let recording = directory.path().join("ros.mcap");
    let text = format!("{SCENE}\n{ARM}");
    let arguments = [
        "--ros2",
        "--clock",
        "lockstep",
        "--record",
        recording.to_str().unwrap(),
    ];
    let daemon = Daemon::start(directory.path(), &text, &arguments);
    let port = daemon.endpoint.rsplit_once(':').unwrap().1.to_owned();
    let out = directory.path().join("wrenches");
    peers(&python, &["press", &port, out.to_str().unwrap()], "");
    daemon
        .connect()
        .rpc(palpate_client::proto::rpc::Call::Shutdown)
        .unwrap();
    assert_eq!(daemon.end().1, 0);
    let over_ros: Vec<String> = std::fs::read_to_string(&out)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect();
    assert_eq!(over_ros.len(), 300);

    // The same poses, with the velocities that the adapter made of them, from a native client.
    let done = Command::new(PROGRAM)
        .args(["export", "--csv", "-"])
        .arg(&recording)
        .output()
        .unwrap();
    let table = String::from_utf8(done.stdout).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let heading = rows.next().unwrap();
    let column = |name: &str| {
        heading
            .iter()
            .position(|given| *given == format!("ball.{name}"))
            .unwrap()
    };
    let [position, linear, angular] =
        ["position_x_m", "velocity_x_m_s", "turning_x_rad_s"].map(column);
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let mut pressed = 0;
    for (row, over_ros) in rows.zip(&over_ros) {
        let three = |at: usize| [0, 1, 2].map(|c| row[at + c].parse::<f64>().unwrap());
        let mut pose = pose_at(three(position));
        pose.linear_velocity = three(linear);
        pose.angular_velocity = three(angular);
        let seq = tool.send(pose).unwrap();
        let force: ToolForce = tool.wait_force(seq, Duration::from_secs(30)).unwrap();
        let bytes = force
            .force
            .iter()
            .chain(&force.torque)
            .flat_map(|x| x.to_be_bytes());
        let native: String = bytes.map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(&native, over_ros, "pose {seq}");
        pressed += u32::from(force.force[0] > 0.5);
    }
    assert!(pressed > 100, "{pressed} ticks in contact");
}

#[test]
fn zenoh_ros2_sdk_lists_our_topics_types_and_services() {
    let Some(python) = python_with("zenoh_ros2_sdk", "zenoh-ros2-sdk") else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), &format!("{SCENE}\n{ARM}"), &["--ros2"]);
    let port = daemon.endpoint.rsplit_once(':').unwrap().1.to_owned();
    let begun = Instant::now();
    loop {
        let graph = peers(&python, &["graph", &port], "");
        let all = [
            "/arm/measured_cp",
            "PoseStamped",
            "/arm/body/servo_cf",
            "WrenchStamped",
            "/palpate/nets",
            "/palpate/reset",
            "Trigger",
        ];
        if all.iter().all(|word| graph.contains(word)) {
            return println!("{graph}");
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "{graph}");
    }
}

#[test]
fn rosbags_and_mcap_ros2_read_a_bag_with_the_forces_of_the_recording() {
    let directory = tempfile::tempdir().unwrap();
    let recording = root().join("recordings/golden/rigid-teardrop-press.mcap");
    let bag = directory.path().join("bag");
    let export = |what: &[&str], to: &Path| {
        let done = Command::new(PROGRAM)
            .arg("export")
            .arg(&recording)
            .args(what)
            .arg(to)
            .output()
            .unwrap();
        (
            done.status.code(),
            String::from_utf8_lossy(&done.stderr).into_owned(),
        )
    };
    assert_eq!(export(&["--ros2bag"], &bag).0, Some(0));
    // A bag is never written over another one.
    let (code, words) = export(&["--ros2bag"], &bag);
    assert!(code == Some(2) && words.contains("exists"), "{words}");
    let metadata = std::fs::read_to_string(bag.join("metadata.yaml")).unwrap();
    assert!(metadata.contains("/ball/servo_cf") && metadata.contains("storage_identifier: mcap"));
    let table: PathBuf = directory.path().join("table.csv");
    assert_eq!(export(&["--csv"], &table).0, Some(0));
    let Some(python) = python_with("rosbags, mcap_ros2", "rosbags mcap-ros2-support") else {
        return;
    };
    let read: Value =
        serde_json::from_str(&peers(&python, &["bag", bag.to_str().unwrap()], "")).unwrap();
    let table = std::fs::read_to_string(table).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let heading = rows.next().unwrap();
    let column = heading
        .iter()
        .position(|name| *name == "ball.force_x_n")
        .unwrap();
    let forces = read["/ball/servo_cf"].as_array().unwrap();
    let mut pressed = 0;
    for (row, force) in rows.by_ref().zip(forces) {
        for c in 0..3 {
            let recorded: f64 = row[column + c].parse().unwrap();
            assert_eq!(recorded.to_bits(), force[c].as_f64().unwrap().to_bits());
            pressed += u32::from(recorded != 0.0);
        }
    }
    assert!(rows.next().is_none() && pressed > 100, "{pressed}");
    // A rigid body does not change: no net was recorded. A soft one does.
    let soft = directory.path().join("soft");
    let done = Command::new(PROGRAM)
        .args(["export", "--ros2bag"])
        .arg(&soft)
        .arg(root().join("recordings/golden/teardrop-tap.mcap"))
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0));
    let read: Value =
        serde_json::from_str(&peers(&python, &["bag", soft.to_str().unwrap()], "")).unwrap();
    let nets = read["/palpate/nets"].as_array().unwrap();
    println!("{} nets, {} points in the first", nets.len(), nets[0][0]);
    assert!(nets.len() > 3 && nets[0][0].as_f64().unwrap() > 100.0);
}

#[test]
fn a_program_of_the_vendors_page_pushes_the_simulated_haply_device() {
    let Some(python) = python_with("websockets", "websockets") else {
        return;
    };
    let port = free_port();
    let mut service = Command::new(PROGRAM)
        .args([
            "device",
            "--as",
            "haply",
            "--per-message",
            "--hand",
            "light",
            "--for",
            "60s",
            "--port",
        ])
        .arg(port.to_string())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    let done = Command::new(python)
        .arg(root().join("tests/readers/haply_program.py"))
        .arg(format!("ws://127.0.0.1:{port}"))
        .output()
        .unwrap();
    let _ = service.kill();
    let _ = service.wait();
    let words = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{words}");
    let seen: Value = serde_json::from_slice(&done.stdout).unwrap();
    // 1 N against a hand of 100 N/m.
    let moved_m = seen["moved_m"].as_f64().unwrap();
    assert!((0.005..0.015).contains(&moved_m), "{seen}");
    assert_eq!(seen["force"]["z"], 1.0);
}

/// Node with the packages that `.ci/run` puts into `target/node`, or those of `PALPATE_NODE`.
fn node_packages(package: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("PALPATE_NODE")
        .map_or_else(|| root().join("target/node/node_modules"), PathBuf::from);
    let runs = Command::new("node").arg("--version").output();
    let has = runs.is_ok_and(|done| done.status.success()) && folder.join(package).is_dir();
    if !has {
        println!("skipped: no node with {package} in {}", folder.display());
    }
    has.then_some(folder)
}

fn node_peer(folder: &Path, arguments: &[&str]) -> Value {
    let done = Command::new("node")
        .arg(root().join("tests/readers/live_peers.mjs"))
        .args(arguments)
        .env("PALPATE_NODE", folder)
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{arguments:?}: {words}");
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn the_client_of_foxglove_is_shown_every_channel() {
    let Some(node) = node_packages("@foxglove/ws-protocol") else {
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let scene = crate::scenes::SOFT_DROP;
    let _daemon = Daemon::start(directory.path(), scene, &["--foxglove", &port.to_string()]);
    crate::page::wait_for(port);
    // Something is told only when something happens.
    let palpate = _daemon.connect();
    palpate
        .rpc(palpate_client::proto::rpc::Call::Reset)
        .unwrap();
    let found = node_peer(&node, &["foxglove", &format!("ws://127.0.0.1:{port}")]);
    let bytes = |topic: &str| found[topic].as_u64().unwrap();
    assert!(
        bytes("/view/scene") > 10_000 && bytes("/view/tool/ball/shape") > 1_000,
        "{found}"
    );
    assert!(bytes("/tool/ball/wrench") > 0, "{found}");
    assert_eq!(found.as_object().unwrap().len(), 7);
}

#[test]
fn roslib_and_roslibpy_press_the_ball_and_feel_it() {
    let python = python_with("roslibpy", "roslibpy");
    let node = node_packages("roslib");
    if python.is_none() && node.is_none() {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = crate::page::serve(directory.path(), &format!("{SCENE}\n{ARM}"), &[]);
    let url = format!("ws://127.0.0.1:{port}/rosbridge");
    if let Some(node) = node {
        let found = node_peer(&node, &["roslib", &url]);
        println!("roslib: {found}");
        assert!(found["peak"].as_f64().unwrap() > 0.5 && found["answer"]["success"] == true);
    }
    if let Some(python) = python {
        let done = Command::new(python)
            .arg(root().join("tests/readers/roslibpy_press.py"))
            .arg(&url)
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{words}");
        let found: Value = serde_json::from_slice(&done.stdout).unwrap();
        println!("roslibpy: {found}");
        assert!(found["peak"].as_f64().unwrap() > 0.5 && found["answer"]["success"] == true);
        assert!(found["count"].as_u64().unwrap() > 10, "{found}");
    }
}
