//! README and guides hold what they show: every block of code is parsed, built or run.
//!
//! The first word after the fence is the language, the rest says what a block is. Rust blocks are
//! doctests of the library (`src/lib.rs`).

use palpate_client::device::{DeviceModel, Hand};
use palpate_experiment::batch::Sweep;
use palpate_modeling::branch::Tree;
use palpate_sim::scene::{Scene, file};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A document, by its path from the root.
struct Document {
    path: String,
    text: String,
}

/// A fenced block of a document.
pub struct Block {
    /// Document and line of the fence, for messages.
    pub place: String,
    pub language: String,
    /// What follows the language in the fence's line.
    pub kind: String,
    pub code: String,
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn documents() -> Vec<Document> {
    let mut paths = vec![root().join("README.md")];
    for client in ["c", "python", "web"] {
        paths.push(root().join("clients").join(client).join("README.md"));
    }
    let guides = std::fs::read_dir(root().join("docs")).unwrap();
    paths.extend(guides.map(|entry| entry.unwrap().path()));
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.sort();
    let document = |path: PathBuf| Document {
        text: std::fs::read_to_string(&path).unwrap(),
        path: path.strip_prefix(root()).unwrap().display().to_string(),
    };
    paths.into_iter().map(document).collect()
}

pub fn blocks() -> Vec<Block> {
    let mut blocks = Vec::new();
    for document in documents() {
        let mut open: Option<Block> = None;
        for (k, line) in document.text.lines().enumerate() {
            match (&mut open, line.strip_prefix("```")) {
                (Some(_), Some("")) => blocks.extend(open.take()),
                (Some(block), _) => {
                    block.code.push_str(line);
                    block.code.push('\n');
                }
                (None, Some(info)) => {
                    let end = info.find([' ', ',']).unwrap_or(info.len());
                    open = Some(Block {
                        place: format!("{}:{}", document.path, k + 1),
                        language: info[..end].to_owned(),
                        kind: info[end..].trim_start_matches([' ', ',']).to_owned(),
                        code: String::new(),
                    });
                }
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a block does not end", document.path);
    }
    blocks
}

/// Kinds of blocks, and for those that are only read the reason in their name.
const KINDS: [(&str, &[&str]); 9] = [
    ("text", &["", "output"]), // output: documents_run
    ("sh", &["", "build", "daemon", "npm", "peer", "recording"]), // run by documents_run
    ("c", &["", "list", "watchdog"]), // compiled and run by readmes
    ("ts", &[""]),             // checked and run by clients/web/tests/readme.test.mjs
    ("rust", &["", "no_run", "no_run,test_harness"]),
    // Run by clients/python/tests/wheel with the installed wheel; `messages` need none (readmes).
    (
        "python",
        &[
            "",
            "no_run",
            "messages",
            "needs=pandas",
            "needs=mcap_protobuf",
            "needs=pyarrow",
            "needs=distributed",
        ],
    ),
    ("hex", &[""]), // proto/tests/golden.rs compares it with the golden bytes
    ("json", &["", "abridged"]),
    (
        "toml",
        &[
            "scene",
            "part of a scene",
            "lines of a tool",
            "device",
            "hand",
            "sweep",
            "tree, abridged",
        ],
    ),
];

#[test]
fn every_block_is_of_a_kind_that_is_checked() {
    for block in blocks() {
        let known = KINDS
            .iter()
            .find(|(language, _)| *language == block.language);
        let kinds = known
            .unwrap_or_else(|| panic!("{}: language {:?}", block.place, block.language))
            .1;
        assert!(
            kinds.contains(&&*block.kind),
            "{}: {:?} is none of {kinds:?}",
            block.place,
            block.kind
        );
    }
}

// --- scenes and other TOML files

/// A scene to which parts are added: one body, one tool.
const BASE: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }

[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
"#;

fn build(text: &str, directory: &Path, place: &str) {
    let loaded =
        file::parse(text, place, directory).unwrap_or_else(|e| panic!("{place}: {e}\n{text}"));
    let built = Scene::build_with(&loaded.spec, directory, palpate_thesis::METHODS);
    built.unwrap_or_else(|e| panic!("{place}: {e}\n{text}"));
}

/// The base scene, its first body and tool replaced or completed by those of a part.
fn completed(part: &str) -> String {
    let mut scene: toml::Table = toml::from_str(BASE).unwrap();
    let part: toml::Table = toml::from_str(part).unwrap();
    for (key, value) in part {
        let first = |list: &mut toml::Value| {
            list.as_array_mut().unwrap()[0]
                .as_table_mut()
                .unwrap()
                .clone()
        };
        match (key.as_str(), value) {
            ("body" | "tool", mut list) => {
                let mut whole = scene[&key].as_array().unwrap()[0]
                    .as_table()
                    .unwrap()
                    .clone();
                whole.extend(first(&mut list));
                scene.insert(key.clone(), vec![whole].into());
            }
            (_, value) => drop(scene.insert(key.clone(), value)),
        }
    }
    if let Some(frame) = scene
        .get("gravity")
        .and_then(|gravity| gravity.get("frame"))
        .cloned()
    {
        scene["tool"][0]["id"] = frame;
    }
    toml::to_string(&scene).unwrap()
}

/// Files that parts of scenes name, as people would have them.
fn files() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let bracket = root().join("scenes/bracket.step");
    std::fs::copy(bracket, directory.path().join("bracket.step")).unwrap();
    for (name, arguments) in [
        ("liver.json", &["convert", "builtin:teardrop"]),
        ("organ.json", &["convert", "builtin:sphere"]),
        ("probe.stl", &["tessellate", "builtin:sphere"]),
    ] {
        let unit: &[&str] = if name.ends_with("stl") {
            &["--unit", "mm", "--cells", "4"]
        } else {
            &[]
        };
        let output = if name.ends_with("stl") {
            vec!["-o", name]
        } else {
            vec![name]
        };
        let done = Command::new(env!("CARGO_BIN_EXE_palpate"))
            .arg("surface")
            .args(arguments)
            .args(output)
            .args(unit)
            .current_dir(directory.path())
            .output()
            .unwrap();
        assert!(
            done.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&done.stderr)
        );
    }
    directory
}

#[test]
fn scenes_and_parts_of_scenes_are_built() {
    let files = files();
    for block in blocks().iter().filter(|block| block.language == "toml") {
        match &*block.kind {
            "scene" => build(&block.code, files.path(), &block.place),
            "part of a scene" => build(&completed(&block.code), files.path(), &block.place),
            "lines of a tool" => {
                for line in block.code.lines() {
                    let part = format!("[[tool]]\nid = \"ball\"\n{line}\n");
                    build(&completed(&part), files.path(), &block.place);
                }
            }
            _ => {}
        }
    }
}

#[test]
fn files_of_devices_hands_and_trees_are_read() {
    for block in blocks().iter().filter(|block| block.language == "toml") {
        let place = &block.place;
        match &*block.kind {
            "device" => drop(DeviceModel::from_toml(&block.code, place).unwrap()),
            "hand" => drop(Hand::from_toml(&block.code, place).unwrap()),
            "sweep" => {
                let sweep = Sweep::parse(&block.code, place, root());
                let sweep = sweep.unwrap_or_else(|error| panic!("{place}: {error}"));
                // As the page says, and as the file in the repository is.
                assert_eq!(sweep.plan().count(), 40);
                let file = std::fs::read_to_string(root().join("scenes/sweeps/stiffness.toml"));
                let lines = |text: &str| -> Vec<String> {
                    let told = |line: &&str| !line.starts_with('#');
                    text.lines().filter(told).map(str::to_owned).collect()
                };
                assert_eq!(lines(&file.unwrap()), lines(&block.code), "{place}");
            }
            "tree, abridged" => {
                // What the comments stand for: the branch ends, and the right one is like the left.
                let mut tree: toml::Table = toml::from_str(&block.code).unwrap();
                let fork = tree["stem"]["fork"].as_table_mut().unwrap();
                fork["left"].as_table_mut().unwrap().remove("fork");
                let left = fork["left"].clone();
                fork.insert("right".into(), left);
                let tree: Tree = tree.try_into().unwrap_or_else(|e| panic!("{place}: {e}"));
                assert_eq!(tree.leaves(), 2);
            }
            _ => {}
        }
    }
}

// --- commands

/// One command of a `sh` block, without comment, redirection and variables.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quoted) = (Vec::new(), None::<String>, false);
    for c in line.chars() {
        match c {
            '\'' => {
                quoted = !quoted;
                word.get_or_insert_default();
            }
            '#' if !quoted && word.is_none() => break,
            c if c.is_whitespace() && !quoted => words.extend(word.take()),
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    if let Some(k) = words.iter().position(|word| word == ">" || word == "&") {
        words.truncate(k);
    }
    while words
        .first()
        .is_some_and(|word| word.contains('=') && !word.starts_with('-'))
    {
        words.remove(0);
    }
    words
}

fn commands() -> Vec<(String, Vec<String>)> {
    let lines = |block: &Block| {
        let lines = block
            .code
            .lines()
            .map(words)
            .filter(|words| !words.is_empty());
        lines
            .map(|words| (block.place.clone(), words))
            .collect::<Vec<_>>()
    };
    blocks()
        .iter()
        .filter(|block| block.language == "sh")
        .flat_map(lines)
        .collect()
}

/// Long options of `palpate-bench`, from its source: the daemon's crate cannot use it.
fn bench_knows(argument: &str) -> bool {
    let source = include_str!("../../crates/bench/src/main.rs");
    match argument.strip_prefix("--") {
        Some(option) => {
            source.contains(&format!("        {}:", option.replace('-', "_")))
                || source.contains(&format!("    {}:", option.replace('-', "_")))
        }
        None => true,
    }
}

fn check(place: &str, command: &[String]) {
    let text: Vec<&str> = command.iter().map(String::as_str).collect();
    match text.as_slice() {
        ["palpate", ..] => {
            let parsed = palpate::cli::command().try_get_matches_from(command);
            parsed.unwrap_or_else(|e| panic!("{place}: {}\n{e}", command.join(" ")));
        }
        ["cargo", "run", "--", rest @ ..] | ["cargo", "run", "--release", "--", rest @ ..] => {
            let arguments = ["palpate"].iter().chain(rest).map(|&word| word.to_owned());
            check(place, &arguments.collect::<Vec<_>>());
        }
        [
            "cargo",
            "run",
            "--release",
            "-p",
            "palpate-bench",
            "--",
            suite,
            rest @ ..,
        ] => {
            let suites = [
                "surface",
                "contact",
                "deformation",
                "haptics",
                "modeling",
                "recording",
                "viewer",
            ];
            assert!(suites.contains(suite), "{place}: {suite}");
            for argument in rest {
                assert!(bench_knows(argument), "{place}: {argument}");
            }
        }
        ["cargo", "test", "--workspace"] | ["wait"] => {}
        // Of the Python package, which `.ci/run` builds and tests.
        ["pip", "install", "maturin"]
        | [
            "maturin",
            "develop",
            "--release",
            "-m",
            "clients/python/Cargo.toml",
        ]
        | ["pytest", "clients/python"] => {}
        // Of clients/web, which `.ci/run` tests.
        ["npm", "ci" | "test"]
        | ["npm", "run", "test:browser"]
        | ["node", "tests/browser.mjs", ..] => {}
        ["cargo", "install", "--path", "."] => {}
        ["kill", _] => {}
        other => panic!("{place}: {other:?} is not checked"),
    }
}

#[test]
fn commands_and_their_options_exist() {
    let commands = commands();
    assert!(commands.len() > 30, "{}", commands.len());
    for (place, command) in &commands {
        check(place, command);
    }
}

/// `palpate serve SCENE [--record FILE]` in running text and tables: the command and each of its
/// options exist.
#[test]
fn commands_in_the_text_exist() {
    for document in documents() {
        for span in document
            .text
            .split('`')
            .filter(|span| span.starts_with("palpate "))
        {
            let span = span.replace("\\|", "|");
            let mut command = palpate::cli::command();
            for word in span.split_whitespace().skip(1).take(2) {
                for name in word.split('|') {
                    if name.chars().all(|c| c.is_ascii_lowercase())
                        && let Some(found) = command.clone().find_subcommand(name)
                    {
                        command = found.clone();
                    }
                }
            }
            let at = || format!("{}: {span:?}", document.path);
            assert_ne!(command.get_name(), "palpate", "{}", at());
            for option in span
                .split(|c: char| !(c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'))
                .filter(|word| word.starts_with("--"))
            {
                let known = command
                    .get_arguments()
                    .any(|a| a.get_long() == Some(&option[2..]));
                assert!(known, "{}: {option}", at());
            }
        }
    }
}

#[test]
fn every_page_is_in_the_book() {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    for document in documents() {
        let Some(page) = document.path.strip_prefix("docs/") else {
            continue;
        };
        let listed = summary.contains(&format!("]({page})"));
        assert!(
            listed || page == "SUMMARY.md",
            "docs/SUMMARY.md lacks {page}"
        );
    }
}

#[test]
fn links_lead_somewhere() {
    for document in documents() {
        let directory = root().join(&document.path);
        let directory = directory.parent().unwrap();
        for link in document.text.split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            if link.starts_with("http") || link.contains(' ') {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() {
                root().join(&document.path)
            } else {
                directory.join(path)
            };
            assert!(target.exists(), "{}: {link}", document.path);
            if !anchor.is_empty() {
                let text = std::fs::read_to_string(&target).unwrap();
                let heading = |line: &str| {
                    line.starts_with('#')
                        .then(|| slug(line.trim_start_matches('#').trim()))
                };
                assert!(
                    text.lines().filter_map(heading).any(|slug| slug == anchor),
                    "{}: {link}",
                    document.path
                );
            }
        }
    }
}

/// The anchor of a heading, as GitHub makes it.
fn slug(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}
