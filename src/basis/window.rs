//! The basis functions that live at one parameter, with derivatives.
//!
//! Piegl & Tiller, *The NURBS Book*, algorithms A2.2 and A2.3, for orders 0, 1 and 2.

use super::{KnotVector, MAX_DEGREE, Side};

const WIDTH: usize = MAX_DEGREE + 1;

/// `degree + 1` basis functions at a parameter: everything else is zero there.
#[derive(Clone, Copy, Debug)]
pub struct BasisWindow {
    /// Column of the first value, in the stored (extended) basis; take it modulo the control count when periodic.
    pub first: usize,
    /// Number of values, `degree + 1`.
    pub len: usize,
    values: [f64; WIDTH],
    first_derivatives: [f64; WIDTH],
    second_derivatives: [f64; WIDTH],
}

impl BasisWindow {
    /// Basis values, `degree + 1`.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.len]
    }

    /// First derivatives, `degree + 1`.
    pub fn first_derivatives(&self) -> &[f64] {
        &self.first_derivatives[..self.len]
    }

    /// Second derivatives, `degree + 1`.
    pub fn second_derivatives(&self) -> &[f64] {
        &self.second_derivatives[..self.len]
    }

    /// Values of derivative `order` (0, 1 or 2).
    pub fn order(&self, order: usize) -> &[f64] {
        match order {
            0 => self.values(),
            1 => self.first_derivatives(),
            _ => self.second_derivatives(),
        }
    }
}

impl KnotVector {
    /// The basis window at `u` (confined to the domain), seen from the right; see [`KnotVector::window_from`].
    pub fn window(&self, u: f64) -> BasisWindow {
        self.window_from(u, Side::Right)
    }

    /// The basis window at `u`, seen from one side, with first and second derivatives.
    pub fn window_from(&self, u: f64, side: Side) -> BasisWindow {
        let u = self.confine(u);
        let p = self.degree();
        let i = self.span(u, side);
        let t = self.knots();
        let (mut left, mut right) = ([0.0; WIDTH], [0.0; WIDTH]);
        // n[k][j]: value j of degree k, for the last three degrees only, which the derivatives need.
        let mut values = [0.0; WIDTH];
        let (mut lower, mut lowest) = ([0.0; WIDTH], [0.0; WIDTH]);
        values[0] = 1.0;
        for j in 1..=p {
            lowest = lower;
            lower = values;
            left[j] = u - t[i + 1 - j];
            right[j] = t[i + j] - u;
            let mut saved = 0.0;
            for r in 0..j {
                let quotient = lower[r] / (right[r + 1] + left[j - r]);
                values[r] = saved + right[r + 1] * quotient;
                saved = left[j - r] * quotient;
            }
            values[j] = saved;
        }
        let mut first_derivatives = [0.0; WIDTH];
        let mut second_derivatives = [0.0; WIDTH];
        difference(t, i, p, p, &lower, &mut first_derivatives);
        if p >= 2 {
            let mut inner = [0.0; WIDTH];
            difference(t, i, p - 1, p - 1, &lowest, &mut inner);
            difference(t, i, p, p, &inner, &mut second_derivatives);
        }
        BasisWindow { first: i - p, len: p + 1, values, first_derivatives, second_derivatives }
    }
}

/// Derivative of degree-`k` functions from degree `k - 1`: N'_{i,k} = k (N_{i,k-1} / Δ_i − N_{i+1,k-1} / Δ_{i+1}), eq. 2.7.
fn difference(t: &[f64], span: usize, k: usize, len: usize, lower: &[f64; WIDTH], out: &mut [f64; WIDTH]) {
    for j in 0..=len {
        let column = span + j - k;
        let mut sum = 0.0;
        if j > 0 {
            sum += lower[j - 1] / (t[column + k] - t[column]);
        }
        if j < len {
            sum -= lower[j] / (t[column + k + 1] - t[column + 1]);
        }
        out[j] = k as f64 * sum;
    }
}
