//! Climbs to a local maximum of a depth over the surface's parameters, without derivatives of it.
//!
//! Newton on central differences where the depth is smooth: at a maximum an error of the place
//! counts squared, so nine digits of depth need five of the place. Where it has kinks (edges of a
//! box, creases of the surface), a cross of shrinking steps in turning directions comes near, and
//! golden sections within golden sections finish: the greatest value along one parameter, as a
//! function of the other, has one maximum too, however sharp a ridge runs through both.

use super::golden::greatest;
use crate::surface::{Closing, Surface, Topology};
use nalgebra::{Matrix2, Vector2};

/// The surface's parameters, going on over seams.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    pub domain: [(f64, f64); 2],
    pub wraps: [bool; 2],
    pub poles: [[bool; 2]; 2],
    /// Mean width of a span.
    pub spans: [f64; 2],
}

/// How a climb ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClimbTop {
    pub at: [f64; 2],
    pub height_m: f64,
    /// Smooth there, and as exact as it gets; else [`Map::finish`] is worth its price.
    pub settled: bool,
}

/// Less than this of the size in a step is no gain.
const GAIN: f64 = 1e-12;
/// Nor is this in a window: depth is exact to 1e-9, a place is not where depth is level.
const LEVEL_WINDOW: f64 = 1e-10;
/// A second difference less than this of the size is none.
const LEVEL: f64 = 1e-13;
/// Steps one after the other that may lead beyond where the height means something.
const PATIENCE: usize = 3;
/// Newton steps, and steps of the cross.
const NEWTON: usize = 24;
/// The longest of Newton's steps, in spans.
const LONGEST: f64 = 0.25;
/// A step gains at least this of what the slope says.
const FAIR: f64 = 0.1;
const ROUNDS: usize = 60;
/// Where the cross leaves off at a kink, in spans, and half the window that is searched from there.
const NEAR: f64 = 1e-6;
const WINDOW: f64 = 8e-3;
/// Windows looked at, each twice as wide, while the top is at the edge of the last.
const WINDOWS: usize = 4;
/// Steps of a golden section: 0.62³⁴ of the window is 1e-9 of a span.
const SECTIONS: usize = 34;
/// Steps of differences, in spans: rounding over step² and step² itself balance for Newton's
/// purpose.
const DIFFERENCE: f64 = 2e-4;

impl Map {
    pub fn new(surface: &Surface) -> Self {
        let topology: Topology = surface.topology();
        let knots = [surface.knots_u(), surface.knots_v()];
        let domain = knots.map(|k| k.domain());
        Self {
            domain,
            wraps: topology.closing.map(|c| c != Closing::Open),
            poles: topology.poles,
            spans: std::array::from_fn(|k| {
                (domain[k].1 - domain[k].0) / knots[k].spans().count() as f64
            }),
        }
    }

    /// Of a patch of a branching surface: its edges hold, and the domain's poles count where they
    /// are its own.
    pub fn within(&self, patch: [[f64; 2]; 2]) -> Self {
        let pole = |d: usize, e: usize| {
            self.poles[d][e] && patch[d][e] == [self.domain[d].0, self.domain[d].1][e]
        };
        Self {
            domain: patch.map(|[a, b]| (a, b)),
            wraps: [false; 2],
            poles: [0, 1].map(|d| [pole(d, 0), pole(d, 1)]),
            spans: self.spans,
        }
    }

    /// A parameter that may have left the domain: round where that leads on, else held.
    pub fn turn(&self, x: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| {
            let (a, b) = self.domain[k];
            if x[k] >= a && x[k] <= b {
                x[k]
            } else if self.wraps[k] && x[k].is_finite() {
                (a + (x[k] - a).rem_euclid(b - a)).clamp(a, b)
            } else {
                x[k].clamp(a, b)
            }
        })
    }

    /// The direction (0 or 1) along which a place is at a collapsed edge, and the way inwards.
    fn pole(&self, x: [f64; 2]) -> Option<(usize, f64)> {
        (0..2).find_map(|k| {
            let (a, b) = self.domain[k];
            let reach = 1e-9 * (b - a);
            if self.poles[k][0] && x[k] <= a + reach {
                Some((k, 1.0))
            } else if self.poles[k][1] && x[k] >= b - reach {
                Some((k, -1.0))
            } else {
                None
            }
        })
    }

    /// The local maximum above a start. `height` gives −∞ where it means nothing; `size_m`: what digits are relative to;
    /// `beyond`: where the height is no longer that of the solid. `None` where the top is there.
    pub fn climb(
        &self,
        start: [f64; 2],
        size_m: f64,
        mut height: impl FnMut([f64; 2]) -> f64,
        beyond: impl Fn([f64; 2]) -> bool,
    ) -> Option<ClimbTop> {
        let mut top = ClimbTop {
            at: self.turn(start),
            height_m: 0.0,
            settled: false,
        };
        top.height_m = height(top.at);
        top.settled = self.newton(&mut top, size_m, &mut height, &beyond)?;
        let smooth = top;
        let flat = self.cross(&mut top, size_m, smooth.settled, &mut height, &beyond)?;
        // What Newton took for a top was none when a cross of steps finds better; where curvature jumps, it finds none.
        top.settled = match smooth.settled {
            true => top.height_m - smooth.height_m <= LEVEL_WINDOW * size_m,
            false => flat,
        };
        (!beyond(top.at)).then_some(top)
    }

    /// Makes a top that is not settled exact.
    pub fn finish(&self, top: &mut ClimbTop, size_m: f64, height: impl Fn([f64; 2]) -> f64) {
        let mut window = WINDOW;
        for _ in 0..WINDOWS {
            let start = *top;
            let half = self.spans.map(|s| window * s);
            // Values between: each inner section is a function of the outer place.
            let inner = |u: f64| {
                let (v, value) = section(|v| {
                    height(self.turn([start.at[0] + u * half[0], start.at[1] + v * half[1]]))
                });
                (v, value)
            };
            let (u, value) = section(|u| inner(u).1);
            let (v, _) = inner(u);
            if value > top.height_m {
                top.at = self.turn([start.at[0] + u * half[0], start.at[1] + v * half[1]]);
                top.height_m = height(top.at);
            }
            // At the window's edge the top is beyond it, unless it is level there.
            if u.abs() < 0.9 && v.abs() < 0.9
                || top.height_m - start.height_m < LEVEL_WINDOW * size_m
            {
                break;
            }
            window *= 2.0;
        }
    }

    /// True when it arrived where the depth is smooth and bent down; `None` when it leads beyond.
    fn newton(
        &self,
        top: &mut ClimbTop,
        size_m: f64,
        height: &mut impl FnMut([f64; 2]) -> f64,
        beyond: &impl Fn([f64; 2]) -> bool,
    ) -> Option<bool> {
        let h = self.spans.map(|s| DIFFERENCE * s);
        let mut radius = LONGEST;
        let mut out = 0;
        for _ in 0..NEWTON {
            let mut at =
                |a: f64, b: f64| height(self.turn([top.at[0] + a * h[0], top.at[1] + b * h[1]]));
            let f = top.height_m;
            let (e, w, n, s) = (at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0));
            let mixed = 0.25 * (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0));
            let g = Vector2::new(0.5 * (e - w), 0.5 * (n - s));
            let bend = Matrix2::new(e - 2.0 * f + w, mixed, mixed, n - 2.0 * f + s);
            let (way, bent) = uphill(&g, &bend, LEVEL * size_m);
            let (mut x, mut y) = (way.x, way.y);
            if !(x.is_finite() && y.is_finite()) {
                return Some(false);
            }
            let limit = radius / DIFFERENCE;
            let longest = x.abs().max(y.abs());
            if longest > limit {
                (x, y) = (x * limit / longest, y * limit / longest);
            }
            let gain = g.x * x + g.y * y;
            // Depth is exact before its place is: this step is the last.
            let last = bent && gain.abs() <= LEVEL_WINDOW * size_m;
            let before = top.at;
            let (mut moved, mut left) = (false, false);
            // A start may be beyond, of which the top is not.
            let inside = !beyond(before);
            for attempt in 0..if last { 1 } else { 6 } {
                let next = self.turn([before[0] + x * h[0], before[1] + y * h[1]]);
                let value = height(next);
                // A last step gains no more than rounding.
                let fair = if last {
                    0.0
                } else {
                    FAIR * (g.x * x + g.y * y)
                };
                let better = value - top.height_m > fair;
                if better && !(inside && beyond(next)) {
                    *top = ClimbTop {
                        at: next,
                        height_m: value,
                        settled: false,
                    };
                    moved = true;
                    if attempt == 0 {
                        radius = LONGEST.min(2.0 * radius);
                    }
                    break;
                }
                left |= better;
                (x, y, radius) = (0.25 * x, 0.25 * y, (0.25 * radius).max(1e-3));
            }
            if last {
                return Some(true);
            }
            // Steps that lead beyond are cut, and end when they go on to.
            out = if left || !inside { out + 1 } else { 0 };
            if out > PATIENCE || left && !moved {
                return None;
            }
            if !moved {
                return Some(false);
            }
        }
        Some(false)
    }

    /// Steps in sixteen directions, shorter when none leads up. True when no step changes anything at the end; `None`
    /// when it leads beyond.
    fn cross(
        &self,
        top: &mut ClimbTop,
        size_m: f64,
        settled: bool,
        height: &mut impl FnMut([f64; 2]) -> f64,
        beyond: &impl Fn([f64; 2]) -> bool,
    ) -> Option<bool> {
        // After Newton only to make sure; else from steps that reach the next sample.
        let mut step: f64 = if settled { 1e-5 } else { 0.05 };
        let mut lean = 0.0;
        let mut out = 0;
        for _ in 0..ROUNDS {
            let before = *top;
            let mut change: f64 = 0.0;
            let pole = self.pole(before.at);
            for k in 0..16 {
                let next = match pole {
                    Some((d, inward)) => {
                        let mut x = before.at;
                        let (a, b) = self.domain[1 - d];
                        x[1 - d] = a + (b - a) * (k as f64 + 0.5) / 16.0;
                        x[d] += inward * step * self.spans[d];
                        x
                    }
                    None => {
                        let angle = std::f64::consts::PI * k as f64 / 8.0 + lean;
                        [
                            before.at[0] + step * self.spans[0] * libm::cos(angle),
                            before.at[1] + step * self.spans[1] * libm::sin(angle),
                        ]
                    }
                };
                let next = self.turn(next);
                let value = height(next);
                change = change.max((value - before.height_m).abs());
                if value > top.height_m + GAIN * size_m {
                    *top = ClimbTop {
                        at: next,
                        height_m: value,
                        settled: false,
                    };
                }
            }
            // Directions turn by the golden angle, so that a ridge is met from every side.
            lean += 2.399_963_229_728_653;
            if top.height_m > before.height_m {
                out = if beyond(top.at) { out + 1 } else { 0 };
                if out > PATIENCE {
                    return None;
                }
                step = (2.0 * step).min(0.1);
                continue;
            }
            if change <= GAIN * size_m {
                return Some(true);
            }
            if step < if settled { 1e-9 } else { NEAR } {
                break;
            }
            step *= if settled { 0.1 } else { 0.4 };
        }
        Some(false)
    }
}

/// Newton's step towards a maximum in units of the differences, and whether there is one: bent down in each direction or
/// level in it. Where it is bent up, the way that rises most.
fn uphill(g: &Vector2<f64>, bend: &Matrix2<f64>, level: f64) -> (Vector2<f64>, bool) {
    let steepest = || {
        let length = g.norm().max(f64::MIN_POSITIVE);
        (g / (length * DIFFERENCE), false)
    };
    if !bend.iter().chain(g.iter()).all(|x| x.is_finite()) {
        return steepest();
    }
    let eigen = bend.symmetric_eigen();
    let mut way = Vector2::zeros();
    for k in 0..2 {
        let (direction, bent) = (eigen.eigenvectors.column(k), eigen.eigenvalues[k]);
        let slope = direction.dot(g);
        let weakest = 1e-6 * eigen.eigenvalues.amax();
        if bent < -level.max(weakest) {
            way -= direction * (slope / bent);
        } else if bent > level || slope.abs() > level {
            return steepest();
        }
    }
    (way, true)
}

/// The place and value of the greatest value on [−1, 1].
fn section(value: impl Fn(f64) -> f64) -> (f64, f64) {
    greatest(-1.0, 1.0, SECTIONS, value)
}

/// Places between two others at which a ridge is looked at, twelfths, far ones first.
const WAY: [f64; 5] = [6.0, 3.0, 9.0, 1.0, 11.0];

impl Map {
    /// The shorter straight way from one place to another, perhaps over a seam.
    pub fn way(&self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| {
            let (direct, period) = (b[k] - a[k], self.domain[k].1 - self.domain[k].0);
            if self.wraps[k] {
                direct - period * (direct / period).round()
            } else {
                direct
            }
        })
    }

    /// A straight way between two places on which the height stays at or above `level`.
    pub fn joined(
        &self,
        a: [f64; 2],
        b: [f64; 2],
        level: f64,
        mut height: impl FnMut([f64; 2]) -> f64,
    ) -> bool {
        let way = self.way(a, b);
        WAY.into_iter().all(|t| {
            height(self.turn([a[0] + way[0] * t / 12.0, a[1] + way[1] * t / 12.0])) >= level
        })
    }
}
