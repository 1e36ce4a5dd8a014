//! Exchange with another CAD kernel: OpenCASCADE evaluates what we write, and we what it writes.
//!
//! Files that it wrote are kept in `tests/opencascade/`; the rest runs where Python has it (`pip
//! install cadquery-ocp`; `PALPATE_PYTHON` names another Python than `python3`).

use palpate_geometry::exchange::iges;
use palpate_geometry::exchange::step::{PartPick, read_part, write_part};
use palpate_geometry::exchange::{Format, Pick, read_surface, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::part::Part;
use palpate_geometry::surface::file::{self, Unit};
use palpate_geometry::surface::{Direction, Surface, builtin};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Decimals that OpenCASCADE prints of coordinates (in the file's unit), knots and weights.
const STEP_DECIMALS: f64 = 1e-12;
const IGES_DECIMALS: f64 = 1e-9;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencascade")
}

fn python() -> Option<Command> {
    let name = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&name)
        .args(["-c", "import OCP"])
        .output()
        .is_ok_and(|done| done.status.success());
    has.then(|| {
        let mut command = Command::new(name);
        command.arg(data().join("kernel.py"));
        command
    })
}

fn run(mut command: Command) {
    let done = command.output().unwrap();
    assert!(
        done.status.success(),
        "{command:?}\n{}",
        String::from_utf8_lossy(&done.stderr)
    );
}

fn pairs(value: &Value) -> Vec<[f64; 2]> {
    serde_json::from_value(value.clone()).unwrap()
}

/// Largest distance of the surface's points from those expected, over its size.
fn difference(surface: &Surface, parameters: &[[f64; 2]], points: &Value) -> f64 {
    let points: Vec<[f64; 3]> = serde_json::from_value(points.clone()).unwrap();
    assert_eq!(parameters.len(), points.len());
    let distance = |(&[u, v], [x, y, z]): (&[f64; 2], [f64; 3])| {
        (surface.point(u, v) - Point3::new(x, y, z)).norm()
    };
    parameters
        .iter()
        .zip(points)
        .map(distance)
        .fold(0.0, f64::max)
        / surface.size()
}

/// Reads all files of a directory that `kernel.py write` filled; returns how many.
fn read_all(directory: &Path) -> usize {
    let text = std::fs::read_to_string(directory.join("expected.json")).unwrap();
    let expected: Value = serde_json::from_str(&text).unwrap();
    let mut read = 0;
    for (name, values) in expected.as_object().unwrap() {
        for (ending, format, decimals) in [
            ("step", Format::Step, STEP_DECIMALS),
            ("igs", Format::Iges, IGES_DECIMALS),
        ] {
            let Ok(bytes) = std::fs::read(directory.join(format!("{name}.{ending}"))) else {
                continue;
            };
            let imported = read_surface(&bytes, format, Pick::First)
                .unwrap_or_else(|e| panic!("{name}.{ending}: {e}"));
            let surface = &imported.surface;
            let wanted = if name.ends_with("_inch") {
                "inch"
            } else if name.ends_with("_m") {
                "m"
            } else {
                "mm"
            };
            assert_eq!(
                (imported.count, imported.unit.name()),
                (1, wanted),
                "{name}.{ending}"
            );
            assert_eq!(
                surface.weights().is_some(),
                name.contains("rational"),
                "{name}.{ending}"
            );
            let periodic = [
                surface.knots_u().is_periodic(),
                surface.knots_v().is_periodic(),
            ];
            // Three points make no periodic vector of degree 3: they stay an open one that closes.
            let periodic_wanted = [
                name.starts_with("periodic") && name != "periodic_few",
                name == "periodic_twice",
            ];
            assert_eq!(periodic, periodic_wanted, "{name}.{ending}");
            let closes = name.starts_with("periodic") || name == "clamped_closed";
            assert_eq!(surface.topology().wraps(0), closes, "{name}.{ending}");
            let error = difference(surface, &pairs(&values["parameters"]), &values["points"]);
            println!("{name}.{ending}: {error:.1e}");
            // The last place of coordinates, as a part of the size; and that of knots and weights.
            let printed = decimals * (imported.unit.metres() / surface.size() + 1.0);
            assert!(
                error <= printed,
                "{name}.{ending}: points off by {error} of the size"
            );
            read += 1;
        }
    }
    read
}

#[test]
fn files_that_opencascade_wrote_have_its_points() {
    let read = read_all(&data());
    assert!(read >= 10, "only {read} files are there");
}

#[test]
fn files_that_opencascade_writes_now_have_its_points() {
    let Some(mut command) = python() else {
        println!("skipped: this Python has no OCP (pip install cadquery-ocp)");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    command.arg("write").arg(directory.path());
    run(command);
    assert_eq!(read_all(directory.path()), 24);
}

fn ours() -> Vec<(&'static str, Surface)> {
    let made = |name, net| builtin(name, net, None).unwrap();
    let rational = include_str!("../src/surface/data/teardrop_8_rational.json");
    let torus = made("torus", Some([9, 7]))
        .insert_knots(Direction::U, &[0.31, 0.5, 0.5])
        .unwrap();
    vec![
        ("sheet", made("sheet", None)),
        ("teardrop", made("teardrop", None)),
        ("teardrop_20", made("teardrop", Some([20, 20]))),
        ("rational_teardrop", file::read(rational).unwrap()),
        ("sphere", made("sphere", None)),
        ("torus", made("torus", None)),
        ("uneven_torus", torus),
    ]
}

#[test]
fn opencascade_evaluates_our_files_to_our_points() {
    let Some(mut command) = python() else {
        println!("skipped: this Python has no OCP (pip install cadquery-ocp)");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let mut parameters = serde_json::Map::new();
    let mut written = Vec::new();
    for (name, surface) in ours() {
        let place = |k: usize, (start, end): (f64, f64)| {
            start + (end - start) * ((k as f64 * 0.618_033_988_749_895) % 1.0)
        };
        let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
        let pairs: Vec<[f64; 2]> = (0..60)
            .map(|k| [place(k, u), place(k * k + 3, v)])
            .collect();
        for (ending, format) in [("step", Format::Step), ("igs", Format::Iges)] {
            for unit in [Unit::Metre, Unit::Millimetre] {
                let file = format!("{name}_{}.{ending}", unit.name());
                std::fs::write(at(&file), write_surface(&surface, format, unit).unwrap()).unwrap();
                parameters.insert(file.clone(), serde_json::to_value(&pairs).unwrap());
                written.push((file, surface.clone(), pairs.clone()));
            }
        }
    }
    std::fs::write(at("parameters.json"), Value::Object(parameters).to_string()).unwrap();
    command.arg("points").arg(directory.path());
    run(command);
    let points: Value =
        serde_json::from_str(&std::fs::read_to_string(at("points.json")).unwrap()).unwrap();
    for (file, surface, pairs) in written {
        let error = difference(&surface, &pairs, &points[&file]);
        println!("{file}: {error:.1e}");
        assert!(
            error <= 1e-12,
            "{file}: OpenCASCADE's points are off by {error} of the size"
        );
    }
}

#[test]
fn opencascade_finds_our_parts_valid_and_as_large() {
    let Some(mut command) = python() else {
        println!("skipped: this Python has no OCP (pip install cadquery-ocp)");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
    let mut written = Vec::new();
    for entry in std::fs::read_dir(parts).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "step") {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let read = read_part(&std::fs::read(&path).unwrap(), &PartPick::default()).unwrap();
        let text = write_part(&read.brep, &read.unit, &name).unwrap();
        std::fs::write(directory.path().join(format!("{name}.step")), text).unwrap();
        written.push((name, read));
    }
    assert_eq!(written.len(), 12);
    command.arg("parts").arg(directory.path());
    run(command);
    let text = std::fs::read_to_string(directory.path().join("parts.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    for (name, read) in written {
        let (found, part) = (&found[&name], Part::new(&read.brep).unwrap());
        let measure = part.measure();
        let area_mm2 = measure.face_areas_m2.iter().sum::<f64>() * 1e6;
        let volume_mm3 = measure.volume_m3.unwrap() * 1e9;
        let off = [("volume", volume_mm3), ("area", area_mm2)]
            .map(|(what, ours)| (found[what].as_f64().unwrap() / ours - 1.0).abs());
        println!("{name}: {found}, volume and area off by {off:?}");
        assert_eq!(found["valid"], true, "{name}");
        assert_eq!(found["faces"], part.faces().len(), "{name}");
        assert_eq!(found["solids"], read.solids.len(), "{name}");
        assert!(off.iter().all(|off| *off < 1e-6), "{name}: off by {off:?}");
    }
}

// Faces alone: the format has no solids, so that there is no volume to ask for.
#[test]
fn opencascade_finds_trimmed_surfaces_of_our_parts_as_large() {
    let Some(mut command) = python() else {
        println!("skipped: this Python has no OCP (pip install cadquery-ocp)");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
    let mut written = Vec::new();
    for entry in std::fs::read_dir(parts).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "step") {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let mut read = read_part(&std::fs::read(&path).unwrap(), &PartPick::default()).unwrap();
        let part = read.part(false).unwrap();
        let text = iges::write_part(&part, &read.unit, &name).unwrap();
        std::fs::write(directory.path().join(format!("{name}.igs")), text).unwrap();
        written.push((name, part));
    }
    assert_eq!(written.len(), 12);
    command.arg("parts").arg(directory.path());
    run(command);
    let text = std::fs::read_to_string(directory.path().join("parts.json")).unwrap();
    let found: Value = serde_json::from_str(&text).unwrap();
    for (name, part) in written {
        let found = &found[&name];
        let area_mm2 = part.measure().face_areas_m2.iter().sum::<f64>() * 1e6;
        let off = (found["area"].as_f64().unwrap() / area_mm2 - 1.0).abs();
        println!("{name}: {found}, area off by {off:.1e}");
        assert_eq!(found["faces"], part.faces().len(), "{name}");
        assert!(off < 1e-6, "{name}: off by {off}");
    }
}
