//! Quasi-static equilibrium, offline: full Newton on the energy of [`Continuum`] with frictionless
//! rigid obstacles.
//!
//! Contact holds at given places of the surface, each a weighted sum of nodes (a node, or Σ N_i(u,
//! v) P_i of a B-spline surface whose control points are nodes), by an augmented Lagrangian (Simo &
//! Laursen 1992): `φ = Ψ + Σ (max(0, λ − r g)² − λ²) / 2 r`, g the gap; Newton with line search on
//! φ, then `λ ← max(0, λ − r g)`. Used for error figures and tests: it allocates, iterates to
//! convergence, and its bits may differ between machines.

mod newton;
mod obstacle;
#[cfg(test)]
mod tests;

pub use obstacle::Obstacle;

use super::continuum::Continuum;
use palpate_geometry::math::{Lane, Point3, Vector3};

/// A place of the surface where contact is asked for: Σ weight × node.
pub type Sample = Vec<(u32, f64)>;

/// Why there is no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// Newton's method did not get there.
    #[error(
        "no equilibrium after {steps} Newton steps: {residual_n} N are left of {scale_n} N; move in smaller steps"
    )]
    Newton {
        /// Steps made.
        steps: usize,
        /// Largest force left on a node, N.
        residual_n: f64,
        /// Largest force of contact, N.
        scale_n: f64,
    },
    /// The multipliers did not settle.
    #[error(
        "after {rounds} rounds a sample is still {depth_m} m inside the obstacle; move in smaller steps"
    )]
    Contact {
        /// Rounds made.
        rounds: usize,
        /// Deepest sample, m.
        depth_m: f64,
    },
    /// The tangent has no factor.
    #[error("the tangent has no factor: is the body held? ({0})")]
    Factor(String),
}

/// A body at rest somewhere.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// (node_count), m; fourth number zero.
    pub places: Vec<Lane>,
    /// (samples): contact force, N.
    pub multipliers_n: Vec<f64>,
    /// Sum of the contact forces on the obstacle, N.
    pub force_n: Vector3,
    /// Sum of what the fixed directions carry, N: the force of the body on its base.
    pub base_n: Vector3,
    /// Samples in contact.
    pub touching: usize,
    /// Newton steps of the last call.
    pub newton_steps: usize,
}

/// The constant of a quasi-static problem.
#[derive(Clone, Debug)]
pub struct Reference<'a> {
    solid: &'a Continuum,
    /// (node_count): which coordinates are fixed.
    fixed: Vec<[bool; 3]>,
    samples: Vec<Sample>,
    /// (node_count, 3): row of a coordinate, or none.
    rows: Vec<[Option<usize>; 3]>,
    unknown_count: usize,
    /// r, N/m.
    penalty_n_m: f64,
    /// A length of the contact samples, m: depths are compared with zero relative to it.
    length_m: f64,
}

impl<'a> Reference<'a> {
    /// `fixed[node][axis]` coordinates keep their rest value (all three on a base, one on a plane
    /// of symmetry).
    pub fn new(solid: &'a Continuum, fixed: &[[bool; 3]], samples: Vec<Sample>) -> Self {
        debug_assert_eq!(fixed.len(), solid.node_count(), "one triple a node");
        let mut unknown_count = 0;
        let rows = fixed
            .iter()
            .map(|axes| {
                axes.map(|fixed| {
                    let row = (!fixed).then_some(unknown_count);
                    unknown_count += usize::from(!fixed);
                    row
                })
            })
            .collect();
        let mut diagonal = vec![0.0; 3 * solid.node_count()];
        let rest: Vec<Lane> = solid.rest().iter().map(|p| [p.x, p.y, p.z, 0.0]).collect();
        solid.add_hessian(&rest, true, &mut |row, column, value| {
            if row == column {
                diagonal[row] += value;
            }
        });
        let on_surface = || samples.iter().flatten().map(|&(node, _)| node as usize);
        let stiffest = on_surface()
            .map(|node| diagonal[3 * node])
            .fold(0.0, f64::max);
        let (mut low, mut high) = (
            Point3::from([f64::INFINITY; 3]),
            Point3::from([f64::NEG_INFINITY; 3]),
        );
        for p in solid.rest() {
            (low, high) = (low.inf(p), high.sup(p));
        }
        Self {
            solid,
            fixed: fixed.to_vec(),
            samples,
            rows,
            unknown_count,
            // Stiff against the body, so that few rounds are needed, and not so stiff that Newton
            // hunts for who touches.
            penalty_n_m: 3.0 * stiffest,
            length_m: (high - low).norm(),
        }
    }

    /// The body undisturbed.
    pub fn at_rest(&self) -> Equilibrium {
        Equilibrium {
            places: self
                .solid
                .rest()
                .iter()
                .map(|p| [p.x, p.y, p.z, 0.0])
                .collect(),
            multipliers_n: vec![0.0; self.samples.len()],
            force_n: Vector3::zeros(),
            base_n: Vector3::zeros(),
            touching: 0,
            newton_steps: 0,
        }
    }

    /// Moves on to the equilibrium with an obstacle, from a neighbouring one. `load_n(node)` is
    /// added to the nodes.
    ///
    /// # Errors
    /// Too large a step, or a body that nothing holds.
    pub fn press(
        &self,
        state: &mut Equilibrium,
        obstacle: Option<&Obstacle>,
        load_n: &dyn Fn(usize) -> Vector3,
    ) -> Result<(), ReferenceError> {
        const ROUNDS: usize = 60;
        const DEPTH: f64 = 1e-6;
        state.newton_steps = 0;
        let mut depth_m = 0.0;
        for _ in 0..ROUNDS {
            let done = newton::minimise(self, state, obstacle, load_n)?;
            state.newton_steps += done;
            let Some(obstacle) = obstacle else {
                state.multipliers_n.fill(0.0);
                self.sum_up(state, None);
                return Ok(());
            };
            depth_m = 0.0f64;
            for (sample, multiplier) in self.samples.iter().zip(&mut state.multipliers_n) {
                let (gap, _, _) = obstacle.gap(&place(sample, &state.places));
                let next = (*multiplier - self.penalty_n_m * gap).max(0.0);
                depth_m = depth_m.max(if next > 0.0 { gap.abs() } else { 0.0 });
                *multiplier = next;
            }
            if depth_m < DEPTH * self.length_m {
                self.sum_up(state, Some(obstacle));
                return Ok(());
            }
        }
        Err(ReferenceError::Contact {
            rounds: ROUNDS,
            depth_m,
        })
    }

    fn sum_up(&self, state: &mut Equilibrium, obstacle: Option<&Obstacle>) {
        state.force_n = Vector3::zeros();
        state.touching = 0;
        if let Some(obstacle) = obstacle {
            for (sample, &multiplier) in self.samples.iter().zip(&state.multipliers_n) {
                if multiplier > 0.0 {
                    state.force_n -= obstacle.gap(&place(sample, &state.places)).1 * multiplier;
                    state.touching += 1;
                }
            }
        }
        let forces = self.solid.exact_forces(&state.places);
        state.base_n = Vector3::zeros();
        for (force, fixed) in forces.iter().zip(&self.fixed) {
            for axis in 0..3 {
                if fixed[axis] {
                    state.base_n[axis] += force[axis];
                }
            }
        }
    }
}

fn place(sample: &Sample, places: &[Lane]) -> Point3 {
    let mut at = Point3::origin();
    for &(node, weight) in sample {
        for axis in 0..3 {
            at[axis] += weight * places[node as usize][axis];
        }
    }
    at
}
