//! Reference pages are what the program prints, and scenes are what the schema says.
//!
//! `BLESS=1` writes the pages.

use crate::daemon::PROGRAM;
use crate::documents::{Block, blocks, root};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

const MARK: &str = "<!-- generated -->\n";

fn printed(arguments: &[&str]) -> String {
    let done = Command::new(PROGRAM).args(arguments).output().unwrap();
    assert!(done.status.success(), "{arguments:?}");
    String::from_utf8(done.stdout).unwrap()
}

/// Holds the end of a page to what a command prints.
fn hold(page: &str, arguments: &[&str]) {
    let path = root().join(page);
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, body) = text.split_once(MARK).expect("a page with a generated part");
    let now = format!("\n{}", printed(arguments));
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, format!("{head}{MARK}{now}")).unwrap();
        return;
    }
    let differs = now
        .lines()
        .zip(body.lines())
        .find(|(now, then)| now != then);
    assert!(
        now == body,
        "{page} is not what `palpate {}` prints: {differs:?}; BLESS=1 writes it",
        arguments.join(" ")
    );
}

#[test]
fn the_scene_reference_is_that_of_this_program() {
    hold("docs/scene.md", &["schema", "--markdown"]);
}

#[test]
fn the_command_reference_is_that_of_this_program() {
    hold("docs/commands.md", &["man", "--markdown"]);
}

#[test]
fn the_channels_of_the_guide_are_those_of_this_program() {
    let path = root().join("docs/recording.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let begin = text.find("| `/sim/tick`").unwrap();
    let end = text.find("| `/view/scene`").unwrap();
    let now = palpate_record::channel_table();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, format!("{}{now}{}", &text[..begin], &text[end..])).unwrap();
        return;
    }
    assert_eq!(&text[begin..end], now, "BLESS=1 writes it");
}

/// Every key of every table, by the schema's own words.
fn keys(schema: &Value, found: &mut Vec<String>) {
    match schema {
        Value::Object(map) => {
            if let Some(properties) = map.get("properties").and_then(Value::as_object) {
                found.extend(properties.keys().cloned());
            }
            map.values().for_each(|value| keys(value, found));
        }
        Value::Array(list) => list.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_of_a_scene_is_in_its_reference() {
    let schema: Value = serde_json::from_str(&printed(&["schema"])).unwrap();
    let mut found = Vec::new();
    keys(&schema, &mut found);
    assert!(found.len() > 120, "{}", found.len());
    let page = std::fs::read_to_string(root().join("docs/scene.md")).unwrap();
    for key in &found {
        let row = page.contains(&format!("| `{key}` |"));
        // Forms without a name stand in one row.
        let form = page.contains(&format!("{{ {key} = ")) || page.contains(&format!(", {key} = "));
        assert!(row || form, "{key} is not in docs/scene.md");
    }
}

/// A Python that has `jsonschema` and reads TOML.
fn python() -> Option<String> {
    let name = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&name)
        .args(["-c", "import jsonschema, tomllib"])
        .output()
        .is_ok_and(|done| done.status.success());
    if !has {
        println!("skipped: {name} lacks jsonschema (pip install jsonschema) or is older than 3.11");
    }
    has.then_some(name)
}

/// Validates TOML files; prints what is wrong with each, a line a file.
const VALIDATE: &str = r#"
import json, sys, tomllib
from jsonschema import Draft7Validator
schema = json.load(open(sys.argv[1]))
Draft7Validator.check_schema(schema)
validator = Draft7Validator(schema)
for name in sys.argv[2:]:
    errors = [f"{e.json_path}: {e.message[:120]}" for e in validator.iter_errors(tomllib.load(open(name, "rb")))]
    print(name, "|", "; ".join(errors))
"#;

fn errors(python: &str, directory: &Path, files: &[PathBuf]) -> Vec<String> {
    let schema = directory.join("scene.schema.json");
    std::fs::write(&schema, printed(&["schema"])).unwrap();
    let done = Command::new(python)
        .args(["-c", VALIDATE])
        .arg(&schema)
        .args(files)
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{err}");
    let out = String::from_utf8(done.stdout).unwrap();
    out.lines().map(str::to_owned).collect()
}

fn scenes(directory: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "motions" {
            scenes(&path, into);
        } else if path.extension().is_some_and(|e| e == "toml") {
            // Folders of scenarios hold other files too.
            let text = std::fs::read_to_string(&path).unwrap();
            if text.contains("[[body]]") {
                into.push(path);
            }
        }
    }
}

// The validator is another's, and so are its notions of TOML and of the schema.
#[test]
fn scenes_of_the_repository_and_of_documents_fit_the_schema() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for folder in ["scenes", "recordings/golden"] {
        scenes(&root().join(folder), &mut files);
    }
    let of_documents = blocks();
    let of_documents = of_documents
        .iter()
        .filter(|block: &&Block| block.language == "toml" && block.kind == "scene");
    for (k, block) in of_documents.enumerate() {
        let path = directory.path().join(format!("block-{k}.toml"));
        std::fs::write(&path, &block.code).unwrap();
        files.push(path);
    }
    assert!(files.len() > 6, "{files:?}");
    for line in errors(&python, directory.path(), &files) {
        assert!(line.ends_with("| "), "{line}");
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let body = "[[body]]\nid = \"drop\"\nsurface = { builtin = \"sheet\" }\n";
    let wrong = [
        "[loop]\nrate_hz = 0\n[[body]]\nid = \"drop\"\nsurface = {}\n".to_owned(),
        format!("{body}colour = \"red\"\n"),
        format!("{body}model = \"jelly\"\n"),
        format!("{body}material = {{ young_pa = -1.0 }}\n"),
        format!("{body}material = {{ preset = \"cheese\" }}\n"),
        format!("{body}[[tool]]\nid = \"A B\"\n"),
        format!(
            "{body}[[tool]]\nid = \"a\"\nshape = {{ sphere = {{ radius_m = 1.0 }}, point = {{}} }}\n"
        ),
        "[[tool]]\nid = \"a\"\n".to_owned(),
    ];
    let files: Vec<PathBuf> = (0..wrong.len())
        .map(|k| directory.path().join(format!("{k}.toml")))
        .collect();
    for (path, text) in files.iter().zip(&wrong) {
        std::fs::write(path, text).unwrap();
        let check = Command::new(PROGRAM)
            .arg("check")
            .arg(path)
            .output()
            .unwrap();
        assert_eq!(check.status.code(), Some(2), "{text}");
    }
    for (line, text) in errors(&python, directory.path(), &files).iter().zip(&wrong) {
        assert!(!line.ends_with("| "), "{text} is taken");
    }
}
