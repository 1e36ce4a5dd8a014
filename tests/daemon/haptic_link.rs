//! The link between loop and device: lost and found, described, and told no more than a hand can
//! feel.

use crate::common::{Laws as _, World};
use crate::daemon::{Daemon, PROGRAM};
use palpate::transport::{SessionSettings, open};
use palpate_client::pose_at;
use palpate_client::proto::codec::decode;
use palpate_client::proto::messages::{DeviceInfo, EventKind, ToolContact};
use palpate_client::proto::rpc::Call;
use palpate_geometry::math::Vector3;
use palpate_record::Contents;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::TickRecord;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use zenoh::Wait;

/// A rigid drop. The force limit moves by 0.08 N a tick.
const SCENE: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }
device = { force_max_n = 8.0, ramp_s = 0.1 }
"#;
const FORCE_MAX_N: f64 = 8.0;
const RAMP_N: f64 = 0.08;
/// Some millimetres deep.
const INSIDE: [f64; 3] = [0.023, 0.003, 0.045];

fn info(deadband: f64) -> DeviceInfo {
    DeviceInfo {
        name: "desk arm".into(),
        dof_force: 3,
        dof_torque: 0,
        workspace: [0.16, 0.12, 0.07],
        force_max: 3.3,
        force_continuous: 0.88,
        torque_max: 0.0,
        mass: 0.045,
        damping: 0.2,
        coulomb_friction: 0.26,
        encoder_resolution: 5.5e-5,
        rate_hz: 1_000.0,
        delay_s: 0.0,
        deadband,
    }
}

/// Asks until the answer is yes.
fn until(what: &str, mut asked: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !asked() {
        assert!(
            Instant::now() < deadline,
            "waited a minute for this: {what}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// On the way from outside into the drop.
fn way(share: f64) -> [f64; 3] {
    [0.06 - (0.06 - INSIDE[0]) * share, INSIDE[1], INSIDE[2]]
}

// A client that died inside the body and comes back there, counting from 1: no force until it has been out of it;
// then that which it would have been without the loss.
#[test]
fn a_tool_that_returns_into_a_body_feels_no_kick() {
    let mut world = World::new(SCENE);
    for k in 0..300 {
        world.at(way(f64::from(k.min(200)) / 200.0));
    }
    let held = world.at(INSIDE).tools[0].force_n;
    assert!(
        held.norm() > 20.0 * RAMP_N,
        "{held:?} is too little to tell a kick by"
    );
    for _ in 0..300 {
        world.silent();
    }
    assert_eq!(world.silent().tools[0].force_n.norm(), 0.0);
    world.seq = 0;
    for k in 1..=200 {
        let tool = world.at(INSIDE).tools[0];
        assert_eq!((tool.pose_seq, tool.flags), (k, flags::WITHHELD));
        assert_eq!(tool.force_n.norm(), 0.0);
    }
    for k in 0..=200 {
        world.at(way(1.0 - f64::from(k) / 200.0));
    }
    for k in 0..300 {
        world.at(way(f64::from(k.min(200)) / 200.0));
    }
    let again = world.at(INSIDE);
    assert!(
        (again.tools[0].force_n - held).norm() < 1e-9 * held.norm(),
        "{:?} was {held:?}",
        again.tools[0].force_n
    );
}

/// Force on the device, N.
fn force_n(record: &TickRecord) -> f64 {
    record.output.tools[0].force_n.norm()
}

#[test]
fn a_device_killed_in_contact_leaves_by_the_ramp_and_the_next_one_joins_by_it() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("killed.mcap");
    let daemon = Daemon::start(
        directory.path(),
        SCENE,
        &["--record", file.to_str().unwrap()],
    );
    let palpate = daemon.connect();
    let lost = Arc::new(Mutex::new(0u64));
    let seen = lost.clone();
    let withheld = Arc::new(Mutex::new(0));
    let said = withheld.clone();
    let _events = palpate
        .events(move |event| match &event.kind {
            EventKind::ToolLost { .. } => *seen.lock().unwrap() = event.tick,
            EventKind::ForceWithheld { tool } if tool == "ball" => *said.lock().unwrap() += 1,
            _ => {}
        })
        .unwrap();
    // A bare subscriber, as other programs are: it is what makes the daemon send these messages.
    let session = open(&SessionSettings {
        connect: vec![daemon.endpoint.clone()],
        ..Default::default()
    })
    .unwrap();
    let felt = Arc::new(Mutex::new(0.0f64));
    let newest = felt.clone();
    let _contacts = session
        .declare_subscriber("palpate/default/tool/ball/contact")
        .callback(move |sample| {
            let contact: ToolContact = decode(
                &sample.payload().to_bytes(),
                "postcard;palpate.ToolContact.v1",
            )
            .unwrap();
            assert_eq!(contact.force_limit, FORCE_MAX_N);
            *newest.lock().unwrap() = contact.force.iter().map(|x| x * x).sum::<f64>().sqrt();
        })
        .wait()
        .unwrap();
    let mut device = Command::new(PROGRAM)
        .args([
            "device",
            "--tool",
            "ball",
            "--motion",
            "press",
            "--for",
            "120s",
            "--connect",
            &daemon.endpoint,
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    until("the device presses", || *felt.lock().unwrap() > 0.3);
    device.kill().unwrap();
    device.wait().unwrap();
    let killed = palpate.status().unwrap().tick;
    until("the tool is lost, and its force gone", || {
        let lost = *lost.lock().unwrap();
        lost + 60 > killed && palpate.status().unwrap().tick > lost.max(killed) + 200
    });

    // The next holder is another process's client: it counts from 1, and is in the body at once.
    let mut tool = palpate.tool("ball").unwrap();
    until("the old numbers are taken", || {
        let seq = tool.send(pose_at(INSIDE)).unwrap();
        tool.force()
            .is_some_and(|force| force.pose_seq > 100 && force.pose_seq <= seq)
    });
    let force = tool.force().unwrap();
    // The force is of the newest tick, which on a busy machine may be long after the pose.
    assert_eq!(
        (force.force, force.flags & !flags::STALE),
        ([0.0; 3], flags::WITHHELD)
    );
    for k in -200i32..=200 {
        tool.send(pose_at(way(f64::from(k.abs()) / 200.0))).unwrap();
        std::thread::sleep(Duration::from_millis(2));
    }
    until("it presses", || {
        tool.send(pose_at(INSIDE)).unwrap();
        *felt.lock().unwrap() > 1.0 && tool.force().is_some_and(|force| force.flags == 0)
    });
    palpate.rpc(Call::Shutdown).unwrap();
    drop(tool);
    let (text, code) = daemon.end();
    assert_eq!(code, 0, "{text}");

    let recording = Contents::open(&file).unwrap();
    let ticks = &recording.ticks;
    let seq = |k: usize| ticks[k].output.tools[0].pose_seq;
    let joined = (1..ticks.len())
        .rev()
        .find(|&k| seq(k) < seq(k - 1))
        .expect("no numbers began anew");
    let stale = |k: usize| ticks[k].output.tools[0].flags & flags::STALE != 0;
    assert!(stale(joined - 1));
    let left = (1..joined).rev().find(|&k| !stale(k - 1)).unwrap();
    assert!(
        force_n(&ticks[left - 1]) > 0.1,
        "killed out of contact: {} N",
        force_n(&ticks[left - 1])
    );
    for k in left..joined {
        let limit = (FORCE_MAX_N - RAMP_N * (k - left + 1) as f64).max(0.0);
        assert!(
            force_n(&ticks[k]) <= limit + 1e-12,
            "{} N, {} ticks after the loss",
            force_n(&ticks[k]),
            k - left
        );
    }
    assert_eq!(force_n(&ticks[joined - 1]), 0.0);
    let is_withheld = |k: usize| ticks[k].output.tools[0].flags & flags::WITHHELD != 0;
    let begun = (1..ticks.len()).filter(|&k| is_withheld(k) && !is_withheld(k - 1));
    assert_eq!(
        *withheld.lock().unwrap(),
        begun.count(),
        "an event for each time"
    );
    let released = (joined..ticks.len()).find(|&k| !is_withheld(k)).unwrap();
    assert!(released > joined + 100, "it was not told in time");
    assert!((joined..released).all(|k| force_n(&ticks[k]) == 0.0));
    for (k, record) in ticks[released..].iter().enumerate() {
        let limit = RAMP_N * (k + 1) as f64;
        assert!(
            force_n(record) <= limit + 1e-12,
            "{} N, {k} ticks after the return",
            force_n(record)
        );
    }
    let pushed = ticks[joined + 1].output.tools[0].contact_force_n.norm();
    assert!(
        pushed > 10.0 * RAMP_N,
        "contacts push with {pushed} N only: nothing to hold back"
    );
    assert!(
        ticks[released..].iter().any(|record| force_n(record) > 0.1),
        "the next holder feels nothing"
    );
}

#[test]
fn contacts_and_devices_are_told_and_lockstep_leaves_out_no_force() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let told = Arc::new(Mutex::new(Vec::new()));
    let heard = told.clone();
    let _events = palpate
        .events(move |event| {
            if let EventKind::DeviceTold { tool, name } = event.kind {
                heard.lock().unwrap().push((tool, name));
            }
        })
        .unwrap();
    let mut tool = palpate.tool("ball").unwrap();
    assert!(
        tool.announce(&DeviceInfo {
            mass: -1.0,
            ..info(0.5)
        })
        .is_err(),
        "no device has a mass of -1 kg"
    );
    tool.announce(&info(0.5)).unwrap();
    assert_eq!(palpate.device("ball").unwrap(), info(0.5));
    until("the event", || {
        *told.lock().unwrap() == [("ball".to_owned(), "desk arm".to_owned())]
    });
    assert_eq!(tool.contact().unwrap(), None);

    // Into the body and still: after the ramp the device gets what it told it can bear, along what
    // contacts do.
    let mut compared = 0;
    let mut step = |k: u32| {
        let share = (f64::from(k) / 200.0).min(1.0);
        let place = [0.06 - (0.06 - INSIDE[0]) * share, INSIDE[1], INSIDE[2]];
        let seq = tool.send(pose_at(place)).unwrap();
        let force = tool
            .wait_force(seq, Duration::from_secs(20))
            .expect("a force was left out in lockstep");
        assert_eq!(force.pose_seq, seq);
        // It is sent after the force.
        if k > 400
            && let Some(contact) = tool.contact().unwrap()
        {
            assert_eq!(
                (force.flags, force.torque),
                (flags::SATURATED, contact.torque)
            );
            let (told, whole) = (Vector3::from(force.force), Vector3::from(contact.force));
            let miss = (told - whole * (3.3 / whole.norm())).norm();
            assert!(
                miss < 1e-14 * whole.norm() && whole.norm() > 4.0,
                "{told} of {whole} at tick {}",
                force.tick
            );
            assert!(contact.force[0] > 1.0 && contact.tick > 300 && contact.dissipated_j == 0.0);
            compared += 1;
        }
        compared > 20
    };
    let mut k = 0;
    until("contacts come", || {
        k += 1;
        step(k)
    });
    let report: serde_json::Value = serde_json::from_str(&palpate.info().unwrap()).unwrap();
    let device = &report["devices"]["ball"];
    assert_eq!(
        (&device["info"]["name"], &device["refused"]),
        (&"desk arm".into(), &0.into()),
        "{report}"
    );
    assert_eq!(
        device["forces_suppressed"], 0,
        "lockstep leaves out none: {report}"
    );
    drop(tool);
    // The next holder may have another device.
    until("the device is forgotten", || {
        let report: serde_json::Value = serde_json::from_str(&palpate.info().unwrap()).unwrap();
        report["devices"]["ball"]["info"].is_null()
    });
}

#[test]
fn in_real_time_a_deadband_leaves_out_forces_and_a_new_daemon_is_told_again() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let port: u16 = daemon.endpoint.rsplit(':').next().unwrap().parse().unwrap();
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    tool.announce(&info(0.2)).unwrap();
    let suppressed = || {
        let report: serde_json::Value = serde_json::from_str(&palpate.info().unwrap()).unwrap();
        report["devices"]["ball"]["forces_suppressed"]
            .as_u64()
            .unwrap()
    };
    // Held still, nearly every force is like the one before; the newest still comes now and then.
    until("forces are left out", || {
        let before = tool.received();
        let seq = tool.send(pose_at(INSIDE)).unwrap();
        tool.wait_force(seq, Duration::from_secs(20))
            .expect("with a deadband, the newest force never came");
        tool.received() > before && suppressed() > 500
    });
    drop(daemon);
    // Another daemon at the same place: the client finds it by itself and tells it of the device.
    let daemon = Daemon::start_at(port, directory.path(), SCENE, &[]);
    let other = daemon.connect();
    until("the new daemon is told", || {
        tool.send(pose_at(INSIDE)).unwrap();
        std::thread::sleep(Duration::from_millis(20));
        let report: serde_json::Value = serde_json::from_str(&other.info().unwrap()).unwrap();
        report["devices"]["ball"]["info"]["name"] == "desk arm"
    });
    assert_eq!(other.device("ball").unwrap(), info(0.2));
}
