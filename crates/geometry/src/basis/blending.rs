//! Blending matrices: what a set of parameters sees of the control points, and the least-squares
//! way back.
//!
//! A has one row a parameter and one column a control point; a row holds `degree + 1` values that
//! follow each other (round the end when periodic). Sampling is M = A P, fitting is P = (AᵀA)⁻¹ Aᵀ
//! M (eq. 3.6 and 3.7 of the design's source thesis, a direction at a time). Both depend on knots
//! and parameters only, never on the net. The fit is factored once: AᵀA is banded, with corners
//! when periodic, so its Cholesky factor stays within the same envelope; one step of refinement
//! then gives back the digits that squaring A has cost.

use super::KnotVector;
use std::ops::{AddAssign, Mul, SubAssign};

/// What can be blended: a number or a vector.
pub trait Blendable: Copy + Default + Mul<f64, Output = Self> + AddAssign + SubAssign {}

impl<T: Copy + Default + Mul<f64, Output = T> + AddAssign + SubAssign> Blendable for T {}

/// Banded matrix of the basis and its first two derivatives at some parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Blending {
    columns: usize,
    /// `degree + 1`: values in a row.
    width: usize,
    /// Parameter of each row (rows).
    parameters: Vec<f64>,
    /// (rows) column of each row's first value, below `columns`; later ones follow, round the end
    /// if need be.
    first: Vec<usize>,
    /// (rows × width) for orders 0, 1 and 2.
    values: [Vec<f64>; 3],
}

impl Blending {
    /// One row for each parameter, confined to the domain; at a knot as seen from the right.
    pub fn new(knots: &KnotVector, parameters: &[f64]) -> Self {
        let width = knots.degree() + 1;
        let mut blending = Self {
            columns: knots.count(),
            width,
            parameters: parameters.iter().map(|&u| knots.confine(u)).collect(),
            first: Vec::with_capacity(parameters.len()),
            values: std::array::from_fn(|_| Vec::with_capacity(parameters.len() * width)),
        };
        for &u in parameters {
            let window = knots.window(u);
            blending.first.push(window.first % knots.count());
            for (order, values) in blending.values.iter_mut().enumerate() {
                values.extend_from_slice(window.order(order));
            }
        }
        blending
    }

    /// Number of parameters.
    pub fn rows(&self) -> usize {
        self.first.len()
    }

    /// Number of control points.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Values in a row, `degree + 1`.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The parameters, inside the domain: (rows).
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// First column of a row, and its `degree + 1` values of derivative `order` (0, 1 or 2); value
    /// k belongs to column `first + k`, modulo the number of columns.
    pub fn row(&self, row: usize, order: usize) -> (usize, &[f64]) {
        (
            self.first[row],
            &self.values[order][row * self.width..(row + 1) * self.width],
        )
    }

    /// The non-zeros of a row: (column, value).
    pub fn entries(&self, row: usize, order: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (first, values) = self.row(row, order);
        let columns = self.columns;
        values.iter().enumerate().map(move |(k, &value)| {
            let column = first + k;
            (
                if column < columns {
                    column
                } else {
                    column - columns
                },
                value,
            )
        })
    }

    /// `out = A^(order) points`: samples of a curve, (columns) → (rows).
    pub fn apply<T: Blendable>(&self, order: usize, points: &[T], out: &mut [T]) {
        debug_assert_eq!(
            (points.len(), out.len()),
            (self.columns, self.rows()),
            "points and blending disagree"
        );
        for (row, out) in out.iter_mut().enumerate() {
            let mut sum = T::default();
            for (column, value) in self.entries(row, order) {
                sum += points[column] * value;
            }
            *out = sum;
        }
    }

    /// `out += Aᵀ samples`.
    fn add_transposed<T: Blendable>(&self, samples: &[T], out: &mut [T]) {
        for (row, &sample) in samples.iter().enumerate() {
            for (column, value) in self.entries(row, 0) {
                out[column] += sample * value;
            }
        }
    }
}

/// Least-squares fit for one [`Blending`]: of all control points, those whose samples miss least in
/// the sum of squares.
///
/// Control points that the samples leave free, alone or in combination, follow their neighbour: no
/// fit is worse for it.
#[derive(Clone, Debug)]
pub struct BlendingInverse {
    blending: Blending,
    /// Pairs of neighbours whose difference is held at zero because the samples do not say.
    ties: Vec<(usize, usize)>,
    tie_weight: f64,
    factor: Envelope,
}

/// A pivot that falls below this fraction of its diagonal is rounding: the column depends on those
/// before. With samples spread over all spans, clamped and periodic bases stay above 1e-6 up to
/// degree 15; noise was seen up to 1e-12.
const DEPENDENT: f64 = 1e-11;

impl BlendingInverse {
    /// Factors AᵀA.
    pub fn new(blending: Blending) -> Self {
        let columns = blending.columns;
        let mut normal = Envelope::new(columns, |row| {
            // Columns meet in AᵀA when some window holds both; ties are neighbours.
            let reach = blending.width - 1;
            let wraps = row + reach >= columns
                && (0..blending.rows()).any(|k| blending.first[k] + reach >= columns);
            if wraps || row == columns - 1 {
                0
            } else {
                row.saturating_sub(reach.max(1))
            }
        });
        for row in 0..blending.rows() {
            for (i, a) in blending.entries(row, 0) {
                for (j, b) in blending.entries(row, 0).filter(|&(j, _)| j <= i) {
                    normal.add(i, j, a * b);
                }
            }
        }
        let mut tie_weight = (0..columns).map(|k| normal.at(k, k)).fold(0.0, f64::max);
        if blending.rows() == 0 {
            // Differences cannot hold what no sample holds: every control point is zero then.
            tie_weight = 1.0;
            (0..columns).for_each(|k| normal.add(k, k, tie_weight));
        }
        let mut ties: Vec<(usize, usize)> = Vec::new();
        loop {
            let mut factor = normal.clone();
            match factor.factor(DEPENDENT, tie_weight) {
                // A null vector that has no differences is constant, and samples hold constants: so
                // this ends before every neighbour is tied.
                Err(column) if ties.len() < columns => {
                    let before = (column.saturating_sub(1), column);
                    let after = (
                        column.min((column + 1) % columns),
                        column.max((column + 1) % columns),
                    );
                    let (low, high) = if column > 0 && !ties.contains(&before) {
                        before
                    } else {
                        after
                    };
                    normal.add(low, low, tie_weight);
                    normal.add(high, high, tie_weight);
                    normal.add(high, low, -tie_weight);
                    ties.push((low, high));
                }
                _ => {
                    return Self {
                        blending,
                        ties,
                        tie_weight,
                        factor,
                    };
                }
            }
        }
    }

    /// The matrix it inverts.
    pub fn blending(&self) -> &Blending {
        &self.blending
    }

    /// Control points of the best curve, (rows) samples → (columns) points; `scratch` is (rows +
    /// columns) long. No allocation, no factorisation.
    pub fn fit<T: Blendable>(&self, samples: &[T], out: &mut [T], scratch: &mut [T]) {
        let (rows, columns) = (self.blending.rows(), self.blending.columns());
        debug_assert_eq!(
            (samples.len(), out.len()),
            (rows, columns),
            "samples, points and blending disagree"
        );
        let (misses, correction) = scratch[..rows + columns].split_at_mut(rows);
        out.fill(T::default());
        self.blending.add_transposed(samples, out);
        self.factor.solve(out);
        // One refinement, from what the samples still miss.
        self.blending.apply(0, out, misses);
        for (miss, &sample) in misses.iter_mut().zip(samples) {
            let mut rest = sample;
            rest -= *miss;
            *miss = rest;
        }
        correction.fill(T::default());
        self.blending.add_transposed(misses, correction);
        for &(a, b) in &self.ties {
            let mut apart = out[a];
            apart -= out[b];
            correction[a] -= apart * self.tie_weight;
            correction[b] += apart * self.tie_weight;
        }
        self.factor.solve(correction);
        for (point, &correction) in out.iter_mut().zip(correction.iter()) {
            *point += correction;
        }
    }
}

/// Lower half of a symmetric matrix, each row from its first non-zero column to the diagonal.
#[derive(Clone, Debug)]
struct Envelope {
    /// (n) first column of each row.
    start: Vec<usize>,
    /// (n + 1) where each row begins in `values`.
    offset: Vec<usize>,
    values: Vec<f64>,
}

impl Envelope {
    fn new(count: usize, start: impl Fn(usize) -> usize) -> Self {
        let start: Vec<usize> = (0..count).map(start).collect();
        let mut offset = vec![0];
        for (row, start) in start.iter().enumerate() {
            offset.push(offset[row] + row + 1 - start);
        }
        Self {
            values: vec![0.0; offset[count]],
            start,
            offset,
        }
    }

    fn index(&self, row: usize, column: usize) -> usize {
        debug_assert!(
            self.start[row] <= column && column <= row,
            "({row}, {column}) is outside the envelope"
        );
        self.offset[row] + column - self.start[row]
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[self.index(row, column)]
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        let k = self.index(row, column);
        self.values[k] += value;
    }

    /// Replaces the matrix by its Cholesky factor; fails at the first column that depends on those
    /// before. `typical` is the size of a diagonal, for columns that are zero.
    fn factor(&mut self, dependent: f64, typical: f64) -> Result<(), usize> {
        for i in 0..self.start.len() {
            let diagonal = self.at(i, i);
            for j in self.start[i]..=i {
                let from = self.start[i].max(self.start[j]);
                let (a, b) = (self.index(i, from), self.index(j, from));
                let dot: f64 = (0..j - from)
                    .map(|k| self.values[a + k] * self.values[b + k])
                    .sum();
                let rest = self.at(i, j) - dot;
                let k = self.index(i, j);
                if j < i {
                    self.values[k] = rest / self.at(j, j);
                } else if rest > dependent * diagonal
                    && rest > f64::EPSILON * f64::EPSILON * typical
                {
                    self.values[k] = rest.sqrt();
                } else {
                    // Left usable whatever the caller does: the column then counts as found.
                    self.values[k] = typical.sqrt();
                    return Err(i);
                }
            }
        }
        Ok(())
    }

    /// Solves L Lᵀ x = b in place.
    fn solve<T: Blendable>(&self, x: &mut [T]) {
        for i in 0..x.len() {
            let mut sum = x[i];
            for j in self.start[i]..i {
                sum -= x[j] * self.at(i, j);
            }
            x[i] = sum * (1.0 / self.at(i, i));
        }
        for i in (0..x.len()).rev() {
            let value = x[i] * (1.0 / self.at(i, i));
            x[i] = value;
            for j in self.start[i]..i {
                x[j] -= value * self.at(i, j);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::KnotKind;
    use super::super::testing::{KINDS, Random, parameters, random_knots, twin_row};
    use super::*;

    /// `per_span` parameters inside each span.
    fn spread(knots: &KnotVector, per_span: usize) -> Vec<f64> {
        let t = knots.knots();
        let inside = |k: usize| (k as f64 + 0.5) / per_span as f64;
        knots
            .spans()
            .flat_map(|i| (0..per_span).map(move |k| t[i] + (t[i + 1] - t[i]) * inside(k)))
            .collect()
    }

    /// Number of control points that the samples alone do not determine.
    fn undetermined(inverse: &BlendingInverse) -> usize {
        match inverse.blending.rows() {
            0 => inverse.blending.columns(),
            _ => inverse.ties.len(),
        }
    }

    #[test]
    fn rows_are_those_of_the_recursive_definition() {
        let mut random = Random(71);
        for degree in 1..=7 {
            for kind in KINDS {
                let knots = random_knots(&mut random, degree, kind, degree + 1);
                let mut at = parameters(&mut random, &knots, 5);
                at.pop();
                let blending = Blending::new(&knots, &at);
                for (row, &u) in at.iter().enumerate() {
                    for order in 0..3 {
                        let wanted = twin_row(&knots, u, false, order);
                        let scale = wanted.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
                        let mut got = vec![0.0; knots.count()];
                        blending
                            .entries(row, order)
                            .for_each(|(column, value)| got[column] += value);
                        for (a, b) in got.iter().zip(&wanted) {
                            assert!(
                                (a - b).abs() < 1e-13 * scale,
                                "{knots:?} at {u}, order {order}: {got:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_fit_recovers_the_control_points_that_made_the_samples() {
        let mut random = Random(72);
        for degree in 1..=7 {
            for kind in KINDS {
                for _ in 0..6 {
                    let knots = random_knots(&mut random, degree, kind, degree + 1);
                    let points: Vec<f64> = (0..knots.count())
                        .map(|_| random.float(-1.0, 1.0))
                        .collect();
                    let blending = Blending::new(&knots, &spread(&knots, degree + 2));
                    let mut samples = vec![0.0; blending.rows()];
                    blending.apply(0, &points, &mut samples);
                    let inverse = BlendingInverse::new(blending);
                    assert_eq!(undetermined(&inverse), 0, "{knots:?}");
                    let mut found = vec![0.0; points.len()];
                    inverse.fit(
                        &samples,
                        &mut found,
                        &mut vec![0.0; samples.len() + points.len()],
                    );
                    // The outermost points of an open vector reach the domain with 1/p! at most:
                    // the samples' rounding shows there, whatever the method.
                    let tolerance = if kind == KnotKind::Open && degree >= 6 {
                        1e-8
                    } else {
                        1e-10
                    };
                    for (a, b) in found.iter().zip(&points) {
                        assert!((a - b).abs() < tolerance, "{knots:?}: {a} is not {b}");
                    }
                }
            }
        }
    }

    // Gauss's condition, whatever the data: the misses of the best fit are orthogonal to every
    // column.
    #[test]
    fn misses_of_a_fit_are_orthogonal_to_the_basis() {
        let mut random = Random(73);
        for degree in 1..=7 {
            for kind in KINDS {
                let knots = random_knots(&mut random, degree, kind, degree);
                let blending = Blending::new(&knots, &spread(&knots, 2 * degree + 3));
                let samples: Vec<f64> = (0..blending.rows())
                    .map(|_| random.float(-1.0, 1.0))
                    .collect();
                let inverse = BlendingInverse::new(blending);
                let mut found = vec![0.0; knots.count()];
                inverse.fit(
                    &samples,
                    &mut found,
                    &mut vec![0.0; samples.len() + knots.count()],
                );
                let mut misses = vec![0.0; samples.len()];
                inverse.blending().apply(0, &found, &mut misses);
                misses
                    .iter_mut()
                    .zip(&samples)
                    .for_each(|(miss, sample)| *miss -= sample);
                let mut products = vec![0.0; knots.count()];
                inverse.blending().add_transposed(&misses, &mut products);
                assert!(
                    products.iter().all(|p| p.abs() < 1e-11),
                    "{knots:?}: {products:?}"
                );
            }
        }
    }

    #[test]
    fn points_without_samples_follow_their_neighbours_and_spoil_nothing() {
        for knots in [
            KnotVector::clamped_uniform(3, 12).unwrap(),
            KnotVector::periodic_uniform(3, 12).unwrap(),
        ] {
            let points: Vec<f64> = (0..12).map(|k| f64::from(k * k % 7)).collect();
            for at in [
                spread(&knots, 5)[..20].to_vec(),
                vec![0.31, 0.31, 0.62],
                vec![0.2; 9],
                Vec::new(),
            ] {
                let blending = Blending::new(&knots, &at);
                let mut samples = vec![0.0; at.len()];
                blending.apply(0, &points, &mut samples);
                let inverse = BlendingInverse::new(blending);
                // As many as there are columns beyond the rank: what distinct samples leave over.
                let mut distinct = at.clone();
                distinct.dedup();
                let least = 12 - distinct.len().min(12);
                assert!(
                    (least..=12).contains(&undetermined(&inverse)),
                    "{} of {least}",
                    undetermined(&inverse)
                );
                assert!(undetermined(&inverse) > 0);
                let mut found = vec![0.0; 12];
                inverse.fit(&samples, &mut found, &mut vec![0.0; at.len() + 12]);
                let mut again = vec![0.0; at.len()];
                inverse.blending().apply(0, &found, &mut again);
                for (a, b) in again.iter().zip(&samples) {
                    assert!(
                        (a - b).abs() < 1e-10,
                        "{} samples: {a} is not {b}",
                        at.len()
                    );
                }
                assert!(found.iter().all(|x| x.abs() < 100.0), "{found:?}");
            }
        }
    }
}
