//! A deforming body: its constants, and what contact asks of it.
//!
//! A body has coordinates q, which move; nodes x = W q, which carry its law's forces; and a control
//! net, each point of which is a coordinate. Contact acts on coordinates of the net through the
//! compliance of one step: how far a force held through the step moves each coordinate, in columns
//! kept from the start.

mod queries;

use super::columns;
use super::field::Field;
use super::material::Plastic;
use super::matter::{Blueprint, FIXED, Matter, lanes};
use super::node_map::NodeMap;
use super::settings::{DeformableError, StepSettings};
use super::state::{DeformableScratch, DeformableState};
use super::stepper::{Compliance, Stepper};
use palpate_geometry::math::{Lane, Vector3};

/// Steps in a row without motion after which a body sleeps.
pub(super) const STILL_STEPS: u32 = 100;

/// Constants of a body.
#[derive(Debug)]
pub struct Deformable {
    matter: Matter,
    stepper: Stepper,
    compliance: Compliance,
}

impl Deformable {
    /// Builds the step and its compliance.
    ///
    /// # Errors
    /// No free coordinate, one without mass, a matrix without factor, or a combination that is not
    /// there.
    pub fn new(
        blueprint: Blueprint,
        damping_s: f64,
        plastic: Option<Plastic>,
        settings: StepSettings,
    ) -> Result<Self, DeformableError> {
        let matter = Matter::new(blueprint, damping_s, plastic, settings)?;
        let stepper = Stepper::new(&matter)?;
        let compliance = stepper.compliance(&matter);
        Ok(Self {
            matter,
            stepper,
            compliance,
        })
    }

    /// Sets what free points feel from the next [`Deformable::predict`] on.
    pub fn set_field(&self, scratch: &mut DeformableScratch, field: Field) {
        scratch.field = field;
    }

    /// x*: where the coordinates go in one step without contact; of several iterations, after the
    /// first.
    pub fn predict(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        if self.asleep(state) {
            scratch.predicted.copy_from_slice(&state.positions);
            return;
        }
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.predict(&self.matter, state, scratch),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => {
                self.stepper.run(&self.matter, state, scratch)
            }
        }
    }

    /// One more iteration of an implicit step, from where the contact forces of the scratch, which
    /// are used up, take the body: x* becomes what [`Deformable::advance`] with the same forces
    /// would end in the same place from.
    pub fn iterate(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        let Stepper::Implicit(implicit) = &self.stepper else {
            return self.drop_loads(scratch);
        };
        if scratch.loaded.is_empty() && self.asleep(state) {
            return;
        }
        self.respond(scratch);
        for (moved, &coordinate) in scratch.lanes.iter().zip(&self.matter.coordinate_of_unknown) {
            scratch.predicted[coordinate as usize] += Vector3::new(moved[0], moved[1], moved[2]);
        }
        self.drop_loads(scratch);
        implicit.again(&self.matter, state, scratch);
    }

    /// The step with contact forces, which are used up. [`Deformable::predict`] came before, on the
    /// same state.
    pub fn advance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        if scratch.loaded.is_empty() && self.asleep(state) {
            state.slept += 1;
            return;
        }
        let touched = !scratch.loaded.is_empty();
        match &self.stepper {
            Stepper::Implicit(_) => self.advance_on_compliance(state, scratch),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => {
                // Again from the start: the prediction knew no contact.
                self.stepper.run(&self.matter, state, scratch);
                state.positions.copy_from_slice(&scratch.predicted);
                state.velocities.copy_from_slice(&scratch.speed);
            }
        }
        self.drop_loads(scratch);
        let flowed = self.flow(state, scratch);
        self.count_still(state, touched || flowed);
    }

    /// A⁻¹ Cᵀ λ, into the scratch's lanes.
    fn respond(&self, scratch: &mut DeformableScratch) {
        let n = self.unknown_count();
        let column_of = |coordinate: u32| {
            let column = self.compliance.column[coordinate as usize] as usize;
            &self.compliance.values[column * n..(column + 1) * n]
        };
        scratch.lanes.fill([0.0; 4]);
        for four in scratch.loaded.chunks(4) {
            let mut columns: [&[f64]; 4] = [&[]; 4];
            let mut forces = [[0.0; 4]; 4];
            for (k, &coordinate) in four.iter().enumerate() {
                let force = scratch.forces[coordinate as usize];
                (columns[k], forces[k]) = (column_of(coordinate), [force.x, force.y, force.z, 0.0]);
            }
            columns::add(columns, four.len(), &forces, &mut scratch.lanes);
        }
    }

    /// x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt.
    fn advance_on_compliance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        self.respond(scratch);
        let inverse_dt = 1.0 / self.matter.settings.dt_s;
        for (moved, &coordinate) in scratch.lanes.iter().zip(&self.matter.coordinate_of_unknown) {
            let coordinate = coordinate as usize;
            let position =
                scratch.predicted[coordinate] + Vector3::new(moved[0], moved[1], moved[2]);
            state.velocities[coordinate] = (position - state.positions[coordinate]) * inverse_dt;
            state.positions[coordinate] = position;
        }
    }

    fn flow(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) -> bool {
        let Some(flow) = &self.matter.flow else {
            return false;
        };
        let DeformableScratch {
            coordinates,
            nodes,
            flow: changes,
            ..
        } = scratch;
        lanes(&state.positions, coordinates);
        let places: &[Lane] = match &self.matter.map {
            NodeMap::Same => coordinates,
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                nodes
            }
        };
        flow.flow(
            &self.matter.law.springs,
            places,
            &mut state.rest_lengths,
            &mut state.plastic_strain,
            changes,
        )
    }

    /// What moves no more for a while falls asleep; it wakes by a touch.
    fn count_still(&self, state: &mut DeformableState, busy: bool) {
        let limit = self.matter.settings.sleep_m_s * self.matter.settings.sleep_m_s;
        let still =
            !busy && limit > 0.0 && state.velocities.iter().all(|v| v.norm_squared() <= limit);
        state.still = if still {
            (state.still + 1).min(STILL_STEPS)
        } else {
            0
        };
        if state.still == STILL_STEPS {
            state.velocities.fill(Vector3::zeros());
        }
    }

    /// True when steps are skipped until something touches the body.
    pub fn asleep(&self, state: &DeformableState) -> bool {
        state.still >= STILL_STEPS
    }

    /// Adds a force (N) on a coordinate of the net for this step.
    pub fn push(&self, scratch: &mut DeformableScratch, coordinate: usize, force: Vector3) {
        if self.compliance.column[coordinate] == FIXED {
            return;
        }
        if !scratch.is_loaded[coordinate] {
            scratch.is_loaded[coordinate] = true;
            scratch.loaded.push(coordinate as u32);
        }
        scratch.forces[coordinate] += force;
    }

    /// Moves the forces given so far into `loads` (coordinates).
    pub fn take_loads(&self, scratch: &mut DeformableScratch, loads: &mut [Vector3]) {
        loads.fill(Vector3::zeros());
        for coordinate in scratch.loaded.drain(..) {
            let coordinate = coordinate as usize;
            loads[coordinate] =
                std::mem::replace(&mut scratch.forces[coordinate], Vector3::zeros());
            scratch.is_loaded[coordinate] = false;
        }
    }

    /// Gives back what [`Deformable::take_loads`] took.
    pub fn give_loads(&self, scratch: &mut DeformableScratch, loads: &[Vector3]) {
        for (coordinate, load) in loads
            .iter()
            .enumerate()
            .filter(|(_, load)| **load != Vector3::zeros())
        {
            self.push(scratch, coordinate, *load);
        }
    }

    /// Forgets the forces given so far.
    pub fn drop_loads(&self, scratch: &mut DeformableScratch) {
        for coordinate in scratch.loaded.drain(..) {
            scratch.forces[coordinate as usize] = Vector3::zeros();
            scratch.is_loaded[coordinate as usize] = false;
        }
    }

    /// Displacements of all free coordinates for a unit force held on one of the net over one step,
    /// m/N, by [`Deformable::unknown`]; `None` for a fixed one.
    pub fn compliance_of(&self, coordinate: usize) -> Option<&[f64]> {
        let column = self.compliance.column[coordinate];
        let n = self.unknown_count();
        (column != FIXED)
            .then(|| &self.compliance.values[column as usize * n..(column as usize + 1) * n])
    }

    /// Place of a coordinate among the free ones; `None` if it is fixed.
    pub fn unknown(&self, coordinate: usize) -> Option<usize> {
        self.matter.unknown(coordinate)
    }

    /// Coordinate of a control point (u-major index).
    pub fn coordinate_of_control(&self, control: usize) -> usize {
        self.matter.coordinate_of_control[control] as usize
    }

    /// The state at rest.
    pub fn rest_state(&self) -> DeformableState {
        self.matter.rest_state()
    }

    /// Sets a state of this body back to rest. Allocates nothing.
    pub fn set_to_rest(&self, state: &mut DeformableState) {
        self.matter.set_to_rest(state);
    }

    /// Buffers; call [`Deformable::predict`] before the first step.
    pub fn scratch(&self) -> DeformableScratch {
        self.matter.scratch()
    }
}
