//! Parts written and read back: those of files, and by hand.

use super::*;
use crate::basis::KnotVector;
use crate::exchange::LengthUnit;
use crate::math::{Matrix3, Point3, Random, Vector3};
use crate::part::hand::{self, FILES, Maker, axes};
use crate::part::{Brep, BrepBound, BrepCurve, BrepShell, Carrier, Part, PartSolver, Placing};
use crate::surface::file::Unit;
use crate::surface::{Curve, builtin};

/// Of the size.
const SAME: f64 = 1e-12;

fn read(bytes: &[u8]) -> ImportedPart {
    let read = read_part(bytes, &PartPick::default()).unwrap();
    assert!(read.left_out.is_nothing(), "{}", read.left_out);
    read
}

fn assert_same(name: &str, before: &Brep, after: &Brep) {
    let (a, b) = (Part::new(before).unwrap(), Part::new(after).unwrap());
    let kinds = |part: &Part| -> Vec<(&'static str, usize)> {
        let faces = part.faces();
        faces
            .map(|face| (face.carrier.name(), face.loops))
            .collect()
    };
    assert_eq!(kinds(&a), kinds(&b), "{name}");
    assert_eq!(a.edge_count(), b.edge_count(), "{name}");
    assert_eq!(a.is_closed(), b.is_closed(), "{name}");
    assert_eq!(a.turned_faces(), b.turned_faces(), "{name}");
    let sizes = |brep: &Brep| (brep.faces.len(), brep.shells.clone());
    assert_eq!(sizes(before), sizes(after), "{name}");
    let (one, other) = (a.measure(), b.measure());
    let pairs = one.face_areas_m2.iter().zip(&other.face_areas_m2);
    let mut worst = 0.0f64;
    for (face, (x, y)) in pairs.enumerate() {
        worst = worst.max((x / y - 1.0).abs());
        assert!((x / y - 1.0).abs() < SAME, "{name}, face {face}: {x} {y}");
    }
    match (one.volume_m3, other.volume_m3) {
        (Some(x), Some(y)) => assert!((x / y - 1.0).abs() < SAME, "{name}: {x} {y}"),
        (x, y) => assert_eq!(x, y, "{name}"),
    }
    let size_m = a.size_m();
    let [(low, high), (low_b, high_b)] = [a.bounds(), b.bounds()];
    let off_m = (low - low_b).amax().max((high - high_b).amax());
    assert!(off_m <= SAME * size_m, "{name}: bounds off by {off_m} m");
    let mut random = Random(7);
    let mut solvers = [PartSolver::new(&a), PartSolver::new(&b)];
    let mut farthest = 0.0f64;
    for _ in 0..200 {
        let q = (low - Vector3::repeat(0.2 * size_m))
            + (high - low + Vector3::repeat(0.4 * size_m)).map(|side| side * random.unit());
        let [x, y] = [(&a, 0), (&b, 1)].map(|(part, k)| solvers[k].closest(part, &q).unwrap());
        let off_m = (x.distance - y.distance).abs();
        farthest = farthest.max(off_m / size_m);
        assert!(off_m <= SAME * size_m, "{name}: {x:?} {y:?}");
        let signs = [x, y].map(|foot| foot.signed_distance.map(|d| d < 0.0));
        assert_eq!(signs[0], signs[1], "{name}: {x:?} {y:?}");
    }
    println!("{name}: areas {worst:.0e}, distances {farthest:.0e} of the size");
}

/// Writes, reads, compares; and a second time the file is the same.
fn round_trip(name: &str, brep: &Brep, unit: &LengthUnit) -> (String, Brep) {
    let text = write_part(brep, unit, name).unwrap();
    let back = read(text.as_bytes());
    assert_same(name, brep, &back.brep);
    assert_eq!(back.unit.name(), unit.name());
    let again = write_part(&back.brep, &back.unit, name).unwrap();
    assert!(text == again, "{name}: the second file differs");
    let last = read(again.as_bytes());
    assert_eq!(last.brep, back.brep, "{name}");
    (text, back.brep)
}

fn millimetres() -> LengthUnit {
    Unit::Millimetre.into()
}

#[test]
fn parts_of_files_are_the_same_after_writing() {
    for name in FILES {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
        let bytes = std::fs::read(path.join(format!("{name}.step"))).unwrap();
        let imported = read(&bytes);
        let (text, back) = round_trip(name, &imported.brep, &imported.unit);
        // What stands where its file has it is so to the last bit.
        if name != "assembly" {
            let mut faces = imported.brep.faces.iter().zip(&back.faces);
            let same = faces.all(|(a, b)| a.carrier == b.carrier && a.same_sense == b.same_sense);
            assert!(same, "{name}: a surface differs");
        }
        let splines = imported.brep.faces.iter();
        let splines = splines
            .filter(|face| face.carrier.name() == "b-spline")
            .count();
        assert_eq!(text.contains("=PCURVE("), splines > 0, "{name}");
        for unit in [Unit::Metre, Unit::Millimetre] {
            let text = write_part(&imported.brep, &unit.into(), name).unwrap();
            assert_same(name, &imported.brep, &read(text.as_bytes()).brep);
        }
    }
}

/// A box within a box.
fn hollow() -> Brep {
    let mut outer = hand::prism(&[[0.0, 0.0], [0.03, 0.0], [0.03, 0.02], [0.0, 0.02]], 0.01);
    let inner = hand::prism(&[[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]], 0.004);
    let placing = Placing {
        shift: Vector3::new(0.007, 0.005, 0.003),
        ..Placing::default()
    };
    let mut inner = inner.placed(&placing).unwrap();
    // It looks into itself.
    for face in &mut inner.faces {
        face.same_sense = !face.same_sense;
        for bound in &mut face.bounds {
            if let BrepBound::Loop(uses) = bound {
                uses.reverse();
                uses.iter_mut()
                    .for_each(|(_, forward)| *forward = !*forward);
            }
        }
    }
    outer.add(inner);
    outer
        .shells
        .iter_mut()
        .for_each(|shell| shell.solid = Some(0));
    outer
}

fn sheet() -> Brep {
    let mut brep = hand::drilled();
    brep.faces.truncate(3);
    brep.shells = vec![BrepShell {
        faces: vec![0, 1, 2],
        closed: false,
        solid: None,
    }];
    brep
}

fn ball_with_vertex() -> Brep {
    let mut brep = hand::whole(Carrier::Sphere {
        axes: axes([0.01, 0.02, 0.03], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]),
        radius_m: 0.01,
    });
    let Carrier::Sphere { axes, radius_m } = brep.faces[0].carrier.clone() else {
        unreachable!()
    };
    brep.vertices.push(axes.origin + axes.z * radius_m);
    brep.faces[0].bounds.push(BrepBound::Vertex(0));
    brep
}

fn torus(major_m: f64, minor_m: f64) -> Brep {
    hand::whole(Carrier::Torus {
        axes: axes([0.01, 0.02, 0.03], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]),
        major_m,
        minor_m,
    })
}

/// With the vertices where it meets its axis, without which nothing is nearest above them.
fn apple() -> Brep {
    let mut brep = torus(0.01, 0.02);
    let Carrier::Torus { axes, .. } = brep.faces[0].carrier.clone() else {
        unreachable!()
    };
    let up = axes.z * 3e-4f64.sqrt();
    brep.vertices = vec![axes.origin - up, axes.origin + up];
    brep.faces[0].bounds = vec![BrepBound::Vertex(0), BrepBound::Vertex(1)];
    brep
}

fn mirrored(brep: &Brep) -> Brep {
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    let turn = crate::math::Rotation::from_euler_angles(0.3, -0.7, 1.9);
    let placing = Placing {
        turn: turn.to_rotation_matrix().into_inner() * mirror,
        scale: 1.0,
        shift: Vector3::new(0.1, 1.0 / 3.0, -0.2),
    };
    brep.placed(&placing).unwrap()
}

/// Pieces of a plane, each between a curve and its chord.
fn segments() -> Brep {
    let mut maker = Maker::default();
    let frame = |x: f64| axes([x, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let arc = |x: f64| {
        let points = [[0.01, 0.0], [0.01, 0.01], [0.0, 0.01]];
        let points = points.map(|[a, b]| Point3::new(x + a, b, 0.0)).to_vec();
        let knots = KnotVector::clamped_uniform(2, 3).unwrap();
        BrepCurve::Spline(Curve::new(knots, points, Some(vec![1.0, 0.7, 1.0])).unwrap())
    };
    let radii_m = [0.02, 0.01];
    let (cosh, sinh) = (1f64.cosh(), 1f64.sinh());
    let cases = [
        (frame(0.0), [[0.02, 0.0], [0.0, 0.01]]),
        (
            frame(0.1),
            [[0.02 * cosh, -0.01 * sinh], [0.02 * cosh, 0.01 * sinh]],
        ),
        (frame(0.2), [[0.01, -0.02], [0.01, 0.02]]),
        (frame(0.3), [[0.01, 0.0], [0.0, 0.01]]),
    ];
    for (k, (axes, [a, b])) in cases.into_iter().enumerate() {
        let curve = match k {
            0 => BrepCurve::Ellipse { axes, radii_m },
            1 => BrepCurve::Hyperbola { axes, radii_m },
            2 => BrepCurve::Parabola {
                axes,
                focal_m: 0.01,
            },
            _ => arc(0.3),
        };
        let [a, b] = [a, b].map(|[x, y]| [axes.origin.x + x, y, 0.0]);
        let ends = [maker.vertex(a), maker.vertex(b)];
        let bow = maker.edge(curve, ends);
        let chord = maker.line(b, a);
        let walk = match k {
            1 | 2 => vec![(chord.0, !chord.1), (bow, false)],
            _ => vec![(bow, true), chord],
        };
        maker.face(Carrier::Plane(frame(0.0)), true, vec![walk]);
    }
    let mut brep = maker.solid();
    brep.shells = (0..4)
        .map(|face| BrepShell {
            faces: vec![face],
            closed: false,
            solid: None,
        })
        .collect();
    brep
}

fn of_file(name: &str) -> Brep {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
    read(&std::fs::read(path.join(name)).unwrap()).brep
}

#[test]
fn parts_by_hand_are_the_same_after_writing() {
    let organ = |name| {
        hand::whole(Carrier::Spline(Box::new(
            builtin(name, None, None).unwrap(),
        )))
    };
    let mut both = hand::cylinder(0.01, 0.02);
    both.add(sheet());
    let cases = [
        ("drilled", hand::drilled()),
        ("sheet", sheet()),
        ("segments", segments()),
        ("void", hollow()),
        ("ball", ball_with_vertex()),
        ("cone", hand::cone()),
        ("dome", hand::dome()),
        ("bend", hand::bend()),
        ("ring", torus(0.02, 0.005)),
        ("apple", apple()),
        ("teardrop", organ("teardrop")),
        ("solid and sheet", both),
        ("mirrored cone", mirrored(&hand::cone())),
        ("mirrored bend", mirrored(&hand::bend())),
        ("mirrored loft", mirrored(&of_file("loft.step"))),
        ("mirrored turned", mirrored(&of_file("turned.step"))),
    ];
    for (name, brep) in cases {
        for unit in [Unit::Metre, Unit::Millimetre] {
            round_trip(name, &brep, &unit.into());
        }
    }
}

#[test]
fn faces_without_bounds_get_vertices_or_seams() {
    let text = |brep: &Brep| write_part(brep, &millimetres(), "whole").unwrap();
    // Of an apple those of its ends.
    assert_eq!(text(&torus(0.01, 0.02)), text(&apple()));
    let ring = text(&torus(0.02, 0.005));
    assert_eq!(ring.matches("=EDGE_CURVE(").count(), 2);
    assert_eq!(ring.matches("=ORIENTED_EDGE(").count(), 4);
}

#[test]
fn shared_entities_are_written_once_and_units_and_names_are_those_given() {
    let text = write_part(&hand::drilled(), &millimetres(), "Bohrung \u{d8} 8 'a\\b'").unwrap();
    for (entity, count) in [
        ("EDGE_CURVE", 15),
        ("VERTEX_POINT", 10),
        ("ADVANCED_FACE", 7),
        ("ADVANCED_BREP_SHAPE_REPRESENTATION", 1),
        ("MANIFOLD_SOLID_BREP", 1),
        // Six along the axes, and no others.
        ("DIRECTION", 6),
    ] {
        let found = text.matches(&format!("={entity}(")).count();
        assert_eq!(found, count, "{entity}");
    }
    assert!(text.is_ascii());
    assert_eq!(
        read(text.as_bytes()).solids[0].name,
        "Bohrung \u{d8} 8 'a\\b'"
    );
    let units = [
        (LengthUnit::of_metres("INCH", 0.0254, 1.0), "inch"),
        (LengthUnit::of_metres("centimetre", 1e-2, 1.0), "cm"),
        (LengthUnit::of_metres("foot", 0.3048, 1.0), "mm"),
    ];
    for (unit, name) in units {
        let text = write_part(&hand::drilled(), &unit, "").unwrap();
        let back = read(text.as_bytes());
        assert_eq!(back.unit.name(), name);
        assert_same(name, &hand::drilled(), &back.brep);
        assert!(
            write_part(&back.brep, &back.unit, "").unwrap() == text,
            "{name}"
        );
    }
}

#[test]
fn lengths_read_back_bit_for_bit_where_the_unit_has_them() {
    let mut random = Random(5);
    for unit in [
        LengthUnit::of_metres("mm", 1.0, 1e3),
        LengthUnit::of_metres("inch", 25.4, 1e3),
        LengthUnit::of_metres("cm", 1.0, 1e2),
    ] {
        assert_eq!(unit.of_length(unit.to_metres(12.3)), 12.3);
        for _ in 0..20_000 {
            let scale = random.float(-6.0, 4.0).exp2();
            let value = random.signed() * scale;
            let metres = unit.to_metres(value);
            assert_eq!(unit.to_metres(unit.of_length(metres)), metres, "{value}");
            let other = unit.of_length(value);
            assert_eq!(unit.of_length(unit.to_metres(other)), other, "{value}");
            assert!((unit.to_metres(other) - value).abs() <= value.abs() * f64::EPSILON);
        }
    }
}

#[test]
fn a_curve_that_comes_apart_is_refused_with_its_edge() {
    let mut brep = segments();
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0]).unwrap();
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [2.0, 0.0]];
    let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    brep.edges[0].curve = BrepCurve::Spline(Curve::new(knots, points, None).unwrap());
    let error = write_part(&brep, &millimetres(), "").unwrap_err();
    assert_eq!(error, WritePartError::Edge { id: 100, knot: 1.0 });
    assert!(
        error
            .to_string()
            .starts_with("edge #100: its curve is separated at t = 1")
    );
}
