//! Descent to a local minimum: Newton with second derivatives, inside the smooth patch that holds
//! the start.
//!
//! A patch is a parameter rectangle between creases, disjoined knots and ends of the domain; smooth
//! period ends are passed. At a patch's edge a variable that wants to leave is held (projected
//! Newton; Bertsekas 1982), where the Hessian is not positive its eigenvalues are mirrored, and the
//! step is halved until the objective falls. Near the answer, where the objective is flat to
//! rounding, steps are taken while they reduce the gradient instead. Finds a local minimum only;
//! who needs the global one asks the bounds.

use super::objective::{Jet, Smooth};
use super::side::Site;
use crate::surface::bezier::{BezierPieces, Joint, PieceDirection};
use crate::surface::joints::{Joints, Spot};
use crate::surface::tensor::{Frame, Surface};

/// Where a piecewise surface is evaluated: its directions, and a frame seen from given spans.
pub(super) trait Evaluate {
    fn directions(&self) -> (&PieceDirection, &PieceDirection);
    /// `u` in span `i`, `v` in span `j`.
    fn frame(&mut self, i: usize, j: usize, u: f64, v: f64) -> Frame;
    /// The pieces, which know how a branching surface is joined.
    fn pieces(&self) -> &BezierPieces;
}

/// On Bézier pieces, refreshed when they are old.
pub(super) struct OnPieces<'a> {
    pub pieces: &'a mut BezierPieces,
    pub surface: &'a Surface,
}

impl Evaluate for OnPieces<'_> {
    #[inline(always)]
    fn directions(&self) -> (&PieceDirection, &PieceDirection) {
        (&self.pieces.u, &self.pieces.v)
    }

    #[inline(always)]
    fn frame(&mut self, i: usize, j: usize, u: f64, v: f64) -> Frame {
        self.pieces.refresh_piece(self.surface, i, j);
        let (a, b) = (&self.pieces.u.spans[i], &self.pieces.v.spans[j]);
        let (s, t) = (
            (u - a.start) / (a.end - a.start),
            (v - b.start) / (b.end - b.start),
        );
        self.pieces.frame(i, j, s, t)
    }

    #[inline(always)]
    fn pieces(&self) -> &BezierPieces {
        self.pieces
    }
}

/// On the surface itself, for callers without a mutable solver.
pub(super) struct OnSurface<'a> {
    pub pieces: &'a BezierPieces,
    pub surface: &'a Surface,
}

impl Evaluate for OnSurface<'_> {
    fn directions(&self) -> (&PieceDirection, &PieceDirection) {
        (&self.pieces.u, &self.pieces.v)
    }

    fn frame(&mut self, i: usize, j: usize, u: f64, v: f64) -> Frame {
        let Self { pieces, surface } = *self;
        Site {
            surface,
            u: &pieces.u,
            v: &pieces.v,
            joints: None,
        }
        .frame(NewtonPlace { i, j, u, v })
    }

    fn pieces(&self) -> &BezierPieces {
        self.pieces
    }
}

/// A place on the surface: parameters with the spans they are seen from.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonPlace {
    pub i: usize,
    pub j: usize,
    pub u: f64,
    pub v: f64,
}

impl From<Spot> for NewtonPlace {
    fn from(Spot { i, j, u, v }: Spot) -> Self {
        Self { i, j, u, v }
    }
}

impl From<NewtonPlace> for Spot {
    fn from(NewtonPlace { i, j, u, v }: NewtonPlace) -> Self {
        Self { i, j, u, v }
    }
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    pub place: NewtonPlace,
    pub frame: Frame,
    pub jet: Jet,
    /// The directions in which the objective could still fall: not held at an edge, with metres to
    /// move.
    pub free: [bool; 2],
    /// Largest slope along a free direction, objective per metre.
    pub slope: f64,
    /// Parameters at which a variable is stuck at a crease: the span beyond, to go on from.
    pub beyond: Option<NewtonPlace>,
}

impl Descent {
    /// The Hessian over the free directions is positive, or zero to rounding, in metres.
    pub fn is_minimum(&self) -> bool {
        let [mu, mv] = self.jet.metric;
        let [huu, huv, hvv] = self.jet.h;
        let low = -1e-9;
        match self.free {
            [false, false] => true,
            [true, false] => huu >= low * mu,
            [false, true] => hvv >= low * mv,
            [true, true] => {
                let (a, b, c) = (huu / mu, huv / (mu * mv).sqrt(), hvv / mv);
                let mean = 0.5 * (a + c);
                mean - (0.25 * (a - c) * (a - c) + b * b).sqrt() >= low
            }
        }
    }
}

/// [`descend`], going on over creases while that helps.
pub(super) fn descend_over<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    start: NewtonPlace,
) -> Descent {
    let mut best = descend(eval, objective, start);
    for _ in 0..8 {
        let Some(place) = best.beyond else { break };
        let next = descend(eval, objective, place);
        if next.jet.f < best.jet.f {
            best = next;
        } else {
            break;
        }
    }
    best
}

/// Descends from `start` within its smooth patch.
pub(super) fn descend<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    start: NewtonPlace,
) -> Descent {
    let (du, dv) = eval.directions();
    let (a, b) = (&du.spans[start.i], &dv.spans[start.j]);
    let (low, high) = ([a.reach_low, b.reach_low], [a.reach_high, b.reach_high]);
    descend_between(eval, objective, start, low, high)
}

/// Descends from `start` within a parameter rectangle of its smooth patch, unwrapped as `start` is.
pub(super) fn descend_between<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    start: NewtonPlace,
    low: [f64; 2],
    high: [f64; 2],
) -> Descent {
    #[cfg(target_arch = "x86_64")]
    if crate::math::simd::has_avx2() {
        // SAFETY: the processor has AVX2, asked just above.
        #[allow(unsafe_code)]
        return unsafe { descend_wide(eval, objective, start, low, high) };
    }
    descend_in(eval, objective, start, low, high)
}

/// AVX2 build of the baseline function: sums in the same order, hence identical bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn descend_wide<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    start: NewtonPlace,
    low: [f64; 2],
    high: [f64; 2],
) -> Descent {
    descend_in(eval, objective, start, low, high)
}

#[inline(always)]
fn descend_in<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    start: NewtonPlace,
    low: [f64; 2],
    high: [f64; 2],
) -> Descent {
    // `x` is unwrapped; `at` is the same place inside the domain.
    let mut x = [
        start.u.clamp(low[0], high[0]),
        start.v.clamp(low[1], high[1]),
    ];
    let (mut at, mut frame, mut jet) = look(eval, objective, x, start, high);
    let mut free;
    let mut slope;
    let mut best_slope = f64::INFINITY;
    let mut rounds = 0;
    loop {
        (free, slope) = freedom(&jet, x, low, high);
        rounds += 1;
        if rounds > 80 || slope <= jet.slope_noise {
            break;
        }
        let step = newton_step(&jet, free);
        let (du, dv) = eval.directions();
        let widths = [
            du.spans[at.i].end - du.spans[at.i].start,
            dv.spans[at.j].end - dv.spans[at.j].start,
        ];
        // No farther than a span at once: beyond it the second-order model says nothing.
        let mut shrink = 1.0_f64;
        for k in 0..2 {
            if step[k].abs() > widths[k] {
                shrink = shrink.min(widths[k] / step[k].abs());
            }
        }
        if let Some((y, place)) = last_step(eval.directions(), &jet, free, x, at, step, widths) {
            frame = extend(&frame, place.u - at.u, place.v - at.v);
            (x, at, jet) = (y, place, objective.jet(&frame));
            (free, slope) = freedom(&jet, x, low, high);
            break;
        }
        let target = |scale: f64| -> [f64; 2] {
            std::array::from_fn(|k| (x[k] + scale * shrink * step[k]).clamp(low[k], high[k]))
        };
        let mut y = target(1.0);
        if y == x {
            break;
        }
        let promise = |y: [f64; 2]| jet.g[0] * (y[0] - x[0]) + jet.g[1] * (y[1] - x[1]);
        if -promise(y) <= jet.noise {
            // The objective cannot tell any more; the gradient can.
            let (place, new_frame, new_jet) = look(eval, objective, y, at, high);
            let (_, new_slope) = freedom(&new_jet, y, low, high);
            if new_slope < 0.9 * slope.min(best_slope) && new_jet.f <= jet.f + jet.noise {
                best_slope = new_slope;
                (x, at, frame, jet) = (y, place, new_frame, new_jet);
                continue;
            }
            break;
        }
        let mut scale = 1.0;
        let mut accepted = false;
        for _ in 0..40 {
            let (place, new_frame, new_jet) = look(eval, objective, y, at, high);
            if new_jet.f <= jet.f + 1e-4 * promise(y) {
                (x, at, frame, jet) = (y, place, new_frame, new_jet);
                accepted = true;
                break;
            }
            scale *= 0.4;
            y = target(scale);
            if y == x {
                break;
            }
        }
        if !accepted {
            break;
        }
    }
    let beyond =
        if let Some(joints) = eval.pieces().joints() {
            over_joint(joints, at, x, low, high, jet.g)
        } else {
            let (du, dv) = eval.directions();
            across(du, x[0], low[0], high[0], at.i, at.u, jet.g[0])
                .map(|(i, u)| NewtonPlace { i, u, ..at })
                .or_else(|| {
                    across(dv, x[1], low[1], high[1], at.j, at.v, jet.g[1])
                        .map(|(j, v)| NewtonPlace { j, v, ..at })
                })
        };
    Descent {
        place: at,
        frame,
        jet,
        free,
        slope,
        beyond,
    }
}

/// Evaluates at an unwrapped parameter pair that is reached smoothly from `near`.
#[inline(always)]
fn look<E: Evaluate, O: Smooth>(
    eval: &mut E,
    objective: &O,
    x: [f64; 2],
    near: NewtonPlace,
    high: [f64; 2],
) -> (NewtonPlace, Frame, Jet) {
    let (du, dv) = eval.directions();
    let (i, offset_u) = du.locate(x[0], near.i, high[0]);
    let (j, offset_v) = dv.locate(x[1], near.j, high[1]);
    let (a, b) = (&du.spans[i], &dv.spans[j]);
    let place = NewtonPlace {
        i,
        j,
        u: (x[0] - offset_u).clamp(a.start, a.end),
        v: (x[1] - offset_v).clamp(b.start, b.end),
    };
    let frame = eval.frame(i, j, place.u, place.v);
    (place, frame, objective.jet(&frame))
}

/// A step so short that Taylor's series to second order is the surface to rounding, from a point
/// where Newton's error is safely squared by each step: the last one, and no evaluation is needed
/// to take it.
#[inline(always)]
fn last_step(
    (du, dv): (&PieceDirection, &PieceDirection),
    jet: &Jet,
    free: [bool; 2],
    x: [f64; 2],
    at: NewtonPlace,
    step: [f64; 2],
    widths: [f64; 2],
) -> Option<([f64; 2], NewtonPlace)> {
    const SHORT: f64 = 1e-8;
    let ([mu, mv], [huu, huv, hvv]) = (jet.metric, jet.h);
    let short = step[0].abs() <= SHORT * widths[0] && step[1].abs() <= SHORT * widths[1];
    if !short || free != [true, true] || huu < 0.1 * mu || huu * hvv - huv * huv < 0.01 * mu * mv {
        return None;
    }
    let place = NewtonPlace {
        u: at.u + step[0],
        v: at.v + step[1],
        ..at
    };
    let (a, b) = (&du.spans[at.i], &dv.spans[at.j]);
    let inside = place.u > a.start && place.u < a.end && place.v > b.start && place.v < b.end;
    inside.then_some(([x[0] + step[0], x[1] + step[1]], place))
}

/// A frame moved by a step of parameters, by its own derivatives.
#[inline(always)]
fn extend(frame: &Frame, u: f64, v: f64) -> Frame {
    let (along_u, along_v) = (frame.duu * u + frame.duv * v, frame.duv * u + frame.dvv * v);
    Frame {
        point: frame.point + (frame.du + along_u * 0.5) * u + (frame.dv + along_v * 0.5) * v,
        du: frame.du + along_u,
        dv: frame.dv + along_v,
        ..*frame
    }
}

/// The place over a joint of a branching surface at which a variable is held.
#[inline(never)]
fn over_joint(
    joints: &Joints,
    at: NewtonPlace,
    x: [f64; 2],
    low: [f64; 2],
    high: [f64; 2],
    g: [f64; 2],
) -> Option<NewtonPlace> {
    let edges = joints.edges_at(at.into());
    let held = |side: usize| {
        let k = side / 2;
        edges[side]
            && if side.is_multiple_of(2) {
                x[k] <= low[k] && g[k] >= 0.0
            } else {
                x[k] >= high[k] && g[k] <= 0.0
            }
    };
    let side =
        (0..4).find(|&side| held(side) && joints.beyond(at.into(), side).next().is_some())?;
    joints
        .beyond(at.into(), side)
        .next()
        .map(|(spot, _)| spot.into())
}

/// The span across a crease at which the variable is held.
fn across(
    d: &PieceDirection,
    x: f64,
    low: f64,
    high: f64,
    span: usize,
    inside: f64,
    slope: f64,
) -> Option<(usize, f64)> {
    let n = d.spans.len();
    if x <= low
        && slope >= 0.0
        && d.spans[span].before == Joint::Crease
        && inside == d.spans[span].start
    {
        let other = (span + n - 1) % n;
        Some((other, d.spans[other].end))
    } else if x >= high
        && slope <= 0.0
        && d.spans[span].after == Joint::Crease
        && inside == d.spans[span].end
    {
        let other = (span + 1) % n;
        Some((other, d.spans[other].start))
    } else {
        None
    }
}

/// Which variables may move, and the steepest slope among them.
#[inline]
fn freedom(jet: &Jet, x: [f64; 2], low: [f64; 2], high: [f64; 2]) -> ([bool; 2], f64) {
    let mut free = [true; 2];
    let mut slope: f64 = 0.0;
    for k in 0..2 {
        let (g, m) = (jet.g[k], jet.metric[k]);
        free[k] = m > 0.0 && !(x[k] <= low[k] && g >= 0.0) && !(x[k] >= high[k] && g <= 0.0);
        if free[k] {
            slope = slope.max(g.abs() / m.sqrt());
        }
    }
    (free, slope)
}

/// Newton's step over the free variables; where the Hessian is not positive, its eigenvalues are
/// mirrored.
#[inline]
fn newton_step(jet: &Jet, free: [bool; 2]) -> [f64; 2] {
    let [gu, gv] = jet.g;
    let [huu, huv, hvv] = jet.h;
    let alone = |g: f64, h: f64, m: f64| {
        -g / if h > 1e-12 * m {
            h
        } else {
            h.abs().max(1e-3 * m)
        }
    };
    match free {
        [false, false] => [0.0, 0.0],
        [true, false] => [alone(gu, huu, jet.metric[0]), 0.0],
        [false, true] => [0.0, alone(gv, hvv, jet.metric[1])],
        [true, true] => {
            let det = huu * hvv - huv * huv;
            if huu > 0.0 && hvv > 0.0 && det > 1e-12 * huu * hvv {
                return [(huv * gv - hvv * gu) / det, (huv * gu - huu * gv) / det];
            }
            // In metres: scaled by the lengths of the tangents.
            let (lu, lv) = (jet.metric[0].sqrt(), jet.metric[1].sqrt());
            let (a, b, c) = (huu / (lu * lu), huv / (lu * lv), hvv / (lv * lv));
            let (x, y) = (gu / lu, gv / lv);
            let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
            let root = (half * half + b * b).sqrt();
            let (first, second) = (mean + root, mean - root);
            let most = first.abs().max(second.abs()).max(f64::MIN_POSITIVE);
            let safe = |l: f64| l.abs().max(1e-6 * most);
            // Eigenvector of the larger eigenvalue.
            let (ex, ey) = if half >= 0.0 {
                (half + root, b)
            } else {
                (b, root - half)
            };
            let length = (ex * ex + ey * ey).sqrt();
            let (ex, ey) = if length > 0.0 {
                (ex / length, ey / length)
            } else {
                (1.0, 0.0)
            };
            let (p, q) = (
                -(x * ex + y * ey) / safe(first),
                -(y * ex - x * ey) / safe(second),
            );
            [(p * ex - q * ey) / lu, (p * ey + q * ex) / lv]
        }
    }
}
