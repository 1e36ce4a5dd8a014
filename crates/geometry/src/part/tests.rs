//! Boundaries by hand, against closed forms and brute force.

mod senses;

use super::hand::{Maker, axes, bend, cone, dome, drilled, prism, whole};
use super::*;
use crate::math::{Matrix3, Point3, Random, Vector3};
use std::f64::consts::PI;

#[test]
fn areas_and_volumes_are_those_of_closed_forms() {
    let frame = axes([0.01, 0.02, 0.03], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]);
    let r = 0.008;
    let cases = [
        (
            "drilled",
            drilled(),
            0.06 * 0.04 * 0.02 - PI * r * r * 0.02,
            2.0 * (0.0024 - PI * r * r) + 0.2 * 0.02 + 2.0 * PI * r * 0.02,
        ),
        (
            "cone",
            cone(),
            PI * 1e-6 / 3.0,
            PI * 1e-4 * (1.0 + 2f64.sqrt()),
        ),
        ("dome", dome(), 2.0 / 3.0 * PI * 1e-6, 3.0 * PI * 1e-4),
        (
            "bend",
            bend(),
            0.25 * 2.0 * PI * PI * 0.02 * 25e-6,
            PI * PI * 0.02 * 0.005 + 2.0 * PI * 25e-6,
        ),
        (
            "ball",
            whole(Carrier::Sphere {
                axes: frame,
                radius_m: 0.01,
            }),
            4.0 / 3.0 * PI * 1e-6,
            4.0 * PI * 1e-4,
        ),
        (
            "apple",
            whole(Carrier::Torus {
                axes: frame,
                major_m: 0.01,
                minor_m: 0.02,
            }),
            2.0 * PI / 3.0 * 9e-4 * 3e-4f64.sqrt() + 2.0 * PI * 4e-6 * (PI - 0.5f64.acos()),
            4.0 * PI * 0.02 * (3e-4f64.sqrt() + 0.01 * (PI - 0.5f64.acos())),
        ),
        (
            "ring",
            whole(Carrier::Torus {
                axes: frame,
                major_m: 0.02,
                minor_m: 0.005,
            }),
            2.0 * PI * PI * 0.02 * 25e-6,
            4.0 * PI * PI * 0.02 * 0.005,
        ),
    ];
    let mut random = Random(45);
    for (name, brep, volume, area) in cases {
        for turn in 0..8 {
            let rotation = random.rotation().to_rotation_matrix().into_inner();
            let mirror = if turn % 2 == 1 {
                Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0))
            } else {
                Matrix3::identity()
            };
            let placing = Placing {
                turn: rotation * mirror,
                scale: 1.0 + f64::from(turn),
                shift: random.vector() * 0.1,
            };
            let part = Part::new(&brep.placed(&placing).expect("in range"))
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            let s = placing.scale;
            let measure = part.measure();
            let off = (measure.area_m2 / (area * s * s) - 1.0).abs();
            assert!(off < 1e-12, "{name}, {turn}: area off by {off:e}");
            let off = (measure.volume_m3.expect("closed") / (volume * s * s * s) - 1.0).abs();
            assert!(off < 1e-11, "{name}, {turn}: volume off by {off:e}");
            assert!(part.gap_m() < 1e-15 * s, "{name}: {:e}", part.gap_m());
        }
    }
}

// Edges of 5e11 m whose lines miss their corners by 2e-4 of that: what is integrated between them took a step a metre.
#[test]
fn what_is_very_large_is_measured_at_once() {
    let placing = Placing {
        scale: 1e13,
        ..Placing::default()
    };
    let square = [[0.0, 0.0], [0.05, 0.0], [0.05, 0.05], [0.0, 0.05]];
    let mut brep = prism(&square, 0.05).placed(&placing).expect("in range");
    for edge in &mut brep.edges {
        if let BrepCurve::Line { direction, .. } = &mut edge.curve {
            *direction = (*direction + Vector3::new(1.0, 2.0, 3.0) * 1e-4).normalize();
        }
    }
    let part = Part::new(&brep).expect("a part");
    let off = part.measure().area_m2 / (6.0 * 25e22) - 1.0;
    assert!(off.abs() < 1e-3, "{off:e}");
}

/// Signed distances of the shapes above.
fn distance(name: &str, p: &Point3) -> f64 {
    let rho = p.x.hypot(p.y);
    match name {
        "drilled" => {
            let slab = |x: f64, w: f64| (x - 0.5 * w).abs() - 0.5 * w;
            let (a, b, c) = (slab(p.x, 0.06), slab(p.y, 0.04), slab(p.z, 0.02));
            let hole = 0.008 - (p.x - 0.03).hypot(p.y - 0.02);
            // Inside the hole: to its wall, or to the circle at its end.
            if hole > 0.0 {
                return hole.hypot(c.max(0.0));
            }
            let outside = Vector3::new(a.max(0.0), b.max(0.0), c.max(0.0)).norm();
            if outside > 0.0 {
                outside
            } else {
                a.max(b).max(c).max(hole)
            }
        }
        "dome" => {
            if p.z >= 0.0 {
                (p.coords.norm() - 0.01).max(-p.z)
            } else if rho <= 0.01 {
                -p.z
            } else {
                (rho - 0.01).hypot(p.z)
            }
        }
        "cone" => {
            let (side, t) = (
                (rho + p.z - 0.01) / 2f64.sqrt(),
                (rho - p.z + 0.01) / 2f64.sqrt(),
            );
            if p.z >= 0.0 && rho + p.z <= 0.01 {
                return (-p.z).max(side);
            }
            let length = 0.01 * 2f64.sqrt();
            let slant = side.hypot((-t).max(t - length).max(0.0));
            let base = p.z.hypot((rho - 0.01).max(0.0));
            slant.min(base)
        }
        _ => unreachable!("{name}"),
    }
}

#[test]
fn distances_and_signs_are_those_of_closed_forms() {
    let mut random = Random(46);
    for (name, brep) in [("drilled", drilled()), ("dome", dome()), ("cone", cone())] {
        let placing = Placing {
            turn: random.rotation().to_rotation_matrix().into_inner(),
            scale: 1.0,
            shift: random.vector() * 0.05,
        };
        let part = Part::new(&brep.placed(&placing).expect("in range")).expect("a part");
        let mut solver = PartSolver::new(&part);
        let mut worst = 0.0f64;
        for k in 0..20_000 {
            let p = Point3::from(random.vector().map(|x| x * 0.06));
            let q = placing.point(&p);
            let foot = solver.closest(&part, &q).expect("finite");
            let right = distance(name, &p);
            let off = (foot.signed_distance.expect("closed") - right).abs();
            assert!(off < 1e-14, "{name} {k}: {foot:?} at {p}, right {right}");
            worst = worst.max(off);
        }
        println!("{name}: off by {worst:.1e} m at most");
    }
}

/// Balls and rings in random poses: moments by closed forms, about the middle of their box.
#[test]
fn moments_are_those_of_closed_forms() {
    let mut random = Random(17);
    for _ in 0..5 {
        let turn = random.rotation().to_rotation_matrix().into_inner();
        let at = Axes::new(
            Point3::from(random.vector()),
            &turn.column(2).into_owned(),
            Some(&turn.column(0).into_owned()),
        )
        .expect("an axis");
        let (r, major) = (random.float(0.01, 0.02), random.float(0.03, 0.05));
        let ball = 4.0 / 3.0 * PI * r.powi(3);
        let ring = 2.0 * PI * PI * major * r * r;
        let across = ring * (0.5 * major * major + 0.375 * r * r);
        let of_ring = [across, across, ring * 0.25 * r * r];
        for (carrier, volume, spread) in [
            (
                Carrier::Sphere {
                    axes: at,
                    radius_m: r,
                },
                ball,
                [ball * r * r / 5.0; 3],
            ),
            (
                Carrier::Torus {
                    axes: at,
                    major_m: major,
                    minor_m: r,
                },
                ring,
                of_ring,
            ),
        ] {
            let part = Part::new(&whole(carrier)).expect("a part");
            let found = part.moments().expect("closed");
            let off = at.origin - found.about;
            let second = turn * Matrix3::from_diagonal(&Vector3::from(spread)) * turn.transpose()
                + off * off.transpose() * volume;
            let size_m = part.size_m();
            assert!((found.volume_m3 / volume - 1.0).abs() < 1e-11);
            assert!((found.first - off * volume).norm() < 1e-11 * volume * size_m);
            assert!(
                (found.second - second).norm() < 1e-11 * volume * size_m * size_m,
                "{found:?}"
            );
        }
    }
}

// A rectangle of 40 × 40 mm with a round hole, on a flat B-spline of 60 × 40 mm.
#[test]
fn a_face_on_a_b_spline_is_a_trimmed_patch() {
    let mut maker = Maker::default();
    let corners = [
        [0.0, 0.0, 0.0],
        [0.04, 0.0, 0.0],
        [0.04, 0.04, 0.0],
        [0.0, 0.04, 0.0],
    ];
    let outer = (0..4)
        .map(|k| maker.line(corners[k], corners[(k + 1) % 4]))
        .collect();
    let centre = axes([0.02, 0.02, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let hole = maker.circle(centre, 0.008);
    let knots = crate::basis::KnotVector::clamped_uniform(1, 2).unwrap();
    let points = [[0.0, 0.0], [0.0, 0.04], [0.06, 0.0], [0.06, 0.04]];
    let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let net = crate::surface::ControlNet::new(2, 2, points).unwrap();
    let flat = crate::surface::Surface::new(knots.clone(), knots, net, None).unwrap();
    let carrier = Carrier::Spline(Box::new(flat.clone()));
    maker.face(carrier, true, vec![outer, vec![(hole, false)]]);
    let mut brep = maker.solid();
    brep.shells[0].closed = false;
    brep.shells[0].solid = None;
    let (surface, trim) = Part::new(&brep).unwrap().as_patch().unwrap().unwrap();
    assert_eq!(surface, flat);
    let areas: Vec<f64> = (trim.loops().iter())
        .map(|ring| {
            let next = ring.iter().cycle().skip(1);
            let twice = ring
                .iter()
                .zip(next)
                .map(|(a, b)| a[0] * b[1] - b[0] * a[1]);
            0.5 * twice.sum::<f64>() * 0.06 * 0.04
        })
        .collect();
    assert_eq!(areas.len(), 2, "{:?}", trim.loops());
    // Left of the loops: counterclockwise outside, clockwise round the hole, whose chords cut off 1e-4 of it.
    assert!((areas[0] - 0.04 * 0.04).abs() < 1e-12, "{areas:?}");
    let round = PI * 0.008 * 0.008;
    assert!((areas[1] + round).abs() < 1e-3 * round, "{areas:?}");
    for [u, v] in &trim.loops()[1] {
        let off = libm::hypot(0.06 * u - 0.02, 0.04 * v - 0.02) - 0.008;
        assert!(off.abs() < 1e-9, "{u} {v}: {off}");
    }
    assert!(Part::new(&drilled()).unwrap().as_patch().is_none());
}
