//! Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as its stability needs.
//!
//! With the greatest frequency ω and the damping time d, a substep h is stable while h² ω² + 2 h d
//! ω² ≤ 4.

use super::implicit::greatest_frequency_squared;
use super::look_ahead::LookAhead;
use super::matter::{Matter, lanes};
use super::rigid_motion::Momentum;
use super::scratch::DeformableScratch;
use super::settings::DeformableError;
use super::state::DeformableState;
use palpate_geometry::math::Vector3;

/// Most substeps of a step.
pub(super) const MOST_SUBSTEPS: usize = 20_000;
/// Share of the stable substep that is taken.
const SAFETY: f64 = 0.9;

/// Constants of the method.
#[derive(Debug)]
pub(super) struct Explicit {
    substeps: usize,
    look_ahead: Option<LookAhead>,
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
        Ok(Self {
            substeps: at_least.max(needed as usize).max(1),
            look_ahead: LookAhead::new(matter),
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
        scratch.turning = (matter.is_free() && self.look_ahead.is_some()).then(|| {
            let (places, velocities) = (&state.positions, &state.velocities);
            Momentum::of(matter, places, velocities).rigid(matter, places)
        });
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

    /// Moves the coordinates at which the law is asked ahead by d ẋ, without that of rigid motion.
    fn look_ahead(&self, matter: &Matter, scratch: &mut DeformableScratch) {
        let Some(look_ahead) = &self.look_ahead else {
            return;
        };
        let turning = scratch.turning.unwrap_or_default();
        let moving = scratch.speed.iter().zip(&scratch.predicted);
        for (ahead, (v, x)) in scratch.ahead.iter_mut().zip(moving) {
            *ahead = (v - turning.velocity(x)) * matter.damping_s;
        }
        look_ahead.add(&scratch.ahead, &mut scratch.coordinates);
    }
}
