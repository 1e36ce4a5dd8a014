//! Several daemons, and clients that come late or see their daemon go.

use super::{FREE, SCENE, pressing, until};
use crate::daemon::{Daemon, PROGRAM};
use palpate_client::proto::messages::EventKind;
use palpate_client::proto::rpc::Call;
use palpate_client::{Connect, Palpate, Tool, pose_at};
use std::time::Duration;

const PATIENCE: Duration = Duration::from_secs(60);

fn connect(daemon: &Daemon, instance: &str) -> Palpate {
    let settings = Connect {
        instance: instance.into(),
        timeout: PATIENCE,
        ..Connect::to(&daemon.endpoint)
    };
    Palpate::connect(&settings).unwrap()
}

fn press(tool: &mut Tool, ticks: std::ops::Range<u64>) {
    for tick in ticks {
        let seq = tool.send(pose_at(pressing(tick))).unwrap();
        tool.wait_force(seq, PATIENCE).unwrap();
    }
}

#[test]
fn two_instances_on_one_network_do_not_disturb_each_other() {
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let one = Daemon::start(
        here.path(),
        SCENE,
        &["--instance", "one", "--clock", "lockstep"],
    );
    let two = Daemon::start(
        there.path(),
        SCENE,
        &[
            "--instance",
            "two",
            "--clock",
            "lockstep",
            "--connect",
            &one.endpoint,
        ],
    );
    let (first, second) = (connect(&one, "one"), connect(&two, "two"));
    let mut pressed = first.tool("ball").unwrap();
    press(&mut pressed, 0..200);
    // Not a tick there, not a pose, and nobody's net has moved.
    let status = second.status().unwrap();
    assert_eq!(
        (status.tick, status.tools[0].received),
        (0, 0),
        "{status:?}"
    );
    let mut held = second.tool("ball").unwrap();
    for _ in 0..10 {
        let seq = held.send(pose_at(FREE)).unwrap();
        let force = held.wait_force(seq, PATIENCE).unwrap();
        assert_eq!(
            (force.force, force.depth),
            ([0.0; 3], 0.0),
            "the press is felt in the other instance"
        );
        assert_eq!(force.proxy_position, FREE);
    }
    let (a, b) = (first.scene().unwrap(), second.scene().unwrap());
    assert_eq!((a.tick, b.tick), (200, 10));
    assert!(
        a.bodies[0].points != a.bodies[0].rest_points,
        "the drop was not pressed"
    );
    let still = b.bodies[0]
        .points
        .iter()
        .zip(&b.bodies[0].rest_points)
        .all(|(p, q)| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-6));
    assert!(still, "the other drop moved");
    assert_eq!(first.status().unwrap().tools[0].received, 200);
    assert_eq!(second.status().unwrap().tools[0].received, 10);
    // A command reaches only the one it names.
    first.rpc(Call::Pause).unwrap();
    assert_eq!(
        second
            .past_events(0)
            .unwrap()
            .iter()
            .filter(|event| event.kind == EventKind::Paused)
            .count(),
        0
    );
    // Whoever knows one of them finds both.
    let look = || {
        let output = std::process::Command::new(PROGRAM)
            .args(["ls", "--json", "-e", &one.endpoint])
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    until("both are listed", look, |text| {
        text.contains("\"instance\":\"one\"") && text.contains("\"instance\":\"two\"")
    });
}

#[test]
fn a_late_joiner_gets_everything_by_one_query_and_the_next_net() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    press(&mut tool, 0..200);
    let late = connect(&daemon, "default");
    let nets = late.nets("drop").unwrap();
    let scene = late.scene().unwrap();
    let body = &scene.bodies[0];
    assert_eq!(
        (scene.tick, body.id.as_str(), scene.lockstep),
        (200, "drop", true)
    );
    let moved = |points: &[[f64; 3]]| {
        let far = |(p, q): (&[f64; 3], &[f64; 3])| {
            (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        };
        points
            .iter()
            .zip(&body.rest_points)
            .map(far)
            .fold(0.0, f64::max)
    };
    assert!(
        moved(&body.points) > 1e-3,
        "the pressed drop is shown at rest"
    );
    assert_eq!(
        body.points.len(),
        usize::from(body.count[0]) * usize::from(body.count[1])
    );
    assert_eq!(
        body.knots[0].len(),
        if body.periodic[0] {
            1
        } else {
            1 + usize::from(body.degree[0])
        } + usize::from(body.count[0])
    );
    assert_eq!(
        scene.tools[0].position,
        tool.force().unwrap().proxy_position
    );
    // The session goes on: the next net fits what was told.
    let next = until(
        "the next net",
        || {
            let seq = tool.send(pose_at(pressing(150))).unwrap();
            tool.wait_force(seq, PATIENCE).unwrap();
            nets.get()
        },
        |net| net.as_ref().is_some_and(|net| net.revision > body.revision),
    )
    .unwrap();
    assert_eq!(
        ([next.count_u, next.count_v], next.body.as_str()),
        (body.count, "drop")
    );
    assert!(moved(&next.points) > 1e-3);
    // What happened before is known too.
    let events = late.past_events(0).unwrap();
    assert!(
        events
            .iter()
            .any(|event| matches!(&event.kind, EventKind::ToolJoined { tool } if tool == "ball")),
        "{events:?}"
    );
    assert!(
        events.windows(2).all(|pair| pair[1].seq == pair[0].seq + 1),
        "{events:?}"
    );
}

#[test]
fn a_daemon_that_comes_back_finds_its_client_again() {
    let directory = tempfile::tempdir().unwrap();
    let first = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let port: u16 = first.endpoint.rsplit(':').next().unwrap().parse().unwrap();
    let palpate = first.connect();
    let mut tool = palpate.tool("ball").unwrap();
    press(&mut tool, 0..50);
    assert_eq!(tool.force().unwrap().tick, 50);
    drop(first);
    let again = Daemon::start_at(port, directory.path(), SCENE, &["--clock", "lockstep"]);
    // The same client, its numbers going on; ticks count from 1 again, and their forces are taken.
    let force = until(
        "a force of the new daemon",
        || {
            let seq = tool.send(pose_at(pressing(0))).unwrap();
            tool.wait_force(seq, Duration::from_secs(1))
        },
        Option::is_some,
    )
    .unwrap();
    assert!(force.tick < 50, "{force:?}");
    let late = connect(&again, "default");
    assert!(late.status().unwrap().tools[0].received >= 1);
}
