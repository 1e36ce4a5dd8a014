//! Facts about curves of intersection, against closed forms and sampled signs of distance.

use super::super::tests::{Random, posed};
use super::super::*;
use super::*;
use crate::math::{Rotation, Vector3};
use crate::surface::builtin;

fn curves(body: &Surface, tool: &Surface, tolerance_m: f64) -> Vec<IntersectionCurve> {
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    let found = PairSolver::new(body, tool).curves(
        PairSide {
            surface: body,
            solver: &mut a,
        },
        PairSide {
            surface: tool,
            solver: &mut b,
        },
        tolerance_m,
    );
    check(body, tool, tolerance_m, &found);
    found
}

fn loops(curves: &[IntersectionCurve]) -> usize {
    curves.iter().filter(|c| c.closed).count()
}

fn segments(curve: &IntersectionCurve) -> impl Iterator<Item = (CurvePoint, CurvePoint)> + '_ {
    let n = curve.points.len();
    (0..if curve.closed { n } else { n - 1 })
        .map(move |k| (curve.points[k], curve.points[(k + 1) % n]))
}

/// What holds for every curve: its points are on both surfaces, its chords near them, and it runs
/// along n_body × n_tool.
fn check(body: &Surface, tool: &Surface, tolerance_m: f64, found: &[IntersectionCurve]) {
    let size = body.size() + tool.size();
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    for curve in found {
        assert!(curve.points.len() > 1);
        for c in &curve.points {
            let (x, y) = (body.point(c.u, c.v), tool.point(c.s, c.t));
            assert!(
                (x - y).norm() <= 1e-12 * size,
                "{c:?}: {x} and {y} are {} apart",
                (x - y).norm()
            );
            assert!((x - c.point).norm() <= 1e-12 * size, "{c:?}");
        }
        let mut along = 0.0;
        for (p, q) in segments(curve) {
            let middle = nalgebra::center(&p.point, &q.point);
            let off = a
                .closest(body, &middle)
                .distance
                .max(b.closest(tool, &middle).distance);
            assert!(off <= tolerance_m, "chord from {p:?} to {q:?} is {off} off");
            let way = body.normal(p.u, p.v).cross(&tool.normal(p.s, p.t));
            along += way.dot(&(q.point - p.point));
        }
        assert!(along > 0.0, "curve runs backwards: {along}");
    }
}

#[test]
fn two_balls_cross_in_the_circle_that_their_radii_say() {
    let mut random = Random(11);
    for k in 0..24 {
        let (r, q): (f64, f64) = ([0.05, 0.03, 0.01][k % 3], 0.04);
        let (body, tool) = (
            builtin("sphere", None, Some(r)).unwrap(),
            builtin("sphere", None, Some(q)).unwrap(),
        );
        let way = random.vector().normalize();
        let apart = [
            r + q - 1e-6,
            (r - q).abs() + 1e-6,
            r + q - 0.003,
            (r - q).abs() + 0.002,
            r.max(q),
        ][k % 5];
        let tool = posed(&tool, &random.rotation(), &(way * apart));
        let tolerance = 1e-5;
        let found = curves(&body, &tool, tolerance);
        assert_eq!((found.len(), loops(&found)), (1, 1), "{k}: apart {apart}");
        // The circle's plane and radius.
        let height = (apart * apart + r * r - q * q) / (2.0 * apart);
        let radius = (r * r - height * height).sqrt();
        let mut turned = 0.0;
        for (p, n) in segments(&found[0]) {
            let off = (p.point.coords.dot(&way) - height).abs();
            let ring = (p.point.coords - way * p.point.coords.dot(&way)).norm() - radius;
            // Both spheres hold each point to rounding: along the circle's plane and across it that
            // is divided by the sine of the angle between them.
            let sine = radius * apart / (r * q);
            assert!(
                off <= 1e-13 / sine && ring.abs() <= 1e-13 / sine,
                "{k}: off {off}, ring {ring}"
            );
            turned += way.dot(&(p.point.coords.cross(&n.point.coords)));
        }
        let area = 0.5 * turned.abs();
        let full = std::f64::consts::PI * radius * radius;
        // Chords within the tolerance leave less than circumference × tolerance.
        assert!(
            area <= full * (1.0 + 1e-9) && area >= full - 6.3 * radius * tolerance,
            "{k}: area {area} of {full}"
        );
    }
}

#[test]
fn a_plane_sheet_cuts_a_torus_in_as_many_loops_as_its_height_says() {
    let torus = builtin("torus", None, Some(0.05)).unwrap();
    let sheet = builtin("sheet", None, Some(0.3)).unwrap();
    // Across the axis: two rings, above the top none. Along it: two, one near the inner rim, one,
    // none.
    let flat = |z: f64| posed(&sheet, &Rotation::identity(), &Vector3::new(0.0, 0.0, z));
    let upright = Rotation::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.1);
    let beside = |x: f64| posed(&sheet, &upright, &Vector3::new(x, 0.0, 0.0));
    for (name, tool, wanted) in [
        ("flat", flat(0.0), 2),
        ("flat", flat(0.0171), 2),
        ("flat", flat(0.0199), 2),
        ("flat", flat(0.021), 0),
    ] {
        let found = curves(&torus, &tool, 1e-5);
        assert_eq!((found.len(), loops(&found)), (wanted, wanted), "{name}");
    }
    for (x, wanted) in [
        (0.0, 2),
        (0.02, 2),
        (0.04, 1),
        (0.06, 1),
        (0.0699, 1),
        (0.0702, 0),
    ] {
        let mut tool = beside(0.0);
        let normal = tool.normal(0.5, 0.5);
        for p in tool.net_mut().points_mut() {
            *p += normal * x;
        }
        let found = curves(&torus, &tool, 1e-5);
        assert_eq!(
            (found.len(), loops(&found)),
            (wanted, wanted),
            "upright at {x}"
        );
    }
}

#[test]
fn a_ball_meets_a_torus_in_one_or_two_loops() {
    let torus = builtin("torus", None, Some(0.05)).unwrap();
    for (radius, shift, wanted) in [
        // In the tube, poking out of its top; across the tube; in the hole, touching all around;
        // around the tube.
        (0.019, Vector3::new(0.05, 0.0, 0.004), 1),
        (0.015, Vector3::new(0.05, 0.0, 0.015), 1),
        (0.032, Vector3::new(0.0, 0.0, 0.0), 2),
        (0.024, Vector3::new(0.0, 0.05, 0.0), 2),
        (0.01, Vector3::new(0.0, 0.05, 0.0), 0),
    ] {
        let ball = builtin("sphere", None, Some(radius)).unwrap();
        let tool = posed(&ball, &Random(4).rotation(), &shift);
        for (a, b) in [(&torus, &tool), (&tool, &torus)] {
            let found = curves(a, b, 1e-5);
            assert_eq!(
                (found.len(), loops(&found)),
                (wanted, wanted),
                "radius {radius} at {shift}"
            );
        }
    }
}

/// Squares of an `n × n` grid over `upper` whose corners are on both sides of the closed `lower`:
/// how many groups, with a place of each square and how wide it is.
fn squares(upper: &Surface, lower: &Surface, n: usize) -> (usize, Vec<(Point3, f64)>) {
    let mut solver = ClosestSolver::new(lower);
    let ((u0, u1), (v0, v1)) = (upper.knots_u().domain(), upper.knots_v().domain());
    let topology = upper.topology();
    let corner = |i: usize, j: usize| {
        upper.point(
            u0 + (u1 - u0) * i as f64 / n as f64,
            v0 + (v1 - v0) * j as f64 / n as f64,
        )
    };
    let inside: Vec<bool> = (0..(n + 1) * (n + 1))
        .map(|k| {
            solver
                .closest(lower, &corner(k / (n + 1), k % (n + 1)))
                .signed_distance
                < 0.0
        })
        .collect();
    let mixed = |i: usize, j: usize| {
        let at = |i: usize, j: usize| inside[i * (n + 1) + j];
        let sum = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]
            .iter()
            .filter(|x| **x)
            .count();
        sum % 4 != 0
    };
    let (mut seen, mut groups, mut all) = (vec![false; n * n], 0, vec![]);
    for k in 0..n * n {
        if seen[k] || !mixed(k / n, k % n) {
            continue;
        }
        groups += 1;
        let mut stack = vec![k];
        seen[k] = true;
        while let Some(x) = stack.pop() {
            let (i, j) = (x / n, x % n);
            let (p, q) = (corner(i, j), corner(i + 1, j + 1));
            let wide = (q - p)
                .norm()
                .max((corner(i + 1, j) - corner(i, j + 1)).norm());
            all.push((nalgebra::center(&p, &q), wide));
            let step = |x: usize, by: usize, wraps: bool| match (x + by, wraps) {
                (y, true) => Some((y + n - 1) % n),
                (y, false) => (1..=n).contains(&y).then(|| y - 1),
            };
            let mut near = vec![];
            for a in 0..3 {
                for b in 0..3 {
                    if let (Some(i), Some(j)) =
                        (step(i, a, topology.wraps(0)), step(j, b, topology.wraps(1)))
                    {
                        near.push(i * n + j);
                    }
                }
            }
            if (j == 0 && topology.poles[1][0]) || (j + 1 == n && topology.poles[1][1]) {
                near.extend((0..n).map(|i| i * n + j));
            }
            for y in near {
                if !seen[y] && mixed(y / n, y % n) {
                    seen[y] = true;
                    stack.push(y);
                }
            }
        }
    }
    (groups, all)
}

// Each square that the other surface passes has a curve beside it; and a group of such squares is a
// loop or, where loops come nearer than a square, several.
#[test]
fn curves_of_teardrops_are_those_that_sampled_signs_show() {
    let n = if cfg!(debug_assertions) { 100 } else { 400 };
    let mut random = Random(21);
    let (mut wrong, mut most) = (0, 0);
    for k in 0..if cfg!(debug_assertions) { 8 } else { 60 } {
        let count = [8, 12, 20][k % 3];
        let drop = builtin("teardrop", Some([count; 2]), None).unwrap();
        let tool = posed(&drop, &random.rotation(), &(random.vector() * 0.05));
        let found = curves(&drop, &tool, 1e-5);
        assert!(
            found.iter().all(|c| c.closed),
            "pose {k}: closed surfaces cross in loops"
        );
        for (upper, lower) in [(&drop, &tool), (&tool, &drop)] {
            let (groups, all) = squares(upper, lower, n);
            most = most.max(groups);
            let bare = all.iter().filter(|(place, wide)| {
                !found.iter().flat_map(segments).any(|(p, q)| {
                    let (chord, way) = (q.point - p.point, place - p.point);
                    let share = (way.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
                    (way - chord * share).norm() <= 2.0 * wide + 1e-5
                })
            });
            let bare = bare.count();
            if bare > 0 || found.len() < groups {
                wrong += 1;
                println!(
                    "pose {k}: {bare} of {} squares without curve, {} curves, {groups} groups",
                    all.len(),
                    found.len()
                );
            }
        }
        // What the sampling does not show is smaller than its squares.
        let groups = squares(&drop, &tool, n).0.max(squares(&tool, &drop, n).0);
        let large = found.iter().filter(|c| {
            segments(c)
                .map(|(p, q)| (q.point - p.point).norm())
                .sum::<f64>()
                > 0.02
        });
        if large.count() > groups {
            wrong += 1;
            println!("pose {k}: {} curves, {groups} groups", found.len());
        }
    }
    assert!(most > 0);
    assert_eq!(wrong, 0);
}

#[test]
fn a_loop_over_a_pole_and_one_over_a_seam_close() {
    let ball = builtin("sphere", None, Some(0.05)).unwrap();
    let sheet = builtin("sheet", None, Some(0.3)).unwrap();
    // Through both poles; through one; beside both by less than any step.
    for (turn, shift) in [
        (0.0, 0.0),
        (0.3, 0.0),
        (0.0, 1e-7),
        (0.7, 1e-4),
        (0.1, 0.049),
    ] {
        let rotation = Rotation::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, turn);
        let mut tool = posed(&sheet, &rotation, &Vector3::zeros());
        let normal = tool.normal(0.5, 0.5);
        for p in tool.net_mut().points_mut() {
            *p += normal * shift;
        }
        let found = curves(&ball, &tool, 1e-5);
        assert_eq!(
            (found.len(), loops(&found)),
            (1, 1),
            "turn {turn} shift {shift}"
        );
        let length: f64 = segments(&found[0])
            .map(|(p, q)| (q.point - p.point).norm())
            .sum();
        let around = std::f64::consts::TAU * (0.05_f64 * 0.05 - shift * shift).sqrt();
        assert!(
            (length / around - 1.0).abs() < 2e-3,
            "turn {turn} shift {shift}: {length} for {around}"
        );
    }
    // On the seam u = 0 of a ball, and on that of a periodic torus.
    for body in [&ball, &builtin("torus", None, Some(0.05)).unwrap()] {
        let at = body.point(0.0, 0.5 + 0.05);
        let small = builtin("sphere", None, Some(0.004)).unwrap();
        let tool = posed(&small, &Random(9).rotation(), &at.coords);
        let found = curves(body, &tool, 1e-6);
        assert_eq!((found.len(), loops(&found)), (1, 1));
        let us: Vec<f64> = found[0].points.iter().map(|p| p.u).collect();
        assert!(
            us.iter().any(|u| *u < 0.1) && us.iter().any(|u| *u > 0.9),
            "the loop passes the seam: {us:?}"
        );
    }
}

#[test]
fn branches_end_at_open_edges() {
    let sheet = builtin("sheet", None, None).unwrap();
    let turned = Rotation::from_euler_angles(1.1, 0.0, 0.2);
    let tool = posed(&sheet, &turned, &Vector3::new(0.01, 0.02, 0.003));
    let found = curves(&sheet, &tool, 1e-6);
    assert_eq!(found.len(), 1);
    assert!(!found[0].closed);
    let edge = |x: f64| x == 0.0 || x == 1.0;
    for end in [
        found[0].points[0],
        found[0].points[found[0].points.len() - 1],
    ] {
        assert!(
            [end.u, end.v, end.s, end.t].into_iter().any(edge),
            "{end:?}"
        );
    }
    // A ball over an edge and a corner: one open arc each.
    for (x, y) in [(0.05, 0.0), (0.05, 0.05), (0.02, -0.05)] {
        let ball = builtin("sphere", None, Some(0.01)).unwrap();
        let tool = posed(&ball, &Random(2).rotation(), &Vector3::new(x, y, 0.002));
        let found = curves(&sheet, &tool, 1e-6);
        assert_eq!((found.len(), loops(&found)), (1, 0), "at {x} {y}");
        let length: f64 = segments(&found[0])
            .map(|(p, q)| (q.point - p.point).norm())
            .sum();
        let around = std::f64::consts::TAU * (1e-4_f64 - 4e-6).sqrt();
        let share = if x == 0.05 && y == 0.05 { 0.25 } else { 0.5 };
        assert!(
            (length / (share * around) - 1.0).abs() < 2e-3,
            "at {x} {y}: {length} of {around}"
        );
    }
}

#[test]
fn curves_move_and_scale_with_the_pair() {
    let drop = builtin("teardrop", None, None).unwrap();
    let mut random = Random(31);
    let scaled = |surface: &Surface, scale: f64| {
        let mut scaled = surface.clone();
        scaled
            .net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|p| *p = Point3::from(p.coords * scale));
        scaled
    };
    let length = |found: &[IntersectionCurve]| -> f64 {
        found
            .iter()
            .flat_map(segments)
            .map(|(p, q)| (q.point - p.point).norm())
            .sum()
    };
    for k in 0..6 {
        let tool = posed(&drop, &random.rotation(), &(random.vector() * 0.04));
        let first = curves(&drop, &tool, 1e-5);
        let (rotation, shift) = (random.rotation(), random.vector());
        let moved = curves(
            &posed(&drop, &rotation, &shift),
            &posed(&tool, &rotation, &shift),
            1e-5,
        );
        let mut others = vec![
            ("moved", 1.0, moved),
            ("swapped", 1.0, curves(&tool, &drop, 1e-5)),
        ];
        for scale in [1e-6, 1e3] {
            others.push((
                "scaled",
                scale,
                curves(&scaled(&drop, scale), &scaled(&tool, scale), 1e-5 * scale),
            ));
        }
        for (name, scale, other) in others {
            assert_eq!(
                (other.len(), loops(&other)),
                (first.len(), loops(&first)),
                "{k} {name} {scale}"
            );
            let (a, b) = (length(&first), length(&other) / scale);
            assert!((a - b).abs() <= 2e-3 * a, "{k} {name} {scale}: {a} and {b}");
        }
    }
}

#[test]
fn surfaces_that_lie_on_each_other_or_are_not_finite_return() {
    for name in ["sheet", "sphere", "teardrop", "torus"] {
        let body = builtin(name, None, None).unwrap();
        assert!(
            curves(&body, &body.clone(), 1e-5).is_empty(),
            "{name} on itself"
        );
    }
    let drop = builtin("teardrop", None, None).unwrap();
    let mut bad = drop.clone();
    bad.net_mut().points_mut()[20].x = f64::NAN;
    let (mut a, mut b) = (ClosestSolver::new(&drop), ClosestSolver::new(&drop));
    b.net_changed();
    let (body, tool) = (
        PairSide {
            surface: &drop,
            solver: &mut a,
        },
        PairSide {
            surface: &bad,
            solver: &mut b,
        },
    );
    assert!(
        PairSolver::new(&drop, &drop)
            .curves(body, tool, 1e-5)
            .is_empty()
    );
}
