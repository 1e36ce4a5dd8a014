//! Live views: `/foxglove` and `--foxglove`.

use crate::daemon::{Daemon, free_port};
use crate::page::{serve, wait_for};
use crate::scenes::SOFT_DROP;
use palpate_client::pose_at;
use palpate_proto::recording::descriptors;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

const PRESSED: [f64; 3] = [0.0255, 0.003, 0.045];

/// A viewer without libraries.
struct Viewer {
    socket: WebSocket<TcpStream>,
    /// Protocol that the server chose.
    protocol: String,
    /// By topic.
    channels: BTreeMap<String, Value>,
    /// Messages that came while others were awaited.
    seen: Vec<Shown>,
}

/// A message of a channel.
struct Shown {
    subscription: u32,
    time_ns: u64,
    payload: Vec<u8>,
}

impl Viewer {
    fn connect(port: u16, path: &str, headers: &[(&'static str, &str)]) -> Result<Self, String> {
        let url = format!("ws://127.0.0.1:{port}{path}");
        let mut request = url.into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .unwrap();
        let (socket, answer) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
        let protocol = answer.headers()["sec-websocket-protocol"].to_str().unwrap();
        Ok(Self {
            socket,
            protocol: protocol.to_owned(),
            channels: BTreeMap::new(),
            seen: Vec::new(),
        })
    }

    fn open(port: u16, path: &str) -> Self {
        let headers = [("sec-websocket-protocol", "foxglove.sdk.v1")];
        let mut viewer = Self::connect(port, path, &headers).unwrap();
        let info = viewer.text();
        assert_eq!(
            (&info["op"], &info["capabilities"]),
            (&json!("serverInfo"), &json!([]))
        );
        viewer.advertised();
        viewer
    }

    fn advertised(&mut self) {
        let advertise = self.text();
        assert_eq!(advertise["op"], "advertise");
        for channel in advertise["channels"].as_array().unwrap() {
            let topic = channel["topic"].as_str().unwrap().to_owned();
            self.channels.insert(topic, channel.clone());
        }
    }

    fn next(&mut self) -> Result<Value, Shown> {
        loop {
            match self.socket.read().unwrap() {
                Message::Text(text) => return Ok(serde_json::from_str(&text).unwrap()),
                Message::Binary(bytes) => {
                    assert_eq!(bytes[0], 1);
                    return Err(Shown {
                        subscription: u32::from_le_bytes(bytes[1..5].try_into().unwrap()),
                        time_ns: u64::from_le_bytes(bytes[5..13].try_into().unwrap()),
                        payload: bytes[13..].to_vec(),
                    });
                }
                _ => {}
            }
        }
    }

    fn text(&mut self) -> Value {
        loop {
            if let Ok(text) = self.next() {
                return text;
            }
        }
    }

    /// A message of a subscription that pleases: one that came before, or the next.
    fn shown<M: prost::Message + Default>(&mut self, id: u32, pleases: impl Fn(&M) -> bool) -> M {
        let begun = Instant::now();
        let read = |shown: &Shown| {
            assert!(shown.time_ns > 1_600_000_000_000_000_000);
            let message =
                (shown.subscription == id).then(|| M::decode(&shown.payload[..]).unwrap());
            message.filter(&pleases)
        };
        if let Some(message) = self.seen.iter().rev().find_map(read) {
            return message;
        }
        loop {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "subscription {id}"
            );
            let Err(shown) = self.next() else { continue };
            let message = read(&shown);
            self.seen.push(shown);
            if let Some(message) = message {
                return message;
            }
        }
    }

    fn send(&mut self, request: &Value) {
        self.socket
            .send(Message::text(request.to_string()))
            .unwrap();
    }

    fn subscribe(&mut self, id: u32, topic: &str) {
        let channel = &self.channels[topic]["id"];
        let request =
            json!({ "op": "subscribe", "subscriptions": [{ "id": id, "channelId": channel }] });
        self.send(&request);
    }
}

#[test]
fn a_viewer_gets_the_views_of_recordings_with_their_schemas_and_sees_a_press() {
    use palpate_proto::foxglove as fox;
    use palpate_proto::recording as pb;
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), SOFT_DROP, &[]);
    let mut viewer = Viewer::open(port, "/foxglove");
    assert_eq!(viewer.protocol, "foxglove.sdk.v1");
    let topics: Vec<&str> = viewer.channels.keys().map(String::as_str).collect();
    let expected = [
        "/log",
        "/tf",
        "/tool/ball/wrench",
        "/view/body/drop/points",
        "/view/scene",
        "/view/tool/ball",
        "/view/tool/ball/shape",
    ];
    assert_eq!(topics, expected);
    let scene = &viewer.channels["/view/scene"];
    use base64::Engine as _;
    let schema = base64::engine::general_purpose::STANDARD
        .decode(scene["schema"].as_str().unwrap())
        .unwrap();
    assert_eq!(schema, descriptors("foxglove.SceneUpdate").unwrap());
    assert_eq!(scene["encoding"], "protobuf");
    for (id, topic) in (1..).zip(expected) {
        viewer.subscribe(id, topic);
    }
    let all = viewer.shown::<fox::SceneUpdate>(5, |scene| {
        scene.entities.iter().any(|entity| entity.id == "body/drop")
    });
    assert!(!all.entities[0].triangles[0].points.is_empty());
    let shape = viewer.shown::<fox::SceneUpdate>(7, |_| true);
    assert_eq!(shape.entities[0].frame_id, "tool/ball");
    // A device presses: the arrow of its force, its frame, the dent.
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let stop = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (tool, stop) = (&mut tool, &stop);
        scope.spawn(move || {
            let mut x = 0.06;
            while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                x = f64::max(x - 1e-4, PRESSED[0]);
                tool.send(pose_at([x, PRESSED[1], PRESSED[2]])).unwrap();
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        let arrow = viewer.shown::<fox::SceneUpdate>(5, |scene| {
            let tools = || {
                scene
                    .entities
                    .iter()
                    .filter(|entity| entity.id == "tool/ball")
            };
            tools().any(|tool| !tool.arrows.is_empty())
        });
        assert!(!arrow.entities.is_empty());
        viewer
            .shown::<fox::FrameTransforms>(2, |tf| tf.transforms[0].child_frame_id == "tool/ball");
        viewer.shown::<pb::Wrench>(3, |wrench| wrench.force.is_some_and(|force| force.x > 0.0));
        viewer.shown::<fox::PoseInFrame>(6, |pose| {
            let position = pose.pose.unwrap().position.unwrap();
            position.x < 0.04 && position.x > PRESSED[0] - 1e-3
        });
        viewer.shown::<fox::PointCloud>(4, |cloud| {
            let point =
                |k: usize| f32::from_le_bytes(cloud.data[k + 12..k + 16].try_into().unwrap());
            (0..cloud.data.len()).step_by(20).any(|k| point(k) > 1e-4)
        });
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    viewer.shown::<fox::Log>(1, |log| log.message.contains("tool joined"));
}

#[test]
fn views_are_made_for_subscriptions_and_for_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), SOFT_DROP, &[]);
    let mut viewer = Viewer::open(port, "/foxglove");
    let pause = |viewer: &mut Viewer, time: Duration| {
        let stream = viewer.socket.get_ref();
        stream.set_read_timeout(Some(time)).unwrap();
        let mut heard = Vec::new();
        let until = Instant::now() + time;
        while Instant::now() < until {
            match viewer.socket.read() {
                Ok(Message::Binary(bytes)) => {
                    heard.push(u32::from_le_bytes(bytes[1..5].try_into().unwrap()))
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(_)) => break,
                Err(error) => panic!("{error}"),
            }
        }
        let stream = viewer.socket.get_ref();
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .unwrap();
        heard
    };
    assert!(pause(&mut viewer, Duration::from_millis(300)).is_empty());
    viewer.subscribe(9, "/view/tool/ball");
    let heard = pause(&mut viewer, Duration::from_millis(1_000));
    assert!(
        !heard.is_empty() && heard.iter().all(|id| *id == 9),
        "{heard:?}"
    );
    // A viewer that comes later to the scene gets all of it, though it rests.
    viewer.subscribe(10, "/view/scene");
    viewer.shown::<palpate_proto::foxglove::SceneUpdate>(10, |scene| {
        scene.entities.iter().any(|entity| entity.id == "body/drop")
    });
    viewer.send(&json!({ "op": "unsubscribe", "subscriptionIds": [9, 10] }));
    pause(&mut viewer, Duration::from_millis(300));
    assert!(pause(&mut viewer, Duration::from_millis(500)).is_empty());
}

#[test]
fn wrong_requests_are_told_and_end_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), SOFT_DROP, &[]);
    let mut viewer = Viewer::open(port, "/foxglove");
    for wrong in [
        json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 999 }] }),
        json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 0 }] }),
        json!({ "op": "subscribe" }),
        json!({ "op": "getParameters", "parameterNames": [] }),
        json!([1, 2, 3]),
    ] {
        viewer.send(&wrong);
        let status = viewer.text();
        assert_eq!(
            (&status["op"], &status["level"]),
            (&json!("status"), &json!(1)),
            "{wrong}"
        );
    }
    viewer
        .socket
        .send(Message::Binary(vec![1, 2, 3].into()))
        .unwrap();
    assert_eq!(viewer.text()["op"], "status");
    viewer.subscribe(2, "/tf");
    viewer.shown::<palpate_proto::foxglove::FrameTransforms>(2, |_| true);
}

#[test]
fn foreign_sites_and_other_protocols_are_refused_unless_they_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let site = "https://viewer.example";
    let own = free_port();
    let own_text = own.to_string();
    let arguments = ["--http-origin", site, "--foxglove", &own_text];
    let (_daemon, port) = serve(directory.path(), SOFT_DROP, &arguments);
    wait_for(own);
    let connect = |port, path: &str, origin: Option<&str>, protocol: Option<&str>| {
        let protocol = protocol.map(|protocol| ("sec-websocket-protocol", protocol));
        let origin = origin.map(|origin| ("origin", origin));
        let headers: Vec<_> = protocol.into_iter().chain(origin).collect();
        Viewer::connect(port, path, &headers)
            .map(|viewer| viewer.protocol)
            .map_err(|error| error.contains("403"))
    };
    let (old, new) = ("foxglove.websocket.v1", "foxglove.sdk.v1");
    for (port, path) in [(port, "/foxglove"), (own, "/"), (own, "/foxglove")] {
        let both = format!("{new}, {old}");
        assert_eq!(connect(port, path, None, Some(old)).as_deref(), Ok(old));
        assert_eq!(connect(port, path, None, Some(&both)).as_deref(), Ok(new));
        assert_eq!(
            connect(port, path, Some(site), Some(new)).as_deref(),
            Ok(new)
        );
        for origin in ["https://evil.example", "null", "http://viewer.example"] {
            assert_eq!(
                connect(port, path, Some(origin), Some(new)),
                Err(true),
                "{origin}"
            );
        }
        assert_eq!(connect(port, path, None, Some("graphql-ws")), Err(false));
    }
    // The named site gets to nothing else.
    let answer = crate::page::get_with(port, "/session.json", &[("Origin", site)]);
    assert_eq!(answer.status, 403);
}

#[test]
fn merged_bodies_come_on_other_channels() {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let scene = crate::editing::SCENE;
    let daemon = Daemon::start(directory.path(), scene, &["--foxglove", &port.to_string()]);
    wait_for(port);
    let mut viewer = Viewer::open(port, "/");
    let before = viewer.channels.clone();
    viewer.subscribe(1, "/view/scene");
    viewer.shown::<palpate_proto::foxglove::SceneUpdate>(1, |_| true);
    let palpate = daemon.connect();
    let arguments = json!({ "bodies": ["left", "right"], "id": "both" });
    let call = palpate_client::proto::rpc::Call::parse("merge", arguments.to_string().as_bytes());
    palpate.rpc(call.unwrap()).unwrap();
    let gone = viewer.text();
    assert_eq!(gone["op"], "unadvertise");
    assert_eq!(gone["channelIds"].as_array().unwrap().len(), before.len());
    viewer.channels.clear();
    viewer.advertised();
    assert!(viewer.channels.contains_key("/view/body/both/points"));
    viewer.subscribe(2, "/view/scene");
    viewer.shown::<palpate_proto::foxglove::SceneUpdate>(2, |scene| {
        scene.entities.iter().any(|entity| entity.id == "body/both")
    });
}
