//! The signed height of a surface over a plane, one polynomial a Bézier piece.

use super::CutPlane;
use super::grid::{Grid, Side, WHOLE};
use crate::surface::{BezierPieces, Surface};

/// Of the largest coefficient: what is added to all. It is more than rounding makes of a coefficient when a piece is halved,
/// so that a line that lies in the plane is on one side of it.
const SHIFT: f64 = 4e-15;
/// Of the largest coefficient: a pole that is no farther than this from the plane lies in it.
const THROUGH: f64 = 1e-12;

/// h(u, v) = w (n · S − offset), with the weight w of rational surfaces: Bernstein coefficients by piece, u-major.
///
/// Where the plane passes through a pole, the pieces beside it hold h / t^k instead, t being the parameter from the pole: its
/// zeros are the same, and they cross the pole's line instead of running along it.
pub(super) struct Field {
    degree: [usize; 2],
    pieces: Vec<Vec<f64>>,
    columns: usize,
    /// The largest coefficient, m.
    pub scale_m: f64,
    /// By direction and end: the plane passes through that pole.
    pub through: [[bool; 2]; 2],
}

impl Field {
    pub fn new(surface: &Surface, grid: &Grid, plane: &CutPlane) -> Self {
        let bezier = BezierPieces::new(surface);
        let height = |h: &[f64; 4]| {
            let n = &plane.normal;
            n.x * h[0] + n.y * h[1] + n.z * h[2] - plane.offset_m * h[3]
        };
        let pieces: Vec<Vec<f64>> = (0..bezier.len())
            .map(|k| bezier.points(k).iter().map(height).collect())
            .collect();
        let largest = pieces.iter().flatten().fold(0.0f64, |m, c| m.max(c.abs()));
        let mut field = Self {
            degree: [surface.knots_u().degree(), surface.knots_v().degree()],
            pieces,
            columns: grid.counts()[1],
            scale_m: largest,
            through: [[false; 2]; 2],
        };
        field.join(grid);
        for d in 0..2 {
            for end in 0..2 {
                field.divide(grid, d, end);
            }
        }
        let shift = SHIFT * largest;
        field.pieces.iter_mut().flatten().for_each(|c| *c += shift);
        field
    }

    /// Neighbouring pieces share the coefficients of their common side, to the bit.
    fn join(&mut self, grid: &Grid) {
        for d in 0..2 {
            let [rows, columns] = grid.counts();
            for i in 0..rows {
                for j in 0..columns {
                    let mut next = [i, j];
                    next[d] += 1;
                    if next[d] == grid.counts()[d] {
                        if !grid.wraps[d] {
                            continue;
                        }
                        next[d] = 0;
                    }
                    let [from, to] = [next[0] * columns + next[1], i * columns + j];
                    for k in 0..=self.degree[1 - d] {
                        let value = self.pieces[from][self.index(d, 0, k)];
                        let last = self.index(d, self.degree[d], k);
                        self.pieces[to][last] = value;
                    }
                }
            }
        }
    }

    /// The coefficient at `along` in direction d and `across` in the other.
    fn index(&self, d: usize, along: usize, across: usize) -> usize {
        let [i, j] = if d == 0 {
            [along, across]
        } else {
            [across, along]
        };
        i * (self.degree[1] + 1) + j
    }

    /// Where the plane passes through a pole, takes the parameter from it out as a factor.
    fn divide(&mut self, grid: &Grid, d: usize, end: usize) {
        if !grid.poles[d][end] {
            return;
        }
        let counts = grid.counts();
        let at = if end == 0 { 0 } else { counts[d] - 1 };
        let ring: Vec<usize> = (0..counts[1 - d])
            .map(|k| {
                let [i, j] = if d == 0 { [at, k] } else { [k, at] };
                i * counts[1] + j
            })
            .collect();
        let degree = self.degree[d];
        let from_pole = |a: usize| if end == 0 { a } else { degree - a };
        for _ in 0..degree {
            let within = |k: &usize| {
                (0..=self.degree[1 - d]).all(|b| {
                    let first = self.pieces[*k][self.index(d, from_pole(0), b)];
                    first.abs() <= THROUGH * self.scale_m
                })
            };
            if !ring.iter().all(within) {
                return;
            }
            self.through[d][end] = true;
            for &k in &ring {
                for b in 0..=self.degree[1 - d] {
                    let row: Vec<f64> = (0..=degree)
                        .map(|a| self.pieces[k][self.index(d, from_pole(a), b)])
                        .collect();
                    for (a, value) in quotient(&row).into_iter().enumerate() {
                        let index = self.index(d, from_pole(a), b);
                        self.pieces[k][index] = value;
                    }
                }
            }
        }
    }

    /// Degrees in u and v.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Coefficients of a piece, u-major.
    pub fn piece(&self, [i, j]: [usize; 2]) -> &[f64] {
        &self.pieces[i * self.columns + j]
    }

    /// At a place of the grid, the same number whoever asks.
    pub fn at(&self, grid: &Grid, place: [u64; 2]) -> f64 {
        let (piece, local) = grid.piece(place);
        let across = self.along(0, piece, local[0]);
        value(&across, local[1])
    }

    /// Coefficients in the other direction where the parameter of direction d of a piece is t.
    pub fn along(&self, d: usize, piece: [usize; 2], t: f64) -> Vec<f64> {
        restricted(self.piece(piece), self.degree, d, t)
    }

    /// The place where it is 0 on a side between two places of the grid at which its signs differ.
    pub fn crossing(&self, grid: &Grid, side: &Side) -> [f64; 2] {
        let d = side.direction;
        let start = side.place(side.from);
        let (piece, local) = grid.piece(start);
        let line = self.along(1 - d, piece, local[1 - d]);
        let base = (piece[d] as u64) * WHOLE;
        let [a, b] = [side.from, side.to].map(|x| (x - base) as f64 / WHOLE as f64);
        let t = root(&line, [a, b], self.at(grid, start) > 0.0);
        let mut uv = grid.parameters(start);
        uv[d] = grid.parameter_within(d, piece[d], t);
        uv
    }
}

/// Coefficients in the other direction where the parameter of direction d is t.
pub(super) fn restricted(points: &[f64], degree: [usize; 2], d: usize, t: f64) -> Vec<f64> {
    let [p, q] = degree;
    match d {
        0 => (0..=q)
            .map(|b| {
                let column: Vec<f64> = (0..=p).map(|a| points[a * (q + 1) + b]).collect();
                value(&column, t)
            })
            .collect(),
        _ => points.chunks(q + 1).map(|row| value(row, t)).collect(),
    }
}

/// A polynomial divided by its parameter, of which it is a multiple; of the same degree.
fn quotient(c: &[f64]) -> Vec<f64> {
    let n = c.len() - 1;
    let lower: Vec<f64> = (0..n)
        .map(|i| n as f64 / (i + 1) as f64 * c[i + 1])
        .collect();
    (0..=n)
        .map(|j| {
            let share = j as f64 / n as f64;
            let before = if j > 0 { share * lower[j - 1] } else { 0.0 };
            let here = if j < n { (1.0 - share) * lower[j] } else { 0.0 };
            before + here
        })
        .collect()
}

/// De Casteljau.
pub(super) fn value(coefficients: &[f64], t: f64) -> f64 {
    match t {
        0.0 => return coefficients[0],
        1.0 => return coefficients[coefficients.len() - 1],
        _ => {}
    }
    let mut c = [0.0; crate::basis::MAX_DEGREE + 1];
    c[..coefficients.len()].copy_from_slice(coefficients);
    for n in (1..coefficients.len()).rev() {
        for k in 0..n {
            c[k] += t * (c[k + 1] - c[k]);
        }
    }
    c[0]
}

/// The root between two places; `falls`: it is above 0 at the first and not at the second. Illinois' method, and halving
/// where that is slow.
pub(super) fn root(coefficients: &[f64], [from, to]: [f64; 2], falls: bool) -> f64 {
    let at = |t: f64| {
        let f = value(coefficients, t);
        if falls { f } else { -f }
    };
    let (mut a, mut b) = (from, to);
    let (mut fa, mut fb) = (at(a).max(0.0), at(b).min(0.0));
    for k in 0..200 {
        if (b - a).abs() <= f64::EPSILON * (a.abs() + b.abs()) {
            break;
        }
        let t = match k % 8 < 6 && fa > fb {
            true => a + (b - a) * (fa / (fa - fb)),
            false => 0.5 * (a + b),
        };
        let f = at(t);
        if f == 0.0 {
            return t;
        }
        if f > 0.0 {
            if t == a {
                break;
            }
            (a, fa) = (t, f);
            fb *= 0.5;
        } else {
            if t == b {
                break;
            }
            (b, fb) = (t, f);
            fa *= 0.5;
        }
    }
    if fa < -fb { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Random;

    #[test]
    fn a_quotient_times_the_parameter_is_the_polynomial() {
        let mut random = Random(5);
        for degree in 1..8 {
            let mut c: Vec<f64> = (0..=degree).map(|_| random.signed()).collect();
            c[0] = 0.0;
            let q = quotient(&c);
            for k in 0..=10 {
                let t = f64::from(k) / 10.0;
                let off = value(&q, t) * t - value(&c, t);
                assert!(off.abs() < 1e-14, "degree {degree} at {t}: {off}");
            }
        }
    }

    #[test]
    fn a_root_is_where_the_polynomial_is_zero() {
        let mut random = Random(6);
        for _ in 0..1000 {
            let r = random.unit();
            // (t − r)(1 + t²)
            let p = |t: f64| (t - r) * (1.0 + t * t);
            let [c0, c3] = [p(0.0), p(1.0)];
            // p = −r + t − r t² + t³ in Bernstein form.
            let c1 = c0 + 1.0 / 3.0;
            let c2 = c0 + 2.0 / 3.0 - r / 3.0;
            let t = root(&[c0, c1, c2, c3], [0.0, 1.0], false);
            assert!((t - r).abs() < 1e-14, "{t} for {r}");
        }
    }
}
