//! Where the law is asked in a step, and its forces there.

use super::elements::continuum::Given;
use super::look_ahead::LookAhead;
use super::matter::{Matter, lanes};
use super::node_map::NodeMap;
use super::rigid_motion::Momentum;
use super::rigid_velocity::RigidVelocity;
use super::scratch::DeformableScratch;
use super::state::DeformableState;
use palpate_geometry::math::{Point3, Vector3};

impl Matter {
    /// Adds Wᵀ of the law's forces at the coordinates of the scratch to its residual.
    pub fn add_law_forces(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        self.add_forces(state, scratch, false);
    }

    /// Adds them under the pressures of the step, and leaves the gaps of these in the scratch.
    pub fn add_step_forces(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        self.add_forces(state, scratch, true);
    }

    fn add_forces(&self, state: &DeformableState, scratch: &mut DeformableScratch, unknown: bool) {
        let rest = self.rest_lengths(state);
        let DeformableScratch {
            coordinates,
            nodes,
            residual,
            node_residual,
            springs,
            implicit,
            ..
        } = scratch;
        let given = unknown.then_some(Given {
            pressures: &implicit.pressures,
            gaps: &mut implicit.gaps,
        });
        match &self.map {
            NodeMap::Same => {
                (self.law).add_forces(rest, given, coordinates, residual, springs);
            }
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                node_residual.fill([0.0; 4]);
                (self.law).add_forces(rest, given, nodes, node_residual, springs);
                map.add_transposed(node_residual, residual);
            }
        }
    }

    /// The rigid motion of a free body at a state.
    pub fn turning(&self, state: &DeformableState) -> Option<RigidVelocity> {
        let (places, velocities) = (&state.positions, &state.velocities);
        (self.is_free()).then(|| Momentum::of(self, places, velocities).rigid(self, places))
    }

    /// d ẋ of a coordinate that moves from one place to the other in a step, without that of rigid motion, m.
    fn ahead(&self, turning: Option<RigidVelocity>) -> impl Fn(&Point3, &Point3) -> Vector3 {
        let (damping_s, dt_s) = (self.damping_s, self.settings.dt_s);
        let share = damping_s / dt_s;
        move |x, z| {
            let ahead = (z - x) * share;
            let Some(turning) = &turning else {
                return ahead;
            };
            let middle = nalgebra::center(x, z) - turning.linear * (0.5 * dt_s);
            ahead - turning.velocity(&middle) * damping_s
        }
    }

    /// Moves the coordinates of the scratch, at which the law is asked, from where the step has come ahead by d ẋ,
    /// without that of rigid motion: the force there is f − d K ẋ to first order, that of a Voigt solid.
    pub fn look_ahead(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        let ahead = self.ahead(scratch.turning);
        let moved = scratch.reached.iter().zip(&state.positions);
        for ((z, x), lane) in moved.zip(scratch.coordinates.iter_mut()) {
            let at = z + ahead(x, z);
            *lane = [at.x, at.y, at.z, 0.0];
        }
    }

    /// [`Matter::look_ahead`] for springs: less far where neighbours part or meet, since far ahead cells turn over.
    pub fn look_ahead_short(
        &self,
        look_ahead: &LookAhead,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let ahead = self.ahead(scratch.turning);
        lanes(&scratch.reached, &mut scratch.coordinates);
        let moved = scratch.reached.iter().zip(&state.positions);
        for ((z, x), to) in moved.zip(&mut scratch.ahead) {
            *to = ahead(x, z);
        }
        look_ahead.add(&scratch.ahead, &mut scratch.coordinates);
    }
}
