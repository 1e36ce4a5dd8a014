//! Newton's method to places common to two surfaces.

use super::super::cells::Cells;
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Frame, Surface};

/// How far apart the two surfaces' points of one place may be, relative to the size.
const GAP: f64 = 1e-12;
const STEPS: usize = 14;
/// Normals whose cross product is shorter give no direction.
const TANGENT: f64 = 1e-9;
/// Newton's steps of one call that lead nowhere new: about ten milliseconds.
const MOST_WORK: usize = 16_000;
/// A certified foot costs as much as so many steps.
const FOOT_WORK: usize = 20;

/// A place on both surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvePlace {
    /// (u, v) on the first surface, (s, t) on the second.
    pub at: [f64; 4],
    pub point: Point3,
    /// Unit vector along n_A × n_B.
    pub way: Vector3,
    /// How far a step may go before parts of either surface are passed over, m.
    pub reach_m: f64,
}

/// Why no place was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lost {
    /// Beyond an open edge: which surface, which of its parameters, at which value.
    Left { side: usize, d: usize, value: f64 },
    /// Tangent there, or not found.
    Nowhere,
}

/// Two surfaces with what is needed to walk on both.
pub(super) struct JoinedCurve<'a> {
    pub surfaces: [&'a Surface; 2],
    pub solvers: [&'a mut ClosestSolver; 2],
    pub cells: [&'a Cells; 2],
    /// Of both together, m.
    pub size_m: f64,
    work: usize,
}

impl<'a> JoinedCurve<'a> {
    pub fn new(
        surfaces: [&'a Surface; 2],
        solvers: [&'a mut ClosestSolver; 2],
        cells: [&'a Cells; 2],
        size_m: f64,
    ) -> Self {
        Self {
            surfaces,
            solvers,
            cells,
            size_m,
            work: 0,
        }
    }

    /// Nothing more is to be tried.
    pub fn spent(&self) -> bool {
        self.work >= MOST_WORK
    }

    /// What was done since `before` has brought a curve forward.
    pub fn earned(&mut self, before: usize) {
        self.work = self.work.min(before);
    }

    pub fn work(&self) -> usize {
        self.work
    }

    pub fn frame(&mut self, side: usize, at: [f64; 4]) -> Frame {
        self.solvers[side].frame_at(self.surfaces[side], at[2 * side], at[2 * side + 1])
    }

    fn normal(&self, side: usize, at: [f64; 4], frame: &Frame) -> Vector3 {
        let across = frame.du.cross(&frame.dv);
        let area = across.norm();
        if area > 1e-9 * frame.du.norm() * frame.dv.norm() {
            return across
                * (if self.surfaces[side].flip_normal() {
                    -1.0
                } else {
                    1.0
                } / area);
        }
        self.surfaces[side].normal_of(frame, at[2 * side], at[2 * side + 1])
    }

    /// A common place with its direction; none where the surfaces are tangent.
    pub fn place(&mut self, at: [f64; 4]) -> Option<CurvePlace> {
        let (a, b) = (self.frame(0, at), self.frame(1, at));
        let across = self.normal(0, at, &a).cross(&self.normal(1, at, &b));
        let way = across.try_normalize(TANGENT)?;
        let reach = |side: usize, f: &Frame| {
            let (_, wide) =
                self.cells[side].middle(self.cells[side].cell_at(at[2 * side], at[2 * side + 1]));
            0.7 * (f.du.norm() * wide[0]).max(f.dv.norm() * wide[1])
        };
        Some(CurvePlace {
            at,
            point: a.point,
            way,
            reach_m: reach(0, &a).min(reach(1, &b)),
        })
    }

    /// The common place in the plane through `target` across `way`, from a place nearby.
    ///
    /// The next guess is where both tangent planes meet that plane: Newton's method in four
    /// unknowns.
    pub fn correct(
        &mut self,
        from: [f64; 4],
        target: &Point3,
        way: &Vector3,
    ) -> Result<CurvePlace, Lost> {
        let mut at = from;
        let mut best: Option<(f64, [f64; 4])> = None;
        let mut first_m = None;
        let mut lost = Lost::Nowhere;
        for _ in 0..STEPS {
            self.work += 1;
            let (a, b) = (self.frame(0, at), self.frame(1, at));
            let apart = b.point - a.point;
            let (gap, off) = (apart.norm(), way.dot(&(target - a.point)));
            // False for NaN.
            let there = gap <= GAP * self.size_m && off.abs() <= 1e-9 * self.size_m;
            if there {
                let better = best.is_none_or(|(least, _)| gap < 0.5 * least);
                if best.is_none_or(|(least, _)| gap < least) {
                    best = Some((gap, at));
                }
                if !better || gap <= 1e-15 * self.size_m {
                    break;
                }
            }
            let (na, nb) = (self.normal(0, at, &a), self.normal(1, at, &b));
            let across = na.cross(&nb);
            let det = across.dot(way);
            let crossing = det.abs() > TANGENT;
            if !crossing {
                break;
            }
            let step = (way.cross(&na) * nb.dot(&apart) + across * off) * (1.0 / det);
            let metres = step.norm();
            let most = *first_m.get_or_insert(4.0 * metres + 1e-9 * self.size_m);
            let bounded = metres <= most;
            if !bounded {
                break;
            }
            lost = Lost::Nowhere;
            for (side, frame, step) in [(0, &a, step), (1, &b, step - apart)] {
                if let Some(left) = self.walk(side, &mut at, frame, &step) {
                    lost = left;
                }
            }
        }
        let (_, at) = best.ok_or(lost)?;
        self.place(at).ok_or(Lost::Nowhere)
    }

    /// The common place with one parameter of one surface held, from a place nearby.
    pub fn pierce(
        &mut self,
        side: usize,
        d: usize,
        value: f64,
        from: [f64; 4],
    ) -> Option<[f64; 4]> {
        let (other, held, free) = (1 - side, 2 * side + d, 2 * side + 1 - d);
        let mut at = from;
        at[held] = value;
        let mut best: Option<(f64, [f64; 4])> = None;
        for _ in 0..STEPS {
            self.work += 1;
            let (x, y) = (self.frame(side, at), self.frame(other, at));
            let apart = y.point - x.point;
            let gap = apart.norm();
            if gap <= GAP * self.size_m {
                let better = best.is_none_or(|(least, _)| gap < 0.5 * least);
                if best.is_none_or(|(least, _)| gap < least) {
                    best = Some((gap, at));
                }
                if !better || gap <= 1e-15 * self.size_m {
                    break;
                }
            }
            let along = if d == 0 { x.dv } else { x.du };
            let normal = y.du.cross(&y.dv);
            let slope = normal.dot(&along);
            let crossing = slope.abs() > TANGENT * normal.norm() * along.norm();
            if !crossing {
                break;
            }
            let by = normal.dot(&apart) / slope;
            let line = &self.cells[side].lines[1 - d];
            let bounded = by.abs() <= 0.25 * (line[line.len() - 1] - line[0]);
            if !bounded {
                break;
            }
            let mut step = [0.0; 2];
            step[1 - d] = by;
            let moved = self.cells[side].moved([at[2 * side], at[2 * side + 1]], step);
            at[free] = moved[1 - d];
            self.walk(other, &mut at, &y, &(along * by - apart));
        }
        best.map(|(_, at)| at)
    }

    /// Signed distance to the second surface of a place on the first, `by_m` beside the curve.
    pub fn beside(&mut self, place: &CurvePlace, by_m: f64) -> Option<f64> {
        let [u, v, s, t] = place.at;
        let frame = self.frame(0, place.at);
        let across = self.normal(0, place.at, &frame).cross(&place.way) * by_m;
        let step = tangential(&frame, &across)?;
        let [u, v] = self.cells[0].moved([u, v], step);
        let point = self.solvers[0].frame_at(self.surfaces[0], u, v).point;
        let foot = self.solvers[1].near_from(self.surfaces[1], &point, s, t).at;
        (!self.cells[1].on_open_edge(foot.u, foot.v)).then_some(foot.signed_distance)
    }

    /// Moves one surface's parameters by a step in space. Tells when an open edge is in the way.
    fn walk(
        &mut self,
        side: usize,
        at: &mut [f64; 4],
        frame: &Frame,
        step: &Vector3,
    ) -> Option<Lost> {
        let cells = self.cells[side];
        let x = [at[2 * side], at[2 * side + 1]];
        let wide = [0, 1].map(|d| cells.lines[d][cells.counts[d]] - cells.lines[d][0]);
        let by = tangential(frame, step).filter(|by| (0..2).all(|d| by[d].abs() <= 0.15 * wide[d]));
        let Some(by) = by else {
            // Beside a pole a small step turns far around it.
            let target = frame.point + step;
            let foot = self.solvers[side]
                .near_from(self.surfaces[side], &target, x[0], x[1])
                .at;
            let near = foot.distance <= 0.1 * step.norm();
            self.work += if near { FOOT_WORK / 8 } else { FOOT_WORK };
            let foot = if near {
                foot
            } else {
                self.solvers[side].closest(self.surfaces[side], &target)
            };
            (at[2 * side], at[2 * side + 1]) = (foot.u, foot.v);
            return None;
        };
        let next = cells.moved(x, by);
        (at[2 * side], at[2 * side + 1]) = (next[0], next[1]);
        (0..2).find_map(|d| {
            let (start, end) = (cells.lines[d][0], cells.lines[d][cells.counts[d]]);
            let beyond = !cells.wraps[d]
                && ((x[d] + by[d] < start && !cells.poles[d][0])
                    || (x[d] + by[d] > end && !cells.poles[d][1]));
            beyond.then_some(Lost::Left {
                side,
                d,
                value: next[d],
            })
        })
    }
}

/// Parameters of a step in the tangent plane; none at poles.
fn tangential(frame: &Frame, step: &Vector3) -> Option<[f64; 2]> {
    let (e, f, g) = (
        frame.du.norm_squared(),
        frame.du.dot(&frame.dv),
        frame.dv.norm_squared(),
    );
    let det = e * g - f * f;
    let regular = det > 1e-14 * e * g;
    let (p, q) = (step.dot(&frame.du), step.dot(&frame.dv));
    regular.then(|| [(g * p - f * q) / det, (e * q - f * p) / det])
}
