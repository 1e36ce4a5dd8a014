//! What must not become force: daemons that die, clients that do not read, strangers, slow loops,
//! bodies in each other. Each test is a defect that was there.

use crate::agones::{Call, Does, Sidecar};
use crate::daemon::{Daemon, PROGRAM, free_port, side_by_side};
use crate::scenes::{RIGID_TEARDROP as RIGID, too_slow, with_large_net};
use palpate_client::proto::codec::encode;
use palpate_client::proto::messages::{DeviceInfo, EventKind, ToolForce, ToolPose, force_flags};
use palpate_client::{ClientError, Connect, Palpate, pose_at};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use zenoh::Wait;

const PRESSED: [f64; 3] = [0.0255, 0.003, 0.045];
const AWAY: [f64; 3] = [0.036, 0.003, 0.045];

fn sleep(seconds: f64) {
    std::thread::sleep(Duration::from_secs_f64(seconds));
}

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !done() {
        assert!(begun.elapsed() < Duration::from_secs(60), "never: {what}");
        sleep(0.005);
    }
}

/// A device that presses, and what it wrote of each servo period: time, and force that acted, N.
fn pressing(endpoint: &str, csv: &std::path::Path, seconds: u32) -> std::process::Child {
    Command::new(PROGRAM)
        .args([
            "device", "--tool", "ball", "--motion", "press", "--depth", "0.004",
        ])
        .args([
            "--for",
            &format!("{seconds}s"),
            "--connect",
            endpoint,
            "--csv",
        ])
        .arg(csv)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn applied(csv: &std::path::Path) -> Vec<(f64, f64)> {
    let text = std::fs::read_to_string(csv).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heading = lines.next().unwrap();
    let first = heading
        .iter()
        .position(|name| *name == "applied_x_n")
        .unwrap();
    lines
        .map(|row| {
            let number = |k: usize| row[k].parse::<f64>().unwrap();
            let force = (first..first + 3).map(|k| number(k).powi(2)).sum::<f64>();
            (number(0), force.sqrt())
        })
        .collect()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn forces_go_with_a_daemon_that_dies_and_stay_beside_a_client_that_does_not_read() {
    side_by_side![
        a_device_lets_go_when_its_daemon_dies_and_feels_the_next_one_at_once,
        a_client_that_does_not_read_its_answers_takes_no_forces_from_others,
    ];
}

// Seen: 2 N for 12.9 s after the daemon was killed, 4.87 N for 26 s after it came back, exit 0.
fn a_device_lets_go_when_its_daemon_dies_and_feels_the_next_one_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let csv = directory.path().join("periods.csv");
    let daemon = Daemon::start_at(port, directory.path(), RIGID, &[]);
    let mut device = pressing(&daemon.endpoint, &csv, 8);
    // Long enough that the next daemon's ticks are below for all that follows.
    sleep(3.5);
    drop(daemon);
    sleep(1.2);
    let again = Daemon::start_at(port, directory.path(), RIGID, &[]);
    let ended = device.wait().unwrap();
    let mut words = String::new();
    std::io::Read::read_to_string(device.stderr.as_mut().unwrap(), &mut words).unwrap();
    drop(again);
    assert_eq!(ended.code(), Some(3), "{words}");
    assert!(words.contains("no force came for up to"), "{words}");
    let rows = applied(&csv);
    // A press lasts two seconds; alone for longer than 60 ms no force acts.
    let zero_for = |rows: &[(f64, f64)]| {
        let mut longest = 0;
        let mut run = 0;
        for (_, force) in rows {
            run = if *force == 0.0 { run + 1 } else { 0 };
            longest = longest.max(run);
        }
        longest
    };
    let peak = |from: f64, to: f64| {
        let part = rows.iter().filter(|(t, _)| (from..to).contains(t));
        part.map(|(_, force)| *force).fold(0.0, f64::max)
    };
    println!(
        "peak before {:.2} N, after {:.2} N; {} periods without force",
        peak(0.0, 3.5),
        peak(6.0, 8.0),
        zero_for(&rows)
    );
    assert!(peak(0.0, 3.5) > 0.2);
    assert!(zero_for(&rows) > 500);
    assert!(peak(6.0, 8.0) > 0.2, "the next daemon is not felt");
}

// Seen: 200 queries of `scene` whose answers were not read silenced all forces for 5 to 10 s.
fn a_client_that_does_not_read_its_answers_takes_no_forces_from_others() {
    let directory = tempfile::tempdir().unwrap();
    let scene = with_large_net();
    let daemon = Daemon::start(directory.path(), &scene, &[]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    // The answers of this session wait behind a callback that does not return.
    let endpoint = daemon.endpoint.clone();
    let asked = Arc::new(AtomicUsize::new(0));
    let counted = asked.clone();
    let deaf = std::thread::spawn(move || {
        let settings = palpate::transport::SessionSettings {
            connect: vec![endpoint],
            ..Default::default()
        };
        let session = palpate::transport::open(&settings).unwrap();
        for _ in 0..200 {
            let flag = flag.clone();
            let _ = session
                .get("palpate/default/scene")
                .callback(move |_| {
                    while !flag.load(Ordering::Relaxed) {
                        std::thread::sleep(Duration::from_millis(20));
                    }
                })
                .wait();
            counted.fetch_add(1, Ordering::Relaxed);
        }
        while !flag.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    let (begun, mut last, mut gap) = (Instant::now(), Instant::now(), Duration::ZERO);
    let mut received = tool.received();
    while begun.elapsed() < Duration::from_secs(5) {
        tool.send(pose_at(PRESSED)).unwrap();
        std::thread::sleep(Duration::from_millis(1));
        if tool.received() != received {
            gap = gap.max(last.elapsed());
            (received, last) = (tool.received(), Instant::now());
        }
    }
    gap = gap.max(last.elapsed());
    stop.store(true, Ordering::Relaxed);
    deaf.join().unwrap();
    println!(
        "{} queries asked, {received} forces in 5 s, longest gap {gap:?}",
        asked.load(Ordering::Relaxed)
    );
    assert!(asked.load(Ordering::Relaxed) > 10);
    assert!(gap < Duration::from_secs(3), "{gap:?} without a force");
}

fn device_info(name: &str, force_max: f64) -> DeviceInfo {
    DeviceInfo {
        name: name.into(),
        dof_force: 3,
        dof_torque: 0,
        workspace: [0.1; 3],
        force_max,
        force_continuous: 0.5,
        torque_max: 0.0,
        mass: 0.1,
        damping: 0.0,
        coulomb_friction: 0.0,
        encoder_resolution: 1e-5,
        rate_hz: 1e3,
        delay_s: 0.0,
        deadband: 0.0,
    }
}

// Seen: a pose with the number 2⁶⁴ − 1 locked the holder out; a stranger's poses and description moved
// the tool and raised the limit of its device.
#[test]
fn a_stranger_neither_moves_a_held_tool_nor_describes_its_device_nor_locks_its_holder_out() {
    // A holder that a busy machine keeps from sending for long loses the tool, as it should.
    let kept = (0..5).any(|_| holder_keeps_its_tool());
    assert!(kept, "the stranger has the tool each time");
}

/// False where the holder was silent for so long that it lost the tool.
fn holder_keeps_its_tool() -> bool {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID, &[]);
    let holder = daemon.connect();
    let mut tool = holder.tool("ball").unwrap();
    tool.announce(&device_info("holder", 0.8)).unwrap();
    let stranger = daemon.connect();
    let settings = palpate::transport::SessionSettings {
        connect: vec![daemon.endpoint.clone()],
        ..Default::default()
    };
    let raw = palpate::transport::open(&settings).unwrap();
    let key = "palpate/default/tool/ball";
    let mut other = stranger.tool("ball").unwrap();
    let begun = Instant::now();
    let (mut moved, mut felt) = (0, 0);
    let mut came = begun;
    while begun.elapsed() < Duration::from_secs(3) {
        // From outside, as hands come; once more where a busy machine has lost it.
        let withheld = |force: &ToolForce| force.flags & force_flags::WITHHELD != 0;
        if tool.force().as_ref().is_some_and(withheld) {
            came = Instant::now();
        }
        let share = (came.elapsed().as_secs_f64() / 0.3).min(1.0);
        let place = [0, 1, 2].map(|c| AWAY[c] + share * (PRESSED[c] - AWAY[c]));
        match tool.send(pose_at(place)) {
            Ok(_) => {}
            Err(ClientError::Held { .. }) => return false,
            Err(error) => panic!("{error}"),
        }
        if begun.elapsed() > Duration::from_millis(500) {
            // Refused from when the holder is known; then it sends nothing.
            let _ = other.send(pose_at(AWAY));
            let _ = other.announce(&device_info("stranger", 8.0));
            let last = ToolPose {
                seq: u64::MAX,
                ..pose_at(AWAY)
            };
            raw.put(format!("{key}/pose"), encode(&last))
                .wait()
                .unwrap();
            let told = encode(&device_info("nobody", 8.0));
            raw.put(format!("{key}/device"), told).wait().unwrap();
        }
        std::thread::sleep(Duration::from_millis(1));
        if let Some(force) = tool
            .force()
            .filter(|_| came.elapsed() > Duration::from_secs(1))
        {
            let size = force.force.iter().map(|f| f * f).sum::<f64>().sqrt();
            felt += u32::from(size > 0.3);
            moved += u32::from(size > 0.8 + 1e-6 || force.proxy_position[0] > AWAY[0] - 1e-3);
        }
    }
    assert!(felt > 50 && moved == 0, "felt {felt}, moved {moved}");
    assert_eq!(holder.device("ball").unwrap().name, "holder");
    let metrics = holder.metrics().unwrap();
    let count = metrics
        .lines()
        .find_map(|line| line.strip_prefix("palpate_tool_poses_of_strangers_total{tool=\"ball\"} "))
        .unwrap();
    assert!(count.parse::<u64>().unwrap() > 100, "{count}");
    // Once the holder is silent, another may have the tool.
    until("another holder", || {
        let _ = other.send(pose_at(AWAY));
        stranger.status().unwrap().tools[0].out_of_order == 0
            && other
                .force()
                .is_some_and(|force| force.proxy_position[0] > AWAY[0] - 1e-3)
    });
    true
}

#[test]
fn a_holder_that_skips_a_million_numbers_at_once_is_not_believed() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID, &[]);
    let palpate = daemon.connect();
    let key = "palpate/default/tool/ball/pose";
    let settings = palpate::transport::SessionSettings {
        connect: vec![daemon.endpoint.clone()],
        ..Default::default()
    };
    let raw = palpate::transport::open(&settings).unwrap();
    let publisher = raw.declare_publisher(key).wait().unwrap();
    let put = |seq: u64| {
        let pose = ToolPose {
            seq,
            ..pose_at(AWAY)
        };
        publisher.put(encode(&pose)).wait().unwrap();
    };
    let counts = || {
        let status = palpate.status().unwrap();
        (status.tools[0].received, status.tools[0].out_of_order)
    };
    // A session that has just opened may not know of the daemon's subscriber yet, and drops what it
    // is given until it does.
    until("a subscriber", || {
        publisher.matching_status().wait().unwrap().matching()
    });
    put(1);
    until("the first", || counts().0 == 1);
    // While it is there: at once after the others.
    put(2);
    put(u64::MAX);
    put(3);
    until("all of them", || counts().0 + counts().1 == 4);
    assert_eq!(counts(), (3, 1));
}

// Seen: two daemons of one name on one network, steps of 4 N.
#[test]
fn a_second_daemon_of_one_name_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let first = Daemon::start(directory.path(), RIGID, &[]);
    let scene = directory.path().join("scene.toml");
    let listen = format!("tcp/127.0.0.1:{}", free_port());
    let second = |instance: &str| {
        Command::new(PROGRAM)
            .arg("serve")
            .arg(&scene)
            .args(["--no-rt", "--connect", &first.endpoint, "--listen", &listen])
            .args(["--for", "1s", "--instance", instance])
            .stdin(Stdio::null())
            .output()
            .unwrap()
    };
    let refused = second("default");
    assert_eq!(refused.status.code(), Some(2), "{}", words(&refused));
    assert!(
        words(&refused).contains("instance \"default\" is served already"),
        "{}",
        words(&refused)
    );
    let other = second("other");
    assert_eq!(other.status.code(), Some(0), "{}", words(&other));
}

// Seen: 8 N and 8.5 J made by a loop at 34 of 1000 Hz, /readyz said 200, and Agones was told that it is healthy.
#[test]
fn a_loop_that_does_not_keep_its_rate_sends_no_force_and_is_neither_ready_nor_healthy() {
    let directory = tempfile::tempdir().unwrap();
    let sidecar = Sidecar::start(|_, _| Does::Takes);
    let port = free_port();
    let http = format!("127.0.0.1:{port}");
    let daemon = sidecar.daemon(directory.path(), &too_slow(), &["--http", &http]);
    crate::page::wait_for(port);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let mut slow_since = Instant::now();
    // Until the rate has been lost for long.
    until("a slow loop without force", || {
        tool.send(pose_at(PRESSED)).unwrap();
        let ready = crate::page::get(port, "/readyz");
        if ready.status != 503 || !ready.text().contains("rate") {
            slow_since = Instant::now();
        }
        slow_since.elapsed() > Duration::from_secs(3)
    });
    let force = tool.force().unwrap();
    assert!(force.contact_count > 0, "the ball touches: {force:?}");
    assert_eq!((force.force, force.torque), ([0.0; 3], [0.0; 3]));
    // None after the last look, which may have been under way.
    let healthy = sidecar.log.of("/health");
    let late = |call: &&Call| call.at > slow_since + Duration::from_secs(1);
    assert_eq!(healthy.iter().filter(late).count(), 0, "{healthy:?}");
    // Asked for, not listened to: a slow loop says so once, perhaps before anybody listens.
    let events = palpate.past_events(0).unwrap();
    let said = |kind: &EventKind| matches!(kind, EventKind::Fault { reason } if reason.contains("of 10000 Hz"));
    assert!(events.iter().any(|event| said(&event.kind)), "{events:?}");
    assert!(
        palpate
            .metrics()
            .unwrap()
            .contains("palpate_loop_measured_rate_hertz")
    );
}

// Seen: a net point at 65.6 m, 8 N, no fault, and `check` passed; then that `serve` started what `check` refused.
#[test]
fn soft_bodies_that_stand_in_each_other_are_refused_in_every_way_to_run_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let two = include_str!("../../scenes/two-drops.toml");
    std::fs::write(path.join("good.toml"), two).unwrap();
    std::fs::write(path.join("bad.toml"), two.replace("-0.0357", "-0.028")).unwrap();
    std::fs::write(path.join("poses.csv"), "0.1, 0.0, 0.1\n").unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(PROGRAM);
        command.args(arguments).current_dir(path).output().unwrap()
    };
    let good = run(&["check", "good.toml"]);
    assert_eq!(good.status.code(), Some(0), "{}", words(&good));
    let serve = [
        "serve",
        "bad.toml",
        "--for",
        "1s",
        "--listen",
        "tcp/127.0.0.1:0",
    ];
    for (arguments, code) in [
        (&["check", "bad.toml"][..], 3),
        (&serve[..], 2),
        (&["probe", "bad.toml", "--poses", "poses.csv"], 2),
        (&["doctor", "bad.toml"], 2),
    ] {
        let bad = run(arguments);
        let said = words(&bad);
        assert_eq!(bad.status.code(), Some(code), "{arguments:?}: {said}");
        let pair = "bodies left and right stand";
        let swapped = "bodies right and left stand";
        assert!(
            said.contains(pair) || said.contains(swapped),
            "{arguments:?}: {said}"
        );
        assert!(
            said.contains("bad.toml:"),
            "no place: {arguments:?}: {said}"
        );
    }
}

#[test]
fn a_configuration_file_that_names_no_endpoint_leaves_the_daemon_where_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let config = directory.path().join("lease.json5");
    std::fs::write(&config, "{ transport: { link: { tx: { lease: 5000 } } } }").unwrap();
    let port = free_port();
    let arguments = ["--zenoh-config", config.to_str().unwrap()];
    let daemon = Daemon::start_at(port, directory.path(), RIGID, &arguments);
    // It answers where it was told to listen, and listens nowhere else.
    assert!(daemon.connect().status().is_ok());
    let sockets = std::fs::read_to_string(format!("/proc/{}/net/tcp", daemon.child.id()));
    let own = open_ports(daemon.child.id());
    assert_eq!(own, [port], "{sockets:?}");
}

/// Ports of TCP on which a process listens.
fn open_ports(pid: u32) -> Vec<u16> {
    let inodes: Vec<String> = std::fs::read_dir(format!("/proc/{pid}/fd"))
        .unwrap()
        .filter_map(|entry| std::fs::read_link(entry.ok()?.path()).ok())
        .filter_map(|link| {
            let text = link.to_string_lossy().into_owned();
            Some(text.strip_prefix("socket:[")?.strip_suffix(']')?.to_owned())
        })
        .collect();
    let mut ports = Vec::new();
    for table in ["tcp", "tcp6"] {
        let text = std::fs::read_to_string(format!("/proc/{pid}/net/{table}")).unwrap_or_default();
        for line in text.lines().skip(1) {
            let parts: Vec<&str> = line.split_whitespace().collect();
            let (address, state, inode) = (parts[1], parts[3], parts[9]);
            if state == "0A" && inodes.iter().any(|known| known == inode) {
                let (_, port) = address.rsplit_once(':').unwrap();
                ports.push(u16::from_str_radix(port, 16).unwrap());
            }
        }
    }
    ports
}

#[test]
fn a_connected_client_names_its_config_and_does_not_listen() {
    let directory = tempfile::tempdir().unwrap();
    let config = directory.path().join("lease.json5");
    std::fs::write(&config, "{ transport: { link: { tx: { lease: 5000 } } } }").unwrap();
    let daemon = Daemon::start(directory.path(), RIGID, &[]);
    let before = open_ports(std::process::id());
    let palpate = Palpate::connect(&Connect {
        zenoh_config: Some(config),
        timeout: Duration::from_secs(20),
        ..Connect::to(&daemon.endpoint)
    })
    .unwrap();
    assert!(palpate.status().is_ok());
    let after = open_ports(std::process::id());
    let own: Vec<u16> = after
        .into_iter()
        .filter(|port| !before.contains(port))
        .collect();
    // Other tests of this program may listen meanwhile, on ports of their own below 32000.
    assert!(own.iter().all(|port| *port < 32_000), "{own:?}");
}
