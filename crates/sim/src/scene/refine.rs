//! How finely a deforming body's net is cut, and where.
//!
//! The net must resolve the contact: a ball that presses a net of coarse spans meets too much
//! stiffness. Refinement is exact (knot insertion), so it costs nodes only.

use super::door::At;
use super::layout::{distinct, layout};
use super::spec::{BodySpec, BuilderSpec, RefineAuto, RefineSpec, SceneSpec};
use crate::body::layers::Rings;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ClosestSolver, Closing, Surface};

/// Spans at the place a tool starts from are this much finer than far away. Chosen between 1 (on
/// the teardrop a 10 mm ball pressed 1 mm meets 56 % too much force) and 6 (the spans far away grow
/// so long that the body as a whole stiffens).
const GRADING: f64 = 3.0;
/// Width of the fine zone, as a share of the domain.
const ZONE: f64 = 0.15;

/// The refined surface a scene asks for; `at` is the body, and `node_budget` the most nodes that
/// `"auto"` makes.
pub(super) fn refine(
    scene: &SceneSpec,
    spec: &BodySpec,
    at: &At<'_>,
    surface: Surface,
    node_budget: usize,
) -> Option<Surface> {
    let at = at.key("lattice").key("refine");
    // The nodes of a cube lattice must see every control point: its net is not refined unasked.
    let cube = spec.lattice.builder != BuilderSpec::Layers;
    match &spec.lattice.refine {
        RefineSpec::Auto(RefineAuto::None) => Some(surface),
        RefineSpec::Auto(RefineAuto::Auto) if cube => Some(surface),
        RefineSpec::Counts([u, v]) => at.take(surface.refined_to(*u, *v)),
        RefineSpec::Knots { u, v } => {
            let refined = at.take(surface.insert_knots_alike([u, v]))?;
            Some(refined.with_exact_seams())
        }
        RefineSpec::Auto(RefineAuto::Auto) => {
            let counts = auto_counts(scene, spec, &surface, node_budget);
            let now = distinct(&surface, &surface.topology());
            let [u, v] = graded_knots(scene, &surface, [counts[0] - now[0], counts[1] - now[1]]);
            let refined = at.take(surface.insert_knots_alike([&u, &v]))?;
            Some(refined.with_exact_seams())
        }
    }
}

/// Where ball tools start from, in parameters of the surface.
fn focuses(scene: &SceneSpec, surface: &Surface) -> Vec<[f64; 2]> {
    let mut solver = ClosestSolver::new(surface);
    let touching = scene
        .tools
        .iter()
        .filter(|tool| tool.shape.shape().half_space().is_none())
        // Others are reported where they stand.
        .filter(|tool| tool.pose.position.iter().all(|x| x.is_finite()));
    touching
        .map(|tool| {
            let foot = solver.closest(surface, &Point3::from(tool.pose.position));
            [foot.u, foot.v]
        })
        .collect()
}

/// Knots to insert, `more[0]` in u and `more[1]` in v: always into the middle of the span that is
/// longest for its place.
fn graded_knots(scene: &SceneSpec, surface: &Surface, more: [usize; 2]) -> [Vec<f64>; 2] {
    let topology = surface.topology();
    let focuses = focuses(scene, surface);
    let joints = surface.joints();
    let direction = |d: usize, knots: &KnotVector| {
        let wraps = topology.closing[d] != Closing::Open;
        let length = knots.length();
        let weight = |x: f64| {
            let near = focuses.iter().map(|focus| {
                let away = (x - focus[d]).abs() / length;
                let away = if wraps { away.min(1.0 - away) } else { away };
                libm::exp(-(away / ZONE) * (away / ZONE))
            });
            1.0 + (GRADING - 1.0) * near.fold(0.0, f64::max)
        };
        let mut spans: Vec<(f64, f64)> = knots
            .spans()
            .map(|i| (knots.knots()[i], knots.knots()[i + 1]))
            .collect();
        let mut inserted = Vec::new();
        while inserted.len() < more[d] {
            let size = |&(a, b): &(f64, f64)| (b - a) * weight(0.5 * (a + b));
            let largest = spans.iter().map(size).fold(0.0, f64::max);
            // The first of equals, with a hair of tolerance: rounding of knots like
            // 0.6000000000000001 must not decide.
            let Some(k) = spans
                .iter()
                .position(|span| size(span) >= largest * (1.0 - 1e-9))
            else {
                break;
            };
            let (a, b) = spans[k];
            let middle = 0.5 * (a + b);
            if joints.is_none() {
                inserted.push(middle);
                spans.splice(k..=k, [(a, middle), (middle, b)]);
                continue;
            }
            // All copies are cut alike; cuts of the other direction follow by themselves.
            let cuts = joints
                .iter()
                .flat_map(|joints| joints.cuts(d, middle))
                .filter(|cut| cut.0 == d);
            for (_, cut) in cuts {
                let Some(k) = spans.iter().position(|&(a, b)| cut > a && cut < b) else {
                    continue;
                };
                let (a, b) = spans[k];
                inserted.push(cut);
                spans.splice(k..=k, [(a, cut), (cut, b)]);
            }
        }
        inserted.sort_by(f64::total_cmp);
        inserted
    };
    [
        direction(0, surface.knots_u()),
        direction(1, surface.knots_v()),
    ]
}

/// Control points wanted in u and v: three across the contact that the smallest ball makes at a
/// tenth of its radius, but no more nodes than the budget, and never fewer than the surface has.
fn auto_counts(
    scene: &SceneSpec,
    spec: &BodySpec,
    surface: &Surface,
    node_budget: usize,
) -> [usize; 2] {
    let topology = surface.topology();
    let net = surface.net();
    let (rows, columns) = (net.rows(), net.columns());
    let row_length = |j: usize| {
        (1..rows)
            .map(|i| (net.at(i, j) - net.at(i - 1, j)).norm())
            .sum::<f64>()
    };
    let column_length = |i: usize| {
        (1..columns)
            .map(|j| (net.at(i, j) - net.at(i, j - 1)).norm())
            .sum::<f64>()
    };
    let length_u = (0..columns).map(row_length).fold(0.0, f64::max);
    let length_v = (0..rows).map(column_length).fold(0.0, f64::max);
    let radius = scene
        .tools
        .iter()
        .filter_map(|tool| tool.shape.shape().refines_to_radius_m());
    let radius = radius.fold(f64::INFINITY, f64::min);
    let width = if radius.is_finite() {
        2.0 * radius * 0.1_f64.sqrt()
    } else {
        0.0
    };
    let now = distinct(surface, &topology);
    // What a branching surface draws twice costs once.
    let share = match surface.joints() {
        Some(_) => surface.distinct_points(&topology).count as f64 / (rows * columns) as f64,
        None => 1.0,
    };
    let nodes = |u: usize, v: usize| match layout(surface, &topology) {
        Some(Rings { u_around: true, .. }) => u * v * spec.lattice.layers + v,
        Some(_) => u * v * spec.lattice.layers + u,
        None => (share * (u * v) as f64) as usize * spec.lattice.layers.max(2),
    };
    let mut counts = now;
    loop {
        let spacing = [length_u / counts[0] as f64, length_v / counts[1] as f64];
        let coarser = usize::from(spacing[1] > spacing[0]);
        let mut next = counts;
        next[coarser] += 1;
        if spacing[coarser] * 3.0 <= width || nodes(next[0], next[1]) > node_budget {
            return counts;
        }
        counts = next;
    }
}
