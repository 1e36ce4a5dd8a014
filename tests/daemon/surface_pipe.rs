//! `palpate surface pipe` as scripts use it: curves in, bounds and surfaces out, exit codes.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ClosestSolver, Closing, Loaded, file};
use std::path::Path;
use std::process::{Command, Output};

fn pipe(directory: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_palpate");
    Command::new(program)
        .args(["surface", "pipe"])
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn error(output: &Output) -> String {
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A hook whose ends come near each other (mm).
const HOOK: &str = r#"{"format": "palpate.curve.v1", "degree": 4, "knots": [0, 0, 0, 0, 0, 1, 1, 1, 1, 1],
    "points": [[0, 0, 0], [20, 2, 5], [15, 25, -3], [-6, 12, 4], [11, -5, 6]], "weights": [1, 2, 0.5, 3, 1], "unit": "mm"}"#;

#[test]
fn bounds_are_printed_in_the_unit_of_the_file_with_what_gives_them() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("hook.json"), HOOK).unwrap();
    let output = pipe(directory.path(), &["hook.json", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let report = json(&output);
    for (key, wanted) in [
        ("r_max", 1.032_574_058_813_789_2),
        ("r_local", 1.032_574_058_813_789_2),
        ("r_bb", 1.934_179_548_482_318_5),
        ("r_ee", 15.229_255_703_052_327),
        ("r_eb", 3.951_726_569_873_443_4),
    ] {
        let found = report[key].as_f64().unwrap();
        assert!(
            (found / wanted - 1.0).abs() < 1e-10,
            "{key}: {found} is not {wanted}"
        );
    }
    assert_eq!(
        (report["limit"].as_str(), report["status"].as_str()),
        (Some("local"), Some("complete"))
    );
    assert_eq!(report["pairs"].as_array().unwrap().len(), 4);
    assert_eq!(
        report["kinds"],
        serde_json::json!(["saddle", "minimum", "maximum", "saddle"])
    );
    assert!(report.get("free").is_none());
    let points = &report["witness"]["bb"]["points"];
    let point = |k: usize| Point3::from([0, 1, 2].map(|axis| points[k][axis].as_f64().unwrap()));
    let distance = (point(0) - point(1)).norm();
    assert!(
        (distance - 2.0 * report["r_bb"].as_f64().unwrap()).abs() < 1e-12,
        "{distance}"
    );
    let people = pipe(directory.path(), &["hook.json"]);
    assert!(
        String::from_utf8(people.stdout)
            .unwrap()
            .contains("4 stationary pairs")
    );
}

#[test]
fn a_radius_is_answered_and_its_pipe_written_only_where_it_is_free() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    std::fs::write(at("hook.json"), HOOK).unwrap();
    let free = pipe(
        directory.path(),
        &["hook.json", "--json", "--radius", "1.03", "-o", "pipe.json"],
    );
    assert_eq!(
        (free.status.code(), json(&free)["free"].as_bool()),
        (Some(0), Some(true))
    );
    assert!(json(&free)["surface"]["deviation"].as_f64().unwrap() <= 1.03e-6);
    let (Loaded { surface, .. }, unit) =
        file::read_with_unit(&std::fs::read_to_string(at("pipe.json")).unwrap()).unwrap();
    assert_eq!(
        (unit.name(), surface.topology().closing),
        ("mm", [Closing::Open, Closing::Periodic])
    );
    // Half a millimetre outside the pipe, beside the middle of the spine; closest points are feet
    // on the outward normal.
    let (point, normal) = (surface.point(0.5, 0.2), surface.normal(0.5, 0.2));
    let foot = ClosestSolver::new(&surface).closest(&surface, &(point + normal * 5e-4));
    assert!((foot.distance - 5e-4).abs() < 1e-9, "{}", foot.distance);

    let met = pipe(
        directory.path(),
        &["hook.json", "--json", "--radius", "1.04", "-o", "met.json"],
    );
    assert_eq!(
        (met.status.code(), json(&met)["free"].as_bool()),
        (Some(1), Some(false))
    );
    assert!(!at("met.json").exists());
    let forced = pipe(
        directory.path(),
        &[
            "hook.json",
            "--json",
            "--radius",
            "1.04",
            "-o",
            "met.step",
            "--force",
            "--tolerance",
            "0.001",
        ],
    );
    assert_eq!(forced.status.code(), Some(1));
    assert!(
        at("met.step").exists() && json(&forced)["surface"]["deviation"].as_f64().unwrap() <= 1e-3
    );
}

#[test]
fn bounds_that_do_not_exist_are_null() {
    let directory = tempfile::tempdir().unwrap();
    let line = r#"{"format": "palpate.curve.v1", "degree": 1, "knots": [0, 0, 1, 1], "points": [[0, 0, 0], [1, 0, 0]]}"#;
    std::fs::write(directory.path().join("line.json"), line).unwrap();
    let output = pipe(directory.path(), &["line.json", "--json", "--radius", "7"]);
    assert_eq!(output.status.code(), Some(0));
    for key in ["r_max", "limit", "r_local", "r_bb", "r_ee", "r_eb"] {
        assert!(json(&output)[key].is_null(), "{key}");
    }
}

#[test]
fn bad_input_is_refused_with_what_and_where() {
    let directory = tempfile::tempdir().unwrap();
    let said = |text: &str, more: &[&str]| {
        std::fs::write(directory.path().join("spine.json"), text).unwrap();
        error(&pipe(directory.path(), &[&["spine.json"], more].concat()))
    };
    assert!(said(HOOK, &["--radius", "-1"]).contains("finite length above 0"));
    assert!(said(HOOK, &["--radius", "nan"]).contains("finite length above 0"));
    assert!(
        said(
            HOOK,
            &["--radius", "1", "-o", "pipe.json", "--tolerance", "-2"]
        )
        .contains("the tolerance is -0.002 m")
    );
    assert!(said(HOOK, &["-o", "pipe.json"]).contains("--radius"));
    assert!(said(HOOK, &["--radius", "1", "-o", "pipe.stl"]).contains("is not a surface format"));
    assert!(
        said(
            HOOK,
            &["--radius", "1", "-o", "pipe.json", "--tolerance", "1e-15"]
        )
        .contains("raise the tolerance")
    );
    assert!(said("{", &[]).contains("spine.json"));
    assert!(
        said(&HOOK.replace("[20, 2, 5]", "[0, 0, 0]"), &[]).contains("vanishes at parameter 0")
    );
    assert!(error(&pipe(directory.path(), &["nowhere.json"])).contains("nowhere.json"));
}
