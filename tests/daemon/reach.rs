//! What reaches a client, as the daemon's metrics tell it.

use crate::daemon::{Daemon, PROGRAM, device};
use crate::scenes::SOFT_DROP;
use crate::wire::{bare, until};
use palpate_client::pose_at;
use palpate_client::proto::codec::{decode, encode};
use palpate_client::proto::messages::{ToolForce, ToolPose};
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use zenoh::Wait as _;

/// Values of a metric, with their labels.
fn values(metrics: &str, name: &str) -> Vec<(String, f64)> {
    let lines = metrics.lines().filter_map(|line| line.strip_prefix(name));
    let lines = lines.filter_map(|rest| rest.strip_prefix('{')?.split_once("} "));
    lines
        .map(|(labels, value)| (labels.to_owned(), value.parse().unwrap()))
        .collect()
}

#[test]
fn metrics_say_what_each_client_received_and_how_old_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SOFT_DROP, &[]);
    let palpate = daemon.connect();
    let published = || {
        values(
            &palpate.metrics().unwrap(),
            "palpate_client_forces_published_total",
        )
    };
    let received = || {
        values(
            &palpate.metrics().unwrap(),
            "palpate_client_forces_received_total",
        )
    };
    assert!(published().is_empty() && received().is_empty());
    let mut tool = palpate.tool("ball").unwrap();
    let begun = Instant::now();
    while tool.received() < 200 {
        assert!(begun.elapsed() < Duration::from_secs(60), "no forces");
        let seq = tool.send(pose_at([0.06, 0.003, 0.045])).unwrap();
        tool.wait_force(seq, Duration::from_millis(50));
    }
    let (heard, first) = (tool.received(), received());
    let [(labels, told)] = &first[..] else {
        panic!("{first:?}")
    };
    assert!(
        labels.contains("tool=\"ball\"") && labels.contains("client=\""),
        "{labels}"
    );
    // As of its last pose, and without what had come before its first.
    assert!(*told > 100.0 && *told <= heard as f64, "{told} of {heard}");
    let sent = published()[0].1;
    assert!(sent >= 0.9 * told, "{sent} published, {told} received");
    let ages = values(
        &palpate.metrics().unwrap(),
        "palpate_client_force_age_seconds",
    );
    let ages: Vec<f64> = ages.into_iter().map(|(_, age)| age).collect();
    let [median, p99, max] = ages[..] else {
        panic!("{ages:?}")
    };
    println!("{sent} published, {told} received, age {ages:?} s");
    assert!(
        0.0 < median && median <= p99 && p99 <= max && max < 60.0,
        "{ages:?}"
    );
    // Another client is another line.
    drop(tool);
    let (report, code) = device(&daemon.endpoint, &["--motion", "press", "--for", "2s"]);
    assert_eq!(code, 0, "{report}");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let second = received();
    assert_eq!(second.len(), 1, "{second:?}");
    assert_ne!(second[0].0, first[0].0);
    let forces = report["forces"].as_f64().unwrap();
    assert!(
        second[0].1 <= forces && second[0].1 > 0.5 * forces,
        "{second:?} {report}"
    );
}

// A client that drops two of three forces says so with its poses.
#[test]
fn forces_that_did_not_reach_a_client_are_in_the_status_and_in_ls() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SOFT_DROP, &[]);
    let palpate = daemon.connect();
    let session = bare(&daemon.endpoint);
    // Forces that came, and the stamp of the newest.
    let heard = Arc::new(Mutex::new((0_u64, 0_u64)));
    let shared = heard.clone();
    let _forces = session
        .declare_subscriber("palpate/default/tool/ball/force")
        .callback(move |sample| {
            let force: ToolForce = decode(&sample.payload().to_bytes(), "").unwrap();
            let mut heard = shared.lock().unwrap();
            *heard = (heard.0 + 1, force.t_server_ns);
        })
        .wait()
        .unwrap();
    let mut seq = 0;
    let link = until(
        "a hundred lost forces",
        || {
            for _ in 0..20 {
                seq += 1;
                let pose = ToolPose {
                    seq,
                    ..pose_at([0.06, 0.003, 0.045])
                };
                let (count, newest_ns) = *heard.lock().unwrap();
                let receipt = [
                    &[7; 24][..],
                    &(count / 3).to_le_bytes(),
                    &newest_ns.to_le_bytes(),
                ];
                session
                    .put("palpate/default/tool/ball/pose", encode(&pose))
                    .attachment(receipt.concat())
                    .wait()
                    .unwrap();
                std::thread::sleep(Duration::from_millis(1));
            }
            palpate.status().unwrap().tools[0].clone()
        },
        |link| link.forces_lost >= 100,
    );
    assert!(link.forces_sent > link.forces_lost, "{link:?}");
    let listed = Command::new(PROGRAM)
        .args(["ls", "-e", &daemon.endpoint])
        .output()
        .unwrap();
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    assert!(listed.contains("FORCES LOST"), "{listed}");
}
