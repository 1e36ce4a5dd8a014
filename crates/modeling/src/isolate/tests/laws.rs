//! What must hold for every answer.

use super::{ellipsoid, solved};
use crate::isolate::pair::Pair;
use crate::isolate::{Body, IsolateMethod, IsolateSpec, IsolateStatus, Resolution, given, isolate};
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::math::Random;
use palpate_geometry::math::{Pose, Vector3, rotation_by};
use palpate_geometry::surface::{ClosestSolver, Surface};

fn triangles(method: IsolateMethod) -> IsolateSpec {
    IsolateSpec {
        method,
        exact: false,
        fall_back: false,
        ..IsolateSpec::default()
    }
}

fn random_vector(random: &mut Random, size: f64) -> Vector3 {
    Vector3::from_fn(|_, _| random.float(-size, size))
}

#[test]
fn the_gap_is_as_asked_and_nothing_overlaps_on_any_pair() {
    for given in given::all() {
        let [a, b] = given.bodies();
        let gap = 1e-3 * Pair::new(&a, &b, Vector3::zeros()).diameter_m;
        for method in [
            IsolateMethod::Normals,
            IsolateMethod::BestBlend,
            IsolateMethod::Local,
            IsolateMethod::Global,
        ] {
            let bodies = [a.clone(), b.clone()];
            let answer = solved(
                &given,
                &bodies,
                &IsolateSpec {
                    fall_back: true,
                    ..triangles(method)
                },
            );
            assert_eq!(
                answer.status,
                IsolateStatus::Isolated,
                "{} {method:?}",
                given.name
            );
            assert!(
                !a.overlaps(&answer.translation_m, &b),
                "{} {method:?} overlaps",
                given.name
            );
            let found = a.gap_m(&answer.translation_m, &b);
            assert_eq!(Some(found), answer.gap_m);
            assert!(
                (gap..=1.3 * gap).contains(&found),
                "{} {method:?}: gap {found} of {gap}",
                given.name
            );
        }
    }
}

// The surfaces have their own overlap test, which knows nothing of triangles.
#[test]
fn exact_answers_are_free_by_the_test_of_the_surfaces_and_others_are_not() {
    let overlap = |moving: &Surface, fixed: &Surface, by: &Vector3| {
        let moved = moving.transformed(&Pose::translation(by.x, by.y, by.z));
        let (mut first, mut second) = (ClosestSolver::new(fixed), ClosestSolver::new(&moved));
        PairSolver::new(fixed, &moved).overlap(
            PairSide {
                surface: fixed,
                solver: &mut first,
            },
            PairSide {
                surface: &moved,
                solver: &mut second,
            },
        )
    };
    let mut missed = 0;
    for given in given::all().iter().step_by(2) {
        let bodies = given.bodies();
        let exact = solved(
            given,
            &bodies,
            &IsolateSpec {
                exact: true,
                ..triangles(IsolateMethod::Global)
            },
        );
        assert!(
            exact.exact && exact.status == IsolateStatus::Isolated,
            "{}: {exact:?}",
            given.name
        );
        assert!(
            !overlap(&given.moving, &given.fixed, &exact.translation_m),
            "{}",
            given.name
        );
        let rough = solved(given, &bodies, &triangles(IsolateMethod::Global));
        missed += usize::from(overlap(&given.moving, &given.fixed, &rough.translation_m));
    }
    assert!(
        missed > 3,
        "the triangles alone were free where the surfaces overlap {missed} times"
    );
}

#[test]
fn exchanging_the_bodies_turns_the_translation_round() {
    for given in given::all() {
        let [a, b] = given.bodies();
        let there = solved(
            &given,
            &[a.clone(), b.clone()],
            &triangles(IsolateMethod::Global),
        );
        let back = super::isolate_ready(
            (&given.fixed, &b),
            (&given.moving, &a),
            &Vector3::zeros(),
            &triangles(IsolateMethod::Global),
        )
        .unwrap();
        let (there, back) = (there.contact_m, back.contact_m);
        assert!(
            (there.norm() / back.norm() - 1.0).abs() < 0.01,
            "{}: {there} and {back}",
            given.name
        );
        // Symmetric bodies have several shortest ways.
        let symmetric = ["14", "16"].contains(&&given.name[..2]);
        assert!(
            symmetric || (there + back).norm() < 0.05 * there.norm(),
            "{}: {there} and {back}",
            given.name
        );
    }
}

// Directions turn with the bodies; the step length and the signs come from axes, so only methods
// whose one step leads out keep their answer. Pairs 02, 08, 13: one region, one step. Method 7 and
// 5 there as well.
#[test]
fn a_rotation_of_both_bodies_rotates_the_answers_of_methods_3_to_7() {
    let mut random = Random(31);
    for given in given::all()
        .iter()
        .filter(|given| ["02", "08", "13"].contains(&&given.name[..2]))
    {
        for _ in 0..3 {
            let rotation = rotation_by(&random_vector(&mut random, 2.0));
            let pose = Pose::from_parts(Vector3::new(0.3, -0.2, 0.5).into(), rotation);
            let turned = [&given.moving, &given.fixed].map(|surface| surface.transformed(&pose));
            let bodies = [0, 1].map(|k| Body::new(&turned[k], given.cells[k], k).unwrap());
            for method in &IsolateMethod::ALL[2..7] {
                let before = solved(given, &given.bodies(), &triangles(*method)).contact_m;
                let spec = triangles(*method);
                let after = super::isolate_ready(
                    (&turned[0], &bodies[0]),
                    (&turned[1], &bodies[1]),
                    &Vector3::zeros(),
                    &spec,
                );
                let after = after.unwrap().contact_m;
                let change = (after.norm() / before.norm() - 1.0).abs();
                assert!(change < 0.02, "{} {method:?}: {change}", given.name);
            }
        }
    }
}

// For convex bodies the least translation is the least over directions of the overlap of supports:
// no meshes, no trees.
#[test]
fn convex_bodies_part_by_the_least_overlap_of_their_supports() {
    let mut random = Random(5);
    for case in 0..40 {
        let axes = || [0.6, 0.9, 1.2];
        let mut body = |centre: Vector3| {
            let turn = rotation_by(&random_vector(&mut random, 2.0));
            ellipsoid(axes(), Vector3::zeros()).transformed(&Pose::from_parts(centre.into(), turn))
        };
        let moving = body(Vector3::zeros());
        let fixed = body(Vector3::new(0.4, 0.5, 0.3));
        let cells = [36, 21];
        let (a, b) = (
            Body::new(&moving, cells, 0).unwrap(),
            Body::new(&fixed, cells, 1).unwrap(),
        );
        let overlap = |d: &Vector3| {
            let high = b
                .points
                .iter()
                .map(|p| d.dot(p))
                .fold(f64::NEG_INFINITY, f64::max);
            let low = a
                .points
                .iter()
                .map(|p| d.dot(p))
                .fold(f64::INFINITY, f64::min);
            high - low
        };
        let least = least_over_directions(&overlap);
        let spec = IsolateSpec {
            resolution: Resolution::Cells(cells),
            ..triangles(IsolateMethod::Global)
        };
        let found = isolate(&moving, &fixed, &spec).unwrap().contact_m.norm();
        assert!(
            (found / least - 1.0).abs() < 2e-3,
            "case {case}: {found}, supports say {least}"
        );
    }
}

/// The least value over the sphere: a spiral of 500, then ever smaller steps from the best.
fn least_over_directions(f: &dyn Fn(&Vector3) -> f64) -> f64 {
    let spread = crate::isolate::search::cone(&Vector3::z(), std::f64::consts::PI, 500);
    let mut tops: Vec<(f64, Vector3)> = spread.iter().map(|d| (f(d), *d)).collect();
    tops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    for (mut value, mut at) in tops.into_iter().take(4) {
        let mut step = 0.1;
        while step > 1e-5 {
            let around = crate::isolate::search::cone(&at, step, 12);
            let best = around
                .iter()
                .map(|d| (f(d), *d))
                .fold((value, at), |a, b| if b.0 < a.0 { b } else { a });
            if best.0 < value {
                (value, at) = best
            } else {
                step *= 0.5
            }
        }
        least = least.min(value);
    }
    least
}

#[test]
fn a_limit_on_the_turn_is_kept_and_costs_length() {
    for given in given::all()
        .iter()
        .filter(|given| ["03", "06", "11"].contains(&&given.name[..2]))
    {
        let bodies = given.bodies();
        let mut last = 0.0;
        for most in [180.0, 20.0, 5.0, 0.0] {
            let spec = IsolateSpec {
                max_turn_deg: Some(most),
                exact: true,
                ..triangles(IsolateMethod::Global)
            };
            let answer = solved(given, &bodies, &spec);
            assert_eq!(
                answer.status,
                IsolateStatus::Isolated,
                "{} at most {most}",
                given.name
            );
            assert!(
                answer.turn_deg.unwrap() <= most + 1e-6,
                "{}: {answer:?}",
                given.name
            );
            assert!(
                answer.contact_m.norm() >= 0.999 * last,
                "{} at most {most}: {answer:?}",
                given.name
            );
            last = answer.contact_m.norm();
        }
    }
}

// With no turn at all there is one direction: that of method 5.
#[test]
fn no_turn_at_all_is_the_line_of_the_centroids() {
    let given = &given::all()[2];
    let bodies = given.bodies();
    let none = solved(
        given,
        &bodies,
        &IsolateSpec {
            max_turn_deg: Some(0.0),
            ..triangles(IsolateMethod::Global)
        },
    );
    let line = solved(given, &bodies, &triangles(IsolateMethod::Centroids));
    assert!(
        (none.contact_m.norm() / line.contact_m.norm() - 1.0).abs() < 2e-3,
        "{none:?}\n{line:?}"
    );
}

// A shift by 3 mm between two frames: the earlier answer is a start that needs no regions.
#[test]
fn a_local_search_from_an_earlier_answer_finds_the_same_minimum() {
    let given = &given::all()[7];
    let bodies = given.bodies();
    let cold = solved(given, &bodies, &triangles(IsolateMethod::Global));
    for shift in [
        Vector3::zeros(),
        Vector3::new(0.003, 0.0, 0.0),
        Vector3::new(-0.003, 0.001, 0.0),
    ] {
        let spec = IsolateSpec {
            warm_m: Some(cold.translation_m + shift),
            ..triangles(IsolateMethod::Local)
        };
        let warm = solved(given, &bodies, &spec);
        assert!(
            (warm.contact_m.norm() / cold.contact_m.norm() - 1.0).abs() < 1e-3,
            "{warm:?}"
        );
    }
}

#[test]
fn halving_the_step_ends_when_the_length_changes_by_less_than_the_gap() {
    let moving = ellipsoid([1.0; 3], Vector3::zeros());
    let fixed = ellipsoid([1.0; 3], Vector3::new(1.5, 0.3, 0.2));
    let spec = IsolateSpec {
        resolution: Resolution::Halving,
        ..triangles(IsolateMethod::Global)
    };
    let answer = isolate(&moving, &fixed, &spec).unwrap();
    let gap = 1e-3
        * Pair::new(
            &Body::new(&moving, answer.cells[0], 0).unwrap(),
            &Body::new(&fixed, answer.cells[1], 1).unwrap(),
            Vector3::zeros(),
        )
        .diameter_m;
    assert!(answer.change_m.unwrap() < 1.01 * gap, "{answer:?}");
    assert!(answer.cells[0][0] > 36, "{answer:?}");
    // Second order: coarse triangles are off by more than the gap, in the direction of too short.
    let rough = isolate(
        &moving,
        &fixed,
        &IsolateSpec {
            resolution: Resolution::Cells([12, 8]),
            ..spec
        },
    )
    .unwrap();
    assert!(
        answer.contact_m.norm() - rough.contact_m.norm() > gap,
        "{rough:?}"
    );
}

// Balls of a rational sphere: the shortest way is along the centres, as long as what is missing
// between them.
#[test]
fn balls_part_along_their_centres_to_the_digits_of_the_gap() {
    let fixed = palpate_geometry::surface::builtin("sphere", None, Some(0.05)).unwrap();
    let mut random = Random(17);
    for _ in 0..12 {
        let between = random_vector(&mut random, 1.0).normalize() * random.float(0.02, 0.099);
        let moving = fixed.transformed(&Pose::translation(between.x, between.y, between.z));
        let spec = IsolateSpec {
            gap_m: Some(1e-5),
            ..IsolateSpec::default()
        };
        let answer = isolate(&moving, &fixed, &spec).unwrap();
        let wanted = 0.1 - between.norm() + answer.gap_m.unwrap();
        let found = answer.translation_m.norm();
        // The length is at its least there, so an angle of 1e-3 costs a millionth.
        assert!(
            (found / wanted - 1.0).abs() < 1e-4,
            "{found}, {wanted}: {answer:?}"
        );
    }
}
