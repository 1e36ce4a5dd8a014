//! Motions in which a body gives way far more than its scalar response says: bending, twisting,
//! turning as a whole.
//!
//! Contact answers by a scalar response W = H⁻¹, H = M / dt² + κ L. Against the tangent B of the step
//! it is right for forces on small parts of the surface, and too stiff where much of the body follows:
//! bending a rod hardly strains it, but L counts the turning. The generalised eigenvectors
//! B φ = λ H φ with small λ are those motions; with them `W + Σ (1 / λ − 1) φ φᵀ` answers as the
//! tangent does there. They are turned with the body, coordinate by coordinate.

use super::frame::Frame;
use palpate_geometry::math::{
    BlockCholesky, Lane, Random, SymmetricTriplets, Vector3, symmetric_eigen,
};

/// Most modes of a body.
const MOST_MODES: usize = 24;
/// Modes with a larger λ are left to the scalar response: half of what contact changes is then
/// settled in the same tick, and the rest in the next.
const STIFF_ENOUGH: f64 = 0.7;
/// More vectors than modes: the last of a subspace converge slowly.
const SPARE: usize = 8;
/// Subspace iterations: λ of the modes that matter is then known to a percent, which is enough.
const ROUNDS: usize = 12;

/// Modes of a body.
#[derive(Clone, Debug, Default)]
pub(super) struct SoftModes {
    /// 1 / λ − 1.
    gains: Vec<f64>,
    /// (unknowns × modes), mode after mode for each unknown, in the frame of rest; φᵀ H φ = 1.
    shapes: Vec<[f32; 3]>,
}

impl SoftModes {
    /// `factor`: of B; `scalar`: H.
    pub(super) fn new(factor: &BlockCholesky, scalar: &SymmetricTriplets) -> Self {
        let n = scalar.n;
        let size = (MOST_MODES + SPARE).min(3 * n);
        let mut random = Random(1);
        let mut vectors: Vec<Vec<Lane>> = (0..size)
            .map(|_| (0..n).map(|_| lane(&random.vector())).collect())
            .collect();
        let mut work = factor.work();
        let mut ratios = Vec::new();
        for _ in 0..ROUNDS {
            let loads: Vec<Vec<Lane>> = vectors.iter().map(|x| product(scalar, x)).collect();
            // Z = B⁻¹ H X: Zᵀ B Z = Zᵀ (H X), and Zᵀ H Z.
            let moved: Vec<Vec<Lane>> = loads
                .iter()
                .map(|load| {
                    let mut z = load.clone();
                    factor.solve(&mut z, &mut work);
                    z
                })
                .collect();
            let weighed: Vec<Vec<Lane>> = moved.iter().map(|z| product(scalar, z)).collect();
            let Some((found, mixed)) = ritz(&moved, &loads, &weighed) else {
                return Self::default();
            };
            (ratios, vectors) = (found, mixed);
        }
        let count = ratios
            .iter()
            .take(MOST_MODES)
            .take_while(|&&ratio| ratio > 0.0 && ratio < STIFF_ENOUGH)
            .count();
        let mut shapes = Vec::with_capacity(n * count);
        for node in 0..n {
            for vector in &vectors[..count] {
                let [x, y, z, _] = vector[node];
                shapes.push([x as f32, y as f32, z as f32]);
            }
        }
        Self {
            gains: ratios[..count]
                .iter()
                .map(|ratio| 1.0 / ratio - 1.0)
                .collect(),
            shapes,
        }
    }

    /// How many.
    pub(super) fn len(&self) -> usize {
        self.gains.len()
    }

    pub(super) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// Adds `weight` R φ(unknown) of every mode to `to` (modes).
    pub(super) fn add_shapes(
        &self,
        unknown: usize,
        frame: &Frame,
        weight: f64,
        to: &mut [Vector3],
    ) {
        let m = self.len();
        let turned = frame.map(|row| row.map(|x| x * weight));
        for (to, shape) in to
            .iter_mut()
            .zip(&self.shapes[unknown * m..(unknown + 1) * m])
        {
            let s = shape.map(f64::from);
            for (value, row) in to.iter_mut().zip(&turned) {
                *value += row[0] * s[0] + row[1] * s[1] + row[2] * s[2];
            }
        }
    }

    /// Adds φ(unknown)ᵀ Rᵀ f of every mode to `to` (modes).
    pub(super) fn add_work(&self, unknown: usize, frame: &Frame, force: &Vector3, to: &mut [f64]) {
        let m = self.len();
        let [a, b, c] = frame;
        let f: [f64; 3] = std::array::from_fn(|k| a[k] * force.x + b[k] * force.y + c[k] * force.z);
        for (to, shape) in to
            .iter_mut()
            .zip(&self.shapes[unknown * m..(unknown + 1) * m])
        {
            let s = shape.map(f64::from);
            *to += s[0] * f[0] + s[1] * f[1] + s[2] * f[2];
        }
    }

    /// R Σ φ(unknown) amount.
    pub(super) fn moved(&self, unknown: usize, frame: &Frame, amounts: &[f64]) -> Vector3 {
        let m = self.len();
        let mut sum = [0.0; 3];
        for (amount, shape) in amounts
            .iter()
            .zip(&self.shapes[unknown * m..(unknown + 1) * m])
        {
            for (sum, s) in sum.iter_mut().zip(shape) {
                *sum += amount * f64::from(*s);
            }
        }
        let turned = frame.map(|row| row[0] * sum[0] + row[1] * sum[1] + row[2] * sum[2]);
        Vector3::new(turned[0], turned[1], turned[2])
    }
}

fn lane(v: &Vector3) -> Lane {
    [v.x, v.y, v.z, 0.0]
}

/// H x.
fn product(matrix: &SymmetricTriplets, x: &[Lane]) -> Vec<Lane> {
    let mut out = vec![[0.0; 4]; x.len()];
    let mut add = |to: usize, from: usize, value: f64| {
        for c in 0..3 {
            out[to][c] += value * x[from][c];
        }
    };
    for &(i, j, value) in &matrix.entries {
        add(i as usize, j as usize, value);
        if i != j {
            add(j as usize, i as usize, value);
        }
    }
    out
}

fn dot(a: &[Lane], b: &[Lane]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "vectors of one length");
    let terms = a.iter().zip(b);
    terms
        .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        .sum()
}

/// Ritz values of Zᵀ B Z y = λ Zᵀ H Z y, ascending, and vectors Z y with yᵀ Zᵀ H Z y = 1.
fn ritz(
    z: &[Vec<Lane>],
    stiff: &[Vec<Lane>],
    weighed: &[Vec<Lane>],
) -> Option<(Vec<f64>, Vec<Vec<Lane>>)> {
    debug_assert!(
        z.len() == stiff.len() && z.len() == weighed.len(),
        "a product a vector"
    );
    let m = z.len();
    let gram = |other: &[Vec<Lane>]| -> Vec<f64> {
        let mut out = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..=i {
                let value = 0.5 * (dot(&z[i], &other[j]) + dot(&z[j], &other[i]));
                (out[i * m + j], out[j * m + i]) = (value, value);
            }
        }
        out
    };
    // Whitened by the eigenvectors of Zᵀ H Z; directions lost to rounding are left out.
    let (values, axes) = symmetric_eigen(&gram(weighed), m);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..m).filter(|&k| values[k] > 1e-10 * largest).collect();
    let size = kept.len();
    if size == 0 {
        return None;
    }
    let axis = |row: usize, k: usize| axes[row * m + kept[k]] / values[kept[k]].sqrt();
    let stiffness = gram(stiff);
    let mut small = vec![0.0; size * size];
    for a in 0..size {
        for b in 0..size {
            let mut sum = 0.0;
            for i in 0..m {
                for j in 0..m {
                    sum += axis(i, a) * stiffness[i * m + j] * axis(j, b);
                }
            }
            small[a * size + b] = sum;
        }
    }
    let (ratios, mixes) = symmetric_eigen(&small, size);
    let vectors = (0..size).map(|k| {
        let weights: Vec<f64> = (0..m)
            .map(|row| (0..size).map(|a| axis(row, a) * mixes[a * size + k]).sum())
            .collect();
        let mut out = vec![[0.0; 4]; z[0].len()];
        for (vector, weight) in z.iter().zip(&weights) {
            for (out, x) in out.iter_mut().zip(vector) {
                for c in 0..3 {
                    out[c] += weight * x[c];
                }
            }
        }
        out
    });
    let vectors = vectors.collect();
    Some((ratios, vectors))
}
