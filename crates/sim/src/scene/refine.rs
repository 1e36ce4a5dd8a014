//! How finely a deforming body's net is cut, and where.
//!
//! The net must resolve the contact: a ball that presses a net of coarse spans meets too much
//! stiffness. Refinement is exact (knot insertion), so it costs nodes only. `"auto"` cuts the spans
//! evenly by their length on the surface, so that a press meets the same net wherever its tool was
//! when the scene was loaded.

use super::door::At;
use super::layout::{distinct, layout};
use super::spec::{BodySpec, BuilderSpec, RefineAuto, RefineSpec, SceneSpec};
use crate::body::layers::Rings;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Pose};
use palpate_geometry::surface::{ClosestSolver, Direction, Joints, Surface, SurfaceError};

/// Lines of the other direction on which a span's length is measured.
const LINES: usize = 24;
/// Chords of a span on each of them.
const CHORDS: usize = 16;

/// Spans at a focus are this much finer than far away: the first that a body can be built with.
/// Chosen between 1 (on the teardrop's own net a 10 mm ball pressed 1 mm meets 57 % too much force) and 6
/// (the spans far away grow so long that the body as a whole stiffens).
pub(super) const GRADINGS: [f64; 4] = [3.0, 2.0, 1.5, 1.0];
/// Radius of the fine zone around a focus, relative to the body's size.
const ZONE: f64 = 0.12;

/// The body whose surface is refined.
pub(super) struct Refined<'a> {
    pub scene: &'a SceneSpec,
    pub spec: &'a BodySpec,
    pub at: &'a At<'a>,
    pub placement: &'a Pose,
    /// The most nodes that `"auto"` and a focus make.
    pub node_budget: usize,
    /// How much finer spans are at a focus.
    pub grading: f64,
}

/// The refined surface a scene asks for.
pub(super) fn refine(body: &Refined<'_>, surface: Surface) -> Option<Surface> {
    let at = body.at.key("lattice").key("refine");
    // The nodes of a cube lattice must see every control point: its net is not refined unasked.
    let cube = body.spec.lattice.builder != BuilderSpec::Layers;
    let evenly = |foci: &[Point3]| {
        let [u, v] = even_knots(body, foci, &surface);
        let refined = at.take(surface.insert_knots_alike([&u, &v]))?;
        Some(refined.with_exact_seams())
    };
    match &body.spec.lattice.refine {
        RefineSpec::Auto(RefineAuto::None) => Some(surface),
        RefineSpec::Auto(RefineAuto::Auto) if cube => Some(surface),
        RefineSpec::Auto(RefineAuto::Auto) => evenly(&[]),
        RefineSpec::Focus { focus } => {
            let finite = focus.iter().map(|point| at.finite("focus", point));
            finite.collect::<Option<()>>()?;
            let mut solver = ClosestSolver::new(&surface);
            let on_surface = |&point: &[f64; 3]| {
                let in_world = body.placement * Point3::from(point);
                solver.closest(&surface, &in_world).point
            };
            evenly(&focus.iter().map(on_surface).collect::<Vec<_>>())
        }
        RefineSpec::Counts([u, v]) => match two_sides(&surface) {
            Some(along) => at.take(refined_alike(&surface, along, [*u, *v])),
            None => at.take(surface.refined_to(*u, *v)),
        },
        RefineSpec::Knots { u, v } => {
            let refined = at.take(surface.insert_knots_alike([u, v]))?;
            Some(refined.with_exact_seams())
        }
    }
}

/// A knot span and the pieces it is cut into.
struct Span {
    from: f64,
    to: f64,
    /// (chords + 1): way to the ends of its chords, as long as it counts, along the line on which
    /// it is longest, m.
    way_m: [f64; CHORDS + 1],
    pieces: usize,
}

impl Span {
    fn piece_m(&self) -> f64 {
        self.way_m[CHORDS] / self.pieces as f64
    }

    /// Parameters that cut it into pieces as long as each other.
    fn cuts(&self) -> Vec<f64> {
        let cut = |piece: usize| {
            let goal_m = self.piece_m() * piece as f64;
            let k = self.way_m.partition_point(|&way| way <= goal_m);
            let k = k.clamp(1, CHORDS);
            let chord_m = self.way_m[k] - self.way_m[k - 1];
            let rest_m = goal_m - self.way_m[k - 1];
            let share = if chord_m > 0.0 { rest_m / chord_m } else { 0.5 };
            let whole = (k - 1) as f64 + share.min(1.0);
            self.from + (self.to - self.from) * whole / CHORDS as f64
        };
        (1..self.pieces).map(cut).collect()
    }

    /// The same in its parameter.
    fn halves(&self) -> Vec<f64> {
        let share = |piece: usize| piece as f64 / self.pieces as f64;
        let cut = |piece| self.from + (self.to - self.from) * share(piece);
        (1..self.pieces).map(cut).collect()
    }
}

/// The knot spans of a direction, with lengths on the surface; `counts_as` is what a length at a
/// point is multiplied by.
fn spans(surface: &Surface, d: usize, counts_as: impl Fn(&Point3) -> f64) -> Vec<Span> {
    let knots = [surface.knots_u(), surface.knots_v()];
    let (along, across): (&KnotVector, &KnotVector) = (knots[d], knots[1 - d]);
    let (start, end) = across.domain();
    let line = |k: usize| start + (end - start) * (k as f64 + 0.5) / LINES as f64;
    let way = |from: f64, to: f64, y: f64| {
        let place = |share: f64| {
            let x = from + (to - from) * share;
            if d == 0 { [x, y] } else { [y, x] }
        };
        let point = |[u, v]: [f64; 2]| surface.point(u, v);
        let mut way_m = [0.0; CHORDS + 1];
        let mut last = point(place(0.0));
        for k in 1..=CHORDS {
            let next = point(place(k as f64 / CHORDS as f64));
            let counts_as = counts_as(&last.lerp(&next, 0.5));
            way_m[k] = way_m[k - 1] + (next - last).norm() * counts_as;
            last = next;
        }
        way_m
    };
    let longest = |from: f64, to: f64| {
        let mut longest = way(from, to, line(0));
        for k in 1..LINES {
            let trial = way(from, to, line(k));
            // With a hair of tolerance: rounding of symmetric surfaces must not decide.
            if trial[CHORDS] > longest[CHORDS] * (1.0 + 1e-9) {
                longest = trial;
            }
        }
        longest
    };
    let span = |i: usize| {
        let (from, to) = (along.knots()[i], along.knots()[i + 1]);
        Span {
            from,
            to,
            way_m: longest(from, to),
            pieces: 1,
        }
    };
    along.spans().map(span).collect()
}

/// Knots to insert in u and in v: always into the span whose pieces are longest on the surface,
/// until three control points lie across the contact that the smallest ball makes at a tenth of its
/// radius, but no more nodes than the budget.
fn even_knots(body: &Refined<'_>, foci: &[Point3], surface: &Surface) -> [Vec<f64>; 2] {
    let radius = body
        .scene
        .tools
        .iter()
        .filter_map(|tool| tool.shape.shape().refines_to_radius_m());
    let radius = radius.fold(f64::INFINITY, f64::min);
    let width_m = if radius.is_finite() {
        2.0 * radius * 0.1_f64.sqrt()
    } else {
        0.0
    };
    let zone_m = ZONE * surface.size();
    let counts_as = |point: &Point3| {
        let near = foci.iter().map(|focus| {
            let away = (point - focus).norm() / zone_m;
            libm::exp(-away * away)
        });
        let near = near.fold(0.0, f64::max);
        // Relative to the focus, so that what is fine enough there is fine enough.
        match foci {
            [] => 1.0,
            _ => (1.0 + (body.grading - 1.0) * near) / body.grading,
        }
    };
    let nodes = node_count(body.spec, surface);
    let joints = surface.joints();
    let sides = two_sides(surface);
    let mut counts = distinct(surface, &surface.topology());
    let mut spans = [0, 1].map(|d| spans(surface, d, counts_as));
    loop {
        let mut longest = (0.0, [0, 0]);
        for (d, spans) in spans.iter().enumerate() {
            for (k, span) in spans.iter().enumerate() {
                // The first of equals, with a hair of tolerance for rounding.
                if span.piece_m() > longest.0 * (1.0 + 1e-9) {
                    longest = (span.piece_m(), [d, k]);
                }
            }
        }
        let (piece_m, [d, k]) = longest;
        let together = match sides {
            Some(along) if along == d => both_sides(spans[d].len(), k).map(|k| [d, k]).collect(),
            _ => alike(joints.as_ref(), &spans, [d, k]),
        };
        let mut next = counts;
        together.iter().for_each(|&[d, _]| next[d] += 1);
        if piece_m <= 0.0 || piece_m * 3.0 <= width_m || nodes(next) > body.node_budget {
            break;
        }
        counts = next;
        for [d, k] in together {
            spans[d][k].pieces += 1;
        }
    }
    // Copies are cut at the same shares of their spans.
    let cuts = match joints {
        Some(_) => Span::halves,
        None => Span::cuts,
    };
    spans.map(|spans| spans.iter().flat_map(cuts).collect())
}

/// The direction from pole to pole of a flat body, whose sides are cut alike: its cells stand between
/// control points that lie opposite each other.
fn two_sides(surface: &Surface) -> Option<usize> {
    let rings = layout(surface, &surface.topology())?;
    rings.is_flat().then_some(usize::from(rings.u_around))
}

/// A span and the one opposite, of so many.
fn both_sides(spans: usize, k: usize) -> impl Iterator<Item = usize> {
    let opposite = spans - 1 - k;
    [k, opposite]
        .into_iter()
        .take(if k == opposite { 1 } else { 2 })
}

/// A flat body with so many control points: its longest spans are cut evenly, in both sides alike, so
/// that it may get one more.
fn refined_alike(
    surface: &Surface,
    along: usize,
    counts: [usize; 2],
) -> Result<Surface, SurfaceError> {
    let mut around = counts;
    around[along] = 0;
    let surface = surface.refined_to(around[0], around[1])?;
    let knots = [surface.knots_u(), surface.knots_v()][along];
    let t = knots.knots();
    let mut spans: Vec<(f64, f64, usize)> = knots.spans().map(|i| (t[i], t[i + 1], 1)).collect();
    let have = surface.distinct_counts()[along];
    let mut more = counts[along].saturating_sub(have);
    while more > 0 {
        let piece = |&(from, to, pieces): &(f64, f64, usize)| (to - from) / pieces as f64;
        let mut longest = 0;
        for k in 1..spans.len() {
            // The first of equals, with a hair of tolerance for rounding.
            if piece(&spans[k]) > piece(&spans[longest]) * (1.0 + 1e-9) {
                longest = k;
            }
        }
        for k in both_sides(spans.len(), longest) {
            spans[k].2 += 1;
            more = more.saturating_sub(1);
        }
    }
    let cuts = spans.iter().flat_map(|&(from, to, pieces)| {
        (1..pieces).map(move |k| from + (to - from) * (k as f64 / pieces as f64))
    });
    let cuts: Vec<f64> = cuts.collect();
    let direction = [Direction::U, Direction::V][along];
    surface.insert_knots(direction, &cuts)
}

/// The spans that must be cut as this one is: copies of a branching surface stay alike.
fn alike(joints: Option<&Joints>, spans: &[Vec<Span>; 2], [d, k]: [usize; 2]) -> Vec<[usize; 2]> {
    let Some(joints) = joints else {
        return vec![[d, k]];
    };
    let span = &spans[d][k];
    let mut together: Vec<[usize; 2]> = Vec::new();
    for (e, cut) in joints.cuts(d, 0.5 * (span.from + span.to)) {
        let of = spans[e].iter().position(|s| cut > s.from && cut < s.to);
        if let Some(l) = of
            && !together.contains(&[e, l])
        {
            together.push([e, l]);
        }
    }
    together
}

/// Nodes of a body whose net has so many distinct control points in u and v.
fn node_count(spec: &BodySpec, surface: &Surface) -> impl Fn([usize; 2]) -> usize {
    let topology = surface.topology();
    let shape = layout(surface, &topology);
    let layers = spec.layers();
    // What a branching surface draws twice costs once.
    let share = match surface.joints() {
        Some(_) => {
            let drawn = surface.net().points().len();
            surface.distinct_points(&topology).count as f64 / drawn as f64
        }
        None => 1.0,
    };
    move |[u, v]| match &shape {
        Some(Rings { u_around: true, .. }) => u * v * layers + v,
        Some(_) => u * v * layers + u,
        None => (share * (u * v) as f64) as usize * layers.max(2),
    }
}
