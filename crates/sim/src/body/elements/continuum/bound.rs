//! The scalar matrix above the tangent of a solid: what explicit steps must resolve.

use super::ContinuumLaw;
use super::rest::RestCell;
use crate::body::elements::law::{Edge, ForceLaw, Place};
use palpate_geometry::math::{Lane, Matrix3};
use std::collections::BTreeMap;

impl ForceLaw for ContinuumLaw {
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        self.add_forces_of(&[], None, places, residual);
    }

    fn energy_j(&self, places: &[Lane]) -> f64 {
        self.energy_j(places)
    }

    fn parts(&self) -> Vec<Vec<u32>> {
        self.nodes_of_parts()
    }

    fn part_count(&self) -> usize {
        self.part_count()
    }

    fn add_forces_of_parts(&self, parts: (&[u32], u32), places: &[Lane], residual: &mut [Lane]) {
        self.add_forces_of_some(parts, &[], None, places, residual);
    }

    fn edges(&self) -> Vec<Edge> {
        self.laplacian()
    }

    fn tangent_at(&self, at: &Place<'_>, out: &mut dyn FnMut(u32, u32, Matrix3)) {
        let own = Place {
            metrics: &[],
            pressures: &[],
            ..*at
        };
        self.tangent_at(&own, out);
    }
}

impl ContinuumLaw {
    /// L = Σ k (e_a − e_b)(e_a − e_b)ᵀ as (a, b, k), a < b, ordered, N/m: a Laplacian above the tangent of cells
    /// that are strained a little. Some k are negative or zero (edges of a cube); their sum is positive semidefinite.
    pub fn laplacian(&self) -> Vec<(u32, u32, f64)> {
        let mut springs: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let rest = RestCell::new(&self.rest, cell);
            let weight = elastic.steepest_pa();
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
