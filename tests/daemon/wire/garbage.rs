//! Random bytes on every key that a daemon listens to, and a flood of them beside a client that
//! works.

use super::{SCENE, any_bytes, bare, pressing, until};
use crate::daemon::Daemon;
use palpate_client::pose_at;
use palpate_client::proto::messages::LoopState;
use palpate_client::proto::rpc::{Answer, METHODS};
use palpate_geometry::math::Random;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use zenoh::Wait;
use zenoh::qos::CongestionControl;

#[test]
fn random_bytes_on_every_key_are_refused_and_the_loop_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    let session = bare(&daemon.endpoint);
    let mut random = Random(7);
    let before = palpate.status().unwrap();
    let answer = |key: String, payload: Vec<u8>| -> Option<Answer> {
        let replies = session
            .get(&key)
            .payload(payload)
            .timeout(Duration::from_secs(20))
            .wait()
            .unwrap();
        let reply = replies.recv().ok()?;
        let bytes = match reply.result() {
            Ok(sample) => sample.payload().to_bytes().into_owned(),
            Err(error) => error.payload().to_bytes().into_owned(),
        };
        Some(serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{key}: {e}: {bytes:?}")))
    };
    until(
        "the methods are declared",
        || answer("palpate/default/rpc/step".into(), b"{".to_vec()),
        Option::is_some,
    );
    for method in METHODS {
        for k in 0..8 {
            // What begins like this is no JSON; what is longer than 16 KiB is not even read.
            let most = if k == 7 { 200_000 } else { 400 };
            let payload = [&[0xfe], &any_bytes(&mut random, most)[..]].concat();
            let too_long = payload.len() > 16 << 10;
            let reply =
                answer(format!("palpate/default/rpc/{method}"), payload).expect("an answer");
            let error = reply.into_result().unwrap_err();
            assert!(error.contains(method), "{method}: {error}");
            assert!(
                error.contains(if too_long {
                    "at most 16384"
                } else {
                    "do not parse"
                }),
                "{method}: {error}"
            );
        }
        // Arguments of other methods, and nonsense that is JSON.
        for payload in [
            "[]",
            "17",
            "\"x\"",
            "{\"speed\": 1}",
            "{\"ticks\": -1}",
            "{\"ticks\": 1, \"rate\": 2, \"tick\": 3}",
        ] {
            let reply =
                answer(format!("palpate/default/rpc/{method}"), payload.into()).expect("an answer");
            assert!(reply.into_result().is_err(), "{method} took {payload}");
        }
    }
    let selectors = [
        "event?after=x",
        "event?after=-1",
        "@meta/schema/nothing",
        "@meta/schema/x?format=proto",
        "@meta/schema/*?format=xml",
    ];
    for selector in selectors {
        let reply = answer(format!("palpate/default/{selector}"), Vec::new()).expect("an answer");
        assert!(
            reply.into_result().is_err_and(|error| error.len() > 10),
            "{selector}"
        );
    }
    let mut sent = 0;
    for key in ["pose", "device"] {
        for _ in 0..500 {
            let bytes = any_bytes(&mut random, 300);
            session
                .put(format!("palpate/default/tool/ball/{key}"), bytes)
                .congestion_control(CongestionControl::Block)
                .wait()
                .unwrap();
        }
        sent += 500;
    }
    let refused = || {
        let poses: u64 = palpate.status().unwrap().tools[0]
            .refused()
            .iter()
            .map(|(_, count)| count)
            .sum();
        let info: serde_json::Value = serde_json::from_str(&palpate.info().unwrap()).unwrap();
        poses + info["devices"]["ball"]["refused"].as_u64().unwrap()
    };
    until("all are counted", refused, |refused| *refused == sent);
    let after = until(
        "the loop goes on",
        || palpate.status().unwrap(),
        |status| status.tick > before.tick + 100,
    );
    assert_eq!(
        (after.state, after.tools[0].received),
        (LoopState::Running, 0)
    );
    assert!(palpate.scene().is_ok());
}

#[test]
fn a_flood_of_garbage_does_not_change_a_bit_of_a_client_in_lockstep() {
    let forces = |flood: bool| -> Vec<[u64; 3]> {
        let directory = tempfile::tempdir().unwrap();
        let daemon = Daemon::start(directory.path(), SCENE, &["--clock", "lockstep"]);
        let palpate = daemon.connect();
        let mut tool = palpate.tool("ball").unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let flooder = flood.then(|| {
            let (stop, session) = (stop.clone(), bare(&daemon.endpoint));
            std::thread::spawn(move || {
                let mut random = Random(3);
                let mut sent = 0u64;
                while !stop.load(Ordering::Relaxed) {
                    let key = [
                        "tool/ball/pose",
                        "tool/ball/device",
                        "status",
                        "contact",
                        "tool/ball/force/x",
                    ];
                    let key = format!("palpate/default/{}", key[random.below(key.len())]);
                    let _ = session.put(key, any_bytes(&mut random, 200)).wait();
                    sent += 1;
                }
                sent
            })
        });
        if flood {
            let refused = || {
                palpate.status().unwrap().tools[0]
                    .refused()
                    .iter()
                    .map(|(_, count)| count)
                    .sum::<u64>()
            };
            until("the flood has begun", refused, |refused| *refused > 100);
        }
        let forces = (0..250)
            .map(|tick| {
                let seq = tool.send(pose_at(pressing(tick))).unwrap();
                let force = tool
                    .wait_force(seq, Duration::from_secs(60))
                    .expect("no force");
                force.force.map(f64::to_bits)
            })
            .collect();
        stop.store(true, Ordering::Relaxed);
        if let Some(flooder) = flooder {
            let sent = flooder.join().unwrap();
            assert!(sent > 1_000, "only {sent} messages are no flood");
        }
        forces
    };
    let (quiet, flooded) = (forces(false), forces(true));
    assert!(
        quiet
            .iter()
            .any(|force| f64::from_bits(force[0]).abs() > 0.01),
        "the drop was never pressed"
    );
    assert_eq!(quiet, flooded);
}
