//! Polynomials on [0, 1] in Bernstein form with interval coefficients: sums, products, derivatives.
//!
//! p(t) = Σ a_i B_i^m(t). With products, (a b)_k = Σ_{i+j=k} C(m,i) C(n,j) / C(m+n,k) a_i b_j:
//! every factor is positive, so nothing cancels that does not cancel in the polynomials themselves
//! (Farouki & Rajan 1988).

use super::Interval;

/// A polynomial in one variable. At least one coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Bernstein {
    coefficients: Vec<Interval>,
}

impl Bernstein {
    /// From `degree + 1` coefficients. An empty list is the zero polynomial.
    pub fn new(mut coefficients: Vec<Interval>) -> Self {
        if coefficients.is_empty() {
            coefficients.push(Interval::ZERO);
        }
        Self { coefficients }
    }

    /// The polynomial 1, written in a degree.
    pub fn one(degree: usize) -> Self {
        Self {
            coefficients: vec![Interval::point(1.0); degree + 1],
        }
    }

    /// Nominal degree.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Coefficients, `degree + 1`.
    pub fn coefficients(&self) -> &[Interval] {
        &self.coefficients
    }

    /// The product, of the sum of the degrees.
    pub fn times(&self, other: &Self) -> Self {
        let (m, n) = (self.degree(), other.degree());
        let weights = ProductWeights::new(m, n);
        let mut out = vec![Interval::ZERO; m + n + 1];
        for (i, &a) in self.coefficients.iter().enumerate() {
            for (j, &b) in other.coefficients.iter().enumerate() {
                out[i + j] = out[i + j] + (a * b).scaled(weights.at(i, j), weights.slack);
            }
        }
        Self { coefficients: out }
    }

    /// The sum, of the larger degree.
    pub fn plus(&self, other: &Self) -> Self {
        let degree = self.degree().max(other.degree());
        let (a, b) = (self.elevated(degree), other.elevated(degree));
        Self {
            coefficients: a
                .coefficients
                .iter()
                .zip(&b.coefficients)
                .map(|(&a, &b)| a + b)
                .collect(),
        }
    }

    /// The difference, of the larger degree.
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    /// Times a number.
    pub fn scaled(&self, factor: f64) -> Self {
        let factor = Interval::point(factor);
        Self {
            coefficients: self.coefficients.iter().map(|&a| a * factor).collect(),
        }
    }

    /// Returns this polynomial in a degree at least its own.
    pub fn elevated(&self, degree: usize) -> Self {
        debug_assert!(degree >= self.degree(), "elevation goes up");
        if degree == self.degree() {
            self.clone()
        } else {
            self.times(&Self::one(degree - self.degree()))
        }
    }

    /// The derivative by t.
    pub fn derivative(&self) -> Self {
        let m = Interval::point(self.degree() as f64);
        Self::new(
            self.coefficients
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) * m)
                .collect(),
        )
    }

    /// p(t) / t for a polynomial whose first coefficient is zero in exact arithmetic: what stands
    /// there is dropped.
    pub fn without_root_at_zero(&self) -> Self {
        let m = self.degree() as f64;
        let quotient = self.coefficients.iter().enumerate().skip(1);
        Self::new(
            quotient
                .map(|(i, &a)| a.scaled(m / i as f64, f64::EPSILON))
                .collect(),
        )
    }

    /// The value by de Casteljau's algorithm from the middles of the coefficients.
    pub fn value(&self, t: f64) -> f64 {
        let mut line: Vec<f64> = self.coefficients.iter().map(|a| a.mid()).collect();
        for count in (1..line.len()).rev() {
            for i in 0..count {
                line[i] += t * (line[i + 1] - line[i]);
            }
        }
        line[0]
    }

    /// The part on [start, end], again over [0, 1]. The ends may be a little outside [0, 1].
    pub fn part(&self, start: f64, end: f64) -> Self {
        let mut line = self.coefficients.clone();
        let m = self.degree();
        if end != 1.0 {
            for r in 1..=m {
                for i in (r..=m).rev() {
                    line[i] = line[i - 1].lerp(line[i], end);
                }
            }
        }
        if start != 0.0 {
            let start = start / end;
            for r in 1..=m {
                for i in 0..=m - r {
                    line[i] = line[i].lerp(line[i + 1], start);
                }
            }
        }
        Self { coefficients: line }
    }
}

/// C(m,i) C(n,j) / C(m+n,i+j) for all i, j.
pub(super) struct ProductWeights {
    first: Vec<f64>,
    second: Vec<f64>,
    whole: Vec<f64>,
    /// Relative error of a weight at most.
    pub slack: f64,
}

impl ProductWeights {
    pub fn new(m: usize, n: usize) -> Self {
        // Binomials are exact below 2^53, that is up to degree 50; beyond, two roundings a factor.
        let steps = if m + n <= 50 {
            4.0
        } else {
            6.0 * (m + n) as f64
        };
        let slack = steps * f64::EPSILON;
        Self {
            first: binomials(m),
            second: binomials(n),
            whole: binomials(m + n),
            slack,
        }
    }

    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.first[i] * self.second[j] / self.whole[i + j]
    }
}

/// C(n, 0) … C(n, n).
pub fn binomials(n: usize) -> Vec<f64> {
    let mut row = Vec::with_capacity(n + 1);
    let mut value = 1.0;
    for k in 0..=n {
        row.push(value);
        value = value * (n - k) as f64 / (k + 1) as f64;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn random_polynomial(random: &mut Random, degree: usize) -> Bernstein {
        Bernstein::new(
            (0..=degree)
                .map(|_| Interval::point(random.float(-1.0, 1.0)))
                .collect(),
        )
    }

    #[test]
    fn operations_agree_with_values() {
        let mut random = Random(3);
        for _ in 0..300 {
            let (m, n) = (random.integer(0, 9), random.integer(0, 9));
            let (a, b) = (
                random_polynomial(&mut random, m),
                random_polynomial(&mut random, n),
            );
            let t = random.float(0.0, 1.0);
            let (x, y) = (a.value(t), b.value(t));
            assert!((a.times(&b).value(t) - x * y).abs() < 1e-14);
            assert!((a.plus(&b).value(t) - (x + y)).abs() < 1e-14);
            assert!((a.minus(&b).value(t) - (x - y)).abs() < 1e-14);
            let h = 1e-6;
            let slope = (a.value(t + h) - a.value(t - h)) / (2.0 * h);
            assert!((a.derivative().value(t) - slope).abs() < 1e-7, "{slope}");
            let (start, end) = (0.2 * t, 0.9);
            let part = a.part(start, end);
            assert!((part.value(0.3) - a.value(start + 0.3 * (end - start))).abs() < 1e-14);
        }
    }

    #[test]
    fn dividing_by_t_undoes_multiplying_by_it() {
        let mut random = Random(4);
        let t = Bernstein::new(vec![Interval::ZERO, Interval::point(1.0)]);
        for degree in 0..8 {
            let a = random_polynomial(&mut random, degree);
            let again = a.times(&t).without_root_at_zero();
            for (x, y) in a.coefficients().iter().zip(again.coefficients()) {
                assert!(y.lo <= x.lo && x.hi <= y.hi && y.radius() < 1e-14);
            }
        }
    }
}
