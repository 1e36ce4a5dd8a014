//! `serve --ros2` and a bare peer.

use super::peer::{Heard, Peer, pose, twist};
use crate::daemon::{Daemon, free_port};
use palpate_client::pose_at;
use palpate_client::proto::messages::{ToolForce, ToolPose};
use palpate_client::proto::rpc::Call;
use palpate_devices::cdr::{decode, encode};
use palpate_devices::ros2::{
    Bool, Empty, Float64MultiArray, Joy, MarkerArray, PoseStamped, RosMessage, TriggerResponse,
    WrenchStamped, topic_key,
};
use std::process::Command;
use std::time::{Duration, Instant};
use zenoh::Wait;

use crate::scenes::RIGID_TEARDROP as SCENE;
const ARM: &str = "[[ros2.tool]]\ntool = \"ball\"\npreset = \"crtk\"\n";
const POSE: &str = "/arm/measured_cp";
const FORCE: &str = "/arm/body/servo_cf";
/// About 2 mm deep in the drop.
const PRESSED: [f64; 3] = [0.0255, 0.003, 0.045];
const AWAY: [f64; 3] = [0.036, 0.003, 0.045];

fn start(ros2: &str, arguments: &[&str]) -> (tempfile::TempDir, Daemon) {
    let directory = tempfile::tempdir().unwrap();
    let text = format!("{SCENE}\n{ros2}");
    let arguments = [&["--ros2"], arguments].concat();
    let daemon = Daemon::start(directory.path(), &text, &arguments);
    (directory, daemon)
}

/// Publishes poses in real time, a thousand times a second, for as long as `until` does not hold.
fn press_until(peer: &Peer, position: [f64; 3], mut until: impl FnMut() -> bool) {
    let begun = Instant::now();
    let mut k = 0;
    while !until() {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "it does not happen"
        );
        k += 1;
        let share = if position == PRESSED {
            // Again and again: the first poses may be lost.
            (k % 500) as f64 / 40.0
        } else {
            1.0
        };
        peer.put(POSE, &pose(now_ms(), coming_to(position, share)));
        std::thread::sleep(Duration::from_millis(k).saturating_sub(begun.elapsed()));
    }
}

/// A hand comes from outside: inside the body it would feel nothing.
fn coming_to(place: [f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|c| AWAY[c] + (place[c] - AWAY[c]) * share.min(1.0))
}

fn now_ms() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.unwrap().as_millis() as u64
}

fn felt(forces: &Heard) -> bool {
    let heard = forces.take::<WrenchStamped>();
    heard.iter().any(|wrench| wrench.force[0] > 0.5)
}

fn path(k: u64) -> ([f64; 3], [f64; 3]) {
    // 12 mm in 200 ms, then a slide.
    let x = AWAY[0] - 0.06 * (k.min(200) as f64 * 1e-3);
    let z = AWAY[2] + 0.02 * (k.saturating_sub(200) as f64 * 1e-3);
    let velocity = if k <= 200 {
        [-0.06, 0.0, 0.0]
    } else {
        [0.0, 0.0, 0.02]
    };
    ([x, AWAY[1], z], velocity)
}

#[test]
fn in_lockstep_wrenches_are_the_forces_of_a_native_run_bit_for_bit() {
    let (_files, daemon) = start(ARM, &["--clock", "lockstep"]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    peer.await_listener::<PoseStamped>(POSE);
    let mut over_ros = Vec::new();
    for k in 1..=300 {
        let (position, velocity) = path(k);
        peer.put("/arm/measured_cv", &twist(k, velocity));
        peer.put(POSE, &pose(k, position));
        let wrench: WrenchStamped = forces.next();
        assert_eq!(wrench.header.frame_id, "world");
        over_ros.push((wrench.force, wrench.torque));
    }
    drop(daemon);

    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let mut pressed = 0;
    for (k, over_ros) in (1..).zip(&over_ros) {
        let (position, velocity) = path(k);
        let pose = ToolPose {
            linear_velocity: velocity,
            ..pose_at(position)
        };
        let seq = tool.send(pose).unwrap();
        let force: ToolForce = tool.wait_force(seq, Duration::from_secs(30)).unwrap();
        let bits = |(force, torque): ([f64; 3], [f64; 3])| {
            (force.map(f64::to_bits), torque.map(f64::to_bits))
        };
        assert_eq!(
            bits((force.force, force.torque)),
            bits(*over_ros),
            "tick {k}"
        );
        pressed += u32::from(force.force[0] > 0.5);
    }
    assert!(pressed > 100, "{pressed} ticks in contact");
}

#[test]
fn poses_without_attachment_or_with_a_wrong_one_or_of_nonsense_move_nothing() {
    let (_files, daemon) = start(ARM, &["--clock", "lockstep"]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    peer.await_listener::<PoseStamped>(POSE);
    let good = encode(&pose(1, AWAY));
    let attachment = peer.attachment().to_bytes().to_vec();
    let put = |bytes: Vec<u8>, attachment: Option<Vec<u8>>| {
        peer.put_bytes::<PoseStamped>(POSE, bytes, attachment);
    };
    put(good.clone(), None);
    put(good.clone(), Some(attachment[..32].to_vec()));
    put(good[..good.len() - 1].to_vec(), Some(attachment.clone()));
    put(vec![], Some(attachment.clone()));
    put(vec![0xff; 84], Some(attachment.clone()));
    let mut long_text = good.clone();
    long_text[12..16].copy_from_slice(&(1_u32 << 31).to_le_bytes());
    put(long_text, Some(attachment.clone()));
    // A stamp of 0: not valid. NaN: counted by the coupling.
    let mut unstamped = pose(1, AWAY);
    unstamped.header.stamp = Default::default();
    peer.put(POSE, &unstamped);
    peer.put(POSE, &pose(2, [f64::NAN, 0.0, 0.0]));
    assert!(forces.sample(Duration::from_millis(300)).is_none());
    // The 77 bytes of Jazzy 0.2.0 do, and so does big-endian CDR.
    let bare = peer.attachment().to_bytes();
    let named = [
        &b"\x0fsequence_number"[..],
        &bare[..8],
        b"\x10source_timestamp",
        &bare[8..16],
        b"\x0asource_gid",
        &bare[16..],
    ]
    .concat();
    put(good, Some(named));
    let _: WrenchStamped = forces.next();
    let mut big = vec![0, 0, 0, 0];
    big.extend(2_i32.to_be_bytes());
    big.extend(0_u32.to_be_bytes());
    big.extend([0, 0, 0, 1, 0, 0, 0, 0]);
    for number in [AWAY[0], AWAY[1], AWAY[2], 0.0, 0.0, 0.0, 1.0] {
        big.extend(number.to_be_bytes());
    }
    put(big, Some(peer.attachment().to_bytes().to_vec()));
    let _: WrenchStamped = forces.next();
    assert!(forces.sample(Duration::from_millis(200)).is_none());
}

#[test]
fn poses_in_another_frame_are_refused_if_a_frame_is_asked_for() {
    let (_files, daemon) = start(
        &format!("{ARM}frame = \"base\"\n"),
        &["--clock", "lockstep"],
    );
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    peer.await_listener::<PoseStamped>(POSE);
    peer.put(POSE, &pose(1, AWAY));
    assert!(forces.sample(Duration::from_millis(300)).is_none());
    let mut right = pose(2, AWAY);
    right.header.frame_id = "base".into();
    peer.put(POSE, &right);
    let wrench: WrenchStamped = forces.next();
    assert_eq!(wrench.header.frame_id, "base");
}

#[test]
fn of_two_publishers_of_one_pose_topic_the_first_one_moves_the_tool() {
    let (_files, daemon) = start(ARM, &[]);
    let first = Peer::connect(&daemon.endpoint);
    let mut second = Peer::connect(&daemon.endpoint);
    second.gid = [9; 16];
    first.await_listener::<PoseStamped>(POSE);
    let palpate = daemon.connect();
    let newest = palpate.forces("ball").unwrap();
    press_until(&first, AWAY, || newest.get().is_some());
    let mut pressed_by_second = false;
    let begun = Instant::now();
    // The first holds it away from the body, the second would press it in.
    press_until(&first, AWAY, || {
        second.put(POSE, &pose(now_ms(), PRESSED));
        pressed_by_second |= newest.get().is_some_and(|force| force.contact_count > 0);
        begun.elapsed() > Duration::from_millis(600)
    });
    assert!(!pressed_by_second);
    // Once the first one is silent the second one is heard.
    press_until(&second, PRESSED, || {
        newest.get().is_some_and(|force| force.contact_count > 0)
    });
}

#[test]
fn a_publisher_that_stops_leaves_the_device_with_zero_and_free() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    let free = peer.hear::<Empty>("/arm/free");
    let absolute = peer.hear::<Bool>("/arm/body/set_cf_orientation_absolute");
    peer.await_listener::<PoseStamped>(POSE);
    press_until(&peer, PRESSED, || felt(&forces));
    assert!(absolute.next::<Bool>().data);
    free.next::<Empty>();
    let last = forces.take::<WrenchStamped>().pop().unwrap();
    assert_eq!((last.force, last.torque), ([0.0; 3], [0.0; 3]));
    // Nothing is said to a device that is left, and all goes on when it speaks again.
    std::thread::sleep(Duration::from_millis(200));
    assert!(forces.take::<WrenchStamped>().is_empty());
    press_until(&peer, PRESSED, || felt(&forces));
}

#[test]
fn a_pause_over_the_trigger_service_fades_the_force_and_frees_the_device() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    let free = peer.hear::<Empty>("/arm/free");
    peer.await_listener::<PoseStamped>(POSE);
    press_until(&peer, PRESSED, || felt(&forces));
    let call = |method: &str| {
        let key = topic_key(0, &format!("/palpate/{method}"), TriggerResponse::TYPE);
        let replies = peer
            .session
            .get(key)
            .payload(encode(&Empty::default()))
            .attachment(peer.attachment().to_bytes())
            .timeout(Duration::from_secs(20))
            .wait()
            .unwrap();
        let reply = replies.recv().unwrap();
        let sample = reply.result().unwrap();
        decode::<TriggerResponse>(&sample.payload().to_bytes()).unwrap()
    };
    assert!(call("pause").success);
    press_until(&peer, PRESSED, || free.sample(Duration::ZERO).is_some());
    let faded = forces.take::<WrenchStamped>();
    assert_eq!(faded.last().unwrap().force, [0.0; 3]);
    assert!(call("resume").success);
    press_until(&peer, PRESSED, || felt(&forces));
    assert!(call("reset").success);
}

#[test]
fn a_daemon_that_is_shut_down_leaves_the_device_with_zero_and_free() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    let free = peer.hear::<Empty>("/arm/free");
    peer.await_listener::<PoseStamped>(POSE);
    press_until(&peer, PRESSED, || felt(&forces));
    daemon.connect().rpc(Call::Shutdown).unwrap();
    free.next::<Empty>();
    assert_eq!(daemon.end().1, 0);
    assert_eq!(
        forces.take::<WrenchStamped>().last().unwrap().force,
        [0.0; 3]
    );
}

#[test]
fn a_clutch_pressed_in_contact_lets_the_hand_go_without_a_step_of_force() {
    let ros2 = format!("{ARM}button = \"/arm/button1\"\ngrab = 5\nclutch = 0\n");
    let (_files, daemon) = start(&ros2, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    let palpate = daemon.connect();
    let newest = palpate.forces("ball").unwrap();
    let forces = peer.hear::<WrenchStamped>(FORCE);
    peer.await_listener::<PoseStamped>(POSE);
    press_until(&peer, PRESSED, || felt(&forces));
    let button = |down: i32| Joy {
        buttons: vec![down],
        ..Joy::default()
    };
    peer.put("/arm/button1", &button(1));
    // The hand goes 5 cm away; the tool stays where it was, and the hand is let go.
    let mut steps = Vec::new();
    let mut last: Option<f64> = None;
    let mut x = PRESSED[0];
    let begun = Instant::now();
    loop {
        x = (x + 1e-4).min(PRESSED[0] + 0.05);
        peer.put(POSE, &pose(now_ms(), [x, PRESSED[1], PRESSED[2]]));
        std::thread::sleep(Duration::from_millis(1));
        for wrench in forces.take::<WrenchStamped>() {
            let force = wrench.force[0];
            steps.extend(last.map(|last: f64| (force - last).abs()));
            last = Some(force);
        }
        if last == Some(0.0) && x > PRESSED[0] + 0.049 {
            break;
        }
        assert!(begun.elapsed() < Duration::from_secs(60));
    }
    // The tool still presses: it stayed where it was.
    press_until(&peer, [x, PRESSED[1], PRESSED[2]], || {
        newest.get().is_some_and(|force| force.force[0] > 0.5)
    });
    peer.put("/arm/button1", &button(0));
    press_until(&peer, [x, PRESSED[1], PRESSED[2]], || felt(&forces));
    let largest = steps.iter().copied().fold(0.0, f64::max);
    println!(
        "{} forces while fading, largest step {largest:.3} N",
        steps.len()
    );
    assert!(steps.len() > 5, "{} messages", steps.len());
}

#[test]
fn devices_of_100_500_and_4000_hz_are_all_answered() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    peer.await_listener::<PoseStamped>(POSE);
    for rate_hz in [100_u64, 500, 4_000] {
        forces.take::<WrenchStamped>();
        let begun = Instant::now();
        let mut most: f64 = 0.0;
        for k in 1..=rate_hz {
            let share = 4.0 * k as f64 / rate_hz as f64;
            peer.put(POSE, &pose(now_ms(), coming_to(PRESSED, share)));
            let due = Duration::from_secs_f64(k as f64 / rate_hz as f64);
            std::thread::sleep(due.saturating_sub(begun.elapsed()));
        }
        let heard = forces.take::<WrenchStamped>();
        heard
            .iter()
            .for_each(|wrench| most = most.max(wrench.force[0]));
        println!("{rate_hz} Hz: {} forces, at most {most:.3} N", heard.len());
        assert!(most > 0.5, "{rate_hz} Hz: {most} N");
    }
}

pub fn contact_wrenches_and_nets_are_published_while_somebody_subscribes() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    peer.await_listener::<PoseStamped>(POSE);
    let contact = peer.hear::<WrenchStamped>("/palpate/ball/measured_cf");
    let nets = peer.hear::<MarkerArray>("/palpate/nets");
    press_until(&peer, PRESSED, || {
        let heard = contact.take::<WrenchStamped>();
        heard.iter().any(|wrench| wrench.force[0] > 0.5)
    });
    let mut drawn = Vec::new();
    let begun = Instant::now();
    press_until(&peer, PRESSED, || {
        drawn.extend(nets.take::<MarkerArray>());
        begun.elapsed() > Duration::from_secs(2) && !drawn.is_empty()
    });
    let marker = &drawn[0].markers[0];
    assert_eq!((marker.ns.as_str(), marker.shape), ("drop", 5));
    assert!(marker.points.len() > 100);
    let most = 31.0 * begun.elapsed().as_secs_f64();
    assert!(drawn.len() as f64 <= most, "{} in 2 s", drawn.len());
}

#[test]
fn an_array_of_numbers_goes_to_a_ros2_control_device() {
    let (_files, daemon) = start(
        "[[ros2.tool]]\ntool = \"ball\"\npreset = \"ros2_control_fd\"\n",
        &["--clock", "lockstep"],
    );
    let peer = Peer::connect(&daemon.endpoint);
    let forces = peer.hear::<Float64MultiArray>("/fd/fd_controller/commands");
    peer.await_listener::<PoseStamped>("/fd/ee_pose");
    for k in 1..=100 {
        let place = coming_to(PRESSED, k as f64 / 50.0);
        peer.put("/fd/ee_pose", &pose(k, place));
        let array: Float64MultiArray = forces.next();
        assert_eq!(array.data.len(), 3);
        if k == 100 {
            assert!(array.data[0] > 0.5, "{:?}", array.data);
        }
    }
}

pub fn a_router_may_appear_later_go_and_come_back() {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let router = format!("tcp/127.0.0.1:{port}");
    let arguments = ["--ros2", "--connect", &router];
    let text = format!("{SCENE}\n{ARM}");
    let daemon = Daemon::start(directory.path(), &text, &arguments);
    let palpate = daemon.connect();
    let newest = palpate.forces("ball").unwrap();
    for round in 0..2 {
        let router_session = open_router(&router);
        let peer = Peer::connect(&router);
        peer.await_listener::<PoseStamped>(POSE);
        let forces = peer.hear::<WrenchStamped>(FORCE);
        press_until(&peer, PRESSED, || felt(&forces));
        peer.session.close().wait().unwrap();
        router_session.close().wait().unwrap();
        let begun = Instant::now();
        // Gone: the pose is stale, and the force is zero.
        while newest.get().is_none_or(|force| force.force != [0.0; 3]) {
            assert!(begun.elapsed() < Duration::from_secs(60), "round {round}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// A router as a session of this program.
pub fn open_router(endpoint: &str) -> zenoh::Session {
    use palpate::transport::{Role, SessionSettings, open};
    let settings = SessionSettings {
        listen: vec![endpoint.to_owned()],
        role: Role::Router,
        ..Default::default()
    };
    let begun = Instant::now();
    loop {
        match open(&settings) {
            Ok(session) => return session,
            // The port may still be in the hands of the one before.
            Err(error) => assert!(begun.elapsed() < Duration::from_secs(60), "{error}"),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn counts_of_ros_messages_are_in_the_metrics_and_slow_devices_in_the_doctor() {
    let (_files, daemon) = start(ARM, &[]);
    let peer = Peer::connect(&daemon.endpoint);
    peer.await_listener::<PoseStamped>(POSE);
    peer.put_bytes::<PoseStamped>(POSE, encode(&pose(1, AWAY)), None);
    let palpate = daemon.connect();
    let begun = Instant::now();
    let (mut counted, mut warned) = (false, false);
    while !(counted && warned) {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{counted} {warned}"
        );
        for _ in 0..40 {
            peer.put(POSE, &pose(now_ms(), AWAY));
            std::thread::sleep(Duration::from_millis(10));
        }
        let metrics = palpate.metrics().unwrap();
        let line = "palpate_ros2_poses_total{tool=\"ball\",outcome=\"no attachment\"} 1";
        counted = metrics.lines().any(|known| known == line);
        let done = Command::new(crate::daemon::PROGRAM)
            .args(["doctor", "--connect", &daemon.endpoint])
            .output()
            .unwrap();
        warned = String::from_utf8_lossy(&done.stdout).contains("below 1000");
    }
}

// Both tools listen to the pedal; neither knows of the other.
#[test]
fn one_clutch_topic_for_two_tools_holds_both() {
    let two = format!(
        "{}\n[[tool]]\nid = \"pen\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\n\
         pose = {{ position = [-0.06, 0.003, 0.045] }}\n",
        SCENE
    );
    let arm = |tool: &str, namespace: &str| {
        format!(
            "[[ros2.tool]]\ntool = \"{tool}\"\npreset = \"crtk\"\nnamespace = \"{namespace}\"\n\
             button = \"/pedals/clutch\"\ngrab = 5\nclutch = 0\n"
        )
    };
    let directory = tempfile::tempdir().unwrap();
    let text = format!("{two}\n{}{}", arm("ball", "/left"), arm("pen", "/right"));
    let daemon = Daemon::start(directory.path(), &text, &["--ros2"]);
    let peer = Peer::connect(&daemon.endpoint);
    for topic in ["/left/measured_cp", "/right/measured_cp"] {
        peer.await_listener::<PoseStamped>(topic);
    }
    peer.await_listener::<Joy>("/pedals/clutch");
    let palpate = daemon.connect();
    let newest = ["ball", "pen"].map(|tool| palpate.forces(tool).unwrap());
    let places: [[f64; 3]; 2] = [[0.06, 0.003, 0.045], [-0.06, 0.003, 0.045]];
    let mut away = 0.0;
    let mut send = |step: f64| {
        away += step;
        for (topic, place) in ["/left/measured_cp", "/right/measured_cp"]
            .iter()
            .zip(places)
        {
            let x = place[0] + away * place[0].signum();
            peer.put(topic, &pose(now_ms(), [x, place[1], place[2]]));
        }
        std::thread::sleep(Duration::from_millis(1));
        away
    };
    let moved = || {
        let x = |k: usize| newest[k].get().map_or(0.0, |force| force.proxy_position[0]);
        [x(0) - places[0][0], places[1][0] - x(1)]
    };
    let begun = Instant::now();
    while moved().iter().any(|by| by.abs() > 1e-4) {
        assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", moved());
        send(0.0);
    }
    peer.put(
        "/pedals/clutch",
        &Joy {
            buttons: vec![1],
            ..Joy::default()
        },
    );
    // The pedal's message is on its way while poses are.
    for _ in 0..200 {
        send(0.0);
    }
    let mut to = 0.0;
    for _ in 0..300 {
        to = send(1e-4);
    }
    for _ in 0..100 {
        send(0.0);
    }
    assert!(to > 0.029);
    let still = moved();
    assert!(still.iter().all(|by| by.abs() < 1e-3), "{still:?}");
}

// Where rmw_zenohd usually is, there is a router: the daemon connects to it and is no second one.
#[test]
fn with_the_usual_port_taken_the_daemon_connects_to_who_has_it() {
    if std::net::TcpListener::bind("127.0.0.1:7447").is_err() {
        println!("skipped: somebody has port 7447");
        return;
    }
    let router = open_router("tcp/127.0.0.1:7447");
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("scene.toml");
    std::fs::write(&scene, format!("{SCENE}\n{ARM}")).unwrap();
    let mut daemon = Command::new(crate::daemon::PROGRAM)
        .args(["serve", "--ros2", "--no-rt", "--for", "60s"])
        .arg(&scene)
        .stdin(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let peer = Peer::connect("tcp/127.0.0.1:7447");
    peer.await_listener::<PoseStamped>(POSE);
    let forces = peer.hear::<WrenchStamped>(FORCE);
    press_until(&peer, PRESSED, || felt(&forces));
    let _ = daemon.kill();
    let _ = daemon.wait();
    router.close().wait().unwrap();
}

#[test]
fn a_scene_with_a_wrong_mapping_is_refused_with_its_line() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("scene.toml");
    std::fs::write(&scene, format!("{SCENE}\n[[ros2.tool]]\ntool = \"pen\"\n")).unwrap();
    let done = Command::new(crate::daemon::PROGRAM)
        .args(["serve", "--ros2"])
        .arg(&scene)
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2));
    assert!(
        words.contains("no tool \"pen\"; the scene has ball"),
        "{words}"
    );
}
