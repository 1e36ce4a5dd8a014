//! Faces as formats want them that know no periods: a surface with ends, and closed curves in the rectangle of its parameters.
//!
//! ```text
//! chains without seams ── lifted along periods ──▶ those that go round: cut, a seam between them ──▶ rectangle ──▶ patch
//!                                                                                      edges, seams ── projected ──▶ pictures
//! ```

mod walk;

use self::walk::{Span, Walk, crosses};
use super::bezier::Homogeneous;
use super::carrier::Carrier;
use super::chart::{lifted, wrap};
use super::curve::EdgeCurve;
use super::part::{Face, Part};
use super::pcurve::{FlatCurve, PCurve};
use crate::surface::{ClosestSolver, Direction, Surface, SurfaceError};

/// Places of a segment at which a loop is followed through the parameters.
const PLACES: usize = 32;
/// Of the rectangle of a face: how much larger its patch is, where nothing ends there.
const MARGIN: f64 = 0.02;
/// Of the rectangle: ends that are one place.
const SAME: f64 = 1e-7;
/// Of the rectangle: loops that leave it.
const OUTSIDE: f64 = 1e-6;

/// A face on a surface with ends.
#[derive(Clone, Debug)]
pub(crate) struct FlatFace {
    /// Its normal is the face's.
    pub surface: Surface,
    /// The first is around all others, unless the edges of the surface are; each has the face on its left.
    pub loops: Vec<Vec<FlatPiece>>,
    /// The face goes to all edges of the surface, but for its loops.
    pub whole: bool,
}

/// A piece of a loop.
#[derive(Clone, Debug)]
pub(crate) struct FlatPiece {
    /// In space: rational Bézier segments; none along a pole.
    pub curve: Vec<Vec<Homogeneous>>,
    /// In the parameters of the surface.
    pub picture: FlatCurve,
}

/// Why a face cannot be laid flat.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlatProblem {
    /// Loops around both directions of a torus, or several times round.
    #[error(
        "its loops go round in a way that one rectangle of parameters cannot show: divide the face in the CAD system"
    )]
    Windings,
    /// No line across free of loops.
    #[error(
        "its loops cross every line at which it could be cut open: divide the face in the CAD system"
    )]
    NoSeam,
    /// Outer loops.
    #[error("it has {0} outer loops: divide it into as many faces")]
    Pieces(usize),
    /// An edge through a pole.
    #[error("edge #{0} has no image in its parameters: it passes through a pole; divide it there")]
    Edge(u64),
    /// Coordinates beyond all lengths.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

struct Flattening<'a> {
    part: &'a Part,
    index: u32,
    face: &'a Face,
    periods: [f64; 2],
    /// v, or u, at which there is a pole.
    poles: [[Option<f64>; 2]; 2],
}

impl Part {
    /// A face on a surface with ends.
    pub(crate) fn flattened(&self, index: usize) -> Result<FlatFace, FlatProblem> {
        let face = &self.faces[index];
        let mut poles = [[None; 2], face.trim.chart.poles()];
        if let Carrier::Spline(surface) = &face.carrier {
            let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
            for k in 0..2 {
                let ends = [domain[k].0, domain[k].1];
                let closed = face.carrier.periods()[k] > 0.0;
                poles[k] = [0, 1].map(|e| (!closed && !face.rims[k][e]).then_some(ends[e]));
            }
        }
        let flattening = Flattening {
            part: self,
            index: index as u32,
            face,
            periods: face.carrier.periods(),
            poles,
        };
        let mut flat = flattening.laid()?;
        if !face.same_sense {
            flat.exchange();
        }
        Ok(flat)
    }
}

impl FlatFace {
    /// u and v exchanged: the normal is the other one.
    fn exchange(&mut self) {
        self.surface = self.surface.swap_uv().with_flip_normal(false);
        for piece in self.loops.iter_mut().flatten() {
            piece.picture.points.iter_mut().for_each(|p| p.swap(0, 1));
        }
    }
}

impl Flattening<'_> {
    fn laid(&self) -> Result<FlatFace, FlatProblem> {
        let mut walks: Vec<Walk> = (self.face.chains.iter())
            .map(|chain| self.walk(chain))
            .collect();
        let turns: Vec<[i32; 2]> = walks.iter().map(|walk| walk.turns(self.periods)).collect();
        let round = |k: usize| turns.iter().any(|turns| turns[k] != 0);
        match [round(0), round(1)] {
            [false, false] => self.closed(walks),
            [true, true] => Err(FlatProblem::Windings),
            [u, _] => {
                let k = usize::from(!u);
                let mut bands = Vec::new();
                for (at, turns) in turns.iter().enumerate().rev() {
                    if turns[k] != 0 {
                        bands.push((walks.remove(at), turns[k]));
                    }
                }
                self.band(k, bands, walks)
            }
        }
    }

    /// The place of a span's edge in the face's parameters; and whether it is at a pole, where the other one is none.
    fn at(&self, span: &Span, place: f64) -> Option<([f64; 2], bool)> {
        let edge = &self.part.edges[span.edge as usize];
        let at = placed(&edge.curve, place);
        let side = edge.sides.iter().find(|side| side.face == self.index)?;
        let mut uv = edge.on(side, &self.part.faces, at)?;
        let [low, high] = self.face.trim.reach[1];
        let close = 1e-6 * (high - low);
        // Of B-splines the traced curve says what it tends to.
        let poles = self.poles[1]
            .iter()
            .flatten()
            .filter(|_| side.pcurve.is_none());
        let pole = poles.copied().find(|pole| (uv[1] - pole).abs() <= close);
        uv[1] = pole.unwrap_or(uv[1]);
        Some((uv, pole.is_some()))
    }

    fn walk(&self, chain: &[(u32, bool)]) -> Walk {
        let spans = chain.iter().map(|&(edge, forward)| {
            let count = self.part.edges[edge as usize].curve.segments() as f64;
            let [from, to] = if forward { [0.0, count] } else { [count, 0.0] };
            Span { edge, from, to }
        });
        self.lifted(spans.collect())
    }

    /// Follows spans through the parameters.
    fn lifted(&self, spans: Vec<Span>) -> Walk {
        let mut places: Vec<((usize, f64), [f64; 2])> = Vec::new();
        for (s, span) in spans.iter().enumerate() {
            let steps = (PLACES as f64 * (span.to - span.from).abs())
                .ceil()
                .max(4.0);
            for k in 0..=steps as usize {
                let place = span.from + (span.to - span.from) * (k as f64 / steps);
                let near = places.last().map(|(_, near)| *near);
                match (self.at(span, place), near) {
                    (Some((uv, false)), None) => places.push(((s, place), uv)),
                    (Some((uv, true)), Some(near)) => places.push(((s, place), [near[0], uv[1]])),
                    (Some((uv, false)), Some(near)) => {
                        let uv = std::array::from_fn(|k| lifted(uv[k], near[k], self.periods[k]));
                        places.push(((s, place), uv));
                    }
                    _ => {}
                }
            }
        }
        if let (Some(&(at, first)), Some(&(_, near))) = (places.first(), places.last()) {
            let end = std::array::from_fn(|k| lifted(first[k], near[k], self.periods[k]));
            places.push((at, end));
        }
        Walk { spans, places }
    }

    /// A face whose loops do not go round: one around the others, or none but the edges of the carrier.
    fn closed(&self, mut walks: Vec<Walk>) -> Result<FlatFace, FlatProblem> {
        let sign = if self.face.same_sense { 1.0 } else { -1.0 };
        walks.sort_by(|a, b| (sign * b.area()).total_cmp(&(sign * a.area())));
        let outer = walks.iter().filter(|walk| sign * walk.area() > 0.0).count();
        if outer > 1 {
            return Err(FlatProblem::Pieces(outer));
        }
        let mut range = [[0.0; 2]; 2];
        for (k, range) in range.iter_mut().enumerate() {
            *range = match outer {
                1 => self.widened(k, walks[0].range(k)),
                _ => self.natural(k, &walks)?,
            };
        }
        let mut holes = walks.split_off(outer);
        self.seat(&mut range, &mut walks);
        self.within(range, &mut holes)?;
        walks.extend(holes);
        let patch = self.patch(range)?;
        let loops = walks.iter().map(|walk| {
            let pieces = self.pieces(&patch, walk)?;
            Ok(bridged(&patch, pieces))
        });
        let loops = loops.collect::<Result<_, FlatProblem>>()?;
        Ok(FlatFace {
            surface: patch,
            loops,
            whole: outer == 0,
        })
    }

    /// The ends of a B-spline in a direction in which it has some, or a seam that stays.
    fn ends(&self, k: usize) -> Option<[f64; 2]> {
        let Carrier::Spline(surface) = &self.face.carrier else {
            return None;
        };
        let knots = [surface.knots_u(), surface.knots_v()][k];
        let (low, high) = knots.domain();
        (!knots.is_periodic()).then_some([low, high])
    }

    /// Within the first period of a periodic B-spline; elsewhere as it is.
    fn seated(&self, k: usize, at: f64) -> f64 {
        let Carrier::Spline(surface) = &self.face.carrier else {
            return at;
        };
        let (low, _) = [surface.knots_u(), surface.knots_v()][k].domain();
        low + wrap(at - low, self.periods[k])
    }

    /// All of a direction, cut where no loop is.
    fn natural(&self, k: usize, walks: &[Walk]) -> Result<[f64; 2], FlatProblem> {
        let period = self.periods[k];
        if let Some(ends) = self.ends(k) {
            return Ok(ends);
        }
        if period == 0.0 {
            let [Some(low), Some(high)] = self.poles[k] else {
                return Err(FlatProblem::NoSeam);
            };
            return Ok([low, high]);
        }
        let ends = walks.iter().map(|walk| walk.range(k)[1]);
        let free = |at: f64| walks.iter().all(|walk| !crosses(walk.range(k), at, period));
        let widths = [0.0, 0.01, 0.1, 0.5].map(|w| w * period);
        let at = (ends.chain([0.0]))
            .flat_map(|end| widths.map(|w| end + w))
            .find(|&at| free(at));
        let at = self.seated(k, at.ok_or(FlatProblem::NoSeam)?);
        Ok([at, at + period])
    }

    /// A range with room beside it, as far as the carrier has it.
    fn widened(&self, k: usize, [low, high]: [f64; 2]) -> [f64; 2] {
        if let Some(ends) = self.ends(k) {
            return ends;
        }
        let room = MARGIN * (high - low);
        let [below, above] = self.poles[k];
        let low = below.map_or(low - room, |pole| (low - room).max(pole));
        let high = above.map_or(high + room, |pole| (high + room).min(pole));
        match self.periods[k] {
            period if period > 0.0 && high - low > period => {
                let middle = 0.5 * (low + high);
                [middle - 0.5 * period, middle + 0.5 * period]
            }
            _ => [low, high],
        }
    }

    /// Moves a rectangle and what is in it by whole periods, so that it begins in the first one of a periodic B-spline.
    fn seat(&self, range: &mut [[f64; 2]; 2], walks: &mut [Walk]) {
        for (k, range) in range.iter_mut().enumerate() {
            if self.ends(k).is_none() && self.periods[k] > 0.0 {
                let by = self.seated(k, range[0]) - range[0];
                range.iter_mut().for_each(|x| *x += by);
                walks.iter_mut().for_each(|walk| walk.shift(k, by));
            }
        }
    }

    /// Brings loops into a rectangle by whole periods.
    fn within(&self, range: [[f64; 2]; 2], walks: &mut [Walk]) -> Result<(), FlatProblem> {
        for walk in walks {
            for (k, [low, high]) in range.into_iter().enumerate() {
                let own = walk.range(k);
                let middle = 0.5 * (own[0] + own[1]);
                walk.shift(
                    k,
                    lifted(middle, 0.5 * (low + high), self.periods[k]) - middle,
                );
                let [a, b] = walk.range(k);
                let slack = OUTSIDE * (high - low);
                if a < low - slack || b > high + slack {
                    return Err(FlatProblem::NoSeam);
                }
            }
        }
        Ok(())
    }

    /// A face round an axis in direction `k`: between two loops, or between one and a pole.
    fn band(
        &self,
        k: usize,
        mut bands: Vec<(Walk, i32)>,
        mut holes: Vec<Walk>,
    ) -> Result<FlatFace, FlatProblem> {
        let period = self.periods[k];
        bands.sort_by_key(|(_, turns)| -turns);
        let turns: Vec<i32> = bands.iter().map(|(_, turns)| *turns).collect();
        if !matches!(turns[..], [1, -1] | [1] | [-1]) {
            return Err(FlatProblem::Windings);
        }
        let mut bands: Vec<Walk> = bands.into_iter().map(|(walk, _)| walk).collect();
        let start = self.seam(k, &bands, &holes)?;
        for walk in &mut bands {
            *walk = self.opened(k, walk, start)?;
        }
        // From the start of the first one; the second goes back.
        let first = turns[0];
        for (walk, turn) in bands.iter_mut().zip(&turns) {
            let at = walk.places[0].1[k];
            walk.shift(k, start + if *turn > 0 { 0.0 } else { period } - at);
        }
        // The left of a loop that goes up u is up v; that of one that goes up v is down u.
        let sign = if self.face.same_sense { 1.0 } else { -1.0 };
        let left = sign * f64::from(first) * if k == 0 { 1.0 } else { -1.0 };
        let other = 1 - k;
        let mut across = bands[0].range(other);
        if let [a, b] = &mut bands[..] {
            let (low, high) = (a.range(other), b.range(other));
            let apart = 0.5 * (high[0] + high[1] - low[0] - low[1]);
            if let by @ 0.0.. = self.periods[other]
                && by > 0.0
            {
                let wrapped = wrap(left * apart, by);
                b.shift(other, left * wrapped - apart);
            }
            let own = b.range(other);
            across = [across[0].min(own[0]), across[1].max(own[1])];
        } else {
            let [low, high] = self.poles[other];
            let pole = if left > 0.0 { high } else { low };
            let pole = pole.ok_or(FlatProblem::Windings)?;
            across = [across[0].min(pole), across[1].max(pole)];
        }
        let mut range = [[start, start + period]; 2];
        range[other] = self.widened(other, across);
        self.seat(&mut range, &mut bands);
        self.within(range, &mut holes)?;
        for walk in &bands {
            let [a, b] = walk.range(k);
            if a < start - OUTSIDE * period || b > start + period * (1.0 + OUTSIDE) {
                return Err(FlatProblem::NoSeam);
            }
        }
        let patch = self.patch(range)?;
        let mut outer = self.pieces(&patch, &bands[0])?;
        let (begin, turned) = (start_of(&outer), end_of(&outer));
        if let Some(second) = bands.get(1) {
            let back = self.pieces(&patch, second)?;
            let (from, to) = (start_of(&back), end_of(&back));
            outer.push(line(&patch, turned, from, k));
            outer.extend(back);
            outer.push(line(&patch, to, begin, k));
        } else {
            let [low, high] = self.poles[other];
            let pole = if left > 0.0 { high } else { low };
            let [from, to] = [turned, begin].map(|mut uv| {
                uv[other] = pole.unwrap_or(uv[other]);
                uv
            });
            outer.push(line(&patch, turned, from, k));
            outer.push(FlatPiece {
                curve: Vec::new(),
                picture: FlatCurve::line(from, to),
            });
            outer.push(line(&patch, to, begin, k));
        }
        let mut loops = vec![bridged(&patch, outer)];
        for hole in &holes {
            loops.push(bridged(&patch, self.pieces(&patch, hole)?));
        }
        Ok(FlatFace {
            surface: patch,
            loops,
            whole: false,
        })
    }

    /// Where a band is cut open: at the end of an edge of its first loop, or within one, where each of its loops crosses the
    /// line once and no hole does.
    fn seam(&self, k: usize, bands: &[Walk], holes: &[Walk]) -> Result<f64, FlatProblem> {
        let period = self.periods[k];
        let beside = SAME * period;
        let free = |at: f64| {
            let mut both = bands.iter().flat_map(|band| {
                [at - beside, at + beside].map(|line| band.crossings(k, line, period))
            });
            (holes.iter()).all(|hole| !crosses(hole.range(k), at, period))
                && both.all(|count| count == 1)
        };
        if let Some([at, _]) = self.ends(k) {
            return free(at).then_some(at).ok_or(FlatProblem::NoSeam);
        }
        let walk = &bands[0];
        let starts = (walk.places.windows(2))
            .filter(|pair| pair[0].0.0 != pair[1].0.0)
            .map(|pair| pair[1].1[k]);
        let anywhere = walk.places.iter().map(|(_, uv)| uv[k] + 1e-3 * period);
        let mut all = [walk.places[0].1[k]]
            .into_iter()
            .chain(starts)
            .chain(anywhere);
        let at = all.find(|&at| free(at)).ok_or(FlatProblem::NoSeam)?;
        Ok(self.seated(k, at))
    }

    /// A loop that goes round, begun anew where it crosses a line.
    fn opened(&self, k: usize, walk: &Walk, line: f64) -> Result<Walk, FlatProblem> {
        let period = self.periods[k];
        let close = SAME * period;
        let off = |x: f64| x - lifted(line, x, period);
        if off(walk.places[0].1[k]).abs() <= close {
            return Ok(walk.clone());
        }
        let spans = &walk.spans;
        for pair in walk.places.windows(2) {
            let [((s, a), uv), ((s1, b), to)] = [pair[0], pair[1]];
            let (x, y) = (off(uv[k]), off(uv[k]) + to[k] - uv[k]);
            if s == s1 && x.signum() == y.signum() || s != s1 && y.abs() > close {
                continue;
            }
            let (at, cut) = match s == s1 {
                true => (s, self.crossing(k, &spans[s], [a, b], (uv[k], line))),
                false => (s1, b),
            };
            let span = spans[at];
            let mut all = vec![Span { from: cut, ..span }];
            all.extend(&spans[at + 1..]);
            all.extend(&spans[..at]);
            all.push(Span { to: cut, ..span });
            all.retain(|span| (span.to - span.from).abs() > 1e-9);
            return Ok(self.lifted(all));
        }
        Err(FlatProblem::NoSeam)
    }

    /// The place between two at which a span crosses a line; the first is at `near` in the direction.
    fn crossing(
        &self,
        k: usize,
        span: &Span,
        [mut a, mut b]: [f64; 2],
        (near, line): (f64, f64),
    ) -> f64 {
        let period = self.periods[k];
        let line = lifted(line, near, period);
        let off = |t: f64| {
            self.at(span, t)
                .map_or(0.0, |(uv, _)| lifted(uv[k], near, period) - line)
        };
        let from = off(a);
        for _ in 0..60 {
            let t = 0.5 * (a + b);
            match off(t).signum() == from.signum() {
                true => a = t,
                false => b = t,
            }
        }
        0.5 * (a + b)
    }

    fn patch(&self, range: [[f64; 2]; 2]) -> Result<Surface, FlatProblem> {
        let mut patch = self.face.carrier.patch(range)?.with_flip_normal(false);
        for (k, [low, high]) in range.into_iter().enumerate() {
            let direction = [Direction::U, Direction::V][k];
            if patch.knots(direction).is_periodic() {
                patch = patch.part(direction, low, high)?;
            }
        }
        Ok(patch)
    }

    /// The curves of a walk and their pictures, each lifted to begin where the one before ends.
    fn pieces(&self, patch: &Surface, walk: &Walk) -> Result<Vec<FlatPiece>, FlatProblem> {
        let mut solver = ClosestSolver::new(patch);
        let mut near = walk.places[0].1;
        let each = walk.spans.iter().map(|span| {
            let edge = &self.part.edges[span.edge as usize];
            let problem = FlatProblem::Edge(edge.id);
            let [a, b] = [span.from.min(span.to), span.from.max(span.to)];
            let curve = edge.curve.part(a, b).map_err(|_| problem.clone())?;
            let forward = span.from < span.to;
            let picture = PCurve::new(patch, &mut solver, &curve).joined(forward);
            let mut picture = picture.ok_or(problem)?;
            let from = picture.points[0];
            for k in 0..2 {
                let by = lifted(from[k], near[k], self.periods[k]) - from[k];
                picture.points.iter_mut().for_each(|p| p[k] += by);
            }
            near = picture.end();
            let mut curve = curve.chain_segments();
            if !forward {
                curve.reverse();
                curve.iter_mut().for_each(|points| points.reverse());
            }
            Ok(FlatPiece { curve, picture })
        });
        each.collect()
    }
}

fn start_of(pieces: &[FlatPiece]) -> [f64; 2] {
    pieces
        .first()
        .map_or([0.0; 2], |piece| piece.picture.points[0])
}

fn end_of(pieces: &[FlatPiece]) -> [f64; 2] {
    pieces.last().map_or([0.0; 2], |piece| piece.picture.end())
}

/// A seam: a line on which parameter `k` is constant.
fn line(patch: &Surface, from: [f64; 2], to: [f64; 2], k: usize) -> FlatPiece {
    let constant = [Direction::U, Direction::V][k];
    let knots = if k == 0 {
        patch.knots_u()
    } else {
        patch.knots_v()
    };
    let other = 1 - k;
    let curve = patch.iso_curve(constant, knots.confine(from[k]));
    let curve = curve.map_or_else(
        |_| Vec::new(),
        |curve| {
            let confined = |x: f64| curve.knots().confine(x);
            let [a, b] = [confined(from[other]), confined(to[other])];
            let mut chain = super::curve::chain_between(&curve, true, [a.min(b), a.max(b)]);
            if a > b {
                chain.reverse();
                chain.iter_mut().for_each(|points| points.reverse());
            }
            chain
        },
    );
    FlatPiece {
        curve,
        picture: FlatCurve::line(from, to),
    }
}

/// Gaps between pictures closed: small ones by moving ends, others by lines along the pole that is there.
fn bridged(patch: &Surface, pieces: Vec<FlatPiece>) -> Vec<FlatPiece> {
    let count = pieces.len();
    let domain = [patch.knots_u().domain(), patch.knots_v().domain()];
    let starts: Vec<[f64; 2]> = pieces.iter().map(|piece| piece.picture.points[0]).collect();
    let mut out = Vec::with_capacity(count);
    for (j, mut piece) in pieces.into_iter().enumerate() {
        let (end, next) = (piece.picture.end(), starts[(j + 1) % count]);
        let apart = (0..2).map(|k| (end[k] - next[k]).abs() / (domain[k].1 - domain[k].0));
        let apart = apart.fold(0.0, f64::max);
        let last = piece.picture.points.len() - 1;
        if apart <= SAME.sqrt() {
            piece.picture.points[last] = next;
        }
        for p in &mut piece.picture.points {
            *p = std::array::from_fn(|k| p[k].clamp(domain[k].0, domain[k].1));
        }
        out.push(piece);
        if apart > SAME.sqrt() {
            out.push(FlatPiece {
                curve: Vec::new(),
                picture: FlatCurve::line(end, next),
            });
        }
    }
    out
}

fn placed(curve: &EdgeCurve, place: f64) -> (usize, f64) {
    let last = curve.segments() - 1;
    let segment = (place.max(0.0) as usize).min(last);
    (segment, place - segment as f64)
}

#[cfg(test)]
mod tests;
