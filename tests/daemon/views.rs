//! What viewers find in a recording: Foxglove messages that show the simulation, and only when
//! something changed.

use crate::live::{Live, SOFT};
use crate::scenes::RIGID;
use palpate_proto::foxglove as fox;
use palpate_proto::recording as pb;
use palpate_record::{Contents, RecorderSettings};
use palpate_sim::scene::{Scene, file};
use prost::Message;
use std::collections::BTreeMap;
use std::path::Path;

type Messages = BTreeMap<String, Vec<(u64, Vec<u8>)>>;

/// All messages by topic, with the schema each topic names.
fn read(path: &Path) -> (Messages, BTreeMap<String, String>) {
    let bytes = std::fs::read(path).unwrap();
    let (mut messages, mut schemas) = (Messages::new(), BTreeMap::new());
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert!(schema.encoding == "protobuf" && message.channel.message_encoding == "protobuf");
        schemas.insert(message.channel.topic.clone(), schema.name.clone());
        messages
            .entry(message.channel.topic.clone())
            .or_default()
            .push((message.log_time, message.data.into_owned()));
    }
    (messages, schemas)
}

fn all<M: Message + Default>(messages: &Messages, topic: &str) -> Vec<(u64, M)> {
    let list = messages
        .get(topic)
        .unwrap_or_else(|| panic!("nothing on {topic}"));
    list.iter()
        .map(|(time, data)| (*time, M::decode(&data[..]).unwrap()))
        .collect()
}

#[test]
fn pictures_show_the_nets_and_tools_of_their_ticks() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("seen.mcap");
    let mut live = Live::start(&path, SOFT);
    let mut archive = live.recorder.archive().unwrap();
    for k in 0..700 {
        live.tick();
        if k == 300 {
            archive.event(300, "tool_lost", "ball");
        }
    }
    let (_, records) = live.finish();
    let (messages, schemas) = read(&path);
    let expected = [
        ("/view/scene", "foxglove.SceneUpdate"),
        ("/view/body/drop/points", "foxglove.PointCloud"),
        ("/view/body/sheet/points", "foxglove.PointCloud"),
        ("/view/tool/ball", "foxglove.PoseInFrame"),
        ("/view/tool/pen", "foxglove.PoseInFrame"),
        ("/view/tool/ball/shape", "foxglove.SceneUpdate"),
        ("/view/tool/pen/shape", "foxglove.SceneUpdate"),
        ("/tool/ball/wrench", "palpate.v1.Wrench"),
        ("/tool/pen/wrench", "palpate.v1.Wrench"),
        ("/tf", "foxglove.FrameTransforms"),
        ("/log", "foxglove.Log"),
        ("/sim/tick", "palpate.v1.Tick"),
    ];
    for (topic, schema) in expected {
        assert_eq!(
            schemas.get(topic).map(String::as_str),
            Some(schema),
            "{topic}"
        );
    }

    // Wrenches are those of the ticks in which they changed, and no tick between is left out.
    let wrenches = all::<pb::Wrench>(&messages, "/tool/ball/wrench");
    assert!(wrenches.len() > 50, "{} wrenches", wrenches.len());
    let mut newest = wrenches.iter().peekable();
    let mut now = None;
    for record in &records {
        while let Some((_, wrench)) =
            newest.next_if(|(time, _)| *time <= record.output.tick * 1_000_000)
        {
            now = Some(wrench);
        }
        let (force, torque) = (now.unwrap().force.unwrap(), now.unwrap().torque.unwrap());
        let tool = &record.output.tools[0];
        assert_eq!(
            [force.x, force.y, force.z],
            <[f64; 3]>::from(tool.force_n),
            "tick {}",
            record.output.tick
        );
        assert_eq!(
            [torque.x, torque.y, torque.z],
            <[f64; 3]>::from(tool.torque_nm)
        );
    }

    // Poses are the proxies of their ticks.
    let poses = all::<fox::PoseInFrame>(&messages, "/view/tool/ball");
    assert!(
        (20..=22).contains(&poses.len()),
        "{} pictures in 0.7 s",
        poses.len()
    );
    for (time, pose) in &poses {
        let stamp = pose.timestamp.unwrap();
        assert_eq!(
            stamp.seconds as u64 * 1_000_000_000 + stamp.nanos as u64,
            *time
        );
        let proxy = records[(time / 1_000_000) as usize - 1].output.tools[0].proxy_position;
        let position = pose.pose.unwrap().position.unwrap();
        assert_eq!(
            [position.x, position.y, position.z],
            [proxy.x, proxy.y, proxy.z]
        );
    }

    // Points are those of the surface with the newest net before them.
    let session = Contents::open(&path).unwrap();
    let loaded = file::parse(SOFT, "test.toml", Path::new(".")).unwrap();
    let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
    let clouds = all::<fox::PointCloud>(&messages, "/view/body/drop/points");
    assert!(clouds.len() > 10);
    let mut largest = 0.0_f32;
    for (time, cloud) in &clouds[1..] {
        let net = session
            .nets
            .iter()
            .rfind(|net| net.body == "drop" && net.tick * 1_000_000 < *time)
            .unwrap();
        let mut surface = scene.rest_surface(0).unwrap().clone();
        for (to, from) in surface
            .net_mut()
            .points_mut()
            .iter_mut()
            .zip(net.points.chunks_exact(3))
        {
            *to = [from[0], from[1], from[2]].into();
        }
        let value = |k: usize| f32::from_le_bytes(cloud.data[4 * k..4 * k + 4].try_into().unwrap());
        assert_eq!((cloud.point_stride, cloud.fields.len()), (20, 8));
        let (from, _) = surface.knots_u().domain();
        let (start, _) = surface.knots_v().domain();
        let corner = surface.point(from, start);
        assert_eq!(
            [value(0), value(1), value(2)],
            [corner.x as f32, corner.y as f32, corner.z as f32]
        );
        largest = (0..cloud.data.len() / 20)
            .map(|k| value(5 * k + 3))
            .fold(largest, f32::max);
    }
    assert!(
        largest > 1e-3,
        "a press of centimetres moves points by {largest} m"
    );

    // One entity a body and a tool, whole triangles, arrows while a force acts.
    let scenes = all::<fox::SceneUpdate>(&messages, "/view/scene");
    let ids: Vec<_> = scenes[0]
        .1
        .entities
        .iter()
        .map(|entity| entity.id.as_str())
        .collect();
    assert_eq!(ids, ["body/drop", "body/sheet", "tool/ball", "tool/pen"]);
    for entity in scenes.iter().flat_map(|(_, scene)| &scene.entities) {
        for triangles in &entity.triangles {
            assert!(triangles.indices.len().is_multiple_of(3));
            assert!(
                triangles
                    .indices
                    .iter()
                    .all(|index| (*index as usize) < triangles.points.len())
            );
        }
    }
    // Shapes come once, in the frame of their tool, and whole.
    for tool in ["ball", "pen"] {
        let shapes = all::<fox::SceneUpdate>(&messages, &format!("/view/tool/{tool}/shape"));
        assert_eq!((shapes.len(), shapes[0].1.entities.len()), (1, 1));
        let entity = &shapes[0].1.entities[0];
        assert_eq!(entity.frame_id, format!("tool/{tool}"));
        assert!(entity.frame_locked);
        let triangles = &entity.triangles[0];
        let outline = scene.tool_outline(scene.tool_index(tool).unwrap(), 1.0);
        assert_eq!(triangles.indices.len(), 3 * outline.triangles.len());
        assert!(triangles.indices.len() > 300);
    }
    let arrows = scenes
        .iter()
        .flat_map(|(_, s)| &s.entities)
        .filter(|e| !e.arrows.is_empty())
        .count();
    assert!(arrows > 5, "{arrows} arrows");
    let logs = all::<fox::Log>(&messages, "/log");
    assert_eq!(
        (logs.len(), logs[0].1.message.as_str()),
        (1, "tool lost: ball")
    );
    assert_eq!(logs[0].1.level(), fox::log::Level::Info);
}

#[test]
fn what_stands_still_is_drawn_once_and_what_nobody_wants_not_at_all() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rigid.mcap");
    let mut live = Live::start(&path, RIGID);
    (0..400).for_each(|_| live.tick());
    live.finish();
    let (messages, _) = read(&path);
    assert_eq!(messages["/view/body/drop/points"].len(), 1);
    assert!(messages["/view/scene"].len() > 5);

    let plain = directory.path().join("plain.mcap");
    let text = RIGID.replace("[record]\n", "[record]\nviews = false\n");
    let mut live = Live::with(&text, |settings| RecorderSettings {
        ..settings.to(&plain)
    });
    (0..400).for_each(|_| live.tick());
    live.finish();
    let (messages, _) = read(&plain);
    assert!(
        messages
            .keys()
            .all(|topic| topic.starts_with("/sim/") || topic.starts_with("/body/")),
        "{:?}",
        messages.keys()
    );
}
