//! Which B-spline faces have nothing near a query, from what was proved of an earlier one.
//!
//! What is kept only spares searches: an answer is the same whatever is kept.

use super::bezier;
use super::foot::{At, Best, Support, wire};
use super::part::Part;
use super::tree::Tree;
use crate::math::Point3;
use crate::surface::{Basin, Clip, ClosestPoint, ClosestSolver, Surface};

/// Minima of a B-spline that are looked at.
pub(super) const MOST_FEET: usize = 64;
/// Cells that a piece is divided into, in each direction, to see where loops are.
const CELLS: usize = 8;
/// Parts of a cubic of a loop whose boxes mark cells.
const PARTS: usize = 16;
/// Of the size: how far queries are meant to go before a proof is asked for anew.
const REACH: f64 = 0.04;
/// Of the size: how far they go before a proof is tried again that failed.
const AGAIN: f64 = 4e-3;
/// Of the size: distances and places within this are not told apart here.
pub(super) const SAME: f64 = 1e-9;

/// What is known of one face.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// By piece of the surface.
    clips: Box<[Clip]>,
    basin: Option<Basin>,
    /// Where the last proof failed, and of what ceiling, m.
    failed: Option<(Point3, f64)>,
    size_m: f64,
}

/// A B-spline face of a part.
#[derive(Clone, Copy)]
pub(super) struct SplineFace<'a> {
    pub part: &'a Part,
    /// Its number.
    pub k: u32,
    pub surface: &'a Surface,
}

/// What is looked for: feet of a point nearer than a ceiling.
#[derive(Clone, Copy)]
pub(super) struct FootQuery<'a> {
    pub q: &'a Point3,
    pub within_m: f64,
    /// The nearest that is known.
    pub best: Option<&'a Best>,
}

/// What a face has that is nearer than a ceiling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// No place.
    Nothing,
    /// Only the place that was known before.
    Same,
    /// One minimum, here, within the loops.
    One(Point3),
    Unknown,
}

impl Known {
    pub fn new(part: &Part, k: u32, solver: &mut ClosestSolver, surface: &Surface) -> Self {
        Self {
            clips: clips(part, k, solver, surface),
            basin: None,
            failed: None,
            size_m: part.size_m(),
        }
    }

    /// Whether the face has a minimum of the distance, off its edges, that is nearer than `within_m` and not the one that is
    /// known already. `own` holds the edges of the face.
    pub fn judge(
        &mut self,
        face: SplineFace<'_>,
        own: &Tree,
        solver: &mut ClosestSolver,
        query: &FootQuery<'_>,
    ) -> Verdict {
        let SplineFace { part, k, surface } = face;
        let FootQuery { q, within_m, best } = *query;
        let same_m = SAME * self.size_m;
        let clears = |basin: &Basin| basin.clear_m(q) > within_m + same_m;
        if let Some(basin) = self.basin.filter(clears) {
            return verdict(face, own, solver, query, &basin);
        }
        if let Some((at, of_m)) = self.failed
            && (q - at).norm() <= AGAIN * self.size_m
            && within_m >= of_m - AGAIN * self.size_m
        {
            return Verdict::Unknown;
        }
        let reach_m = REACH * self.size_m;
        let known = best.and_then(|best| match best.at {
            At::Face(uv) if best.support == Support::Face(k) => Some(uv),
            At::Edge(e, at) => {
                let edge = &part.edges[e as usize];
                let side = edge.sides.iter().find(|side| side.face == k)?;
                let chart = &part.faces[k as usize].trim.chart;
                Some(chart.confined(edge.on(side, &part.faces, at)?))
            }
            _ => None,
        });
        let mut basin = solver.basin(surface, q, within_m, reach_m, known, &self.clips);
        if basin.is_none_or(|basin| !clears(&basin)) {
            let foot = solver.rough(surface, q);
            basin = solver.basin(
                surface,
                q,
                within_m,
                reach_m,
                Some([foot.u, foot.v]),
                &self.clips,
            );
        }
        let basin = basin.filter(clears);
        self.failed = basin.is_none().then_some((*q, within_m));
        self.basin = basin.or(self.basin);
        match basin {
            Some(basin) => verdict(face, own, solver, query, &basin),
            None => Verdict::Unknown,
        }
    }
}

/// What a basin says that clears the ceiling.
fn verdict(
    face: SplineFace<'_>,
    own: &Tree,
    solver: &mut ClosestSolver,
    query: &FootQuery<'_>,
    basin: &Basin,
) -> Verdict {
    let SplineFace { part, k, surface } = face;
    let FootQuery { q, within_m, best } = *query;
    if basin.is_empty() {
        return Verdict::Nothing;
    }
    let Some(lowest) = solver.lowest_of(surface, q, basin) else {
        return Verdict::Unknown;
    };
    let face = &part.faces[k as usize];
    let same_m = SAME * part.size_m();
    let (foot, uv) = (lowest.at, [lowest.at.u, lowest.at.v]);
    if lowest.leaves || foot.distance > within_m + same_m || face.carrier.is_on_rim(&face.rims, uv)
    {
        return Verdict::Nothing;
    }
    if let Some(best) = best
        && best.support == Support::Face(k)
        && (foot.point - best.point).norm() <= same_m
    {
        return Verdict::Same;
    }
    let inside = face.trim.contains(uv);
    if inside && lowest.free {
        return Verdict::One(foot.point);
    }
    if inside {
        return Verdict::Unknown;
    }
    // Rounding must not bring it over an edge.
    let close_m = same_m + 2.0 * part.gap_m();
    let mut near = false;
    own.nearest(&foot.point, &mut (close_m * close_m), |item, ceiling| {
        near |= wire(part, &foot.point, item, *ceiling).is_some();
    });
    match near {
        true => Verdict::Unknown,
        false => Verdict::Nothing,
    }
}

/// Where on each piece of its surface a face has something.
fn clips(part: &Part, k: u32, solver: &mut ClosestSolver, surface: &Surface) -> Box<[Clip]> {
    let face = &part.faces[k as usize];
    let pieces = solver.pieces(surface);
    let rectangles: Vec<_> = (0..pieces.len())
        .map(|piece| pieces.rectangle(piece))
        .collect();
    // Lines of cells: those of each span, one after the other.
    let [us, vs] = [0, 1].map(|d| {
        let mut spans: Vec<[f64; 2]> = (rectangles.iter())
            .map(|&(u, v)| if d == 0 { u } else { v })
            .collect();
        spans.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        spans.dedup();
        spans
    });
    let cells = |spans: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let at = |[a, b]: [f64; 2], i: usize| a + (b - a) * i as f64 / CELLS as f64;
        let of = |span: &[f64; 2]| {
            let span = *span;
            (0..CELLS).map(move |i| [at(span, i), at(span, i + 1)])
        };
        spans.iter().flat_map(of).collect()
    };
    let (cells_u, cells_v) = (cells(&us), cells(&vs));
    let mut touched = vec![false; cells_u.len() * cells_v.len()];
    let periods = face.trim.chart.periods;
    let sides = part.edges.iter().flat_map(|edge| &edge.sides);
    for pcurve in sides
        .filter(|side| side.face == k)
        .filter_map(|side| side.pcurve.as_ref())
    {
        for cubic in pcurve.segments() {
            // Short ones are no longer than a cell.
            let wide = (0..2).any(|d| {
                let cell = if d == 0 { cells_u[0] } else { cells_v[0] };
                cubic
                    .iter()
                    .any(|p| (p[d] - cubic[0][d]).abs() > cell[1] - cell[0])
            });
            let parts = if wide { PARTS } else { 1 };
            for i in 0..parts {
                let within = [i, i + 1].map(|i| i as f64 / parts as f64);
                let points = bezier::between(&cubic, within);
                let [u, v] = [0, 1].map(|d| {
                    let (low, high) = points
                        .iter()
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                            (l.min(p[d]), h.max(p[d]))
                        });
                    let spans = if d == 0 { &us } else { &vs };
                    let domain = [spans[0][0], spans[spans.len() - 1][1]];
                    let room = 1e-6 * (domain[1] - domain[0]);
                    reached(
                        if d == 0 { &cells_u } else { &cells_v },
                        [low - room, high + room],
                        domain,
                        periods[d],
                    )
                });
                for i in u.iter().flat_map(|range| range.clone()) {
                    for j in v.iter().flat_map(|range| range.clone()) {
                        touched[i * cells_v.len() + j] = true;
                    }
                }
            }
        }
    }
    let mut held = touched.clone();
    for (i, u) in cells_u.iter().enumerate() {
        let mut before: Option<bool> = None;
        for (j, v) in cells_v.iter().enumerate() {
            let cell = i * cells_v.len() + j;
            before = (!touched[cell]).then(|| {
                let middle = [0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])];
                before.unwrap_or_else(|| face.trim.contains(middle))
            });
            held[cell] |= before == Some(true);
        }
    }
    let index = |spans: &[[f64; 2]], start: f64| spans.partition_point(|span| span[0] < start);
    let clip = |(u, v): &([f64; 2], [f64; 2])| {
        let (i, j) = (CELLS * index(&us, u[0]), CELLS * index(&vs, v[0]));
        let mut clip = Clip {
            s: [1.0, 0.0],
            t: [1.0, 0.0],
        };
        for (a, b) in (0..CELLS).flat_map(|a| (0..CELLS).map(move |b| (a, b))) {
            if held[(i + a) * cells_v.len() + j + b] {
                let share = |a: usize| a as f64 / CELLS as f64;
                clip.s = [clip.s[0].min(share(a)), clip.s[1].max(share(a + 1))];
                clip.t = [clip.t[0].min(share(b)), clip.t[1].max(share(b + 1))];
            }
        }
        clip
    };
    rectangles.iter().map(clip).collect()
}

/// Which cells a range reaches, over the ends of a period too.
fn reached(
    cells: &[[f64; 2]],
    [low, high]: [f64; 2],
    domain: [f64; 2],
    period: f64,
) -> Vec<std::ops::Range<usize>> {
    let turns = match period {
        0.0 => 0..1,
        _ => {
            let turn = |x: f64| ((x - domain[0]) / period).floor() as i32;
            turn(low) - 1..turn(high) + 2
        }
    };
    turns
        .map(|turn| {
            let (low, high) = (
                low - f64::from(turn) * period,
                high - f64::from(turn) * period,
            );
            cells.partition_point(|cell| cell[1] < low)
                ..cells.partition_point(|cell| cell[0] <= high)
        })
        .filter(|range| !range.is_empty())
        .collect()
}

/// What may be offered of the minima of a B-spline face.
pub(super) struct Feet<'a> {
    pub face: SplineFace<'a>,
    pub solver: &'a mut ClosestSolver,
    pub known: Option<&'a mut Known>,
    pub own: Option<&'a Tree>,
}

impl Feet<'_> {
    /// The minima of the distance to the carrier of the face that are looked for, as far as they may be within the loops and
    /// are not `best`. True when none was left out.
    ///
    /// What the nearest sample leads to is given as it is found from there, whichever way it is found to be the only one: so
    /// it is the same to the last bit.
    pub fn find(self, query: &FootQuery<'_>, out: &mut Vec<ClosestPoint>) -> bool {
        let Self {
            face,
            solver,
            known,
            own,
        } = self;
        let SplineFace { part, k, surface } = face;
        let FootQuery { q, within_m, best } = *query;
        // A copy of the scratch begins without room.
        out.clear();
        out.reserve(MOST_FEET);
        let same_m = SAME * part.size_m();
        let mut verdict = Verdict::Unknown;
        if let (Some(known), Some(own)) = (known, own) {
            verdict = known.judge(face, own, solver, query);
        }
        if matches!(verdict, Verdict::Nothing | Verdict::Same) {
            return true;
        }
        let guess = solver.guess(surface, q);
        if let (Verdict::One(point), Some(guess)) = (verdict, guess)
            && (guess.point - point).norm() <= same_m
        {
            out.extend((guess.distance < within_m).then_some(guess));
            return true;
        }
        let complete = solver.minima_within(surface, q, within_m, out);
        if let Some(best) = best.filter(|best| best.support == Support::Face(k)) {
            out.retain(|foot| (foot.point - best.point).norm() > same_m);
        }
        if let Some(guess) = guess {
            for foot in out
                .iter_mut()
                .filter(|foot| (foot.point - guess.point).norm() <= same_m)
            {
                *foot = guess;
            }
            out.retain(|foot| foot.distance < within_m);
        }
        complete
    }
}
