//! The parts suite: closest points of STEP parts, with their error and their time, beside OpenCASCADE where
//! `PALPATE_PYTHON` names a Python that can import `OCP`; and a ball slid over them, and solids pressed on them, in the loop.

mod picture;
mod press;
mod slide;

pub use self::picture::parts_picture;

use super::measure::{Times, clocked, time};
use super::{Cases, Effort, Row};
use crate::peers::python;
use palpate_geometry::exchange::Format;
use palpate_geometry::exchange::step::{PartPick, read_part};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::part::{Part, PartSolver};
use palpate_geometry::surface::WarmFoot;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

const SCRIPT: &str = include_str!("../../../benches/peers/parts.py");

/// A STEP file and its reference, mm.
struct Input {
    name: &'static str,
    step: &'static str,
    reference: &'static str,
}

macro_rules! inputs {
    ($($name:literal),*) => {
        [$(Input {
            name: $name,
            step: include_str!(concat!("../../geometry/tests/data/parts/", $name, ".step")),
            reference: include_str!(concat!("../../geometry/tests/data/parts/", $name, ".json")),
        }),*]
    };
}

/// What OpenCASCADE prints.
#[derive(serde::Deserialize)]
struct Peer {
    seconds: Vec<f64>,
    distances: Vec<f64>,
}

/// Of `scenes/bracket.toml`.
const BRACKET: &str = include_str!("../../../scenes/bracket.step");

/// Parts that solid tools are pressed on.
const PRESSED: [&str; 3] = ["filleted_box", "text_cut", "bracket"];

/// Runs cases `closest/<part>`, `slide/<part>` and `press/<part>`. Each row is handed out as soon as it is measured.
pub fn parts(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) {
    let all = inputs![
        "assembly",
        "cone_tip",
        "filleted_box",
        "loft",
        "pipe",
        "saddle",
        "seam_cut",
        "shelled_box",
        "sphere_minus_boxes",
        "text_cut",
        "thread",
        "turned"
    ];
    for input in &all {
        let case = format!("closest/{}", input.name);
        if cases.has(&case) {
            one(effort, input, &case, out);
        }
    }
    let touched = all.iter().map(|input| (input.name, input.step));
    for (name, step) in touched.chain([("bracket", BRACKET)]) {
        let case = format!("slide/{name}");
        if cases.has(&case) {
            let row = Row::new("parts", case, "palpate");
            out(slide::slide(effort, step, row));
        }
        let case = format!("press/{name}");
        for tool in press::TOOLS {
            if PRESSED.contains(&name) && cases.has(&case) {
                out(press::press(
                    effort,
                    step,
                    tool,
                    Row::new("parts", &case, tool.0),
                ));
            }
        }
    }
}

/// What opens of the STEP files of a folder, a line each, and the sums.
///
/// # Errors
/// The folder or a file cannot be read.
pub fn census(folder: &Path) -> anyhow::Result<String> {
    let mut paths: Vec<_> = std::fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()?;
    paths.retain(|path| matches!(Format::of(path), Ok(Format::Step)));
    paths.sort();
    let (mut text, mut opened, mut faces) = (String::new(), 0, 0);
    for path in &paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let bytes = std::fs::read(path)?;
        let (took, made) = clocked(|| {
            let read = read_part(&bytes, &PartPick::default()).map_err(|e| e.to_string())?;
            let part = Part::new(&read.brep).map_err(|e| e.to_string())?;
            Ok::<_, String>((read.left_out, part))
        });
        let ms = took.as_secs_f64() * 1e3;
        let said = match made {
            Err(error) => error,
            Ok((left_out, part)) => {
                opened += 1;
                faces += part.faces().len();
                let gap = part.gap_m() / part.size_m();
                let count = part.faces().len();
                format!(
                    "{count:>5} faces, gap {gap:.1e} of the size, {ms:.1} ms, left out: {left_out}"
                )
            }
        };
        let _ = writeln!(text, "{name:<24} {said}");
    }
    let _ = writeln!(
        text,
        "{opened} of {} files open, {faces} faces",
        paths.len()
    );
    Ok(text)
}

fn one(effort: Effort, input: &Input, case: &str, out: &mut dyn FnMut(Row)) {
    let row = |method: &str| Row::new("parts", case, method);
    let (took, built) = clocked(|| {
        let read = read_part(input.step.as_bytes(), &PartPick::default());
        read.map_err(|e| e.to_string())
            .and_then(|read| Part::new(&read.brep).map_err(|e| e.to_string()))
    });
    let part = match built {
        Ok(part) => part,
        Err(error) => return out(row("palpate").saying(error)),
    };
    let data: serde_json::Value = serde_json::from_str(input.reference).unwrap_or_default();
    let queries = data["queries"].as_array().map_or(&[][..], Vec::as_slice);
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
    let points_mm: Vec<[f64; 3]> = (queries.iter())
        .map(|q| [0, 1, 2].map(|k| number(&q[k])))
        .collect();
    let size_mm = number(&data["size"]);
    let most_mm = 1e-9 * size_mm + 2e3 * part.gap_m();
    let mut solver = PartSolver::new(&part);
    let (mut worst_mm, mut wrong) = (0.0f64, 0);
    let calls = if effort == Effort::Quick {
        200
    } else {
        queries.len()
    };
    let times = time(calls, Duration::from_secs(5), |k| {
        let q = Point3::from(points_mm[k]) * 1e-3;
        let (took, foot) = clocked(|| solver.closest(&part, &q));
        let distance_mm = foot.map_or(f64::NAN, |foot| foot.distance * 1e3);
        let signed = foot.and_then(|foot| foot.signed_distance);
        if queries[k][3] != "disputed" {
            let off_mm = (distance_mm - number(&queries[k][4])).abs();
            worst_mm = worst_mm.max(off_mm);
            let side = match queries[k][10].as_str() {
                Some("in") => signed.is_some_and(|d| d > 0.0),
                Some("out") => signed.is_some_and(|d| d < 0.0),
                _ => false,
            };
            wrong +=
                usize::from(off_mm > most_mm || off_mm.is_nan() || side && distance_mm > most_mm);
        }
        took
    });
    let measure = part.measure();
    let volume = measure
        .volume_m3
        .map(|v| v * 1e9 / number(&data["volume"]) - 1.0);
    let area = measure.area_m2 * 1e6 / number(&data["area"]) - 1.0;
    out(Row {
        wrong: Some(wrong),
        ..row("palpate")
            .timed(times)
            .off_by(worst_mm / size_mm, "of the size")
            .saying(format!(
                "{} faces, gap {:.0e} of the size, area {:.0e}, volume {:.0e} off, read in {:.1} ms",
                part.faces().len(),
                part.gap_m() / part.size_m(),
                area.abs(),
                volume.unwrap_or(f64::NAN).abs(),
                took.as_secs_f64() * 1e3
            ))
    });
    out(warm(&part, calls, row("palpate warm")));
    let asked = serde_json::json!({ "step": input.step, "points": points_mm[..calls] });
    if let Some(answer) = python::answer::<Peer>(SCRIPT, &asked) {
        let peer = Row {
            peer: true,
            ..row("OpenCASCADE")
        };
        out(match answer {
            Err(error) => peer.saying(error),
            Ok(found) => {
                let offs = found
                    .distances
                    .iter()
                    .zip(queries)
                    .filter(|(_, q)| q[3] != "disputed");
                let offs: Vec<f64> = offs.map(|(d, q)| (d - number(&q[4])).abs()).collect();
                Row {
                    wrong: Some(offs.iter().filter(|&&off| off > most_mm).count()),
                    ..peer.timed(Times::of(found.seconds)).off_by(
                        offs.iter().copied().fold(0.0, f64::max) / size_mm,
                        "of the size",
                    )
                }
            }
        });
    }
}

/// Warm queries along a smooth path that keeps within a twentieth of the size of the part, at 20 to 200 mm/s and 1 kHz.
/// Wrong are those whose distance is not that of the cold query, to 1e-12 of the size.
fn warm(part: &Part, calls: usize, row: Row) -> Row {
    let size_m = part.size_m();
    let (mut cold, mut solver) = (PartSolver::new(part), PartSolver::new(part));
    let mut random = Random(20);
    let (low, high) = part.bounds();
    let mut q = high;
    let (mut last, mut heading) = (q, (low - high).normalize());
    let mut foot = WarmFoot::default();
    let (mut worst_m, mut wrong) = (0.0f64, 0);
    let times = time(calls, Duration::from_secs(5), |_| {
        heading = (heading + 0.2 * random.vector())
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::x);
        q += heading * random.float(2e-5, 2e-4);
        if let Some(near) = cold.closest(part, &q)
            && near.distance > 0.05 * size_m
        {
            // Back towards the part.
            heading = (near.point - q) / near.distance;
        }
        let moved_m = (q - last).norm();
        last = q;
        let (took, found) = clocked(|| solver.closest_warm_moved(part, &q, moved_m, &mut foot));
        let right = cold.closest(part, &q);
        let off_m = match (found, right) {
            (Some(found), Some(right)) => (found.distance - right.distance).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        worst_m = worst_m.max(off_m);
        wrong += usize::from(off_m.is_nan() || off_m > 1e-12 * size_m);
        took
    });
    Row {
        wrong: Some(wrong),
        ..row
            .timed(times)
            .off_by(worst_m / size_m, "of the size, from the cold query")
    }
}
