//! Polynomials in two variables on [0, 1]², tensor-product Bernstein form with interval
//! coefficients.

use super::bernstein::ProductWeights;
use super::{Bernstein, Interval};

/// f(s, t) = Σ c_ij B_i^p(s) B_j^q(t), rows in s.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    degree: [usize; 2],
    coefficients: Vec<Interval>,
}

impl Tensor {
    /// From `(p + 1)(q + 1)` coefficients, row after row.
    pub fn new(degree: [usize; 2], coefficients: Vec<Interval>) -> Self {
        debug_assert_eq!(
            coefficients.len(),
            (degree[0] + 1) * (degree[1] + 1),
            "coefficients and degree disagree"
        );
        Self {
            degree,
            coefficients,
        }
    }

    /// a(s) b(t).
    pub fn outer(a: &Bernstein, b: &Bernstein) -> Self {
        let coefficients = a
            .coefficients()
            .iter()
            .flat_map(|&x| b.coefficients().iter().map(move |&y| x * y))
            .collect();
        Self {
            degree: [a.degree(), b.degree()],
            coefficients,
        }
    }

    /// Nominal degrees in s and t.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Coefficients, row after row.
    pub fn coefficients(&self) -> &[Interval] {
        &self.coefficients
    }

    /// f(t, s).
    pub fn swapped(&self) -> Self {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| self.coefficients[i * (q + 1) + j];
        let coefficients = (0..=q)
            .flat_map(|j| (0..=p).map(move |i| at(i, j)))
            .collect();
        Self {
            degree: [q, p],
            coefficients,
        }
    }

    /// f(s, t) a(s).
    pub fn times_in_s(&self, a: &Bernstein) -> Self {
        let ([p, q], m) = (self.degree, a.degree());
        let weights = ProductWeights::new(p, m);
        let mut out = vec![Interval::ZERO; (p + m + 1) * (q + 1)];
        for i in 0..=p {
            for (k, &factor) in a.coefficients().iter().enumerate() {
                let factor = factor.scaled(weights.at(i, k), weights.slack);
                for j in 0..=q {
                    let place = (i + k) * (q + 1) + j;
                    out[place] = out[place] + self.coefficients[i * (q + 1) + j] * factor;
                }
            }
        }
        Self {
            degree: [p + m, q],
            coefficients: out,
        }
    }

    /// f(s, t) a(t).
    pub fn times_in_t(&self, a: &Bernstein) -> Self {
        self.swapped().times_in_s(a).swapped()
    }

    /// The sum, both of the same degrees.
    pub fn plus(mut self, other: &Self) -> Self {
        debug_assert_eq!(self.degree, other.degree, "sums are of equal degree");
        for (a, &b) in self.coefficients.iter_mut().zip(&other.coefficients) {
            *a = *a + b;
        }
        self
    }

    /// The difference, both of the same degrees.
    pub fn minus(mut self, other: &Self) -> Self {
        debug_assert_eq!(self.degree, other.degree, "differences are of equal degree");
        for (a, &b) in self.coefficients.iter_mut().zip(&other.coefficients) {
            *a = *a - b;
        }
        self
    }

    /// Returns this polynomial in degrees at least its own.
    pub fn elevated(&self, degree: [usize; 2]) -> Self {
        let [p, q] = self.degree;
        let in_s = if degree[0] > p {
            self.times_in_s(&Bernstein::one(degree[0] - p))
        } else {
            self.clone()
        };
        if degree[1] > q {
            in_s.times_in_t(&Bernstein::one(degree[1] - q))
        } else {
            in_s
        }
    }

    /// True when all coefficients are of one sign: no root on [0, 1]².
    pub fn has_sign(&self) -> bool {
        self.coefficients.iter().all(|a| a.lo > 0.0) || self.coefficients.iter().all(|a| a.hi < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid;
    use super::*;
    use palpate_geometry::math::Random;

    fn value(f: &Tensor, at: [f64; 2]) -> f64 {
        let middles: Vec<f64> = f.coefficients().iter().map(|a| a.mid()).collect();
        grid::value_and_gradient(&middles, f.degree(), at).0
    }

    #[test]
    fn operations_agree_with_values() {
        let mut random = Random(7);
        for _ in 0..200 {
            let (p, q, m) = (
                random.integer(0, 6),
                random.integer(0, 6),
                random.integer(0, 6),
            );
            let mut points = |n: usize| {
                (0..n)
                    .map(|_| Interval::point(random.float(-1.0, 1.0)))
                    .collect::<Vec<_>>()
            };
            let f = Tensor::new([p, q], points((p + 1) * (q + 1)));
            let a = Bernstein::new(points(m + 1));
            let at = [random.float(0.0, 1.0), random.float(0.0, 1.0)];
            let close = |x: f64, y: f64| assert!((x - y).abs() < 1e-13, "{x} is not {y}");
            close(value(&f.times_in_s(&a), at), value(&f, at) * a.value(at[0]));
            close(value(&f.times_in_t(&a), at), value(&f, at) * a.value(at[1]));
            close(value(&f.swapped(), [at[1], at[0]]), value(&f, at));
            close(value(&f.elevated([p + 3, q + 1]), at), value(&f, at));
            close(
                value(&Tensor::outer(&a, &a), at),
                a.value(at[0]) * a.value(at[1]),
            );
            close(value(&f.clone().plus(&f), at), 2.0 * value(&f, at));
            close(value(&f.clone().minus(&f), at), 0.0);
        }
    }
}
