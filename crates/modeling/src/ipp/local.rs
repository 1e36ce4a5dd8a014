//! A box in its own coordinates [0, 1]²: preconditioning, uniqueness, Newton's method, Krawczyk's
//! test.
//!
//! With Y near the inverse of the mean Jacobian of (f₀, f₁) the combinations h = Y f are nearly (s
//! − s₀, t − t₀). Let L bound |1 − H'| in the maximum norm over the box. If L < 1, h has at most
//! one root there; and a ball of radius ρ ≥ |h(x)| / (1 − L) around x that lies in the box holds
//! one (Krawczyk 1969; Rump 2010, theorem 13.3).

use super::grid;

/// The two equations on one box.
pub(super) struct Local<'a> {
    pub degree: [usize; 2],
    pub f: [&'a [f64]; 2],
    pub noise: [f64; 2],
}

/// Y f, in buffers that are used again.
#[derive(Default)]
pub(super) struct Preconditioned {
    pub h: [Vec<f64>; 2],
    pub noise: [f64; 2],
    y: [[f64; 2]; 2],
    /// L: below 1 there is at most one root in the box.
    pub contraction: f64,
}

/// A proved root in coordinates of the box.
pub(super) struct Proved {
    pub at: [f64; 2],
    pub radius: f64,
}

impl Local<'_> {
    /// True when one of the equations has no root in the box.
    pub fn excluded(&self) -> bool {
        (0..2).any(|k| has_sign(self.f[k], self.noise[k]))
    }

    /// For each equation, true when nothing but rounding is left. Four times the bound: a box at
    /// the edge of what can be excluded would else be cut to dust, each part a hair above the
    /// bound.
    pub fn unresolvable(&self) -> [bool; 2] {
        [0, 1].map(|k| self.f[k].iter().all(|c| c.abs() <= 4.0 * self.noise[k]))
    }

    /// Fills `to`; false where the mean Jacobian is singular.
    pub fn precondition(&self, to: &mut Preconditioned) -> bool {
        let [[fs, ft], [gs, gt]] = [0, 1].map(|k| mean_gradient(self.f[k], self.degree));
        let det = fs * gt - ft * gs;
        let size = (fs.abs() + ft.abs()) * (gs.abs() + gt.abs());
        if det.is_nan() || det.abs() <= 1e-12 * size {
            to.contraction = f64::INFINITY;
            return false;
        }
        to.y = [[gt / det, -ft / det], [-gs / det, fs / det]];
        let most = [0, 1].map(|k| self.f[k].iter().fold(0.0, |most: f64, c| most.max(c.abs())));
        for k in 0..2 {
            let [a, b] = to.y[k];
            to.h[k].clear();
            to.h[k].extend(self.f[0].iter().zip(self.f[1]).map(|(f, g)| a * f + b * g));
            to.noise[k] = a.abs() * (self.noise[0] + 2.0 * f64::EPSILON * most[0])
                + b.abs() * (self.noise[1] + 2.0 * f64::EPSILON * most[1]);
        }
        to.contraction = to.contraction(self.degree);
        true
    }

    /// Newton's method from the middle, then Krawczyk's test. `None` where the ball is not inside
    /// the box.
    pub fn prove(&self, h: &Preconditioned) -> Option<Proved> {
        let mut at = [0.5; 2];
        for _ in 0..12 {
            let [(f, df), (g, dg)] =
                [0, 1].map(|k| grid::value_and_gradient(self.f[k], self.degree, at));
            let det = df[0] * dg[1] - df[1] * dg[0];
            let step = [(f * dg[1] - g * df[1]) / det, (g * df[0] - f * dg[0]) / det];
            at = [at[0] - step[0], at[1] - step[1]];
            // Also false for NaN.
            let near = |x: f64| (x - 0.5).abs() < 0.75;
            if !(near(at[0]) && near(at[1])) {
                return None;
            }
            if step[0].abs().max(step[1].abs()) < 1e-15 {
                break;
            }
        }
        let values = [0, 1].map(|k| grid::value_and_gradient(self.f[k], self.degree, at).0);
        // The evaluation adds a rounding for each of its steps, of values no larger than the
        // largest coefficient.
        let steps = 8.0 * (self.degree[0] + self.degree[1] + 4) as f64 * f64::EPSILON;
        let residual = (0..2).fold(0.0, |most: f64, k| {
            let [a, b] = h.y[k];
            let rounding = steps * h.h[k].iter().fold(0.0, |most: f64, c| most.max(c.abs()));
            most.max((a * values[0] + b * values[1]).abs() + h.noise[k] + rounding)
        });
        let radius = 1.01 * residual / (1.0 - h.contraction);
        let inside = |x: f64| x - radius > 0.0 && x + radius < 1.0;
        (inside(at[0]) && inside(at[1])).then_some(Proved { at, radius })
    }
}

impl Preconditioned {
    /// A bound of |1 − H'| from the differences of neighbouring coefficients.
    fn contraction(&self, [p, q]: [usize; 2]) -> f64 {
        let mut worst = 0.0_f64;
        for k in 0..2 {
            let (c, noise) = (&self.h[k], 2.0 * self.noise[k]);
            let (mut s, mut t) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64));
            let wide = |range: &mut (f64, f64), x: f64| *range = (range.0.min(x), range.1.max(x));
            let width = q + 1;
            let start = |range: &mut (f64, f64)| *range = (f64::INFINITY, f64::NEG_INFINITY);
            if p > 0 {
                start(&mut s);
                for i in width..c.len() {
                    wide(&mut s, c[i] - c[i - width]);
                }
                s = (p as f64 * (s.0 - noise), p as f64 * (s.1 + noise));
            }
            if q > 0 {
                start(&mut t);
                for row in c.chunks(width) {
                    for pair in row.windows(2) {
                        wide(&mut t, pair[1] - pair[0]);
                    }
                }
                t = (q as f64 * (t.0 - noise), q as f64 * (t.1 + noise));
            }
            let off = |range: (f64, f64), wanted: f64| {
                (range.0 - wanted).abs().max((range.1 - wanted).abs())
            };
            let (own, other) = if k == 0 { (s, t) } else { (t, s) };
            worst = worst.max(off(own, 1.0) + off(other, 0.0));
        }
        worst
    }

    /// True when one of the combinations has no root in the box.
    pub fn excluded(&self) -> bool {
        (0..2).any(|k| has_sign(&self.h[k], self.noise[k]))
    }
}

fn has_sign(c: &[f64], noise: f64) -> bool {
    let (low, high) = c
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        });
    low > noise || high < -noise
}

/// The mean of the gradient along the edges: what the corner rows and columns of the coefficients
/// say.
fn mean_gradient(c: &[f64], [p, q]: [usize; 2]) -> [f64; 2] {
    let width = q + 1;
    let last = p * width;
    let s: f64 = (0..width).map(|j| c[last + j] - c[j]).sum::<f64>() / width as f64;
    let t: f64 = c.chunks(width).map(|row| row[q] - row[0]).sum::<f64>() / (p + 1) as f64;
    [s, t]
}
