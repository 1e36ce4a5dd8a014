//! Whether a place found within one part is a local minimum of the whole surface, and whether two
//! of them are one.

use super::newton::{Descent, Evaluate, NewtonPlace, OnPieces, descend};
use super::objective::Objective;
use super::side::{SAME, Site, other_end, sides};
use crate::surface::bezier::{BezierPieces, Joint, PieceDirection};
use crate::surface::joints::{Joints, Spot};

/// How far around a place that the Hessian does not decide values are looked at, in spans.
const AROUND: [f64; 2] = [1e-3, 1e-5];
/// Meridians out of a pole that are looked at, per span.
const MERIDIANS: usize = 4;
/// Squares of tangents below this share of the squared size are rounding: the edge is collapsed.
const COLLAPSED: f64 = 1e-24;
/// Points looked at between two places: these twelfths of the way, far ones first.
const WAY: [f64; 11] = [6.0, 3.0, 9.0, 1.0, 11.0, 2.0, 10.0, 4.0, 8.0, 5.0, 7.0];
/// Slopes count as larger than rounding when they exceed it by this factor, which is 1e-7 of the size
/// for a squared distance and 1e-7 for a height; a neighbouring part then sees the same sign.
pub(super) const STEEP: f64 = 1e8;

/// A piecewise surface and what is minimised on it.
pub(super) struct Judge<'a, O: Objective> {
    pub eval: OnPieces<'a>,
    pub objective: &'a O,
    pub size_m: f64,
}

impl<O: Objective> Judge<'_, O> {
    /// The local minimum of the surface at or next to a place; `None` when the surface is lower
    /// around it by more than `equal`.
    pub fn minimum(&mut self, start: &Descent, equal: f64) -> Option<Descent> {
        let found = descend(&mut self.eval, self.objective, start.place);
        let equal = equal + found.jet.noise;
        let bend = self.bend(&found);
        let collapsed =
            (0..2).any(|k| found.jet.metric[k] <= COLLAPSED * self.size_m * self.size_m);
        if (bend < -1.0 && !collapsed)
            || (self.at_border(&found.place) && self.falls_across(&found, equal))
        {
            return None;
        }
        let sure = !collapsed
            && bend > 1.0
            && (0..2).all(|k| found.free[k] || steep(&found, k, self.size_m));
        let falls =
            !sure && (self.falls_around(&found, equal) || self.falls_from_pole(&found, equal));
        (!falls).then_some(found)
    }

    /// Least curvature over the free variables, in units of what can be distinguished from rounding.
    fn bend(&self, found: &Descent) -> f64 {
        let ([mu, mv], [huu, huv, hvv]) = (found.jet.metric, found.jet.h);
        let least = match found.free {
            [false, false] => return f64::INFINITY,
            [true, false] => huu / mu,
            [false, true] => hvv / mv,
            [true, true] => {
                let (a, b, c) = (huu / mu, huv / (mu * mv).sqrt(), hvv / mv);
                0.5 * (a + c) - (0.25 * (a - c) * (a - c) + b * b).sqrt()
            }
        };
        least * self.size_m / (STEEP * found.jet.slope_noise)
    }

    fn at_border(&self, at: &NewtonPlace) -> bool {
        let at_joint = |d: &PieceDirection, k: usize, x: f64| {
            let span = &d.spans[k];
            (x <= span.start && span.before != Joint::Smooth)
                || (x >= span.end && span.after != Joint::Smooth)
        };
        at_joint(&self.eval.pieces.u, at.i, at.u) || at_joint(&self.eval.pieces.v, at.j, at.v)
    }

    fn value(&mut self, place: NewtonPlace) -> f64 {
        let p = self.eval.frame(place.i, place.j, place.u, place.v).point;
        self.objective.value(p.x, p.y, p.z)
    }

    /// Lower beyond a crease, or beyond ends that coincide.
    fn falls_across(&mut self, found: &Descent, equal: f64) -> bool {
        let (at, point) = (found.place, found.frame.point);
        if let Some(joints) = self.eval.pieces.joints() {
            let meeting = joints.meeting(at.into());
            let lower = |spot: &Spot| {
                descend(&mut self.eval, self.objective, NewtonPlace::from(*spot))
                    .jet
                    .f
                    < found.jet.f - equal
            };
            return meeting.spots()[1..].iter().any(lower);
        }
        let (du, dv) = (&self.eval.pieces.u, &self.eval.pieces.v);
        let site = Site {
            surface: self.eval.surface,
            u: du,
            v: dv,
            joints: None,
        };
        let same = |place: NewtonPlace| {
            (site.frame(place).point - point).norm() <= SAME * (point.coords.amax() + self.size_m)
        };
        let us = sides(du, at.i, at.u, |i, u| same(NewtonPlace { i, u, ..at }));
        let vs = sides(dv, at.j, at.v, |j, v| same(NewtonPlace { j, v, ..at }));
        for (a, u) in us.iter().enumerate() {
            for (b, v) in vs.iter().enumerate() {
                let (Some((i, u, _)), Some((j, v, _)), true) = (*u, *v, a + b > 0) else {
                    continue;
                };
                let other = descend(&mut self.eval, self.objective, NewtonPlace { i, j, u, v });
                if other.jet.f < found.jet.f - equal {
                    return true;
                }
            }
        }
        false
    }

    /// Lower close by, within the smooth patch.
    fn falls_around(&mut self, found: &Descent, equal: f64) -> bool {
        let at = found.place;
        for share in AROUND {
            for k in 0..9 {
                let (a, b) = (
                    &self.eval.pieces.u.spans[at.i],
                    &self.eval.pieces.v.spans[at.j],
                );
                let move_by = |step: f64, x: f64, width: f64, low: f64, high: f64| {
                    (x + step * share * width).clamp(low, high)
                };
                let u = move_by(
                    (k / 3) as f64 - 1.0,
                    at.u,
                    a.end - a.start,
                    a.reach_low,
                    a.reach_high,
                );
                let v = move_by(
                    (k % 3) as f64 - 1.0,
                    at.v,
                    b.end - b.start,
                    b.reach_low,
                    b.reach_high,
                );
                let (i, offset_u) = self.eval.pieces.u.locate(u, at.i, a.reach_high);
                let (j, offset_v) = self.eval.pieces.v.locate(v, at.j, b.reach_high);
                if self.value(NewtonPlace {
                    i,
                    j,
                    u: u - offset_u,
                    v: v - offset_v,
                }) < found.jet.f - equal
                {
                    return true;
                }
            }
        }
        false
    }

    /// Lower on a meridian out of a pole.
    fn falls_from_pole(&mut self, found: &Descent, equal: f64) -> bool {
        let at = found.place;
        for collapsed in 0..2 {
            let short = found.jet.metric[collapsed] <= COLLAPSED * self.size_m * self.size_m;
            let (du, dv) = (&self.eval.pieces.u, &self.eval.pieces.v);
            let (held, k, x, spans) = if collapsed == 0 {
                (dv, at.j, at.v, du.spans.len())
            } else {
                (du, at.i, at.u, dv.spans.len())
            };
            if !short || other_end(held, x).is_none() {
                continue;
            }
            let width = held.spans[k].end - held.spans[k].start;
            let inward = if x <= held.domain.0 { width } else { -width };
            for ring in 0..spans * MERIDIANS {
                let span = ring / MERIDIANS;
                let d = if collapsed == 0 {
                    &self.eval.pieces.u
                } else {
                    &self.eval.pieces.v
                };
                let (start, end) = (d.spans[span].start, d.spans[span].end);
                let z =
                    start + (end - start) * ((ring % MERIDIANS) as f64 + 0.5) / MERIDIANS as f64;
                let place = |y: f64| {
                    if collapsed == 0 {
                        NewtonPlace {
                            i: span,
                            u: z,
                            v: y,
                            ..at
                        }
                    } else {
                        NewtonPlace {
                            j: span,
                            v: z,
                            u: y,
                            ..at
                        }
                    }
                };
                let NewtonPlace { i, j, u, v } = place(x);
                let jet = self.objective.jet(&self.eval.frame(i, j, u, v));
                let out = 1 - collapsed;
                let slope =
                    jet.g[out] * inward.signum() / jet.metric[out].sqrt().max(f64::MIN_POSITIVE);
                // What it falls by until it rises again.
                let bend = (jet.h[2 * out] / jet.metric[out].max(f64::MIN_POSITIVE)).max(0.0);
                if (slope < -16.0 * jet.slope_noise && slope * slope > 2.0 * bend * equal)
                    || AROUND
                        .into_iter()
                        .any(|share| self.value(place(x + share * inward)) < found.jet.f - equal)
                {
                    return true;
                }
            }
        }
        false
    }

    /// A straight way in the parameters, perhaps across a seam, on which no value is above `limit`.
    pub fn joined(&mut self, a: &NewtonPlace, b: &NewtonPlace, limit: f64) -> bool {
        if let Some(joints) = self.eval.pieces.joints()
            && let Some(ways) = Detours::between(joints, *a, *b)
        {
            return ways
                .spots()
                .any(|[from, to]| self.straight(a, &from, limit) && self.straight(&to, b, limit));
        }
        self.straight(a, b, limit)
    }

    fn straight(&mut self, a: &NewtonPlace, b: &NewtonPlace, limit: f64) -> bool {
        let ways = |d: &PieceDirection, from: f64, to: f64| {
            let (direct, period) = (to - from, d.domain.1 - d.domain.0);
            let around = if direct > 0.0 {
                direct - period
            } else {
                direct + period
            };
            // Around a period is as smooth as anywhere: take the shorter way. Across ends, try
            // both.
            match (d.periodic, around.abs() < direct.abs()) {
                (true, true) => [Some(around), None],
                (true, false) => [Some(direct), None],
                (false, _) => [Some(direct), Some(around)],
            }
        };
        let us = ways(&self.eval.pieces.u, a.u, b.u);
        let vs = ways(&self.eval.pieces.v, a.v, b.v);
        us.into_iter().flatten().any(|u| {
            vs.into_iter()
                .flatten()
                .any(|v| self.joined_by(a, u, v, limit))
        })
    }

    fn joined_by(&mut self, a: &NewtonPlace, along_u: f64, along_v: f64, limit: f64) -> bool {
        // Of a branching surface a way stays on its patch, also where that ends.
        let most = self
            .eval
            .pieces
            .joints()
            .map_or([usize::MAX; 2], |joints| joints.last_spans([a.i, a.j]));
        let at = |judge: &Self, share: f64| {
            let (du, dv) = (&judge.eval.pieces.u, &judge.eval.pieces.v);
            let (u, v) = (
                within(du, a.u + share * along_u),
                within(dv, a.v + share * along_v),
            );
            NewtonPlace {
                i: du.span_of(u).min(most[0]),
                j: dv.span_of(v).min(most[1]),
                u,
                v,
            }
        };
        for twelfth in WAY {
            let place = at(self, twelfth / 12.0);
            let value = self.value(place);
            if value.is_nan() || value > limit {
                return false;
            }
        }
        // Where the way leaves one end of the domain and goes on at the other, they must be one
        // place.
        for (in_u, x, along) in [(true, a.u, along_u), (false, a.v, along_v)] {
            let d = if in_u {
                &self.eval.pieces.u
            } else {
                &self.eval.pieces.v
            };
            let (start, end) = d.domain;
            let y = x + along;
            if d.periodic || (y >= start && y <= end) {
                continue;
            }
            let last = d.spans.len() - 1;
            let share = (if y > end { end - x } else { start - x }) / along;
            let place = at(self, share);
            let [p, q] = [(0, start), (last, end)].map(|(k, x)| {
                let place = if in_u {
                    NewtonPlace {
                        i: k,
                        u: x,
                        ..place
                    }
                } else {
                    NewtonPlace {
                        j: k,
                        v: x,
                        ..place
                    }
                };
                self.eval.frame(place.i, place.j, place.u, place.v).point
            });
            if (p - q).norm() > SAME * (p.coords.amax() + self.size_m) {
                return false;
            }
        }
        true
    }
}

/// Ways from one patch to another over an edge that joins them: where it is left, and where the
/// other patch is entered.
struct Detours {
    ways: [Option<[NewtonPlace; 2]>; 12],
}

impl Detours {
    /// `None` within one patch, whose places are reached straight.
    fn between(joints: &Joints, a: NewtonPlace, b: NewtonPlace) -> Option<Self> {
        let (from, to) = (joints.patch_of([a.i, a.j])?, joints.patch_of([b.i, b.j])?);
        if from == to {
            return None;
        }
        let mut ways = [None; 12];
        let mut count = 0;
        for side in 0..4 {
            // Where the edge is nearest to each of the two, in parameters, and in between.
            let own = joints.on_edge(from, side, a.into());
            for spot in joints.crossings(own, side, to, b.into()) {
                if count < ways.len() {
                    ways[count] = Some(spot.map(NewtonPlace::from));
                    count += 1;
                }
            }
        }
        Some(Self { ways })
    }

    fn spots(&self) -> impl Iterator<Item = [NewtonPlace; 2]> + '_ {
        self.ways.iter().flatten().copied()
    }
}

/// Held at an edge by a slope that exceeds rounding, along a tangent that is none.
pub(super) fn steep(found: &Descent, k: usize, size_m: f64) -> bool {
    let m = found.jet.metric[k];
    m > COLLAPSED * size_m * size_m
        && found.jet.g[k].abs() > STEEP * found.jet.slope_noise * m.sqrt()
}

/// A parameter that may have left the domain by less than its length, wrapped into it.
fn within(d: &PieceDirection, x: f64) -> f64 {
    let (start, end) = d.domain;
    let period = end - start;
    (if x > end {
        x - period
    } else if x < start {
        x + period
    } else {
        x
    })
    .clamp(start, end)
}

/// The edges of the domain on which a place is, of u and of v: 0, 1 at start and end of u, 2, 3 of
/// v.
pub(super) fn ends(pieces: &BezierPieces, at: &NewtonPlace) -> [Option<usize>; 2] {
    let end = |d: &PieceDirection, x: f64, first: usize| {
        if d.periodic {
            None
        } else if x <= d.domain.0 {
            Some(first)
        } else {
            (x >= d.domain.1).then_some(first + 1)
        }
    };
    [end(&pieces.u, at.u, 0), end(&pieces.v, at.v, 2)]
}

/// The edge of the domain that is collapsed to the point where a descent ended.
pub(super) fn pole_at(pieces: &BezierPieces, found: &Descent, size_m: f64) -> Option<usize> {
    let collapsed = |across: usize| found.jet.metric[across] <= COLLAPSED * size_m * size_m;
    let [u, v] = ends(pieces, &found.place);
    u.filter(|_| collapsed(1)).or(v.filter(|_| collapsed(0)))
}
