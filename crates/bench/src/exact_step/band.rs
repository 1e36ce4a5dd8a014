//! Cholesky's factor of a symmetric matrix whose entries are near the diagonal.

/// L of A = L Lᵀ, row by row: row i holds columns i − band … i.
#[derive(Clone, Debug)]
pub struct BandCholesky {
    n: usize,
    band: usize,
    /// (n × (band + 1)).
    rows: Vec<f64>,
}

impl BandCholesky {
    /// Factors the lower half of a matrix, stored as [`BandCholesky`] stores L. `None` if it is not
    /// positive definite.
    pub fn new(n: usize, band: usize, mut rows: Vec<f64>) -> Option<Self> {
        debug_assert_eq!(rows.len(), n * (band + 1), "n rows of band + 1 numbers");
        let width = band + 1;
        for i in 0..n {
            let first = i.saturating_sub(band);
            let (above, row) = rows.split_at_mut(i * width);
            for j in first..=i {
                let from = first.max(j.saturating_sub(band));
                // Column k of row i stands at k + band − i.
                let own = &row[from + band - i..j + band - i];
                if j == i {
                    let pivot = row[band] - own.iter().map(|l| l * l).sum::<f64>();
                    if pivot.is_nan() || pivot <= 0.0 {
                        return None;
                    }
                    row[band] = pivot.sqrt();
                } else {
                    let other = &above[j * width..(j + 1) * width];
                    let part = dot(own, &other[from + band - j..band]);
                    row[j + band - i] = (row[j + band - i] - part) / other[band];
                }
            }
        }
        Some(Self { n, band, rows })
    }

    /// Replaces b by A⁻¹ b.
    pub fn solve(&self, b: &mut [f64]) {
        debug_assert_eq!(b.len(), self.n, "one number a row");
        let (band, width) = (self.band, self.band + 1);
        for i in 0..self.n {
            let first = i.saturating_sub(band);
            let row = &self.rows[i * width..(i + 1) * width];
            b[i] = (b[i] - dot(&row[first + band - i..band], &b[first..i])) / row[band];
        }
        for i in (0..self.n).rev() {
            let first = i.saturating_sub(band);
            let row = &self.rows[i * width..(i + 1) * width];
            b[i] /= row[band];
            let value = b[i];
            for (b, l) in b[first..i].iter_mut().zip(&row[first + band - i..band]) {
                *b -= l * value;
            }
        }
    }
}

/// Σ a b in four sums, which compilers turn into one of vectors.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, others) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = fours
        .remainder()
        .iter()
        .zip(others.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in fours.zip(others) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_solves_what_it_was_made_of_and_an_indefinite_matrix_has_none() {
        let (n, band) = (23, 5);
        let entry = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 4.0 + i as f64 * 0.1,
            d if d <= band => 0.5 / (d as f64 + 0.3 * (i + j) as f64),
            _ => 0.0,
        };
        let mut rows = vec![0.0; n * (band + 1)];
        for i in 0..n {
            for j in i.saturating_sub(band)..=i {
                rows[i * (band + 1) + j + band - i] = entry(i, j);
            }
        }
        let x: Vec<f64> = (0..n).map(|k| (k as f64 * 0.7).sin()).collect();
        let mut b: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum())
            .collect();
        BandCholesky::new(n, band, rows.clone())
            .unwrap()
            .solve(&mut b);
        for (k, (got, want)) in b.iter().zip(&x).enumerate() {
            assert!(
                (got - want).abs() < 1e-13,
                "row {k}: {got} instead of {want}"
            );
        }
        rows[7 * (band + 1) + band] = -1.0;
        assert!(BandCholesky::new(n, band, rows).is_none());
    }
}
