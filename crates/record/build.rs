//! What programs are built from: recordings name the sources that decide their bits, the target and the compiler.

use std::path::{Path, PathBuf};

/// What a tick runs through: a change anywhere else cannot change its bits.
const DECIDING: [&str; 4] = [
    "crates/geometry/src",
    "crates/sim/src",
    "crates/thesis/src",
    "proto/src",
];

/// And what a run of a batch goes through beside it: simulated devices, motions, figures of a run.
const DECIDING_RUNS: [&str; 3] = [
    "clients/rust/src/device",
    "crates/experiment/src/batch",
    "crates/wire/src",
];

/// From here to the workspace.
const ROOT: &str = "../..";

fn main() {
    println!(
        "cargo::rustc-env=PALPATE_SOURCE={:016x}",
        source_hash(&DECIDING)
    );
    println!(
        "cargo::rustc-env=PALPATE_RUN_SOURCE={:016x}",
        source_hash(&[&DECIDING[..], &DECIDING_RUNS].concat())
    );
    println!(
        "cargo::rustc-env=PALPATE_TARGET={}",
        std::env::var("TARGET").unwrap_or_default()
    );
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = std::process::Command::new(rustc)
        .arg("--version")
        .output()
        .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
        .unwrap_or_default();
    println!("cargo::rustc-env=PALPATE_RUSTC={version}");
}

/// FNV-1a (64 bits) over the version, the locked dependencies and the deciding sources without
/// their comments and tests. It names a state of the sources and guards nothing. A packaged crate
/// has no sources of the others beside it; there the version says what they are.
fn source_hash(deciding: &[&str]) -> u64 {
    let root = Path::new(ROOT);
    let mut files = vec![root.join("Cargo.lock")];
    for directory in deciding {
        println!("cargo::rerun-if-changed={ROOT}/{directory}");
        collect(&root.join(directory), &mut files);
    }
    println!("cargo::rerun-if-changed={ROOT}/Cargo.lock");
    files.sort();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |text: &str| {
        for byte in text.bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    add(&std::env::var("CARGO_PKG_VERSION").unwrap_or_default());
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        add(&file.to_string_lossy());
        for line in text.lines().map(str::trim) {
            if !line.is_empty() && !line.starts_with("//") {
                add(line);
            }
        }
    }
    hash
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if path.is_dir() {
            if name != "tests" {
                collect(&path, files);
            }
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            files.push(path);
        }
    }
}
