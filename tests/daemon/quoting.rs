//! What stands in files and names does not get where it does not belong: a file that somebody names may
//! hold a key, and a name may hold what a terminal obeys.

use crate::daemon::PROGRAM;
use crate::live::record;
use crate::scenes::RIGID;
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs the program in a folder; gives all that it says, and the exit code.
fn palpate(folder: &Path, arguments: &[&str]) -> (String, i32) {
    let output = Command::new(PROGRAM)
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said).into_owned();
    (said, output.status.code().unwrap_or(-1))
}

/// Files that are none of the user's business, each with `S3CRET` where a reader stops.
const FILES: [(&str, &str); 5] = [
    (
        "shadow",
        "root:$6$S3CRET$abc:19000:0:99999:7:::\ndaemon:S3CRET:0\n",
    ),
    ("words", "S3CRET 1 2 3\nv S3CRET 1 2\n"),
    ("json", "\"S3CRET\""),
    ("toml", "position = \"S3CRET\"\nmode = S3CRET\n"),
    (
        "settings",
        "{ mode: \"S3CRET\", format: \"S3CRET\", points: \"S3CRET\" }",
    ),
];

#[test]
fn no_refusal_repeats_what_stands_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = |name: &str, surface: &str, more: &str, shape: &str| {
        let text = format!(
            "[[body]]\nid = \"a\"\nsurface = {surface}\n{more}\n[[tool]]\nid = \"b\"\nshape = {shape}\n"
        );
        std::fs::write(folder.join(name), text).unwrap();
    };
    let (drop, ball) = (
        "{ builtin = \"teardrop\", net = [8, 8] }",
        "{ sphere = { radius_m = 0.01 } }",
    );
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    for (kind, text) in FILES {
        let mut doors: Vec<Vec<String>> = Vec::new();
        let mut door = |arguments: &str| {
            doors.push(arguments.split(' ').map(str::to_owned).collect());
        };
        for ending in ["json", "stl", "obj", "ply", "glb", "step", "igs", "csv"] {
            let file = format!("{kind}.{ending}");
            write(&file, text);
            let named = format!("{{ file = \"{file}\" }}");
            scene(&format!("s-{file}.toml"), &named, "", ball);
            door(&format!("check s-{file}.toml"));
            scene(
                &format!("m-{file}.toml"),
                drop,
                "",
                &format!("{{ mesh = {named} }}"),
            );
            door(&format!("check m-{file}.toml"));
        }
        let motion = format!("motion = {{ file = \"{kind}.csv\" }}");
        scene(&format!("p-{kind}.toml"), drop, &motion, ball);
        door(&format!("check p-{kind}.toml"));
        write(kind, text);
        write(&format!("{kind}.json5"), text);
        write(&format!("{kind}.yaml"), text);
        for file in [
            kind.to_owned(),
            format!("{kind}.json5"),
            format!("{kind}.yaml"),
        ] {
            door(&format!(
                "serve builtin:rigid-teardrop --zenoh-config {file}"
            ));
            door(&format!("serve builtin:rigid-teardrop --identity {file}"));
        }
        for command in [
            "info",
            "batch --output o",
            "device --tool ball --device",
            "surface closest builtin:teardrop --points",
            "import",
        ] {
            door(&format!("{command} {kind}.csv"));
        }
        for arguments in doors {
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let (said, code) = palpate(folder, &arguments);
            assert!(code != 0, "{arguments:?} was accepted: {said}");
            assert!(!said.contains("S3CRET"), "{arguments:?}: {said}");
        }
    }
}

#[test]
fn what_a_recording_calls_its_scene_does_not_reach_the_terminal_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mcap");
    let text = RIGID.replace("rigid-teardrop", "x\\u001b[2J\\u202ey");
    record(&file, &text, 20, &[]);
    let (said, code) = palpate(folder.path(), &["info", "a.mcap"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains(r"scene x\u{1b}[2J\u{202e}y"), "{said:?}");
    assert!(!said.contains(['\u{1b}', '\u{202e}']), "{said:?}");
    let (said, code) = palpate(folder.path(), &["info", "no\u{1b}[2J.mcap"]);
    assert!(code == 2 && !said.contains('\u{1b}'), "{said:?}");
}

#[test]
fn a_refusal_says_where_it_stopped_and_what_belongs_there() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("mode.json5", "{\n  mode: \"pear\" }");
    write("key.json5", "{ lisen: {} }");
    write("cut.json5", "{ mode: ");
    write("mode.yaml", "mode: pear\n");
    write("a.conf", "{}");
    write("hand.toml", "mass_kg = \"heavy\"\n");
    write("points.csv", "1, 2, 3\n1, two, 3\n");
    write("scan.obj", "v 1 2 3\nv 1 two 3\n");
    let config = "serve builtin:rigid-teardrop --zenoh-config ";
    for (arguments, words) in [
        (
            config,
            "mode.json5: line 2, column 9: expected one of `router`, `peer`, `client`",
        ),
        (
            config,
            "key.json5: line 1, column 3: expected one of `id`, `metadata`, `mode`",
        ),
        (config, "cut.json5: it is not JSON5 at line 1, column"),
        (
            config,
            "mode.yaml: line 1, column 7: expected one of `router`, `peer`, `client`",
        ),
        (
            config,
            "a.conf: a configuration is a file .json5, .json or .yaml",
        ),
        (
            "device --tool ball --hand ",
            "hand.toml: line 1, column 11: expected f64",
        ),
        (
            "surface closest builtin:teardrop --points ",
            "points.csv:2: expected x,y,z",
        ),
        (
            "import ",
            "scan.obj: line 2: expected v and three numbers, found 2 words and 2 numbers",
        ),
    ] {
        let file = words.split(':').next().unwrap();
        let all = format!("{arguments}{file}");
        let all: Vec<&str> = all.split(' ').collect();
        let (said, code) = palpate(folder.path(), &all);
        assert!(code == 2 && said.contains(words), "{all:?}: {said}");
    }
}
