//! Layers import one way, and below the tick nothing knows clocks, threads, files or sockets.

use std::path::{Path, PathBuf};

/// What each layer may import of ours.
const TABLE: [(&str, &[&str]); 17] = [
    ("math", &[]),
    ("basis", &["math"]),
    ("surface", &["math", "basis"]),
    ("exchange", &["math", "basis", "surface"]),
    ("contact", &["math", "basis", "surface"]),
    ("modeling", &["math", "basis", "surface", "contact"]),
    ("body", &["math", "basis", "surface", "contact"]),
    ("haptics", &["math", "basis", "surface", "contact"]),
    (
        "scene",
        &[
            "math", "basis", "surface", "exchange", "contact", "body", "haptics",
        ],
    ),
    (
        "tick",
        &[
            "math", "basis", "surface", "contact", "body", "haptics", "scene",
        ],
    ),
    (
        "wire",
        &[
            "math", "basis", "surface", "contact", "body", "haptics", "scene", "tick",
        ],
    ),
    (
        "transport",
        &[
            "math", "basis", "surface", "contact", "body", "haptics", "scene", "tick", "wire",
        ],
    ),
    (
        "recording",
        &[
            "math", "basis", "surface", "contact", "body", "haptics", "scene", "tick", "wire",
        ],
    ),
    (
        "editing",
        &[
            "math",
            "basis",
            "surface",
            "contact",
            "modeling",
            "scene",
            "tick",
            "recording",
        ],
    ),
    ("viewer", &["math", "wire", "transport"]),
    (
        "bench",
        &[
            "math",
            "basis",
            "surface",
            "contact",
            "modeling",
            "body",
            "haptics",
            "scene",
            "tick",
            "wire",
            "recording",
        ],
    ),
    (
        "cli",
        &[
            "math",
            "basis",
            "surface",
            "exchange",
            "contact",
            "modeling",
            "body",
            "haptics",
            "scene",
            "tick",
            "wire",
            "transport",
            "recording",
            "editing",
            "viewer",
            "bench",
        ],
    ),
];

/// Layers that are pure arithmetic. `scene` reads its files at build; `tick` has the loop's
/// threads.
const PURE: [&str; 7] = [
    "math", "basis", "surface", "contact", "modeling", "body", "haptics",
];
const IMPURE: [&str; 6] = [
    "std::time",
    "std::thread",
    "std::fs",
    "std::net",
    "std::process",
    "HashMap",
];

/// Lines of a file up to its tests that break the table.
fn violations(layer: &str, allowed: &[&str], text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or("");
    let mut found = Vec::new();
    for (k, line) in code.lines().enumerate() {
        let line = line.split("//").next().unwrap_or("");
        for (at, _) in line.match_indices("crate::") {
            let name: String = line[at + 7..]
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            let ours = TABLE.iter().any(|(layer, _)| *layer == name);
            if ours && name != layer && !allowed.contains(&name.as_str()) {
                found.push(format!("line {}: {layer} imports {name}", k + 1));
            }
        }
        if PURE.contains(&layer) {
            for word in IMPURE.iter().filter(|word| line.contains(*word)) {
                found.push(format!("line {}: {layer} uses {word}", k + 1));
            }
        }
    }
    found
}

fn files(directory: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

#[test]
fn layers_import_one_way() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut broken = Vec::new();
    let mut read = 0;
    for (layer, allowed) in TABLE {
        let mut paths = Vec::new();
        files(&source.join(layer), &mut paths);
        for path in paths {
            read += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            broken.extend(
                violations(layer, allowed, &text)
                    .iter()
                    .map(|what| format!("{}: {what}", path.display())),
            );
        }
    }
    assert!(read > 40, "only {read} files were read");
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn the_checker_sees_planted_violations() {
    assert_eq!(
        violations("basis", &["math"], "use crate::surface::Surface;\n").len(),
        1
    );
    assert_eq!(
        violations("body", &["math"], "let now = std::time::Instant::now();\n").len(),
        1
    );
    assert_eq!(
        violations(
            "basis",
            &["math"],
            "use crate::math::Point3; // crate::surface\n"
        )
        .len(),
        0
    );
}
