//! Two surfaces against closed forms.

use super::tests::{missed_m, shape};
use super::*;
use palpate_geometry::math::Random;
use palpate_geometry::math::Rotation;
use palpate_geometry::surface::{ClosestSolver, builtin};

fn ask(body: &Surface, tool: &Surface, rows: usize, reach: &Reach) -> (ContactSet, Counters) {
    let (mut b, mut t) = (Spheres::new(body, [rows; 2]), Spheres::new(tool, [rows; 2]));
    let mut pair = SpheresPair::new(&b, &t);
    let mut set = ContactSet::new();
    pair.find(&mut b, &mut t, reach, &mut set);
    let (first, counters) = (set.clone(), *pair.counters());
    pair.find(&mut b, &mut t, reach, &mut set);
    assert_eq!(first, set, "asked twice");
    (first, counters)
}

fn ball_at(x: f64, y: f64, z: f64, radius_m: f64) -> Surface {
    // Turned, so that nothing is aligned.
    let pose = Pose::from_parts(
        Vector3::new(x, y, z).into(),
        Rotation::from_euler_angles(0.3, 1.1, -0.4),
    );
    builtin("sphere", None, Some(radius_m))
        .unwrap()
        .transformed(&pose)
}

// A ball's deepest point inside a body is as deep as the ball's centre says, if that is outside.
#[test]
fn a_ball_made_of_a_surface_is_as_deep_as_a_ball_and_errors_fall_with_the_square() {
    let body = shape("teardrop");
    let mut solver = ClosestSolver::new(&body);
    let mut worst = Vec::new();
    for rows in [28, 82, 244] {
        let (mut random, mut error) = (Random(5), 0.0_f64);
        let mut b = Spheres::new(&body, [rows; 2]);
        let mut t = Spheres::new(&ball_at(0.0, 0.0, 0.0, 0.02), [rows; 2]);
        let allowed = missed_m(&mut b) + missed_m(&mut t);
        let mut pair = SpheresPair::new(&b, &t);
        let mut set = ContactSet::new();
        for _ in 0..30 {
            let (u, v) = (random.float(0.0, 1.0), random.float(0.1, 0.9));
            let depth = random.float(0.001, 0.006);
            let centre = body.point(u, v) + body.normal(u, v) * (0.02 - depth);
            let exact = 0.02 - solver.closest(&body, &centre).signed_distance;
            t.load(&ball_at(centre.x, centre.y, centre.z, 0.02));
            pair.find(&mut b, &mut t, &Reach::TOUCH, &mut set);
            if exact < allowed {
                continue;
            }
            assert!(
                set.overlap() && set.contacts().len() >= 2,
                "{rows}: {exact} m deep: {set:?}"
            );
            assert_eq!(pair.counters().dropped, 0);
            // On the body, the ball's own depth; on the ball, the part inside the body is at least
            // as deep at its pole.
            let of_body = set
                .contacts()
                .iter()
                .map(|c| (c.depth_m - exact).abs())
                .fold(f64::INFINITY, f64::min);
            error = error.max(of_body);
            for c in set.contacts() {
                assert!(
                    (c.on_body - c.on_tool - c.normal * c.depth_m).norm() < 1e-12,
                    "{c:?}"
                );
                assert!((body.point(c.u, c.v) - c.on_body).norm() < allowed, "{c:?}");
            }
        }
        assert!(error <= allowed, "{rows}: {error}");
        worst.push(error);
    }
    for two in worst.windows(2) {
        let ratio = two[0] / two[1];
        assert!(
            (4.0..20.0).contains(&ratio),
            "{worst:?}: three times the rows leave a ninth of the error"
        );
    }
}

#[test]
fn two_balls_meet_when_their_centres_are_closer_than_their_radii() {
    let a = ball_at(0.0, 0.0, 0.0, 0.05);
    for (gap, touching) in [(-2e-3, true), (-1e-4, true), (1e-4, false), (2e-3, false)] {
        let b = ball_at(0.048, 0.064, 0.0, 0.03 - gap);
        let (set, counters) = ask(&a, &b, 244, &Reach::TOUCH);
        assert_eq!(set.overlap(), touching, "{gap}: {counters:?}");
        if touching {
            assert_eq!(
                set.contacts().len(),
                2,
                "a part of each inside the other: {set:?}"
            );
            // Both grids' h²κ/8, and as much again for the deepest point between rows.
            assert!(
                (set.deepest().unwrap().depth_m + gap).abs() < 6e-5,
                "{set:?}"
            );
            let n = set.deepest().unwrap().normal;
            assert!((n - Vector3::new(0.6, 0.8, 0.0)).norm() < 0.05, "{n}");
        }
    }
}

#[test]
fn one_inside_the_other_overlaps_without_crossing() {
    let (large, small) = (ball_at(0.0, 0.0, 0.0, 0.05), ball_at(0.02, 0.0, 0.0, 0.01));
    for (body, tool) in [(&large, &small), (&small, &large)] {
        let (set, counters) = ask(body, tool, 82, &Reach::TOUCH);
        assert!(
            set.overlap() && counters.triangle_meets == 0,
            "{counters:?}"
        );
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        // The inner side of the small ball is 10 mm from the large one's centre; rows are 1 mm
        // apart at most.
        assert!(
            (set.deepest().unwrap().depth_m - 0.04).abs() < 1e-4,
            "{set:?}"
        );
    }
}

#[test]
fn coincident_flat_patches_stop_early_and_are_one_contact_of_depth_zero() {
    let sheet = shape("sheet");
    let (set, counters) = ask(&sheet, &sheet, 82, &Reach::TOUCH);
    assert_eq!(counters.early_stop, Some(0));
    assert!(counters.points() <= 200, "{counters:?}");
    assert!(set.overlap());
    assert_eq!(
        (set.contacts().len(), set.rectangles().len()),
        (1, 1),
        "{set:?}"
    );
    let deepest = set.deepest().unwrap();
    assert!(deepest.depth_m.abs() < 1e-12, "{deepest:?}");
    assert!((deepest.normal.z.abs() - 1.0).abs() < 1e-12, "{deepest:?}");
}

#[test]
fn no_triangle_is_tested_unless_spheres_of_the_last_level_meet() {
    let body = shape("teardrop");
    let rest = ball_at(0.2, 0.0, 0.05, 0.02);
    let (set, counters) = ask(&body, &rest, 82, &Reach::TOUCH);
    assert!(counters.hulls_apart && !set.overlap() && counters.points() == 0);
    // In the hollow of a bent sheet: hulls overlap, surfaces do not.
    let mut bowl = builtin("sheet", Some([12, 12]), Some(0.1)).unwrap();
    for p in bowl.net_mut().points_mut() {
        p.z = 12.0 * (p.x * p.x + p.y * p.y);
    }
    let (set, counters) = ask(&bowl, &ball_at(0.0, 0.0, 0.02, 0.01), 82, &Reach::TOUCH);
    assert!(!counters.hulls_apart && !set.overlap() && set.contacts().is_empty());
    assert_eq!(counters.triangle_tests, 0, "{counters:?}");
    let (set, counters) = ask(&bowl, &ball_at(0.0, 0.0, 0.009, 0.01), 82, &Reach::TOUCH);
    assert!(set.overlap() && counters.triangle_tests > 0);
    let last = counters
        .tool
        .iter()
        .rposition(|level| level.tests > 0)
        .unwrap();
    assert!(
        counters.triangle_tests <= 4 * counters.tool[last].meets,
        "{counters:?}"
    );
    assert!(
        counters.points() < 2 * 82 * 82 / 5,
        "a fifth of both grids: {counters:?}"
    );
}

#[test]
fn a_ring_across_a_trough_has_four_regions() {
    let mut trough = builtin("sheet", Some([20, 6]), Some(0.12)).unwrap();
    for p in trough.net_mut().points_mut() {
        p.z = -0.02 * libm::cos(80.0 * p.x);
    }
    // Its rims are lines, x = ±39 mm; the lowest points of the ring a circle of 50 mm.
    let torus = shape("torus");
    let rim = ClosestSolver::new(&trough)
        .deepest_along(&trough, &Vector3::z())
        .2
        .z;
    let low = ClosestSolver::new(&torus)
        .deepest_along(&torus, &-Vector3::z())
        .2
        .z;
    let ring = torus.transformed(&Pose::translation(0.0, 0.0, rim - low - 1e-3));
    let (set, counters) = ask(&trough, &ring, 82, &Reach::TOUCH);
    assert!(
        set.overlap() && set.rectangles().len() == 4,
        "{set:?} {counters:?}"
    );
    assert_eq!(
        set.contacts().len(),
        8,
        "a part of each inside the other: {set:?}"
    );
    assert!(
        set.contacts()
            .iter()
            .all(|c| (c.depth_m - 1e-3).abs() < 1e-4),
        "{set:?}"
    );
}

#[test]
fn a_gap_within_the_margin_is_a_contact_of_negative_depth() {
    let a = ball_at(0.0, 0.0, 0.0, 0.05);
    let b = ball_at(0.048, 0.064, 0.0, 0.029);
    let (set, _) = ask(
        &a,
        &b,
        82,
        &Reach {
            margin_m: 2e-3,
            below: false,
            closing_m: 0.0,
        },
    );
    assert!(!set.overlap());
    let deepest = set.deepest().expect("a gap of a millimetre");
    assert!((deepest.depth_m + 1e-3).abs() < 3e-4, "{set:?}");
    assert!((deepest.on_body - deepest.on_tool - deepest.normal * deepest.depth_m).norm() < 1e-12);
    let (set, _) = ask(
        &a,
        &b,
        82,
        &Reach {
            margin_m: 5e-4,
            below: false,
            closing_m: 0.0,
        },
    );
    assert!(set.contacts().is_empty(), "{set:?}");
}

#[test]
fn scales_do_not_matter() {
    let answer = |scale: f64| {
        let body = shape("teardrop").scaled(scale);
        let centre = body.point(0.3, 0.5) + body.normal(0.3, 0.5) * (0.018 * scale);
        let (set, _) = ask(
            &body,
            &ball_at(centre.x, centre.y, centre.z, 0.02 * scale),
            82,
            &Reach::TOUCH,
        );
        (set.deepest().unwrap().depth_m / scale, set.contacts().len())
    };
    let (depth, contacts) = answer(1.0);
    for scale in [1e-5, 1e4] {
        let other = answer(scale);
        assert!(
            (other.0 - depth).abs() < 1e-12 && other.1 == contacts,
            "{scale}: {other:?} and {depth} {contacts}"
        );
    }
}
