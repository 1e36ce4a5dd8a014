//! Which places of a carrier belong to a face: winding of its loops.
//!
//! ```text
//! loops ──▶ seams dropped, chained anew ──▶ arcs: u monotone, within one period ──▶ base from the left of every arc
//! q = (u, v): base(u) + signed crossings of the ray from q towards +v; 1 inside, 0 outside
//! ```
//! Spainhour, Gunderman & Weiss, "Robust containment queries over collections of rational parametric curves via generalized
//! winding numbers" (2024) count windings likewise; here crossings come from the curve in space, so that nothing is fitted on
//! elementary carriers. Whether an arc crosses the ray is decided by the u of its ends, which neighbours share to the bit;
//! only how high it crosses is calculated.

use super::bezier::{self, Homogeneous};
use super::chart::{Chart, lifted, wrap};
use std::ops::Range;

/// Columns of the table that says which arcs a ray may cross.
const COLUMNS: usize = 32;
/// Arcs that are asked for the base, beside one of each loop.
const MOST_VOTES: usize = 200;
/// Of the length of all loops: pieces that rounding makes where u begins anew.
const ROUNDING: f64 = 1e-12;
/// Of the length of all loops: what may be on the wrong side where edges do not quite meet.
const MOST_WRONG: f64 = 1e-3;
/// Of the range of v: how near to a loop a place is on it.
const ON: f64 = 1e-13;

/// Why loops bound nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrimProblem {
    /// An end without a beginning.
    #[error("a loop does not close: edge #{0} ends where none begins")]
    Open(u64),
    /// Arcs whose left sides are not all inside.
    #[error(
        "its loops contradict each other, as loops do that cross or run the wrong way round: {wrong:.1e} of {total:.1e} of their length"
    )]
    Contradiction {
        /// Of the length in u, in the parameters of the carrier.
        wrong: f64,
        /// All of it.
        total: f64,
    },
    /// All that is far away would be inside.
    #[error("its loops bound nothing: the face would go on without end")]
    Unbounded,
}

/// How high an arc is over a u.
#[derive(Clone, Debug, PartialEq)]
enum Path {
    /// A segment along the carrier's axes, or in (u, v) on flat carriers; u is shifted by so much there.
    Curve(Vec<Homogeneous>, f64),
    /// At one v: along a pole.
    Level,
}

/// A piece of a loop on which u only grows or only falls.
#[derive(Clone, Debug, PartialEq)]
struct Arc {
    /// At its start and at its end, within one period.
    u: [f64; 2],
    /// Where it can be, low and high.
    v: [f64; 2],
    path: Path,
}

/// A face's loops.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trim {
    pub chart: Chart,
    arcs: Vec<Arc>,
    base: i32,
    /// Where arcs cross the line at which v is cut, and by how much the base changes there; ascending.
    steps: Vec<(f64, i32)>,
    /// First u of the table and columns a unit.
    columns: (f64, f64),
    /// Arcs by column, and where each column begins.
    lists: Vec<u32>,
    starts: Vec<u32>,
    /// Size of the range of v.
    height: f64,
    /// Low and high of both parameters, over all arcs.
    pub reach: [[f64; 2]; 2],
}

/// A monotone piece of a loop.
pub(super) struct Walk<'a> {
    /// Its segment, and where on it the piece begins and ends; `None` along a pole.
    pub points: Option<(&'a [Homogeneous], [f64; 2])>,
    /// At its start and its end.
    pub u: [f64; 2],
    /// Near which it is.
    pub v: f64,
}

/// A piece of an edge on a face, in walking order.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// As [`Chart::local`] gives it, or in (u, v).
    pub points: Vec<Homogeneous>,
}

/// An arc before periods are cut.
#[derive(Clone, Debug)]
struct Draft {
    points: Option<Vec<Homogeneous>>,
    /// Raw parameters at start and end, u with its neighbours' values.
    ends: [[f64; 2]; 2],
    /// A start or an end at a pole, where u is what it tends to.
    pole: [bool; 2],
}

impl Trim {
    /// The whole carrier.
    pub fn whole(chart: Chart) -> Self {
        Self {
            chart,
            arcs: Vec::new(),
            base: 1,
            steps: Vec::new(),
            columns: (0.0, 0.0),
            lists: Vec::new(),
            starts: Vec::new(),
            height: 1.0,
            reach: [[f64::NEG_INFINITY, f64::INFINITY]; 2],
        }
    }

    /// Of closed chains of pieces, with the face on their left as the carrier's normal sees it.
    pub fn new(mut chart: Chart, chains: &[Vec<Piece>]) -> Result<Self, TrimProblem> {
        let size = chains.iter().flatten().flat_map(|piece| &piece.points);
        let size = size.fold(0.0f64, |m, h| m.max(bezier::projected(h).coords.amax()));
        let mut apart = 0.0;
        let drafts: Vec<Vec<Draft>> = chains
            .iter()
            .map(|chain| drafts(&chart, chain, size, &mut apart))
            .collect();
        if chart.periods[1] > 0.0 {
            chart.origin[1] = cut(&chart, &drafts);
        }
        let mut trim = Self::whole(chart);
        trim.base = 0;
        let mut winding = 0;
        let mut loops = Vec::with_capacity(drafts.len());
        for chain in &drafts {
            let first = trim.arcs.len();
            for draft in chain {
                winding += trim.add(draft);
            }
            loops.push(first..trim.arcs.len());
        }
        let period = chart.periods[0];
        trim.steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let range = |k: usize| {
            let ends = trim
                .arcs
                .iter()
                .flat_map(|arc| if k == 0 { arc.u } else { arc.v });
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
            [low, high]
        };
        trim.reach = [range(0), range(1)];
        trim.height = (trim.reach[1][1] - trim.reach[1][0]).max(f64::MIN_POSITIVE);
        trim.tabulate();
        trim.settle_base(&loops, apart)?;
        let bounded = match chart.map {
            super::chart::Map::Sphere | super::chart::Map::Torus(..) => true,
            super::chart::Map::Cone(..) => trim.base == 0,
            super::chart::Map::Flat if chart.periods != [0.0, 0.0] => true,
            super::chart::Map::Flat | super::chart::Map::Cylinder => trim.base == 0 && winding == 0,
        };
        let closes = trim.steps.iter().map(|(_, step)| step).sum::<i32>() == 0;
        debug_assert!(period > 0.0 || winding == 0);
        match bounded && closes {
            true => Ok(trim),
            false => Err(TrimProblem::Unbounded),
        }
    }

    /// Adds a draft's arcs, cut at the ends of the periods; says how often it went round in u.
    fn add(&mut self, draft: &Draft) -> i32 {
        let [period, height] = self.chart.periods;
        let [start, end] = draft.ends.map(|raw| self.chart.reduced(raw));
        let ahead = lifted(draft.ends[1][0], draft.ends[0][0], period) - draft.ends[0][0];
        let turns = match period {
            0.0 => 0,
            _ => ((ahead - (end[0] - start[0])) / period).round() as i32,
        };
        let Some(points) = &draft.points else {
            self.add_level(start[0], end[0], turns, start[1]);
            return turns;
        };
        // Heights along it, going on past the cut of v.
        let mut heights = Vec::with_capacity(17);
        for k in 0..=16 {
            let h = bezier::evaluate(points, f64::from(k) / 16.0).0;
            let v = self.chart.reduced(self.chart.raw(&h))[1];
            let near = heights.last().copied().unwrap_or(v);
            heights.push(lifted(v, near, height));
        }
        let (low, high) = heights
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| {
                (l.min(x), h.max(x))
            });
        if height > 0.0 && (low < 0.0 || high >= height) {
            self.add_across(draft, points, &heights);
            return turns;
        }
        let slack = 0.1 * (high - low) + 1e-12 * (low.abs() + high.abs());
        let shift = if self.chart.is_flat() {
            draft.ends[0][0] - self.chart.origin[0] - start[0]
        } else {
            0.0
        };
        self.add_between(
            start[0],
            end[0],
            turns,
            [low - slack, high + slack],
            |turned| Path::Curve(points.clone(), shift + f64::from(turned) * period),
        );
        turns
    }

    fn add_level(&mut self, from: f64, to: f64, turns: i32, v: f64) {
        self.add_between(from, to, turns, [v, v], |_| Path::Level);
    }

    /// One arc, or those on both sides of the line where u begins anew.
    fn add_between(
        &mut self,
        from: f64,
        to: f64,
        turns: i32,
        v: [f64; 2],
        path: impl Fn(i32) -> Path,
    ) {
        let period = self.chart.periods[0];
        let mut push = |u: [f64; 2], turned: i32| {
            self.arcs.push(Arc {
                u,
                v,
                path: path(turned),
            });
        };
        match turns {
            0 => push([from, to], 0),
            1.. => {
                push([from, period], 0);
                push([0.0, to], 1);
            }
            _ => {
                push([from, 0.0], 0);
                push([period, to], -1);
            }
        }
    }

    /// An arc that crosses the line at which v is cut: divided there. The base changes by what is on its sides.
    fn add_across(&mut self, draft: &Draft, points: &[Homogeneous], heights: &[f64]) {
        let height = self.chart.periods[1];
        let turn = (heights[0] / height).floor();
        let other = heights
            .iter()
            .map(|v| (v / height).floor())
            .find(|&t| t != turn);
        let line = height * other.map_or(turn, |t| turn.max(t));
        let v_at = |t: f64| {
            let h = bezier::evaluate(points, t).0;
            let v = self.chart.reduced(self.chart.raw(&h))[1];
            let k = ((t * 16.0) as usize).min(16);
            lifted(v, heights[k], height)
        };
        let up = *heights.last().unwrap_or(&0.0) > heights[0];
        let (mut a, mut b) = (0.0, 1.0);
        for _ in 0..60 {
            let t = 0.5 * (a + b);
            if (v_at(t) < line) == up { a = t } else { b = t }
        }
        let t = 0.5 * (a + b);
        let raw = self.chart.raw(&bezier::evaluate(points, t).0);
        let at = self.chart.reduced(raw)[0];
        self.steps.push((at, if up { -1 } else { 1 }));
        let tiny = 1e-12;
        for (within, ends) in [
            ([0.0, t - tiny], [draft.ends[0], raw]),
            ([t + tiny, 1.0], [raw, draft.ends[1]]),
        ] {
            if within[1] - within[0] > tiny {
                let part = Draft {
                    points: Some(bezier::between(points, within)),
                    ends,
                    pole: [false; 2],
                };
                self.add(&part);
            }
        }
    }

    fn tabulate(&mut self) {
        let [low, high] = self.reach[0];
        let width = (high - low).max(f64::MIN_POSITIVE);
        self.columns = (low, COLUMNS as f64 / width);
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); COLUMNS];
        for (k, arc) in self.arcs.iter().enumerate() {
            let [a, b] = [arc.u[0].min(arc.u[1]), arc.u[0].max(arc.u[1])];
            for list in &mut lists[self.column(a)..=self.column(b)] {
                list.push(k as u32);
            }
        }
        self.starts = vec![0];
        for list in lists {
            self.lists.extend(list);
            self.starts.push(self.lists.len() as u32);
        }
    }

    fn column(&self, u: f64) -> usize {
        (((u - self.columns.0) * self.columns.1) as usize).min(COLUMNS - 1)
    }

    /// How high an arc is over a u within its range.
    fn height_at(&self, arc: &Arc, u: f64) -> f64 {
        let Path::Curve(points, shift) = &arc.path else {
            return arc.v[0];
        };
        let t = self.parameter(points, u + shift);
        let h = bezier::evaluate(points, t).0;
        let v = self.chart.reduced(self.chart.raw(&h))[1];
        lifted(v, 0.5 * (arc.v[0] + arc.v[1]), self.chart.periods[1])
    }

    /// Signed crossings above a place; `None` when it is on an arc. `but`: an arc that is not looked at.
    fn crossings(&self, [u, v]: [f64; 2], but: Option<usize>) -> Option<i32> {
        if self.arcs.is_empty() || !(u >= self.reach[0][0] && u <= self.reach[0][1]) {
            return Some(0);
        }
        let column = self.column(u);
        let mut count = 0;
        for &k in &self.lists[self.starts[column] as usize..self.starts[column + 1] as usize] {
            let arc = &self.arcs[k as usize];
            let [before, after] = arc.u.map(|end| end <= u);
            if before == after || arc.v[1] < v || but == Some(k as usize) {
                continue;
            }
            // Towards −u the left is below.
            let sign = if before { -1 } else { 1 };
            if arc.v[0] > v {
                count += sign;
                continue;
            }
            let height = self.height_at(arc, u);
            if (height - v).abs() <= ON * self.height.max(v.abs()) {
                return None;
            }
            count += if height > v { sign } else { 0 };
        }
        Some(count)
    }

    fn base_at(&self, u: f64) -> i32 {
        let passed = self.steps.iter().take_while(|(at, _)| *at <= u);
        self.base + passed.map(|(_, step)| step).sum::<i32>()
    }

    /// Whether a place of the carrier, in its own parameters, belongs to the face. Loops belong to it.
    pub fn contains(&self, uv: [f64; 2]) -> bool {
        let q = self.chart.reduced(uv);
        self.crossings(q, None)
            .is_none_or(|count| count + self.base_at(q[0]) > 0)
    }

    /// A rectangle of the carrier's parameters that holds the face.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let [_, height] = self.chart.periods;
        let [ou, ov] = self.chart.origin;
        let [u, mut v] = [self.free_of_u(), self.reach[1]];
        let over_the_cut = self.base != 0 || !self.steps.is_empty();
        if height > 0.0 && over_the_cut {
            v = [0.0, height];
        }
        let [low, high] = self.chart.poles();
        let reaches = |pole: f64| self.contains([u[0] + ou, pole]) || self.arcs.is_empty();
        let low = low.filter(|&pole| reaches(pole)).unwrap_or(v[0] + ov);
        let high = high.filter(|&pole| reaches(pole)).unwrap_or(v[1] + ov);
        [[u[0] + ou, u[1] + ou], [low, high]]
    }

    /// The range of u outside which nothing belongs to the face: all but the widest range without arcs, where u goes round.
    fn free_of_u(&self) -> [f64; 2] {
        let period = self.chart.periods[0];
        if period == 0.0 {
            return self.reach[0];
        }
        let mut spans: Vec<[f64; 2]> = self
            .arcs
            .iter()
            .map(|arc| [arc.u[0].min(arc.u[1]), arc.u[0].max(arc.u[1])])
            .collect();
        spans.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let Some(first) = spans.first().map(|span| span[0]) else {
            return [0.0, period];
        };
        let mut widest = [0.0, 0.0];
        let mut high = spans[0][1];
        for span in spans.iter().skip(1).chain([&[first + period; 2]]) {
            if span[0] - high > widest[1] - widest[0] {
                widest = [high, span[0]];
            }
            high = high.max(span[1]);
        }
        let middle = wrap(0.5 * (widest[0] + widest[1]), period);
        match widest[1] - widest[0] > 0.0 && self.base_at(middle) == 0 {
            true => [widest[1] - period, widest[0]],
            false => [0.0, period],
        }
    }

    /// The v from which integrals across begin.
    pub fn bottom(&self) -> f64 {
        let [pole, _] = self.chart.poles();
        let lowest = if self.arcs.is_empty() || self.chart.periods[1] > 0.0 {
            0.0
        } else {
            self.reach[1][0]
        };
        match self.chart.is_flat() {
            true if self.chart.periods == [0.0, 0.0] => lowest,
            true => 0.0,
            false => pole.unwrap_or(lowest),
        }
    }

    /// Ranges of u, and the base in each.
    pub fn bases(&self) -> Vec<([f64; 2], i32)> {
        let [low, high] = match self.chart.periods[0] {
            0.0 => self.reach[0],
            period => [0.0, period],
        };
        let mut from = low;
        let mut out = Vec::new();
        for at in self.steps.iter().map(|step| step.0).chain([high]) {
            out.push(([from, at], self.base_at(0.5 * (from + at))));
            from = at;
        }
        out
    }

    /// Its loops in monotone pieces.
    pub fn walks(&self) -> impl Iterator<Item = Walk<'_>> {
        self.arcs.iter().map(|arc| Walk {
            points: match &arc.path {
                Path::Curve(points, shift) => Some((
                    points.as_slice(),
                    arc.u.map(|u| self.parameter(points, u + shift)),
                )),
                Path::Level => None,
            },
            u: arc.u,
            v: 0.5 * (arc.v[0] + arc.v[1]),
        })
    }

    /// Where a monotone segment has a u; the nearer end where it has not.
    fn parameter(&self, points: &[Homogeneous], u: f64) -> f64 {
        self.chart.beside(points, u).root()
    }

    /// The base for which the left of the arcs is inside; `loops`: which arcs each loop has.
    ///
    /// All arcs must agree, but for two kinds. Where u begins anew, rounding cuts off pieces of no width. And where edges do not
    /// quite meet, each may go past the other by as much as they are apart: what goes past is on the wrong side. `apart`: how
    /// far in u the ends of edges are from the starts of the next ones, over all loops.
    fn settle_base(&mut self, loops: &[Range<usize>], apart: f64) -> Result<(), TrimProblem> {
        let mut votes: Vec<(i32, f64)> = Vec::new();
        let size = self
            .reach
            .map(|[low, high]| (high - low).max(f64::MIN_POSITIVE));
        // An arc that is upright but for rounding says nothing of what is above and below it.
        let says = |arc: &Arc| {
            let [across, along] = [arc.u, arc.v].map(|[a, b]| (b - a).abs());
            across / size[0] > 1e-4 * along / size[1] && arc.path != Path::Level
        };
        let step = 1 + self.arcs.len() / MOST_VOTES;
        let telling: Vec<usize> = (loops.iter())
            .flat_map(|arcs| arcs.clone().filter(|&k| says(&self.arcs[k])).step_by(step))
            .collect();
        for k in telling {
            let arc = &self.arcs[k];
            let u = 0.5 * (arc.u[0] + arc.u[1]);
            let v = self.height_at(arc, u);
            let Some(above) = self.crossings([u, v], Some(k)) else {
                continue;
            };
            let own = i32::from(arc.u[1] < arc.u[0]);
            let base = 1 - above - own - self.base_at(u);
            vote(&mut votes, base, (arc.u[1] - arc.u[0]).abs());
        }
        if votes.is_empty() {
            // Upright arcs alone: their left is beside them.
            for (k, arc) in self.arcs.iter().enumerate() {
                let [mut low, mut high] = arc.v;
                if let Path::Curve(points, _) = &arc.path {
                    let middle = 0.5 * (low + high);
                    let end = |t| {
                        let v = self.chart.raw(&bezier::evaluate(points, t).0);
                        lifted(self.chart.reduced(v)[1], middle, self.chart.periods[1])
                    };
                    (low, high) = (end(0.0), end(1.0));
                }
                let [a, b] = [arc.u[0].min(arc.u[1]), arc.u[0].max(arc.u[1])];
                let tiny = 1e-12 * (1.0 + b.abs());
                let u = if high > low { a - tiny } else { b + tiny };
                let u = wrap(u, self.chart.periods[0]);
                if let Some(above) = self.crossings([u, 0.5 * (low + high)], Some(k)) {
                    vote(&mut votes, 1 - above - self.base_at(u), (high - low).abs());
                }
            }
        }
        let total: f64 = votes.iter().map(|vote| vote.1).sum();
        let best = votes
            .iter()
            .copied()
            .fold((1, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        self.base = best.0;
        let wrong = total - best.1;
        let past = (2.0 * apart).min(MOST_WRONG * total);
        match wrong <= past + ROUNDING * total {
            true => Ok(()),
            false => Err(TrimProblem::Contradiction { wrong, total }),
        }
    }
}

fn vote(votes: &mut Vec<(i32, f64)>, base: i32, length: f64) {
    match votes.iter_mut().find(|vote| vote.0 == base) {
        Some(vote) => vote.1 += length,
        None => votes.push((base, length)),
    }
}

/// A chain in pieces on which u only grows or only falls, by a sixth of a turn at most. Adds to `apart` how far in u the ends
/// are from the starts.
fn drafts(chart: &Chart, chain: &[Piece], size: f64, apart: &mut f64) -> Vec<Draft> {
    let mut out: Vec<Draft> = Vec::new();
    for piece in chain {
        for points in at_poles(chart, &piece.points, size) {
            let mut from = 0.0;
            let turns = chart.progress(&points).sign_changes();
            for to in turns.into_iter().chain([1.0]) {
                if to - from > 1e-12 {
                    short(
                        chart,
                        &bezier::between(&points, [from, to]),
                        size,
                        0,
                        &mut out,
                    );
                    from = to;
                }
            }
        }
    }
    join(chart, out, apart)
}

/// Divided where it passes through a pole.
fn at_poles(chart: &Chart, points: &[Homogeneous], size: f64) -> Vec<Vec<Homogeneous>> {
    if chart.poles() == [None, None] {
        return vec![points.to_vec()];
    }
    let rho = |t: f64| {
        let p = bezier::point(points, t);
        libm::hypot(p.x, p.y)
    };
    let count = 32;
    let at = |k: usize| k as f64 / count as f64;
    for k in 1..count {
        if rho(at(k)) <= rho(at(k - 1)) && rho(at(k)) <= rho(at(k + 1)) {
            let (mut a, mut b) = (at(k - 1), at(k + 1));
            for _ in 0..80 {
                let (c, d) = (a + (b - a) * 0.382, b - (b - a) * 0.382);
                if rho(c) < rho(d) { b = d } else { a = c }
            }
            let t = 0.5 * (a + b);
            if rho(t) < 1e-7 * size {
                let (low, high) = bezier::split(points, t);
                let mut all = vec![low];
                all.extend(at_poles(chart, &high, size));
                return all;
            }
        }
    }
    vec![points.to_vec()]
}

/// Halved until neither parameter can have gone the longer way round.
fn short(chart: &Chart, points: &[Homogeneous], size: f64, depth: usize, out: &mut Vec<Draft>) {
    let raw = |t: f64| chart.raw(&bezier::evaluate(points, t).0);
    let rho = |t: f64| {
        let p = bezier::point(points, t);
        libm::hypot(p.x, p.y)
    };
    let has_poles = chart.poles() != [None, None];
    let pole = [0.0, 1.0].map(|t| has_poles && rho(t) < 1e-7 * size);
    let nearly = |t: f64| match t {
        0.0 if pole[0] => 1e-5,
        1.0 if pole[1] => 1.0 - 1e-5,
        t => t,
    };
    let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| raw(nearly(t)));
    let far = |direction: usize| {
        places.windows(2).any(|w| {
            let (a, b) = (w[0][direction], w[1][direction]);
            (lifted(b, a, chart.periods[direction]) - a).abs() > 0.25 * chart.step(direction)
        })
    };
    if depth < 12 && (far(0) || chart.periods[1] > 0.0 && far(1)) {
        let (low, high) = bezier::split(points, 0.5);
        short(chart, &low, size, depth + 1, out);
        short(chart, &high, size, depth + 1, out);
        return;
    }
    let mut ends = [places[0], places[4]];
    for (end, at_pole) in ends.iter_mut().zip(pole) {
        if at_pole {
            let poles = chart.poles().into_iter().flatten();
            end[1] = poles.fold(f64::INFINITY, |best, v| {
                if (v - end[1]).abs() < (best - end[1]).abs() {
                    v
                } else {
                    best
                }
            });
        }
    }
    out.push(Draft {
        points: Some(points.to_vec()),
        ends,
        pole,
    });
}

/// Neighbours share their u; at a pole a level run goes from one to the other.
fn join(chart: &Chart, drafts: Vec<Draft>, total_apart: &mut f64) -> Vec<Draft> {
    let n = drafts.len();
    let starts: Vec<_> = drafts
        .iter()
        .map(|draft| (draft.ends[0], draft.pole[0]))
        .collect();
    let mut out = Vec::with_capacity(n);
    for (k, mut draft) in drafts.into_iter().enumerate() {
        let (next, pole) = starts[(k + 1) % n];
        let apart = lifted(next[0], draft.ends[1][0], chart.periods[0]) - draft.ends[1][0];
        if !(draft.pole[1] && pole) {
            *total_apart += apart.abs();
        }
        if draft.pole[1] && pole || chart.is_flat() && apart.abs() > 1e-9 * next[0].abs() {
            let run = Draft {
                points: None,
                ends: [draft.ends[1], next],
                pole: [true; 2],
            };
            out.extend([draft, run]);
        } else {
            draft.ends[1][0] = lifted(next[0], draft.ends[1][0], chart.periods[0]);
            out.push(draft);
        }
    }
    out
}

/// Where to cut a periodic v: in the middle of the widest range in which no loop is.
fn cut(chart: &Chart, drafts: &[Vec<Draft>]) -> f64 {
    let period = chart.periods[1];
    let mut taken: Vec<f64> = Vec::new();
    for draft in drafts.iter().flatten() {
        let Some(points) = &draft.points else {
            continue;
        };
        for k in 0..=32 {
            let h = bezier::evaluate(points, f64::from(k) / 32.0).0;
            taken.push(wrap(chart.raw(&h)[1] - chart.origin[1], period));
        }
    }
    taken.sort_unstable_by(f64::total_cmp);
    let Some(&first) = taken.first() else {
        return chart.origin[1];
    };
    let mut widest = (0.0, 0.0);
    for (k, &v) in taken.iter().enumerate() {
        let next = taken.get(k + 1).copied().unwrap_or(first + period);
        if next - v > widest.0 {
            widest = (next - v, v);
        }
    }
    chart.origin[1] + widest.1 + 0.5 * widest.0
}
