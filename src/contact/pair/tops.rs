//! Places of greatest depth of one surface below another.
//!
//! Where the foot is unique the depth is smooth and Newton climbs it. The deepest place of a deep region may have two or
//! three feet equally close (it lies on the medial axis): there the least of several smooth depths is greatest, which
//! Newton finds from d₁ = d₂ and λ ∇d₁ + (1 − λ) ∇d₂ = 0, or from d₁ = d₂ = d₃.

use super::depth::{Below, Sounding, jet};
use crate::math::Point3;
use crate::surface::closest::Jet;
use crate::surface::{ClosestSolver, Surface};

/// Times a climb is begun anew when the certificate shows a closer foot.
const ROUNDS: usize = 6;
/// Steps of Newton's method along a ridge.
const RIDGE_STEPS: usize = 25;
/// Depths closer than this, relative to the size, are one.
const SAME_DEPTH: f64 = 1e-10;

/// A place of greatest depth, with its certified foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    pub u: f64,
    pub v: f64,
    pub point: Point3,
    pub sounding: Sounding,
    /// A local maximum; else a saddle, or a place where the search gave up.
    pub summit: bool,
}

/// The surface that is climbed over.
pub(super) struct Upper<'a> {
    pub surface: &'a Surface,
    pub solver: &'a mut ClosestSolver,
    /// Of both surfaces together, m.
    pub size_m: f64,
}

impl Upper<'_> {
    /// The greatest depth that can be climbed to from (u, v), whose foot is near `from`; every depth on the way certified
    /// where it counts.
    pub fn climb(&mut self, below: &mut Below<'_>, u: f64, v: f64, from: (f64, f64)) -> Option<Top> {
        let tolerance = SAME_DEPTH * self.size_m;
        let (mut at, mut foot) = ((u, v), from);
        let mut best: Option<Top> = None;
        for _ in 0..ROUNDS {
            let (bottom, guess) = below.climb(self.surface, self.solver, at.0, at.1, foot);
            let point = bottom.frame.point;
            if !(bottom.u.is_finite() && bottom.v.is_finite() && point.coords.amax().is_finite()) {
                return best;
            }
            let sure = below.certain(&point);
            let arrived = bottom.slope < 1e-7 && bottom.minimum;
            let agreed = (sure.depth_m - guess.depth_m).abs() <= tolerance;
            let top = Top { u: bottom.u, v: bottom.v, point, sounding: sure, summit: arrived && agreed };
            let better = best.is_none_or(|b| sure.depth_m > b.sounding.depth_m || top.summit);
            if better {
                best = Some(top);
            }
            if agreed && bottom.slope < 1e-7 {
                return best;
            }
            // A closer foot, or a kink that stopped the climb.
            if sure.depth_m > 0.0 {
                if let Some(ridge) = self.ridge(below, &top, &guess) {
                    if best.is_none_or(|b| ridge.sounding.depth_m > b.sounding.depth_m - tolerance) {
                        best = Some(ridge);
                        if ridge.summit {
                            return best;
                        }
                    }
                }
            }
            if !better {
                return best;
            }
            at = (top.u, top.v);
            foot = (sure.foot.at.u, sure.foot.at.v);
        }
        best
    }

    /// From a place with (nearly) two feet to the nearest place where the lesser of their depths is greatest.
    fn ridge(&mut self, below: &mut Below<'_>, top: &Top, other: &Sounding) -> Option<Top> {
        let tolerance = SAME_DEPTH * self.size_m;
        let uv = |s: &Sounding| (s.foot.at.u, s.foot.at.v);
        let mut feet = [uv(&top.sounding), uv(other), (0.0, 0.0)];
        let mut count = 2;
        if (top.sounding.foot.at.point - other.foot.at.point).norm() <= 1e-6 * self.size_m {
            feet[1] = self.other_foot(below, top)?;
        }
        let mut at = [top.u, top.v];
        let (start, reach) = (top.point, 0.5 * self.size_m);
        for _ in 0..4 {
            let (mut settled, mut shares) = (false, [0.5, 0.5, 0.0]);
            for _ in 0..RIDGE_STEPS {
                let frame = self.solver.frame_at(self.surface, at[0], at[1]);
                if !((frame.point - start).norm() <= reach) {
                    return None;
                }
                let mut jets = [None; 3];
                for k in 0..count {
                    let sounding = below.follow(&frame.point, feet[k].0, feet[k].1);
                    feet[k] = uv(&sounding);
                    jets[k] = Some(jet(&frame, &sounding));
                }
                let (step, held) = match jets {
                    [Some(a), Some(b), None] => two(&a, &b)?,
                    [Some(a), Some(b), Some(c)] => three(&a, &b, &c)?,
                    _ => return None,
                };
                shares = held;
                let metres = (step[0].abs() * frame.du.norm()).max(step[1].abs() * frame.dv.norm());
                let scale = (0.1 * self.size_m / metres).min(1.0);
                let (ku, kv) = (self.surface.knots_u(), self.surface.knots_v());
                at = [ku.confine(at[0] + scale * step[0]), kv.confine(at[1] + scale * step[1])];
                if !(at[0].is_finite() && at[1].is_finite()) {
                    return None;
                }
                if metres <= 1e-12 * self.size_m {
                    settled = true;
                    break;
                }
            }
            let frame = self.solver.frame_at(self.surface, at[0], at[1]);
            let sounding = below.follow(&frame.point, feet[0].0, feet[0].1);
            let sure = below.certain(&frame.point);
            let summit = settled && (sure.depth_m - sounding.depth_m).abs() <= tolerance;
            let found = Top { u: at[0], v: at[1], point: frame.point, sounding: sure, summit };
            let least = (0..count).fold((0, f64::INFINITY), |m, k| if shares[k] < m.1 { (k, shares[k]) } else { m });
            if summit && least.1 >= -1e-6 {
                return Some(found);
            }
            if summit && count == 3 {
                // A foot that holds nothing: go on along the ridge of the other two.
                feet[least.0] = feet[2];
                count = 2;
            } else if !summit && settled {
                // A third foot is closer than the two.
                let new = uv(&sure);
                if count == 3 {
                    return Some(found);
                }
                feet[2] = new;
                count = 3;
            } else {
                return Some(Top { summit: false, ..found });
            }
        }
        None
    }

    /// Another foot nearly as close: from around the place, where the certified foot is another one.
    fn other_foot(&mut self, below: &mut Below<'_>, top: &Top) -> Option<(f64, f64)> {
        let frame = self.solver.frame_at(self.surface, top.u, top.v);
        let depth = top.sounding.depth_m;
        let mut best: Option<(f64, (f64, f64))> = None;
        for step in [0.003, 0.02] {
            for way in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                let d = frame.du * (way[0] / frame.du.norm().max(f64::MIN_POSITIVE))
                    + frame.dv * (way[1] / frame.dv.norm().max(f64::MIN_POSITIVE));
                let there = below.certain(&(top.point + d * (step * self.size_m)));
                let here = below.follow(&top.point, there.foot.at.u, there.foot.at.v);
                let apart = (here.foot.at.point - top.sounding.foot.at.point).norm();
                let excess = here.foot.at.distance - depth;
                if apart > 1e-3 * self.size_m
                    && excess < 0.05 * self.size_m
                    && best.is_none_or(|(least, _)| excess < least)
                {
                    best = Some((excess, (here.foot.at.u, here.foot.at.v)));
                }
            }
            if best.is_some() {
                break;
            }
        }
        best.map(|(_, foot)| foot)
    }
}

/// Step and shares where two distances stay equal and the larger is least.
fn two(a: &Jet, b: &Jet) -> Option<([f64; 2], [f64; 3])> {
    let d = [a.g[0] - b.g[0], a.g[1] - b.g[1]];
    // In metres, so that neither parameter counts for more.
    let [mu, mv] = a.metric;
    let square = d[0] * d[0] / mu + d[1] * d[1] / mv;
    if !(square > 1e-16) {
        return None;
    }
    // λ a + (1 − λ) b as short as can be.
    let share = -(d[0] * b.g[0] / mu + d[1] * b.g[1] / mv) / square;
    let mix = |x: f64, y: f64| share * x + (1.0 - share) * y;
    let h: [f64; 3] = std::array::from_fn(|k| mix(a.h[k], b.h[k]));
    let g = [mix(a.g[0], b.g[0]), mix(a.g[1], b.g[1])];
    // Across the ridge: d·δ = −(a − b). Along it, t ⟂ d: δ = across + x t with tᵀ(g + H δ) = 0.
    let across = -(a.f - b.f) / square;
    let c = [across * d[0] / mu, across * d[1] / mv];
    let t = [-d[1], d[0]];
    let (ht, hc) = (turn(&h, t), turn(&h, c));
    let bend = t[0] * ht[0] + t[1] * ht[1];
    let slope = t[0] * (g[0] + hc[0]) + t[1] * (g[1] + hc[1]);
    let metres = t[0] * t[0] * mu + t[1] * t[1] * mv;
    // Uphill along the ridge also where it bends the wrong way.
    let x = -slope / bend.abs().max(1e-6 * metres);
    Some(([c[0] + x * t[0], c[1] + x * t[1]], [share, 1.0 - share, 0.0]))
}

fn turn(h: &[f64; 3], x: [f64; 2]) -> [f64; 2] {
    [h[0] * x[0] + h[1] * x[1], h[1] * x[0] + h[2] * x[1]]
}

/// Step and shares where three distances are equal.
fn three(a: &Jet, b: &Jet, c: &Jet) -> Option<([f64; 2], [f64; 3])> {
    let (p, q) = ([a.g[0] - c.g[0], a.g[1] - c.g[1]], [b.g[0] - c.g[0], b.g[1] - c.g[1]]);
    let det = p[0] * q[1] - p[1] * q[0];
    let scale = (p[0].abs() + p[1].abs()) * (q[0].abs() + q[1].abs());
    if !(det.abs() > 1e-9 * scale) {
        return None;
    }
    let (x, y) = (-(a.f - c.f), -(b.f - c.f));
    let step = [(x * q[1] - y * p[1]) / det, (y * p[0] - x * q[0]) / det];
    // α a + β b + (1 − α − β) c = 0.
    let alpha = (-c.g[0] * q[1] + c.g[1] * q[0]) / det;
    let beta = (c.g[0] * p[1] - c.g[1] * p[0]) / det;
    Some((step, [alpha, beta, 1.0 - alpha - beta]))
}
