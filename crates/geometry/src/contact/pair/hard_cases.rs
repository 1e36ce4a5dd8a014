//! The hard cases of two surfaces, one test each. Others are among [`super::tests`]: tangential
//! touch, coincident flat patches, a pole, two regions of equal depth, scale.

use super::tests::{Random, contacts, overlap, posed};
use super::*;
use crate::basis::KnotVector;
use crate::math::{Point3, Rotation, Vector3};
use crate::surface::{ControlNet, builtin};
use std::f64::consts::{FRAC_PI_4, TAU};

/// A closed surface around z from its profile (distance, height) and its outline (x, y); knots with
/// full interior multiplicity in v, and in u when `cornered`. Ends of the profile are on the axis.
fn turned(outline: &[[f64; 2]], profile: &[[f64; 2]], cornered: bool) -> Surface {
    let creased = |count: usize| {
        // Degree 2, each interior knot double: parabolas that join in corners.
        let spans = (count - 1) / 2;
        let mut knots = vec![0.0];
        knots.extend((0..=spans).flat_map(|k| [k as f64 / spans as f64; 2]));
        knots.push(1.0);
        KnotVector::new(2, knots).unwrap()
    };
    let u = if cornered {
        creased(outline.len())
    } else {
        KnotVector::periodic_uniform(3, outline.len()).unwrap()
    };
    let points = outline
        .iter()
        .flat_map(|[x, y]| {
            profile
                .iter()
                .map(move |[r, z]| Point3::new(r * x, r * y, *z))
        })
        .collect();
    let net = ControlNet::new(outline.len(), profile.len(), points).unwrap();
    Surface::new(u, creased(profile.len()), net, None)
        .unwrap()
        .oriented_outward()
}

/// A box about the origin, exact: |x|, |y| ≤ half_m, |z| ≤ height_m.
fn block(half_m: f64, height_m: f64) -> Surface {
    const SQUARE: [[f64; 2]; 9] = [
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
        [1.0, 1.0],
    ];
    let (a, h) = (half_m, height_m);
    turned(
        &SQUARE,
        &[
            [0.0, -h],
            [0.5 * a, -h],
            [a, -h],
            [a, 0.0],
            [a, h],
            [0.5 * a, h],
            [0.0, h],
        ],
        true,
    )
}

/// A lens about the origin with a sharp rim in z = 0; with a `cusp`, of no angle.
fn lens(radius_m: f64, height_m: f64, cusp: bool) -> Surface {
    let ring: Vec<[f64; 2]> = (0..12)
        .map(|k| TAU * f64::from(k) / 12.0)
        .map(|a| [libm::cos(a), libm::sin(a)])
        .collect();
    let (r, h) = (radius_m, height_m);
    let shoulder = if cusp { 0.0 } else { h };
    turned(
        &ring,
        &[
            [0.0, -h],
            [0.5 * r, -shoulder],
            [r, 0.0],
            [0.5 * r, shoulder],
            [0.0, h],
        ],
        false,
    )
}

fn up(z: f64) -> Vector3 {
    Vector3::new(0.0, 0.0, z)
}

fn lifted(surface: &Surface, rotation: &Rotation, lowest_m: f64, shift: &Vector3) -> Surface {
    let turned = posed(surface, rotation, &Vector3::zeros());
    let least = turned
        .net()
        .points()
        .iter()
        .fold(f64::INFINITY, |m, p| m.min(p.z));
    posed(
        &turned,
        &Rotation::identity(),
        &(shift + up(lowest_m - least)),
    )
}

#[test]
fn a_crease_presses_in_as_deep_as_its_edge_or_corner() {
    let (body, tool) = (block(0.05, 0.02), block(0.01, 0.01));
    let corner = Rotation::from_euler_angles(libm::atan2(1.0, libm::sqrt(2.0)), 0.0, 0.0)
        * Rotation::from_euler_angles(0.0, FRAC_PI_4, 0.0);
    for (name, rotation) in [
        ("edge", Rotation::from_euler_angles(FRAC_PI_4, 0.0, 0.0)),
        ("corner", corner),
    ] {
        for depth in [0.002, 1e-4, 1e-6, 0.0, -1e-4] {
            // All corners of a block are points of its net.
            let tool = lifted(
                &tool,
                &rotation,
                0.02 - depth,
                &Vector3::new(0.013, 0.007, 0.0),
            );
            for (a, b, sense) in [(&body, &tool, 1.0), (&tool, &body, -1.0)] {
                let set = contacts(a, b, 1e-3);
                let c = set
                    .deepest()
                    .unwrap_or_else(|| panic!("{name}: nothing at depth {depth}"));
                assert!((c.depth_m - depth).abs() < 1e-9, "{name} {depth}: {set:?}");
                assert!(
                    (c.normal - up(sense)).norm() < 1e-6,
                    "{name} {depth}: {c:?}"
                );
                assert_eq!(set.overlap(), depth >= 0.0, "{name} {depth}: {set:?}");
            }
        }
    }
}

#[test]
fn a_sharp_rim_and_a_cusp_press_in_as_deep_as_their_lowest_point() {
    let body = block(0.05, 0.02);
    for cusp in [false, true] {
        let rim = lens(0.02, 0.005, cusp);
        let upright = posed(
            &rim,
            &Rotation::from_euler_angles(0.0, 1.4, 0.3),
            &Vector3::zeros(),
        );
        // The rim is v = 1/2: its lowest point, by windows that shrink.
        let (mut at, mut wide) = (0.5, 0.5);
        for _ in 0..60 {
            let height = |u: f64| upright.point(u.rem_euclid(1.0), 0.5).z;
            let best = (-40..=40)
                .map(|k| at + wide * f64::from(k) / 40.0)
                .min_by(|a, b| height(*a).total_cmp(&height(*b)));
            (at, wide) = (best.unwrap(), 0.6 * wide);
        }
        let lowest = upright.point(at.rem_euclid(1.0), 0.5).z;
        for depth in [0.002, 1e-4, 1e-6, -1e-4] {
            let tool = posed(
                &upright,
                &Rotation::identity(),
                &(up(0.02 - depth - lowest) + Vector3::new(0.01, 0.004, 0.0)),
            );
            let set = contacts(&body, &tool, 1e-3);
            let c = set
                .deepest()
                .unwrap_or_else(|| panic!("cusp {cusp}: nothing at depth {depth}"));
            assert!(
                (c.depth_m - depth).abs() < 1e-9,
                "cusp {cusp} {depth}: {set:?}"
            );
            assert_eq!(set.overlap(), depth >= 0.0, "cusp {cusp} {depth}: {set:?}");
        }
    }
}

// The normals of the two sheets cancel there: which side a place is on does not follow from their
// mean.
#[test]
fn what_is_beyond_a_cusp_is_outside_and_beyond_a_crack_inside() {
    let body = lens(0.02, 0.005, true);
    // The same from within: what was thin becomes a crack, seen as a body turned inside out.
    let crack = body.clone().with_flip_normal(!body.flip_normal());
    for (surface, sense) in [(&body, 1.0), (&crack, -1.0)] {
        let mut solver = ClosestSolver::new(surface);
        for k in 0..200 {
            let u = f64::from(k) / 200.0;
            let tip = surface.point(u, 0.5);
            for (out, up) in [
                (1e-3, 0.0),
                (1e-4, 3e-4),
                (1e-4, -3e-4),
                (0.03, -0.02),
                (0.01, 0.003),
            ] {
                let way = Vector3::new(tip.x, tip.y, 0.0).normalize();
                let foot = solver.closest(surface, &(tip + way * out + Vector3::z() * up));
                assert!(
                    foot.signed_distance * sense > 0.0,
                    "u {u}, {out} out and {up} up: {foot:?}"
                );
            }
        }
    }
}

#[test]
fn a_very_thin_body_is_pierced_and_touched() {
    // A ten-thousandth as thick as it is wide.
    let mut thin = builtin("sphere", None, Some(0.05)).unwrap();
    for p in thin.net_mut().points_mut() {
        p.z *= 1e-4;
    }
    let size = thin.size();
    let ball = builtin("sphere", None, Some(0.01)).unwrap();
    let mut solver = ClosestSolver::new(&thin);
    for (x, z) in [
        (0.01, 0.003),
        (0.013, -0.006),
        (0.0, 0.0099),
        (0.02, 0.0100035),
        (0.02, 0.0100055),
    ] {
        let centre = Vector3::new(x, 0.004, z);
        let tool = posed(&ball, &Random(6).rotation(), &centre);
        // The farthest place inside a ball is the nearest to its centre.
        let foot = solver.closest(&thin, &Point3::from(centre));
        let depth = 0.01 - foot.distance;
        let set = contacts(&thin, &tool, 1e-4);
        let c = set
            .deepest()
            .unwrap_or_else(|| panic!("nothing at {centre}"));
        assert!(
            (c.depth_m - depth).abs() < 1e-9 * size,
            "at {centre}: {} for {depth}",
            c.depth_m
        );
        assert_eq!(set.overlap(), depth >= 0.0, "at {centre}: {set:?}");
    }
}

#[test]
fn coincident_control_points_do_not_hide_a_contact() {
    let ball = builtin("sphere", None, Some(0.02)).unwrap();
    let mut random = Random(12);
    for k in 0..24 {
        let mut body = builtin("torus", None, Some(0.05)).unwrap();
        let columns = body.net().columns();
        let points = body.net_mut().points_mut();
        // Two, three and four in a row, and a square of four: tangents vanish, not the contact.
        for (from, to) in [
            (0, 1),
            (0, columns),
            (0, columns + 1),
            (40, 41),
            (40, 42),
            (90, 90 + columns),
        ] {
            points[to] = points[from];
        }
        let place = [points[0], points[40], points[90]][k % 3];
        let mut solver = ClosestSolver::new(&body);
        // Around the coincident points, half a radius to just above the surface away.
        let foot = solver.closest(&body, &(place + random.vector() * 0.01));
        let depth = [0.004, 1e-4, 1e-6][k / 3 % 3];
        let centre = foot.point + foot.normal * (0.02 - depth);
        let depth = 0.02 - solver.closest(&body, &centre).distance;
        let tool = posed(&ball, &random.rotation(), &centre.coords);
        let set = contacts(&body, &tool, 1e-4);
        let c = set
            .deepest()
            .unwrap_or_else(|| panic!("{k}: nothing at {centre}"));
        assert!(
            (c.depth_m - depth).abs() < 1e-7 * body.size(),
            "{k}: {} for {depth}",
            c.depth_m
        );
    }
}

#[test]
fn a_contact_on_a_periodic_seam_is_one_and_its_rectangle_passes_the_seam() {
    let torus = builtin("torus", None, Some(0.05)).unwrap();
    let ball = builtin("sphere", None, Some(0.008)).unwrap();
    for (u, v) in [(0.0, 0.3), (0.3, 0.0), (0.0, 0.0), (1.0, 0.6)] {
        for depth in [1e-3, 1e-6, -1e-4] {
            let centre = torus.point(u, v) + torus.normal(u, v) * (0.008 - depth);
            let tool = posed(&ball, &Random(5).rotation(), &centre.coords);
            let set = contacts(&torus, &tool, 5e-4);
            assert_eq!(set.contacts().len(), 1, "({u}, {v}) {depth}: {set:?}");
            let c = &set.contacts()[0];
            assert!(
                (c.depth_m - depth).abs() < 1e-12,
                "({u}, {v}) {depth}: {c:?}"
            );
            assert_eq!(
                set.rectangles().len(),
                usize::from(depth >= 0.0),
                "({u}, {v}) {depth}: {set:?}"
            );
            if depth == 1e-3 {
                let passes = |r: [f64; 2], x: f64| x > 0.0 && x < 1.0 || (r[0] < 1.0 && r[1] > 1.0);
                let r = set.rectangles()[0];
                assert!(passes(r.u, u) && passes(r.v, v), "({u}, {v}): {r:?}");
            }
        }
    }
}

#[test]
fn a_ball_over_an_open_edge_is_as_deep_as_its_lowest_point() {
    let sheet = builtin("sheet", None, None).unwrap();
    let ball = builtin("sphere", None, Some(0.01)).unwrap();
    let size = sheet.size();
    for depth in [0.002, 1e-4, -1e-4] {
        for (x, y) in [(0.05, 0.01), (-0.02, -0.05), (0.05, 0.05)] {
            let tool = posed(
                &ball,
                &Random(7).rotation(),
                &Vector3::new(x, y, 0.01 - depth),
            );
            let set = contacts(&sheet, &tool, 1e-3);
            let c = set
                .deepest()
                .unwrap_or_else(|| panic!("nothing over ({x}, {y}) at {depth}"));
            assert!(
                (c.depth_m - depth).abs() < 1e-6 * size,
                "over ({x}, {y}) at {depth}: {set:?}"
            );
            assert_eq!(
                set.overlap(),
                depth >= 0.0,
                "over ({x}, {y}) at {depth}: {set:?}"
            );
        }
    }
}

#[test]
fn closed_bodies_face_on_face_are_one_region_of_their_common_depth() {
    let body = block(0.03, 0.02);
    for (name, tool) in [
        ("equal", block(0.03, 0.02)),
        ("smaller", block(0.02, 0.01)),
        ("larger", block(0.05, 0.01)),
    ] {
        let height = if name == "equal" { 0.02 } else { 0.01 };
        for depth in [0.0, 1e-3, 1e-6, -1e-4] {
            for shift in [Vector3::zeros(), Vector3::new(0.007, -0.004, 0.0)] {
                let tool = posed(
                    &tool,
                    &Rotation::identity(),
                    &(shift + up(0.02 + height - depth)),
                );
                let set = contacts(&body, &tool, 5e-4);
                let c = set
                    .deepest()
                    .unwrap_or_else(|| panic!("{name}: nothing at {depth}"));
                assert!(
                    (c.depth_m - depth).abs() < 1e-9,
                    "{name} {depth} {shift}: {set:?}"
                );
                assert!(
                    (c.normal - up(1.0)).norm() < 1e-6,
                    "{name} {depth} {shift}: {c:?}"
                );
                assert_eq!(
                    set.overlap(),
                    depth >= 0.0,
                    "{name} {depth} {shift}: {set:?}"
                );
                let touching = set.contacts().iter().filter(|c| c.depth_m >= 0.0).count();
                assert!(touching <= 1, "{name} {depth} {shift}: {set:?}");
            }
        }
    }
}

#[test]
fn a_body_on_itself_overlaps_and_is_nowhere_inside() {
    for body in [
        block(0.03, 0.02),
        lens(0.02, 0.005, false),
        builtin("torus", None, None).unwrap(),
    ] {
        let set = contacts(&body, &body.clone(), 0.0);
        assert!(set.overlap(), "{set:?}");
        assert!(
            set.contacts().iter().all(|c| c.depth_m.abs() < 1e-9),
            "{set:?}"
        );
    }
}

#[test]
fn a_block_inside_a_block_is_as_deep_as_its_place_nearest_the_middle() {
    let (outer, inner) = (block(0.05, 0.05), block(0.01, 0.01));
    // Greatest distances lie where several faces of the outer block are equally far.
    for shift in [0.0, 0.004, 0.01, 0.03] {
        let tool = posed(
            &inner,
            &Rotation::identity(),
            &Vector3::new(shift, 0.0, 0.0),
        );
        let depth = 0.05 - (shift - 0.01).abs();
        for (a, b) in [(&outer, &tool), (&tool, &outer)] {
            let set = contacts(a, b, 0.0);
            assert!(set.overlap());
            let c = set
                .deepest()
                .unwrap_or_else(|| panic!("nothing at {shift}"));
            assert!(
                (c.depth_m - depth).abs() < 1e-6 * outer.size(),
                "{shift}: {} for {depth}",
                c.depth_m
            );
        }
    }
}

#[test]
fn a_millionth_decides_whether_corners_rims_and_rings_touch() {
    let ball = builtin("sphere", None, Some(0.02)).unwrap();
    let ring = builtin("torus", None, Some(0.05)).unwrap();
    let corner = Rotation::from_euler_angles(0.6, 0.5, 0.0);
    for gap in [1e-6, -1e-6] {
        let gap_m = gap * ball.size();
        for body in [
            block(0.02, 0.02),
            posed(&block(0.02, 0.02), &corner, &Vector3::zeros()),
            lens(0.02, 0.004, false),
            ring.clone(),
        ] {
            let mut random = Random(9);
            for _ in 0..6 {
                // A ball beside a place of the surface: how far its centre is, a certified query
                // tells.
                let (u, v) = (random.unit(), random.unit());
                let (point, normal) = (body.point(u, v), body.normal(u, v));
                let centre = point + normal * (0.02 + gap_m);
                let away = ClosestSolver::new(&body).closest(&body, &centre).distance - 0.02;
                // In a hollow the ball meets another place first.
                if (away - gap_m).abs() > 1e-9 {
                    continue;
                }
                let tool = posed(&ball, &random.rotation(), &centre.coords);
                assert_eq!(overlap(&body, &tool), gap < 0.0, "gap {gap} at ({u}, {v})");
            }
        }
        // The corner of a block over a ball, and a ball over the rim of a lens.
        let tool = lifted(&block(0.01, 0.01), &corner, 0.02 + gap_m, &Vector3::zeros());
        let lowest = tool
            .net()
            .points()
            .iter()
            .copied()
            .min_by(|a, b| a.z.total_cmp(&b.z))
            .unwrap();
        let under = posed(
            &tool,
            &Rotation::identity(),
            &Vector3::new(-lowest.x, -lowest.y, 0.0),
        );
        assert_eq!(overlap(&ball, &under), gap < 0.0, "corner at gap {gap}");
        let rim = lens(0.02, 0.004, false);
        // Opposite a point of the net the rim is round about it.
        let tip = rim.point(0.0, 0.5);
        let beside = posed(
            &ball,
            &Random(3).rotation(),
            &(tip.coords + tip.coords.normalize() * (0.02 + gap_m)),
        );
        assert_eq!(overlap(&rim, &beside), gap < 0.0, "rim at gap {gap}");
    }
}
