//! Least squares for lines of points: a clamped basis, its ends free or held at the first and last
//! sample.
//!
//! With the ends held, what they contribute is taken from the samples and the rest is fitted: the
//! first and last control points are then exactly the first and last sample (elimination of two
//! linear constraints). The normal matrix AᵀA is banded; it is factored once (Cholesky) and serves
//! every column.

use palpate_geometry::basis::{KnotVector, MAX_DEGREE, Side};

/// What becomes of the ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ends {
    /// Fitted as all the others (eq. 3.7).
    Free,
    /// Through the first and the last sample.
    Held,
}

/// A pivot below this share of its diagonal is rounding: no sample distinguishes that control point from
/// those before it.
const DEPENDENT: f64 = 1e-12;
/// How much differences of neighbours count where samples say too little, as a share of the largest
/// diagonal.
const RIDGE: f64 = 1e-9;

/// Steps of refinement of a tied fit.
const TIED_STEPS: usize = 6;

/// Factored least-squares fit for one set of knots and parameters.
pub(super) struct LineFit {
    windows: Windows,
    ends: Ends,
    band: Band,
}

impl LineFit {
    /// Parameters rise from one end of the domain to the other.
    pub(super) fn new(knots: &KnotVector, parameters: &[f64], ends: Ends) -> Self {
        let windows = Windows::new(knots, parameters);
        let skip = usize::from(ends == Ends::Held);
        let inner = windows.columns - 2 * skip;
        let mut normal = Band::new(inner, windows.width);
        for (first, values) in windows.rows() {
            // The held ends are not unknowns.
            let cut = skip.saturating_sub(first);
            let start = (first + cut).saturating_sub(skip);
            let length = (values.len() - cut).min(inner.saturating_sub(start));
            normal.add_row(start, &values[cut..cut + length]);
        }
        Self {
            windows,
            ends,
            band: normal.factored(),
        }
    }

    /// (rows × width) samples → (columns × width) control points. One step of refinement gives back
    /// the digits that squaring A has cost; where neighbours had to be tied, more steps take back
    /// what the ties have bent.
    pub(super) fn fit(&self, samples: &[f64], width: usize) -> Vec<f64> {
        let mut points = self.rough(samples, width);
        let skip = usize::from(self.ends == Ends::Held) * width;
        for _ in 0..if self.band.tied { TIED_STEPS } else { 1 } {
            let mut correction = self.transposed(&self.misses(samples, &points, width), width);
            let inner = skip..correction.len() - skip;
            self.band.solve(&mut correction[inner.clone()], width);
            points[inner.clone()]
                .iter_mut()
                .zip(&correction[inner])
                .for_each(|(p, c)| *p += c);
        }
        points
    }

    /// [`LineFit::fit`] without the refinement: for searches.
    pub(super) fn rough(&self, samples: &[f64], width: usize) -> Vec<f64> {
        if self.ends == Ends::Free {
            let mut points = self.transposed(samples, width);
            self.band.solve(&mut points, width);
            return points;
        }
        let last = self.windows.columns - 1;
        let mut rest = samples.to_vec();
        let (head, tail) = (&samples[..width], &samples[samples.len() - width..]);
        for ((first, values), rest) in self.windows.rows().zip(rest.chunks_exact_mut(width)) {
            for (a, value) in values.iter().enumerate() {
                let end = if first + a == 0 { head } else { tail };
                if first + a == 0 || first + a == last {
                    rest.iter_mut().zip(end).for_each(|(x, e)| *x -= value * e);
                }
            }
        }
        let mut points = self.transposed(&rest, width);
        let inner = width..last * width;
        self.band.solve(&mut points[inner], width);
        points[..width].copy_from_slice(head);
        points[last * width..].copy_from_slice(tail);
        points
    }

    /// Sum of squares of the fit to samples that are zero at both held ends: |S|² less this is what
    /// they miss. For searches, where the digits that the difference loses do not matter.
    pub(super) fn fitted_square(&self, samples: &[f64], width: usize) -> f64 {
        let skip = usize::from(self.ends == Ends::Held) * width;
        let mut points = self.transposed(samples, width);
        let inner = skip..points.len() - skip;
        self.band.forward(&mut points[inner.clone()], width);
        points[inner].iter().map(|x| x * x).sum()
    }

    /// What the samples have and the line through the control points has not.
    pub(super) fn misses(&self, samples: &[f64], points: &[f64], width: usize) -> Vec<f64> {
        let mut misses = samples.to_vec();
        for ((first, values), miss) in self.windows.rows().zip(misses.chunks_exact_mut(width)) {
            for (value, point) in values
                .iter()
                .zip(points[first * width..].chunks_exact(width))
            {
                miss.iter_mut()
                    .zip(point)
                    .for_each(|(x, p)| *x -= value * p);
            }
        }
        misses
    }

    fn transposed(&self, samples: &[f64], width: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.windows.columns * width];
        for ((first, values), sample) in self.windows.rows().zip(samples.chunks_exact(width)) {
            for (value, out) in values
                .iter()
                .zip(out[first * width..].chunks_exact_mut(width))
            {
                out.iter_mut()
                    .zip(sample)
                    .for_each(|(o, x)| *o += value * x);
            }
        }
        out
    }
}

/// Basis values at rising parameters, without the derivatives that a
/// [`Blending`](palpate_geometry::basis::Blending) has: searches make many of them.
struct Windows {
    columns: usize,
    width: usize,
    /// (rows) first column.
    first: Vec<usize>,
    /// (rows × width)
    values: Vec<f64>,
}

impl Windows {
    fn new(knots: &KnotVector, parameters: &[f64]) -> Self {
        let width = knots.degree() + 1;
        let (mut first, mut values) = (
            Vec::with_capacity(parameters.len()),
            Vec::with_capacity(parameters.len() * width),
        );
        let (t, last) = (knots.knots(), knots.count() - 1);
        let mut span = knots.span(parameters.first().copied().unwrap_or(0.0), Side::Right);
        for &u in parameters {
            let u = knots.confine(u);
            // Parameters rise, so spans do.
            while span < last && u >= t[span + 1] {
                span += 1;
            }
            first.push(span + 1 - width);
            values.extend_from_slice(&basis(t, span, width, u)[..width]);
        }
        Self {
            columns: knots.count(),
            width,
            first,
            values,
        }
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.first
            .iter()
            .copied()
            .zip(self.values.chunks_exact(self.width))
    }
}

/// N_{i,p}(u) of a span (Piegl & Tiller, *The NURBS Book*, A2.2).
fn basis(t: &[f64], span: usize, width: usize, u: f64) -> [f64; MAX_DEGREE + 1] {
    let mut values = [0.0; MAX_DEGREE + 1];
    values[0] = 1.0;
    for p in 1..width {
        let mut saved = 0.0;
        for r in 0..p {
            let (right, left) = (t[span + r + 1] - u, u - t[span + 1 + r - p]);
            let share = values[r] / (right + left);
            values[r] = saved + right * share;
            saved = left * share;
        }
        values[p] = saved;
    }
    values
}

/// The lower half of a symmetric banded matrix, or its Cholesky factor: row i holds (i, i), (i, i −
/// 1), …
pub(super) struct Band {
    width: usize,
    rows: Vec<f64>,
    /// Differences of neighbours were added to what the samples say.
    tied: bool,
}

impl Band {
    pub(super) fn new(count: usize, width: usize) -> Self {
        Self {
            width,
            rows: vec![0.0; count * width],
            tied: false,
        }
    }

    /// Adds a row of A, values from column `first` on, to AᵀA.
    pub(super) fn add_row(&mut self, first: usize, values: &[f64]) {
        for (a, x) in values.iter().enumerate() {
            let row = &mut self.rows[(first + a) * self.width..];
            values[..=a]
                .iter()
                .enumerate()
                .for_each(|(b, y)| row[a - b] += x * y);
        }
    }

    fn count(&self) -> usize {
        self.rows.len() / self.width
    }

    /// The factor; where samples do not tell all control points apart, differences of neighbours
    /// are held small too.
    pub(super) fn factored(self) -> Self {
        if let Some(factor) = self.cholesky() {
            return factor;
        }
        let largest = (0..self.count())
            .map(|i| self.rows[i * self.width])
            .fold(0.0, f64::max);
        let mut tied = self;
        tied.tied = true;
        for tie in [RIDGE * largest, 1e-6 * largest] {
            for i in 1..tied.count() {
                let w = tied.width;
                tied.rows[(i - 1) * w] += tie;
                tied.rows[i * w] += tie;
                tied.rows[i * w + 1] -= tie;
            }
            if let Some(factor) = tied.cholesky() {
                return factor;
            }
        }
        // Samples that hold not even a constant: none at all.
        (0..tied.count()).for_each(|i| tied.rows[i * tied.width] += largest.max(1.0));
        tied.cholesky()
            .expect("a positive diagonal was added to a sum of squares")
    }

    fn cholesky(&self) -> Option<Self> {
        let (n, w) = (self.count(), self.width);
        let mut l = self.rows.clone();
        for i in 0..n {
            for j in i.saturating_sub(w - 1)..=i {
                let mut sum = self.rows[i * w + (i - j)];
                for k in i.saturating_sub(w - 1)..j {
                    // (j, k) is inside the band because (i, k) is.
                    sum -= l[i * w + (i - k)] * l[j * w + (j - k)];
                }
                if j < i {
                    l[i * w + (i - j)] = sum / l[j * w];
                } else if sum > DEPENDENT * self.rows[i * w] && sum.is_finite() {
                    l[i * w] = sum.sqrt();
                } else {
                    return None;
                }
            }
        }
        Some(Self {
            width: w,
            rows: l,
            tied: self.tied,
        })
    }

    /// An element of the factor, row ≥ column.
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        if row - column < self.width {
            self.rows[row * self.width + (row - column)]
        } else {
            0.0
        }
    }

    /// L⁻¹ x in place.
    fn forward(&self, x: &mut [f64], columns: usize) {
        let (n, w) = (self.count(), self.width);
        for i in 0..n {
            let (before, row) = x.split_at_mut(i * columns);
            let row = &mut row[..columns];
            for k in i.saturating_sub(w - 1)..i {
                let l = self.rows[i * w + (i - k)];
                row.iter_mut()
                    .zip(&before[k * columns..])
                    .for_each(|(r, b)| *r -= l * b);
            }
            let pivot = self.rows[i * w];
            row.iter_mut().for_each(|r| *r /= pivot);
        }
    }

    /// Solves in place for (count × columns) right-hand sides.
    pub(super) fn solve(&self, x: &mut [f64], columns: usize) {
        let (n, w) = (self.count(), self.width);
        self.forward(x, columns);
        for i in (0..n).rev() {
            let (row, after) = x[i * columns..].split_at_mut(columns);
            for k in i + 1..n.min(i + w) {
                let l = self.rows[k * w + (k - i)];
                row.iter_mut()
                    .zip(&after[(k - i - 1) * columns..])
                    .for_each(|(r, a)| *r -= l * a);
            }
            let pivot = self.rows[i * w];
            row.iter_mut().for_each(|r| *r /= pivot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn line(random: &mut Random, count: usize, width: usize) -> Vec<f64> {
        (0..count * width)
            .map(|_| random.float(-1.0, 1.0))
            .collect()
    }

    #[test]
    fn samples_of_a_line_give_its_control_points_back() {
        let mut random = Random(5);
        for _ in 0..50 {
            let degree = random.integer(1, 6);
            let count = random.integer(degree + 1, degree + 9);
            let knots = KnotVector::clamped_uniform(degree, count).unwrap();
            let parameters: Vec<f64> = (0..=200).map(|k| k as f64 / 200.0).collect();
            let points = line(&mut random, count, 3);
            for ends in [Ends::Free, Ends::Held] {
                let fit = LineFit::new(&knots, &parameters, ends);
                let zero = vec![0.0; parameters.len() * 3];
                let samples: Vec<f64> = fit.misses(&zero, &points, 3).iter().map(|x| -x).collect();
                let back = fit.fit(&samples, 3);
                let worst = points
                    .iter()
                    .zip(&back)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max);
                assert!(
                    worst < 1e-11,
                    "degree {degree}, {count} points, {ends:?}: off by {worst}"
                );
            }
        }
    }

    // What is left over is at right angles to every free basis function: the definition of the
    // least sum of squares.
    #[test]
    fn no_held_fit_misses_less() {
        let mut random = Random(6);
        let knots = KnotVector::new(
            3,
            vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.5, 0.5, 0.8, 1.0, 1.0, 1.0, 1.0],
        )
        .unwrap();
        let parameters: Vec<f64> = (0..=60).map(|k| k as f64 / 60.0).collect();
        let fit = LineFit::new(&knots, &parameters, Ends::Held);
        let samples = line(&mut random, 61, 2);
        let points = fit.fit(&samples, 2);
        assert_eq!(
            (&points[..2], &points[14..]),
            (&samples[..2], &samples[120..])
        );
        let left = fit.transposed(&fit.misses(&samples, &points, 2), 2);
        let worst = left[2..14].iter().map(|x| x.abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{left:?}");
    }

    #[test]
    fn basis_values_are_those_of_the_blending() {
        let knots = KnotVector::new(
            3,
            vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.5, 0.5, 0.8, 1.0, 1.0, 1.0, 1.0],
        )
        .unwrap();
        let parameters: Vec<f64> = (0..=40).map(|k| k as f64 / 40.0).collect();
        let windows = Windows::new(&knots, &parameters);
        let blending = palpate_geometry::basis::Blending::new(&knots, &parameters);
        for (row, (first, values)) in windows.rows().enumerate() {
            let (wanted, twin) = blending.row(row, 0);
            assert_eq!(first, wanted);
            assert!(
                values.iter().zip(twin).all(|(a, b)| (a - b).abs() < 1e-15),
                "{values:?} {twin:?}"
            );
        }
    }

    #[test]
    fn knots_without_samples_are_bridged_without_a_fault() {
        let knots = KnotVector::clamped_uniform(3, 20).unwrap();
        let parameters: Vec<f64> = (0..=10)
            .flat_map(|k| [k as f64 * 0.02, 0.8 + k as f64 * 0.02])
            .collect();
        let mut parameters = parameters;
        parameters.sort_by(f64::total_cmp);
        let fit = LineFit::new(&knots, &parameters, Ends::Held);
        let samples: Vec<f64> = parameters.clone();
        let points = fit.fit(&samples, 1);
        assert!(
            points
                .iter()
                .all(|x| x.is_finite() && *x >= -1e-6 && *x <= 1.0 + 1e-6),
            "{points:?}"
        );
    }
}
