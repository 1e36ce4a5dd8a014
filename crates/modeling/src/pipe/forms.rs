//! The polynomials of a piece in Bernstein form, as intervals.
//!
//! X = Σ w_i P_i B_i and W = Σ w_i B_i; the hodograph's numerator N = X'W − XW' (c' = N / W²) of
//! degree 2n − 2; the Wronskian K with c' × c'' = K / W³ of degree 3n − 6. Both come from control
//! point differences only, so that nothing depends on where the origin is:
//!
//! ```text
//! N_k = n Σ_{i+j=k} C(n−1,i) C(n−1,j) / C(2n−2,k)  w_i w_{j+1} (P_{j+1} − P_i)
//! K_l = n²(n−1) Σ_{i+j+k=l} C(n−2,i) C(n−2,j) C(n−2,k) / C(3n−6,l)  w_i w_{j+1} w_{k+2} (P_{j+1} − P_i) × (P_{k+2} − P_i)
//! ```
//! K is the exterior product of the three points that de Casteljau's algorithm leaves before its
//! last two steps; the factor W that N × N' = W K carries never appears, and the degree of the
//! curvature's derivative falls from 13n − 15 to 11n − 17.

use super::piece::Piece;
use crate::ipp::{Bernstein, Interval, Tensor, binomials};

/// Control points are as exact as knot insertion leaves them: a few roundings of coordinates of
/// size 1. Roots at joints are kept by it, whichever of the two pieces rounding moves them to.
const COORDINATE_ERROR: f64 = 4.0 * f64::EPSILON;

/// Relative error of a factor of a few binomials, which are exact up to the degrees that splines
/// have.
const SLACK: f64 = 8.0 * f64::EPSILON;

/// A vector of polynomials.
pub(super) type Bernstein3 = [Bernstein; 3];

/// What the equations of a piece are made of.
#[derive(Clone, Debug)]
pub(super) struct Forms {
    /// Degree of the piece, n.
    pub degree: usize,
    /// Control points P_i.
    pub points: Vec<[Interval; 3]>,
    /// Weights w_i.
    pub weights: Vec<Interval>,
    /// Numerator N of the hodograph c' = N / W².
    pub hodograph: Bernstein3,
}

impl Forms {
    pub fn new(piece: &Piece) -> Self {
        let n = piece.degree();
        let near = |p: &f64| Interval::around(*p, COORDINATE_ERROR);
        let points: Vec<[Interval; 3]> = piece
            .points
            .iter()
            .map(|p| [near(&p.x), near(&p.y), near(&p.z)])
            .collect();
        let weights: Vec<Interval> = piece
            .weights
            .iter()
            .map(|&w| Interval::around(w, 4.0 * f64::EPSILON * w))
            .collect();
        let (c, whole) = (binomials(n - 1), binomials(2 * n - 2));
        let mut sums = [0, 1, 2].map(|_| vec![Interval::ZERO; 2 * n - 1]);
        for i in 0..n {
            for j in 0..n {
                let factor = n as f64 * c[i] * c[j] / whole[i + j];
                let weight = (weights[i] * weights[j + 1]).scaled(factor, SLACK);
                for (axis, sum) in sums.iter_mut().enumerate() {
                    sum[i + j] = sum[i + j] + (points[j + 1][axis] - points[i][axis]) * weight;
                }
            }
        }
        Self {
            degree: n,
            points,
            weights,
            hodograph: sums.map(Bernstein::new),
        }
    }

    /// Weight polynomial W.
    pub fn weight(&self) -> Bernstein {
        Bernstein::new(self.weights.clone())
    }

    /// K; `None` for a straight line of degree 1.
    pub fn wronskian(&self) -> Option<Bernstein3> {
        let n = self.degree;
        if n < 2 {
            return None;
        }
        let (c, whole) = (binomials(n - 2), binomials(3 * n - 6));
        let mut sums = [0, 1, 2].map(|_| vec![Interval::ZERO; 3 * n - 5]);
        let from = |i: usize, j: usize| -> [Interval; 3] {
            [0, 1, 2].map(|a| self.points[j][a] - self.points[i][a])
        };
        for i in 0..=n - 2 {
            for j in 0..=n - 2 {
                let first = from(i, j + 1);
                for k in 0..=n - 2 {
                    let factor = (n * n * (n - 1)) as f64 * c[i] * c[j] * c[k] / whole[i + j + k];
                    let weight = self.weights[i] * self.weights[j + 1] * self.weights[k + 2];
                    let weight = weight.scaled(factor, SLACK);
                    let normal = cross(first, from(i, k + 2));
                    for (axis, sum) in sums.iter_mut().enumerate() {
                        sum[i + j + k] = sum[i + j + k] + normal[axis] * weight;
                    }
                }
            }
        }
        Some(sums.map(Bernstein::new))
    }

    /// G(s, t) = [X(s)W(t) − X(t)W(s)] / (s − t), of degree (n − 1, n − 1): the Bezoutian of X and
    /// W for each coordinate, in Bernstein form (Bini & Gemignani 2004).
    pub fn bezoutian(&self) -> [Tensor; 3] {
        let n = self.degree;
        [0, 1, 2].map(|axis| {
            let difference = |i: usize, j: usize| {
                self.weights[i] * self.weights[j] * (self.points[i][axis] - self.points[j][axis])
            };
            // b[i − 1][j] of the paper's 1-based recursion, which looks one row ahead and one
            // column back.
            let mut b = vec![Interval::ZERO; n * n];
            for i in 1..=n {
                b[(i - 1) * n] = difference(i, 0).scaled(n as f64 / i as f64, SLACK);
            }
            for j in 1..n {
                for i in 1..=n {
                    let below = (i * (n - j)) as f64;
                    let own = difference(i, j).scaled((n * n) as f64 / below, SLACK);
                    let carried = if i < n {
                        b[i * n + j - 1].scaled((j * (n - i)) as f64 / below, SLACK)
                    } else {
                        Interval::ZERO
                    };
                    b[(i - 1) * n + j] = own + carried;
                }
            }
            Tensor::new([n - 1, n - 1], b)
        })
    }

    /// X(s) V(t) − Y(t) W(s) for another piece (Y, V), of degree (n, m).
    pub fn chord(&self, other: &Self) -> [Tensor; 3] {
        [0, 1, 2].map(|axis| {
            let mut coefficients = Vec::with_capacity((self.degree + 1) * (other.degree + 1));
            for (p, &w) in self.points.iter().zip(&self.weights) {
                for (q, &v) in other.points.iter().zip(&other.weights) {
                    coefficients.push(w * v * (p[axis] - q[axis]));
                }
            }
            Tensor::new([self.degree, other.degree], coefficients)
        })
    }
}

fn cross(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// a · b.
pub(super) fn dot(a: &Bernstein3, b: &Bernstein3) -> Bernstein {
    a[0].times(&b[0])
        .plus(&a[1].times(&b[1]))
        .plus(&a[2].times(&b[2]))
}

/// The derivative of each coordinate.
pub(super) fn derivative(a: &Bernstein3) -> Bernstein3 {
    [a[0].derivative(), a[1].derivative(), a[2].derivative()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipe::testing::random_piece;
    use palpate_geometry::math::Random;
    use palpate_geometry::math::Vector3;

    fn vector(a: &Bernstein3, x: f64) -> Vector3 {
        Vector3::new(a[0].value(x), a[1].value(x), a[2].value(x))
    }

    fn tensor(a: &Tensor, s: f64, t: f64) -> f64 {
        let [p, q] = a.degree();
        let rows: Vec<_> = (0..=p)
            .map(|i| {
                Bernstein::new(a.coefficients()[i * (q + 1)..(i + 1) * (q + 1)].to_vec()).value(t)
            })
            .collect();
        Bernstein::new(rows.into_iter().map(Interval::point).collect()).value(s)
    }

    #[test]
    fn hodograph_wronskian_and_bezoutian_are_what_they_stand_for() {
        let mut random = Random(13);
        for _ in 0..200 {
            let degree = random.integer(1, 6);
            let piece = random_piece(&mut random, degree);
            let forms = Forms::new(&piece);
            let (s, t) = (random.float(0.0, 1.0), random.float(0.0, 1.0));
            let (a, b) = (piece.jet(s), piece.jet(t));
            let (wa, wb) = (forms.weight().value(s), forms.weight().value(t));
            let scale = 1.0 + a.first.norm() + a.second.norm();
            assert!((vector(&forms.hodograph, s) / (wa * wa) - a.first).norm() < 1e-12 * scale);
            if let Some(k) = forms.wronskian() {
                let wanted = a.first.cross(&a.second);
                assert!(
                    (vector(&k, s) / (wa * wa * wa) - wanted).norm() < 1e-11 * scale * scale,
                    "degree {degree}"
                );
            }
            let g = forms.bezoutian();
            let value = Vector3::new(
                tensor(&g[0], s, t),
                tensor(&g[1], s, t),
                tensor(&g[2], s, t),
            );
            assert!((value * (s - t) - (a.point - b.point) * (wa * wb)).norm() < 1e-13 * scale);
            let diagonal = Vector3::new(
                tensor(&g[0], s, s),
                tensor(&g[1], s, s),
                tensor(&g[2], s, s),
            );
            assert!(
                (diagonal - vector(&forms.hodograph, s)).norm() < 1e-12 * scale,
                "G(t, t) = N(t)"
            );
        }
    }
}
