//! Backward Euler by projective dynamics (Bouaziz et al. 2014) with one constant matrix
//! `A = M / dt² + (1 + d / dt) Wᵀ L W`, `L = Σ k (e_a − e_b)(e_a − e_b)ᵀ`, factored at build.
//!
//! We solve for increments, `A Δ = M (v / dt + g) + f(x)`, so that rest is rest to the last bit, an
//! error is relative to the motion, not to the position, and equilibrium does not depend on A.

use super::matter::{FIXED, Matter, lanes};
use super::node_map::NodeMap;
use super::settings::DeformableError;
use super::state::{DeformableScratch, DeformableState};
use palpate_geometry::math::{Cholesky, SymmetricTriplets, Vector3};

/// The factor, and what further iterations need.
#[derive(Debug)]
pub(super) struct ImplicitStep {
    factor: Cholesky,
    iterations: usize,
    /// Edges that damp, k d / dt; empty for a single iteration, whose guess has not moved.
    damping: Vec<(u32, u32, f64)>,
}

impl ImplicitStep {
    pub(super) fn new(matter: &Matter, iterations: usize) -> Result<Self, DeformableError> {
        let (dt, damping_s) = (matter.settings.dt_s, matter.damping_s);
        let mut matrix = SymmetricTriplets::new(matter.unknown_count());
        for (row, &coordinate) in matter.coordinate_of_unknown.iter().enumerate() {
            matrix.add(row, row, matter.masses[coordinate as usize] / (dt * dt));
        }
        let edges = matter.law_edges();
        let scaled: Vec<_> = edges
            .iter()
            .map(|&(a, b, k)| (a, b, k * (1.0 + damping_s / dt)))
            .collect();
        matter
            .map
            .add_edges(&scaled, |c| matter.unknown(c as usize), &mut matrix);
        let factor = Cholesky::new(&matrix)?;
        let again = iterations > 1 && damping_s > 0.0;
        let damping = if again {
            edges
                .iter()
                .map(|&(a, b, k)| (a, b, k * damping_s / dt))
                .collect()
        } else {
            Vec::new()
        };
        Ok(Self {
            factor,
            iterations,
            damping,
        })
    }

    pub(super) fn iterations(&self) -> usize {
        self.iterations
    }

    pub(super) fn factor_non_zeros(&self) -> usize {
        self.factor.non_zeros()
    }

    /// A⁻¹ e of each of the given coordinates.
    pub(super) fn columns(&self, matter: &Matter, surface: &[u32]) -> Vec<f64> {
        let n = self.factor.n();
        let mut columns = Vec::with_capacity(surface.len() * n);
        for &coordinate in surface {
            let start = columns.len();
            columns.resize(start + n, 0.0);
            columns[start + matter.unknown[coordinate as usize] as usize] = 1.0;
            self.factor.solve_one(&mut columns[start..]);
        }
        columns
    }

    /// The first iteration, from where the body is.
    pub(super) fn predict(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        scratch.predicted.copy_from_slice(&state.positions);
        self.correct(matter, state, scratch, false);
    }

    /// One more, from the guess in `predicted`.
    pub(super) fn again(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        self.correct(matter, state, scratch, true);
    }

    /// Adds A⁻¹ of the residual of backward Euler, without contact, to the guess.
    fn correct(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        has_moved: bool,
    ) {
        let inverse_dt = 1.0 / matter.settings.dt_s;
        for c in 0..state.positions.len() {
            let moved = scratch.predicted[c] - state.positions[c];
            let due = (state.velocities[c] - moved * inverse_dt) * inverse_dt
                + scratch.field.at(&state.positions[c], &state.velocities[c]);
            let load = due * matter.masses[c];
            scratch.residual[c] = [load.x, load.y, load.z, 0.0];
        }
        if has_moved {
            self.add_damping(matter, state, scratch);
        }
        lanes(&scratch.predicted, &mut scratch.coordinates);
        matter.add_law_forces(state, scratch);
        for (rhs, &c) in scratch.rhs.iter_mut().zip(&matter.coordinate_of_unknown) {
            let [x, y, z, _] = scratch.residual[c as usize];
            *rhs = Vector3::new(x, y, z);
        }
        self.factor.solve(&mut scratch.rhs, &mut scratch.lanes);
        for (moved, &c) in scratch.rhs.iter().zip(&matter.coordinate_of_unknown) {
            scratch.predicted[c as usize] += *moved;
        }
    }

    /// −(d / dt) L (x − x_now) of the guess.
    fn add_damping(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        if self.damping.is_empty() {
            return;
        }
        let DeformableScratch {
            predicted,
            coordinates,
            nodes,
            residual,
            node_residual,
            ..
        } = scratch;
        for ((lane, guess), now) in coordinates
            .iter_mut()
            .zip(predicted.iter())
            .zip(&state.positions)
        {
            let moved = guess - now;
            *lane = [moved.x, moved.y, moved.z, 0.0];
        }
        match &matter.map {
            NodeMap::Same => add_edges(&self.damping, coordinates, residual),
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                node_residual.fill([0.0; 4]);
                add_edges(&self.damping, nodes, node_residual);
                map.add_transposed(node_residual, residual);
            }
        }
    }
}

/// r −= Σ k (e_a − e_b)(e_a − e_b)ᵀ x.
pub(super) fn add_edges(edges: &[(u32, u32, f64)], x: &[[f64; 4]], r: &mut [[f64; 4]]) {
    for &(a, b, k) in edges {
        let (a, b) = (a as usize, b as usize);
        for c in 0..3 {
            let force = k * (x[b][c] - x[a][c]);
            r[a][c] += force;
            r[b][c] -= force;
        }
    }
}

/// Greatest squared frequency that a body can have, 1/s²: Gershgorin's bound of M⁻¹ L over
/// coordinates.
pub(super) fn greatest_frequency_squared(matter: &Matter) -> f64 {
    let mut sums = vec![0.0; matter.unknown_count()];
    let mut matrix = SymmetricTriplets::new(matter.unknown_count());
    matter.map.add_edges(
        &matter.law.steepest_edges(),
        |c| matter.unknown(c as usize),
        &mut matrix,
    );
    // Entries may be given in parts; their sizes then only grow the bound.
    for &(i, j, value) in &matrix.entries {
        sums[i as usize] += value.abs();
        if i != j {
            sums[j as usize] += value.abs();
        }
    }
    let mass = |row: usize| matter.masses[matter.coordinate_of_unknown[row] as usize];
    debug_assert!(matter.unknown.iter().filter(|&&u| u != FIXED).count() == sums.len());
    sums.iter()
        .enumerate()
        .map(|(row, sum)| sum / mass(row))
        .fold(0.0, f64::max)
}
