//! The modules of clients in other languages are what the generator makes of the table, and the C
//! header does what it says, compiled as C99 and as C++17.

#[path = "../examples/generate/files.rs"]
mod files;

use palpate_proto::layout::{Item, Shape};
use palpate_proto::messages::{ALL, TABLE};
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_files_in_the_tree_are_those_of_the_generator() {
    for (path, contents) in files::all() {
        let kept = std::fs::read(root().join(path)).unwrap();
        let lines = |contents: &[u8]| -> Vec<String> {
            let text = String::from_utf8_lossy(contents);
            text.lines().map(str::to_owned).collect()
        };
        let (old, new) = (lines(&kept), lines(&contents));
        let differs = old.iter().zip(&new).position(|(a, b)| a != b);
        assert!(
            kept == contents,
            "{path} differs from line {}: cargo run -p palpate-proto --example generate",
            differs.map_or("its end".into(), |line| (line + 1).to_string())
        );
    }
}

/// docs/wire.md has each key with its message, and for each message its fields in order.
#[test]
fn every_message_key_and_field_is_documented() {
    let document = std::fs::read_to_string(root().join("docs/wire.md")).unwrap();
    for message in ALL {
        let short = message.name.trim_start_matches("palpate.");
        let row = format!("| `palpate/{{inst}}/{}` |", message.key);
        assert!(
            document
                .lines()
                .any(|line| line.starts_with(&row) && line.contains(short)),
            "no row {row} with {short}"
        );
        let section = document.split(&format!("### `{}`", message.name)).nth(1);
        let section = section.unwrap_or_else(|| panic!("no section of {}", message.name));
        let mut rest = section.split("\n### ").next().unwrap();
        for field in message.layout.fields {
            let at = rest.find(field.name);
            let at = at.unwrap_or_else(|| panic!("{}.{} is not there", message.name, field.name));
            rest = &rest[at + field.name.len()..];
        }
    }
}

#[test]
fn the_table_lists_each_type_before_it_is_used() {
    let mut seen = Vec::new();
    let check = |shape: &Shape, seen: &[&str]| {
        let mut shape = shape;
        while let Shape::Array(inner, _) | Shape::List(inner) | Shape::Optional(inner) = shape {
            shape = inner;
        }
        let name = match shape {
            Shape::Struct(layout) => layout.name,
            Shape::Choice(choice) => choice.name,
            _ => return,
        };
        assert!(
            seen.contains(&name),
            "{name} is used before the table has it"
        );
    };
    for item in TABLE {
        let (name, fields) = match item {
            Item::Message(message) => (message.layout.name, message.layout.fields),
            Item::Struct(layout) => (layout.name, layout.fields),
            Item::Choice(choice) => (choice.name, &[][..]),
            Item::Flags(_) => continue,
        };
        for field in fields {
            check(&field.shape, &seen);
        }
        seen.push(name);
    }
}

/// Compiles `tests/c/golden.c` and runs it on the golden messages.
fn golden_in(compiler: &str, arguments: &[&str]) {
    if !Command::new(compiler)
        .arg("--version")
        .output()
        .is_ok_and(|done| done.status.success())
    {
        println!("skipped: no {compiler}");
        return;
    }
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let directory = directory.join(format!("golden-{}-{compiler}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let (program, manifest) = (
        directory.join("golden"),
        Path::new(env!("CARGO_MANIFEST_DIR")),
    );
    let checks = checks(&manifest.join("golden"));
    std::fs::write(directory.join("checks.inc"), checks.concat()).unwrap();
    std::fs::write(directory.join("watchdog.inc"), watchdog(manifest)).unwrap();
    let compiled = Command::new(compiler)
        .args(arguments)
        .args(["-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(root().join("clients/c"))
        .arg("-I")
        .arg(&directory)
        .arg("-o")
        .arg(&program)
        .arg(manifest.join("tests/c/golden.c"))
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{compiler}: {words}");
    let ran = Command::new(&program)
        .arg(manifest.join("golden"))
        .output()
        .unwrap();
    std::fs::remove_dir_all(&directory).unwrap();
    let (out, err) = (
        String::from_utf8_lossy(&ran.stdout),
        String::from_utf8_lossy(&ran.stderr),
    );
    assert!(ran.status.success(), "{compiler}: {out}{err}");
    assert_eq!(out.trim(), format!("{} messages", checks.len()));
}

/// A line of C for each golden message.
fn checks(golden: &Path) -> Vec<String> {
    let paths = std::fs::read_dir(golden)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "json"))
        .collect();
    paths.sort();
    assert!(paths.len() >= ALL.len(), "{paths:?}");
    let line = |path: &PathBuf| {
        let text = std::fs::read(path).unwrap();
        let document: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let message = ALL
            .iter()
            .find(|message| document["type"] == message.name)
            .unwrap();
        let stem = path.file_stem().unwrap().to_str().unwrap();
        format!(
            "CHECK({}, \"{stem}\");\n",
            files::snake(message.layout.name)
        )
    };
    paths.iter().map(line).collect()
}

/// The lines of `golden/watchdog.csv` as items of an array in C.
fn watchdog(manifest: &Path) -> String {
    let table = std::fs::read_to_string(manifest.join("golden/watchdog.csv")).unwrap();
    let item = |line: &str| match line.strip_suffix(',') {
        Some(line) => format!("{{{line},UINT64_MAX}},\n"),
        None => format!("{{{line}u}},\n"),
    };
    table.lines().skip(1).map(item).collect()
}

#[test]
fn the_c_header_reads_and_writes_every_golden_message_as_c99() {
    golden_in("cc", &["-std=c99"]);
}

#[test]
fn the_c_header_reads_and_writes_every_golden_message_as_cpp17() {
    golden_in("c++", &["-x", "c++", "-std=c++17"]);
}

/// The device loop of clients/c: capped forces while they come, zero when they stop.
#[test]
fn the_device_loop_in_c_compiles_as_both_and_lets_go_when_forces_stop() {
    let source = root().join("clients/c/device_loop.c");
    let both: [(&str, &[&str]); 2] = [("cc", &["-std=c99"]), ("c++", &["-x", "c++", "-std=c++17"])];
    for (compiler, arguments) in both {
        let program = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("device-loop-{}-{compiler}", std::process::id()));
        let compiled = Command::new(compiler)
            .args(arguments)
            .args(["-Wall", "-Wextra", "-Werror", "-o"])
            .arg(&program)
            .arg(&source)
            .arg("-lm")
            .output();
        let Ok(compiled) = compiled else {
            println!("skipped: no {compiler}");
            continue;
        };
        let words = String::from_utf8_lossy(&compiled.stderr);
        assert!(compiled.status.success(), "{compiler}: {words}");
        let ran = Command::new(&program).output().unwrap();
        std::fs::remove_file(&program).unwrap();
        let out = String::from_utf8_lossy(&ran.stdout);
        assert!(ran.status.success(), "{compiler}: {out}");
        println!("{compiler}: {}", out.trim());
    }
}
