//! Patches that cross: the curves they cross in.

use palpate_geometry::contact::pair::{CurvePoint, PairSide, PairSolver};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{ClosestSolver, Direction, Surface};

/// Edges nearer than this, as a share of the size, meet: patches that share an edge do not cross
/// there.
const MEET: f64 = 1e-6;
/// Patches that reach past each other by less than this share of the size do not cross.
const SLACK: f64 = 1e-6;
/// Chords of the curve stay this near to it, as a share of the size; rows are a hundredth apart.
const CHORD: f64 = 1e-4;
/// Less of the domain than this is the rounding of a curve along an edge.
const NOTHING: f64 = 1e-6;
/// Points compared along the edges.
const STEPS: usize = 16;

/// The curves in which two patches cross, on each in fractions (u, v) of its domain; none where they do not cross, or along their
/// edges only.
pub(super) fn crossing(
    first: &Surface,
    second: &Surface,
    direction: Direction,
) -> Option<[Vec<Vec<[f64; 2]>>; 2]> {
    let size_m = first.size() + second.size();
    if gap_m(first, second, direction) <= MEET * size_m || parted(first, second, SLACK * size_m) {
        return None;
    }
    let (mut one, mut other) = (ClosestSolver::new(first), ClosestSolver::new(second));
    let curves = PairSolver::new(first, second).curves(
        PairSide {
            surface: first,
            solver: &mut one,
        },
        PairSide {
            surface: second,
            solver: &mut other,
        },
        CHORD * size_m,
    );
    let share = |surface: &Surface, [u, v]: [f64; 2]| {
        [(Direction::U, u), (Direction::V, v)]
            .map(|(d, t)| (t - surface.knots(d).domain().0) / surface.knots(d).length())
    };
    let on = |surface: &Surface, of: fn(&CurvePoint) -> [f64; 2]| -> Vec<Vec<[f64; 2]>> {
        let points = curves.iter().map(|curve| &curve.points);
        points
            .map(|points| points.iter().map(|p| share(surface, of(p))).collect())
            .collect()
    };
    let both = [on(first, |p| [p.u, p.v]), on(second, |p| [p.s, p.t])];
    let d = if direction == Direction::U { 0 } else { 1 };
    let reaches = |curves: &[Vec<[f64; 2]>], beyond: &dyn Fn(f64) -> bool| {
        curves.iter().flatten().any(|p| beyond(p[d]))
    };
    let any = reaches(&both[0], &|f| f < 1.0 - NOTHING) || reaches(&both[1], &|f| f > NOTHING);
    any.then_some(both)
}

/// A plane has all control points of one patch on one side and all of the other's on the other: the
/// patches cannot cross.
fn parted(first: &Surface, second: &Surface, slack_m: f64) -> bool {
    let middle = |s: &Surface| {
        let points = s.net().points();
        points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64
    };
    let way = middle(second) - middle(first);
    let Some(way) = way.try_normalize(0.0) else {
        return false;
    };
    // Patches are seldom square to the line between their middles, but often to an axis.
    [
        way,
        Vector3::x() * way.x.signum(),
        Vector3::y() * way.y.signum(),
        Vector3::z() * way.z.signum(),
    ]
    .iter()
    .any(|n| {
        let heights = |s: &Surface| {
            s.net()
                .points()
                .iter()
                .map(|p| p.coords.dot(n))
                .collect::<Vec<f64>>()
        };
        let end = heights(first).into_iter().fold(f64::NEG_INFINITY, f64::max);
        heights(second).into_iter().fold(f64::INFINITY, f64::min) >= end - slack_m
    })
}

/// Largest distance between points of the edges that face each other, m.
pub(super) fn gap_m(first: &Surface, second: &Surface, direction: Direction) -> f64 {
    let gap = |k: usize| {
        let along = |surface: &Surface, end: f64| {
            let at =
                |d: Direction, f: f64| surface.knots(d).domain().0 + f * surface.knots(d).length();
            let f = k as f64 / STEPS as f64;
            match direction {
                Direction::U => surface.point(at(Direction::U, end), at(Direction::V, f)),
                Direction::V => surface.point(at(Direction::U, f), at(Direction::V, end)),
            }
        };
        (along(first, 1.0) - along(second, 0.0)).norm()
    };
    (0..=STEPS).map(gap).fold(0.0, f64::max)
}
