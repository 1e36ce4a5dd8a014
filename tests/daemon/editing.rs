//! Scenes edited while they run: merge, isolate and truncate, asked for by a client, under a tool that
//! presses, recorded and replayed.

use palpate_client::proto::messages::EventKind;
use palpate_client::proto::rpc::Call;
use palpate_client::testing::TestSession;
use palpate_client::{Palpate, pose_at};
use palpate_record::{Session, replay};
use std::path::Path;

const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate");

/// Two sheets 1 mm apart, two balls in each other, and a pen above the first sheet.
pub const SCENE: &str = r#"
[[body]]
id = "left"
surface = { builtin = "sheet", size = 0.1 }
pose = { position = [-0.0505, 0.0, 0.0] }
model = "membrane"
lattice = { thickness_m = 2e-3, refine = [10, 10] }
fixed = [{ point = [0, -0.049, 0], normal = [0, 1, 0] }, { point = [0, 0.049, 0], normal = [0, -1, 0] }]

[[body]]
id = "right"
surface = { builtin = "sheet", size = 0.1 }
pose = { position = [0.0505, 0.0, 0.0] }
model = "membrane"
lattice = { thickness_m = 2e-3, refine = [10, 10] }
fixed = [{ point = [0, -0.049, 0], normal = [0, 1, 0] }, { point = [0, 0.049, 0], normal = [0, -1, 0] }]

[[body]]
id = "moving"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.3, 0.0, 0.0] }

[[body]]
id = "staying"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.335, 0.0, 0.0] }

[[tool]]
id = "pen"
shape = { sphere = { radius_m = 5e-3 } }
pose = { position = [-0.05, 0.0, 0.0054] }
"#;

fn merge(names: &[&str], more: &str) -> Call {
    call("merge", names, more)
}

fn isolate(names: &[&str], more: &str) -> Call {
    call("isolate", names, more)
}

/// A call of bodies; `more`: its other arguments as JSON, each after a comma.
fn call(method: &str, names: &[&str], more: &str) -> Call {
    let arguments = format!("{{\"bodies\": {names:?}{more}}}");
    Call::parse(method, arguments.as_bytes()).unwrap()
}

pub fn refused(palpate: &Palpate, call: Call) -> String {
    palpate.call(call).unwrap_err().to_string()
}

pub fn ids(palpate: &Palpate) -> Vec<String> {
    palpate
        .scene()
        .unwrap()
        .bodies
        .into_iter()
        .map(|body| body.id)
        .collect()
}

fn net(palpate: &Palpate, id: &str) -> Vec<[f64; 3]> {
    palpate
        .scene()
        .unwrap()
        .bodies
        .into_iter()
        .find(|body| body.id == id)
        .unwrap()
        .points
}

/// A file replays bit for bit, and begins where the one before it ended.
pub fn replays(path: &Path, after: u64) -> (Session, u64) {
    let session = Session::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(
        session.is_clean() && session.gaps() == 0,
        "{}",
        path.display()
    );
    let (first, last) = session.tick_range().unwrap();
    assert_eq!(first, after + 1, "{}", path.display());
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(
        report.passed() && report.ticks_matched == last - after,
        "{}: {report:?}",
        path.display()
    );
    (session, last)
}

#[test]
fn bodies_are_moved_apart_and_merged_under_a_tool_and_each_part_of_the_recording_replays() {
    let directory = tempfile::tempdir().unwrap();
    let record = directory.path().join("edited.mcap");
    let mut session = TestSession::of(SCENE)
        .program(PROGRAM)
        .record(&record)
        .start()
        .unwrap();
    let mut pen = session.tool("pen").unwrap();
    let mut height = 5.4e-3;
    let mut forces = Vec::new();
    let mut press = |session: &mut TestSession, pen: &mut palpate_client::Tool, ticks: usize| {
        for _ in 0..ticks {
            height -= 5e-6;
            let force = session.step(pen, pose_at([-0.05, 0.0, height])).unwrap();
            forces.push((force.tick, force.force[2]));
        }
    };
    press(&mut session, &mut pen, 600);

    let before = net(session.palpate(), "moving");
    // The balls: centres 35 mm apart, radii 20 mm each.
    let apart = isolate(&["moving", "staying"], ", \"gap\": 5e-4");
    let done = session.palpate().call(apart.clone()).unwrap();
    assert_eq!(done.tick, 601);
    let report = done.report.unwrap();
    let by: Vec<f64> = serde_json::from_value(report["translation"].clone()).unwrap();
    assert!(
        by[0] < -0.0054 && by[0] > -0.0058 && by[1].abs() < 1e-3 && by[2].abs() < 1e-3,
        "{report}"
    );
    let after = net(session.palpate(), "moving");
    for (p, q) in before.iter().zip(&after) {
        assert!(
            (0..3).all(|k| (p[k] + by[k] - q[k]).abs() < 1e-15),
            "{p:?} {q:?}"
        );
    }
    // The sheet is pressed as before, though no tick has run since.
    let lowest = |points: Vec<[f64; 3]>| points.iter().map(|p| p[2]).fold(0.0, f64::min);
    assert!(lowest(net(session.palpate(), "left")) < -1e-3);
    press(&mut session, &mut pen, 200);
    // Once more there is nothing to do: no other scene, no other file.
    let again = session.palpate().call(apart).unwrap();
    assert_eq!(
        again.report.unwrap()["translation"],
        serde_json::json!([0.0, 0.0, 0.0])
    );

    let sheet = merge(&["left", "right"], ", \"continuity\": 1, \"id\": \"sheet\"");
    let done = session.palpate().call(sheet).unwrap();
    assert_eq!(done.tick, 801);
    assert_eq!(ids(session.palpate()), ["sheet", "moving", "staying"]);
    press(&mut session, &mut pen, 300);
    let net = session.palpate().scene().unwrap().bodies.remove(0);
    assert!(
        net.points.iter().any(|p| p[0] < -0.1) && net.points.iter().any(|p| p[0] > 0.1),
        "both halves are there"
    );
    let changed: Vec<String> = session
        .palpate()
        .past_events(0)
        .unwrap()
        .into_iter()
        .filter_map(|event| match event.kind {
            EventKind::SceneChanged { what } => Some(what),
            _ => None,
        })
        .collect();
    assert_eq!(changed.len(), 2, "{changed:?}");
    assert!(
        changed[0].contains("moving") && changed[1].contains("sheet"),
        "{changed:?}"
    );
    session.finish(pen).unwrap();

    // The tool felt the sheet all the time; moving what it does not touch changes nothing in its
    // hand.
    let force = |tick: u64| forces.iter().find(|(t, _)| *t == tick).unwrap().1;
    assert!(
        force(600) > 1e-4 && (force(601) - force(600)).abs() < 0.05 * force(600),
        "{} {}",
        force(600),
        force(601)
    );
    // The merged sheet begins at rest, 3.6 mm under the tool's ball, and is thrown off; by then it has
    // swung back.
    assert!(
        forces
            .iter()
            .filter(|(tick, _)| *tick > 950)
            .all(|(_, force)| *force > 0.0)
    );
    let (_, last) = replays(&record, 0);
    assert_eq!(last, 600);
    let (moved, last) = replays(&directory.path().join("edited-0002.mcap"), 600);
    assert_eq!(last, 800);
    assert!(moved.header.run["scene_change"].contains("moving"));
    let (merged, last) = replays(&directory.path().join("edited-0003.mcap"), 800);
    assert_eq!(last, 1_100);
    assert_eq!(merged.header.run["bodies"], "sheet,moving,staying");
    assert!(!directory.path().join("edited-0004.mcap").exists());
}

#[test]
fn what_cannot_be_edited_is_refused_and_the_scene_goes_on() {
    let mut session = TestSession::of(SCENE).program(PROGRAM).start().unwrap();
    let mut pen = session.tool("pen").unwrap();
    session.step(&mut pen, pose_at([0.0, 0.0, 0.05])).unwrap();
    let palpate = session.palpate();
    let one = refused(palpate, merge(&["left"], ""));
    assert!(one.contains("at least two bodies"), "{one}");
    assert!(refused(palpate, merge(&[], "")).contains("at least two bodies"));
    assert!(refused(palpate, isolate(&["left", "left"], "")).contains("each once"));
    let unknown = refused(palpate, isolate(&["left", "rigth"], ""));
    assert!(
        unknown.contains("no body \"rigth\"") && unknown.contains("moving"),
        "{unknown}"
    );
    let name = refused(palpate, merge(&["left", "right"], ", \"id\": \"pen\""));
    assert!(name.contains("in use already"), "{name}");
    let name = refused(palpate, merge(&["left", "right"], ", \"id\": \"No Id\""));
    assert!(name.contains("No Id"), "{name}");
    let method = refused(
        palpate,
        isolate(&["moving", "staying"], ", \"method\": \"fast\""),
    );
    assert!(
        method.contains("fast") && method.contains("global"),
        "{method}"
    );
    let method = refused(palpate, merge(&["left", "right"], ", \"method\": \"fast\""));
    assert!(
        method.contains("fast") && method.contains("constrained"),
        "{method}"
    );
    // Surfaces that no merge joins, and an open surface that has no inside.
    assert!(!refused(palpate, merge(&["left", "staying"], "")).is_empty());
    assert!(!refused(palpate, isolate(&["left", "staying"], "")).is_empty());
    let high = refused(palpate, merge(&["left", "right"], ", \"continuity\": 9"));
    assert!(high.contains("C9"), "{high}");
    assert_eq!(ids(palpate), ["left", "right", "moving", "staying"]);
    let force = session.step(&mut pen, pose_at([0.0, 0.0, 0.05])).unwrap();
    assert_eq!(force.tick, 2);
    session.finish(pen).unwrap();
}

/// Two balls in each other, or apart and one of them soft.
fn balls(soft: bool) -> String {
    let (model, x) = if soft {
        ("model = \"lattice\"", 0.1)
    } else {
        ("", 0.03)
    };
    format!(
        r#"
[[body]]
id = "left"
surface = {{ builtin = "sphere", size = 0.02 }}
{model}

[[body]]
id = "right"
surface = {{ builtin = "sphere", size = 0.02 }}
pose = {{ position = [{x:?}, 0.0, 0.0] }}

[[tool]]
id = "pen"
shape = {{ sphere = {{ radius_m = 5e-3 }} }}
pose = {{ position = [0.0, 0.0, 0.0255] }}
"#
    )
}

#[test]
fn bodies_are_truncated_under_a_tool_and_each_part_of_the_recording_replays() {
    let directory = tempfile::tempdir().unwrap();
    let record = directory.path().join("cut.mcap");
    let mut session = TestSession::of(&balls(false))
        .program(PROGRAM)
        .record(&record)
        .start()
        .unwrap();
    let mut pen = session.tool("pen").unwrap();
    let mut height: f64 = 0.0255;
    let mut press = |session: &mut TestSession, ticks: usize| -> f64 {
        let mut last = 0.0;
        for _ in 0..ticks {
            height = (height - 5e-6).max(0.0245);
            let force = session.step(&mut pen, pose_at([0.0, 0.0, height]));
            last = force.unwrap().force[2];
        }
        last
    };
    let before = press(&mut session, 300);
    let done = session
        .palpate()
        .call(call("truncate", &["left", "right"], ""))
        .unwrap();
    assert_eq!(done.tick, 301);
    let report = done.report.unwrap();
    let volumes: Vec<f64> = serde_json::from_value(report["volumes"].clone()).unwrap();
    // Each ball without a cap of 5 mm.
    let left = std::f64::consts::PI * (4.0 / 3.0 * 8e-6 - 25e-6 * 0.055 / 3.0);
    for volume in &volumes {
        assert!((volume / left - 1.0).abs() < 1e-6, "{report}");
    }
    assert_eq!(ids(session.palpate()), ["left", "right"]);
    // The ball is as it was under the pen.
    let after = press(&mut session, 300);
    assert!(
        before > 0.1 && (after / before - 1.0).abs() < 1e-3,
        "{before} {after}"
    );
    // Parts have no net to change any more.
    let again = refused(session.palpate(), call("truncate", &["left", "right"], ""));
    assert!(again.contains("is a part"), "{again}");
    session.finish(pen).unwrap();
    replays(&record, 0);
    replays(&directory.path().join("cut-0002.mcap"), 300);
}

#[test]
fn bodies_that_may_not_become_parts_are_refused() {
    let session = TestSession::of(&balls(true))
        .program(PROGRAM)
        .start()
        .unwrap();
    let palpate = session.palpate();
    let soft = refused(palpate, call("truncate", &["left", "right"], ""));
    assert!(soft.contains("\"left\" deforms"), "{soft}");
    let one = refused(palpate, call("truncate", &["left"], ""));
    assert!(one.contains("at least two"), "{one}");
}
