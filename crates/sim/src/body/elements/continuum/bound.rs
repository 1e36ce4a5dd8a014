//! The scalar matrix that stands for the tangent in the implicit step.

use super::elastic::Elastic;
use super::hessian::{cell_hessian, cell_tangent, without_negative};
use super::rest::RestCell;
use super::{ContinuumLaw, patch};
use crate::body::cells::Cell;
use crate::body::elements::{Edge, ForceLaw, Weight};
use palpate_geometry::math::{Lane, Matrix3, Vector3};
use std::collections::BTreeMap;

/// How much stiffer than at rest shear and volume are in the tangent of the step. Volume costs
/// little: its waves are faster than a tick.
const SHEAR_MARGIN: f64 = 1.1;
const VOLUME_MARGIN: f64 = 1.5;
/// λ / μ up to which those margins do: ν = 0.476.
const LEAST_LAME: f64 = 20.0;

/// How much farther than the bounding matrix the tangent of the step follows cells.
pub(in crate::body) const TANGENT_REACH: f64 = 1.6;

/// Weight of the Laplacian that gives way as an elastic half-space does, Pa.
fn response_pa(elastic: &Elastic) -> f64 {
    elastic.lame_pa().0 / (1.0 - elastic.poisson)
}

impl ForceLaw for ContinuumLaw {
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane], farther: f64) -> u32 {
        (self.add_forces_reaching(&[], places, residual, farther)).limited
    }

    fn energy_j(&self, places: &[Lane]) -> f64 {
        self.energy_j(places)
    }

    fn edges(&self, of: Weight) -> Vec<Edge> {
        let mut edges = self.laplacian(of);
        if of == Weight::Steepest {
            // The step follows tangents up to 4/3 of its own matrix.
            edges.iter_mut().for_each(|(_, _, k)| *k *= 4.0 / 3.0);
        }
        edges
    }

    fn tangent_at_rest(&self, strain: f64, out: &mut dyn FnMut(u32, u32, Matrix3)) {
        self.tangent_at_points(strain, out);
    }
}

impl ContinuumLaw {
    /// L = Σ k (e_a − e_b)(e_a − e_b)ᵀ as (a, b, k), a < b, ordered, N/m: the Laplacian of the
    /// cells. Some k are negative or zero (edges of a cube); their sum is positive semidefinite.
    pub fn laplacian(&self, of: Weight) -> Vec<(u32, u32, f64)> {
        let mut springs: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let rest = RestCell::new(&self.rest, cell);
            let weight = match of {
                Weight::Bounding | Weight::Steepest => elastic.bounding_pa(),
                Weight::Firm => 2.0 * elastic.lame_pa().0,
                Weight::Response => response_pa(elastic),
            };
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

    /// Hands out blocks (a, b, ∂²Ψ/∂x_a∂x_b), N/m, at rest, a >= b, in parts to be added, with shear
    /// and volume a little stiffer than they are, so that nearly incompressible cells can be followed
    /// up to a `strain`.
    pub(in crate::body) fn tangent_at_points(
        &self,
        strain: f64,
        out: &mut (impl FnMut(u32, u32, Matrix3) + ?Sized),
    ) {
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let (shear, lame) = self.kept_with_margins(elastic, strain);
            let stiffer = Elastic {
                young_pa: shear * (3.0 * lame + 2.0 * shear) / (lame + shear),
                poisson: 0.5 * lame / (lame + shear),
            };
            cell_tangent(&self.rest, cell, &stiffer, out);
        }
    }

    /// The blocks of the tangent at rest of cells that are integrated at their centres: K = V (λ g_i g_jᵀ + μ g_j g_iᵀ + μ g_i ·
    /// g_j I) with the gradients g of the corners there (linear elasticity, which every energy without stress at
    /// rest comes to).
    pub(in crate::body) fn tangent_at_centres(
        &self,
        strain: f64,
        out: &mut (impl FnMut(u32, u32, Matrix3) + ?Sized),
    ) {
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let (shear, lame) = self.kept_with_margins(elastic, strain);
            let (gradients, volume) = self.gradients_at_centre(cell);
            for (i, a) in gradients.iter().enumerate() {
                for (j, b) in gradients.iter().enumerate() {
                    if cell[i] >= cell[j] {
                        let block = a * b.transpose() * lame
                            + (b * a.transpose() + Matrix3::from_diagonal_element(a.dot(b)))
                                * shear;
                        out(cell[i], cell[j], block * volume);
                    }
                }
            }
        }
    }

    /// Hands out what patches of cells add to the tangent at rest: k g gᵀ, g by node (m²) and k in N/m⁵.
    pub(in crate::body) fn shared_at_rest(&self, out: &mut impl FnMut(&[(u32, Vector3)], f64)) {
        for patch in &self.patches {
            let growth = patch.growth(&self.blocks, |cell| {
                let (gradients, volume) = self.gradients_at_centre(cell);
                gradients.map(|gradient| gradient * volume)
            });
            out(&growth, VOLUME_MARGIN * patch.lame_pa / patch.volume_m3);
        }
    }

    /// μ and λ of the tangent, Pa, with their margins, of what cells do not share.
    fn kept_with_margins(&self, elastic: &Elastic, strain: f64) -> (f64, f64) {
        let (shear, lame) = with_margins(elastic, strain);
        match self.patches.is_empty() {
            true => (shear, lame),
            false => (shear, with_margins(&patch::own(elastic), strain).1),
        }
    }

    /// Hands out ∂²Ψ/∂x² (N/m) entry by entry, cell after cell: (3 node + axis, 3 node + axis,
    /// value), both triangles, entries of one place to be added. `definite`: each cell's matrix
    /// without its negative eigenvalues. No cell is held back here.
    pub fn add_hessian(
        &self,
        places: &[Lane],
        definite: bool,
        out: &mut impl FnMut(usize, usize, f64),
    ) {
        for (cell, elastic) in self.cells.iter().zip(&self.materials) {
            let rest = RestCell::new(&self.rest, cell);
            let x = cell.map(|node| {
                let [x, y, z, _] = places[node as usize];
                Vector3::new(x, y, z)
            });
            let mut matrix = cell_hessian(&rest, elastic, &x);
            if definite {
                matrix = without_negative(matrix);
            }
            for row in 0..24 {
                for column in 0..24 {
                    let place = |k: usize| 3 * cell[k / 3] as usize + k % 3;
                    out(place(row), place(column), matrix[(row, column)]);
                }
            }
        }
    }

    /// Gradients of the corners at the centre of a cell at rest, 1/m, and its volume by them, m³.
    fn gradients_at_centre(&self, cell: &Cell) -> ([Vector3; 8], f64) {
        let slopes: [Vector3; 8] = std::array::from_fn(|corner| {
            let slope = |bit: usize| if corner & bit != 0 { 0.125 } else { -0.125 };
            Vector3::new(slope(4), slope(2), slope(1))
        });
        let places = cell.iter().zip(&slopes);
        let map: Matrix3 = places
            .map(|(&node, slope)| self.rest[node as usize].coords * slope.transpose())
            .sum();
        // A cell without volume at its centre has been refused.
        let inverse = map.try_inverse().unwrap_or_else(Matrix3::zeros);
        let gradients = slopes.map(|slope| inverse.transpose() * slope);
        (gradients, 8.0 * map.determinant().abs())
    }
}

/// μ and λ of the tangent, Pa, with their margins.
fn with_margins(elastic: &Elastic, strain: f64) -> (f64, f64) {
    let (shear, lame) = elastic.lame_pa();
    // Strain turns the gradient of volume against that of rest, and what is only shear there
    // meets a share of λ.
    let turned = strain * strain * (lame - LEAST_LAME * shear).max(0.0);
    (SHEAR_MARGIN * shear + turned, VOLUME_MARGIN * lame)
}
