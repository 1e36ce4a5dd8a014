//! Second derivatives, for offline solvers and tests.

use super::elastic::Elastic;
use super::rest::RestCell;
use super::rest::sign;
use crate::body::cells::Cell;
use nalgebra::{SMatrix, SymmetricEigen};
use palpate_geometry::math::{Matrix3, Point3, Vector3};

pub(super) type Block24 = SMatrix<f64, 24, 24>;

/// The triple products of V / 8 by mode, and their factors.
const TRIPLES: [([usize; 3], f64); 4] = [
    ([4, 2, 1], 1.0),
    ([4, 6, 5], 1.0 / 3.0),
    ([2, 3, 6], 1.0 / 3.0),
    ([1, 5, 3], 1.0 / 3.0),
];

pub(super) fn cell_hessian(rest: &RestCell, elastic: &Elastic, x: &[Vector3; 8]) -> Block24 {
    let (shear, lame) = elastic.lame_pa();
    let (stiffness, bulk) = (4.0 / 3.0 * shear, lame + 5.0 / 6.0 * shear);
    let mut matrix = Block24::zeros();
    for gauss in 0..8 {
        let gradients = &rest.gradients[gauss];
        let mut f = Matrix3::zeros();
        for (x, gradient) in x.iter().zip(gradients) {
            f += x * gradient.transpose();
        }
        let invariant = f.norm_squared();
        let factor = stiffness * rest.weights[gauss];
        let straight = factor * invariant / (invariant + 1.0);
        let rank_one = 2.0 * factor / (invariant + 1.0).powi(2);
        let pulls = gradients.map(|gradient| f * gradient);
        for a in 0..8 {
            for b in 0..8 {
                let part =
                    Matrix3::from_diagonal_element(straight * gradients[a].dot(&gradients[b]))
                        + pulls[a] * pulls[b].transpose() * rank_one;
                let mut block = matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                block += part;
            }
        }
    }
    let (volume, growth, bend) = volume_derivatives(x);
    let pressure = (bulk * (volume / rest.volume - 1.0) - shear) * rest.volume.signum();
    let rank_one = bulk / rest.volume.abs();
    for a in 0..8 {
        for b in 0..8 {
            let part =
                growth[a] * growth[b].transpose() * rank_one + bend[a][b].cross_matrix() * pressure;
            let mut block = matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b);
            block += part;
        }
    }
    matrix
}

/// V, ∂V/∂x_a, and w with ∂²V/∂x_a∂x_b = [w_ab]×.
fn volume_derivatives(x: &[Vector3; 8]) -> (f64, [Vector3; 8], [[Vector3; 8]; 8]) {
    let mode = |m: usize| -> Vector3 { (0..8).map(|a| x[a] * (0.125 * sign(m, a))).sum() };
    let c: [Vector3; 8] = std::array::from_fn(mode);
    let (mut volume, mut growth, mut bend) =
        (0.0, [Vector3::zeros(); 8], [[Vector3::zeros(); 8]; 8]);
    for (modes, factor) in TRIPLES {
        volume += 8.0 * factor * c[modes[0]].dot(&c[modes[1]].cross(&c[modes[2]]));
        for k in 0..3 {
            let [p, q, r] = [modes[k], modes[(k + 1) % 3], modes[(k + 2) % 3]];
            let area = c[q].cross(&c[r]) * factor;
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
    let SymmetricEigen {
        eigenvalues,
        eigenvectors,
    } = SymmetricEigen::new(matrix);
    if eigenvalues.iter().all(|&value| value >= 0.0) {
        return matrix;
    }
    let kept = eigenvalues.map(|value| value.max(0.0));
    eigenvectors * Block24::from_diagonal(&kept) * eigenvectors.transpose()
}

/// The blocks of one cell at rest.
pub(super) fn cell_tangent(
    nodes: &[Point3],
    cell: &Cell,
    elastic: &Elastic,
    out: &mut (impl FnMut(u32, u32, Matrix3) + ?Sized),
) {
    let rest = RestCell::new(nodes, cell);
    let x = cell.map(|node| nodes[node as usize].coords);
    let matrix = cell_hessian(&rest, elastic, &x);
    for i in 0..8 {
        for j in 0..8 {
            if cell[i] >= cell[j] {
                let block: Matrix3 = matrix.fixed_view::<3, 3>(3 * i, 3 * j).into();
                out(cell[i], cell[j], block);
            }
        }
    }
}
