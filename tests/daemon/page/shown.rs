//! What a page sees.

use super::{SOFT, TWO_BALLS};
use crate::page::{Page, get, serve};
use palpate_client::pose_at;
use palpate_client::proto::codec::decode;
use palpate_client::proto::messages::{
    ControlNet, LoopStatus, SceneSnapshot, SimEvent, ToolContact, ToolForce,
};
use palpate_client::proto::rpc::Call;
use std::time::{Duration, Instant};

#[test]
fn a_page_gets_the_scene_first_then_all_nets_and_the_past_events() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let palpate = daemon.connect();
    palpate.rpc(Call::Reset).unwrap();
    let mut page = Page::watch(port);
    let (key, payload) = page.next().unwrap();
    assert_eq!(key, "scene");
    let scene: SceneSnapshot = decode(&payload, "").unwrap();
    let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.id.as_str()).collect();
    assert_eq!(bodies, ["drop"]);
    // As on the bus, to the byte.
    let net: ControlNet = page.message("body/drop/net");
    assert_eq!(net.points, scene.bodies[0].points);
    let status: LoopStatus = page.message("status");
    assert!(status.tick > 0);
    let events: Vec<SimEvent> = (page.seen.iter())
        .filter(|(key, _)| key == "event")
        .map(|(_, payload)| decode(payload, "").unwrap())
        .collect();
    assert_eq!(events[0].seq, 1, "{events:?}");
    let info = get(port, "/session.json").json();
    assert_eq!(info["mode"], "live");
    assert_eq!(info["instances"], serde_json::json!(["default"]));
    assert_eq!(info["recordings"], serde_json::json!([]));
    let tools = get(port, "/tools.json").json();
    assert_eq!(tools[0]["id"], "ball");
    assert!(tools[0]["triangles"].as_array().unwrap().len() > 50);
}

#[test]
fn what_a_remote_device_feels_is_shown() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let palpate = daemon.connect();
    let mut page = Page::watch(port);
    page.holder("ball", |who| who.is_none());
    let mut tool = palpate.tool("ball").unwrap();
    tool.send(pose_at([0.045, 0.003, 0.045])).unwrap();
    page.holder("ball", |who| who == Some("a client on the bus"));
    let force: ToolForce = page.message("tool/ball/force");
    assert_eq!(force.pose_seq, 1);
    let contact: ToolContact = page.message("tool/ball/contact");
    assert_eq!(contact.pose_seq, 1);
    drop(tool);
    page.holder("ball", |who| who.is_none());
}

// While it did not read, hundreds of nets were made; it gets the newest and no backlog.
pub fn a_page_that_does_not_read_gets_the_newest_only() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), SOFT, &[]);
    let mut page = Page::open(port);
    page.claim("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
    let palpate = daemon.connect();
    let nets = palpate.nets("drop").unwrap();
    // Pressed to and fro for a while without reading. What the system buffers for a socket is some
    // hundred kB, less than is posted meanwhile.
    let begun = Instant::now();
    let mut seq = 0;
    while begun.elapsed() < Duration::from_secs(5) {
        seq += 1;
        let phase = 1e-3 * begun.elapsed().as_millis() as f64;
        // From outside, where its force is not withheld.
        let x = f64::max(0.018 + 0.004 * phase.sin(), 0.05 - 1e-3 * seq as f64);
        page.pose(
            "ball",
            &palpate_client::proto::messages::ToolPose {
                seq,
                ..pose_at([x, 0.003, 0.045])
            },
        );
        std::thread::sleep(Duration::from_millis(16));
    }
    let newest = nets.get().expect("nets are published").tick;
    assert!(newest > 2_500, "the body did not move: {newest}");
    let mut read = 0;
    let reading = Instant::now();
    page.until("the newest net", |key, payload| {
        read += payload.len();
        (key == "body/drop/net").then_some(())?;
        (decode::<ControlNet>(payload, "").unwrap().tick >= newest).then_some(())
    });
    assert!(
        reading.elapsed() < Duration::from_secs(2),
        "{:?}",
        reading.elapsed()
    );
    // Five seconds of nets, forces and contacts would be more.
    println!("{read} bytes were read until the newest net");
}

// Two sheets become one while a page drags its tool over them: it gets the scene, then its nets, and
// goes on dragging.
#[test]
fn another_scene_is_told_with_its_bodies_while_a_page_drags() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), crate::editing::SCENE, &[]);
    let mut page = Page::open(port);
    let before: SceneSnapshot = page.message("scene");
    assert_eq!(before.bodies.len(), 4);
    page.claim("pen", "mouse");
    page.holder("pen", |who| who == Some("mouse"));
    let mut seq = 0;
    let mut drag = |page: &mut Page| {
        seq += 1;
        let pose = palpate_client::proto::messages::ToolPose {
            seq,
            ..pose_at([-0.05, 1e-4 * (seq % 20) as f64, 0.0048])
        };
        page.pose("pen", &pose);
        let force = page.until("the force", |key, payload| {
            (key == "tool/pen/force").then_some(())?;
            let force: ToolForce = decode(payload, "").unwrap();
            (force.pose_seq >= seq).then_some(force)
        });
        force.flags
    };
    for _ in 0..10 {
        drag(&mut page);
    }
    page.seen.clear();
    let merged = page.call("merge", r#"{"bodies": ["left", "right"], "id": "both"}"#);
    assert_eq!(merged["ok"], true, "{merged}");
    // The answer comes after the change.
    let place = page.seen.iter().position(|(key, _)| key == "scene");
    let place = place.expect("the scene is told before the answer");
    let after: SceneSnapshot = decode(&page.seen[place].1, "").unwrap();
    let bodies: Vec<&str> = after.bodies.iter().map(|body| body.id.as_str()).collect();
    assert!(bodies.contains(&"both") && bodies.len() == 3, "{bodies:?}");
    for (key, _) in &page.seen[..place] {
        assert_ne!(key, "body/both/net", "a net before its scene");
    }
    let told = |page: &Page| (page.seen[place..].iter()).any(|(key, _)| key == "body/both/net");
    while !told(&page) {
        drag(&mut page);
    }
    // Still held, and not stale.
    for _ in 0..20 {
        drag(&mut page);
    }
    assert_eq!(drag(&mut page) & 1, 0);
}

#[test]
fn other_instances_on_the_bus_are_listed_with_their_pages() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let others = ["--instance", "other", "--connect", &daemon.endpoint];
    let (_other, other_port) = serve(directory.path(), TWO_BALLS, &others);
    let info = crate::wire::until(
        "the other is known",
        || get(port, "/session.json").json(),
        |info| info["pages"]["other"].is_string(),
    );
    assert_eq!(info["instances"], serde_json::json!(["default", "other"]));
    let url = format!("http://127.0.0.1:{other_port}/");
    assert_eq!(info["pages"], serde_json::json!({ "other": url }));
}

#[test]
fn a_recording_that_is_played_has_a_page_without_hands() {
    let directory = tempfile::tempdir().unwrap();
    let golden = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("recordings/golden/rigid-teardrop-press.mcap");
    let (zenoh, port) = (crate::page::free_port(), crate::page::free_port());
    let address = format!("127.0.0.1:{port}");
    let _player = crate::daemon::Daemon::spawn(
        zenoh,
        std::process::Command::new(crate::daemon::PROGRAM)
            .arg("play")
            .arg(&golden)
            .args(["--loop", "--http", &address])
            .current_dir(directory.path()),
    );
    crate::page::wait_for(port);
    assert_eq!(get(port, "/session.json").json()["played"], true);
    let mut page = Page::open(port);
    let force: ToolForce = page.message("tool/ball/force");
    assert!(force.tick > 0);
    page.claim("ball", "mouse");
    assert!(page.refusal()["error"].as_str().unwrap().contains("played"));
    assert_eq!(page.call("pause", "{}")["ok"], true);
    assert_eq!(page.call("seek", "{\"tick\": 5}")["tick"], 5);
}

// Control points of a lattice are nodes: what is shown inside is compared with the net of the same tick.
#[test]
fn the_cells_of_bodies_and_where_their_nodes_are_is_shown_to_who_looks_inside() {
    let directory = tempfile::tempdir().unwrap();
    let text = SOFT.replace(
        "[[tool]]",
        "[[body.region]]\nyoung_pa = 40000.0\nball = { centre = [0.0, 0.0, 0.06], radius_m = 0.02 }\n[[tool]]",
    );
    let (_daemon, port) = serve(directory.path(), &text, &[]);
    let inside = get(port, "/inside.json").json();
    assert_eq!(inside[0]["id"], "drop");
    let nodes = inside[0]["nodes"].as_array().unwrap().len() / 3;
    let cells = inside[0]["cells"].as_array().unwrap();
    let young = inside[0]["young_pa"].as_array().unwrap();
    assert_eq!(cells.len(), 8 * young.len());
    assert!(
        cells
            .iter()
            .all(|node| node.as_u64().unwrap() < nodes as u64)
    );
    let stiff = young
        .iter()
        .filter(|value| value.as_f64() == Some(40_000.0))
        .count();
    assert!(
        stiff > 0 && stiff < young.len(),
        "{stiff} of {}",
        young.len()
    );

    let is_nodes = |key: &str| key == "body/drop/nodes";
    // Looking is not writing: no token is needed.
    let mut page = Page::open(port);
    let mut watcher = Page::watch(port);
    watcher.send("inside", &[1]);
    page.claim("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
    let mut nets = std::collections::HashMap::new();
    let mut compared = 0;
    for seq in 1..=80_u64 {
        let x = 0.06 - 0.0006 * seq as f64;
        let pose = palpate_client::proto::messages::ToolPose {
            seq,
            ..pose_at([x, 0.003, 0.045])
        };
        page.pose("ball", &pose);
        std::thread::sleep(Duration::from_millis(16));
    }
    let begun = Instant::now();
    while compared < 5 {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{compared} compared"
        );
        let (key, payload) = watcher.next().unwrap();
        if key == "body/drop/net" {
            let net: ControlNet = decode(&payload, "").unwrap();
            nets.insert(net.tick, net);
        } else if is_nodes(&key) {
            assert_eq!(payload.len(), 8 + 12 * nodes);
            let tick = u64::from_le_bytes(payload[..8].try_into().unwrap());
            let values: Vec<f32> = payload[8..]
                .chunks_exact(4)
                .map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()))
                .collect();
            // Nodes of a tick come before its net; the net of the frame before is here.
            watcher.until("its net", |key, payload| {
                (key == "body/drop/net").then_some(())?;
                let net: ControlNet = decode(payload, "").unwrap();
                nets.insert(net.tick, net);
                Some(())
            });
            let Some(net) = nets.get(&tick).filter(|_| tick > 0) else {
                continue;
            };
            for point in &net.points {
                let point = point.map(|x| x as f32);
                assert!(
                    values.chunks_exact(3).any(|node| *node == point),
                    "{point:?} at {tick}"
                );
            }
            compared += 1;
        }
    }
    // Without anybody who looks, none is made.
    watcher.send("inside", &[0]);
    drop(watcher);
    std::thread::sleep(Duration::from_millis(300));
    let mut late = Page::watch(port);
    for _ in 0..3 {
        late.message::<LoopStatus>("status");
    }
    assert!(!late.seen.iter().any(|(key, _)| is_nodes(key)));
}
