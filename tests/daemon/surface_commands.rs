//! `palpate surface` as scripts use it: files in, lines and files out, exit codes.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ClosestSolver, builtin};
use std::path::Path;
use std::process::{Command, Output};

fn palpate(directory: &Path, arguments: &[&str]) -> Output {
    run(directory, &[&["surface"], arguments].concat())
}

/// Any command.
fn run(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

fn lines(output: &Output) -> Vec<serde_json::Value> {
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn floats(value: &serde_json::Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

#[test]
fn a_surface_answers_the_same_from_every_format_in_the_unit_of_its_file() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    std::fs::write(at("uv.csv"), "u,v\n0.2,0.3 # a comment\n1,1\n").unwrap();
    std::fs::write(at("points.csv"), "30,20,50\n0;0;-10\n").unwrap();
    let drop = builtin("teardrop", None, None).unwrap();
    let mut solver = ClosestSolver::new(&drop);
    for (file, unit) in [("drop.step", "mm"), ("drop.igs", "mm"), ("drop.json", "mm")] {
        let made = palpate(
            directory.path(),
            &["convert", "builtin:teardrop", file, "--unit", unit],
        );
        assert!(made.status.success() && made.stdout.is_empty());
        let evaluated = lines(&palpate(
            directory.path(),
            &[
                "eval",
                file,
                "--uv",
                "uv.csv",
                "--derivatives",
                "2",
                "--json",
            ],
        ));
        for (line, (u, v)) in evaluated.iter().zip([(0.2, 0.3), (1.0, 1.0)]) {
            let frame = drop.frame(u, v);
            let wanted = [
                ("point", frame.point.coords),
                ("S_u", frame.du),
                ("S_v", frame.dv),
                ("S_uv", frame.duv),
            ];
            for (name, wanted) in wanted {
                let got = floats(&line[name]);
                assert!(
                    (0..3).all(|k| (got[k] - 1e3 * wanted[k]).abs() < 1e-10),
                    "{file} {name}: {got:?}"
                );
            }
        }
        let feet = lines(&palpate(
            directory.path(),
            &["closest", file, "--points", "points.csv", "--json"],
        ));
        for (line, query) in feet
            .iter()
            .zip([Point3::new(0.03, 0.02, 0.05), Point3::new(0.0, 0.0, -0.01)])
        {
            let foot = solver.closest(&drop, &query);
            assert!(
                (line["distance"].as_f64().unwrap() - 1e3 * foot.distance).abs() < 1e-10,
                "{file}: {line}"
            );
            assert!(
                (line["u"].as_f64().unwrap() - foot.u).abs() < 1e-9,
                "{file}: {line}"
            );
        }
        let info = &lines(&palpate(directory.path(), &["info", file, "--json"]))[0];
        assert_eq!(
            (info["unit"].as_str(), info["closed"].as_bool()),
            (Some(unit), Some(true))
        );
        assert!(
            (info["volume"].as_f64().unwrap() / (1e9 * drop.volume()) - 1.0).abs() < 1e-12,
            "{file}"
        );
    }
}

#[test]
fn triangles_of_a_surface_can_be_fitted_again() {
    let directory = tempfile::tempdir().unwrap();
    for mesh in ["drop.stl", "drop.obj", "drop.glb"] {
        let made = palpate(
            directory.path(),
            &[
                "tessellate",
                "builtin:teardrop",
                "-o",
                mesh,
                "--tolerance",
                "1e-4",
            ],
        );
        assert!(
            made.status.success()
                && std::fs::metadata(directory.path().join(mesh))
                    .unwrap()
                    .len()
                    > 10_000
        );
    }
    let fit = [
        "fit", "drop.stl", "-o", "fit.json", "--closed", "--net", "20x20", "--json",
    ];
    let report = &lines(&palpate(directory.path(), &fit))[0];
    assert!(report["rms_error_m"].as_f64().unwrap() < 1e-4, "{report}");
    let info = &lines(&palpate(directory.path(), &["info", "fit.json", "--json"]))[0];
    let volume = builtin("teardrop", None, None).unwrap().volume();
    assert!(
        (info["volume"].as_f64().unwrap() / volume - 1.0).abs() < 0.01,
        "{info}"
    );
}

#[test]
fn what_cannot_be_done_says_why_and_ends_with_two() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    write("outside.csv", "0.2,0.3\n0.2,1.5\n");
    write("words.csv", "0.2,zero\n0.3,0.4\n0.3,x\n");
    write("cut.step", "ISO-10303-21;\nHEADER;\n");
    write(
        "flat.csv",
        &(0..40).map(|k| format!("{},0,0\n", k)).collect::<String>(),
    );
    let cases: [(&[&str], &str); 8] = [
        (&["info", "missing.step"], "missing.step"),
        (&["info", "cut.step"], "cut short"),
        (&["info", "builtin:cube"], "cube"),
        (&["convert", "builtin:sheet", "a.doc"], "\".doc\""),
        (
            &["eval", "builtin:sheet", "--uv", "outside.csv"],
            "1.5 is outside the domain 0 ..= 1",
        ),
        (
            &["eval", "builtin:sheet", "--uv", "words.csv"],
            "words.csv:1",
        ),
        (
            &[
                "tessellate",
                "builtin:sheet",
                "-o",
                "a.stl",
                "--tolerance=-1",
            ],
            "tolerance",
        ),
        (
            &["fit", "flat.csv", "--unit", "m", "-o", "a.json"],
            "no extent in 2 of three directions",
        ),
    ];
    for (arguments, says) in cases {
        let output = palpate(directory.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(says), "{arguments:?}: {said}");
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_fault() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(["surface", "info", "builtin:torus"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn degrees_are_raised_without_a_change_and_lowered_with_a_bound() {
    let directory = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| palpate(directory.path(), arguments);
    let report = &lines(&run(&[
        "degree",
        "builtin:teardrop",
        "--u",
        "4",
        "--v",
        "5",
        "-o",
        "up.json",
        "--json",
    ]))[0];
    assert_eq!(
        (&report["degree"], report["error_bound"].as_f64()),
        (&serde_json::json!([4, 5]), Some(0.0))
    );
    let drop = builtin("teardrop", None, None).unwrap();
    let read = |name: &str| {
        palpate_geometry::surface::file::read(
            &std::fs::read_to_string(directory.path().join(name)).unwrap(),
        )
        .unwrap()
    };
    let farthest = |surface: &palpate_geometry::surface::Surface| {
        let parameters = (0..=40)
            .flat_map(|i| (0..=40).map(move |j| (f64::from(i) / 40.0, f64::from(j) / 40.0)));
        parameters
            .map(|(u, v)| (surface.point(u, v) - drop.point(u, v)).norm())
            .fold(0.0, f64::max)
    };
    assert!(farthest(&read("up.json")) < 1e-12 * drop.size());
    let report = &lines(&run(&[
        "degree",
        "builtin:teardrop",
        "--u",
        "2",
        "-o",
        "down.json",
        "--json",
    ]))[0];
    let bound = report["error_bound"].as_f64().unwrap();
    let moved = farthest(&read("down.json"));
    assert!(
        moved > 1e-6 && moved <= bound,
        "{moved} m moved, {bound} m allowed"
    );
    let refused = run(&["degree", "builtin:teardrop", "--u", "0", "-o", "x.json"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// A sheet of degree (3, 2) with these knots in v, and as many columns.
fn sheet_with(v: &[f64]) -> String {
    let points: Vec<Vec<[f64; 3]>> = (0..4)
        .map(|i| {
            let bump = |j: usize| 0.003 * ((7 * i + 3 * j) as f64).sin();
            (0..v.len() - 3)
                .map(|j| [0.01 * i as f64, 0.01 * j as f64, bump(j)])
                .collect()
        })
        .collect();
    serde_json::json!({
        "format": "palpate.surface.v1", "degree": [3, 2], "knots": [[0, 0, 0, 0, 1, 1, 1, 1], v], "points": points,
    })
    .to_string()
}

const ON_SHEET: &str = r#"
[[body]]
id = "sheet"
surface = { file = "sheet.json" }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.004 } }
pose = { position = [0.015, 0.05, 0.03] }
"#;

#[test]
fn knots_that_differ_in_their_last_digits_are_merged_with_a_note_or_refused_with_their_joint() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    write("at.csv", "0.0105,0.0233,-0.0012\n");
    write("scene.toml", ON_SHEET);
    let (a, b, c) = (0.5, 0.5 + 1.2e-16, 0.5 + 2.3e-16);
    let asked: [&[&str]; 4] = [
        &["surface", "info", "sheet.json"],
        &[
            "surface",
            "closest",
            "sheet.json",
            "--points",
            "at.csv",
            "--json",
        ],
        &["check", "scene.toml"],
        &["probe", "scene.toml", "--poses", "at.csv"],
    ];
    for (knots, code, says) in [
        (
            vec![0.0, 0.0, 0.0, a, b, c, 1.0, 1.0, 1.0],
            2,
            "knots 3 to 5 in v differ in their last digits near 0.5",
        ),
        (
            vec![0.0, 0.0, 0.0, a, b, 1.0, 1.0, 1.0],
            0,
            "knots 3 to 4 in v differ in their last digits and were made 0.5",
        ),
    ] {
        write("sheet.json", &sheet_with(&knots));
        for arguments in asked {
            let output = run(directory.path(), arguments);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
            assert!(said.contains(says), "{arguments:?}: {said}");
        }
    }
    let foot = &lines(&run(directory.path(), asked[1]))[0];
    assert_eq!(foot["certified"], true);
}
