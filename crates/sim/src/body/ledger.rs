//! Where the energy of a step went.
//!
//! With Δ = x' − x and the forces that a step of backward Euler knows, its own equation times Δ is
//!
//! ```text
//! F·Δ + M g·Δ = Δ(kinetic) + Δ(elastic) + what inertia, the law, damping, pressures and flow lose + what is left·Δ
//! ```
//! Each term is found by itself, from the two states alone: that they come to the same to rounding says that none is
//! missing, and a loss that is a gain says where a body takes energy from nowhere.

use super::deformable::Deformable;
use super::field::Field;
use super::matter::Matter;
use super::state::DeformableState;
use palpate_geometry::math::{Lane, Vector3};

/// Energies of a step of a body, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Ledger {
    /// What contact forces did.
    pub contact_j: f64,
    /// What weight and the motion of the frame did.
    pub field_j: f64,
    /// Change of the kinetic energy.
    pub kinetic_j: f64,
    /// Change of the elastic energy.
    pub elastic_j: f64,
    /// Lost to the step: of inertia, and of the law between the two places.
    pub step_j: f64,
    /// Lost to damping.
    pub damping_j: f64,
    /// Lost to pressures that do not follow their volumes.
    pub pressure_j: f64,
    /// Lost to plastic flow.
    pub flow_j: f64,
    /// What the step leaves of its equation, times the motion: of one that was shortened, what that took.
    pub residual_j: f64,
}

/// Terms of a force times a motion.
fn dot(forces: &[Vector3], moved: &[Vector3]) -> f64 {
    forces.iter().zip(moved).map(|(f, d)| f.dot(d)).sum()
}

/// Forces of the law at some places.
struct Forces<'a> {
    matter: &'a Matter,
    metrics: &'a [Lane],
}

impl Deformable {
    /// Where the energy of a step from one state to the other went. `None` where the step slept or is of a method that
    /// has no equation.
    pub fn ledger(
        &self,
        before: &DeformableState,
        after: &DeformableState,
        field: Field,
    ) -> Option<Ledger> {
        let left = self.residual(before, after, field)?;
        let matter = self.matter();
        let moved: Vec<Vector3> = after
            .positions
            .iter()
            .zip(&before.positions)
            .map(|(z, x)| z - x)
            .collect();
        let mut ledger = Ledger::default();
        let dt = matter.settings.dt_s;
        for (c, m) in matter.masses.iter().enumerate() {
            if matter.unknown(c).is_none() {
                continue;
            }
            let (v, w, d) = (before.velocities[c], after.velocities[c], moved[c]);
            ledger.field_j += field.at(&before.positions[c], &v).dot(&d) * m;
            ledger.kinetic_j += 0.5 * m * (w.norm_squared() - v.norm_squared());
            ledger.step_j += m * (w - v).dot(&(d / dt - (v + w) * 0.5));
            // What gives a free body its momentum back changes velocities, not the equation.
            ledger.residual_j += m / dt * (d / dt - w).dot(&d);
        }
        for (&c, force) in matter.surface.iter().zip(&after.contact_n) {
            ledger.contact_j += force.dot(&moved[c as usize]);
        }
        ledger.residual_j += dot(&left, &moved);
        let metrics = matter.rest_lengths(before);
        let energy = |state: &DeformableState, metrics: &[Lane]| {
            matter.law.energy_j(
                metrics,
                &super::matter::lanes_of(&self.nodes(&state.positions)),
            )
        };
        let (from, to) = (energy(before, metrics), energy(after, metrics));
        let flowed = energy(after, matter.rest_lengths(after));
        ledger.elastic_j = flowed - from;
        ledger.flow_j = to - flowed;
        let forces = Forces { matter, metrics };
        let here = dot(&forces.at(before, after, false, None), &moved);
        let ahead = dot(&forces.at(before, after, true, None), &moved);
        let pressed = dot(
            &forces.at(before, after, true, Some(&after.pressures)),
            &moved,
        );
        ledger.step_j += -here - (to - from);
        ledger.damping_j = here - ahead;
        ledger.pressure_j = ahead - pressed;
        Some(ledger)
    }
}

impl Forces<'_> {
    /// At the end of a step, or ahead of it where damping looks; under given pressures.
    fn at(
        &self,
        before: &DeformableState,
        after: &DeformableState,
        ahead: bool,
        pressures: Option<&[Lane]>,
    ) -> Vec<Vector3> {
        let mut scratch = self.matter.scratch();
        scratch.reached.clone_from(&after.positions);
        scratch.residual.fill([0.0; 4]);
        match ahead {
            true => {
                scratch.turning = self.matter.turning(before);
                self.matter.look_ahead(before, &mut scratch);
            }
            false => super::matter::lanes(&after.positions, &mut scratch.coordinates),
        }
        let of = DeformableState {
            rest_lengths: self.metrics.to_vec(),
            ..DeformableState::default()
        };
        match pressures.filter(|pressures| !pressures.is_empty()) {
            Some(pressures) => {
                scratch.implicit.pressures = pressures.to_vec();
                scratch.implicit.gaps = pressures.to_vec();
                self.matter.add_step_forces(&of, &mut scratch);
            }
            None => self.matter.add_law_forces(&of, &mut scratch),
        }
        let free = |c: usize| self.matter.unknown(c).is_some();
        let forces = scratch.residual.iter().enumerate();
        forces
            .map(|(c, f)| match free(c) {
                true => Vector3::new(f[0], f[1], f[2]),
                false => Vector3::zeros(),
            })
            .collect()
    }
}
