//! Spines that break things.

use super::oracle::compare;
use super::{Answer, PipeError, PipeLimits, pipe_surface};
use super::{Spine, body_to_body};
use crate::ipp::Status;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Random;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Curve;

fn curled(random: &mut Random, degree: usize, count: usize, least_weight: f64) -> Curve {
    let turn = random.float(0.6, 2.4);
    let points = (0..count)
        .map(|k| {
            let angle = turn * k as f64;
            let rise = 0.2 * k as f64;
            let jitter = Vector3::new(
                random.float(-0.2, 0.2),
                random.float(-0.2, 0.2),
                random.float(-0.2, 0.2),
            );
            Point3::new(libm::cos(angle), libm::sin(angle), rise) + jitter
        })
        .collect();
    let weights = (0..count)
        .map(|_| libm::exp(random.float(libm::log(least_weight), -libm::log(least_weight))))
        .collect();
    Curve::new(
        KnotVector::clamped_uniform(degree, count).unwrap(),
        points,
        Some(weights),
    )
    .unwrap()
}

#[test]
fn every_degree_is_answered() {
    let mut random = Random(31);
    for degree in 1..=15 {
        let curve = curled(&mut random, degree, degree + 1, 0.5);
        let body = body_to_body(&Spine::new(&curve).unwrap());
        let found: Vec<[f64; 2]> = body.pairs.iter().map(|pair| pair.parameters).collect();
        let comparison = compare(&curve, &found, 160);
        assert_eq!(
            (comparison.missed, comparison.wrong),
            (0, 0),
            "degree {degree}: {comparison:?} {:?}",
            body.status
        );
        assert!(
            body.status <= Status::Cluster,
            "degree {degree}: {:?}",
            body.status
        );
        let limits = PipeLimits::of(&curve).unwrap();
        assert!(
            limits
                .bounds_m()
                .iter()
                .all(|(_, r)| r.is_none_or(|r| r.is_finite() && r >= 0.0)),
            "degree {degree}"
        );
    }
}

// Weights over eight orders of magnitude pull the curve onto its net: speeds and curvatures of all
// sizes.
#[test]
fn extreme_weights_give_an_answer_or_an_error() {
    let mut random = Random(32);
    let mut answered = 0;
    for _ in 0..40 {
        let (degree, more) = (random.integer(2, 5), random.integer(1, 4));
        let curve = curled(&mut random, degree, degree + more, 1e-4);
        match PipeLimits::of(&curve) {
            Ok(limits) => {
                answered += 1;
                for (limit, radius_m) in limits.bounds_m() {
                    assert!(
                        radius_m.is_none_or(|r| r.is_finite() && r >= 0.0),
                        "{limit:?}: {radius_m:?}"
                    );
                }
            }
            Err(error) => assert!(matches!(error, PipeError::NotRegular { .. }), "{error}"),
        }
    }
    assert!(answered > 30, "{answered}");
}

#[test]
fn a_piece_a_millionth_as_long_as_the_others_loses_no_pair() {
    let plain = Curve::new(
        KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0]).unwrap(),
        [[0.0, 0.0], [3.0, 2.0], [0.5, 3.0], [-2.0, 2.0], [1.0, -0.5]]
            .map(|[x, y]| Point3::new(x, y, 0.1 * x))
            .to_vec(),
        None,
    )
    .unwrap();
    let before = PipeLimits::of(&plain).unwrap();
    let at = before.body.pairs[0].parameters[0];
    // The short piece holds the first pair's first point.
    let (mut knots, mut points) = (plain.knots().clone(), plain.points().to_vec());
    for knot in [at - 5e-7, at + 5e-7] {
        let insertion = knots.insertion(knot).unwrap();
        points = insertion.apply(&points, |a, b, alpha| a + (b - a) * alpha);
        knots = insertion.knots;
    }
    let after = PipeLimits::of(&Curve::new(knots, points, None).unwrap()).unwrap();
    assert_eq!(after.body.pairs.len(), before.body.pairs.len());
    assert_eq!(after.body.status, Status::Complete);
    for (a, b) in after.body.pairs.iter().zip(&before.body.pairs) {
        assert!(
            (0..2).all(|k| (a.parameters[k] - b.parameters[k]).abs() < 1e-9),
            "{a:?} is not {b:?}"
        );
        assert!((a.distance_m - b.distance_m).abs() < 1e-12);
    }
}

#[test]
fn knots_put_at_the_roots_do_not_double_or_lose_them() {
    let mut random = Random(33);
    for _ in 0..12 {
        let curve = curled(&mut random, 3, 6, 0.5);
        let before = body_to_body(&Spine::new(&curve).unwrap());
        let (mut knots, weights) = (curve.knots().clone(), curve.weights().unwrap());
        let mut line: Vec<(Vector3, f64)> = curve
            .points()
            .iter()
            .zip(weights)
            .map(|(p, &w)| (p.coords * w, w))
            .collect();
        for pair in before.pairs.iter().take(3) {
            let insertion = knots.insertion(pair.parameters[0]).unwrap();
            line = insertion.apply(&line, |a, b, x| {
                (a.0 + (b.0 - a.0) * x, a.1 + (b.1 - a.1) * x)
            });
            knots = insertion.knots;
        }
        let points = line.iter().map(|(p, w)| Point3::from(p / *w)).collect();
        let refined =
            Curve::new(knots, points, Some(line.iter().map(|(_, w)| *w).collect())).unwrap();
        let after = body_to_body(&Spine::new(&refined).unwrap());
        assert_eq!(
            (after.pairs.len(), after.status),
            (before.pairs.len(), Status::Complete)
        );
        for (a, b) in after.pairs.iter().zip(&before.pairs) {
            assert!(
                (0..2).all(|k| (a.parameters[k] - b.parameters[k]).abs() < 1e-12),
                "{a:?} is not {b:?}"
            );
        }
    }
}

#[test]
fn a_periodic_curve_is_the_same_spine_as_its_clamped_form() {
    let points: Vec<Point3> = (0..9)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 9.0;
            Point3::new(
                (2.0 + libm::cos(3.0 * angle)) * libm::cos(2.0 * angle),
                (2.0 + libm::cos(3.0 * angle)) * libm::sin(2.0 * angle),
                libm::sin(3.0 * angle),
            )
        })
        .collect();
    let knots = KnotVector::periodic_uniform(3, 9).unwrap();
    let periodic = Curve::new(knots.clone(), points.clone(), None).unwrap();
    let change = knots.clamping();
    let rows = 0..change.knots().count();
    let clamped_points = rows
        .map(|row| {
            Point3::from(
                change
                    .entries(row)
                    .map(|(k, w)| points[k].coords * w)
                    .sum::<Vector3>(),
            )
        })
        .collect();
    let clamped = Curve::new(change.knots().clone(), clamped_points, None).unwrap();
    let [a, b] = [periodic, clamped].map(|curve| {
        let spine = Spine::new(&curve).unwrap();
        assert!(spine.is_closed() && spine.corners().is_empty());
        PipeLimits::of_spine(&spine)
    });
    assert!(!a.body.pairs.is_empty());
    assert_eq!(a.body.pairs.len(), b.body.pairs.len());
    for (a, b) in a.bounds_m().iter().zip(b.bounds_m()) {
        assert!((a.1.unwrap_or(0.0) - b.1.unwrap_or(0.0)).abs() < 1e-12);
    }
}

#[test]
fn a_closed_spine_of_one_piece_has_no_false_pair_where_it_closes() {
    // A quartic loop whose first and last control points and tangents agree.
    let points = [[0.0, 0.0], [2.0, 0.0], [1.0, 3.0], [-2.0, 0.0], [0.0, 0.0]]
        .map(|[x, y]| Point3::new(x, y, 0.0));
    let curve = Curve::new(
        KnotVector::clamped_uniform(4, 5).unwrap(),
        points.to_vec(),
        None,
    )
    .unwrap();
    let spine = Spine::new(&curve).unwrap();
    assert!(spine.is_closed());
    let limits = PipeLimits::of_spine(&spine);
    assert_eq!(limits.body.status, Status::Complete);
    assert!(
        limits.body.pairs.iter().all(|pair| pair.distance_m > 0.5),
        "{:?}",
        limits.body.pairs
    );
    assert!(!limits.body.pairs.is_empty(), "an oval has its axes");
    assert!(pipe_surface(&spine, 0.1, 1e-5).unwrap().deviation_m <= 1e-5);
}

#[test]
fn ends_that_meet_at_an_angle_touch_at_once() {
    let points =
        [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]].map(|[x, y]| Point3::new(x, y, 0.0));
    let curve = Curve::new(
        KnotVector::clamped_uniform(3, 4).unwrap(),
        points.to_vec(),
        None,
    )
    .unwrap();
    let limits = PipeLimits::of(&curve).unwrap();
    assert_eq!(
        (limits.end_to_end.unwrap().radius_m, limits.answer(1e-9)),
        (0.0, Answer::Intersects)
    );
}

#[test]
fn the_same_spine_gives_the_same_bits() {
    let mut random = Random(34);
    let curve = curled(&mut random, 4, 8, 0.5);
    let [a, b] = [0, 1].map(|_| PipeLimits::of(&curve).unwrap());
    assert_eq!(a.body.pairs, b.body.pairs);
    assert_eq!(a.bounds_m(), b.bounds_m());
}

// Opposite points of a cubic nearly-circle of 48 pieces: distances differ by less than 1e-5, and
// half the pairs lie at joints of four pairs of pieces.
#[test]
fn a_near_circle_has_two_pairs_for_each_piece_and_no_continuum() {
    let points = (0..48)
        .map(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 48.0);
            Point3::new(cos, sin, 0.0)
        })
        .collect();
    let curve = Curve::new(KnotVector::periodic_uniform(3, 48).unwrap(), points, None).unwrap();
    let body = body_to_body(&Spine::new(&curve).unwrap());
    assert_eq!(
        (body.pairs.len(), body.status, body.unresolved.len()),
        (48, Status::Complete, 0)
    );
    let distances = body.pairs.iter().map(|pair| pair.distance_m);
    let range = distances.clone().fold(0.0, f64::max) - distances.fold(f64::MAX, f64::min);
    assert!(range > 1e-8 && range < 1e-5, "{range}");
}
