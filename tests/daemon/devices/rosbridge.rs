//! `/rosbridge`: JSON in the place of ROS.

use crate::daemon::Daemon;
use crate::page::serve;
use palpate_client::pose_at;
use palpate_client::proto::messages::{ToolForce, ToolPose};
use serde_json::{Value, json};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

use crate::scenes::RIGID_TEARDROP as SCENE;
const ARM: &str = "[[ros2.tool]]\ntool = \"ball\"\npreset = \"crtk\"\n";
const POSE: &str = "/arm/measured_cp";
const FORCE: &str = "/arm/body/servo_cf";
const PRESSED: [f64; 3] = [0.0255, 0.003, 0.045];
const AWAY: [f64; 3] = [0.036, 0.003, 0.045];

fn start(arguments: &[&str]) -> (tempfile::TempDir, Daemon, u16) {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), &format!("{SCENE}\n{ARM}"), arguments);
    (directory, daemon, port)
}

/// A client without libraries.
struct Bridge {
    socket: WebSocket<TcpStream>,
}

impl Bridge {
    fn try_open(port: u16, headers: &[(&'static str, &str)]) -> Result<Self, String> {
        let mut request = format!("ws://127.0.0.1:{port}/rosbridge")
            .into_client_request()
            .unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let wait = Some(Duration::from_secs(30));
        stream.set_read_timeout(wait).unwrap();
        stream.set_nodelay(true).unwrap();
        let (socket, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
        Ok(Self { socket })
    }

    fn open(port: u16) -> Self {
        Self::try_open(port, &[]).unwrap()
    }

    fn send(&mut self, request: &Value) {
        self.socket
            .send(Message::text(request.to_string()))
            .unwrap();
    }

    fn next(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                return serde_json::from_str(&text).unwrap();
            }
        }
    }

    /// The next answer of this kind.
    fn until(&mut self, op: &str) -> Value {
        loop {
            let answer = self.next();
            if answer["op"] == op {
                return answer;
            }
        }
    }

    /// Whatever comes within a time.
    fn within(&mut self, time: Duration) -> Vec<Value> {
        let (mut heard, until) = (Vec::new(), Instant::now() + time);
        while let Some(left) = until.checked_duration_since(Instant::now()) {
            let left = left.max(Duration::from_millis(1));
            self.socket.get_ref().set_read_timeout(Some(left)).unwrap();
            match self.socket.read() {
                Ok(Message::Text(text)) => heard.push(serde_json::from_str(&text).unwrap()),
                Ok(_) => {}
                Err(tungstenite::Error::Io(_)) => break,
                Err(error) => panic!("{error}"),
            }
        }
        let wait = Some(Duration::from_secs(30));
        self.socket.get_ref().set_read_timeout(wait).unwrap();
        heard
    }

    fn subscribe(&mut self, topic: &str) {
        self.send(&json!({
            "op": "subscribe", "id": "s1", "topic": topic, "type": "geometry_msgs/WrenchStamped",
        }));
    }

    fn pose(&mut self, stamp: Value, [x, y, z]: [f64; 3]) {
        self.send(&json!({ "op": "publish", "topic": POSE, "msg": {
            "header": { "stamp": stamp, "frame_id": "world" },
            "pose": {
                "position": { "x": x, "y": y, "z": z },
                "orientation": { "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0 },
            },
        }}));
    }

    /// Presses in real time until this is felt.
    fn press_until(&mut self, position: [f64; 3], felt: impl Fn(&Value) -> bool) {
        let begun = Instant::now();
        loop {
            assert!(begun.elapsed() < Duration::from_secs(60), "it is not felt");
            // A hand comes from outside, again and again: inside the body it would feel nothing.
            let share = (begun.elapsed().as_secs_f64() % 0.5 / 0.04).min(1.0);
            let coming = [0, 1, 2].map(|c| AWAY[c] + (position[c] - AWAY[c]) * share);
            self.pose(Value::Null, coming);
            if self.within(Duration::from_millis(1)).iter().any(&felt) {
                return;
            }
        }
    }
}

fn force_of(answer: &Value) -> f64 {
    answer["msg"]["wrench"]["force"]["x"]
        .as_f64()
        .unwrap_or(0.0)
}

fn ms(k: u64) -> Value {
    json!({ "sec": 1 + k / 1_000, "nanosec": k % 1_000 * 1_000_000 })
}

#[test]
fn in_lockstep_wrenches_of_rosbridge_are_the_forces_of_a_native_run_bit_for_bit() {
    let path = |k: u64| {
        [
            AWAY[0] - 0.06 * (k.min(200) as f64 * 1e-3),
            AWAY[1],
            AWAY[2],
        ]
    };
    let (_files, daemon, port) = start(&["--clock", "lockstep"]);
    let mut bridge = Bridge::open(port);
    bridge.subscribe(FORCE);
    let mut over_json = Vec::new();
    for k in 1..=300 {
        let velocity = json!({ "x": if k <= 200 { -0.06 } else { 0.0 }, "y": 0, "z": 0 });
        bridge.send(
            &json!({ "op": "publish", "topic": "/arm/measured_cv", "msg": {
                "twist": { "linear": velocity, "angular": { "x": 0, "y": 0, "z": 0 } },
            }}),
        );
        bridge.pose(ms(k), path(k));
        let wrench = bridge.until("publish");
        assert_eq!(wrench["topic"], FORCE);
        let force = &wrench["msg"]["wrench"]["force"];
        over_json.push(["x", "y", "z"].map(|c| force[c].as_f64().unwrap().to_bits()));
    }
    drop(daemon);

    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let mut pressed = 0;
    for (k, over_json) in (1..).zip(&over_json) {
        // The first velocity came before there was anybody to move.
        let moving = if (2..=200).contains(&k) { -0.06 } else { 0.0 };
        let pose = ToolPose {
            linear_velocity: [moving, 0.0, 0.0],
            ..pose_at(path(k))
        };
        let seq = tool.send(pose).unwrap();
        let force: ToolForce = tool.wait_force(seq, Duration::from_secs(30)).unwrap();
        assert_eq!(force.force.map(f64::to_bits), *over_json, "tick {k}");
        pressed += u32::from(force.force[0] > 0.5);
    }
    assert!(pressed > 100, "{pressed} ticks in contact");
}

#[test]
fn a_client_presses_and_leaves_the_tool_to_the_next() {
    let (_files, _daemon, port) = start(&[]);
    let mut first = Bridge::open(port);
    first.send(&json!({ "op": "advertise", "topic": POSE, "type": "geometry_msgs/PoseStamped" }));
    first.subscribe(FORCE);
    first.subscribe("/palpate/ball/measured_cf");
    first.press_until(PRESSED, |answer| {
        answer["topic"] == FORCE && force_of(answer) > 0.5
    });
    first.press_until(PRESSED, |answer| {
        answer["topic"] == "/palpate/ball/measured_cf" && force_of(answer) > 0.5
    });
    // While it holds the tool nobody else has it.
    let mut second = Bridge::open(port);
    second.pose(Value::Null, AWAY);
    let told = second.until("status");
    assert!(
        told["msg"]
            .as_str()
            .unwrap()
            .contains("held by somebody else"),
        "{told}"
    );
    // Silence: a last force of zero.
    let last = first.within(Duration::from_millis(700));
    let last = last
        .iter()
        .rfind(|answer| answer["topic"] == FORCE)
        .unwrap();
    assert_eq!(force_of(last), 0.0);
    drop(first);
    second.subscribe(FORCE);
    second.press_until(PRESSED, |answer| force_of(answer) > 0.5);
}

#[test]
fn a_client_can_ask_how_old_the_newest_force_is() {
    // In lockstep: without poses there are no forces.
    let (_files, _daemon, port) = start(&["--clock", "lockstep"]);
    let silence = "/palpate/ball/silence";
    let mut bridge = Bridge::open(port);
    bridge.subscribe(FORCE);
    bridge.send(&json!({ "op": "subscribe", "topic": silence, "type": "std_msgs/Float64" }));
    for k in 1..=10 {
        bridge.pose(ms(k), AWAY);
        while bridge.until("publish")["topic"] != FORCE {}
    }
    let mut last = 0.0;
    while last < 0.2 {
        let told = bridge.until("publish");
        assert_eq!(told["topic"], silence, "{told}");
        let age = told["msg"]["data"].as_f64().unwrap();
        assert!(age > last || last == 0.0, "{age} s after {last} s");
        last = age;
    }
}

#[test]
fn services_pause_and_resume_and_unknown_ones_are_named() {
    let (_files, daemon, port) = start(&[]);
    let mut bridge = Bridge::open(port);
    let mut call = |service: &str| {
        bridge.send(&json!({ "op": "call_service", "id": "c1", "service": service, "args": {} }));
        let answer = bridge.until("service_response");
        assert_eq!(
            (&answer["id"], &answer["service"]),
            (&json!("c1"), &json!(service))
        );
        answer
    };
    let done = call("/palpate/pause");
    assert_eq!(
        (&done["result"], &done["values"]["success"]),
        (&json!(true), &json!(true))
    );
    let palpate = daemon.connect();
    assert_eq!(palpate.status().unwrap().state as u8, 1);
    assert_eq!(call("/palpate/resume")["values"]["success"], true);
    assert_eq!(palpate.status().unwrap().state as u8, 0);
    assert_eq!(call("/palpate/reset")["values"]["success"], true);
    let unknown = call("/palpate/shutdown");
    assert_eq!(unknown["result"], false);
    assert!(
        unknown["values"]
            .as_str()
            .unwrap()
            .contains("/palpate/reset")
    );
    let topics = call("/rosapi/topics");
    assert!(
        topics["values"]["topics"]
            .as_array()
            .unwrap()
            .contains(&json!(POSE))
    );
}

#[test]
fn what_cannot_be_is_told_in_words_and_moves_nothing() {
    let (_files, daemon, port) = start(&[]);
    let mut bridge = Bridge::open(port);
    let far = "9".repeat(400);
    let cases = [
        ("{".to_owned(), "not a request"),
        (
            json!({ "op": "png", "data": "" }).to_string(),
            "not a request",
        ),
        (
            json!({ "op": "subscribe", "topic": "/nowhere" }).to_string(),
            "there is no topic \"/nowhere\"; there are /arm/measured_cp",
        ),
        (
            json!({ "op": "subscribe", "topic": FORCE, "type": "std_msgs/String" }).to_string(),
            "is a geometry_msgs/WrenchStamped, not a std_msgs/String",
        ),
        (
            json!({ "op": "subscribe", "topic": FORCE, "compression": "cbor" }).to_string(),
            "not compressed",
        ),
        (
            json!({ "op": "advertise", "topic": FORCE, "type": "geometry_msgs/WrenchStamped" })
                .to_string(),
            "comes from here",
        ),
        (
            json!({ "op": "publish", "topic": POSE, "msg": { "pose": 7 } }).to_string(),
            "pose.position",
        ),
        (
            format!(
                r#"{{"op":"publish","topic":"{POSE}","msg":{{"pose":{{"position":{{"x":{far},"y":0,"z":0}}}}}}}}"#
            ),
            "not a request",
        ),
    ];
    for (frame, words) in cases {
        bridge.socket.send(Message::text(frame.clone())).unwrap();
        let told = bridge.until("status");
        assert!(
            told["msg"].as_str().unwrap().contains(words),
            "{frame}: {told}"
        );
    }
    // CRTK: a stamp of 0 is not valid.
    bridge.pose(json!({ "sec": 0, "nanosec": 0 }), PRESSED);
    let told = bridge.until("status");
    assert!(
        told["msg"].as_str().unwrap().contains("not valid"),
        "{told}"
    );
    let status = daemon.connect().status().unwrap();
    assert_eq!(status.tools[0].received, 0);
}

pub fn a_throttled_subscriber_gets_fewer_messages() {
    let (_files, _daemon, port) = start(&[]);
    let mut presses = Bridge::open(port);
    let mut rarely = Bridge::open(port);
    rarely.send(&json!({
        "op": "subscribe", "topic": FORCE, "throttle_rate": 100, "queue_length": 1,
    }));
    presses.subscribe(FORCE);
    let begun = Instant::now();
    let mut often = 0;
    while begun.elapsed() < Duration::from_secs(2) {
        presses.pose(Value::Null, PRESSED);
        often += presses.within(Duration::from_millis(2)).len();
    }
    let seldom = rarely.within(Duration::from_millis(300)).len();
    println!("{often} messages, throttled {seldom}");
    assert!(
        seldom > 2 && seldom <= 25 && often > 2 * seldom,
        "{often} {seldom}"
    );
}

#[test]
fn foreign_sites_are_refused_and_an_audience_only_looks() {
    let (_files, daemon, port) =
        start(&["--http-view-only", "--http-origin", "http://unity.example"]);
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        let refused = Bridge::try_open(port, &[("origin", origin)]);
        assert!(
            refused.is_err_and(|error| error.contains("403")),
            "{origin}"
        );
    }
    let own = format!("http://127.0.0.1:{port}");
    assert!(Bridge::try_open(port, &[("origin", &own)]).is_ok());
    let mut bridge = Bridge::try_open(port, &[("origin", "http://unity.example")]).unwrap();
    bridge.pose(ms(1), PRESSED);
    let told = bridge.until("status");
    assert!(
        told["msg"].as_str().unwrap().contains("viewing only"),
        "{told}"
    );
    bridge.send(&json!({ "op": "call_service", "service": "/palpate/pause" }));
    assert_eq!(bridge.until("service_response")["result"], false);
    let status = daemon.connect().status().unwrap();
    assert_eq!((status.tools[0].received, status.state as u8), (0, 0));
}
