//! Places of greatest depth of one surface below another.
//!
//! Where the foot is unique the depth is smooth and Newton climbs it. The deepest place of a deep
//! region may have two or three feet equally close (it lies on the medial axis): there the least of
//! several smooth depths is greatest, which Newton finds from d₁ = d₂ and λ ∇d₁ + (1 − λ) ∇d₂ = 0,
//! or from d₁ = d₂ = d₃.

use super::cells::Cells;
use super::depth::{Below, Sounding, jet};
use super::facing::FLAT;
use crate::math::Point3;
use crate::surface::closest::Jet;
use crate::surface::{ClosestSolver, Frame, Surface};

/// Steps of a climb, among them those after a certificate has shown a closer foot.
const STEPS: usize = 40;
/// Feet that a climb keeps in view. Three hold a place; the middle of a block has six, and with
/// only three of them in view a climb steps towards the others.
const FEET: usize = 6;
/// Depths closer than this, relative to the size, are one.
const SAME_DEPTH: f64 = 1e-11;
/// Steps shorter than this, relative to the size, have arrived.
const SHORT: f64 = 1e-10;

/// A place of greatest depth, with its certified foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top {
    pub u: f64,
    pub v: f64,
    pub point: Point3,
    pub sounding: Sounding,
    /// A local maximum; else a place where the search gave up.
    pub summit: bool,
}

/// The surface that is climbed over.
pub(super) struct Upper<'a> {
    pub surface: &'a Surface,
    pub solver: &'a mut ClosestSolver,
    /// Of both surfaces together, m.
    pub size_m: f64,
}

/// A place with the feet in view, the closest first.
struct View {
    at: [f64; 2],
    frame: Frame,
    feet: [Option<Sounding>; FEET],
}

impl View {
    fn depth_m(&self) -> f64 {
        self.feet[0].map_or(f64::NEG_INFINITY, |f| f.depth_m)
    }

    /// Puts a foot in its place, unless it is there; the farthest leaves.
    fn add(&mut self, new: Sounding, size_m: f64) {
        let same = |f: &Sounding| (f.foot.at.point - new.foot.at.point).norm() < 1e-6 * size_m;
        if self.feet.iter().flatten().any(same) {
            return;
        }
        let at = self
            .feet
            .iter()
            .position(|f| f.is_none_or(|f| new.depth_m < f.depth_m));
        if let Some(at) = at {
            self.feet[at..].rotate_right(1);
            self.feet[at] = Some(new);
        }
    }
}

impl Upper<'_> {
    /// A place of a face that is flat on another, if no step of `part_m` promises to raise its depth by more than `level_m`.
    pub fn level(
        &mut self,
        below: &mut Below<'_>,
        at: (f64, f64),
        from: (f64, f64),
        part_m: f64,
        level_m: f64,
    ) -> Option<Top> {
        let frame = self.solver.frame_at(self.surface, at.0, at.1);
        let mut view = View {
            at: [at.0, at.1],
            frame,
            feet: [None; FEET],
        };
        let sounding = below.follow(&frame.point, from.0, from.1);
        view.add(sounding, self.size_m);
        let Jet {
            h,
            metric: [mu, mv],
            ..
        } = jet(&frame, &sounding);
        let bends = (h[0] / mu).abs() + 2.0 * h[1].abs() / (mu * mv).sqrt() + (h[2] / mv).abs();
        let flat = sounding.foot.smooth && bends * part_m < FLAT;
        let (_, _, gain_m) = self.step(&view, part_m).filter(|_| flat)?;
        if gain_m > level_m {
            return None;
        }
        let sure = below.certain(&frame.point);
        let agreed = (sure.depth_m - sounding.depth_m).abs() <= SAME_DEPTH * self.size_m;
        agreed.then_some(Top {
            u: at.0,
            v: at.1,
            point: frame.point,
            sounding: sure,
            summit: true,
        })
    }

    /// The greatest depth that can be climbed to from (u, v), whose foot is near `from`. `reach_m`
    /// is the longest step.
    pub fn climb(
        &mut self,
        cells: &Cells,
        below: &mut Below<'_>,
        u: f64,
        v: f64,
        from: (f64, f64),
        reach_m: f64,
    ) -> Option<Top> {
        let (tolerance, short) = (SAME_DEPTH * self.size_m, SHORT * self.size_m);
        let mut view = View {
            at: [u, v],
            frame: self.solver.frame_at(self.surface, u, v),
            feet: [None; FEET],
        };
        let first = below.follow(&view.frame.point, from.0, from.1);
        view.add(first, self.size_m);
        let mut radius = reach_m;
        let mut certified = None;
        let mut arrived = false;
        for _ in 0..STEPS {
            let (step, metres, _) = self.step(&view, radius)?;
            if !metres.is_finite() {
                return None;
            }
            let next = if metres > short {
                self.look(cells, below, &view, step)
            } else {
                None
            };
            if let Some(next) = next {
                let risen = next.depth_m() - view.depth_m();
                if risen > 0.0 || (risen > -tolerance && metres < 1e-5 * self.size_m) {
                    radius = if metres > 0.5 * radius {
                        2.0 * radius
                    } else {
                        radius
                    };
                    view = next;
                    // The next step would be shorter than rounding.
                    if metres > 1e-6 * self.size_m {
                        continue;
                    }
                } else if metres > short {
                    for foot in next.feet.iter().flatten() {
                        let here = below.follow(&view.frame.point, foot.foot.at.u, foot.foot.at.v);
                        view.add(here, self.size_m);
                    }
                    radius = 0.3 * metres;
                    if radius > short {
                        continue;
                    }
                }
            } else {
                arrived = true;
            }
            let sure = below.certain(&view.frame.point);
            if (sure.depth_m - view.depth_m()).abs() <= tolerance {
                certified = Some(sure);
                if metres < 1e-6 * self.size_m {
                    arrived = true;
                }
                break;
            }
            arrived = false;
            view.add(sure, self.size_m);
            radius = reach_m;
        }
        let sure = match certified {
            Some(sure) => sure,
            None => below.certain(&view.frame.point),
        };
        // Steps may have shrunk to nothing where the feet's models do not hold: on a true top none
        // promises anything.
        let trial_m = 1e-4 * self.size_m;
        let promised = self
            .step(&view, trial_m)
            .map_or(f64::INFINITY, |(_, _, gain)| gain);
        let arrived = arrived && promised <= 1e-5 * trial_m;
        let top = Top {
            u: view.at[0],
            v: view.at[1],
            point: view.frame.point,
            sounding: sure,
            summit: arrived,
        };
        let held = cells.wall(top.u, top.v);
        if arrived && !held {
            return Some(top);
        }
        // An edge, a crease or a pole may hold the deepest place: climb along it.
        Some(self.climb_edges(below, top))
    }

    fn climb_edges(&mut self, below: &mut Below<'_>, top: Top) -> Top {
        let foot = top.sounding.foot.at;
        let (bottom, guess) =
            below.climb(self.surface, self.solver, top.u, top.v, (foot.u, foot.v));
        let point = bottom.frame.point;
        let arrived = bottom.slope < 1e-7 && bottom.minimum;
        if !point.coords.amax().is_finite() || guess.depth_m < top.sounding.depth_m {
            return top;
        }
        let sure = below.certain(&point);
        let agreed = (sure.depth_m - guess.depth_m).abs() <= SAME_DEPTH * self.size_m;
        if sure.depth_m >= top.sounding.depth_m - SAME_DEPTH * self.size_m && agreed {
            return Top {
                u: bottom.u,
                v: bottom.v,
                point,
                sounding: sure,
                summit: arrived || top.summit,
            };
        }
        top
    }

    /// The view from a step away; `None` when the step leads nowhere.
    fn look(
        &mut self,
        cells: &Cells,
        below: &mut Below<'_>,
        view: &View,
        step: [f64; 2],
    ) -> Option<View> {
        let at = cells.moved(view.at, step);
        if at == view.at {
            return None;
        }
        let frame = self.solver.frame_at(self.surface, at[0], at[1]);
        let mut next = View {
            at,
            frame,
            feet: [None; FEET],
        };
        for foot in view.feet.iter().flatten() {
            let sounding = below.follow(&frame.point, foot.foot.at.u, foot.foot.at.v);
            next.add(sounding, self.size_m);
        }
        let (depth, (s, t)) = below.rough(&frame.point);
        if depth < next.depth_m() - 1e-4 * depth.abs() {
            let closer = below.follow(&frame.point, s, t);
            next.add(closer, self.size_m);
        }
        Some(next)
    }

    /// The step of at most `radius` metres that promises most, its length and the depth it promises
    /// to gain: the least of the feet's second-order models is greatest.
    fn step(&self, view: &View, radius: f64) -> Option<([f64; 2], f64, f64)> {
        let mut jets = [None; FEET];
        for (slot, foot) in jets.iter_mut().zip(&view.feet) {
            // Feet that no step reaches hold nothing.
            *slot = foot
                .filter(|f| f.depth_m <= view.depth_m() + 2.0 * radius)
                .map(|f| jet(&view.frame, &f));
        }
        let first = jets[0]?;
        let [mu, mv] = first.metric;
        let muv = view.frame.du.dot(&view.frame.dv);
        let metres = |d: [f64; 2]| {
            (d[0] * d[0] * mu + 2.0 * d[0] * d[1] * muv + d[1] * d[1] * mv)
                .max(0.0)
                .sqrt()
        };
        let mut best: Option<(f64, [f64; 2], f64)> = None;
        let mut offer = |step: [f64; 2]| {
            let length = metres(step);
            let scale = if length > radius {
                radius / length
            } else {
                1.0
            };
            let step = [scale * step[0], scale * step[1]];
            let promise = jets.iter().flatten().fold(f64::INFINITY, |m, j| {
                let h = turn(&j.h, step);
                m.min(
                    -j.f - j.g[0] * step[0]
                        - j.g[1] * step[1]
                        - 0.5 * (step[0] * h[0] + step[1] * h[1]),
                )
            });
            if promise.is_finite() && best.is_none_or(|(most, _, _)| promise > most) {
                best = Some((promise, step, scale * length));
            }
        };
        for a in 0..FEET {
            let Some(ja) = jets[a] else { continue };
            offer(one(&ja, muv, radius));
            for b in a + 1..FEET {
                let Some(jb) = jets[b] else { continue };
                if let Some((step, _)) = two(&ja, &jb) {
                    offer(step);
                }
                for c in b + 1..FEET {
                    if let Some((step, _)) = jets[c].and_then(|jc| three(&ja, &jb, &jc)) {
                        offer(step);
                    }
                }
            }
        }
        best.map(|(promise, step, length)| (step, length, promise - view.depth_m()))
    }
}

/// Newton's step of one foot; away from saddles, along the way that falls.
fn one(j: &Jet, muv: f64, radius: f64) -> [f64; 2] {
    let ([a, b, c], [x, y]) = (j.h, j.g);
    let det = a * c - b * b;
    if a > 0.0 && c > 0.0 && det > 1e-9 * a * c {
        return [(b * y - c * x) / det, (b * x - a * y) / det];
    }
    // Against the gradient, in metres; at a saddle along the direction of least curvature.
    let [mu, mv] = j.metric;
    let det_m = (mu * mv - muv * muv)
        .max(1e-12 * mu * mv)
        .max(f64::MIN_POSITIVE);
    let down = [-(mv * x - muv * y) / det_m, -(mu * y - muv * x) / det_m];
    let slope = -(down[0] * x + down[1] * y);
    let unit = slope.max(0.0).sqrt();
    if unit > 1e-7 {
        return [down[0] * radius / unit, down[1] * radius / unit];
    }
    let (lu, lv) = (
        mu.max(f64::MIN_POSITIVE).sqrt(),
        mv.max(f64::MIN_POSITIVE).sqrt(),
    );
    let (p, q, r) = (
        a / mu.max(f64::MIN_POSITIVE),
        b / (lu * lv),
        c / mv.max(f64::MIN_POSITIVE),
    );
    let (mean, half) = (0.5 * (p + r), 0.5 * (p - r));
    let root = (half * half + q * q).sqrt();
    if mean - root > -1e-6 * (mean.abs() + root) {
        return [0.0, 0.0];
    }
    let (ex, ey) = if half >= 0.0 {
        (-q, half + root)
    } else {
        (root - half, -q)
    };
    let length = (ex * ex + ey * ey).sqrt().max(f64::MIN_POSITIVE);
    [
        0.3 * radius * ex / (length * lu),
        0.3 * radius * ey / (length * lv),
    ]
}

/// Step and shares where two distances stay equal and the larger is least.
fn two(a: &Jet, b: &Jet) -> Option<([f64; 2], [f64; 3])> {
    let d = [a.g[0] - b.g[0], a.g[1] - b.g[1]];
    // In metres, so that neither parameter counts for more.
    let [mu, mv] = a.metric;
    let square = d[0] * d[0] / mu + d[1] * d[1] / mv;
    let apart = square > 1e-16;
    if !apart {
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
    Some((
        [c[0] + x * t[0], c[1] + x * t[1]],
        [share, 1.0 - share, 0.0],
    ))
}

fn turn(h: &[f64; 3], x: [f64; 2]) -> [f64; 2] {
    [h[0] * x[0] + h[1] * x[1], h[1] * x[0] + h[2] * x[1]]
}

/// Step and shares where three distances are equal.
fn three(a: &Jet, b: &Jet, c: &Jet) -> Option<([f64; 2], [f64; 3])> {
    let (p, q) = (
        [a.g[0] - c.g[0], a.g[1] - c.g[1]],
        [b.g[0] - c.g[0], b.g[1] - c.g[1]],
    );
    let det = p[0] * q[1] - p[1] * q[0];
    let scale = (p[0].abs() + p[1].abs()) * (q[0].abs() + q[1].abs());
    let apart = det.abs() > 1e-9 * scale;
    if !apart {
        return None;
    }
    let (x, y) = (-(a.f - c.f), -(b.f - c.f));
    let step = [(x * q[1] - y * p[1]) / det, (y * p[0] - x * q[0]) / det];
    // α a + β b + (1 − α − β) c = 0.
    let alpha = (-c.g[0] * q[1] + c.g[1] * q[0]) / det;
    let beta = (c.g[0] * p[1] - c.g[1] * p[0]) / det;
    Some((step, [alpha, beta, 1.0 - alpha - beta]))
}
