//! A deforming body: its constants, and what contact asks of it.
//!
//! A body has coordinates q, which move; nodes x = W q, which carry its law's forces; and a control
//! net, each point of which is a coordinate. Contact acts on coordinates of the net through the
//! compliance of one step: how far a force held through the step moves each coordinate, in columns
//! kept from the start.

mod queries;

use super::calm::{Outline, STILL_STEPS};
use super::caution::ImplicitScratch;
use super::columns;
use super::excess;
use super::field::Field;
use super::implicit::ImplicitStep;
use super::material::Plastic;
use super::matter::{Blueprint, FIXED, Matter, lanes};
use super::node_map::NodeMap;
use super::rigid_motion::Momentum;
use super::rigid_velocity::RigidVelocity;
use super::settings::{DeformableError, StepSettings};
use super::state::{DeformableScratch, DeformableState};
use super::stepper::{Compliance, Stepper};
use palpate_geometry::math::{Lane, Point3, Vector3};

/// Of the weight of a body that lies on others: how far its contact forces may be from bearing it.
const BORNE: f64 = 5e-3;

/// Constants of a body.
#[derive(Debug)]
pub struct Deformable {
    matter: Matter,
    stepper: Stepper,
    compliance: Compliance,
    outline: Outline,
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
        let mut stepper = Stepper::new(&matter)?;
        let compliance = stepper.compliance(&matter)?;
        stepper.round(&matter);
        let outline = Outline::new(&matter.rest);
        Ok(Self {
            matter,
            stepper,
            compliance,
            outline,
        })
    }

    /// Has the body start with a velocity, m/s, and an angular velocity about its centre of mass, rad/s,
    /// instead of at rest.
    ///
    /// # Errors
    /// Something holds it.
    pub fn launch(&mut self, linear: Vector3, angular: Vector3) -> Result<(), DeformableError> {
        let matter = &mut self.matter;
        if !matter.is_free() {
            return Err(DeformableError::Unsupported(
                "only a body that nothing holds starts with a velocity; drop `fixed`, or the velocity",
            ));
        }
        let weighed = matter.masses.iter().zip(&matter.rest);
        let sum: Vector3 = weighed.map(|(m, x)| x.coords * *m).sum();
        matter.launch = Some(RigidVelocity {
            centre: Point3::from(sum / matter.masses.iter().sum::<f64>()),
            linear,
            angular,
        });
        Ok(())
    }

    /// Sets what free points feel from the next [`Deformable::predict`] on.
    pub fn set_field(&self, scratch: &mut DeformableScratch, field: Field) {
        scratch.field = field;
    }

    /// x*: where the coordinates go in one step without contact; of several iterations, after the
    /// first.
    pub fn predict(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        debug_assert_eq!(
            state.positions.len(),
            self.coordinate_count(),
            "a state of another body"
        );
        if self.asleep(state) {
            if !scratch.at_rest {
                scratch.predicted.copy_from_slice(&state.positions);
                if let Stepper::Implicit(implicit) = &self.stepper {
                    self.begin(implicit, state, scratch);
                }
                scratch.at_rest = true;
            }
            return;
        }
        scratch.at_rest = false;
        match &self.stepper {
            Stepper::Implicit(implicit) => {
                self.begin(implicit, state, scratch);
                self.correct(implicit, state, scratch, true);
            }
            Stepper::Explicit(_) | Stepper::Xpbd(_) => {
                self.stepper.run(&self.matter, state, scratch)
            }
        }
    }

    /// [`Deformable::predict`] for a scratch that stood for another state; forces given so far stay.
    pub fn renew(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        scratch.at_rest = false;
        self.predict(state, scratch);
    }

    /// The inertial prediction, with the contact forces of the step before.
    fn begin(
        &self,
        implicit: &ImplicitStep,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let dt = self.matter.settings.dt_s;
        let moved = state.positions.iter().zip(&state.velocities);
        let ahead_s = if implicit.starts_ahead(&self.matter, state) {
            dt
        } else {
            0.0
        };
        for (reached, (x, v)) in scratch.reached.iter_mut().zip(moved) {
            *reached = x + v * ahead_s;
        }
        scratch.carried.clear();
        let forces = self.matter.surface.iter().zip(&state.contact_n);
        let acting = forces.filter(|(_, force)| **force != Vector3::zeros());
        scratch
            .carried
            .extend(acting.map(|(&c, &force)| (c, force)));
        scratch.turning = self.matter.is_free().then(|| {
            let (places, velocities) = (&state.positions, &state.velocities);
            Momentum::of(&self.matter, places, velocities).rigid(&self.matter, places)
        });
        if let Some(turning) = scratch.turning.filter(|_| ahead_s > 0.0) {
            for (reached, x) in scratch.reached.iter_mut().zip(&state.positions) {
                *reached += turning.inwards(x, dt);
            }
        }
        implicit.begin(&self.matter, state, scratch);
    }

    /// One correction of where the step has come; on the net, x* is that without what contact moved.
    fn correct(
        &self,
        implicit: &ImplicitStep,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        first: bool,
    ) {
        implicit.correct(&self.matter, state, scratch, first);
        if first {
            implicit.settle_response(scratch);
        }
        scratch.predicted.copy_from_slice(&scratch.reached);
        if scratch.carried.is_empty() {
            return;
        }
        let DeformableScratch {
            carried,
            predicted,
            amounts,
            implicit,
            ..
        } = scratch;
        self.weigh_modes(carried, implicit, amounts);
        let (n, columns) = (self.unknown_count(), self.columns(implicit));
        let with_modes = !(implicit.answers_bounding || amounts.is_empty());
        for &c in &self.matter.surface {
            let unknown = self.matter.unknown[c as usize] as usize;
            let mut moved = Vector3::zeros();
            for (coordinate, force) in carried.iter() {
                let column = self.compliance.column[*coordinate as usize] as usize;
                moved += force * columns[column * n + unknown];
            }
            if with_modes {
                moved += self.compliance.response.modes.moved(
                    unknown,
                    &implicit.frames[unknown],
                    amounts,
                );
            }
            predicted[c as usize] -= moved;
        }
    }

    /// One more iteration of an implicit step, from where the contact forces of the scratch, which
    /// are used up, take the body: x* becomes what [`Deformable::advance`] with the same forces
    /// would end in the same place from.
    pub fn iterate(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        debug_assert_eq!(
            scratch.predicted.len(),
            self.coordinate_count(),
            "buffers of another body"
        );
        let Stepper::Implicit(implicit) = &self.stepper else {
            return self.drop_loads(scratch);
        };
        if scratch.loaded.is_empty() && self.asleep(state) {
            return;
        }
        scratch.at_rest = false;
        self.take_contact(scratch);
        self.drop_loads(scratch);
        self.correct(implicit, state, scratch, false);
    }

    /// Moves `reached` by what the contact forces of the scratch change against those that it knows.
    fn take_contact(&self, scratch: &mut DeformableScratch) {
        let DeformableScratch {
            carried,
            changed,
            loaded,
            forces,
            reached,
            lanes,
            amounts,
            implicit,
            ..
        } = scratch;
        // What it knows, less; what acts now, more; by coordinate.
        changed.clear();
        changed.extend(carried.iter().map(|&(c, force)| (c, -force)));
        carried.clear();
        carried.extend(loaded.iter().map(|&c| (c, forces[c as usize])));
        carried.sort_unstable_by_key(|entry| entry.0);
        for &(c, force) in carried.iter() {
            match changed.binary_search_by_key(&c, |entry| entry.0) {
                Ok(k) => changed[k].1 += force,
                Err(k) => changed.insert(k, (c, force)),
            }
        }
        changed.retain(|entry| entry.1 != Vector3::zeros());
        if changed.is_empty() {
            return;
        }
        // What forces change along a sheet waits for its matrix: the response is far too soft there.
        let across = !(implicit.normals.is_empty() || implicit.answers_bounding);
        let normal = |unknown: usize| &implicit.normals[unknown];
        if across {
            for (coordinate, force) in changed.iter_mut() {
                let n = normal(self.matter.unknown[*coordinate as usize] as usize);
                *force = n * n.dot(force);
            }
        }
        self.respond(changed, self.columns(implicit), lanes);
        self.weigh_modes(changed, implicit, amounts);
        let with_modes = !(implicit.answers_bounding || amounts.is_empty());
        for (unknown, &c) in self.matter.coordinate_of_unknown.iter().enumerate() {
            let [x, y, z, _] = lanes[unknown];
            let mut moved = Vector3::new(x, y, z);
            if across {
                moved = normal(unknown) * normal(unknown).dot(&moved);
            }
            let place = &mut reached[c as usize];
            *place += moved;
            if with_modes {
                *place += self.compliance.response.modes.moved(
                    unknown,
                    &implicit.frames[unknown],
                    amounts,
                );
            }
        }
    }

    /// Columns of the response by which contact answers in this step.
    fn columns(&self, implicit: &ImplicitScratch) -> &[f64] {
        &self.compliance.response.columns[implicit.answer]
    }

    /// How much of each soft mode forces on the net excite.
    fn weigh_modes(
        &self,
        forces: &[(u32, Vector3)],
        implicit: &ImplicitScratch,
        amounts: &mut [f64],
    ) {
        amounts.fill(0.0);
        let (modes, frames) = (&self.compliance.response.modes, &implicit.frames);
        if amounts.is_empty() || implicit.answers_bounding {
            return;
        }
        for (coordinate, force) in forces {
            let unknown = self.matter.unknown[*coordinate as usize] as usize;
            modes.add_work(unknown, &frames[unknown], force, amounts);
        }
        for (amount, gain) in amounts.iter_mut().zip(modes.gains()) {
            *amount *= gain;
        }
    }

    /// Number of soft modes in the compliance.
    pub fn mode_count(&self) -> usize {
        self.compliance.response.modes.len()
    }

    /// Gain of each soft mode: with p the work of unit forces on it, two of them move each other by
    /// p_i gain p_jᵀ more than [`Deformable::compliance_of`] says.
    pub fn mode_gains(&self) -> &[f64] {
        self.compliance.response.modes.gains()
    }

    /// Adds `weight` times how each soft mode moves a coordinate of the net to `to` (modes).
    pub fn add_modes(
        &self,
        scratch: &DeformableScratch,
        coordinate: usize,
        weight: f64,
        to: &mut [Vector3],
    ) {
        debug_assert!(coordinate < self.coordinate_count(), "no such coordinate");
        if let Some(unknown) = self.unknown(coordinate)
            && !scratch.implicit.answers_bounding
        {
            let frame = &scratch.implicit.frames[unknown];
            self.compliance
                .response
                .modes
                .add_shapes(unknown, frame, weight, to);
        }
    }

    /// Brings what contact needs of the scratch in line with a state whose free motion was predicted
    /// with another scratch.
    pub fn follow(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        debug_assert_eq!(
            state.positions.len(),
            self.coordinate_count(),
            "a state of another body"
        );
        scratch.at_rest = false;
        if let Stepper::Implicit(implicit) = &self.stepper {
            self.begin(implicit, state, scratch);
        }
    }

    /// The step with contact forces, which are used up. [`Deformable::predict`] came before, on the
    /// same state.
    pub fn advance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        debug_assert_eq!(
            state.velocities.len(),
            state.positions.len(),
            "a velocity a coordinate"
        );
        if scratch.loaded.is_empty() && self.asleep(state) {
            state.slept += 1;
            return;
        }
        let touched = !scratch.loaded.is_empty();
        let handled = scratch.handled;
        match &self.stepper {
            Stepper::Implicit(implicit) => {
                self.advance_on_compliance(state, scratch);
                implicit.end(state, scratch);
            }
            Stepper::Explicit(_) | Stepper::Xpbd(_) => {
                // Again from the start: the prediction knew no contact.
                self.stepper.run(&self.matter, state, scratch);
                state.positions.copy_from_slice(&scratch.predicted);
                state.velocities.copy_from_slice(&scratch.speed);
            }
        }
        self.drop_loads(scratch);
        let flowed = self.flow(state, scratch);
        let balanced = state.calm.steps + 1 >= STILL_STEPS && self.is_borne(state, scratch);
        self.count_still(state, touched, handled || flowed, balanced);
    }

    /// W F of forces on the net, into `lanes` (unknowns); `values`: the columns of W.
    fn respond(&self, forces: &[(u32, Vector3)], values: &[f64], lanes: &mut [Lane]) {
        let n = self.unknown_count();
        lanes.fill([0.0; 4]);
        for four in forces.chunks(4) {
            let mut columns: [&[f64]; 4] = [&[]; 4];
            let mut lanes_of_forces = [[0.0; 4]; 4];
            for (k, &(coordinate, force)) in four.iter().enumerate() {
                let column = self.compliance.column[coordinate as usize] as usize;
                columns[k] = &values[column * n..(column + 1) * n];
                lanes_of_forces[k] = [force.x, force.y, force.z, 0.0];
            }
            columns::add(columns, four.len(), &lanes_of_forces, lanes);
        }
    }

    /// x' = z + W (F − F₀), v = (x' − x) / dt; a free body keeps its momentum.
    fn advance_on_compliance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        let matter = &self.matter;
        self.take_contact(scratch);
        let before =
            (matter.is_free()).then(|| Momentum::of(matter, &state.positions, &state.velocities));
        if before.is_some() {
            // What free points feel now; places are about to change.
            let points = state.positions.iter().zip(&state.velocities);
            for ((load, (x, v)), m) in scratch.speed.iter_mut().zip(points).zip(&matter.masses) {
                *load = scratch.field.at(x, v) * *m;
            }
        }
        let before_j = (scratch.implicit.caution.held).then(|| self.whole_energy_j(state, scratch));
        let mut given_j = 0.0;
        if before_j.is_some() {
            let moved = |c: usize| scratch.reached[c] - state.positions[c];
            for &coordinate in &matter.coordinate_of_unknown {
                let c = coordinate as usize;
                let felt = (scratch.field).at(&state.positions[c], &state.velocities[c]);
                given_j += felt.dot(&moved(c)) * matter.masses[c];
            }
            for &(coordinate, force) in &scratch.carried {
                given_j += force.dot(&moved(coordinate as usize));
            }
        }
        let inverse_dt = 1.0 / matter.settings.dt_s;
        for &coordinate in &matter.coordinate_of_unknown {
            let coordinate = coordinate as usize;
            let position = scratch.reached[coordinate];
            state.velocities[coordinate] = (position - state.positions[coordinate]) * inverse_dt;
            state.positions[coordinate] = position;
        }
        state.contact_n.fill(Vector3::zeros());
        for &(coordinate, force) in &scratch.carried {
            state.contact_n[self.compliance.column[coordinate as usize] as usize] = force;
        }
        if let Some(before) = before {
            self.keep_momentum(&before, state, scratch);
        }
        if let Some(before_j) = before_j {
            let excess_j = self.whole_energy_j(state, scratch) - before_j - given_j;
            excess::take(matter, &state.positions, &mut state.velocities, excess_j);
        }
    }

    /// Elastic and kinetic energy of the state, J, by the buffers of the scratch.
    fn whole_energy_j(&self, state: &DeformableState, scratch: &mut DeformableScratch) -> f64 {
        let DeformableScratch {
            coordinates, nodes, ..
        } = scratch;
        excess::energy_j(
            &self.matter,
            self.matter.rest_lengths(state),
            &state.positions,
            &state.velocities,
            coordinates,
            nodes,
        )
    }

    /// Gives a free body the momentum that it had and what acted on it in the step.
    fn keep_momentum(
        &self,
        before: &Momentum,
        state: &mut DeformableState,
        scratch: &DeformableScratch,
    ) {
        let (matter, dt) = (&self.matter, self.matter.settings.dt_s);
        let now = Momentum::of(matter, &state.positions, &state.velocities);
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (load, x) in scratch.speed.iter().zip(&state.positions) {
            force += load;
            torque += (x - now.centre).cross(load);
        }
        for &(coordinate, load) in &scratch.carried {
            force += load;
            torque += (state.positions[coordinate as usize] - now.centre).cross(&load);
        }
        let missing = Momentum {
            linear: before.linear + force * dt - now.linear,
            angular: before.angular + torque * dt - now.angular,
            ..now
        };
        let change = missing.rigid(matter, &state.positions);
        for (v, x) in state.velocities.iter_mut().zip(state.positions.iter_mut()) {
            *v += change.velocity(x);
            *x += change.linear * dt;
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
            &self.matter.law,
            places,
            &mut state.rest_lengths,
            &mut state.plastic_strain,
            changes,
        )
    }

    /// What moves no more for a while falls asleep; it wakes by a touch.
    /// `busy`: it flowed, or a tool touched it; `balanced`: as [`Deformable::is_borne`].
    fn count_still(&self, state: &mut DeformableState, touched: bool, busy: bool, balanced: bool) {
        let limit = self.matter.settings.sleep_m_s * self.matter.settings.sleep_m_s;
        let squares = state.velocities.iter().map(|v| v.norm_squared());
        // What is not a number is not slow.
        let fastest = squares.fold(0.0, |most, v| if v > most || v.is_nan() { v } else { most });
        let still = !(touched || busy) && fastest <= limit && limit > 0.0;
        state.still = match still {
            true => (state.still + 1).min(STILL_STEPS),
            false => 0,
        };
        if busy || !touched {
            state.calm.steps = 0;
        } else {
            let Matter { rest, settings, .. } = &self.matter;
            let (sleep_m_s, dt_s) = (settings.sleep_m_s, settings.dt_s);
            let (positions, fastest) = (&state.positions, fastest.sqrt());
            (state.calm).count(
                &self.outline,
                rest,
                positions,
                fastest,
                balanced,
                sleep_m_s,
                dt_s,
            );
        }
        if state.still == STILL_STEPS {
            state.velocities.fill(Vector3::zeros());
        }
    }

    /// False where the contact forces of the step are known and are not, within [`BORNE`], those that
    /// hold the body up: contacts tremble, and their forces with them.
    fn is_borne(&self, state: &DeformableState, scratch: &DeformableScratch) -> bool {
        if !(self.matter.is_free() && matches!(self.stepper, Stepper::Implicit(_))) {
            return true;
        }
        let (mut weight, mut weight_n) = (Vector3::zeros(), 0.0);
        let places = state.positions.iter().zip(&state.velocities);
        for ((place, velocity), mass) in places.zip(&self.matter.masses) {
            let part = scratch.field.at(place, velocity) * *mass;
            weight += part;
            weight_n += part.norm();
        }
        let borne: Vector3 = state.contact_n.iter().sum();
        (weight + borne).norm() <= BORNE * weight_n
    }

    /// True when steps are skipped until something touches the body.
    pub fn asleep(&self, state: &DeformableState) -> bool {
        state.still >= STILL_STEPS || state.left_alone
    }

    /// Some of the forces of this step are a tool's.
    pub fn handle(&self, scratch: &mut DeformableScratch) {
        scratch.handled = true;
    }

    /// Adds a force (N) on a coordinate of the net for this step.
    pub fn push(&self, scratch: &mut DeformableScratch, coordinate: usize, force: Vector3) {
        debug_assert!(coordinate < self.coordinate_count(), "no such coordinate");
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
        debug_assert_eq!(loads.len(), self.coordinate_count(), "a load a coordinate");
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
        debug_assert_eq!(loads.len(), self.coordinate_count(), "a load a coordinate");
        for (coordinate, load) in loads
            .iter()
            .enumerate()
            .filter(|(_, load)| **load != Vector3::zeros())
        {
            self.push(scratch, coordinate, *load);
        }
    }

    /// Forgets what was prepared for another state.
    pub fn forget(&self, scratch: &mut DeformableScratch) {
        scratch.at_rest = false;
        self.drop_loads(scratch);
    }

    /// Forgets the forces given so far.
    pub fn drop_loads(&self, scratch: &mut DeformableScratch) {
        scratch.handled = false;
        for coordinate in scratch.loaded.drain(..) {
            scratch.forces[coordinate as usize] = Vector3::zeros();
            scratch.is_loaded[coordinate as usize] = false;
        }
    }

    /// Displacements of all free coordinates for a unit force held on one of the net over the step
    /// that the scratch stands for, m/N, by [`Deformable::unknown`]; `None` for a fixed one.
    pub fn compliance_of(&self, scratch: &DeformableScratch, coordinate: usize) -> Option<&[f64]> {
        debug_assert!(coordinate < self.coordinate_count(), "no such coordinate");
        let column = self.compliance.column[coordinate];
        let n = self.unknown_count();
        let values = self.columns(&scratch.implicit);
        (column != FIXED).then(|| &values[column as usize * n..(column as usize + 1) * n])
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
        let mut state = self.matter.rest_state();
        if let Stepper::Implicit(implicit) = &self.stepper {
            state.caution = implicit.caution(&self.matter);
        }
        state
    }

    /// Sets a state of this body back to rest. Allocates nothing.
    pub fn set_to_rest(&self, state: &mut DeformableState) {
        debug_assert_eq!(
            state.positions.len(),
            self.coordinate_count(),
            "a state of another body"
        );
        self.matter.set_to_rest(state);
    }

    /// Buffers; call [`Deformable::predict`] before the first step.
    pub fn scratch(&self) -> DeformableScratch {
        let mut scratch = self.matter.scratch();
        if let Stepper::Implicit(implicit) = &self.stepper {
            scratch.implicit = implicit.scratch(&self.matter);
            scratch.amounts = vec![0.0; self.mode_count()];
        }
        scratch
    }
}
