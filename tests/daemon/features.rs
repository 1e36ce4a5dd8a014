//! The README's two commands share one build of every dependency.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Features of each package, `{""}` where it has none, as a build of `arguments` would choose them.
fn features(arguments: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--prefix", "none"])
        .args(["--format", "{p}|{f}"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mut packages: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in String::from_utf8(output.stdout).unwrap().lines() {
        if let Some((package, features)) = line.split_once('|') {
            let features = features.trim_end_matches("(*)").trim().to_owned();
            packages.entry(package.into()).or_default().insert(features);
        }
    }
    packages
}

// A package with other features is compiled again, and with it all that uses it: minutes.
#[test]
fn cargo_run_and_cargo_test_build_dependencies_with_the_same_features() {
    let run = features(&["-p", "palpate", "-e", "normal,build"]);
    let test = features(&["--workspace", "-e", "normal,build,dev"]);
    assert!(run.len() > 300, "only {} packages", run.len());
    for (package, features) in &run {
        assert!(
            features.is_subset(&test[package]),
            "{package}: cargo run {features:?}, cargo test {:?}; see Cargo.toml",
            test[package]
        );
    }
}

// Who only reads recordings need not build a bus and a server of pages.
#[test]
fn the_python_module_builds_without_the_daemon() {
    let small = features(&[
        "-p",
        "palpate-python",
        "--no-default-features",
        "-e",
        "normal,build",
    ]);
    let names: BTreeSet<&str> = (small.keys())
        .filter_map(|package| package.split_once(' '))
        .map(|(name, _)| name)
        .collect();
    assert!(names.contains("palpate-record") && names.contains("pyo3"));
    for absent in ["palpate", "palpate-client", "axum", "tokio", "zenoh"] {
        assert!(!names.contains(absent), "{absent}");
    }
}
