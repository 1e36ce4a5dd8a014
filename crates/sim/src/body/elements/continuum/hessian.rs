//! Second derivatives: tangents of the step's matrix, and for offline solvers and tests.

use super::block::metrics_of;
use super::kernel::grown;
use super::rest::{sign, slope};
use super::{ContinuumLaw, Points};
use crate::body::cells::Cell;
use crate::body::elements::law::Place;
use nalgebra::{SMatrix, SymmetricEigen};
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Vector3};
use std::collections::BTreeMap;

pub(super) type Block24 = SMatrix<f64, 24, 24>;

/// The triple products of V / 8 by mode, and their factors.
const TRIPLES: [([usize; 3], f64); 4] = [
    ([4, 2, 1], 1.0),
    ([4, 6, 5], 1.0 / 3.0),
    ([2, 3, 6], 1.0 / 3.0),
    ([1, 5, 3], 1.0 / 3.0),
];

/// V, ∂V/∂x_a, and w with ∂²V/∂x_a∂x_b = [w_ab]×.
pub(super) type VolumeDerivatives = (f64, [Vector3; 8], [[Vector3; 8]; 8]);

impl ContinuumLaw {
    /// Hands out blocks (a, b, ∂²Ψ/∂x_a∂x_b), N/m, a >= b, in parts to be added, each cell's matrix without its
    /// negative eigenvalues.
    pub(in crate::body) fn tangent_at(
        &self,
        at: &Place<'_>,
        out: &mut (impl FnMut(u32, u32, Matrix3) + ?Sized),
    ) {
        self.each_cell(|block, lane, cell| {
            let pressure = self.pressure_of(block, lane, at);
            let matrix = self.cell_matrix(block, lane, at.metrics, pressure, at.places);
            let matrix = without_negative(matrix);
            for i in 0..8 {
                for j in 0..8 {
                    if cell[i] >= cell[j] {
                        let block: Matrix3 = matrix.fixed_view::<3, 3>(3 * i, 3 * j).into();
                        out(cell[i], cell[j], block);
                    }
                }
            }
        });
    }

    /// Hands out what patches of cells add to that: k g gᵀ, g = ∂V/∂x by node (m²) and k in N/m⁵.
    pub(in crate::body) fn shared_at(
        &self,
        places: &[Lane],
        out: &mut impl FnMut(&[(u32, Vector3)], f64),
    ) {
        for patch in &self.patches {
            let mut growth: BTreeMap<u32, Vector3> = BTreeMap::new();
            for block in patch.of(&self.blocks) {
                for k in 0..block.count {
                    let cell: Cell = block.nodes.map(|four| four[k]);
                    let (_, of_corners, _) = self.volume_derivatives(&corners(&cell, places));
                    for (&node, slope) in cell.iter().zip(of_corners) {
                        let to = growth.entry(node).or_insert_with(Vector3::zeros);
                        *to += slope * block.winding[k];
                    }
                }
            }
            let growth: Vec<(u32, Vector3)> = growth.into_iter().collect();
            out(&growth, patch.lame_pa / patch.volume_m3);
        }
    }

    /// Hands out ∂²Ψ/∂x² (N/m) of cells by themselves entry by entry, cell after cell: (3 node + axis, 3 node +
    /// axis, value), both triangles, entries of one place to be added. `definite`: each cell's matrix without its
    /// negative eigenvalues.
    pub fn add_hessian(
        &self,
        places: &[Lane],
        definite: bool,
        out: &mut impl FnMut(usize, usize, f64),
    ) {
        self.each_cell(|index, lane, cell| {
            let block = &self.blocks[index];
            let (volume, _, _) = self.volume_derivatives(&corners(cell, places));
            let mut grown_by: Four = [0.0; 4];
            grown(block, Baseline::splat(volume)).store(&mut grown_by);
            let pressure = block.bulk_pa[lane] * grown_by[lane];
            let mut matrix = self.cell_matrix(index, lane, &[], pressure, places);
            if definite {
                matrix = without_negative(matrix);
            }
            for row in 0..24 {
                for column in 0..24 {
                    let place = |k: usize| 3 * cell[k / 3] as usize + k % 3;
                    out(place(row), place(column), matrix[(row, column)]);
                }
            }
        });
    }

    /// Hands out each cell: its block, its lane there, and its nodes.
    fn each_cell(&self, mut out: impl FnMut(usize, usize, &Cell)) {
        for (index, block) in self.blocks.iter().enumerate() {
            for lane in 0..block.count {
                out(index, lane, &block.nodes.map(|four| four[lane]));
            }
        }
    }

    /// q of a cell with what it shares, Pa.
    fn pressure_of(&self, index: usize, lane: usize, at: &Place<'_>) -> f64 {
        let Some((own, shared)) = at.pressures.split_at_checked(self.blocks.len()) else {
            return 0.0;
        };
        let of = |patch: &super::Patch| (patch.first..patch.first + patch.count).contains(&index);
        let patch = self.patches.iter().position(of);
        own[index][lane] + patch.map_or(0.0, |patch| shared.as_flattened()[patch])
    }

    /// ∂²Ψ/∂x² of a cell under a pressure q, with the stiffness of its own volume.
    fn cell_matrix(
        &self,
        index: usize,
        lane: usize,
        metrics: &[Lane],
        pressure_pa: f64,
        places: &[Lane],
    ) -> Block24 {
        let block = &self.blocks[index];
        let cell: Cell = block.nodes.map(|four| four[lane]);
        let x = corners(&cell, places);
        let mut matrix = Block24::zeros();
        match self.points {
            Points::Eight => {
                if let Some(metrics) = metrics_of::<8>(block, metrics, index) {
                    for (gauss, metric) in metrics.iter().enumerate() {
                        let slopes = std::array::from_fn(|corner| slope(gauss, corner));
                        let stiffness_j = block.stiffness_j[gauss][lane];
                        add_shape(
                            &slopes,
                            &matrix_of(metric, lane),
                            stiffness_j,
                            &x,
                            &mut matrix,
                        );
                    }
                }
            }
            Points::Centre => {
                if let Some(metrics) = metrics_of::<1>(block, metrics, index) {
                    let metric = matrix_of(&metrics[0], lane);
                    let stiffness_j = block.stiffness_j[0][lane];
                    add_shape(&centre_slopes(), &metric, stiffness_j, &x, &mut matrix);
                }
            }
        }
        let (_, growth, bend) = self.volume_derivatives(&x);
        let pressure = (pressure_pa - block.shear_pa[lane]) * block.winding[lane];
        let rank_one = block.bulk_pa[lane] * block.per_volume[lane].abs();
        for a in 0..8 {
            for b in 0..8 {
                let part = growth[a] * growth[b].transpose() * rank_one
                    + bend[a][b].cross_matrix() * pressure;
                let mut block = matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                block += part;
            }
        }
        matrix
    }

    /// Of the volume as the law's points see it.
    pub(super) fn volume_derivatives(&self, x: &[Vector3; 8]) -> VolumeDerivatives {
        match self.points {
            Points::Eight => volume_derivatives(x, &TRIPLES),
            Points::Centre => volume_derivatives(x, &TRIPLES[..1]),
        }
    }
}

fn corners(cell: &Cell, places: &[Lane]) -> [Vector3; 8] {
    cell.map(|node| {
        let [x, y, z, _] = places[node as usize];
        Vector3::new(x, y, z)
    })
}

/// The metric of one of four cells.
fn matrix_of(rows: &[Four; 6], lane: usize) -> Matrix3 {
    let [xx, yy, zz, xy, xz, yz] = rows.map(|four| four[lane]);
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// ∂N/∂ξ of the corners at the centre.
pub(super) fn centre_slopes() -> [Vector3; 8] {
    std::array::from_fn(|corner| {
        let half = |bit: usize| if corner & bit != 0 { 0.125 } else { -0.125 };
        Vector3::new(half(4), half(2), half(1))
    })
}

/// What the change of shape at one point adds.
fn add_shape(
    slopes: &[Vector3; 8],
    metric: &Matrix3,
    stiffness_j: f64,
    x: &[Vector3; 8],
    matrix: &mut Block24,
) {
    let mut gradient = Matrix3::zeros();
    for (x, slope) in x.iter().zip(slopes) {
        gradient += x * slope.transpose();
    }
    let across = slopes.map(|slope| metric * slope);
    let pulls = across.map(|slope| gradient * slope);
    let invariant = (gradient * metric * gradient.transpose()).trace();
    let straight = stiffness_j * invariant / (invariant + 1.0);
    let rank_one = 2.0 * stiffness_j / (invariant + 1.0).powi(2);
    for a in 0..8 {
        for b in 0..8 {
            let part = Matrix3::from_diagonal_element(straight * slopes[a].dot(&across[b]))
                + pulls[a] * pulls[b].transpose() * rank_one;
            let mut block = matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
            block += part;
        }
    }
}

fn volume_derivatives(x: &[Vector3; 8], triples: &[([usize; 3], f64)]) -> VolumeDerivatives {
    let mode = |m: usize| -> Vector3 { (0..8).map(|a| x[a] * (0.125 * sign(m, a))).sum() };
    let c: [Vector3; 8] = std::array::from_fn(mode);
    let (mut volume, mut growth, mut bend) =
        (0.0, [Vector3::zeros(); 8], [[Vector3::zeros(); 8]; 8]);
    for (modes, factor) in triples {
        volume += 8.0 * factor * c[modes[0]].dot(&c[modes[1]].cross(&c[modes[2]]));
        for k in 0..3 {
            let [p, q, r] = [modes[k], modes[(k + 1) % 3], modes[(k + 2) % 3]];
            let area = c[q].cross(&c[r]) * *factor;
            for a in 0..8 {
                growth[a] += area * sign(p, a);
                for b in 0..8 {
                    // [p, q, r] = −p · (r × q).
                    let turn = c[r] * (0.125 * factor * sign(p, a) * sign(q, b));
                    bend[a][b] -= turn;
                    bend[b][a] += turn;
                }
            }
        }
    }
    (volume, growth, bend)
}

pub(super) fn without_negative(matrix: Block24) -> Block24 {
    // A matrix with a factor has none.
    let lifted = matrix + Block24::from_diagonal_element(1e-12 * matrix.trace());
    if lifted.cholesky().is_some() {
        return matrix;
    }
    let SymmetricEigen {
        eigenvalues,
        eigenvectors,
    } = SymmetricEigen::new(matrix);
    let kept = eigenvalues.map(|value| value.max(0.0));
    eigenvectors * Block24::from_diagonal(&kept) * eigenvectors.transpose()
}
