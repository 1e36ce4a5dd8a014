//! Patches that end on curves, against figures of another program and against closed forms.

use super::super::*;
use super::wavy;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Random};
use palpate_geometry::surface::{ClosestSolver, ControlNet, Surface, Trim, file};
use serde_json::Value;

/// Two patches with their trims, and what another program made of them.
struct Given {
    name: String,
    patches: [Surface; 2],
    trims: [Trim; 2],
    continuity: usize,
    document: Value,
}

/// From one border to the other, v rising; closed round what lies before (or behind) it.
fn closed(curve: &[[f64; 2]], keeps_below: bool) -> Vec<[f64; 2]> {
    let (start, end) = (curve[0], curve[curve.len() - 1]);
    match keeps_below {
        true => {
            let corners = [[0.0, end[1]], [0.0, start[1]]];
            curve.iter().copied().chain(corners).collect()
        }
        false => {
            let corners = [[1.0, start[1]], [1.0, end[1]]];
            corners
                .into_iter()
                .chain(curve.iter().rev().copied())
                .collect()
        }
    }
}

fn given() -> Vec<Given> {
    let document: Value = serde_json::from_str(include_str!("../data/trimmed.json")).unwrap();
    let cases = document["cases"].as_array().unwrap();
    let one = |case: &Value| {
        let surface = |name: &str| {
            let index = case[name].as_u64().unwrap() as usize;
            file::from_value(&document["surfaces"][index]).unwrap()
        };
        let patches = [surface("a"), surface("b")];
        let trim = |k: usize| {
            let name = ["trim_a", "trim_b"][k];
            let curve: Vec<[f64; 2]> = serde_json::from_value(case[name].clone()).unwrap();
            Trim::new(&patches[k], vec![closed(&curve, k == 0)]).unwrap()
        };
        let trims = [trim(0), trim(1)];
        let name = case["case"].as_str().unwrap().to_owned();
        Given {
            continuity: if name.ends_with("C0") { 0 } else { 2 },
            name,
            patches,
            trims,
            document: case.clone(),
        }
    };
    cases.iter().map(one).collect()
}

fn spec(trims: &[Trim], hide_by: Option<HideBy>) -> MergeSpec {
    MergeSpec {
        trims: trims.iter().cloned().map(Some).collect(),
        hide_by,
        ..MergeSpec::default()
    }
}

fn seen(merged: &Merged, by: HideBy) -> Seen {
    let reading = merged.readings.iter().find(|r| r.hide_by == by).unwrap();
    reading.outcome.clone().unwrap()
}

// The source's way first: the same rows are dropped, and what they miss is about as much. The reference's fit of lines is not
// ours (at C⁰ it has a row of control points more), so lines are compared from above only.
#[test]
fn figures_are_those_of_another_program() {
    for case in given() {
        let of = |method, by| {
            let spec = MergeSpec {
                continuity: case.continuity,
                method,
                ..spec(&case.trims, Some(by))
            };
            seen(&merge(&case.patches, &spec).unwrap(), by)
        };
        let reference =
            |by: HideBy, name: &str| case.document["results"][by.name()][name].as_f64().unwrap();
        let source = of(MergeMethod::Seed, HideBy::Rows);
        let used = source.deviation.points - source.lost;
        assert_eq!(used, reference(HideBy::Rows, "points_used") as usize);
        for method in [MergeMethod::Seed, MergeMethod::Constrained] {
            let lines = of(method, HideBy::Lines);
            assert_eq!(lines.lost, 0, "{}", case.name);
            assert_eq!(lines.deviation.points, source.deviation.points);
            let share = lines.deviation.standard_m / source.deviation.standard_m;
            assert!(share <= 0.5, "{} {method:?}: {share}", case.name);
            for (by, seen, [least, most]) in [
                (HideBy::Rows, &source, [0.7, 1.1]),
                (HideBy::Lines, &lines, [0.0, 1.8]),
            ] {
                let d = &seen.deviation;
                for (name, ours) in [
                    ("average", d.average_m),
                    ("standard", d.standard_m),
                    ("maximum", d.maximum_m),
                ] {
                    let share = ours * 1e3 / reference(by, name);
                    let fits = share >= least && share <= most;
                    assert!(fits, "{} {method:?} {by:?} {name}: {share}", case.name);
                }
            }
        }
    }
}

#[test]
fn the_better_way_is_taken() {
    for case in given() {
        let spec = MergeSpec {
            continuity: case.continuity,
            ..spec(&case.trims, None)
        };
        let merged = merge(&case.patches, &spec).unwrap();
        let of = |by| seen(&merged, by).deviation.standard_m;
        let (rows, lines) = (of(HideBy::Rows), of(HideBy::Lines));
        // Patches that are one smooth surface go on as one; rows of a crease bridge it.
        let smooth = case.name.contains("smooth");
        let better = if smooth { HideBy::Rows } else { HideBy::Lines };
        assert_eq!(merged.hide_by, Some(better), "{}", case.name);
        assert_eq!(rows < lines, smooth, "{}: {rows} {lines}", case.name);
        let again = merged.plan.as_ref().unwrap().merge(&case.patches);
        assert_eq!(again.unwrap(), merged.surface, "{}", case.name);
        let report = merged.report(&case.patches);
        assert_eq!(report.deviation.standard_m, rows.min(lines));
        let seam = &report.seams[0].1;
        assert!(seam.gap_m < 1e-14, "{seam:?}");
        assert!(case.continuity < 2 || seam.second_jump < 1e-8, "{seam:?}");
    }
}

/// A roof of two planes: they meet over an oblique line, at which both are trimmed. Degree 3, 0.1 m wide.
fn roof() -> ([Surface; 2], [[[f64; 2]; 2]; 2]) {
    let ridge = |y: f64| 0.05 + 0.2 * y;
    let plane = |start: f64, rise: f64| {
        let knots = KnotVector::clamped_uniform(3, 7).unwrap();
        let places = knots.greville();
        let at = |u: f64, v: f64| {
            let (x, y) = (start + 0.08 * u, 0.1 * v);
            Point3::new(x, y, rise * (x - ridge(y)))
        };
        let points = places
            .iter()
            .flat_map(|u| places.iter().map(move |v| at(*u, *v)));
        let net = ControlNet::new(7, 7, points.collect()).unwrap();
        Surface::new(knots.clone(), knots, net, None).unwrap()
    };
    let curve = |start: f64| [0.0, 1.0].map(|v| [(ridge(0.1 * v) - start) / 0.08, v]);
    let starts = [0.0, 0.04];
    let patches = [plane(starts[0], 0.5), plane(starts[1], -0.4)];
    (patches, starts.map(curve))
}

/// A loop on the patch that a turn makes of its own.
fn turned(turn: Turn, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let forth = |&[u, v]: &[f64; 2]| {
        let [a, b] = if turn.swap { [v, u] } else { [u, v] };
        let a = if turn.reverse_u { 1.0 - a } else { a };
        [a, if turn.reverse_v { 1.0 - b } else { b }]
    };
    let mut places: Vec<[f64; 2]> = places.iter().map(forth).collect();
    if turn.swap ^ turn.reverse_u ^ turn.reverse_v {
        places.reverse();
    }
    places
}

// Lines on planes that end on a straight curve make a bilinear surface: nothing is missed, however the patches lie, in either
// order, with a loop round what is kept or the other way round what is not.
#[test]
fn a_roof_is_merged_without_a_deviation_however_it_is_laid() {
    let (patches, curves) = roof();
    let ring = |k: usize, round_the_rest: bool| {
        let mut ring = closed(&curves[k], (k == 0) != round_the_rest);
        if round_the_rest {
            ring.reverse();
        }
        ring
    };
    for (k, turn) in Turn::all().enumerate() {
        for other in Turn::all() {
            let mut surfaces = vec![turn.of(&patches[0]), other.of(&patches[1])];
            let rings = [0, 1].map(|patch| ring(patch, k % 2 == 1));
            let mut trims = vec![
                Trim::new(&surfaces[0], vec![turned(turn, &rings[0])]).unwrap(),
                Trim::new(&surfaces[1], vec![turned(other, &rings[1])]).unwrap(),
            ];
            if other.swap {
                surfaces.reverse();
                trims.reverse();
            }
            let spec = MergeSpec {
                continuity: 0,
                points: 31,
                ..spec(&trims, None)
            };
            let merged = merge(&surfaces, &spec).unwrap();
            let what = format!("{turn:?} {other:?} {:?}", merged.readings);
            assert_eq!(merged.hide_by, Some(HideBy::Lines), "{what}");
            let lines = seen(&merged, HideBy::Lines);
            assert!(
                lines.lost == 0 && lines.deviation.maximum_m < 1e-12,
                "{what}"
            );
            assert!(
                seen(&merged, HideBy::Rows).deviation.maximum_m > 1e-4,
                "{what}"
            );
        }
    }
}

/// A random smooth surface, cut twice so that the parts overlap, and bent apart where they do; trimmed along one random graph.
fn random_pair(random: &mut Random) -> ([Surface; 2], [Trim; 2], impl Fn(f64) -> f64 + use<>) {
    let whole = wavy(random, [3, 3]);
    let [a, _] = whole.split(Direction::U, 0.65).unwrap();
    let [_, b] = whole.split(Direction::U, 0.35).unwrap();
    let waves: Vec<[f64; 2]> = (1..4)
        .map(|_| [random.float(-0.03, 0.03), random.float(0.0, 6.0)])
        .collect();
    let graph = move |v: f64| {
        let terms = waves.iter().enumerate();
        let sum: f64 = terms
            .map(|(k, [size, phase])| size * libm::sin(4.0 * k as f64 * v + phase))
            .sum();
        0.5 + sum
    };
    let curve: Vec<[f64; 2]> = (0..=40)
        .map(|k| f64::from(k) / 40.0)
        .map(|v| [graph(v), v])
        .collect();
    let inside = |s: &Surface, below: bool| {
        let mut ring = closed(&curve, below);
        let (start, end) = s.knots_u().domain();
        ring.iter_mut().for_each(|p| p[0] = p[0].clamp(start, end));
        Trim::new(s, vec![ring]).unwrap()
    };
    let trims = [inside(&a, true), inside(&b, false)];
    ([a, b], trims, graph)
}

// The figures of a reading, point by point, from the certified closest points and the graph itself.
#[test]
fn readings_of_random_patches_are_those_of_all_points_that_show() {
    let mut random = Random(31);
    for round in 0..20 {
        let (patches, trims, _) = random_pair(&mut random);
        let spec = MergeSpec {
            points: 25,
            ..spec(&trims, None)
        };
        let merged = merge(&patches, &spec).unwrap();
        let mut solver = ClosestSolver::new(&merged.surface);
        let mut distances = Vec::new();
        for (patch, trim) in patches.iter().zip(&trims) {
            for (i, j) in (0..25).flat_map(|i| (0..25).map(move |j| (i, j))) {
                let [f, g] = [i, j].map(|k| f64::from(k) / 24.0);
                if keeps(trim, [f, g]) {
                    let at = |k: &KnotVector, f: f64| k.domain().0 + f * k.length();
                    let point = patch.point(at(patch.knots_u(), f), at(patch.knots_v(), g));
                    distances.push(solver.closest(&merged.surface, &point).distance);
                }
            }
        }
        let wanted = report::deviation_of(&distances);
        let taken = seen(&merged, merged.hide_by.unwrap()).deviation;
        assert_eq!(taken.points, wanted.points, "round {round}");
        for (ours, certified) in [
            (taken.average_m, wanted.average_m),
            (taken.standard_m, wanted.standard_m),
            (taken.maximum_m, wanted.maximum_m),
        ] {
            assert!(
                (ours - certified).abs() < 1e-12,
                "round {round}: {ours} {certified}"
            );
        }
        let lines = seen(&merged, HideBy::Lines);
        let whole = patches[0].size();
        assert!(
            lines.lost == 0 && lines.deviation.standard_m < 0.01 * whole,
            "{lines:?}"
        );
    }
}

/// Inside of the one loop of a trim, or within 1e-12 of it: by the parity of sides passed towards −u.
fn keeps(trim: &Trim, [u, v]: [f64; 2]) -> bool {
    let ring = &trim.loops()[0];
    let sides = || ring.iter().zip(ring.iter().cycle().skip(1));
    let near = sides().any(|(a, b)| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let t =
            (((u - a[0]) * dx + (v - a[1]) * dy) / (dx * dx + dy * dy).max(1e-300)).clamp(0.0, 1.0);
        libm::hypot(a[0] + t * dx - u, a[1] + t * dy - v) < 1e-12
    });
    let passed = sides().filter(|(a, b)| {
        (a[1] <= v) != (b[1] <= v) && a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) < u
    });
    near || passed.count() % 2 == 1
}

#[test]
fn crossing_patches_lose_nothing_by_lines() {
    let case = &cases::cases()[4];
    for continuity in [0, 2] {
        let spec = MergeSpec {
            continuity,
            ..case.spec.clone()
        };
        let merged = merge(&case.patches, &spec).unwrap();
        let (rows, lines) = (seen(&merged, HideBy::Rows), seen(&merged, HideBy::Lines));
        assert!(rows.lost > 0 && lines.lost == 0);
        assert!(
            lines.deviation.standard_m < 0.5 * rows.deviation.standard_m,
            "{rows:?} {lines:?}"
        );
        assert_eq!(merged.hide_by, Some(HideBy::Lines));
    }
}

// Patches with a crease cross about where they would be trimmed.
#[test]
fn patches_that_cross_are_merged_as_if_they_were_trimmed_there() {
    for case in given().iter().filter(|case| case.name.contains("crease")) {
        let of = |trims: &[Trim]| {
            let spec = MergeSpec {
                continuity: case.continuity,
                ..spec(trims, None)
            };
            let merged = merge(&case.patches, &spec).unwrap();
            assert_eq!(
                merged.hide_by,
                Some(HideBy::Lines),
                "{}: {:?}",
                case.name,
                merged.readings
            );
            seen(&merged, HideBy::Lines).deviation.standard_m
        };
        let (crossed, trimmed) = (of(&[]), of(&case.trims));
        assert!(
            crossed < 2.0 * trimmed,
            "{}: {crossed} {trimmed}",
            case.name
        );
    }
}

/// Trims of the roof's first patch with this loop, the second whole.
fn of_first(ring: &[[f64; 2]], by: Option<HideBy>) -> Result<Merged, MergeError> {
    let (patches, _) = roof();
    let trims = [Trim::new(&patches[0], vec![ring.to_vec()]).unwrap()];
    let spec = MergeSpec {
        arrangement: Arrangement::Edges([Edge::U1, Edge::U0]),
        find_overlap: false,
        ..spec(&trims, by)
    };
    merge(&patches, &spec)
}

fn no_graph(result: Result<Merged, MergeError>) -> (&'static str, [f64; 2]) {
    match result {
        Err(MergeError::NoGraph {
            patch: 0,
            what,
            u,
            v,
        }) => (what, [u, v]),
        other => panic!("{other:?}"),
    }
}

#[test]
fn curves_that_are_no_graph_are_named_and_rows_go_on_without() {
    let s_shape = [
        [0.0, 0.0],
        [0.7, 0.0],
        [0.8, 0.6],
        [0.6, 0.4],
        [0.7, 1.0],
        [0.0, 1.0],
    ];
    let (what, at) = no_graph(of_first(&s_shape, Some(HideBy::Lines)));
    assert_eq!((what, at), ("turns back", [0.6, 0.4]));
    let merged = of_first(&s_shape, None).unwrap();
    assert_eq!(merged.hide_by, Some(HideBy::Rows));
    assert!(matches!(
        merged.readings[1].outcome,
        Err(MergeError::NoGraph { .. })
    ));
    // Rows end before the curve at u = 0.6.
    let last = merged.rows[0][0].fractions.last();
    assert_eq!(last, Some(&0.6));
    let step = [
        [0.0, 0.0],
        [0.7, 0.0],
        [0.7, 0.5],
        [0.9, 0.5],
        [0.9, 1.0],
        [0.0, 1.0],
    ];
    let (what, _) = no_graph(of_first(&step, Some(HideBy::Lines)));
    assert_eq!(what, "runs straight across the seam");
    let hole = [[0.6, 0.4], [0.6, 0.6], [0.8, 0.6], [0.8, 0.4]];
    let (what, _) = no_graph(of_first(&hole, Some(HideBy::Lines)));
    assert_eq!(what, "ends inside of the patch");
    assert_eq!(
        of_first(&hole, Some(HideBy::Rows)).unwrap().rows[0][0]
            .fractions
            .len(),
        61
    );
    // A corner alone: the edge goes on beside it.
    let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.8, 1.0], [0.0, 1.0]];
    assert_eq!(
        of_first(&corner, Some(HideBy::Lines)).unwrap().hide_by,
        Some(HideBy::Lines)
    );
}

#[test]
fn trims_that_leave_nothing_to_merge_are_refused() {
    let (patches, curves) = roof();
    let mut wrong_side = closed(&[[0.6, 0.0], [0.6, 1.0]], false);
    let (what, at) = no_graph(of_first(&wrong_side, None));
    assert_eq!(
        (what, at),
        ("hides what lies next to the outer edge", [0.6, 0.5])
    );
    wrong_side.reverse();
    assert!(
        of_first(&wrong_side, None).is_ok(),
        "the hole of a reversed loop is the other side"
    );
    let sliver = closed(&[[0.04, 0.0], [0.05, 1.0]], true);
    for by in [None, Some(HideBy::Rows), Some(HideBy::Lines)] {
        let error = of_first(&sliver, by).unwrap_err();
        assert!(
            matches!(
                error,
                MergeError::TooFewRows {
                    patch: 0,
                    needed: 7,
                    ..
                }
            ),
            "{error}"
        );
    }
    let to_the_edge = closed(&[[0.5, 0.0], [0.0, 0.5], [0.5, 1.0]], true);
    assert!(matches!(
        of_first(&to_the_edge, Some(HideBy::Rows)),
        Err(MergeError::TooFewRows { .. })
    ));
    assert!(matches!(
        of_first(&to_the_edge, None),
        Err(MergeError::NoGraph { .. })
    ));
    let nothing = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    assert_eq!(
        no_graph(of_first(&nothing, None)).0,
        "hides all of the patch"
    );
    // All that is kept is all there is.
    let mut all = nothing;
    all.reverse();
    let whole = of_first(&all, None).unwrap();
    assert!(whole.readings.is_empty() && whole.hide_by.is_none());

    let trims = [0, 1].map(|k| Trim::new(&patches[k], vec![closed(&curves[k], k == 0)]).unwrap());
    let exact = MergeSpec {
        method: MergeMethod::Exact,
        ..spec(&trims, None)
    };
    assert_eq!(
        merge(&patches, &exact).unwrap_err(),
        MergeError::NotExact { what: "trims" }
    );
    let hidden = vec![Hidden {
        patch: 0,
        direction: Direction::U,
        range: [0.9, 1.0],
    }];
    let both = MergeSpec {
        hidden,
        ..spec(&trims, None)
    };
    assert!(matches!(
        merge(&patches, &both),
        Err(MergeError::Trims { .. })
    ));
    let three = [patches[0].clone(), patches[1].clone(), patches[0].clone()];
    let row = MergeSpec {
        arrangement: Arrangement::Grid {
            rows: 3,
            columns: 1,
        },
        ..spec(&trims, None)
    };
    assert!(matches!(
        merge(&three, &row),
        Err(MergeError::Trims { given: 3, .. })
    ));
}
