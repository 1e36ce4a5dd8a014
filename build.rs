//! Tells the program what it is built from, and links the C and C++ libraries that `palpate bench
//! surface` can run beside ours, if their features are on.

use std::path::{Path, PathBuf};

fn main() {
    identity();
    println!("cargo::rerun-if-changed=src/bench/peers/occt.cpp");
    if std::env::var_os("CARGO_FEATURE_BENCH_SISL").is_some() {
        println!("cargo::rustc-link-lib=static=sisl");
        println!("cargo::rustc-link-search=native=/usr/lib");
    }
    #[cfg(feature = "bench-occt")]
    {
        cc::Build::new()
            .cpp(true)
            .std("c++17")
            .include("/usr/include/opencascade")
            .flag_if_supported("-Wno-deprecated-declarations")
            .file("src/bench/peers/occt.cpp")
            .compile("palpate_occt");
        for library in [
            "TKShHealing",
            "TKTopAlgo",
            "TKBRep",
            "TKGeomAlgo",
            "TKGeomBase",
            "TKG3d",
            "TKG2d",
            "TKMath",
            "TKernel",
        ] {
            println!("cargo::rustc-link-lib={library}");
        }
    }
}

/// A recording says which sources, target and compiler made it.
fn identity() {
    let mut files = vec![PathBuf::from("Cargo.toml"), PathBuf::from("Cargo.lock")];
    collect(Path::new("src"), &mut files);
    files.sort();
    // FNV-1a, 64 bits: names a state of the sources, guards nothing.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for file in &files {
        let text = std::fs::read(file).unwrap_or_default();
        for byte in file.to_string_lossy().bytes().chain(text) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        println!("cargo::rerun-if-changed={}", file.display());
    }
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rustc-env=PALPATE_SOURCE={hash:016x}");
    println!(
        "cargo::rustc-env=PALPATE_TARGET={}",
        std::env::var("TARGET").unwrap_or_default()
    );
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = std::process::Command::new(rustc)
        .arg("--version")
        .output()
        .ok();
    let version = version
        .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
        .unwrap_or_default();
    println!("cargo::rustc-env=PALPATE_RUSTC={version}");
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, files)
        } else {
            files.push(path)
        }
    }
}
