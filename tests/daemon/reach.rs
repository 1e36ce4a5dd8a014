//! What reaches a client, as the daemon's metrics tell it.

use crate::daemon::{Daemon, SOFT_DROP, device};
use palpate_client::pose_at;
use std::time::{Duration, Instant};

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
