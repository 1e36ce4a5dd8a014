//! Facts about balls and planes against surfaces, closed forms first.

use super::{ExactScratch, ball, plane};
use crate::basis::KnotVector;
use crate::basis::testing::Random;
use crate::contact::{Contact, ContactSet, Reach};
use crate::math::{Point3, Pose, Rotation, Vector3};
use crate::surface::{ClosestSolver, ControlNet, Surface, builtin};

fn with_margin(margin_m: f64) -> Reach {
    Reach {
        margin_m,
        below: false,
        closing_m: 0.0,
    }
}

fn ball_on(surface: &Surface, centre: Point3, radius_m: f64, reach: &Reach) -> ContactSet {
    let mut solver = ClosestSolver::new(surface);
    let mut scratch = ExactScratch::new(surface, &mut solver);
    let mut out = ContactSet::new();
    ball::contacts(
        surface,
        &mut solver,
        &centre,
        radius_m,
        reach,
        &mut scratch,
        &mut out,
    );
    check(surface, &out, reach);
    for c in out.contacts() {
        let off = (c.on_tool - centre).norm() - radius_m;
        assert!(
            off.abs() <= 1e-9 * surface.size() + 1e-15 * centre.coords.amax(),
            "{c:?} is {off:e} off the ball"
        );
    }
    out
}

fn plane_on(surface: &Surface, point: Point3, normal: Vector3, reach: &Reach) -> ContactSet {
    let mut solver = ClosestSolver::new(surface);
    let mut scratch = ExactScratch::new(surface, &mut solver);
    let mut out = ContactSet::new();
    plane::contacts(
        surface,
        &mut solver,
        &point,
        &normal,
        reach,
        &mut scratch,
        &mut out,
    );
    check(surface, &out, reach);
    for c in out.contacts() {
        assert!(
            (c.on_tool - point).dot(&normal.normalize()).abs()
                <= 1e-12 * (surface.size() + point.coords.amax())
        );
    }
    out
}

/// What holds for every answer.
fn check(surface: &Surface, set: &ContactSet, reach: &Reach) {
    let size = surface.size();
    assert!(set.contacts().is_sorted_by(|a, b| a.depth_m >= b.depth_m));
    for c in set.contacts() {
        let scale = size + c.on_body.coords.amax();
        assert!(
            (surface.point(c.u, c.v) - c.on_body).norm() <= 1e-12 * scale,
            "{c:?}"
        );
        assert!((c.normal.norm() - 1.0).abs() <= 1e-12, "{c:?}");
        assert!(
            (c.on_body - c.on_tool - c.normal * c.depth_m).norm() <= 1e-14 * scale,
            "{c:?}"
        );
        assert!(c.depth_m >= -reach.margin_m - 1e-11 * scale, "{c:?}");
        let held = set.rectangles().iter().any(|r| {
            let inside = |[low, high]: [f64; 2], x: f64, (a, b): (f64, f64)| {
                (low..=high).contains(&x)
                    || (low..=high).contains(&(x + b - a))
                    || x == b && low <= a
            };
            inside(r.u, c.u, surface.knots_u().domain())
                && inside(r.v, c.v, surface.knots_v().domain())
        });
        assert!(
            held || c.depth_m > 0.0,
            "{c:?} is in none of {:?}",
            set.rectangles()
        );
    }
}

fn depths(set: &ContactSet) -> Vec<f64> {
    set.contacts().iter().map(|c| c.depth_m).collect()
}

fn centre(surface: &Surface) -> Point3 {
    let net = surface.net().points();
    Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64)
}

fn random_vector(random: &mut Random) -> Vector3 {
    Vector3::new(
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
    )
}

/// A flat square of side 2 around the origin, cubic, normal +z.
fn square() -> Surface {
    builtin("sheet", None, Some(2.0)).unwrap()
}

/// Two slopes of 45 degrees that meet at x = 0 in a ridge (up) or a groove, at a knot of full
/// multiplicity.
fn roof(up: f64) -> Surface {
    let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let points = [-1.0_f64, -0.5, 0.0, 0.5, 1.0]
        .into_iter()
        .flat_map(|x| [-1.0, 1.0].map(|y| Point3::new(x, y, -up * x.abs())))
        .collect();
    Surface::new(u, v, ControlNet::new(5, 2, points).unwrap(), None).unwrap()
}

#[test]
fn the_deepest_contact_of_a_ball_is_that_of_the_closest_point() {
    let mut random = Random(7);
    let mut touched = 0;
    for net in [[8, 8], [12, 12], [20, 20]] {
        let surface = builtin("teardrop", Some(net), None).unwrap();
        let mut solver = ClosestSolver::new(&surface);
        let size = surface.size();
        for k in 0..if cfg!(debug_assertions) { 60 } else { 2_000 } {
            let q = centre(&surface) + random_vector(&mut random) * size * 0.4;
            let radius = if k % 5 == 0 {
                0.0
            } else {
                random.float(0.001, 0.4) * size
            };
            let set = ball_on(&surface, q, radius, &Reach::TOUCH);
            let expected = radius - solver.closest(&surface, &q).signed_distance;
            assert_eq!(set.overlap(), expected >= 0.0, "{q:?} {radius}");
            if expected >= 0.0 {
                touched += 1;
                let depth = set.deepest().unwrap().depth_m;
                assert!(
                    (depth - expected).abs() <= 2e-12 * size,
                    "{depth} {expected}"
                );
            } else {
                assert!(set.deepest().is_none());
            }
        }
    }
    assert!(touched > 60, "{touched}");
}

#[test]
fn a_plane_is_as_deep_as_the_farthest_sample_and_no_deeper_than_the_net() {
    let mut random = Random(8);
    let surface = builtin("teardrop", Some([12, 12]), None).unwrap();
    let size = surface.size();
    for _ in 0..20 {
        let n = random_vector(&mut random).normalize();
        let at = centre(&surface) + random_vector(&mut random) * 0.2 * size;
        let set = plane_on(&surface, at, n, &Reach::TOUCH);
        let sampled = (0..=300)
            .flat_map(|i| (0..=300).map(move |j| (i as f64 / 300.0, j as f64 / 300.0)))
            .map(|(u, v)| -(surface.point(u, v) - at).dot(&n))
            .fold(f64::NEG_INFINITY, f64::max);
        let depth = set.deepest().map_or(f64::NEG_INFINITY, |c| c.depth_m);
        // Samples a 300th apart miss the top by the square of that over the curvature radius.
        assert!(depth >= sampled - 1e-12 * size || (sampled < 0.0 && set.deepest().is_none()));
        assert!(sampled < 0.0 || depth <= sampled + 1e-3 * size);
    }
}

#[test]
fn tool_and_body_moved_together_touch_the_same() {
    let mut random = Random(9);
    let surface = builtin("teardrop", None, None).unwrap();
    let size = surface.size();
    for _ in 0..20 {
        let pose = Pose::from_parts(
            random_vector(&mut random).into(),
            Rotation::from_scaled_axis(random_vector(&mut random) * 2.0),
        );
        let moved = surface.transformed(&pose);
        let q = centre(&surface) + random_vector(&mut random) * size * 0.5;
        let same = |a: &ContactSet, b: &ContactSet| {
            assert_eq!(a.contacts().len(), b.contacts().len());
            for (x, y) in a.contacts().iter().zip(b.contacts()) {
                assert!((x.depth_m - y.depth_m).abs() <= 1e-13, "{x:?} {y:?}");
                assert!((pose * x.on_body - y.on_body).norm() <= 1e-8, "{x:?} {y:?}");
            }
        };
        same(
            &ball_on(&surface, q, 0.3 * size, &with_margin(0.01)),
            &ball_on(&moved, pose * q, 0.3 * size, &with_margin(0.01)),
        );
        let n = random_vector(&mut random).normalize();
        same(
            &plane_on(&surface, q, n, &with_margin(0.01)),
            &plane_on(&moved, pose * q, pose * n, &with_margin(0.01)),
        );
    }
}

// A ball that just touches: depth 0 to rounding, in touch, one contact. A little farther away:
// none.
#[test]
fn tangential_touch() {
    let sheet = square();
    let set = ball_on(&sheet, Point3::new(0.1, 0.2, 0.25), 0.25, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1);
    assert!(set.deepest().unwrap().depth_m.abs() <= 1e-15);
    assert!(
        ball_on(
            &sheet,
            Point3::new(0.1, 0.2, 0.25 + 1e-9),
            0.25,
            &Reach::TOUCH
        )
        .deepest()
        .is_none()
    );
    let drop = builtin("teardrop", None, None).unwrap();
    let (_, _, top) = ClosestSolver::new(&drop).deepest_along(&drop, &Vector3::x());
    let set = plane_on(&drop, top, -Vector3::x(), &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1);
    assert!(set.deepest().unwrap().depth_m.abs() <= 1e-15);
    assert!(
        plane_on(
            &drop,
            top + Vector3::x() * 1e-9,
            -Vector3::x(),
            &Reach::TOUCH
        )
        .deepest()
        .is_none()
    );
}

// From the middle of a torus' tube every point of a circle is nearest; from its centre, every point
// of another.
#[test]
fn ball_centre_on_the_medial_axis_has_few_contacts_of_the_right_depth() {
    let torus = builtin("torus", None, None).unwrap();
    let mut solver = ClosestSolver::new(&torus);
    let size = torus.size();
    for q in [
        centre(&torus),
        torus.point(0.0, 0.3),
        centre(&builtin("teardrop", None, None).unwrap()),
    ] {
        let foot = solver.closest(&torus, &q);
        let set = ball_on(&torus, q, foot.distance + 0.02 * size, &Reach::TOUCH);
        let expected = foot.distance + 0.02 * size - foot.signed_distance;
        assert!((set.deepest().unwrap().depth_m - expected).abs() <= 1e-9 * size);
    }
}

#[test]
fn tool_entirely_inside_is_pushed_out_the_nearest_way() {
    let drop = builtin("teardrop", None, None).unwrap();
    let q = centre(&drop);
    let foot = ClosestSolver::new(&drop).closest(&drop, &q);
    assert!(foot.signed_distance < 0.0);
    for radius in [0.0, 0.2 * foot.distance] {
        let set = ball_on(&drop, q, radius, &Reach::TOUCH);
        assert_eq!(set.contacts().len(), 1);
        let c = set.deepest().unwrap();
        assert!((c.depth_m - radius - foot.distance).abs() < 1e-15);
        assert!((c.normal - foot.normal).norm() < 1e-9);
    }
}

// Surrounded by the ball: from outside, the nearest region; and every other local minimum that
// faces the centre.
#[test]
fn tool_larger_than_the_body() {
    let drop = builtin("teardrop", None, None).unwrap();
    let q = centre(&drop) + Vector3::new(0.12, 0.0, 0.0);
    let foot = ClosestSolver::new(&drop).closest(&drop, &q);
    let set = ball_on(&drop, q, 1.0, &Reach::TOUCH);
    assert!((set.deepest().unwrap().depth_m - (1.0 - foot.distance)).abs() < 1e-13);
    let down = plane_on(&drop, q + Vector3::z() * 10.0, Vector3::z(), &Reach::TOUCH);
    let lowest = ClosestSolver::new(&drop)
        .deepest_along(&drop, &-Vector3::z())
        .2;
    assert!((down.deepest().unwrap().depth_m - (q.z + 10.0 - lowest.z)).abs() < 1e-12);
}

#[test]
fn pole_of_a_teardrop() {
    let drop = builtin("teardrop", None, None).unwrap();
    for v in [0.0, 1.0] {
        let pole = drop.point(0.0, v);
        let out = ClosestSolver::new(&drop).closest(&drop, &pole).normal;
        let set = ball_on(&drop, pole + out * 0.004, 0.005, &Reach::TOUCH);
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        assert!(
            (set.deepest().unwrap().depth_m - 0.001).abs() <= 1e-9,
            "{set:?}"
        );
        let set = plane_on(&drop, pole - out * 0.001, -out, &Reach::TOUCH);
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        assert!(set.deepest().unwrap().depth_m >= 0.001 - 1e-15);
    }
}

#[test]
fn crease_of_full_multiplicity() {
    let ridge = roof(1.0);
    let set = ball_on(&ridge, Point3::new(0.05, 0.0, 0.2), 0.25, &Reach::TOUCH);
    let c = set.deepest().unwrap();
    assert!(
        (c.depth_m - (0.25 - 0.05_f64.hypot(0.2))).abs() < 1e-12,
        "{c:?}"
    );
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((c.normal - Vector3::new(0.05, 0.0, 0.2).normalize()).norm() < 1e-9);
    // In the groove both slopes are touched, as deep as each other, at x = ±0.1.
    let groove = roof(-1.0);
    let set = ball_on(&groove, Point3::new(0.0, 0.0, 0.2), 0.15, &Reach::TOUCH);
    let expected = 0.15 - 0.2 * 0.5_f64.sqrt();
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    assert!(depths(&set).iter().all(|d| (d - expected).abs() < 1e-12));
    // A plane from above meets the ridge along a line of equal depth: one contact.
    let set = plane_on(
        &ridge,
        Point3::new(0.0, 0.0, -0.1),
        -Vector3::z(),
        &Reach::TOUCH,
    );
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.1).abs() < 1e-15);
}

// z = |x|^(2/3): tangents vanish at the edge of the cusp, where four control rows of a cubic meet
// in pairs.
#[test]
fn cusp_without_a_tangent() {
    let u = KnotVector::new(
        3,
        vec![0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 1.0],
    )
    .unwrap();
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let profile = [
        (-1.0, -1.0),
        (0.0, -1.0),
        (0.0, 0.0),
        (0.0, 0.0),
        (0.0, 0.0),
        (0.0, -1.0),
        (1.0, -1.0),
    ];
    let points = profile
        .iter()
        .flat_map(|&(x, z)| [-1.0, 1.0].map(|y| Point3::new(x, y, z)))
        .collect();
    let cusp = Surface::new(u, v, ControlNet::new(7, 2, points).unwrap(), None).unwrap();
    let set = ball_on(&cusp, Point3::new(0.01, 0.0, 0.2), 0.25, &Reach::TOUCH);
    assert!(
        (set.deepest().unwrap().depth_m - (0.25 - 0.01_f64.hypot(0.2))).abs() < 1e-9,
        "{set:?}"
    );
    let set = plane_on(
        &cusp,
        Point3::new(0.0, 0.0, -0.1),
        -Vector3::z(),
        &Reach::TOUCH,
    );
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.1).abs() < 1e-12);
}

// Both faces of a lens 1e-6 thick are within the ball; only the one that faces the centre is
// touched.
#[test]
fn very_thin_body() {
    let mut lens = builtin("sphere", None, Some(1.0)).unwrap();
    lens.net_mut()
        .points_mut()
        .iter_mut()
        .for_each(|p| p.z *= 1e-6);
    let top = ClosestSolver::new(&lens)
        .closest(&lens, &Point3::new(0.0, 0.0, 1.0))
        .point
        .z;
    for z in [1.0, -1.0] {
        let set = ball_on(&lens, Point3::new(0.1, 0.05, 0.2 * z), 0.25, &Reach::TOUCH);
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        let c = set.deepest().unwrap();
        assert!(
            (c.depth_m - 0.05).abs() <= 2.0 * top && c.normal.z * z > 0.999,
            "{c:?}"
        );
    }
}

#[test]
fn coincident_control_points() {
    // Three rows in one place: a tangent that vanishes in the middle.
    let mut sheet = square();
    let columns = sheet.net().columns();
    for j in 0..columns {
        let p = *sheet.net().at(3, j);
        for i in [4, 5] {
            sheet.net_mut().points_mut()[i * columns + j] = p;
        }
    }
    let set = ball_on(&sheet, Point3::new(0.0, 0.0, 0.1), 0.15, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.05).abs() < 1e-12);
    sheet
        .net_mut()
        .points_mut()
        .fill(Point3::new(1.0, 2.0, 3.0));
    let set = ball_on(&sheet, Point3::new(1.0, 2.0, 3.1), 0.15, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.05).abs() < 1e-12);
}

#[test]
fn exactly_on_a_seam_is_one_contact() {
    for name in ["torus", "teardrop", "sphere"] {
        let body = builtin(name, None, None).unwrap();
        let (u0, _) = body.knots_u().domain();
        let (v0, v1) = body.knots_v().domain();
        let (u, v) = (u0, v0 + 0.37 * (v1 - v0));
        let n = body.normal(u, v);
        let size = body.size();
        let set = ball_on(
            &body,
            body.point(u, v) + n * 0.01 * size,
            0.011 * size,
            &Reach::TOUCH,
        );
        assert_eq!(set.contacts().len(), 1, "{name}: {set:?}");
        assert!(
            (set.deepest().unwrap().depth_m - 0.001 * size).abs() < 1e-12 * size,
            "{name}: {set:?}"
        );
        assert_eq!(set.rectangles().len(), 1, "{name}: {:?}", set.rectangles());
    }
}

#[test]
fn open_edge_and_corner_are_touched_where_they_are() {
    let sheet = square();
    let set = ball_on(&sheet, Point3::new(1.03, 0.2, 0.04), 0.06, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.01).abs() < 1e-12);
    let set = ball_on(&sheet, Point3::new(1.03, 1.04, -0.12), 0.14, &Reach::TOUCH);
    assert!(
        (set.deepest().unwrap().depth_m - 0.01).abs() < 1e-12,
        "{set:?}"
    );
    // From below, the same sheet touches with its other face; a centre that came through is held.
    let below = Reach {
        margin_m: 0.0,
        below: true,
        closing_m: 0.0,
    };
    let set = ball_on(&sheet, Point3::new(0.1, 0.2, -0.04), 0.06, &below);
    assert!((set.deepest().unwrap().depth_m - 0.02).abs() < 1e-12);
    assert!((set.deepest().unwrap().normal + Vector3::z()).norm() < 1e-12);
    let set = ball_on(&sheet, Point3::new(0.1, 0.2, 0.04), 0.06, &below);
    assert!(
        (set.deepest().unwrap().depth_m - 0.10).abs() < 1e-12,
        "{set:?}"
    );
}

#[test]
fn two_regions_of_equal_depth_are_both_found() {
    let sheet = square();
    let mut wave = sheet.clone();
    let columns = wave.net().columns();
    for (i, j) in [(2, 3), (5, 4)] {
        wave.net_mut().points_mut()[i * columns + j].z = 0.5;
    }
    let set = plane_on(
        &wave,
        Point3::new(0.0, 0.0, 0.05),
        -Vector3::z(),
        &Reach::TOUCH,
    );
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    assert!((depths(&set)[0] - depths(&set)[1]).abs() < 1e-14);
    let c: Vec<Contact> = set.contacts().to_vec();
    assert!(
        (c[0].on_body + c[1].on_body.coords).xy().coords.norm() < 1e-7,
        "{c:?}"
    );
}

#[test]
fn coincident_flat_faces_are_one_contact_of_depth_zero() {
    let sheet = square();
    let tilt = Pose::from_parts(
        Vector3::new(0.3, -0.7, 0.2).into(),
        Rotation::from_euler_angles(0.3, -1.1, 2.0),
    );
    for (body, n, at) in [
        (sheet.clone(), Vector3::z(), Point3::origin()),
        (
            sheet.transformed(&tilt),
            tilt * Vector3::z(),
            tilt * Point3::origin(),
        ),
    ] {
        for depth in [0.0, 0.1] {
            let set = plane_on(&body, at - n * depth, -n, &Reach::TOUCH);
            assert_eq!(set.contacts().len(), 1, "{set:?}");
            assert!(
                (set.deepest().unwrap().depth_m - depth).abs() < 1e-15,
                "{set:?}"
            );
            assert_eq!(set.rectangles().len(), 1);
        }
    }
}

#[test]
fn scale_does_not_matter() {
    let drop = builtin("teardrop", None, None).unwrap();
    let q = centre(&drop) + Vector3::new(0.03, 0.01, 0.02);
    let n = Vector3::new(0.3, 0.5, -0.8).normalize();
    let at_one = (
        ball_on(&drop, q, 0.03, &Reach::TOUCH),
        plane_on(&drop, q, n, &Reach::TOUCH),
    );
    for scale in [1e-5, 1e4] {
        let scaled = drop.scaled(scale);
        let q = q * scale;
        for (one, other) in [
            (&at_one.0, ball_on(&scaled, q, 0.03 * scale, &Reach::TOUCH)),
            (&at_one.1, plane_on(&scaled, q, n, &Reach::TOUCH)),
        ] {
            assert_eq!(one.contacts().len(), other.contacts().len());
            for (a, b) in one.contacts().iter().zip(other.contacts()) {
                assert!(
                    (a.depth_m * scale - b.depth_m).abs() <= 1e-13 * scale,
                    "{a:?} {b:?}"
                );
            }
        }
    }
}

#[test]
fn arguments_that_are_not_finite_touch_nothing() {
    let drop = builtin("teardrop", None, None).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(
            ball_on(&drop, Point3::new(bad, 0.0, 0.0), 0.1, &Reach::TOUCH)
                .deepest()
                .is_none()
        );
        assert!(
            ball_on(&drop, Point3::origin(), bad, &Reach::TOUCH)
                .deepest()
                .is_none()
        );
        assert!(
            plane_on(
                &drop,
                Point3::new(0.0, bad, 0.0),
                Vector3::z(),
                &Reach::TOUCH
            )
            .deepest()
            .is_none()
        );
        assert!(
            plane_on(
                &drop,
                Point3::origin(),
                Vector3::new(bad, 0.0, 1.0),
                &Reach::TOUCH
            )
            .deepest()
            .is_none()
        );
    }
    assert!(
        plane_on(&drop, Point3::origin(), Vector3::zeros(), &Reach::TOUCH)
            .deepest()
            .is_none()
    );
}
