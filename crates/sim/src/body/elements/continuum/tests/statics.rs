//! Equilibria by Newton's method: no step, no contact.

use super::*;
use crate::body::elements::continuum::rest::RestCell;
use palpate_geometry::math::{Cholesky, SymmetricTriplets};

/// What Newton's method needs of an elastic solid.
pub(super) trait Elastostatic {
    fn rest(&self) -> &[Point3];
    /// −∂Ψ/∂x by node, N.
    fn forces(&self, places: &[Lane]) -> Vec<Vector3>;
    /// ∂²Ψ/∂x² entry by entry, both triangles, as [`ContinuumLaw::add_hessian`] hands it out.
    fn tangent(&self, places: &[Lane], out: &mut dyn FnMut(usize, usize, f64));
}

impl Elastostatic for ContinuumLaw {
    fn rest(&self) -> &[Point3] {
        ContinuumLaw::rest(self)
    }

    fn forces(&self, places: &[Lane]) -> Vec<Vector3> {
        self.forces(places)
    }

    fn tangent(&self, places: &[Lane], out: &mut dyn FnMut(usize, usize, f64)) {
        self.add_hessian(places, false, &mut |i, j, value| out(i, j, value));
    }
}

/// Newton from rest to the equilibrium with `places` of the fixed coordinates given and loads on
/// the others. Answers with the places.
pub(super) fn equilibrium(
    solid: &dyn Elastostatic,
    fixed: &dyn Fn(&Point3, usize) -> Option<f64>,
    load: &dyn Fn(usize) -> Vector3,
) -> Vec<Lane> {
    let mut places = lanes(solid.rest());
    let mut rows = Vec::new();
    for (node, p) in solid.rest().iter().enumerate() {
        for axis in 0..3 {
            match fixed(p, axis) {
                Some(moved) => places[node][axis] += moved,
                None => rows.push(3 * node + axis),
            }
        }
    }
    let mut row_of = vec![usize::MAX; 3 * places.len()];
    rows.iter()
        .enumerate()
        .for_each(|(row, &coordinate)| row_of[coordinate] = row);
    for _ in 0..12 {
        let mut matrix = SymmetricTriplets::new(rows.len());
        solid.tangent(&places, &mut |i, j, value| {
            if i >= j && row_of[i] != usize::MAX && row_of[j] != usize::MAX {
                matrix.add(row_of[i], row_of[j], value);
            }
        });
        let force = solid.forces(&places);
        let residual = |&coordinate: &usize| {
            let (node, axis) = (coordinate / 3, coordinate % 3);
            force[node][axis] + load(node)[axis]
        };
        let mut step: Vec<f64> = rows.iter().map(residual).collect();
        Cholesky::new(&matrix)
            .expect("small strains keep the tangent definite")
            .solve_one(&mut step);
        for (moved, &coordinate) in step.iter().zip(&rows) {
            places[coordinate / 3][coordinate % 3] += moved;
        }
        if step.iter().all(|moved| moved.abs() < 1e-13) {
            break;
        }
    }
    places
}

/// Forces from outside that hold the nodes at their places, N.
pub(super) fn reactions(solid: &dyn Elastostatic, places: &[Lane]) -> Vec<Vector3> {
    solid.forces(places).into_iter().map(|f| -f).collect()
}

/// Sum of those on the nodes that pass, N.
pub(super) fn reaction(
    solid: &dyn Elastostatic,
    places: &[Lane],
    on: impl Fn(&Point3) -> bool,
) -> Vector3 {
    solid
        .rest()
        .iter()
        .zip(reactions(solid, places))
        .filter(|(p, _)| on(p))
        .map(|(_, f)| f)
        .sum()
}

/// The textbook's linear hexahedra with 2 × 2 × 2 points for all of the energy: what a continuum
/// without mean dilatation would be.
pub(super) struct Textbook {
    grid: CellGrid,
    /// ∂²Ψ/∂x², (3 node + axis, 3 node + axis, N/m).
    entries: Vec<(usize, usize, f64)>,
}

impl Textbook {
    pub(super) fn new(grid: &CellGrid, elastic: &Elastic) -> Self {
        let (shear, lame) = elastic.lame_pa();
        let mut entries = Vec::new();
        for cell in &grid.cells {
            let rest = RestCell::new(&grid.nodes, cell);
            for (gradients, weight) in rest.gradients.iter().zip(&rest.weights) {
                for (a, ga) in cell.iter().zip(gradients) {
                    for (b, gb) in cell.iter().zip(gradients) {
                        // λ ∇a ∇bᵀ + μ ∇b ∇aᵀ + μ ∇a·∇b: σ = λ tr ε + 2 μ ε.
                        let block =
                            (ga * gb.transpose() * lame + gb * ga.transpose() * shear) * *weight;
                        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                            let straight = if i == j {
                                shear * ga.dot(gb) * weight
                            } else {
                                0.0
                            };
                            let place = (3 * *a as usize + i, 3 * *b as usize + j);
                            entries.push((place.0, place.1, block[(i, j)] + straight));
                        }
                    }
                }
            }
        }
        Self {
            grid: grid.clone(),
            entries,
        }
    }
}

impl Elastostatic for Textbook {
    fn rest(&self) -> &[Point3] {
        &self.grid.nodes
    }

    fn forces(&self, places: &[Lane]) -> Vec<Vector3> {
        let mut forces = vec![Vector3::zeros(); places.len()];
        for &(i, j, value) in &self.entries {
            forces[i / 3][i % 3] -= value * (places[j / 3][j % 3] - self.grid.nodes[j / 3][j % 3]);
        }
        forces
    }

    fn tangent(&self, _: &[Lane], out: &mut dyn FnMut(usize, usize, f64)) {
        self.entries
            .iter()
            .for_each(|&(i, j, value)| out(i, j, value));
    }
}
