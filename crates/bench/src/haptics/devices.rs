//! What adapters add to a round trip: a step of the device's position to the force that answers it,
//! over ROS 2 and over a Haply service, beside a native client's.
//!
//! On a wall of 1000 N/m the position jumps between 1 and 2 mm deep; a trip ends with the first force
//! that is nearer to the new depth's than to the old one's.

use super::processes::{Files, Process, connect, free_port};
use super::{Bar, Figure};
use crate::Effort;
use anyhow::Context as _;
use palpate::transport::{Role, SessionSettings, open};
use palpate_adapters::ros2::{Intake, RosNode};
use palpate_client::pose_at;
use palpate_devices::haply::{Buttons, DeviceState, read_forces, state_message};
use palpate_devices::ros2::{Header, PoseStamped, Qos, WrenchStamped};
use std::net::TcpListener;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tungstenite::Message;

/// Between two trips: not a multiple of the tick, so that steps come at every phase of it.
const PAUSE: Duration = Duration::from_micros(1_370);
/// Poses before the wall, until the tool has joined.
const JOINING: usize = 300;
/// A trip that takes longer is lost.
const PATIENCE: Duration = Duration::from_millis(100);
const DEPTHS_M: [f64; 2] = [1e-3, 2e-3];
const STIFFNESS_N_M: f64 = 1_000.0;
/// What an adapter may add to the native median, s.
const ADDED_S: f64 = 1e-4;

pub(super) fn run(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Figure),
    failed: &mut Vec<String>,
) {
    if !wanted("latency/ros2") && !wanted("latency/haply") {
        return;
    }
    let count = if effort == Effort::Quick { 500 } else { 5_000 };
    match native(count) {
        Err(error) => failed.push(format!("latency/native: {error:#}")),
        Ok(native) => {
            let cases: [(&str, Measure, Option<f64>); 2] = [
                ("latency/ros2", ros2, Some(ADDED_S)),
                // The service answers once for each message, which costs a round trip more: no bar.
                ("latency/haply", haply, None),
            ];
            for (case, measure, added) in cases.into_iter().filter(|(case, ..)| wanted(case)) {
                match measure(count) {
                    Ok(trips) => rows(case, &trips, &native, added, out),
                    Err(error) => failed.push(format!("{case}: {error:#}")),
                }
            }
        }
    }
}

type Measure = fn(usize) -> anyhow::Result<Trips>;

/// Times of trips, s, in ascending order.
struct Trips {
    times_s: Vec<f64>,
    lost: usize,
}

impl Trips {
    fn quantile(&self, q: f64) -> f64 {
        self.times_s[((self.times_s.len() - 1) as f64 * q) as usize]
    }
}

fn rows(
    case: &str,
    trips: &Trips,
    native: &Trips,
    added: Option<f64>,
    out: &mut dyn FnMut(Figure),
) {
    for (method, q) in [("median", 0.5), ("p99", 0.99)] {
        let reference = native.quantile(q);
        out(Figure {
            suite: "haptics",
            case: case.to_owned(),
            method: method.to_owned(),
            value: trips.quantile(q),
            unit: "s",
            reference,
            reference_is: "native client",
            bar: added
                .filter(|_| q == 0.5)
                .map(|added| Bar::AtMost(reference + added)),
            note: format!(
                "{} steps, {} without answer",
                trips.times_s.len(),
                trips.lost
            ),
        });
    }
}

/// Steps to and fro. `send` gives the depth, m; `force` the newest force, N.
fn steps(
    count: usize,
    mut send: impl FnMut(f64) -> anyhow::Result<()>,
    mut force: impl FnMut() -> Option<f64>,
) -> anyhow::Result<Trips> {
    let (mut times_s, mut lost) = (Vec::with_capacity(count), 0);
    // A tool is where its device is when it joins: before the wall, not behind it.
    for _ in 0..JOINING {
        send(-DEPTHS_M[0])?;
        std::thread::sleep(PAUSE);
    }
    for k in 0..count + 100 {
        let depth_m = DEPTHS_M[k % 2];
        let arrived = |force: f64| (force - depth_m * STIFFNESS_N_M).abs() < 0.4;
        std::thread::sleep(PAUSE);
        let sent = Instant::now();
        send(depth_m)?;
        let mut answered = None;
        while answered.is_none() && sent.elapsed() < PATIENCE {
            match force() {
                Some(force) if arrived(force) => answered = Some(sent.elapsed()),
                _ => std::thread::sleep(Duration::from_micros(10)),
            }
        }
        // The first steps warm up what is on the way.
        if k >= 100 {
            match answered {
                Some(time) => times_s.push(time.as_secs_f64()),
                None => lost += 1,
            }
        }
    }
    anyhow::ensure!(!times_s.is_empty(), "no step was answered");
    times_s.sort_by(f64::total_cmp);
    Ok(Trips { times_s, lost })
}

fn scene(files: &Files) -> anyhow::Result<String> {
    let ros2 = "[[ros2.tool]]\ntool = \"tip\"\npreset = \"crtk\"\nvelocity = \"\"\n";
    let wall = super::rig::wall(STIFFNESS_N_M, 0.0, "");
    files.write("wall.toml", &format!("{wall}\n{ros2}"))
}

fn native(count: usize) -> anyhow::Result<Trips> {
    let files = Files::new("latency-native")?;
    let scene = scene(&files)?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let _daemon = Process::start(&["serve", &scene, "--listen", &endpoint])?;
    let palpate = connect(&endpoint)?;
    let tool = std::cell::RefCell::new(palpate.tool("tip")?);
    let send = |depth_m: f64| {
        tool.borrow_mut().send(pose_at([0.0, 0.0, -depth_m]))?;
        Ok(())
    };
    steps(count, send, || Some(tool.borrow().force()?.force[2]))
}

fn ros2(count: usize) -> anyhow::Result<Trips> {
    let files = Files::new("latency-ros2")?;
    let scene = scene(&files)?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let _daemon = Process::start(&["serve", &scene, "--ros2", "--listen", &endpoint])?;
    connect(&endpoint)?.close();
    let session = open(&SessionSettings {
        connect: vec![endpoint],
        role: Role::Client,
        ..Default::default()
    })?;
    let zenoh = |error: zenoh::Error| anyhow::anyhow!("Zenoh: {error}");
    let node = RosNode::new(&session, 0, "palpate_bench").map_err(zenoh)?;
    let newest = Arc::new(Mutex::new(None));
    let shared = newest.clone();
    let take = move |wrench: WrenchStamped, _| {
        *shared.lock().unwrap_or_else(PoisonError::into_inner) = Some(wrench.force[2]);
    };
    let intake = Arc::new(Intake::default());
    let _forces = node
        .subscriber::<WrenchStamped>("/arm/body/servo_cf", Qos::Newest, &intake, take)
        .map_err(zenoh)?;
    let poses = node
        .publisher::<PoseStamped>("/arm/measured_cp", Qos::Newest)
        .map_err(zenoh)?;
    let begun = Instant::now();
    while !poses.is_wanted() {
        anyhow::ensure!(
            begun.elapsed() < Duration::from_secs(20),
            "nobody takes poses"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    let send = |depth_m: f64| {
        let now = SystemTime::now().duration_since(UNIX_EPOCH)?;
        poses.put(&PoseStamped {
            header: Header::new(now.as_nanos() as u64, "world"),
            position: [0.0, 0.0, -depth_m],
            orientation: [0.0, 0.0, 0.0, 1.0],
        });
        Ok(())
    };
    steps(count, send, || {
        *newest.lock().unwrap_or_else(PoisonError::into_inner)
    })
}

/// A service that moves its device in steps.
fn haply(count: usize) -> anyhow::Result<Trips> {
    let files = Files::new("latency-haply")?;
    let scene = scene(&files)?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let _daemon = Process::start(&["serve", &scene, "--listen", &endpoint])?;
    connect(&endpoint)?.close();
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let uri = format!("ws://{}", listener.local_addr()?);
    let _adapter = Process::start(&[
        "device",
        "--tool",
        "tip",
        "--hardware",
        "haply",
        "--uri",
        &uri,
        "--for",
        "600s",
        "--connect",
        &endpoint,
    ])?;
    let (stream, _) = listener.accept()?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(Duration::from_secs(20)))?;
    let mut socket = tungstenite::accept(stream).context("the adapter's socket")?;
    let state = |depth_m: f64| DeviceState {
        device_id: "049D".into(),
        grip_id: "61548".into(),
        position: [0.0, 0.0, -depth_m],
        velocity: [0.0; 3],
        orientation: [0.0, 0.0, 0.0, 1.0],
        buttons: Buttons::default(),
        force: [0.0; 3],
    };
    socket.send(Message::text(state_message(
        &[state(-DEPTHS_M[0])],
        Some(1),
    )))?;
    // As in `steps`: one message, one state.
    let mut joining = JOINING;
    while joining > 0 {
        if let Message::Text(_) = socket.read()? {
            let before = state(-DEPTHS_M[0]);
            socket.send(Message::text(state_message(&[before], None)))?;
            std::thread::sleep(PAUSE);
            joining -= 1;
        }
    }
    let (mut times_s, mut lost) = (Vec::with_capacity(count), 0);
    let (mut k, mut sent) = (0, None::<Instant>);
    while k < count + 100 {
        let depth_m = DEPTHS_M[k % 2];
        let Message::Text(text) = socket.read()? else {
            continue;
        };
        let force = read_forces(&text)?
            .first()
            .map_or(0.0, |(_, force)| force[2]);
        let arrived = (force - depth_m * STIFFNESS_N_M).abs() < 0.4;
        if let Some(since) = sent.filter(|since| arrived || since.elapsed() > PATIENCE) {
            if k >= 100 {
                match arrived {
                    true => times_s.push(since.elapsed().as_secs_f64()),
                    false => lost += 1,
                }
            }
            (k, sent) = (k + 1, None);
        }
        let depth_m = DEPTHS_M[k % 2];
        sent.get_or_insert_with(Instant::now);
        socket.send(Message::text(state_message(&[state(depth_m)], None)))?;
    }
    anyhow::ensure!(!times_s.is_empty(), "no step was answered");
    times_s.sort_by(f64::total_cmp);
    Ok(Trips { times_s, lost })
}
