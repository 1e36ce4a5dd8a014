//! `palpate surface` on parts: all trimmed faces of a STEP file.

use palpate_geometry::exchange::{Format, read_mesh};
use palpate_geometry::surface::file::Unit;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn palpate(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("surface")
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
        .collect()
}

fn geometry(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("crates/geometry/tests")
        .join(name)
}

/// A part and what is known of it.
fn part(name: &str) -> (String, Value) {
    let path = geometry("data/parts").join(name);
    let text = std::fs::read_to_string(path.with_extension("json")).unwrap();
    let step = path.with_extension("step").to_str().unwrap().to_owned();
    (step, serde_json::from_str(&text).unwrap())
}

fn near(a: &Value, b: &Value, relative: f64) -> bool {
    let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
    (a - b).abs() <= relative * b.abs()
}

#[test]
fn info_lists_the_faces_of_parts_with_areas_and_volume() {
    let directory = tempfile::tempdir().unwrap();
    for (name, faces, solids) in [("filleted_box", 26, 1), ("assembly", 44, 6)] {
        let (step, known) = part(name);
        let output = palpate(directory.path(), &["info", &step, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let info = &lines(&output)[0];
        assert_eq!(info["unit"], "mm");
        assert_eq!(info["closed"], true);
        let listed = info["faces"].as_array().unwrap();
        assert_eq!(listed.len(), faces, "{name}");
        assert_eq!(info["solids"].as_array().unwrap().len(), solids, "{name}");
        let sum: f64 = listed.iter().map(|f| f["area"].as_f64().unwrap()).sum();
        assert!(near(&sum.into(), &known["area"], 1e-9), "{name}: {sum}");
        let loops = |f: &Value| f["loops"].as_u64().unwrap() >= 1;
        assert!(listed.iter().all(loops), "{name}");
        let planes =
            |list: &[Value], plane: &str| list.iter().filter(|f| f["type"] == plane).count();
        assert_eq!(
            planes(listed, "plane"),
            planes(known["faces"].as_array().unwrap(), "Plane"),
            "{name}"
        );
        assert!(near(&info["area"], &known["area"], 1e-9), "{name}");
        assert!(near(&info["volume"], &known["volume"], 1e-9), "{name}");
        assert!(info["gap"].as_f64().unwrap() < 1e-9, "{name}");
        assert_eq!(info["left_out"]["faces"], 0, "{name}");
        assert_eq!(info["turned"], 0, "{name}");
    }
    let (step, _) = part("assembly");
    let pin = ["info", &step, "--part", "pin", "--instance", "2", "--json"];
    let pin = &lines(&palpate(directory.path(), &pin))[0];
    assert_eq!(pin["faces"].as_array().unwrap().len(), 3);
    assert_eq!(pin["solids"][0]["instance"], 2);
    let table = palpate(directory.path(), &["info", &step]);
    let table = String::from_utf8(table.stdout).unwrap();
    for says in [
        "closed part of 44 faces",
        "32 plane",
        "12 faces of \"pin\"",
        "volume 25020.6",
    ] {
        assert!(table.contains(says), "{table}");
    }
}

#[test]
fn closest_points_of_parts_say_what_they_lie_on() {
    let directory = tempfile::tempdir().unwrap();
    let (step, known) = part("filleted_box");
    let queries = &known["queries"].as_array().unwrap()[..200];
    let text: String = (queries.iter())
        .map(|q| format!("{},{},{}\n", q[0], q[1], q[2]))
        .collect();
    std::fs::write(directory.path().join("at.csv"), text).unwrap();
    let arguments = ["closest", &step, "--points", "at.csv"];
    let feet = lines(&palpate(
        directory.path(),
        &[&arguments[..], &["--json"]].concat(),
    ));
    assert_eq!(feet.len(), queries.len());
    for (foot, query) in feet.iter().zip(queries) {
        let distance = foot["distance"].as_f64().unwrap();
        assert!(
            (distance - query[4].as_f64().unwrap()).abs() < 1e-6,
            "{query}: {foot}"
        );
        let sign = if query[10] == "in" { -1.0 } else { 1.0 };
        let signed = foot["signed_distance"].as_f64().unwrap();
        assert!((signed - sign * distance).abs() < 1e-9, "{query}: {foot}");
        let support = foot["support"].as_str().unwrap();
        assert!(["face", "edge", "vertex"].contains(&support), "{foot}");
        assert!(
            foot["support_index"].is_u64() && foot["face"].is_u64(),
            "{foot}"
        );
        assert_eq!(foot["normal"].as_array().unwrap().len(), 3, "{foot}");
    }
    let table = String::from_utf8(palpate(directory.path(), &arguments).stdout).unwrap();
    for (line, foot) in table.lines().zip(&feet) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 8, "{line}");
        assert_eq!(fields[5], foot["support"].as_str().unwrap(), "{line}");
    }
}

#[test]
fn a_surface_has_a_signed_distance_where_it_is_closed() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("at.csv"), "0,0,0.001\n").unwrap();
    for (file, closed) in [("builtin:sphere", true), ("builtin:sheet", false)] {
        let arguments = ["closest", file, "--points", "at.csv"];
        let feet = lines(&palpate(
            directory.path(),
            &[&arguments[..], &["--json"]].concat(),
        ));
        let signed = feet[0]["signed_distance"].as_f64();
        assert_eq!(signed.is_some(), closed, "{file}");
        if let Some(signed) = signed {
            assert_eq!(signed, -feet[0]["distance"].as_f64().unwrap(), "{file}");
        }
        let table = String::from_utf8(palpate(directory.path(), &arguments).stdout).unwrap();
        let last = table.trim().split(',').nth(6).unwrap();
        assert_eq!(last.parse().ok(), signed, "{file}");
    }
}

#[test]
fn triangles_of_parts_are_watertight() {
    let directory = tempfile::tempdir().unwrap();
    let (step, _) = part("assembly");
    for (made, name) in [
        (
            vec!["tessellate", &step, "-o", "a.obj", "--unit", "mm"],
            "a.obj",
        ),
        (
            vec![
                "convert",
                &step,
                "b.obj",
                "--unit",
                "mm",
                "--tolerance",
                "1e-5",
            ],
            "b.obj",
        ),
    ] {
        let output = palpate(directory.path(), &made);
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let bytes = std::fs::read(directory.path().join(name)).unwrap();
        let mesh = read_mesh(&bytes, Format::Obj, Unit::Millimetre).unwrap();
        let mut uses: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for &[a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *uses.entry([from.min(to), from.max(to)]).or_default() +=
                    if from < to { 1 } else { -1 };
            }
        }
        assert!(
            mesh.triangles.len() > 500 && uses.values().all(|sum| *sum == 0),
            "{name}"
        );
    }
}

#[test]
fn a_part_is_written_as_step_and_is_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let (step, _) = part("assembly");
    let info = |file: &str| lines(&palpate(directory.path(), &["info", file, "--json"]))[0].clone();
    let before = info(&step);
    for (made, unit) in [
        (vec!["convert", &step, "a.step"], "mm"),
        (vec!["convert", &step, "b.stp", "--unit", "m"], "m"),
        (vec!["convert", "a.step", "again.step"], "mm"),
    ] {
        let output = palpate(directory.path(), &made);
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let after = info(made[2]);
        assert_eq!(after["unit"], unit);
        assert_eq!(after["closed"], true);
        assert_eq!(after["edges"], before["edges"]);
        let kinds = |info: &Value| -> Vec<Value> {
            let faces = info["faces"].as_array().unwrap().iter();
            faces.map(|face| face["type"].clone()).collect()
        };
        assert_eq!(kinds(&after), kinds(&before));
        let scale: f64 = if unit == "m" { 1e-9 } else { 1.0 };
        let volume = before["volume"].as_f64().unwrap() * scale;
        assert!(near(&volume.into(), &after["volume"], 1e-12), "{after}");
    }
    let [first, second] = ["a.step", "again.step"]
        .map(|name| std::fs::read_to_string(directory.path().join(name)).unwrap());
    assert_eq!(first, second);
}

#[test]
fn a_face_that_cannot_be_read_is_refused_or_left_out_with_a_difference() {
    let directory = tempfile::tempdir().unwrap();
    let (step, _) = part("filleted_box");
    let text = std::fs::read_to_string(step).unwrap();
    let text = text.replacen("PLANE('',", "OFFSET_SURFACE('',", 1);
    std::fs::write(directory.path().join("odd.step"), text).unwrap();
    let refused = palpate(directory.path(), &["info", "odd.step"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        words(&refused).contains("OFFSET_SURFACE"),
        "{}",
        words(&refused)
    );
    let taken = palpate(
        directory.path(),
        &["info", "odd.step", "--partial", "--json"],
    );
    assert_eq!(taken.status.code(), Some(1), "{}", words(&taken));
    let info = &lines(&taken)[0];
    assert_eq!(info["faces"].as_array().unwrap().len(), 25);
    assert_eq!(info["left_out"]["faces"], 1);
    assert_eq!(info["left_out"]["kinds"]["OFFSET_SURFACE"], 1);
    assert_eq!(
        (&info["closed"], &info["volume"]),
        (&false.into(), &Value::Null)
    );
    assert!(
        words(&taken).contains("1 faces (1 at OFFSET_SURFACE)"),
        "{}",
        words(&taken)
    );
}

#[test]
fn what_takes_one_surface_or_one_part_says_so() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("uv.csv"), "0.2,0.3\n").unwrap();
    let (filleted, _) = part("filleted_box");
    let drilled = geometry("opencascade/drilled_box.step");
    let (filleted, drilled) = (filleted.as_str(), drilled.to_str().unwrap());
    let cases: [(&[&str], i32, &str); 7] = [
        (
            &["eval", filleted, "--uv", "uv.csv"],
            2,
            "a part with 26 faces",
        ),
        (
            &["eval", drilled, "--uv", "uv.csv"],
            1,
            "reads all its faces as a part",
        ),
        (
            &["tessellate", filleted, "-o", "a.stl", "--cells", "4"],
            2,
            "--cells",
        ),
        (
            &["convert", filleted, "a.json"],
            2,
            "written as .step or .stp",
        ),
        (
            &["info", filleted, "--part", "no such"],
            2,
            "no part is called \"no such\"",
        ),
        (
            &["info", "builtin:sheet", "--partial"],
            2,
            "choose parts of a STEP file",
        ),
        (
            &["info", filleted, "--part", "a", "--index", "0"],
            2,
            "cannot be used with",
        ),
    ];
    for (arguments, code, says) in cases {
        let output = palpate(directory.path(), arguments);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(says), "{arguments:?}: {said}");
    }
}

#[test]
fn pieces_of_a_cut_are_parts_with_the_volumes_that_it_prints() {
    let directory = tempfile::tempdir().unwrap();
    let drop = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("crates/geometry/src/surface/data/teardrop_12.json");
    let drop = drop.to_str().unwrap();
    let plane = ["--point", "0,0,45", "--normal", "0,0,1"];
    let cut = |more: &[&str]| {
        let arguments = [&["cut", drop][..], &plane, more].concat();
        palpate(directory.path(), &arguments)
    };
    let output = cut(&["-o", "all.step", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let report = &lines(&output)[0];
    assert_eq!(report["unit"], "mm");
    let pieces = report["pieces"].as_array().unwrap();
    let sides: Vec<&Value> = pieces.iter().map(|piece| &piece["side"]).collect();
    assert_eq!(sides, ["above", "below"]);
    // Of the reference data, mm³.
    for (piece, volume) in pieces.iter().zip([20592.569198601304, 50091.50075468002]) {
        assert!(near(&piece["volume"], &volume.into(), 1e-9), "{piece}");
    }
    for (k, piece) in pieces.iter().enumerate() {
        let number = k.to_string();
        let output = cut(&["-o", "one.step", "--piece", &number]);
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let output = palpate(directory.path(), &["info", "one.step", "--json"]);
        let info = &lines(&output)[0];
        assert_eq!(info["closed"], true, "{info}");
        assert_eq!(info["faces"].as_array().unwrap().len(), 2);
        assert!(near(&info["volume"], &piece["volume"], 1e-8), "{info}");
    }
    let info = &lines(&palpate(directory.path(), &["info", "all.step", "--json"]))[0];
    assert_eq!(info["solids"].as_array().unwrap().len(), 2, "{info}");
    let whole = 20592.569198601304 + 50091.50075468002;
    assert!(near(&info["volume"], &whole.into(), 1e-8), "{info}");
    for (arguments, said) in [
        (["--piece", "2"], "there is no piece 2"),
        (["-o", "pieces.stl"], "written as .step or .stp"),
    ] {
        let output = cut(&arguments);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        assert!(words(&output).contains(said), "{}", words(&output));
    }
    let missed = ["cut", drop, "--point", "0,0,200", "--normal", "0,0,1"];
    let output = palpate(directory.path(), &missed);
    assert!(words(&output).contains("does not cut the surface"));
}
