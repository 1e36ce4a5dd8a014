//! Suites that start daemons find them.

use std::process::Command;

#[test]
fn the_latency_of_a_daemon_is_measured() {
    let bench = env!("CARGO_BIN_EXE_palpate-bench");
    let arguments = [
        "haptics",
        "--quick",
        "--json",
        "--only",
        "latency/pose-force/followed",
    ];
    let output = Command::new(bench).args(arguments).output().unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    let rows = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<serde_json::Value> = rows
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let methods: Vec<_> = rows.iter().map(|row| row["method"].clone()).collect();
    assert_eq!(methods, ["median", "p99"]);
}
