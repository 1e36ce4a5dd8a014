//! Keys that are patterns: whoever reads the whole bus gives no command and moves no tool.

use super::{FREE, SCENE, bare, until};
use crate::daemon::Daemon;
use palpate_client::pose_at;
use palpate_client::proto::codec::encode;
use palpate_client::proto::messages::{LoopState, ToolForce, ToolPose};
use palpate_client::proto::rpc::METHODS;
use std::time::Duration;
use zenoh::Wait;
use zenoh::query::{ConsolidationMode, QueryTarget};

/// Answers and errors.
fn ask(session: &zenoh::Session, key: &str, target: QueryTarget, payload: &str) -> [usize; 2] {
    let mut get = session
        .get(key)
        .target(target)
        .consolidation(ConsolidationMode::None)
        .timeout(Duration::from_secs(10));
    if !payload.is_empty() {
        get = get.payload(payload);
    }
    let replies = get.wait().unwrap();
    let (mut answers, mut errors) = (0, 0);
    while let Ok(reply) = replies.recv() {
        match reply.result() {
            Ok(_) => answers += 1,
            Err(_) => errors += 1,
        }
    }
    [answers, errors]
}

#[test]
fn a_query_that_names_no_method_runs_none() {
    let directory = tempfile::tempdir().unwrap();
    let recordings = directory.path().join("recordings");
    let folder = recordings.to_str().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &["--record-dir", folder]);
    let palpate = daemon.connect();
    until(
        "running",
        || palpate.status().unwrap().tick,
        |tick| *tick > 10,
    );
    let session = bare(&daemon.endpoint);
    // A session that has just opened may not know of the daemon's methods yet.
    let querier = session.declare_querier("palpate/default/rpc/shutdown");
    let querier = querier.wait().unwrap();
    until(
        "a method",
        || querier.matching_status().wait().unwrap().matching(),
        |known| *known,
    );
    // Questions may be asked like that, and are answered.
    let patterns = [
        ("**", true),
        ("palpate/**", true),
        ("*/**", true),
        ("**/shutdown", false),
        ("palpate/default/rpc/*", false),
        ("palpate/default/rpc/**", false),
        ("palpate/*/rpc/shutdown", false),
        ("palpate/default/*/pause", false),
        ("palpate/default/rpc/shut$*", false),
        ("palpate/default/rpc/$*set", false),
        ("palpate/**/reset", false),
    ];
    for (pattern, answered) in patterns {
        for target in [QueryTarget::BestMatching, QueryTarget::All] {
            for payload in ["", "{}"] {
                let [answers, errors] = ask(&session, pattern, target, payload);
                assert_eq!(errors, 0, "{pattern}");
                assert_eq!(answers > 0, answered, "{pattern}");
            }
        }
    }
    // Its own key, but nothing that says that it is meant.
    for method in METHODS {
        let key = format!("palpate/default/rpc/{method}");
        let [answers, _] = ask(&session, &key, QueryTarget::All, "");
        assert_eq!(answers, 1, "{method}: refused in words");
    }
    let status = palpate.status().unwrap();
    assert_eq!(status.state, LoopState::Running);
    assert_eq!(palpate.past_events(0).unwrap(), [], "nothing happened");
    assert!(
        !recordings.exists() || recordings.read_dir().unwrap().next().is_none(),
        "nothing was recorded"
    );
    // By its name, it is obeyed.
    let key = "palpate/default/rpc/pause";
    assert_eq!(ask(&session, key, QueryTarget::BestMatching, "{}"), [1, 0]);
    assert_eq!(palpate.status().unwrap().state, LoopState::Paused);
}

#[test]
fn what_is_published_under_a_pattern_moves_no_tool_and_is_no_force() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    let mut tool = palpate.tool("ball").unwrap();
    let session = bare(&daemon.endpoint);
    let pose = |seq| {
        encode(&ToolPose {
            seq,
            ..pose_at([0.03, 0.0, 0.045])
        })
    };
    let publisher = session.declare_publisher("palpate/default/tool/ball/pose");
    let publisher = publisher.wait().unwrap();
    until(
        "a subscriber",
        || publisher.matching_status().wait().unwrap().matching(),
        |known| *known,
    );
    let patterns = [
        "**",
        "palpate/**",
        "palpate/default/tool/*/pose",
        "palpate/*/tool/ball/pose",
        "palpate/default/tool/ball/*",
        "palpate/default/tool/ba$*/pose",
    ];
    for (k, pattern) in patterns.into_iter().enumerate() {
        session.put(pattern, pose(k as u64 + 1)).wait().unwrap();
    }
    // In order on one link: what came before this has come.
    publisher.put(pose(100)).wait().unwrap();
    let link = until(
        "the pose of its own key",
        || palpate.status().unwrap().tools[0].clone(),
        |link| link.received > 0,
    );
    assert_eq!(
        (link.received, link.out_of_order, link.malformed),
        (1, 0, 0),
        "patterns are not heard"
    );
    // The other way: forces.
    std::thread::sleep(Duration::from_millis(300));
    let mut seen = 0;
    for _ in 0..300 {
        tool.send(pose_at(FREE)).unwrap();
        if let Some(heard) = tool.force() {
            let force = ToolForce {
                force: [7.0, 0.0, 0.0],
                tick: u64::MAX,
                ..heard
            };
            for pattern in ["palpate/**", "palpate/default/tool/*/force"] {
                session.put(pattern, encode(&force)).wait().unwrap();
            }
        }
        std::thread::sleep(Duration::from_millis(1));
        let felt = tool.force().is_some_and(|force| force.force[0] > 1.0);
        seen += u32::from(felt);
    }
    assert_eq!(seen, 0, "forces under a pattern were felt");
    assert!(tool.received() > 50);
}
