//! A cell at rest: what its 2 × 2 × 2 Gauss points know, and how good it is.

use crate::body::cells::{Cell, shape_slopes};
use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// Places of the two Gauss points on [−1, 1].
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;

/// +1 where corner or Gauss point `at` has all or an even number of the bits of `mode` missing,
/// else −1: the sign of the monomial `mode` (4 ξ, 2 η, 1 ζ) there.
pub(super) fn sign(mode: usize, at: usize) -> f64 {
    if (mode & !at).count_ones().is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

/// Gradients and volumes of a cell at rest.
pub(super) struct RestCell {
    /// (Gauss point, corner): ∇N, 1/m. Corners that share a node keep a gradient each.
    pub gradients: [[Vector3; 8]; 8],
    /// (Gauss point): J₀⁻¹ J₀⁻ᵀ, 1/m², J₀ = ∂X/∂ξ.
    pub metrics: [Matrix3; 8],
    /// (Gauss point): share of the cell's volume, m³.
    pub weights: [f64; 8],
    /// Volume, m³, negative if the corners wind the other way.
    pub volume: f64,
}

/// How a cell fills its volume at rest.
pub(super) struct RestShape {
    /// (Gauss point): J₀ = ∂X/∂ξ.
    maps: [Matrix3; 8],
    /// (Gauss point): its determinant, m³.
    jacobians: [f64; 8],
    /// Volume, m³, negative if the corners wind the other way.
    pub volume: f64,
    /// Least share of the volume at a Gauss point over the mean share; zero or less if the map
    /// folds there.
    pub evenness: f64,
}

impl RestShape {
    pub fn new(nodes: &[Point3], cell: &Cell) -> Self {
        let corners = cell.map(|node| nodes[node as usize].coords);
        let mut shape = Self {
            maps: [Matrix3::zeros(); 8],
            jacobians: [0.0; 8],
            volume: 0.0,
            evenness: 0.0,
        };
        for (gauss, map) in shape.maps.iter_mut().enumerate() {
            for (corner, [x, y, z]) in corners.iter().zip(SLOPES[gauss]) {
                *map += corner * Vector3::new(x, y, z).transpose();
            }
            shape.jacobians[gauss] = map.determinant();
            shape.volume += shape.jacobians[gauss];
        }
        let share = shape.volume / 8.0;
        if share != 0.0 {
            let shares = shape.jacobians.iter().map(|j| j / share);
            shape.evenness = shares.fold(f64::INFINITY, f64::min);
        }
        shape
    }
}

impl RestCell {
    pub fn new(nodes: &[Point3], cell: &Cell) -> Self {
        let shape = RestShape::new(nodes, cell);
        let mut rest = Self {
            gradients: [[Vector3::zeros(); 8]; 8],
            metrics: [Matrix3::zeros(); 8],
            weights: [0.0; 8],
            volume: shape.volume,
        };
        for (gauss, map) in shape.maps.iter().enumerate() {
            let Some(inverse) = map.try_inverse() else {
                continue;
            };
            let gradient = |corner| inverse.transpose() * slope(gauss, corner);
            rest.gradients[gauss] = std::array::from_fn(gradient);
            rest.metrics[gauss] = inverse * inverse.transpose();
            rest.weights[gauss] = shape.jacobians[gauss].abs();
        }
        rest
    }
}

/// (Gauss point, corner): ∂N/∂ξ.
const SLOPES: [[[f64; 3]; 8]; 8] = shape_slopes(
    [
        [0.5 * (1.0 + GAUSS), 0.5 * (1.0 - GAUSS)],
        [0.5 * (1.0 - GAUSS), 0.5 * (1.0 + GAUSS)],
    ],
    0.5,
);

/// ∂N/∂ξ of a corner at a Gauss point.
pub(super) fn slope(gauss: usize, corner: usize) -> Vector3 {
    Vector3::from(SLOPES[gauss][corner])
}

/// Least scaled Jacobian, det(e₁, e₂, e₃) / |e₁||e₂||e₃|, over the corners whose three edges lead
/// to three other nodes; corners where edges have collapsed have no such number and are left to
/// [`RestShape::evenness`]. Positive for a cell that does not fold whichever way it winds. `None` if
/// every corner has collapsed.
pub(super) fn scaled_jacobian(nodes: &[Point3], cell: &Cell, volume: f64) -> Option<f64> {
    let mut least: Option<f64> = None;
    for corner in 0..8 {
        let ends = [corner ^ 4, corner ^ 2, corner ^ 1].map(|end| cell[end]);
        let regular = ends.iter().all(|&end| end != cell[corner])
            && ends[0] != ends[1]
            && ends[1] != ends[2]
            && ends[2] != ends[0];
        if !regular {
            continue;
        }
        let edges = ends.map(|end| nodes[end as usize] - nodes[cell[corner] as usize]);
        // An edge that runs against its axis turns the frame over: three of them at corner 7, none
        // at corner 0.
        let turn = -sign(7, corner) * volume.signum();
        let value = Matrix3::from_columns(&edges).determinant() * turn
            / edges.iter().map(|e| e.norm()).product::<f64>();
        let value = if value.is_finite() { value } else { 0.0 };
        least = Some(least.map_or(value, |other| other.min(value)));
    }
    least
}
