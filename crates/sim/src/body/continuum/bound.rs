//! The scalar matrix that stands for the tangent in the implicit step.

use super::{ContinuumLaw, Elastic, RestCell};
use std::collections::BTreeMap;

/// How far above the least stable weight of rest the matrix is, so that strained cells can be
/// followed too: at ν = 0.3 a cell is held back once I_C is 15 % above that of rest.
const MARGIN: f64 = 1.25;

/// Weight of the Laplacian, Pa.
///
/// The step `(M / dt² + L) Δ = M v / dt + f` is stable while L ≥ K / 2. At rest K is at most 2 μ +
/// 3 λ times the Laplacian of the same quadrature (pure dilatation, which a free body can do), and
/// λ + 2 μ makes L the matrix of backward Euler for waves of compression.
pub(super) fn weight_pa(elastic: &Elastic) -> f64 {
    let (shear, lame) = elastic.lame_pa();
    MARGIN * (lame + 2.0 * shear).max(1.5 * lame + shear)
}

impl ContinuumLaw {
    /// L = Σ k (e_a − e_b)(e_a − e_b)ᵀ as (a, b, k), a < b, ordered, N/m: the Laplacian of the
    /// cells with the weight that keeps the step stable. Some k are negative or zero (edges of a
    /// cube); their sum is positive semidefinite.
    pub fn bounding_springs(&self) -> Vec<(u32, u32, f64)> {
        let mut springs: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let rest = RestCell::new(&self.rest, cell);
            let weight = weight_pa(elastic);
            for i in 0..8 {
                for j in i + 1..8 {
                    let (a, b) = (cell[i].min(cell[j]), cell[i].max(cell[j]));
                    if a != b {
                        let product = |gauss: usize| {
                            rest.weights[gauss]
                                * rest.gradients[gauss][i].dot(&rest.gradients[gauss][j])
                        };
                        *springs.entry((a, b)).or_insert(0.0) -=
                            weight * (0..8).map(product).sum::<f64>();
                    }
                }
            }
        }
        springs.into_iter().map(|((a, b), k)| (a, b, k)).collect()
    }
}
