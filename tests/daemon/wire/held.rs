//! A tool has one holder: whoever else takes it, or goes on moving it, is told so, and hears nothing.

use super::{FREE, SCENE, bare, pressing, until};
use crate::daemon::{Daemon, PROGRAM};
use palpate_client::proto::codec::encode;
use palpate_client::proto::messages::ToolPose;
use palpate_client::{ClientError, Palpate, Tool, pose_at};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use zenoh::Wait;

const PATIENCE: Duration = Duration::from_secs(60);

/// Presses until it shall end; whoever else counts from 1 too has poses with these numbers.
fn press_on(mut tool: Tool, ended: &AtomicBool) {
    for tick in 0.. {
        if ended.load(Ordering::Relaxed) {
            return;
        }
        let seq = tool.send(pose_at(pressing(tick))).unwrap();
        let answer = tool.wait_force(seq, PATIENCE).unwrap();
        assert!(answer.pose_seq >= seq);
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn is_held(error: &ClientError) -> bool {
    matches!(error, ClientError::Held { tool, .. } if tool == "ball")
        && error.to_string().contains("\"ball\"")
}

/// Moves a tool until it is refused; a single force on the way is one too many.
fn refused(tool: &mut Tool) -> ClientError {
    loop {
        match tool.send(pose_at(FREE)) {
            Ok(seq) => assert_eq!(tool.wait_force(seq, Duration::from_millis(5)), None),
            Err(error) => return error,
        }
        assert_eq!(tool.force(), None, "the force of another hand");
    }
}

/// What `palpate device` says, and its exit code.
fn device(endpoint: &str) -> (String, Option<i32>) {
    let arguments = [
        "device",
        "--tool",
        "ball",
        "--for",
        "1s",
        "--connect",
        endpoint,
    ];
    let ended = Command::new(PROGRAM).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    (said, ended.status.code())
}

/// The same whatever the clock and whether the holder's device is known.
fn a_second_client_is_refused(palpate: &Palpate, endpoint: &str, holder: Tool, named: &str) {
    // Taken while nobody moved it.
    let mut early = palpate.tool("ball").unwrap();
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| press_on(holder, &ended));
        let late = until(
            "the holder is known",
            || palpate.tool("ball").err(),
            Option::is_some,
        );
        let late = late.unwrap();
        assert!(is_held(&late) && late.to_string().contains(named), "{late}");
        // Once for each try.
        for _ in 0..2 {
            let error = refused(&mut early);
            assert!(is_held(&error), "{error}");
        }
        // A single pose is enough.
        let seq = early.send(pose_at(FREE)).unwrap();
        assert_eq!(early.wait_force(seq, PATIENCE), None);
        assert!(is_held(&early.take_refusal().unwrap_err()));
        let (said, code) = device(endpoint);
        assert_eq!(code, Some(2), "{said}");
        let words = "tool \"ball\" is held by another client";
        assert!(said.contains(words) && said.contains(named), "{said}");
        ended.store(true, Ordering::Relaxed);
    });
    // The holder has left.
    until(
        "the next one's answer",
        || {
            let seq = early.send(pose_at(FREE)).ok()?;
            early.wait_force(seq, Duration::from_millis(500))
        },
        Option::is_some,
    );
}

#[test]
fn a_second_client_of_a_tool_is_refused_by_name_and_hears_no_force_of_the_first() {
    for clock in ["realtime", "lockstep"] {
        for named in [None, Some("omega.3")] {
            let directory = tempfile::tempdir().unwrap();
            let daemon = Daemon::start(directory.path(), SCENE, &["--clock", clock]);
            let palpate = daemon.connect();
            let mut holder = palpate.tool("ball").unwrap();
            if let Some(name) = named {
                let model = palpate_client::device::DeviceModel::preset(name).unwrap();
                holder.announce(&model.info(0.0)).unwrap();
            }
            a_second_client_is_refused(&palpate, &daemon.endpoint, holder, named.unwrap_or(""));
        }
    }
}

// A client in another language, without an id and without a token.
#[test]
fn a_client_that_says_nothing_of_itself_holds_a_tool_as_well() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    let session = bare(&daemon.endpoint);
    let mut early = palpate.tool("ball").unwrap();
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut seq = 0;
            while !ended.load(Ordering::Relaxed) {
                seq += 1;
                let pose = ToolPose {
                    seq,
                    ..pose_at(pressing(seq))
                };
                let put = session.put("palpate/default/tool/ball/pose", encode(&pose));
                put.wait().unwrap();
                std::thread::sleep(Duration::from_millis(2));
            }
        });
        until(
            "the holder is known",
            || palpate.tool("ball").err(),
            Option::is_some,
        );
        let error = refused(&mut early);
        assert!(is_held(&error), "{error}");
        ended.store(true, Ordering::Relaxed);
    });
}
