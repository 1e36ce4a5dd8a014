//! Loops as chains of polynomial curves, in space and in (u, v).
//!
//! A piece of the curve is a graph over its chord in the plane: at six places of the chord the surface's point is found by
//! Newton's method, and the quintics through these are the piece, in space and in (u, v) alike. Halved until they agree with
//! the surface between the places too. Knots are ends of pieces: across them the curve is less smooth.

use super::field::Field;
use super::graph::Graph;
use super::grid::{Grid, WHOLE};
use super::leaves::Leaves;
use super::regions::{Loop, Regions, Step};
use super::{CutError, CutPlane};
use crate::math::{Point3, Vector3};
use crate::surface::Surface;
use nalgebra::SMatrix;
use std::f64::consts::PI;

/// Control points of a piece.
pub(super) const ORDER: usize = 6;
/// Of the size: how far a piece may be from the surface's point at the same place of the chord.
const FIT: f64 = 1e-11;
/// Of the size: how well a place on the curve is found.
const FOUND: f64 = 1e-13;
/// Of the size: pieces shorter than this go with a neighbour, knot or not.
const SHORT: f64 = 1e-6;
/// Halvings of a piece at most.
const MOST_HALVINGS: usize = 40;

/// A piece of a rim: Bézier curves over the same parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct RimPiece {
    /// (u, v), going on past the ends of periods.
    pub uv: [[f64; 2]; ORDER],
    /// m.
    pub points: [Point3; ORDER],
}

/// A part of a rim that ends where the curve touches itself, at a pole, or where the surface ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RimEdge {
    /// In the plane.
    Cut(Vec<RimPiece>),
    /// Along the surface's own border: the direction, and both ends in (u, v).
    Border(usize, [[f64; 2]; 2]),
}

/// What is fitted with.
pub(super) struct Fitter<'a> {
    pub surface: &'a Surface,
    pub plane: &'a CutPlane,
    pub field: &'a Field,
    pub grid: &'a Grid,
    pub leaves: &'a Leaves,
    pub regions: &'a Regions,
    size_m: f64,
    interpolation: SMatrix<f64, ORDER, ORDER>,
}

/// A place of a loop.
#[derive(Clone, Copy, Debug)]
struct Station {
    uv: [f64; 2],
    /// Pieces end here.
    knot: bool,
}

/// Between places at which edges end.
#[derive(Debug)]
enum Run {
    Cut(Vec<Station>),
    Border(usize, [[f64; 2]; 2]),
}

impl<'a> Fitter<'a> {
    pub fn new(
        surface: &'a Surface,
        plane: &'a CutPlane,
        field: &'a Field,
        grid: &'a Grid,
        leaves: &'a Leaves,
        regions: &'a Regions,
    ) -> Option<Self> {
        let bernstein = SMatrix::<f64, ORDER, ORDER>::from_fn(|i, j| {
            let mut unit = [0.0; ORDER];
            unit[j] = 1.0;
            super::field::value(&unit, node(i))
        });
        Some(Self {
            surface,
            plane,
            field,
            grid,
            leaves,
            regions,
            size_m: surface.size(),
            interpolation: bernstein.try_inverse()?,
        })
    }

    /// The edges of a loop, the region on the left.
    pub fn edges(&self, one: &Loop) -> Result<Vec<RimEdge>, CutError> {
        let mut out = Vec::new();
        for run in self.runs(one) {
            match run {
                Run::Border(direction, ends) => out.push(RimEdge::Border(direction, ends)),
                Run::Cut(stations) => {
                    let mut pieces = Vec::new();
                    for part in self.parts(&stations) {
                        self.fit(&part, 0, &mut pieces)?;
                    }
                    out.push(RimEdge::Cut(pieces));
                }
            }
        }
        Ok(out)
    }

    /// Where the sectors of a cell touch.
    fn centre(&self, cell: usize) -> [f64; 2] {
        let cell = &self.regions.cells[cell];
        let sectors = &self.regions.sectors[cell.first..cell.first + cell.count];
        let places: Vec<[f64; 2]> = sectors
            .iter()
            .filter_map(|sector| Some(self.regions.crossings[sector.arc?[0]].uv))
            .collect();
        let near = places[0];
        let lifted = places.iter().map(|&uv| self.grid.lifted(uv, near));
        let sum = lifted.fold([0.0; 2], |s, uv| [s[0] + uv[0], s[1] + uv[1]]);
        sum.map(|x| x / places.len() as f64)
    }

    /// The curve within a sector, as places; where several touch, the middle one ends an edge.
    fn arc(&self, sector: usize) -> (Vec<Station>, Option<usize>) {
        let regions = self.regions;
        let sector = &regions.sectors[sector];
        let Some(arc) = sector.arc else {
            return (Vec::new(), None);
        };
        let ends = arc.map(|c| &regions.crossings[c]);
        let station = |k: usize| Station {
            uv: self.grid.lifted(ends[k].uv, ends[0].uv),
            knot: ends[k].side.line % WHOLE == 0,
        };
        let cell = &regions.cells[sector.cell];
        if cell.count > 2 {
            let uv = self.grid.lifted(self.centre(sector.cell), ends[0].uv);
            return (
                vec![station(0), Station { uv, knot: true }, station(1)],
                Some(1),
            );
        }
        let leaf = &self.leaves.all[cell.leaves[0]];
        let mut out = vec![station(0)];
        if let Some(graph) = Graph::new(self.field, self.grid, leaf, ends.map(|end| end.uv)) {
            let at = |k: usize| leaf.local(self.grid, ends[k].uv)[graph.over];
            for k in 1..4 {
                let x = at(0) + (at(1) - at(0)) * f64::from(k) / 4.0;
                let local = graph.place(x, graph.height(x).0);
                let uv = self
                    .grid
                    .lifted(leaf.parameters(self.grid, local), ends[0].uv);
                out.push(Station { uv, knot: false });
            }
        }
        out.push(station(1));
        (out, None)
    }

    /// The steps of a loop, without jumps, divided where edges end.
    fn runs(&self, one: &Loop) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let mut open: Vec<Station> = Vec::new();
        let mut last: Option<[f64; 2]> = None;
        for step in &one.steps {
            match step {
                Step::Border {
                    direction,
                    ends,
                    pole,
                } => {
                    if open.len() > 1 {
                        runs.push(Run::Cut(std::mem::take(&mut open)));
                    }
                    open.clear();
                    let from = last.map_or(ends[0], |near| self.grid.lifted(ends[0], near));
                    let to = [0, 1].map(|d| ends[1][d] + from[d] - ends[0][d]);
                    if !pole {
                        runs.push(Run::Border(*direction, [from, to]));
                    }
                    last = Some(to);
                }
                Step::Arc(sector) => {
                    let (stations, middle) = self.arc(*sector);
                    let from = stations[0].uv;
                    let lifted = last.map_or(from, |near| self.grid.lifted(from, near));
                    for (k, station) in stations.into_iter().enumerate() {
                        let uv = [0, 1].map(|d| station.uv[d] + lifted[d] - from[d]);
                        if k > 0 || open.is_empty() {
                            open.push(Station { uv, ..station });
                        }
                        if middle == Some(k) {
                            runs.push(Run::Cut(std::mem::take(&mut open)));
                            open.push(Station { uv, ..station });
                        }
                        last = Some(uv);
                    }
                }
            }
        }
        let ends_with_arc = matches!(one.steps.last(), Some(Step::Arc(_)));
        if open.len() > 1 {
            // What the loop began with goes on from here.
            let begins_with_arc = matches!(one.steps.first(), Some(Step::Arc(_)));
            match runs.first_mut() {
                Some(Run::Cut(first)) if ends_with_arc && begins_with_arc => {
                    let shift = [0, 1].map(|d| open[open.len() - 1].uv[d] - first[0].uv[d]);
                    for station in &first[1..] {
                        let uv = [0, 1].map(|d| station.uv[d] + shift[d]);
                        open.push(Station { uv, ..*station });
                    }
                    *first = open;
                }
                _ => runs.push(Run::Cut(open)),
            }
        }
        runs
    }

    fn point(&self, uv: [f64; 2]) -> Point3 {
        let [u, v] = self.grid.reduced(uv);
        self.surface.point(u, v)
    }

    /// A run divided at knots. One that is closed begins at a knot, or is divided twice more.
    fn parts(&self, stations: &[Station]) -> Vec<Vec<[f64; 2]>> {
        let count = stations.len();
        let mut cuts: Vec<usize> = vec![0];
        for k in 1..count - 1 {
            let from = self.point(stations[cuts[cuts.len() - 1]].uv);
            let here = self.point(stations[k].uv);
            if stations[k].knot && (here - from).norm() > SHORT * self.size_m {
                cuts.push(k);
            }
        }
        let end = self.point(stations[count - 1].uv);
        let near_end = |k: usize| (self.point(stations[k].uv) - end).norm() <= SHORT * self.size_m;
        while cuts.len() > 1 && near_end(cuts[cuts.len() - 1]) {
            cuts.pop();
        }
        let closed = near_end(0);
        if closed && cuts.len() < 3 {
            let (third, wide) = (count / 3, count >= 4);
            if wide {
                cuts.extend([third, 2 * third]);
                cuts.sort_unstable();
                cuts.dedup();
            }
        }
        cuts.push(count - 1);
        cuts.windows(2)
            .map(|pair| stations[pair[0]..=pair[1]].iter().map(|s| s.uv).collect())
            .collect()
    }

    /// The place of the curve over a chord, from near it.
    fn over(&self, near: [f64; 2], chord: (&Point3, &Vector3), along_m: f64) -> Option<[f64; 2]> {
        let (start, direction) = chord;
        let mut uv = near;
        for _ in 0..20 {
            let [u, v] = self.grid.reduced(uv);
            let frame = self.surface.frame(u, v);
            let r = [
                self.plane.height(&frame.point),
                (frame.point - start).dot(direction) - along_m,
            ];
            let off = r[0].abs().max(r[1].abs());
            let n = &self.plane.normal;
            let [a, b] = [n.dot(&frame.du), n.dot(&frame.dv)];
            let [c, d] = [direction.dot(&frame.du), direction.dot(&frame.dv)];
            let det = a * d - b * c;
            let step = [(d * r[0] - b * r[1]) / det, (a * r[1] - c * r[0]) / det];
            if off <= 0.01 * FOUND * self.size_m {
                return Some(uv);
            }
            if !step.iter().all(|x| x.is_finite()) {
                return (off <= FOUND * self.size_m).then_some(uv);
            }
            let next = [uv[0] - step[0], uv[1] - step[1]];
            let within = self.grid.lifted(self.grid.reduced(next), next);
            if within == uv {
                return (off <= FOUND * self.size_m).then_some(uv);
            }
            uv = within;
        }
        let off = self.point(uv);
        let good = self.plane.height(&off).abs() <= FOUND * self.size_m
            && ((off - start).dot(direction) - along_m).abs() <= FOUND * self.size_m;
        good.then_some(uv)
    }

    /// Quintics over the chord between the first and the last of some places of the curve.
    fn fit(
        &self,
        places: &[[f64; 2]],
        depth: usize,
        out: &mut Vec<RimPiece>,
    ) -> Result<(), CutError> {
        let points: Vec<Point3> = places.iter().map(|&uv| self.point(uv)).collect();
        let last = points.len() - 1;
        let along = points[last] - points[0];
        let length = along.norm();
        let direction = along / length;
        let shares: Vec<f64> = points
            .iter()
            .map(|p| (p - points[0]).dot(&direction) / length)
            .collect();
        let rises = shares.windows(2).all(|pair| pair[1] > pair[0]);
        let flat = points
            .iter()
            .zip(&shares)
            .all(|(p, t)| (p - points[0] - along * *t).norm() <= 0.3 * length);
        let [u, v] = self.grid.reduced(places[0]);
        if !(length > 0.0 && rises && flat) {
            if last > 1 && depth < MOST_HALVINGS {
                let middle = last.div_ceil(2);
                self.fit(&places[..=middle], depth + 1, out)?;
                return self.fit(&places[middle..], depth + 1, out);
            }
            if length == 0.0 {
                return Ok(());
            }
        }
        let chord = (&points[0], &direction);
        let at = |t: f64| {
            let k = shares.partition_point(|s| *s <= t).clamp(1, last);
            let (a, b) = (shares[k - 1], shares[k]);
            let part = (t - a) / (b - a);
            let near = [0, 1].map(|d| places[k - 1][d] + (places[k][d] - places[k - 1][d]) * part);
            self.over(near, chord, t * length)
        };
        let inner: Option<Vec<[f64; 2]>> = (1..ORDER - 1).map(|k| at(node(k))).collect();
        let good = inner.map(|inner| {
            let piece = self.piece([places[0], places[last]], &inner);
            (self.fits(&piece, &at), piece)
        });
        match good {
            Some((true, piece)) => {
                out.push(piece);
                Ok(())
            }
            good if depth >= MOST_HALVINGS => {
                let (_, piece) = good.ok_or(CutError::Unclear { u, v })?;
                out.push(piece);
                Ok(())
            }
            _ => {
                let Some(middle) = at(0.5) else {
                    if last < 2 {
                        return Err(CutError::Unclear { u, v });
                    }
                    let middle = last.div_ceil(2);
                    self.fit(&places[..=middle], depth + 1, out)?;
                    return self.fit(&places[middle..], depth + 1, out);
                };
                let k = shares.partition_point(|s| *s < 0.5 - 1e-6);
                let after = shares.partition_point(|s| *s <= 0.5 + 1e-6);
                let mut low = places[..k].to_vec();
                low.push(middle);
                let mut high = vec![middle];
                high.extend(&places[after..]);
                self.fit(&low, depth + 1, out)?;
                self.fit(&high, depth + 1, out)
            }
        }
    }

    fn piece(&self, ends: [[f64; 2]; 2], inner: &[[f64; 2]]) -> RimPiece {
        let mut uv = [ends[0]; ORDER];
        uv[1..ORDER - 1].copy_from_slice(inner);
        uv[ORDER - 1] = ends[1];
        let points = uv.map(|uv| self.point(uv));
        let mixed = |value: &dyn Fn(usize) -> f64, k: usize| match k {
            0 => value(0),
            _ if k == ORDER - 1 => value(ORDER - 1),
            _ => (0..ORDER)
                .map(|j| self.interpolation[(k, j)] * value(j))
                .sum(),
        };
        RimPiece {
            uv: std::array::from_fn(|k| [0, 1].map(|d| mixed(&|j| uv[j][d], k))),
            points: std::array::from_fn(|k| {
                Point3::from(Vector3::from(
                    [0, 1, 2].map(|d| mixed(&|j| points[j][d], k)),
                ))
            }),
        }
    }

    /// Whether a piece is near the curve between its places.
    fn fits(&self, piece: &RimPiece, at: &dyn Fn(f64) -> Option<[f64; 2]>) -> bool {
        (1..ORDER).all(|k| {
            let t = 0.5 * (node(k - 1) + node(k));
            let Some(uv) = at(t) else { return false };
            let [u, v] = self.grid.reduced(uv);
            let frame = self.surface.frame(u, v);
            let own = piece.uv(t);
            let off = frame.du * (own[0] - uv[0]) + frame.dv * (own[1] - uv[1]);
            let most = FIT * self.size_m;
            (piece.point(t) - frame.point).norm() <= most && off.norm() <= most
        })
    }
}

/// Chebyshev's places, from 0 to 1.
fn node(k: usize) -> f64 {
    match k {
        0 => 0.0,
        _ if k == ORDER - 1 => 1.0,
        _ => 0.5 - 0.5 * libm::cos(PI * k as f64 / (ORDER - 1) as f64),
    }
}

impl RimPiece {
    /// (u, v) at a parameter from 0 to 1.
    pub fn uv(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|d| super::field::value(&self.uv.map(|uv| uv[d]), t))
    }

    /// The point at a parameter from 0 to 1, m.
    pub fn point(&self, t: f64) -> Point3 {
        let at = |d: usize| super::field::value(&self.points.map(|p| p[d]), t);
        Point3::new(at(0), at(1), at(2))
    }

    /// n · ½ ∫ (r − x₀) × dr, m²: exact by Gauss's rule with as many points as control points.
    pub(super) fn swept(&self, plane: &CutPlane, rule: &[(f64, f64)]) -> f64 {
        let origin = plane.origin();
        let slope = |t: f64| {
            let d = |d: usize| {
                let c: [f64; ORDER - 1] = std::array::from_fn(|k| {
                    (ORDER - 1) as f64 * (self.points[k + 1][d] - self.points[k][d])
                });
                super::field::value(&c, t)
            };
            Vector3::new(d(0), d(1), d(2))
        };
        let terms = rule.iter().map(|(x, w)| {
            let t = 0.5 * (1.0 + x);
            0.25 * w * (self.point(t) - origin).cross(&slope(t)).dot(&plane.normal)
        });
        terms.sum()
    }
}
