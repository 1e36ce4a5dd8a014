//! Longitude and share of the length on a section, and the way back.

use super::error::PieceSkinError;
use super::fine::{Corner, Fine, Lies, Sheets};
use super::harmonic::{FIXED, Harmonic};
use super::levels::{Levels, Strip};
use super::sections::{Net, Rim, Sections};
use crate::math::Vector3;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Of the radius: a pole farther from the centre of a round frame is no place to see it from.
const MOST_OFF_CENTRE: f64 = 0.6;

/// Times a chart is eased at most, the strain below which it is not, and what of it is left at most where it helps.
const MOST_EASED: usize = 6;
const CALM: f64 = 2.4;
const LEAST_GAIN: f64 = 0.9;
/// Above this strain, it is tried once more where it did not help.
const WILD: f64 = 6.0;
/// What strain counts for in a chart without a pole at a tip of the surface: the fit rounds the tip.
const LOST_TIP: f64 = 2.5;

/// Where a section ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// At a pole where it begins.
    First,
    /// At rims on both sides.
    Ring,
    /// At a pole where it ends.
    Last,
    /// At four sides: no turns, but shares of two lengths.
    Patch,
}

/// A triangle in the chart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laid {
    pub triangle: u32,
    pub places: [[f64; 2]; 3],
}

/// A section laid out: a disc about the pole, a band of one turn, or a square.
pub(super) struct Chart {
    pub kind: Kind,
    /// In the mean, m.
    pub length_m: f64,
    /// Corners of the piece: longitude in turns, share of the length from where the section begins.
    pub corners: Vec<(u32, [f64; 2])>,
    laid: Vec<Laid>,
    bins: Bins,
}

/// Longitudes along a rim, in turns.
pub(super) struct RimTurns {
    /// (corners of the walk, and the first again), ascending by one turn.
    pub turns: Vec<f64>,
}

impl RimTurns {
    /// By length, from an offset on.
    pub fn new(fine: &Fine, rim: &Rim, offset: f64) -> Self {
        let mut turns = vec![offset];
        let mut passed = 0.0;
        let count = rim.corners.len();
        for k in 0..count {
            let [p, q] = [k, (k + 1) % count].map(|k| fine.corners[rim.corners[k] as usize].rest);
            passed += (q - p).norm();
            turns.push(offset + passed / rim.length_m);
        }
        turns[count] = offset + 1.0;
        Self { turns }
    }

    /// The edge of a longitude, and the place on it from 0 to 1.
    pub fn find(&self, turn: f64) -> (usize, f64) {
        let turn = turn - (turn - self.turns[0]).floor();
        let last = self.turns.len() - 2;
        let k = self
            .turns
            .partition_point(|t| *t <= turn)
            .clamp(1, last + 1)
            - 1;
        let (a, b) = (self.turns[k], self.turns[k + 1]);
        (k, ((turn - a) / (b - a).max(1e-300)).clamp(0.0, 1.0))
    }
}

/// All sections, and the longitudes of the rims between them. Rims begin where longitude does.
pub(super) fn charts(
    fine: &Fine,
    net: &Net,
    sections: &mut Sections,
    is_tip: &dyn Fn(u32) -> bool,
) -> Result<(Vec<Chart>, Vec<RimTurns>), PieceSkinError> {
    let (mut charts, mut turns) = (Vec::new(), Vec::new());
    for section in 0..sections.count {
        let triangles: Vec<u32> = (0..fine.triangles.len() as u32)
            .filter(|&t| sections.of[t as usize] as usize == section)
            .collect();
        let kind = match section {
            0 => Kind::First,
            k if k + 1 == sections.count => Kind::Last,
            _ => Kind::Ring,
        };
        if kind == Kind::First {
            turns.push(RimTurns::new(fine, &sections.rims[0], 0.0));
        }
        let before = section.saturating_sub(1);
        let maker = Maker {
            fine,
            net,
            of: &sections.of,
            section: section as u32,
            triangles,
            kind,
        };
        let rims: Vec<&[u32]> = (sections.rims[before..(section + 1).min(sections.rims.len())])
            .iter()
            .map(|rim| rim.corners.as_slice())
            .collect();
        let harmonic = Harmonic::new(fine, net, &maker.triangles, &rims);
        let harmonic = harmonic.ok_or(PieceSkinError::Pinched)?;
        let near = &sections.rims[before];
        if kind == Kind::Ring {
            let (far_edge, steps) = maker.way_across(near, &sections.rims[section])?;
            sections.rims[section].end_with(far_edge);
            let ends = [&sections.rims[before], &sections.rims[section]];
            let (chart, offset) = maker.ring(&harmonic, ends, &turns[before], &steps)?;
            turns.push(RimTurns::new(fine, &sections.rims[section], offset));
            charts.push(chart);
        } else {
            charts.push(maker.disc(&harmonic, near, &turns[before], is_tip)?);
        }
    }
    Ok((charts, turns))
}

/// (triangles of the piece), and the mean over the area of a section.
struct Strain {
    of: Vec<f64>,
    mean: f64,
}

/// Lays out a section.
pub(super) struct Maker<'a> {
    pub fine: &'a Fine,
    pub net: &'a Net,
    /// (triangles of the piece) Their sections.
    pub of: &'a [u32],
    pub section: u32,
    pub triangles: Vec<u32>,
    pub kind: Kind,
}

impl Maker<'_> {
    /// Triangles from one at an edge to the first that is wanted, with the edges by which each is entered.
    fn way(
        &self,
        from: u32,
        wanted: &dyn Fn(u32) -> bool,
    ) -> Result<Vec<(u32, usize)>, PieceSkinError> {
        let edge = self.net.edges[from as usize];
        let inside = |t: u32| self.of[t as usize] == self.section;
        let first = edge.sides.into_iter().find(|side| inside(side.0));
        let (first, entered) = first.ok_or(PieceSkinError::Pinched)?;
        let mut before: Vec<Option<(u32, u8)>> = vec![None; self.of.len()];
        before[first as usize] = Some((first, entered));
        let mut ahead = VecDeque::from([first]);
        while let Some(t) = ahead.pop_front() {
            if wanted(t) {
                let (mut at, mut way) = (t, Vec::new());
                while let Some((back, k)) = before[at as usize] {
                    way.push((at, k as usize));
                    if back == at {
                        break;
                    }
                    at = back;
                }
                way.reverse();
                return Ok(way);
            }
            for k in 0..3 {
                let next = self.net.across(t, k);
                if inside(next) && before[next as usize].is_none() {
                    let sides = self.net.edges[self.net.of[t as usize][k] as usize].sides;
                    let side = sides[usize::from(sides[0].0 == t)];
                    before[next as usize] = Some((t, side.1));
                    ahead.push_back(next);
                }
            }
        }
        Err(PieceSkinError::Pinched)
    }

    /// One turn for each edge by which a way enters: longitude jumps there. From the end of the smaller number.
    fn steps(&self, way: &[(u32, usize)]) -> Vec<f64> {
        let mut steps = vec![0.0; self.net.edges.len()];
        // The section is on the left of the rim behind it and on the right of that before it.
        let sense = if self.kind == Kind::First { -1.0 } else { 1.0 };
        for &(t, k) in way {
            self.set_step(&mut steps, t, k, sense);
        }
        steps
    }

    fn set_step(&self, steps: &mut [f64], t: u32, k: usize, sense: f64) {
        let corners = self.fine.triangles[t as usize];
        let up = corners[k] < corners[(k + 1) % 3];
        steps[self.net.of[t as usize][k] as usize] = if up { sense } else { -sense };
    }

    /// A way from the last edge of one rim to an edge of the other, and its steps.
    pub fn way_across(&self, near: &Rim, far: &Rim) -> Result<(u32, Vec<f64>), PieceSkinError> {
        let mut at_far = vec![false; self.net.edges.len()];
        far.edges.iter().for_each(|&e| at_far[e as usize] = true);
        let leaves = |t: u32| {
            self.net.of[t as usize]
                .iter()
                .position(|&e| at_far[e as usize])
        };
        let way = self.way(near.edges[near.edges.len() - 1], &|t| leaves(t).is_some())?;
        let mut steps = self.steps(&way);
        let (last, _) = way[way.len() - 1];
        let k = leaves(last).unwrap_or(0);
        self.set_step(&mut steps, last, k, -1.0);
        Ok((self.net.of[last as usize][k], steps))
    }

    fn give(&self, values: &mut [f64], rim: &Rim, turns: &RimTurns) {
        for (&corner, turn) in rim.corners.iter().zip(&turns.turns) {
            values[corner as usize] = *turn;
        }
    }

    /// The chart of a ring, and the longitude at which its far rim begins.
    pub fn ring(
        &self,
        harmonic: &Harmonic,
        ends: [&Rim; 2],
        near: &RimTurns,
        steps: &[f64],
    ) -> Result<(Chart, f64), PieceSkinError> {
        let made = |harmonic: &Harmonic| -> Result<Chart, PieceSkinError> {
            let [turns, levels] = self.between(harmonic, ends, near, steps);
            Ok(self.laid(harmonic, &turns, &levels, steps, None))
        };
        let round_m = 0.5 * (ends[0].length_m + ends[1].length_m);
        let (chart, _) = self.eased(harmonic, made(harmonic)?, round_m, &made)?;
        // That of the chart that was the best, which need not be the last.
        let far = ends[1].corners[0];
        let begin = chart.corners.iter().find(|(corner, _)| *corner == far);
        let begin = begin.map_or(0.0, |(_, [turn, _])| *turn);
        Ok((chart, begin))
    }

    /// Turns and levels of a ring.
    fn between(
        &self,
        harmonic: &Harmonic,
        ends: [&Rim; 2],
        near: &RimTurns,
        steps: &[f64],
    ) -> [Vec<f64>; 2] {
        let nothing = vec![0.0; harmonic.count];
        let mut levels = vec![0.0; self.fine.corners.len()];
        let far_corners = &ends[1].corners;
        far_corners.iter().for_each(|&c| levels[c as usize] = 1.0);
        harmonic.solve(self.net, &mut levels, &nothing, &[]);
        let mut turns = vec![0.0; self.fine.corners.len()];
        self.give(&mut turns, ends[0], near);
        let far = RimTurns::new(self.fine, ends[1], 0.0);
        self.give(&mut turns, ends[1], &far);
        harmonic.solve(self.net, &mut turns, &nothing, steps);
        // Turning the far rim by an offset adds that times the level: the one with the least energy.
        let (mut with, mut own) = (0.0, 0.0);
        for &(e, weight) in &harmonic.edges {
            let [a, b] = self.net.edges[e as usize].ends.map(|k| k as usize);
            let rise = levels[b] - levels[a];
            with += weight * (turns[b] - turns[a] + steps[e as usize]) * rise;
            own += weight * rise * rise;
        }
        let offset = if own > 0.0 { -with / own } else { 0.0 };
        for (turn, level) in turns.iter_mut().zip(&levels) {
            *turn += offset * level;
        }
        [turns, levels]
    }

    /// By the better of two ways: levels of what flows from the rim to a pole suit what is long away from its rim, a membrane
    /// in a round frame what is long along it. The pole is in the middle, or at a tip of the surface.
    pub fn disc(
        &self,
        harmonic: &Harmonic,
        rim: &Rim,
        rim_turns: &RimTurns,
        is_tip: &dyn Fn(u32) -> bool,
    ) -> Result<Chart, PieceSkinError> {
        let numbers = harmonic.unknown.iter().enumerate();
        let inner = numbers
            .filter(|(_, row)| **row < FIXED)
            .map(|(corner, _)| corner as u32);
        let tips: Vec<u32> = inner.filter(|&corner| is_tip(corner)).collect();
        let at = |tip: &u32| {
            let around = |t: &&u32| self.fine.triangles[**t as usize].contains(tip);
            Some((*self.triangles.iter().find(around)?, Some(*tip)))
        };
        let mut places: Vec<(u32, Option<u32>)> = tips.iter().filter_map(at).collect();
        places.push((self.middle(harmonic), None));
        let round_m = rim.length_m;
        let mut best: Option<(f64, Chart)> = None;
        for (triangle, pole) in places {
            let flow = |harmonic: &Harmonic| -> Result<Chart, PieceSkinError> {
                let [turns, levels] = self.flow(harmonic, rim, rim_turns, triangle)?;
                Ok(self.laid(harmonic, &turns, &levels, &[], pole))
            };
            let membrane = |harmonic: &Harmonic| -> Result<Chart, PieceSkinError> {
                let [turns, levels] = self.membrane(harmonic, rim, rim_turns, pole);
                Ok(self.laid(harmonic, &turns, &levels, &[], pole))
            };
            let (a, b) = (flow(harmonic)?, membrane(harmonic)?);
            let (chart, strain) =
                match self.strain(&a, round_m).mean < self.strain(&b, round_m).mean {
                    true => self.eased(harmonic, a, round_m, &flow)?,
                    false => self.eased(harmonic, b, round_m, &membrane)?,
                };
            let lost = pole.is_none() && !tips.is_empty();
            let cost = if lost { LOST_TIP * strain } else { strain };
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, chart));
            }
            if cost <= CALM {
                break;
            }
        }
        best.map(|(_, chart)| chart).ok_or(PieceSkinError::Pinched)
    }

    /// Where the chart is stretched, weights are made smaller and it is made again, as long as that helps (Yoshizawa, Belyaev &
    /// Seidel, *A fast and simple stretch-minimizing mesh parameterization*, 2004): a horn gets its share of the chart.
    pub fn eased(
        &self,
        harmonic: &Harmonic,
        first: Chart,
        round_m: f64,
        again: &dyn Fn(&Harmonic) -> Result<Chart, PieceSkinError>,
    ) -> Result<(Chart, f64), PieceSkinError> {
        let mut strain = self.strain(&first, round_m);
        let mut factors = vec![1.0; self.net.edges.len()];
        let (mut best, mut least, mut idle) = (first, strain.mean, 0);
        for _ in 0..MOST_EASED {
            let most_idle = if least > WILD { 2 } else { 1 };
            if least <= CALM || idle >= most_idle {
                break;
            }
            for &(e, _) in &harmonic.edges {
                let sides = self.net.edges[e as usize].sides.map(|side| side.0 as usize);
                let inside = sides.into_iter().filter(|&t| self.of[t] == self.section);
                let (count, sum) = inside.fold((0.0, 0.0), |(n, s), t| (n + 1.0, s + strain.of[t]));
                let factor = &mut factors[e as usize];
                *factor = (*factor / libm::sqrt((sum / count).max(1e-3))).clamp(1e-9, 1e3);
            }
            let Some(eased) = harmonic.reweighted(self.net, &factors) else {
                break;
            };
            let chart = again(&eased)?;
            strain = self.strain(&chart, round_m);
            idle += 1;
            if strain.mean < LEAST_GAIN * least {
                (best, least, idle) = (chart, strain.mean, 0);
            }
        }
        Ok((best, least))
    }

    fn flow(
        &self,
        harmonic: &Harmonic,
        rim: &Rim,
        rim_turns: &RimTurns,
        middle: u32,
    ) -> Result<[Vec<f64>; 2], PieceSkinError> {
        let way = self.way(rim.edges[rim.edges.len() - 1], &|t| t == middle)?;
        let steps = self.steps(&way);
        let mut turns = vec![0.0; self.fine.corners.len()];
        self.give(&mut turns, rim, rim_turns);
        harmonic.solve(self.net, &mut turns, &vec![0.0; harmonic.count], &steps);
        let mut source = vec![0.0; harmonic.count];
        for corner in self.fine.triangles[middle as usize] {
            if let Some(x) = source.get_mut(harmonic.unknown[corner as usize] as usize) {
                *x = 1.0 / 3.0;
            }
        }
        let mut levels = vec![0.0; self.fine.corners.len()];
        harmonic.solve(self.net, &mut levels, &source, &[]);
        Ok([turns, levels])
    }

    /// Places in a circle, the rim on it; turns are where rays from the pole meet it.
    fn membrane(
        &self,
        harmonic: &Harmonic,
        rim: &Rim,
        rim_turns: &RimTurns,
        kept: Option<u32>,
    ) -> [Vec<f64>; 2] {
        let nothing = vec![0.0; harmonic.count];
        let mut places = [(); 2].map(|()| vec![0.0; self.fine.corners.len()]);
        for (&corner, turn) in rim.corners.iter().zip(&rim_turns.turns) {
            let (sin, cos) = libm::sincos(TAU * turn);
            places[0][corner as usize] = cos;
            places[1][corner as usize] = sin;
        }
        for place in &mut places {
            harmonic.solve(self.net, place, &nothing, &[]);
        }
        let [mut turns, mut levels] = places;
        let centre = kept.map(|k| [turns[k as usize], levels[k as usize]]);
        let near = |c: &[f64; 2]| libm::hypot(c[0], c[1]) <= MOST_OFF_CENTRE;
        let centre = centre.filter(near).unwrap_or([0.0; 2]);
        for (x, y) in turns.iter_mut().zip(&mut levels) {
            (*x, *y) = seen_from(centre, [*x, *y]);
        }
        self.give(&mut turns, rim, rim_turns);
        (rim.corners.iter()).for_each(|&corner| levels[corner as usize] = 0.0);
        [turns, levels]
    }

    /// How much the chart is stretched: squares of what a turn and the whole length are in space, by what they should be.
    fn strain(&self, chart: &Chart, round_m: f64) -> Strain {
        let mut strain = Strain {
            of: vec![1.0; self.of.len()],
            mean: 0.0,
        };
        let mut whole = 0.0;
        for one in &chart.laid {
            let area = self.fine.area_of(one.triangle as usize);
            let [a, b, c] = self.fine.rest(one.triangle as usize);
            let [p, q, r] = one.places;
            let ([x1, y1], [x2, y2]) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
            let det = x1 * y2 - x2 * y1;
            if det == 0.0 {
                continue;
            }
            let along_x = ((b - a) * y2 - (c - a) * y1) / det;
            let along_y = ((c - a) * x1 - (b - a) * x2) / det;
            let (round, out) = match self.kind {
                Kind::Ring | Kind::Patch => (along_x, along_y),
                Kind::First | Kind::Last => {
                    let middle = [0, 1].map(|d| (p[d] + q[d] + r[d]) / 3.0);
                    let radius = libm::hypot(middle[0], middle[1]).max(1e-12);
                    let [cos, sin] = middle.map(|x| x / radius);
                    let round = (along_y * cos - along_x * sin) * (TAU * radius);
                    (round, along_x * cos + along_y * sin)
                }
            };
            let own = round.norm_squared() / (round_m * round_m)
                + out.norm_squared() / (chart.length_m * chart.length_m);
            strain.of[one.triangle as usize] = own;
            whole += area;
            strain.mean += area * own;
        }
        strain.mean /= whole.max(1e-300);
        strain
    }

    /// The triangle where a membrane that is blown up is highest.
    fn middle(&self, harmonic: &Harmonic) -> u32 {
        let mut source = vec![0.0; harmonic.count];
        for &t in &self.triangles {
            let part = self.fine.area_of(t as usize) / 3.0;
            for corner in self.fine.triangles[t as usize] {
                if let Some(x) = source.get_mut(harmonic.unknown[corner as usize] as usize) {
                    *x += part;
                }
            }
        }
        let mut heights = vec![0.0; self.fine.corners.len()];
        harmonic.solve(self.net, &mut heights, &source, &[]);
        let mut best = (0.0, self.triangles[0]);
        for &t in &self.triangles {
            let corners = self.fine.triangles[t as usize];
            let height: f64 = corners.iter().map(|&c| heights[c as usize]).sum();
            if height > best.0 {
                best = (height, t);
            }
        }
        best.1
    }

    fn laid(
        &self,
        harmonic: &Harmonic,
        turns: &[f64],
        levels: &[f64],
        steps: &[f64],
        pole: Option<u32>,
    ) -> Chart {
        let disc = matches!(self.kind, Kind::First | Kind::Last);
        let strip = |&t: &u32| {
            let corners = self.fine.triangles[t as usize].map(|c| levels[c as usize]);
            let [a, b, c] = self.fine.rest(t as usize);
            let (p, q) = (b - a, c - a);
            let normal = p.cross(&q);
            let twice = normal.norm();
            // The gradient of a linear function on a triangle.
            let (x, y) = (corners[1] - corners[0], corners[2] - corners[0]);
            let slope: Vector3 = p * y - q * x;
            Strip {
                level: corners.iter().sum::<f64>() / 3.0,
                area: 0.5 * twice,
                slope: if twice > 0.0 {
                    slope.norm() / twice
                } else {
                    0.0
                },
            }
        };
        let lengths = Levels::new(self.triangles.iter().map(strip).collect(), disc);
        let from_rim = |corner: u32| match pole == Some(corner) {
            true => 1.0,
            false => lengths.share(levels[corner as usize]),
        };
        let share = |corner: u32| {
            let from_rim = from_rim(corner);
            match self.kind {
                Kind::First => 1.0 - from_rim,
                Kind::Ring | Kind::Last | Kind::Patch => from_rim,
            }
        };
        let mut corners = Vec::new();
        for (corner, &row) in harmonic.unknown.iter().enumerate() {
            if row <= FIXED {
                corners.push((corner as u32, [turns[corner], share(corner as u32)]));
            }
        }
        let place = |turn: f64, corner: u32| {
            if !disc {
                return [turn, share(corner)];
            }
            polar(turn, 1.0 - from_rim(corner))
        };
        let lay = |&t: &u32| {
            let ends = self.fine.triangles[t as usize];
            let first = turns[ends[0] as usize];
            // From its first corner, so that none is a turn away.
            let lifted = |k: usize| {
                let e = if k == 1 { 0 } else { 2 };
                let step = steps.get(self.net.of[t as usize][e] as usize);
                let step = step.copied().unwrap_or(0.0);
                let up = ends[0] < ends[k];
                turns[ends[k] as usize] + if up { step } else { -step }
            };
            Laid {
                triangle: t,
                places: [
                    place(first, ends[0]),
                    place(lifted(1), ends[1]),
                    place(lifted(2), ends[2]),
                ],
            }
        };
        let laid: Vec<Laid> = self.triangles.iter().map(lay).collect();
        Chart::of(self.kind, lengths.length_m, corners, laid)
    }
}

/// Which triangles may be at a place.
struct Bins {
    count: usize,
    disc: bool,
    of: Vec<Vec<u32>>,
}

impl Bins {
    fn new(laid: &[Laid], disc: bool) -> Self {
        let count = (libm::sqrt(laid.len() as f64) as usize).clamp(1, 256);
        let mut bins = Self {
            count,
            disc,
            of: vec![Vec::new(); count * count],
        };
        for (k, one) in laid.iter().enumerate() {
            let range = |d: usize| {
                let of =
                    |f: fn(f64, f64) -> f64, start| one.places.iter().map(|p| p[d]).fold(start, f);
                let ends = [of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY)];
                let [low, high] = ends.map(|x| (bins.scaled(d, x)).floor() as i64);
                low..=high.min(low + count as i64)
            };
            let (columns, rows) = (range(0), range(1));
            for i in columns {
                for j in rows.clone() {
                    let slot = bins.slot(i, j);
                    if bins.of[slot].last() != Some(&(k as u32)) {
                        bins.of[slot].push(k as u32);
                    }
                }
            }
        }
        bins
    }

    fn scaled(&self, d: usize, x: f64) -> f64 {
        let share = match (self.disc, d) {
            (true, _) => 0.5 * (x + 1.0),
            (false, _) => x,
        };
        share.clamp(-1e6, 1e6) * self.count as f64
    }

    fn slot(&self, i: i64, j: i64) -> usize {
        let count = self.count as i64;
        let i = match self.disc {
            true => i.clamp(0, count - 1),
            false => i.rem_euclid(count),
        };
        (i * count + j.clamp(0, count - 1)) as usize
    }
}

impl Chart {
    /// Of triangles that are laid out.
    pub fn of(kind: Kind, length_m: f64, corners: Vec<(u32, [f64; 2])>, laid: Vec<Laid>) -> Self {
        let disc = matches!(kind, Kind::First | Kind::Last);
        Self {
            kind,
            length_m,
            corners,
            bins: Bins::new(&laid, disc),
            laid,
        }
    }

    /// The place of the piece at a longitude and a share of the length.
    pub fn corner(&self, fine: &Fine, sheets: &mut Sheets<'_>, [turn, share]: [f64; 2]) -> Corner {
        let (triangle, weights) = self.find(turn, share);
        let corners = fine.triangles[triangle as usize].map(|c| fine.corners[c as usize]);
        let lies = match fine.caps[triangle as usize] {
            Some(_) => Lies::Cap,
            None => Lies::Skin,
        };
        let [a, b, c] = [0, 1, 2].map(|k| (corners[k], weights[k]));
        sheets.between(&[a, b, c], lies)
    }

    /// The triangle at a longitude and a share of the length, and the weights of its corners.
    fn find(&self, turn: f64, share: f64) -> (u32, [f64; 3]) {
        let place = match self.kind {
            Kind::Ring => [turn - turn.floor(), share],
            Kind::Patch => [turn, share],
            Kind::First => polar(turn, share),
            Kind::Last => polar(turn, 1.0 - share),
        };
        let [i, j] = [0, 1].map(|d| self.bins.scaled(d, place[d]).floor() as i64);
        let near = &self.bins.of[self.bins.slot(i, j)];
        let mut best = self.best(near.iter().copied(), place);
        if best.0 < -0.5 {
            best = self.best(0..self.laid.len() as u32, place);
        }
        let (_, k, weights) = best;
        let weights = weights.map(|w| w.max(0.0));
        let sum: f64 = weights.iter().sum();
        (self.laid[k as usize].triangle, weights.map(|w| w / sum))
    }

    /// The one whose least weight is greatest.
    fn best(&self, among: impl Iterator<Item = u32>, place: [f64; 2]) -> (f64, u32, [f64; 3]) {
        let mut best = (f64::NEG_INFINITY, 0, [1.0 / 3.0; 3]);
        for k in among {
            let [a, b, c] = self.laid[k as usize].places;
            let shift = match self.kind {
                Kind::Ring => ((a[0] + b[0] + c[0]) / 3.0 - place[0]).round(),
                _ => 0.0,
            };
            let p = [place[0] + shift, place[1]];
            let cross = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            let whole = cross(a, b, c);
            if whole == 0.0 {
                continue;
            }
            let weights = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|x| x / whole);
            let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
            if least > best.0 {
                best = (least, k, weights);
            }
            if least >= 0.0 {
                break;
            }
        }
        best
    }
}

/// The turn where a ray from a centre through a place meets the unit circle, and the level of the place: 0 on the circle, a
/// logarithm, so that it rises without end towards the centre.
fn seen_from(centre: [f64; 2], place: [f64; 2]) -> (f64, f64) {
    let way = [0, 1].map(|d| place[d] - centre[d]);
    let length = libm::hypot(way[0], way[1]).max(1e-12);
    let way = way.map(|x| x / length);
    let along = centre[0] * way[0] + centre[1] * way[1];
    let square = 1.0 - centre[0] * centre[0] - centre[1] * centre[1];
    let reach = libm::sqrt((along * along + square).max(0.0)) - along;
    let hit = [0, 1].map(|d| centre[d] + reach * way[d]);
    let level = libm::log(reach.max(1e-12) / length) / TAU;
    (libm::atan2(hit[1], hit[0]) / TAU, level.max(0.0))
}

fn polar(turn: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(TAU * turn);
    [radius * cos, radius * sin]
}
