//! Parts of STEP files against references: OpenCASCADE's nearest points, refined from dense samples where it misses them;
//! areas and volumes by Green's theorem along its parameter curves.

use palpate_geometry::exchange::step::{PartPick, read_part};
use palpate_geometry::math::{Point3, Random};
use palpate_geometry::part::{Part, PartSolver, Support};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::PathBuf;

const NAMES: [&str; 12] = [
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
    "turned",
];

fn path(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/parts")
        .join(file)
}

fn part(name: &str) -> Part {
    let bytes = std::fs::read(path(&format!("{name}.step"))).expect("the file");
    let read = read_part(&bytes, &PartPick::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(read.left_out.is_nothing(), "{name}: {}", read.left_out);
    Part::new(&read.brep).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Lengths in mm.
fn reference(name: &str) -> Value {
    let text = std::fs::read_to_string(path(&format!("{name}.json"))).expect("the file");
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn distances_and_sides_are_those_of_the_references() {
    for name in NAMES {
        let (part, data) = (part(name), reference(name));
        let mut solver = PartSolver::new(&part);
        let size_mm = number(&data["size"]);
        // A distance may jump by the gap of an edge where its foot passes from face to face.
        let most_mm = 1e-9 * size_mm + 2e3 * part.gap_m();
        let mut worst_mm = 0.0f64;
        for query in data["queries"].as_array().expect("a list") {
            let [x, y, z, distance_mm] = [0, 1, 2, 4].map(|k| number(&query[k]));
            if query[3] == "disputed" {
                continue;
            }
            let q = Point3::new(x, y, z) * 1e-3;
            let foot = solver.closest(&part, &q).expect("a finite query");
            let off_mm = (foot.distance * 1e3 - distance_mm).abs();
            assert!(off_mm <= most_mm, "{name}: {foot:?} for {query}");
            assert!(foot.certified, "{name}: {foot:?} for {query}");
            assert!(((q - foot.point).norm() - foot.distance).abs() < 1e-15);
            worst_mm = worst_mm.max(off_mm);
            if let (Some(signed), Some(side)) = (foot.signed_distance, query[10].as_str())
                && distance_mm > most_mm
            {
                let right = if side == "in" {
                    signed < 0.0
                } else {
                    signed > 0.0
                };
                assert!(right || side == "on", "{name}: {foot:?} for {query}");
            }
            let clear = query[9] != -1 && query[8] == "face" && query[3] != "edge";
            if let (Support::Face(face), true) = (foot.support, clear && query[3] == "offset") {
                assert_eq!(
                    i64::from(face),
                    query[9].as_i64().expect("a face"),
                    "{name}: {query}"
                );
            }
        }
        println!("{name}: off by {worst_mm:.1e} mm at most, of {most_mm:.1e}");
    }
}

#[test]
fn areas_and_volumes_are_those_of_the_references() {
    for name in NAMES {
        let (part, data) = (part(name), reference(name));
        let measure = part.measure();
        let faces = data["faces"].as_array().expect("a list");
        assert_eq!(part.faces().len(), faces.len(), "{name}");
        let mut worst = 0.0f64;
        for ((face, area_m2), right) in part.faces().zip(&measure.face_areas_m2).zip(faces) {
            let area = number(&right["area"]);
            let off = (area_m2 * 1e6 / area - 1.0).abs();
            // Its own parameter curves are off the edges by so much.
            let slack = number(&right["area_uncertainty"]) / area;
            assert!(
                off <= 1e-6 + slack,
                "{name}, face #{}: {off:e} of {area}",
                face.id
            );
            worst = worst.max(off);
        }
        let volume = data["volume"].as_f64();
        if let (Some(volume), Some(own_m3)) = (volume, measure.volume_m3) {
            let off = (own_m3 * 1e9 / volume - 1.0).abs();
            assert!(off <= 1e-6, "{name}: the volume is off by {off:e}");
        }
        println!("{name}: areas off by {worst:.1e} at most");
        let splines = part.faces().any(|face| face.carrier.name() == "b-spline");
        let off = part.size_m() * 1e3 / number(&data["size"]) - 1.0;
        assert!(
            splines || off.abs() < 1e-3,
            "{name}: the size is off by {off:e}"
        );
    }
}

#[test]
fn triangles_close_and_bound_the_volume() {
    for name in NAMES {
        let part = part(name);
        let tolerance_m = 1e-3 * part.size_m();
        let mesh = part
            .triangles(tolerance_m, 1_000_000)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut sides = std::collections::BTreeMap::new();
        for triangle in &mesh.mesh.triangles {
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                *sides.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        assert!(sides.values().all(|&sum| sum == 0), "{name}: open");
        let volume: f64 = (mesh.mesh.triangles.iter())
            .map(|t| {
                let [a, b, c] = t.map(|k| mesh.mesh.points[k as usize].coords);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        let measure = part.measure();
        let right = measure.volume_m3.expect("closed");
        let most = 2.0 * tolerance_m * measure.area_m2;
        assert!(
            (volume - right).abs() <= most,
            "{name}: {volume} for {right}"
        );
    }
}

/// Files changed at random: another answer or a typed error, never a panic; what is built can be asked.
#[test]
fn changed_files_are_parts_or_errors() {
    let mut random = Random(4545);
    let (mut built, mut refused) = (0, 0);
    for name in ["turned", "pipe", "sphere_minus_boxes", "cone_tip", "thread"] {
        let whole = std::fs::read(path(&format!("{name}.step"))).expect("the file");
        for _ in 0..40 {
            let mut bytes = whole.clone();
            for _ in 0..=random.below(4) {
                let k = random.below(bytes.len());
                // Digits and points most of all: what remains is a file.
                bytes[k] = match bytes[k] {
                    b'0'..=b'9' => b'0' + random.below(10) as u8,
                    b'T' => b'F',
                    b'F' => b'T',
                    other => other,
                };
            }
            let read = read_part(&bytes, &PartPick::default());
            let part = read.ok().and_then(|read| Part::new(&read.brep).ok());
            let Some(part) = part else {
                refused += 1;
                continue;
            };
            built += 1;
            let mut solver = PartSolver::new(&part);
            for _ in 0..20 {
                let q = Point3::from(random.vector() * part.size_m());
                let foot = solver.closest(&part, &q).expect("a finite query");
                assert!(foot.distance.is_finite(), "{foot:?}");
            }
            let _ = part.triangles(0.02 * part.size_m(), 50_000);
        }
    }
    println!("{built} built, {refused} refused");
    assert!(
        built > 20 && refused > 20,
        "{built} built, {refused} refused"
    );
}

/// Rims of a hole that are quarters of tori, between two circles and a seam: which of the two bands between the circles is
/// meant, the seam says, whichever way round a file walks the loops.
#[test]
fn a_seam_lies_in_its_face_whatever_the_sense_of_its_loops() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/bracket.step");
    let text = std::fs::read_to_string(path).expect("the scene's part");
    // Plate, wall, their fillet; less rounded corners, countersunk holes and a hole with rounded rims, mm³.
    let corner = 1.0 - PI / 4.0;
    let rim = 2.0 * PI * (8.0 + (10.0 - 3.0 * PI) / (12.0 - 3.0 * PI)) * corner;
    let sunk = 54.0 * PI + 98.0 / 3.0 * PI - 18.0 * PI;
    let volume = 14_400.0 + 9_360.0 + 1_000.0 * corner
        - 24.0 * 64.0 * corner
        - 2.0 * sunk
        - 384.0 * PI
        - 2.0 * rim;
    for (from, to) in [
        ("", ""),
        ("#90=FACE_BOUND('',#89,.F.)", "#90=FACE_BOUND('',#89,.T.)"),
    ] {
        let edited = text.replace(from, to);
        let read = read_part(edited.as_bytes(), &PartPick::default()).expect("a part");
        let part = Part::new(&read.brep).expect("a part");
        assert!(part.is_closed(), "{:?}", part.senses());
        let measured = part.measure().volume_m3.expect("closed") * 1e9;
        assert!(
            (measured / volume - 1.0).abs() < 1e-9,
            "{measured} for {volume}"
        );
    }
}
