use super::super::cases::{PipeCase, cases};
use super::super::{LocalKind, PairKind};
use super::*;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Point3;

fn case(name: &str) -> (PipeCase, PipeLimits) {
    let case = cases()
        .into_iter()
        .find(|case| case.name == name)
        .expect("a case of the data");
    let limits = PipeLimits::of(&case.curve()).unwrap();
    (case, limits)
}

fn bezier(points: &[[f64; 3]], weights: Option<Vec<f64>>) -> Curve {
    let knots = KnotVector::clamped_uniform(points.len() - 1, points.len()).unwrap();
    Curve::new(
        knots,
        points.iter().map(|p| Point3::from(*p)).collect(),
        weights,
    )
    .unwrap()
}

fn close(found: Option<f64>, wanted: Option<f64>, what: &str) {
    match (found, wanted) {
        (Some(found), Some(wanted)) => {
            // 1e-10 relative; a crossing has distance 0, found to the rounding of the coordinates.
            assert!(
                (found - wanted).abs() <= 1e-10 * wanted + 1e-15,
                "{what}: {found} is not {wanted}"
            );
        }
        _ => assert_eq!(
            found.is_some(),
            wanted.is_some(),
            "{what}: {found:?} is not {wanted:?}"
        ),
    }
}

#[test]
fn the_ten_cases_have_their_bounds_and_all_their_pairs() {
    for case in cases() {
        let limits = PipeLimits::of(&case.curve()).unwrap();
        let name = &case.name;
        let [local, bb, ee, eb] = limits.bounds_m().map(|(_, radius)| radius);
        close(local, Some(case.r_local), name);
        close(bb, case.r_bb, name);
        if name != "helix" {
            close(ee, case.r_ee, name);
            close(eb, case.r_eb, name);
        }
        assert_eq!(limits.body.pairs.len(), case.pairs.len(), "{name}");
        assert_eq!(limits.body.status, Status::Complete, "{name}");
        let (start, end) = case.curve().knots().domain();
        for wanted in &case.pairs {
            // The data count a closed spine's parameters from any of its turns.
            let inside = |t: f64| {
                if t < start {
                    t + (end - start)
                } else if t > end {
                    t - (end - start)
                } else {
                    t
                }
            };
            let mut at = [inside(wanted[0]), inside(wanted[1])];
            at.sort_by(f64::total_cmp);
            let error = |pair: &super::super::StationaryPair| {
                let [s, t] = pair.parameters;
                (s - at[0])
                    .abs()
                    .max((t - at[1]).abs())
                    .max((pair.distance_m - wanted[2]).abs())
            };
            let nearest = limits
                .body
                .pairs
                .iter()
                .map(error)
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest < 1e-12 * (end - start).max(1.0),
                "{name}: {at:?} is {nearest} off"
            );
        }
    }
}

#[test]
fn statuses_are_complete_but_for_the_arc_whose_curvature_is_constant() {
    for case in cases() {
        let status = PipeLimits::of(&case.curve()).unwrap().status();
        let wanted = if case.name == "arc" {
            Status::Continuum
        } else {
            Status::Complete
        };
        assert_eq!(status, wanted, "{}", case.name);
    }
}

#[test]
fn the_published_end_circles_touch_where_they_should() {
    // Patrikalakis & Maekawa, example 11.6.2.
    let (_, limits) = case("example-11.6.2");
    let touch = limits.end_to_end.unwrap();
    assert!((touch.radius_m - 0.0963).abs() < 5e-5);
    assert!(
        (touch.point - Point3::new(2.918, 3.055, 4.023)).amax() < 5e-4,
        "{}",
        touch.point
    );
    // The end circle meets the body earlier than the other end circle.
    assert_eq!(limits.r_max_m().unwrap().1, Limit::EndToBody);
    let first = limits.ends_to_body.touches[0];
    assert!(first.end == 0 && (first.parameter - 0.998_352_974_515_709).abs() < 1e-12);
}

#[test]
fn curvature_is_largest_where_the_data_say() {
    for case in cases() {
        let witness = PipeLimits::of(&case.curve())
            .unwrap()
            .local
            .witness
            .unwrap();
        if let Some(t) = case.t_kappa_max.filter(|_| case.name != "arc") {
            // The crossing spine is symmetric: either of two places.
            let mirrored = if case.name == "crossing" { 1.0 - t } else { t };
            let error = (witness.parameter - t)
                .abs()
                .min((witness.parameter - mirrored).abs());
            assert!(error < 1e-11, "{}: {witness:?} is not at {t}", case.name);
        }
    }
    // y = x² on [−1/2, 1/2]: curvature 2 at the vertex.
    let parabola = PipeLimits::of(&bezier(
        &[[-0.5, 0.25, 0.0], [0.0, -0.25, 0.0], [0.5, 0.25, 0.0]],
        None,
    ))
    .unwrap();
    assert!((parabola.local.radius_m.unwrap() - 0.5).abs() < 1e-15);
    assert!((parabola.local.witness.unwrap().parameter - 0.5).abs() < 1e-15);
}

#[test]
fn answers_change_at_the_largest_radius() {
    let (case, limits) = case("example-11.6.5");
    let r_max_m = case.r_eb.unwrap();
    assert_eq!(limits.answer(r_max_m * (1.0 - 1e-9)), Answer::Free);
    assert_eq!(
        limits.answer(limits.r_max_m().unwrap().0),
        Answer::Intersects
    );
    assert_eq!(limits.answer(r_max_m * (1.0 + 1e-9)), Answer::Intersects);
}

#[test]
fn a_straight_spine_has_no_bounds() {
    for points in [
        vec![[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]],
        vec![[0.0; 3], [1.0, 2.0, 3.0], [1.5, 3.0, 4.5], [2.0, 4.0, 6.0]],
    ] {
        let limits = PipeLimits::of(&bezier(&points, None)).unwrap();
        assert_eq!(
            limits.bounds_m().map(|(_, radius)| radius),
            [None; 4],
            "{points:?}"
        );
        assert_eq!(
            (limits.status(), limits.answer(1e6)),
            (Status::Complete, Answer::Free)
        );
    }
}

/// A circle of radius R in the plane, four rational quadratic arcs.
fn circle(radius: f64, turns: usize) -> Curve {
    let h = 0.5_f64.sqrt();
    let corners = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
    ];
    let (mut points, mut weights, mut knots) = (Vec::new(), Vec::new(), vec![0.0; 3]);
    for k in 0..=8 * turns {
        let [x, y] = corners[k % 8];
        points.push(Point3::new(radius * x, radius * y, 0.0));
        weights.push(if k % 2 == 0 { 1.0 } else { h });
    }
    for k in 1..4 * turns {
        knots.extend([k as f64; 2]);
    }
    knots.extend([4.0 * turns as f64; 3]);
    Curve::new(KnotVector::new(2, knots).unwrap(), points, Some(weights)).unwrap()
}

#[test]
fn opposite_points_of_a_circle_are_a_continuum_and_two_turns_lie_on_each_other() {
    let limits = PipeLimits::of(&circle(3.0, 1)).unwrap();
    assert_eq!(limits.body.status, Status::Continuum);
    assert!(
        (limits.body.radius_m.unwrap() - 3.0).abs() < 1e-12,
        "{:?}",
        limits.body.radius_m
    );
    for unresolved in &limits.body.unresolved {
        assert!(
            unresolved
                .distance_m
                .iter()
                .all(|d| (d - 6.0).abs() < 1e-12),
            "{unresolved:?}"
        );
    }
    assert!((limits.local.radius_m.unwrap() - 3.0).abs() < 1e-12);
    assert!(
        limits.end_to_end.is_none() && limits.ends_to_body.touches.is_empty(),
        "no end circles"
    );
    let twice = PipeLimits::of(&circle(1.0, 2)).unwrap();
    assert_eq!(twice.body.status, Status::Continuum);
    assert!(
        twice.body.radius_m.unwrap() < 1e-12,
        "{:?}",
        twice.body.radius_m
    );
}

#[test]
fn a_corner_has_radius_zero() {
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 2.0, 2.0]).unwrap();
    for y in [2.0, -1.5] {
        let points = vec![
            Point3::origin(),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(1.0 + 0.2 * y, y, 0.0),
        ];
        let limits = PipeLimits::of(&Curve::new(knots.clone(), points, None).unwrap()).unwrap();
        let witness = limits.local.witness.unwrap();
        assert_eq!(
            (limits.r_max_m().unwrap().0, witness.kind, witness.parameter),
            (0.0, LocalKind::Corner, 1.0)
        );
        assert_eq!(limits.answer(1e-12), Answer::Intersects);
    }
}

#[test]
fn spines_without_tangents_connection_or_size_are_refused() {
    let refused = |curve: &Curve| PipeLimits::of(curve).unwrap_err();
    let doubled = bezier(
        &[[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        None,
    );
    assert!(matches!(refused(&doubled), PipeError::NotRegular { parameter } if parameter < 1e-9));
    let cusp = bezier(
        &[[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        None,
    );
    assert!(
        matches!(refused(&cusp), PipeError::NotRegular { parameter } if (parameter - 0.5).abs() < 1e-6)
    );
    assert!(matches!(
        refused(&bezier(&[[1.0; 3]; 4], None)),
        PipeError::Size { size_m: 0.0 }
    ));
    let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
    let points = (0..6)
        .map(|k| Point3::new(f64::from(k), f64::from(k * k), f64::from(k / 3)))
        .collect();
    assert!(matches!(
        refused(&Curve::new(knots, points, None).unwrap()),
        PipeError::Disjoined { parameter: 1.0, gap_m } if gap_m > 1.0
    ));
    let far = bezier(
        &[[1e12, 0.0, 0.0], [1e12, 1e-3, 0.0], [1e12, 2e-3, 5e-3]],
        None,
    );
    assert!(matches!(refused(&far), PipeError::FarAway { .. }));
}

#[test]
fn bounds_scale_with_the_spine_and_do_not_move_with_it() {
    for name in ["hook", "example-11.6.2", "near-cusp"] {
        let (case, limits) = case(name);
        let curve = case.curve();
        for (factor, shift) in [(1e-6, 0.0), (1e3, 0.0), (1.0, 10.0), (1e-60, 0.0)] {
            let points = curve
                .points()
                .iter()
                .map(|p| p * factor + palpate_geometry::math::Vector3::repeat(shift))
                .collect();
            let weights = curve
                .weights()
                .map(|weights| weights.iter().map(|w| w * 1e5).collect());
            let moved =
                PipeLimits::of(&Curve::new(curve.knots().clone(), points, weights).unwrap())
                    .unwrap();
            assert_eq!(
                moved.body.pairs.len(),
                limits.body.pairs.len(),
                "{name} × {factor} + {shift}"
            );
            for ((_, a), (_, b)) in moved.bounds_m().iter().zip(limits.bounds_m()) {
                let (a, b) = (a.unwrap_or(f64::MAX), b.map_or(f64::MAX, |b| b * factor));
                assert!(
                    (a - b).abs() <= 1e-9 * b,
                    "{name} × {factor} + {shift}: {a} is not {b}"
                );
            }
        }
    }
}

#[test]
fn a_crossing_is_a_pair_at_distance_zero() {
    let (_, limits) = case("crossing");
    let first = limits.body.pairs[0];
    assert_eq!(first.kind, PairKind::Crossing);
    assert!(first.distance_m < 2e-15, "{}", first.distance_m);
}
