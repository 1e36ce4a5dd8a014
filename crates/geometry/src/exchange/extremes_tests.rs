//! Files whose numbers are replaced by the extremes: what a reader takes is finite in whatever is computed of it and
//! written from it, or it is refused.

use super::testing::{small, surfaces};
use super::*;
use crate::basis::testing::Random;
use crate::surface::{Census, ClosestSolver, Shell};

/// What nobody means: the ends of the numbers, what overflows when squared or cubed, and what is no number.
const EXTREMES: [&str; 14] = [
    "1e308", "-1e308", "1e400", "-1e400", "5e-324", "-5e-324", "1e155", "-1e155", "1e103",
    "1e-200", "1e13", "nan", "inf", "-inf",
];

/// Where a text has numbers: (start, end).
fn numbers(text: &[u8]) -> Vec<(usize, usize)> {
    let is_part =
        |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'+' | b'-' | b'E' | b'e' | b'D');
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let before = at.checked_sub(1).map_or(b' ', |k| text[k]);
        let begins = text[at].is_ascii_digit() || text[at] == b'-' || text[at] == b'.';
        if !begins || before.is_ascii_alphanumeric() || matches!(before, b'#' | b'_' | b'"') {
            at += 1;
            continue;
        }
        let length = text[at..].iter().take_while(|b| is_part(**b)).count();
        if text[at..at + length].iter().any(u8::is_ascii_digit) {
            found.push((at, at + length));
        }
        at += length.max(1);
    }
    found
}

/// The text with one to three of its numbers replaced.
fn replaced(text: &[u8], random: &mut Random) -> (Vec<u8>, String) {
    let places = numbers(text);
    let mut which: Vec<usize> = (0..random.integer(1, 3))
        .map(|_| random.integer(0, places.len() - 1))
        .collect();
    which.sort_unstable_by(|a, b| b.cmp(a));
    which.dedup();
    let (mut changed, mut said) = (text.to_vec(), String::new());
    for k in which {
        let (start, end) = places[k];
        let extreme = EXTREMES[random.integer(0, EXTREMES.len() - 1)];
        said += &format!("number {k} is {extreme}; ");
        changed.splice(start..end, extreme.bytes());
    }
    (changed, said)
}

fn all_finite(what: &str, values: impl IntoIterator<Item = f64>) {
    for value in values {
        assert!(value.is_finite(), "{what}: {value}");
    }
}

/// All that `surface info`, `convert` and queries make of a surface.
fn check_surface(said: &str, surface: &Surface) {
    all_finite(
        said,
        surface.net().points().iter().flat_map(|p| [p.x, p.y, p.z]),
    );
    all_finite(said, [surface.area(), surface.volume(), surface.size()]);
    all_finite(
        said,
        surface.centroid().iter().flat_map(|p| [p.x, p.y, p.z]),
    );
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    for share in [0.0, 0.31, 0.5, 1.0] {
        let at = |(start, end): (f64, f64)| start + share * (end - start);
        let (u, v) = (at(u), at(v));
        let frame = surface.frame(u, v);
        all_finite(said, frame.point.iter().copied());
        for d in [frame.du, frame.dv, frame.duu, frame.duv, frame.dvv] {
            all_finite(said, d.iter().copied());
        }
        all_finite(said, surface.normal(u, v).iter().copied());
        let curvature = surface.curvature(u, v);
        all_finite(
            said,
            curvature.iter().flat_map(|k| [k.mean(), k.gaussian()]),
        );
    }
    let mut solver = ClosestSolver::new(surface);
    for query in [Point3::origin(), Point3::new(0.3, -0.2, 0.1)] {
        let foot = solver.closest(surface, &query);
        all_finite(said, [foot.u, foot.v, foot.distance, foot.signed_distance]);
        all_finite(said, foot.point.iter().chain(foot.normal.iter()).copied());
    }
    for format in [Format::Json, Format::Step, Format::Iges] {
        for unit in [Unit::Metre, Unit::Millimetre] {
            // Refused where the format has no form for it.
            if let Ok(written) = write_surface(surface, format, unit) {
                let again = read_surface(&written, format, Pick::First);
                assert!(
                    again.is_ok(),
                    "{said}: written as {format:?}, then refused: {again:?}"
                );
            }
        }
    }
    if let Ok(mesh) = surface.tessellated([2; 2]) {
        check_mesh(said, &mesh);
    }
}

/// All that fits and writers make of triangles.
fn check_mesh(said: &str, mesh: &Mesh) {
    all_finite(said, mesh.points.iter().flat_map(|p| [p.x, p.y, p.z]));
    all_finite(said, mesh.normals.iter().flat_map(|n| [n.x, n.y, n.z]));
    if let Some(shell) = Shell::of(mesh) {
        let Census {
            area_m2,
            volume_m3,
            size_m,
            ..
        } = shell.census();
        all_finite(said, [area_m2, volume_m3, size_m]);
    }
    for format in [Format::Stl, Format::Obj, Format::Glb] {
        if let Ok(written) = write_mesh(mesh, format, Unit::Millimetre) {
            let again = read_mesh(&written, format, Unit::Millimetre);
            assert!(
                again.is_ok(),
                "{said}: written as {format:?}, then refused: {again:?}"
            );
        }
    }
}

#[test]
fn surfaces_of_files_with_extreme_numbers_are_refused_or_finite() {
    let placed = |name: &str| {
        let path = format!("{}/tests/opencascade/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read(path).unwrap()
    };
    let mut files: Vec<(Format, Vec<u8>)> =
        ["placed_once.step", "placed_nested.step", "plain_inch.step"]
            .map(|name| (Format::Step, placed(name)))
            .into();
    files.push((Format::Iges, placed("plain_inch.igs")));
    let all = surfaces();
    let shapes = [&small(false), &small(true), &all[5].1, &all[7].1];
    for shape in shapes {
        for format in [Format::Json, Format::Step, Format::Iges] {
            files.push((format, write_surface(shape, format, Unit::Metre).unwrap()));
        }
    }
    let mut taken = 0;
    for (k, (format, file)) in files.iter().enumerate() {
        let mut random = Random(k as u64 + 1);
        for _ in 0..60 {
            let (changed, said) = replaced(file, &mut random);
            let said = format!("file {k} ({format:?}): {said}");
            if let Ok(read) = read_surface(&changed, *format, Pick::First) {
                taken += 1;
                check_surface(&said, &read.surface);
            }
        }
    }
    assert!(taken > 100, "only {taken} files were taken at all");
}

#[test]
fn parts_of_files_with_extreme_numbers_are_refused_or_finite() {
    let mut taken = 0;
    for (k, name) in ["turned", "cone_tip", "filleted_box"]
        .into_iter()
        .enumerate()
    {
        let path = format!(
            "{}/tests/data/parts/{name}.step",
            env!("CARGO_MANIFEST_DIR")
        );
        let file = std::fs::read(path).unwrap();
        let mut random = Random(k as u64 + 31);
        for _ in 0..120 {
            let (changed, said) = replaced(&file, &mut random);
            let said = format!("{name}: {said}");
            let Ok(mut read) = step::read_part(&changed, &step::PartPick::default()) else {
                continue;
            };
            let Ok(part) = read.part(false) else {
                continue;
            };
            taken += 1;
            let measured = part.measure();
            let volume_m3 = measured.volume_m3.unwrap_or(0.0);
            all_finite(&said, measured.face_areas_m2);
            all_finite(&said, [volume_m3, part.size_m(), part.gap_m()]);
            let mut solver = crate::part::PartSolver::new(&part);
            let (low, high) = part.bounds();
            let foot = solver.closest(&part, &(low + (high - low) * 0.3)).unwrap();
            all_finite(&said, [foot.distance, foot.point.x, foot.normal.x]);
        }
    }
    assert!(taken > 40, "only {taken} files were taken at all");
}

#[test]
fn meshes_and_points_of_files_with_extreme_numbers_are_refused_or_finite() {
    let mesh = surfaces()[5].1.tessellated([1; 2]).unwrap();
    let (mut taken, mut random) = (0, Random(77));
    let ascii = mesh::write_stl_ascii(&mesh, Unit::Metre)
        .unwrap()
        .into_bytes();
    let points: Vec<String> = mesh
        .points
        .iter()
        .map(|p| format!("{} {} {}", p.x, p.y, p.z))
        .collect();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{}\n3 0 1 2\n",
        points.len(),
        points.join("\n")
    );
    let texts = [
        (Format::Stl, ascii),
        (
            Format::Obj,
            write_mesh(&mesh, Format::Obj, Unit::Metre).unwrap(),
        ),
        (Format::Ply, ply.into_bytes()),
        (Format::Points, points.join("\n").into_bytes()),
    ];
    let mut try_it = |format: Format, bytes: &[u8], said: &str| {
        let said = format!("{format:?}: {said}");
        if format != Format::Points
            && let Ok(mesh) = read_mesh(bytes, format, Unit::Millimetre)
        {
            taken += 1;
            check_mesh(&said, &mesh);
        }
        if let Ok(points) = read_points(bytes, format, Unit::Millimetre) {
            all_finite(&said, points.iter().flat_map(|p| [p.x, p.y, p.z]));
        }
    };
    for (format, text) in &texts {
        for _ in 0..60 {
            let (changed, said) = replaced(text, &mut random);
            try_it(*format, &changed, &said);
        }
    }
    let extremes = [f32::MAX, f32::MIN, f32::INFINITY, f32::NAN, 1e-45, 1e19];
    for format in [Format::Stl, Format::Glb] {
        let file = write_mesh(&mesh, format, Unit::Metre).unwrap();
        for _ in 0..300 {
            let mut changed = file.clone();
            let word = random.integer(21, file.len() / 4 - 1);
            // Behind the header of an STL file floats begin at an even place.
            let at = (4 * word).min(file.len() - 4);
            let extreme = extremes[random.integer(0, extremes.len() - 1)];
            changed[at..at + 4].copy_from_slice(&extreme.to_le_bytes());
            try_it(format, &changed, &format!("word {word} is {extreme}"));
        }
    }
    assert!(taken > 100, "only {taken} files were taken at all");
}

#[test]
fn an_assembly_with_a_place_that_is_none_is_refused_and_says_where() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/opencascade/placed_once.step"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let whole = read_surface(text.as_bytes(), Format::Step, Pick::First).unwrap();
    let mut refused = 0;
    // Every point and direction of a placement, each made something that cannot be meant.
    for line in text
        .lines()
        .filter(|line| line.contains("AXIS2_PLACEMENT_3D"))
    {
        for reference in line.split('#').skip(2) {
            let id = reference.trim_end_matches(|c: char| !c.is_ascii_digit());
            let start = text.find(&format!("#{id} = ")).unwrap();
            let line = &text[start..start + text[start..].find(';').unwrap()];
            let open = line.rfind('(').unwrap();
            for bad in ["1.E400,0.,0.", "1.E300,0.,0.", "0.,0.,0."] {
                let changed = text.replace(line, &format!("{}({bad}))", &line[..open]));
                match read_surface(changed.as_bytes(), Format::Step, Pick::First) {
                    Ok(read) => check_surface(&format!("#{id} is {bad}"), &read.surface),
                    Err(error) => {
                        refused += 1;
                        let words = error.to_string();
                        assert!(words.contains('#') || words.contains("line"), "{words}");
                    }
                }
            }
        }
    }
    assert!(refused > 3, "{refused}");
    check_surface("as it was", &whole.surface);
}
