//! Two equations in two variables, ready to be solved.

use super::{Tensor, grid};

/// f₀(s, t) = 0 and f₁(s, t) = 0 on [0, 1]², both in the same degrees.
///
/// Coefficients are middles with one bound for the rounding of all of them (intervals in
/// midpoint-radius form): a step of de Casteljau's algorithm is a convex combination, so it leaves
/// the bound as it is and adds its own rounding.
#[derive(Clone, Debug)]
pub struct System {
    /// Degrees in s and t.
    pub(super) degree: [usize; 2],
    /// Coefficients, row after row, largest about 1.
    pub(super) f: [Vec<f64>; 2],
    /// No exact coefficient is further from its middle.
    pub(super) noise: [f64; 2],
}

impl System {
    /// From two polynomials, elevated to common degrees.
    pub fn new(f: &Tensor, g: &Tensor) -> Self {
        let degree = [
            f.degree()[0].max(g.degree()[0]),
            f.degree()[1].max(g.degree()[1]),
        ];
        let mut noise = [0.0; 2];
        let mut k = 0;
        let f = [f, g].map(|tensor| {
            let tensor = tensor.elevated(degree);
            let largest = tensor
                .coefficients()
                .iter()
                .fold(0.0, |most: f64, a| most.max(a.magnitude()));
            let scale = if largest > 0.0 {
                power_of_two_below(largest).recip()
            } else {
                1.0
            };
            let radius = tensor
                .coefficients()
                .iter()
                .fold(0.0, |most: f64, a| most.max(a.radius()));
            noise[k] = radius * scale;
            k += 1;
            tensor
                .coefficients()
                .iter()
                .map(|a| a.mid() * scale)
                .collect()
        });
        Self { degree, f, noise }
    }

    /// The residuals at a point and their gradients: middles.
    pub(super) fn at(&self, at: [f64; 2]) -> [(f64, [f64; 2]); 2] {
        [0, 1].map(|k| grid::value_and_gradient(&self.f[k], self.degree, at))
    }

    /// The point near `from` where the residuals are smallest: Gauss-Newton steps by the
    /// pseudo-inverse, so that it also walks to the nearest point of a curve of roots. Stays in the
    /// box.
    pub fn settle(&self, from: [f64; 2], low: [f64; 2], high: [f64; 2]) -> [f64; 2] {
        let mut at = from;
        for _ in 0..30 {
            let [(f, df), (g, dg)] = self.at(at);
            let step = least_norm_step([df, dg], [f, g]);
            let next = [0, 1].map(|k| (at[k] - step[k]).clamp(low[k], high[k]));
            let moved = (next[0] - at[0]).abs().max((next[1] - at[1]).abs());
            at = next;
            if moved < 1e-16 {
                break;
            }
        }
        at
    }
}

/// A power of two no larger than `x`, not so small that its inverse overflows: dividing by it is
/// exact.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.max(1e-290).to_bits() & 0x7ff0_0000_0000_0000)
}

/// The shortest x with least |J x − r|. Singular values below 1e-6 of the larger count as zero.
pub(super) fn least_norm_step([a, b]: [[f64; 2]; 2], r: [f64; 2]) -> [f64; 2] {
    // One Jacobi rotation makes the rows orthogonal.
    let (aa, bb, ab) = (
        a[0] * a[0] + a[1] * a[1],
        b[0] * b[0] + b[1] * b[1],
        a[0] * b[0] + a[1] * b[1],
    );
    let (mut c, mut s) = (1.0, 0.0);
    if ab != 0.0 {
        let zeta = (bb - aa) / (2.0 * ab);
        let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
        c = 1.0 / (1.0 + tangent * tangent).sqrt();
        s = c * tangent;
    }
    let rows = [
        [c * a[0] - s * b[0], c * a[1] - s * b[1]],
        [s * a[0] + c * b[0], s * a[1] + c * b[1]],
    ];
    let sides = [c * r[0] - s * r[1], s * r[0] + c * r[1]];
    let squares = rows.map(|row| row[0] * row[0] + row[1] * row[1]);
    let least = 1e-12 * squares[0].max(squares[1]);
    let mut x = [0.0; 2];
    for k in 0..2 {
        if squares[k] > least {
            for axis in 0..2 {
                x[axis] += rows[k][axis] * (sides[k] / squares[k]);
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_norm_steps_solve_regular_and_singular_systems() {
        let x = least_norm_step([[2.0, 1.0], [1.0, -3.0]], [4.0, -5.0]);
        assert!(
            (x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15,
            "{x:?}"
        );
        let x = least_norm_step([[1.0, 1.0], [2.0, 2.0]], [2.0, 4.0]);
        assert!(
            (x[0] - 1.0).abs() < 1e-15 && (x[1] - 1.0).abs() < 1e-15,
            "{x:?}"
        );
        assert_eq!(least_norm_step([[0.0; 2]; 2], [1.0, 1.0]), [0.0, 0.0]);
    }
}
