//! Eigenvalues of small symmetric matrices, with the same bits on every machine: libraries choose
//! vector widths at run time.

/// Sweeps of Jacobi's method; it converges quadratically, ten are plenty.
const SWEEPS: usize = 30;

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix (n × n, row by row): column k of the
/// second answer (n × n, row by row) belongs to value k. Cyclic Jacobi (Golub & Van Loan, *Matrix
/// Computations*, §8.5).
pub fn symmetric_eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    debug_assert_eq!(matrix.len(), n * n, "a square matrix");
    let mut a = matrix.to_vec();
    let mut v = vec![0.0; n * n];
    for k in 0..n {
        v[k * n + k] = 1.0;
    }
    for _ in 0..SWEEPS {
        let off: f64 = (0..n)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| a[i * n + j] * a[i * n + j])
            .sum();
        let whole: f64 = (0..n).map(|k| a[k * n + k] * a[k * n + k]).sum();
        if off <= 1e-30 * whole || off.is_nan() {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                let apq = a[p * n + q];
                if apq == 0.0 {
                    continue;
                }
                let tau = (a[q * n + q] - a[p * n + p]) / (2.0 * apq);
                let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[k * n + p], a[k * n + q]);
                    (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p * n + k], a[q * n + k]);
                    (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (v[k * n + p], v[k * n + q]);
                    (v[k * n + p], v[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| a[i * n + i].total_cmp(&a[j * n + j]));
    let values = order.iter().map(|&k| a[k * n + k]).collect();
    let mut vectors = vec![0.0; n * n];
    for row in 0..n {
        for (to, &from) in order.iter().enumerate() {
            vectors[row * n + to] = v[row * n + from];
        }
    }
    (values, vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Random;

    #[test]
    fn vectors_diagonalise_random_matrices() {
        let mut random = Random(3);
        for n in [1, 2, 5, 32] {
            let mut matrix = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..=i {
                    let value = random.signed();
                    (matrix[i * n + j], matrix[j * n + i]) = (value, value);
                }
            }
            let (values, vectors) = symmetric_eigen(&matrix, n);
            assert!(values.is_sorted());
            for k in 0..n {
                for i in 0..n {
                    let along: f64 = (0..n).map(|j| matrix[i * n + j] * vectors[j * n + k]).sum();
                    assert!((along - values[k] * vectors[i * n + k]).abs() < 1e-12);
                }
                for l in 0..=k {
                    let dot: f64 = (0..n)
                        .map(|i| vectors[i * n + k] * vectors[i * n + l])
                        .sum();
                    let wanted = if k == l { 1.0 } else { 0.0 };
                    assert!((dot - wanted).abs() < 1e-12);
                }
            }
        }
    }
}
