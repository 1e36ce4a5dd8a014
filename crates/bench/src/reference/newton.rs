//! Newton's method with line search on the energy of body and contact.

use super::{Equilibrium, Obstacle, Reference, ReferenceError, Sample, place};
use palpate_geometry::math::{Lane, Vector3};
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

const STEPS: usize = 100;
/// Force left on a node, over the largest contact force or load. Much below this, a sample that
/// barely touches can switch on and off with every step, and the energies are too rounded for the
/// line search to see it.
const TOLERANCE: f64 = 1e-6;

/// Moves `state.places` to the minimum of φ with its multipliers; answers with the steps made.
pub(super) fn minimise(
    problem: &Reference<'_>,
    state: &mut Equilibrium,
    obstacle: Option<&Obstacle>,
    load_n: &dyn Fn(usize) -> Vector3,
) -> Result<usize, ReferenceError> {
    let merit = Merit {
        problem,
        multipliers_n: &state.multipliers_n,
        obstacle,
        load_n,
    };
    let (mut residual_n, mut scale_n) = (0.0, 0.0);
    for step in 0..STEPS {
        let (gradient, scale) = merit.gradient(&state.places);
        residual_n = gradient.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        scale_n = scale;
        if residual_n <= TOLERANCE * scale_n {
            return Ok(step);
        }
        // The true tangent first: the definite one converges too, but only linearly.
        let direction = match merit.solve(&state.places, &gradient, false) {
            Ok(direction) => direction,
            Err(_) => merit.solve(&state.places, &gradient, true)?,
        };
        let descent: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let here = merit.value(&state.places);
        let mut length = 1.0;
        let mut best = merit.moved(&state.places, &direction, length);
        // Armijo, with room for the rounding of the energies.
        while merit.value(&best) > here + 1e-4 * length * descent + 1e-13 * here.abs()
            && length > 1e-6
        {
            length *= 0.5;
            best = merit.moved(&state.places, &direction, length);
        }
        state.places = best;
    }
    Err(ReferenceError::Newton {
        steps: STEPS,
        residual_n,
        scale_n,
    })
}

struct Merit<'a> {
    problem: &'a Reference<'a>,
    multipliers_n: &'a [f64],
    obstacle: Option<&'a Obstacle>,
    load_n: &'a dyn Fn(usize) -> Vector3,
}

impl Merit<'_> {
    /// Samples that may touch, with their force max(0, λ − r g), ∂g and ∂²g.
    fn contacts<'s>(
        &'s self,
        places: &'s [Lane],
    ) -> impl Iterator<Item = (&'s Sample, f64, f64, Vector3, palpate_geometry::math::Matrix3)> + 's {
        let samples = self.problem.samples.iter().zip(self.multipliers_n);
        samples.filter_map(move |(sample, &multiplier)| {
            let (gap, normal, bend) = self.obstacle?.gap(&place(sample, places));
            let force = (multiplier - self.problem.penalty_n_m * gap).max(0.0);
            (force > 0.0 || multiplier > 0.0).then_some((sample, multiplier, force, normal, bend))
        })
    }

    fn value(&self, places: &[Lane]) -> f64 {
        let mut value = self.problem.solid.energy_j(places);
        for (_, multiplier, force, _, _) in self.contacts(places) {
            value += (force * force - multiplier * multiplier) / (2.0 * self.problem.penalty_n_m);
        }
        for (node, p) in places.iter().enumerate() {
            value -= (self.load_n)(node)
                .dot(&(Vector3::new(p[0], p[1], p[2]) - self.problem.solid.rest()[node].coords));
        }
        value
    }

    /// ∂φ/∂x of the free coordinates, N, and the size of the forces in it.
    fn gradient(&self, places: &[Lane]) -> (Vec<f64>, f64) {
        let mut gradient = vec![0.0; self.problem.unknown_count];
        let mut scale = f64::MIN_POSITIVE;
        for (node, force) in self.problem.solid.exact_forces(places).iter().enumerate() {
            let load = (self.load_n)(node);
            scale = scale.max(load.amax());
            for axis in 0..3 {
                if let Some(row) = self.problem.rows[node][axis] {
                    gradient[row] -= force[axis] + load[axis];
                } else {
                    scale = scale.max(force[axis].abs());
                }
            }
        }
        for (sample, _, force, normal, _) in self.contacts(places) {
            scale = scale.max(force);
            for &(node, weight) in sample {
                for axis in 0..3 {
                    if let Some(row) = self.problem.rows[node as usize][axis] {
                        gradient[row] -= force * weight * normal[axis];
                    }
                }
            }
        }
        (gradient, scale)
    }

    /// −H⁻¹ gradient.
    fn solve(
        &self,
        places: &[Lane],
        gradient: &[f64],
        definite: bool,
    ) -> Result<Vec<f64>, ReferenceError> {
        let rows = &self.problem.rows;
        let mut triplets = Vec::new();
        let mut add = |row: usize, column: usize, value: f64| {
            if let (Some(row), Some(column)) =
                (rows[row / 3][row % 3], rows[column / 3][column % 3])
                && row >= column
            {
                triplets.push(Triplet::new(row, column, value));
            }
        };
        self.problem.solid.add_hessian(places, definite, &mut add);
        for (sample, _, force, normal, bend) in
            self.contacts(places).filter(|contact| contact.2 > 0.0)
        {
            // The obstacle's own curvature pushes samples apart: it is left out where the matrix is
            // to be definite.
            let bend = if definite { bend * 0.0 } else { bend };
            let matrix = normal * normal.transpose() * self.problem.penalty_n_m - bend * force;
            for &(a, near) in sample {
                for &(b, far) in sample {
                    for i in 0..3 {
                        for j in 0..3 {
                            add(
                                3 * a as usize + i,
                                3 * b as usize + j,
                                near * far * matrix[(i, j)],
                            );
                        }
                    }
                }
            }
        }
        let n = self.problem.unknown_count;
        let wrong = |error: &dyn std::fmt::Debug| ReferenceError::Factor(format!("{error:?}"));
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets)
            .map_err(|e| wrong(&e))?;
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|e| wrong(&e))?;
        let answer = factor.solve(&Col::from_fn(n, |row| -gradient[row]));
        Ok((0..n).map(|row| answer[row]).collect())
    }

    fn moved(&self, places: &[Lane], direction: &[f64], length: f64) -> Vec<Lane> {
        let mut moved = places.to_vec();
        for (lane, rows) in moved.iter_mut().zip(&self.problem.rows) {
            for axis in 0..3 {
                if let Some(row) = rows[axis] {
                    lane[axis] += length * direction[row];
                }
            }
        }
        moved
    }
}
