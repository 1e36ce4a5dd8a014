//! Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as its stability needs.
//!
//! With the greatest frequency ω and the damping time d, a substep h is stable while h² ω² + 2 h d
//! ω² ≤ 4.

use super::implicit::greatest_frequency_squared;
use super::look_ahead::LookAhead;
use super::matter::{Matter, lanes};
use super::node_map::NodeMap;
use super::rigid_motion::{Momentum, RigidVelocity};
use super::settings::DeformableError;
use super::state::{DeformableScratch, DeformableState};
use palpate_geometry::math::{Lane, Vector3};

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
        let mut limited = 0;
        for _ in 0..self.substeps {
            for (load, force) in scratch.residual.iter_mut().zip(&scratch.forces) {
                *load = [force.x, force.y, force.z, 0.0];
            }
            lanes(&scratch.predicted, &mut scratch.coordinates);
            self.look_ahead(matter, scratch);
            matter.add_law_forces(state, scratch);
            limited = limited.max(scratch.limited);
            for &c in &matter.coordinate_of_unknown {
                let c = c as usize;
                let force = Vector3::from_column_slice(&scratch.residual[c][..3]);
                let felt = scratch.field.at(&scratch.predicted[c], &scratch.speed[c]);
                scratch.speed[c] += (force / matter.masses[c] + felt) * h;
                scratch.predicted[c] += scratch.speed[c] * h;
            }
        }
        if limited > 0 {
            take_excess(matter, state, scratch);
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

/// Forces of cells that are held back are no gradient of an energy, and pump: without damping a body
/// that is hit hard once scrambles itself within seconds. What a step has more than before, and was
/// not given by loads, is taken from the motion within the body; its momentum stays.
fn take_excess(matter: &Matter, state: &DeformableState, scratch: &mut DeformableScratch) {
    let before_j = energy_j(matter, state, scratch, true);
    let after_j = energy_j(matter, state, scratch, false);
    let DeformableScratch {
        predicted,
        speed,
        forces,
        field,
        ..
    } = scratch;
    let mut given_j = 0.0;
    for (c, (to, from)) in predicted.iter().zip(&state.positions).enumerate() {
        let weight = field.at(to, &speed[c]) * matter.masses[c];
        given_j += (forces[c] + weight).dot(&(to - from));
    }
    let excess_j = after_j - before_j - given_j;
    if excess_j.is_nan() || excess_j <= 0.0 {
        return;
    }
    let rigid = match matter.is_free() {
        true => Momentum::of(matter, predicted, speed).rigid(matter, predicted),
        false => RigidVelocity::default(),
    };
    let moving = speed.iter().zip(predicted.iter()).zip(&matter.masses);
    let within_j: f64 = moving
        .map(|((v, x), m)| 0.5 * m * (v - rigid.velocity(x)).norm_squared())
        .sum();
    let share = (1.0 - excess_j / within_j).max(0.0).sqrt();
    if share.is_finite() {
        for (v, x) in speed.iter_mut().zip(predicted.iter()) {
            let along = rigid.velocity(x);
            *v = along + (*v - along) * share;
        }
    }
}

/// Elastic and kinetic, J: of the state, or of where the step has come.
fn energy_j(
    matter: &Matter,
    state: &DeformableState,
    scratch: &mut DeformableScratch,
    before: bool,
) -> f64 {
    let DeformableScratch {
        predicted,
        speed,
        coordinates,
        nodes,
        ..
    } = scratch;
    let (places, speeds) = match before {
        true => (&state.positions, &state.velocities),
        false => (&*predicted, &*speed),
    };
    lanes(places, coordinates);
    let moving = matter.masses.iter().zip(speeds);
    let kinetic: f64 = moving.map(|(m, v)| 0.5 * m * v.norm_squared()).sum();
    let all: &[Lane] = match &matter.map {
        NodeMap::Same => coordinates,
        NodeMap::Sparse(map) => {
            map.apply(coordinates, nodes);
            nodes
        }
    };
    matter.law.energy_j(matter.rest_lengths(state), all) + kinetic
}
