//! Poses that are bad in some way: each counted under its cause, none of them moves the tool.

use super::{FREE, SCENE, bare, pressing, until};
use crate::daemon::Daemon;
use palpate_client::proto::codec::{encode, encoding_schema};
use palpate_client::proto::messages::{ToolLink, ToolPose, force_flags};
use palpate_client::{Palpate, pose_at};
use std::time::Duration;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::CongestionControl;

fn link(palpate: &Palpate) -> ToolLink {
    palpate.status().unwrap().tools[0].clone()
}

fn publisher<'s>(session: &'s zenoh::Session, schema: &str) -> Publisher<'s> {
    let publisher = session
        .declare_publisher("palpate/default/tool/ball/pose")
        .encoding(Encoding::APPLICATION_OCTET_STREAM.with_schema(schema.to_owned()))
        .congestion_control(CongestionControl::Block)
        .wait()
        .unwrap();
    until(
        "nobody listens",
        || publisher.matching_status().wait().unwrap().matching(),
        |matching| *matching,
    );
    publisher
}

/// Elsewhere: a pose that would be seen to have moved the tool.
fn elsewhere(seq: u64) -> ToolPose {
    ToolPose {
        seq,
        ..pose_at([0.06, 0.003, 0.047])
    }
}

#[test]
fn every_cause_is_counted_apart_and_none_moves_the_tool() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    let session = bare(&daemon.endpoint);
    let ours = publisher(&session, &encoding_schema::<ToolPose>());
    let none = publisher(&session, "");
    let other = publisher(&session, "postcard;palpate.ToolPose.v2");
    let foreign = publisher(&session, "postcard;palpate.ToolForce.v1");

    // A quaternion within 1e-6 of unit length is a good one.
    let nearly = ToolPose {
        seq: 100,
        orientation: [0.0, 0.0, 6e-7, 1.0 + 5e-7],
        ..pose_at(FREE)
    };
    ours.put(encode(&nearly)).wait().unwrap();
    until(
        "the first pose",
        || link(&palpate),
        |link| link.received == 1,
    );
    let stands = |what: &str| {
        let tool = palpate.scene().unwrap().tools[0].clone();
        assert_eq!(
            tool.position.map(f64::to_bits),
            FREE.map(f64::to_bits),
            "{what} moved the tool"
        );
        let norm = tool.orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(
            (norm - 1.0).abs() < 1e-15,
            "the quaternion was not brought to unit length: {norm}"
        );
    };
    until(
        "the first tick with it",
        || palpate.scene().unwrap().tools[0].position,
        |position| *position == FREE,
    );
    stands("the first pose");

    let good = encode(&elsewhere(200));
    let put = |publisher: &Publisher<'_>, bytes: &[u8]| publisher.put(bytes).wait().unwrap();
    let mut expected = link(&palpate);
    let mut check = |what: &str, count: u64, field: fn(&mut ToolLink) -> &mut u64| {
        *field(&mut expected) += count;
        let refused = |link: &ToolLink| (link.received, link.refused());
        let seen = until(
            what,
            || link(&palpate),
            |link| refused(link) == refused(&expected),
        );
        assert_eq!(refused(&seen), refused(&expected), "{what}");
        stands(what);
    };

    put(&other, &good);
    put(&foreign, &good);
    check("another version", 2, |link| &mut link.wrong_version);
    for cut in [0, 1, 50, good.len() - 1] {
        put(&ours, &good[..cut]);
    }
    put(&ours, &[&good[..], &[0]].concat());
    put(&none, &[0xff; 120]);
    check("truncated, trailing and foreign bytes", 6, |link| {
        &mut link.malformed
    });
    put(&ours, &[&good[..], &[0; 26]].concat());
    put(&none, &vec![0; 1 << 20]);
    check("too many bytes", 2, |link| &mut link.oversized);
    for (k, bad) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
        .into_iter()
        .cycle()
        .take(13)
        .enumerate()
    {
        let mut pose = elsewhere(200);
        let fields = [
            &mut pose.position[..],
            &mut pose.orientation,
            &mut pose.linear_velocity,
            &mut pose.angular_velocity,
        ];
        *fields.into_iter().flatten().nth(k).unwrap() = bad;
        put(&ours, &encode(&pose));
    }
    check("values that are not finite", 13, |link| {
        &mut link.not_finite
    });
    for orientation in [
        [0.0; 4],
        [0.0, 0.0, 0.0, 1.0 + 2e-6],
        [1.0; 4],
        [0.0, 0.0, 0.0, 1e300],
    ] {
        put(
            &ours,
            &encode(&ToolPose {
                orientation,
                ..elsewhere(200)
            }),
        );
    }
    check("no rotations", 4, |link| &mut link.bad_quaternion);
    put(&ours, &encode(&elsewhere(100)));
    put(&none, &encode(&elsewhere(100)));
    check("duplicates", 2, |link| &mut link.duplicated);
    for seq in [0, 1, 99] {
        put(&ours, &encode(&elsewhere(seq)));
    }
    check("old numbers", 3, |link| &mut link.out_of_order);

    // The same in the counters for machines.
    let metrics = palpate.metrics().unwrap();
    for (cause, count) in link(&palpate).refused() {
        let line = format!(
            "palpate_tool_poses_refused_total{{tool=\"ball\",cause=\"{cause}\"}} {count}\n"
        );
        assert!(metrics.contains(&line), "{line} is missing in\n{metrics}");
    }
    // And a good one still gets through.
    put(&none, &good);
    check_moved(&palpate);
}

fn check_moved(palpate: &Palpate) {
    let position = || palpate.scene().unwrap().tools[0].position;
    until("the good pose", position, |position| {
        *position == elsewhere(0).position
    });
}

#[test]
fn a_jump_is_counted_and_does_not_move_the_tool() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let patience = Duration::from_secs(30);
    // Held long enough for the proxy to have come after.
    for tick in 0..400 {
        let seq = tool.send(pose_at(pressing(tick.min(20)))).unwrap();
        tool.wait_force(seq, patience).unwrap();
    }
    let before = tool.force().unwrap();
    for far in [[3.0, 0.0, 0.0], [1e300, 0.0, 0.0]] {
        let seq = tool.send(pose_at(far)).unwrap();
        // Until the force has faded the tool stays where it was; `pose_seq` is that of the pose in
        // effect.
        let force = until(
            "the refusal",
            || tool.force().unwrap(),
            |force| force.tick >= seq,
        );
        assert!(force.flags & force_flags::REFUSED != 0, "{force:?}");
        let moved: f64 = (0..3)
            .map(|k| (force.proxy_position[k] - before.proxy_position[k]).abs())
            .sum();
        assert!(moved < 1e-6, "a jump moved the tool by {moved} m");
        assert!(force.force.iter().all(|x| x.is_finite()));
    }
    assert_eq!(link(&palpate).jumps, 2);
}
