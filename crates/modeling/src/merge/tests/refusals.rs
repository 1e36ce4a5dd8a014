//! What is refused, and with what words.

use super::super::cases::cases;
use super::super::*;
use super::{halves, wavy};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Random;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, builtin};

fn pair() -> [Surface; 2] {
    let mut random = Random(2);
    let whole = wavy(&mut random, [3, 3]);
    halves(&mut random, &whole, Direction::U)
}

fn refusal(surfaces: &[Surface], spec: &MergeSpec) -> MergeError {
    merge(surfaces, spec).expect_err("it should have been refused")
}

fn shifted(surface: &Surface, shift: Vector3) -> Surface {
    let mut moved = surface.clone();
    moved
        .net_mut()
        .points_mut()
        .iter_mut()
        .for_each(|p| *p += shift);
    moved
}

#[test]
fn too_few_patches_or_a_grid_that_they_do_not_fill() {
    let [a, b] = pair();
    assert_eq!(
        refusal(&[], &MergeSpec::default()),
        MergeError::TooFew { given: 0 }
    );
    assert_eq!(
        refusal(std::slice::from_ref(&a), &MergeSpec::default()),
        MergeError::TooFew { given: 1 }
    );
    let three = [a.clone(), b.clone(), a.clone()];
    assert_eq!(
        refusal(&three, &MergeSpec::default()),
        MergeError::NoGrid { given: 3 }
    );
    for (rows, columns) in [(2, 2), (0, 5), (usize::MAX, 2)] {
        let spec = MergeSpec {
            arrangement: Arrangement::Grid { rows, columns },
            ..MergeSpec::default()
        };
        assert_eq!(
            refusal(&[a.clone(), b.clone()], &spec),
            MergeError::Arrangement {
                given: 2,
                rows,
                columns
            }
        );
    }
}

#[test]
fn continuity_that_the_degree_does_not_give() {
    let patches = pair();
    for continuity in [3, 4, usize::MAX] {
        let wanted = MergeError::Continuity {
            continuity,
            degree: 3,
            direction: 'u',
        };
        for method in [
            MergeMethod::Seed,
            MergeMethod::Constrained,
            MergeMethod::Exact,
        ] {
            assert_eq!(
                refusal(
                    &patches,
                    &MergeSpec {
                        continuity,
                        method,
                        ..MergeSpec::default()
                    }
                ),
                wanted
            );
        }
    }
}

#[test]
fn weights_and_nets_that_are_no_nets() {
    let [a, b] = pair();
    let mut weights = vec![1.0; b.net().points().len()];
    let equal = Surface::new(
        b.knots_u().clone(),
        b.knots_v().clone(),
        b.net().clone(),
        Some(weights.clone()),
    )
    .unwrap();
    assert!(
        merge(&[a.clone(), equal], &MergeSpec::default()).is_ok(),
        "equal weights weigh nothing"
    );
    weights[3] = 2.0;
    let rational = Surface::new(
        b.knots_u().clone(),
        b.knots_v().clone(),
        b.net().clone(),
        Some(weights),
    )
    .unwrap();
    assert_eq!(
        refusal(&[a.clone(), rational], &MergeSpec::default()),
        MergeError::Rational { patch: 1 }
    );
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let mut broken = a.clone();
        broken.net_mut().points_mut()[5].y = bad;
        assert_eq!(
            refusal(&[broken, b.clone()], &MergeSpec::default()),
            MergeError::NotFinite { patch: 0, index: 5 }
        );
    }
}

#[test]
fn edges_that_cannot_be_paired() {
    let [a, b] = pair();
    let far = shifted(&b, Vector3::new(5.0, 0.0, 0.0));
    assert!(matches!(
        refusal(&[a.clone(), far], &MergeSpec::default()),
        MergeError::TooFar { a: 0, b: 1, .. }
    ));
    // A closed surface with poles has no edges at all.
    let drop = builtin("teardrop", None, None).unwrap();
    assert_eq!(
        refusal(&[drop, b], &MergeSpec::default()),
        MergeError::NoEdge { patch: 0 }
    );
    // Every point at one place.
    let knots = KnotVector::clamped_uniform(3, 5).unwrap();
    let net = ControlNet::new(5, 5, vec![Point3::origin(); 25]).unwrap();
    let point = Surface::new(knots.clone(), knots, net, None).unwrap();
    assert_eq!(
        refusal(&[a, point], &MergeSpec::default()),
        MergeError::NoEdge { patch: 1 }
    );
}

#[test]
fn a_t_junction_is_named() {
    let [a, b] = pair();
    // Half the edge only.
    let [half, _] = b.split(Direction::V, 0.45).unwrap();
    let error = refusal(&[a.clone(), half.clone()], &MergeSpec::default());
    assert!(
        matches!(error, MergeError::TJunction { a: 0, b: 1, .. }),
        "{error}"
    );
    // Two patches on one edge of a third, as a row.
    let [left, right] = b.split(Direction::V, 0.5).unwrap();
    let spec = MergeSpec {
        arrangement: Arrangement::Grid {
            rows: 3,
            columns: 1,
        },
        ..MergeSpec::default()
    };
    let error = refusal(&[a.clone(), left, right], &spec);
    assert!(
        matches!(
            error,
            MergeError::TJunction { .. } | MergeError::TooFar { .. }
        ),
        "{error}"
    );
    // Slid along the edge by half of it.
    let slid = shifted(&b, Vector3::new(0.0, 0.04, 0.0));
    assert!(matches!(
        refusal(&[a, slid], &MergeSpec::default()),
        MergeError::TJunction { .. }
    ));
}

#[test]
fn hidden_parts_that_make_no_sense() {
    let patches = pair();
    let hide = |patch, direction, range| {
        let hidden = vec![Hidden {
            patch,
            direction,
            range,
        }];
        refusal(
            &patches,
            &MergeSpec {
                hidden,
                ..MergeSpec::default()
            },
        )
    };
    let [start, end] = [
        patches[0].knots_u().domain().0,
        patches[0].knots_u().domain().1,
    ];
    let inside = [start + 0.1, start + 0.2];
    for error in [
        hide(2, Direction::U, [0.0, 0.1]),
        hide(0, Direction::V, [0.9, 1.0]),
        hide(0, Direction::U, inside),
        hide(0, Direction::U, [start, end]),
        hide(0, Direction::U, [end, start]),
        hide(0, Direction::U, [f64::NAN, end]),
        hide(0, Direction::U, [end + 1.0, end + 2.0]),
    ] {
        assert!(matches!(error, MergeError::Hidden { .. }), "{error}");
    }
    let most = [start + 0.02 * (end - start), end];
    assert!(matches!(
        hide(0, Direction::U, most),
        MergeError::TooFewRows { patch: 0, .. }
    ));
}

#[test]
fn numbers_out_of_range() {
    let patches = pair();
    for points in [0, 1, 4, 1002] {
        assert!(matches!(
            refusal(
                &patches,
                &MergeSpec {
                    points,
                    ..MergeSpec::default()
                }
            ),
            MergeError::Points { .. }
        ));
    }
    assert!(matches!(
        refusal(
            &cases()[2].patches,
            &MergeSpec {
                points: 6,
                ..MergeSpec::default()
            }
        ),
        MergeError::TooFewRows { .. }
    ));
    for least_span in [0.0, -1.0, 0.5, f64::NAN] {
        assert!(matches!(
            refusal(
                &patches,
                &MergeSpec {
                    least_span,
                    ..MergeSpec::default()
                }
            ),
            MergeError::Value { .. }
        ));
    }
    for tolerance in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        let spec = MergeSpec {
            tolerance_m: Some(tolerance),
            ..MergeSpec::default()
        };
        assert!(matches!(refusal(&patches, &spec), MergeError::Value { .. }));
    }
}

#[test]
fn what_the_exact_method_does_not_take() {
    let case = &cases()[1];
    let exact = MergeSpec {
        method: MergeMethod::Exact,
        ..MergeSpec::default()
    };
    let error = refusal(&case.patches, &exact);
    assert!(
        matches!(error, MergeError::Apart { gap_m, .. } if gap_m > 1e-4),
        "{error}"
    );
    let tolerance = MergeSpec {
        tolerance_m: Some(1e-6),
        ..exact.clone()
    };
    assert!(matches!(
        refusal(&pair(), &tolerance),
        MergeError::NotExact { .. }
    ));
    let lower = MergeSpec {
        degree: DegreeRule::Lower,
        ..exact
    };
    assert!(matches!(
        refusal(&pair(), &lower),
        MergeError::NotExact { .. }
    ));
}

#[test]
fn a_plan_is_for_its_own_patches() {
    let patches = pair();
    let plan = merge(&patches, &MergeSpec::default())
        .unwrap()
        .plan
        .unwrap();
    assert!(matches!(
        plan.merge(&patches[..1]),
        Err(MergeError::Arrangement { .. })
    ));
    let finer = patches[1].refined_to(12, 12).unwrap();
    assert_eq!(
        plan.merge(&[patches[0].clone(), finer]),
        Err(MergeError::OtherNet { patch: 1 })
    );
}

// Patches of all degrees, near and far, turned and mirrored, with every request: an answer is
// finite and as continuous as asked, or there is a reason.
#[test]
fn whatever_is_asked_is_answered_or_refused() {
    let mut random = Random(77);
    let (mut merged, mut refused) = (0, 0);
    for _ in 0..400 {
        let patch = |random: &mut Random| {
            let degrees = [random.integer(1, 5), random.integer(1, 5)];
            wavy(random, degrees)
        };
        let a = patch(&mut random);
        let place = Vector3::new(
            random.float(0.02, 0.13),
            random.float(-0.02, 0.02),
            random.float(-0.01, 0.01),
        );
        let turns: Vec<Turn> = Turn::all().collect();
        let b = turns[random.integer(0, 7)].of(&shifted(&patch(&mut random), place));
        let spec = MergeSpec {
            continuity: random.integer(0, 4),
            method: [
                MergeMethod::Seed,
                MergeMethod::Constrained,
                MergeMethod::Exact,
            ][random.integer(0, 2)],
            degree: [DegreeRule::Raise, DegreeRule::Lower][random.integer(0, 1)],
            arrangement: [
                Arrangement::Closest,
                Arrangement::Edges([Edge::U1, Edge::V0]),
            ][random.integer(0, 9) / 9],
            points: random.integer(9, 31),
            least_span: random.float(0.001, 0.2),
            tolerance_m: (random.integer(0, 9) == 0).then_some(1e-4),
            ..MergeSpec::default()
        };
        let Ok(answer) = merge(&[a.clone(), b.clone()], &spec) else {
            refused += 1;
            continue;
        };
        merged += 1;
        let report = answer.report(&[a, b]);
        let d = report.deviation;
        assert!(
            answer
                .surface
                .net()
                .points()
                .iter()
                .all(|p| p.iter().all(|x| x.abs() < 1.0)),
            "{spec:?}"
        );
        assert!(
            [d.average_m, d.median_m, d.standard_m, d.maximum_m]
                .iter()
                .all(|x| x.is_finite()),
            "{spec:?}: {d:?}"
        );
        for (_, c) in &report.seams {
            assert!(
                c.gap_m < 1e-12 && c.curvature_per_m.is_finite(),
                "{spec:?}: {c:?}"
            );
            assert!(
                spec.continuity < 1 || c.first_jump < 1e-7,
                "{spec:?}: {c:?}"
            );
        }
    }
    assert!(
        merged > 100 && refused > 30,
        "{merged} merged, {refused} refused"
    );
}

// Scaled to [0, 1] the short span would be 1e-110 long: no knot vector has it, so no patch either.
#[test]
fn a_span_that_vanishes_beside_its_domain_is_refused_before_a_merge() {
    let mut knots = vec![0.0; 4];
    knots.push(1e-60);
    knots.extend([1e50; 4]);
    assert!(KnotVector::new(3, knots).is_err());
}
