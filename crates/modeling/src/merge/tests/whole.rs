//! What a merge gives back, against closed forms, exact operations and slow twins.

use super::super::cases::cases;
use super::super::sheet::Sheet;
use super::super::turn::Turn;
use super::super::*;
use super::{halves, wavy};
use palpate_geometry::basis::{Blending, BlendingInverse};
use palpate_geometry::math::Random;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, GridSpec};

fn spec(continuity: usize, method: MergeMethod) -> MergeSpec {
    MergeSpec {
        continuity,
        method,
        ..MergeSpec::default()
    }
}

// Two halves of one surface are C^∞ where they meet: with their own speeds as parameters nothing is
// lost by merging them.
#[test]
fn halves_of_a_surface_give_it_back() {
    let mut random = Random(11);
    for round in 0..60 {
        let degree = random.integer(2, 4);
        let across = random.integer(2, 4);
        let whole = wavy(&mut random, [degree, across]);
        let direction = if round % 2 == 0 {
            Direction::U
        } else {
            Direction::V
        };
        let k = whole.knots(direction).degree();
        let [a, b] = halves(&mut random, &whole, direction);
        // Laid in any way: edges are found.
        let turns: Vec<Turn> = Turn::all().collect();
        let patches = [
            turns[random.integer(0, 7)].of(&a),
            turns[random.integer(0, 7)].of(&b),
        ];
        for (method, bar_m) in [
            (MergeMethod::Constrained, 1e-9),
            (MergeMethod::Exact, 1e-12),
        ] {
            let merged = merge(&patches, &spec(k - 1, method)).unwrap();
            let report = merged.report(&patches);
            let d = report.deviation;
            assert!(
                d.maximum_m < bar_m,
                "round {round}, {method:?}: off by {} m",
                d.maximum_m
            );
            assert_eq!(d.points, 2 * 101 * 101);
            let seam = report.seams[0].1;
            assert!(
                seam.gap_m < 1e-15 && seam.first_jump < 1e-9,
                "round {round}, {method:?}: {seam:?}"
            );
            assert!(
                k < 3 || seam.second_jump < 1e-8,
                "round {round}, {method:?}: {seam:?}"
            );
        }
    }
}

// Merged nets are linear in the patches' nets, and both directions are fitted one after the other:
// a dense fit of all samples with the basis layer's own least squares, over the source's knots and
// parameters, must agree.
#[test]
fn the_seed_method_is_the_source_s_formula() {
    let case = &cases()[2];
    let merged = merge(&case.patches, &spec(2, MergeMethod::Seed)).unwrap();
    let turned: Vec<Surface> = merged
        .layout
        .places
        .iter()
        .map(|p| p.turn.of(&case.patches[p.patch]))
        .collect();
    let even = |n: usize| {
        (0..n)
            .map(|k| k as f64 / (n - 1) as f64)
            .collect::<Vec<f64>>()
    };
    let mut samples: Vec<Vec<Vector3>> = Vec::new();
    for patch in &turned {
        samples.extend(even(101).iter().map(|&u| {
            even(101)
                .iter()
                .map(|&v| patch.point(u, v).coords)
                .collect()
        }));
    }
    let u = BlendingInverse::new(Blending::new(merged.surface.knots_u(), &even(202)));
    let v = BlendingInverse::new(Blending::new(merged.surface.knots_v(), &even(101)));
    let (rows, columns) = (merged.surface.net().rows(), merged.surface.net().columns());
    let half: Vec<Vec<Vector3>> = samples
        .iter()
        .map(|row| {
            let (mut out, mut scratch) = (
                vec![Vector3::zeros(); columns],
                vec![Vector3::zeros(); 101 + columns],
            );
            v.fit(row, &mut out, &mut scratch);
            out
        })
        .collect();
    for j in 0..columns {
        let line: Vec<Vector3> = half.iter().map(|row| row[j]).collect();
        let (mut out, mut scratch) = (
            vec![Vector3::zeros(); rows],
            vec![Vector3::zeros(); 202 + rows],
        );
        u.fit(&line, &mut out, &mut scratch);
        for i in 0..rows {
            let gap = (merged.surface.net().at(i, j).coords - out[i]).norm();
            assert!(gap < 1e-12, "control point ({i}, {j}) differs by {gap} m");
        }
    }
    // r = r1 + r2 − 1, s = max(s1, s2).
    let counts = |s: &Surface| (s.net().rows(), s.net().columns());
    let ((r1, s1), (r2, s2)) = (counts(&turned[0]), counts(&turned[1]));
    assert_eq!((rows, columns), (r1 + r2 - 1, s1.max(s2)));
}

// The bar: half the source's standard deviation with as many control points. Case 2 at C⁰ misses
// it: its edges are up to 0.4 mm apart, and three knots at one place cannot bridge that and leave
// both patches alone; it stays below 0.8.
#[test]
fn our_deviation_is_half_of_the_source_s() {
    for case in cases() {
        for continuity in [2, 0] {
            let of = |method| {
                let merged = merge(
                    &case.patches,
                    &MergeSpec {
                        continuity,
                        method,
                        ..case.spec.clone()
                    },
                )
                .unwrap();
                let net = [merged.surface.net().rows(), merged.surface.net().columns()];
                (net, merged.report(&case.patches).deviation)
            };
            let ((net, seed), (ours, constrained)) =
                (of(MergeMethod::Seed), of(MergeMethod::Constrained));
            assert_eq!(net, ours, "case {}", case.number);
            assert_eq!(seed.points, constrained.points);
            let bar = if (case.number, continuity) == (2, 0) {
                0.8
            } else {
                0.5
            };
            let share = constrained.standard_m / seed.standard_m;
            assert!(share <= bar, "case {} C{continuity}: {share}", case.number);
        }
    }
}

#[test]
fn seams_are_as_continuous_as_asked() {
    for case in cases() {
        for method in [MergeMethod::Constrained, MergeMethod::Seed] {
            for continuity in 0..3 {
                let merged = merge(
                    &case.patches,
                    &MergeSpec {
                        continuity,
                        method,
                        ..case.spec.clone()
                    },
                )
                .unwrap();
                for (seam, c) in merged.report(&case.patches).seams {
                    let at = format!(
                        "case {} {method:?} C{continuity} {seam:?}: {c:?}",
                        case.number
                    );
                    assert!(c.gap_m < 1e-14, "{at}");
                    assert!(
                        continuity < 1 || (c.first_jump < 1e-10 && c.tangent_deg < 1e-9),
                        "{at}"
                    );
                    assert!(
                        continuity < 2 || (c.second_jump < 1e-8 && c.curvature_jump_per_m < 1e-6),
                        "{at}"
                    );
                }
            }
        }
    }
    // A crease that no one asked to be smoothed is seen by the same measure.
    let case = &cases()[0];
    let merged = merge(&case.patches, &spec(0, MergeMethod::Constrained)).unwrap();
    assert!(merged.report(&case.patches).seams[0].1.tangent_deg > 10.0);
}

#[test]
fn outer_corners_stay() {
    for case in cases().iter().filter(|case| case.number != 5) {
        let merged = merge(&case.patches, &case.spec).unwrap();
        let turned: Vec<Surface> = merged
            .layout
            .places
            .iter()
            .map(|p| p.turn.of(&case.patches[p.patch]))
            .collect();
        let (rows, columns) = (merged.layout.rows, merged.layout.columns);
        let corner = |s: &Surface, u: bool, v: bool| {
            let net = s.net();
            *net.at(
                if u { net.rows() - 1 } else { 0 },
                if v { net.columns() - 1 } else { 0 },
            )
        };
        for (u, v) in [(false, false), (false, true), (true, false), (true, true)] {
            let place = (if u { rows - 1 } else { 0 }) * columns + if v { columns - 1 } else { 0 };
            let gap = (corner(&merged.surface, u, v) - corner(&turned[place], u, v)).norm();
            assert!(
                gap < 1e-14,
                "case {}: corner ({u}, {v}) off by {gap} m",
                case.number
            );
        }
    }
}

// The distances are those of descent from a point's own parameters; the certified search finds
// nothing nearer.
#[test]
fn distances_are_those_of_the_closest_points() {
    let case = &cases()[1];
    let merged = merge(
        &case.patches,
        &MergeSpec {
            points: 15,
            ..case.spec.clone()
        },
    )
    .unwrap();
    let turned = Sheet::laid(&case.patches, &merged.layout);
    let distances = merged.distances(&turned);
    let mut solver = ClosestSolver::new(&merged.surface);
    let mut k = 0;
    for Sheet { surface: patch, .. } in &turned {
        for i in 0..15 {
            for j in 0..15 {
                let point = patch.point(i as f64 / 14.0, j as f64 / 14.0);
                let closest = solver.closest(&merged.surface, &point).distance;
                assert!(
                    (distances[k] - closest).abs() < 1e-12,
                    "point {k}: {} {closest}",
                    distances[k]
                );
                k += 1;
            }
        }
    }
    assert_eq!(k, distances.len());
}

#[test]
fn statistics_of_known_distances() {
    let d = report::deviation_of(&[4e-5, 0.0, 1e-5, 3e-5]);
    assert_eq!((d.points, d.close, d.maximum_m), (4, 2, 4e-5));
    assert!((d.average_m - 2e-5).abs() < 1e-20 && (d.median_m - 2e-5).abs() < 1e-20);
    assert!(
        (d.standard_m - 2.5e-10_f64.sqrt()).abs() < 1e-19,
        "{}",
        d.standard_m
    );
}

// A crease of some 20 degrees: exact at C⁰; for C² five control points of each line move, and no
// more.
#[test]
fn an_exact_merge_moves_only_what_is_next_to_the_seam() {
    let patches = &cases()[2].patches;
    let elevated: Vec<Surface> = {
        // Edges that agree to the last bit: the second patch starts where the first one ends.
        let [a, b] = halves(&mut Random(3), &patches[0], Direction::U);
        let bent = b.affine(
            &palpate_geometry::math::rotation_by(&Vector3::new(0.0, 0.3, 0.0))
                .to_rotation_matrix()
                .into_inner(),
            &Vector3::zeros(),
        );
        let bent = bent.unwrap();
        let shift = a.net().at(a.net().rows() - 1, 0) - bent.net().at(0, 0);
        let mut bent = bent;
        bent.net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|p| *p += shift);
        // The rotation is about an axis along v; edges that bend in v part, so they are put
        // together.
        let last = a.net().rows() - 1;
        for j in 0..a.net().columns() {
            let columns = bent.net().columns();
            bent.net_mut().points_mut()[j % columns] = *a.net().at(last, j);
        }
        vec![a, bent]
    };
    let creased = merge(&elevated, &spec(0, MergeMethod::Exact)).unwrap();
    assert!(creased.report(&elevated).deviation.maximum_m < 1e-13);
    let smooth = merge(&elevated, &spec(2, MergeMethod::Exact)).unwrap();
    let report = smooth.report(&elevated);
    assert!(
        report.deviation.maximum_m > 1e-6,
        "a crease was smoothed without a deviation"
    );
    assert!(report.seams[0].1.second_jump < 1e-9 && report.before.tangent_deg > 5.0);
    let (r, s) = (creased.surface.net().rows(), smooth.surface.net().rows());
    assert_eq!(r, s + 2);
    let seam = elevated[0].net().rows() - 1;
    let mut kept = 0;
    for j in 0..smooth.surface.net().columns() {
        for i in 0..s {
            let old = if i < seam { i } else { i + 2 };
            let gap = (smooth.surface.net().at(i, j) - creased.surface.net().at(old, j)).norm();
            if i + 3 <= seam || i > seam {
                assert!(gap < 1e-15, "({i}, {j}) moved by {gap} m");
                kept += 1;
            }
        }
    }
    assert!(kept > 0);
}

#[test]
fn crossing_patches_end_before_the_curve() {
    let case = &cases()[4];
    let rows = MergeSpec {
        hide_by: Some(HideBy::Rows),
        ..case.spec.clone()
    };
    let merged = merge(&case.patches, &rows).unwrap();
    let (a, b) = (&merged.rows[0][0].fractions, &merged.rows[0][1].fractions);
    assert!(a.len() < 101 && b.len() < 101 && merged.rows[1][0].fractions.len() == 101);
    // The last rows that show have not reached the other patch; the ones after them have,
    // somewhere.
    let side = |patch: &Surface, other: &Surface, f: f64| {
        let mut solver = ClosestSolver::new(other);
        let knots = patch.knots_u();
        let u = knots.domain().0 + f * knots.length();
        let below = |k: usize| {
            let point = patch.point(u, k as f64 / 40.0);
            let foot = solver.closest(other, &point);
            // Behind an edge there is no side.
            (foot.u > 1e-9 && foot.u < 1.0 - 1e-9).then_some(foot.signed_distance < 0.0)
        };
        (0..=40)
            .map(below)
            .collect::<Vec<_>>()
            .into_iter()
            .flatten()
            .collect::<Vec<bool>>()
    };
    let [first, second] = [&case.patches[0], &case.patches[1]];
    let changes = |sides: &[bool]| sides.iter().any(|s| *s != sides[0]);
    assert!(!changes(&side(first, second, a[a.len() - 1])));
    assert!(!changes(&side(second, first, b[0])));
    let spread: Vec<bool> = [0, 1, 2, 3]
        .iter()
        .flat_map(|k| side(first, second, a[a.len() - 1] + 0.02 * f64::from(*k)))
        .collect();
    assert!(changes(&spread), "the curve was not near");
}

#[test]
fn hidden_rows_do_not_count() {
    let case = &cases()[4];
    let hidden = vec![
        Hidden {
            patch: 0,
            direction: Direction::U,
            range: [0.7, 1.0],
        },
        Hidden {
            patch: 1,
            direction: Direction::U,
            range: [-1.0, 0.25],
        },
    ];
    let merged = merge(
        &case.patches,
        &MergeSpec {
            hidden,
            ..case.spec.clone()
        },
    )
    .unwrap();
    let report = merged.report(&case.patches);
    assert_eq!(
        merged.rows[0][0].fractions.len(),
        71 - usize::from(merged.rows[0][0].fractions.len() == 70)
    );
    assert_eq!(merged.rows[0][1].fractions[0], 0.25);
    assert!(report.deviation.maximum_m < 1e-4, "{:?}", report.deviation);
}

#[test]
fn knots_are_inserted_until_the_tolerance_is_met() {
    let case = &cases()[0];
    let plain = merge(&case.patches, &case.spec).unwrap();
    let fine = merge(
        &case.patches,
        &MergeSpec {
            tolerance_m: Some(1e-4),
            ..case.spec.clone()
        },
    )
    .unwrap();
    assert_eq!(fine.within_tolerance, Some(true));
    assert!(fine.report(&case.patches).deviation.maximum_m <= 1e-4);
    assert!(fine.surface.net().rows() > plain.surface.net().rows());
    // Nothing smooth follows a crease to a picometre: that is said, and there is an end.
    let never = merge(
        &case.patches,
        &MergeSpec {
            tolerance_m: Some(1e-12),
            ..case.spec.clone()
        },
    )
    .unwrap();
    assert_eq!(never.within_tolerance, Some(false));
}

#[test]
fn plans_merge_patches_that_have_moved() {
    let case = &cases()[6];
    let plan = merge(&case.patches, &case.spec).unwrap().plan.unwrap();
    let still = plan.merge(&case.patches).unwrap();
    assert_eq!(
        still,
        merge(&case.patches, &case.spec).unwrap().surface,
        "same patches, same bits"
    );
    // Moved as one, they are merged as one.
    let shift = Vector3::new(0.3, -0.2, 0.1);
    let mut moved = case.patches.clone();
    moved.iter_mut().for_each(|s| {
        s.net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|p| *p += shift)
    });
    let merged = plan.merge(&moved).unwrap();
    for (a, b) in still.net().points().iter().zip(merged.net().points()) {
        assert!((b - a - shift).norm() < 1e-14);
    }
}

#[test]
fn degrees_are_raised_or_lowered() {
    let case = &cases()[5];
    let degree = |rule| {
        let merged = merge(
            &case.patches,
            &MergeSpec {
                degree: rule,
                ..case.spec.clone()
            },
        )
        .unwrap();
        (
            [
                merged.surface.knots_u().degree(),
                merged.surface.knots_v().degree(),
            ],
            merged.report(&case.patches).deviation,
        )
    };
    let (raised, a) = degree(DegreeRule::Raise);
    let (lowered, b) = degree(DegreeRule::Lower);
    assert_eq!((raised, lowered), ([4, 5], [3, 3]));
    assert!(a.maximum_m < 1e-4 && b.maximum_m < 5e-4, "{a:?} {b:?}");
}

#[test]
fn three_in_a_row_become_one() {
    let mut random = Random(21);
    let whole = wavy(&mut random, [3, 3]);
    let [a, rest] = whole.split(Direction::V, 0.3).unwrap();
    let [b, c] = rest.split(Direction::V, 0.65).unwrap();
    let patches = [a, b.reversed(Direction::U), c.swap_uv()];
    for method in [MergeMethod::Constrained, MergeMethod::Exact] {
        let merged = merge(
            &patches,
            &MergeSpec {
                arrangement: Arrangement::Grid {
                    rows: 1,
                    columns: 3,
                },
                ..spec(2, method)
            },
        )
        .unwrap();
        assert_eq!(merged.seams.len(), 2);
        let d = merged.report(&patches).deviation;
        assert!(d.maximum_m < 1e-9, "{method:?}: {d:?}");
    }
}

// A bowl and a handle: the bowl's edge is curved and a tenth wider than the handle's, and they meet
// at an angle.
#[test]
fn a_spoon_s_bowl_takes_its_handle() {
    let (bowl, handle) = spoon();
    let patches = [bowl, handle];
    for continuity in [0, 1, 2] {
        let of = |method| {
            let merged = merge(&patches, &spec(continuity, method)).unwrap();
            let report = merged.report(&patches);
            assert!(continuity == 0 || report.seams[0].1.tangent_deg < 1e-9);
            report.deviation
        };
        let (ours, seed) = (of(MergeMethod::Constrained), of(MergeMethod::Seed));
        assert!(
            ours.standard_m < seed.standard_m,
            "C{continuity}: {ours:?} {seed:?}"
        );
        assert!(ours.average_m < 1e-4, "C{continuity}: {ours:?}");
    }
}

/// u from the tip to the neck and along the handle, v across.
fn spoon() -> (Surface, Surface) {
    let grid = |rows: usize, columns: usize, at: &dyn Fn(f64, f64) -> Point3| {
        let even = |k: usize, n: usize| k as f64 / (n - 1) as f64;
        let points: Vec<Point3> = (0..rows * columns)
            .map(|k| at(even(k / columns, rows), even(k % columns, columns)))
            .collect();
        let spec = GridSpec {
            degree: [3, 3],
            counts: [9, 6],
            periodic: [false; 2],
        };
        Surface::fitted_to_grid(&points, rows, columns, &spec)
            .unwrap()
            .surface
    };
    let bowl = grid(30, 20, &|u, v| {
        let half = 0.004 + 0.016 * libm::sin(std::f64::consts::PI * (0.08 + 0.84 * u));
        let across = 2.0 * v - 1.0;
        let depth =
            0.012 * libm::sin(std::f64::consts::PI * (0.1 + 0.85 * u)) * (1.0 - across * across);
        Point3::new(0.06 * u, half * across, -depth)
    });
    let handle = grid(30, 20, &|u, v| {
        let across = 2.0 * v - 1.0;
        let half = 0.0072 + 0.002 * u;
        Point3::new(
            0.0602 + 0.09 * u,
            half * across,
            -0.0018 * (1.0 - across * across) + 0.02 * u - 0.012 * u * u,
        )
    });
    (bowl, handle)
}
