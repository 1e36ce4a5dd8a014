//! Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as its stability needs.
//!
//! With the greatest frequency ω and the damping time d, a substep h is stable while h² ω² + 2 h d
//! ω² ≤ 4.

use super::implicit::{LOOK_AHEAD, greatest_frequency_squared, shortest_edges};
use super::matter::{Matter, lanes};
use super::settings::DeformableError;
use super::state::{DeformableScratch, DeformableState};
use palpate_geometry::math::Vector3;

/// Most substeps of a step.
pub(super) const MOST_SUBSTEPS: usize = 20_000;
/// Share of the stable substep that is taken.
const SAFETY: f64 = 0.9;

/// Constants of the method.
#[derive(Debug)]
pub(super) struct Explicit {
    substeps: usize,
    /// (coordinates): most that damping looks ahead, m; empty without damping.
    reach_m: Vec<f64>,
}

impl Explicit {
    pub(super) fn new(matter: &Matter, at_least: usize) -> Result<Self, DeformableError> {
        let (dt, d) = (matter.settings.dt_s, matter.damping_s);
        let squared = greatest_frequency_squared(matter);
        let stable = (d * d + 4.0 / squared).sqrt() - d;
        let needed = (dt / (SAFETY * stable)).ceil();
        if needed.is_nan() || needed > MOST_SUBSTEPS as f64 {
            return Err(DeformableError::Substeps {
                needed: needed as usize,
                most: MOST_SUBSTEPS,
            });
        }
        let reach_m = if d > 0.0 {
            shortest_edges(matter)
                .into_iter()
                .map(|edge| LOOK_AHEAD * edge)
                .collect()
        } else {
            Vec::new()
        };
        Ok(Self {
            substeps: at_least.max(needed as usize).max(1),
            reach_m,
        })
    }

    pub(super) fn substeps(&self) -> usize {
        self.substeps
    }

    /// A step from `state` with the scratch's forces, into its `predicted` and `speed`.
    pub(super) fn run(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let h = matter.settings.dt_s / self.substeps as f64;
        scratch.predicted.copy_from_slice(&state.positions);
        scratch.speed.copy_from_slice(&state.velocities);
        for _ in 0..self.substeps {
            for (load, force) in scratch.residual.iter_mut().zip(&scratch.forces) {
                *load = [force.x, force.y, force.z, 0.0];
            }
            lanes(&scratch.predicted, &mut scratch.coordinates);
            self.look_ahead(matter, scratch);
            matter.add_law_forces(state, scratch);
            for &c in &matter.coordinate_of_unknown {
                let c = c as usize;
                let force = Vector3::from_column_slice(&scratch.residual[c][..3]);
                let felt = scratch.field.at(&scratch.predicted[c], &scratch.speed[c]);
                scratch.speed[c] += (force / matter.masses[c] + felt) * h;
                scratch.predicted[c] += scratch.speed[c] * h;
            }
        }
    }

    /// Moves the coordinates at which the law is asked ahead by d ẋ, as the implicit step does.
    fn look_ahead(&self, matter: &Matter, scratch: &mut DeformableScratch) {
        let moving = scratch.speed.iter().zip(&self.reach_m);
        for ((v, reach_m), lane) in moving.zip(scratch.coordinates.iter_mut()) {
            let mut ahead = v * matter.damping_s;
            let length = ahead.norm();
            if length > *reach_m {
                ahead *= reach_m / length;
            }
            for (value, part) in lane.iter_mut().zip(ahead.iter()) {
                *value += part;
            }
        }
    }
}
