//! A deforming body: its constants, and what contact asks of it.
//!
//! A body has coordinates q, which move; nodes x = W q, which carry its law's forces; and a control
//! net, each point of which is a coordinate. Contact acts on coordinates of the net through the
//! operator by which the step itself answers loads: its blocks between coordinates of the net are
//! kept from the start.

mod compliance;
mod loads;
mod queries;
mod sleep;

use super::before::Before;
use super::core::{Made, SurfaceBlocks};
use super::field::Field;
use super::following::{Following, Follows};
use super::guard::{Guard, Limit, RigidStep};
use super::implicit::ImplicitStep;
use super::material::Plastic;
use super::matter::{Blueprint, FIXED, Matter, lanes};
use super::missed::About;
use super::rigid_motion::Momentum;
use super::rigid_velocity::RigidVelocity;
use super::scratch::DeformableScratch;
use super::settings::{DeformableError, StepSettings};
use super::state::DeformableState;
use super::stepper::Stepper;
use super::stillness::{Outline, STILL_STEPS};
use palpate_geometry::math::{Point3, Vector3};

/// Constants of a body.
#[derive(Debug)]
pub struct Deformable {
    matter: Matter,
    stepper: Stepper,
    /// How forces on the net move the body, where its step has no matrix.
    by_trial: SurfaceBlocks,
    /// (coordinates): place in [`Matter::surface`], or [`FIXED`].
    column: Vec<u32>,
    guard: Guard,
    outline: Outline,
    about: About,
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
        let by_trial = stepper.by_trial(&matter);
        let mut column = vec![FIXED; matter.rest.len()];
        for (place, &coordinate) in matter.surface.iter().enumerate() {
            column[coordinate as usize] = place as u32;
        }
        let guard = Guard::new(&matter);
        let outline = Outline::new(&matter.rest);
        let about = match &stepper {
            Stepper::Implicit(_) => About::new(&matter),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => About::default(),
        };
        Ok(Self {
            matter,
            stepper,
            by_trial,
            column,
            guard,
            outline,
            about,
        })
    }

    /// The body without its step.
    pub(super) fn matter(&self) -> &Matter {
        &self.matter
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

    /// x*: where the coordinates go in one step with the contact forces of the step before; of several iterations,
    /// after the first.
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
        let ahead_s = if implicit.starts_ahead(state) {
            dt
        } else {
            0.0
        };
        for (reached, (x, v)) in scratch.reached.iter_mut().zip(moved) {
            *reached = x + v * ahead_s;
        }
        (scratch.arrived, scratch.share, scratch.shortened) = (false, 1.0, false);
        scratch.before.halved = false;
        scratch.carried.clear();
        let forces = self.matter.surface.iter().zip(&state.contact_n);
        let acting = forces.filter(|(_, force)| **force != Vector3::zeros());
        scratch
            .carried
            .extend(acting.map(|(&c, &force)| (c, force)));
        scratch.turning = self.matter.turning(state);
        if let Some(turning) = scratch.turning.filter(|_| ahead_s > 0.0) {
            for (reached, x) in scratch.reached.iter_mut().zip(&state.positions) {
                *reached += turning.inwards(x, dt);
            }
        }
        // A scratch that comes from elsewhere lacks the matrix of the state.
        if state.following.now.is_set && scratch.implicit.followed.is_none() {
            scratch.implicit.followed = implicit.make(&self.matter, &state.following.now);
        } else if !state.following.now.is_set {
            scratch.implicit.followed = None;
        }
        implicit.begin(&self.matter, state, scratch);
    }

    /// One correction of where the step has come by itself.
    fn correct(
        &self,
        implicit: &ImplicitStep,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        first: bool,
    ) {
        if first {
            scratch.predicted.copy_from_slice(&scratch.reached);
        }
        implicit.correct(&self.matter, state, scratch, first);
        let unknowns = self.matter.coordinate_of_unknown.iter();
        for (moved, &c) in scratch.implicit.moved.iter().zip(unknowns) {
            scratch.reached[c as usize] += *moved;
            scratch.predicted[c as usize] += *moved;
        }
        if first {
            let [by_itself, _] = implicit.limits();
            let share = self.share_within(by_itself, state, scratch);
            if share < 1.0 {
                self.go_back(state, scratch, share);
                scratch.predicted.copy_from_slice(&scratch.reached);
            }
        }
    }

    /// One more iteration of an implicit step, from where the contact forces of the scratch, which
    /// are used up, take the body. By how much it moves the body by itself, x* changes.
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
        self.take_contact(implicit, scratch);
        self.drop_loads(scratch);
        self.correct(implicit, state, scratch, false);
    }

    /// Moves `reached` by what the contact forces of the scratch change against those that it knows.
    fn take_contact(&self, implicit: &ImplicitStep, scratch: &mut DeformableScratch) {
        let DeformableScratch {
            carried,
            changed,
            loaded,
            forces,
            residual,
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
        residual.fill([0.0; 4]);
        for &(c, force) in changed.iter() {
            residual[c as usize] = [force.x, force.y, force.z, 0.0];
        }
        // What the last correction and this one come to together, in the norm of B.
        let merit_j = |changed: &[(u32, Vector3)], moved: &[Vector3]| -> f64 {
            let work = |&(c, force): &(u32, Vector3)| {
                force.dot(&moved[self.matter.unknown[c as usize] as usize])
            };
            changed.iter().map(work).sum()
        };
        scratch.implicit.merit_j += 2.0 * merit_j(&scratch.changed, &scratch.implicit.moved);
        implicit.answer(&self.matter, scratch, false);
        scratch.implicit.merit_j += merit_j(&scratch.changed, &scratch.implicit.moved);
        let unknowns = self.matter.coordinate_of_unknown.iter();
        for (moved, &c) in scratch.implicit.moved.iter().zip(unknowns) {
            scratch.reached[c as usize] += *moved;
        }
    }

    /// Takes the step to where the contact forces of the scratch, which are used up, lead. [`Deformable::predict`] came
    /// before, on the same state.
    pub fn arrive(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        let Stepper::Implicit(implicit) = &self.stepper else {
            return;
        };
        if scratch.loaded.is_empty() && self.asleep(state) {
            return;
        }
        scratch.at_rest = false;
        self.take_contact(implicit, scratch);
        scratch.arrived = true;
        let [_, with_contact] = implicit.limits();
        scratch.share = self.share_within(with_contact, state, scratch);
    }

    /// The share of the motion of the step so far that strains no cell by more than a limit.
    fn share_within(
        &self,
        limit: Limit,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) -> f64 {
        let matter = &self.matter;
        let inertia = scratch.implicit.inertia.as_ref();
        scratch.rigid = inertia
            .and_then(|inertia| RigidStep::of(matter, inertia, &state.positions, &scratch.reached));
        let places = state.positions.iter().zip(&scratch.reached);
        for ((x, z), moved) in places.zip(scratch.pull.iter_mut()) {
            let from = scratch.rigid.map_or(*x, |rigid| rigid.at(x));
            let d = z - from;
            *moved = [d.x, d.y, d.z, 0.0];
        }
        (self.guard).share(matter, &scratch.pull, &mut scratch.nodes, limit)
    }

    /// By coordinate, how far contact forces took a step that arrived against those that it was predicted with, m.
    pub(crate) fn went<'a>(
        &self,
        scratch: &'a DeformableScratch,
    ) -> Option<impl Fn(usize) -> Vector3 + use<'a>> {
        let is_implicit = matches!(self.stepper, Stepper::Implicit(_));
        (scratch.arrived && is_implicit)
            .then_some(|c: usize| scratch.reached[c] - scratch.predicted[c])
    }

    /// Looks at what a step that arrived leaves of its equation where contact forces act; false where there is no such
    /// equation, or no step.
    pub(crate) fn miss(&self, state: &DeformableState, scratch: &mut DeformableScratch) -> bool {
        let Stepper::Implicit(implicit) = &self.stepper else {
            return false;
        };
        if scratch.arrived {
            implicit.miss(&self.matter, &self.about, &self.column, state, scratch);
        }
        scratch.arrived
    }

    /// Adds a load (N) on a coordinate to what [`Deformable::miss`] found, if it looked there.
    pub(crate) fn add_missed(
        &self,
        scratch: &mut DeformableScratch,
        coordinate: usize,
        load: &Vector3,
    ) {
        scratch.missed.add(self.column[coordinate], load);
    }

    /// What [`Deformable::miss`] found, by place on the net, N.
    pub(crate) fn missed<'a>(&self, scratch: &'a DeformableScratch) -> &'a [(u32, Vector3)] {
        &scratch.missed.loads
    }

    /// Where a step that arrived takes a coordinate, m.
    pub(crate) fn reached(&self, scratch: &DeformableScratch, coordinate: usize) -> Point3 {
        scratch.reached[coordinate]
    }

    /// The step has taken its contact forces, and is not ended yet.
    pub(crate) fn has_arrived(&self, scratch: &DeformableScratch) -> bool {
        scratch.arrived
    }

    /// The share of the motion of the step that the body can follow: 1, or less.
    pub fn share(&self, scratch: &DeformableScratch) -> f64 {
        match scratch.arrived {
            true => scratch.share,
            false => 1.0,
        }
    }

    /// Shortens the deformation of the step about its rigid motion, with its pressures and forces, to a share.
    pub fn shorten(&self, state: &DeformableState, scratch: &mut DeformableScratch, share: f64) {
        debug_assert!((0.0..=1.0).contains(&share), "a share of a motion");
        if !scratch.arrived {
            return;
        }
        self.go_back(state, scratch, share);
        for (_, force) in &mut scratch.carried {
            *force = match share > 0.0 {
                true => *force * share,
                false => Vector3::zeros(),
            };
        }
        scratch.share = 1.0;
    }

    /// Leaves a share of the deformation of the step about its rigid motion, and of its pressures.
    fn go_back(&self, state: &DeformableState, scratch: &mut DeformableScratch, share: f64) {
        for (x, z) in state.positions.iter().zip(&mut scratch.reached) {
            let from = scratch.rigid.map_or(*x, |rigid| rigid.at(x));
            // Of no share, what is not a number stays out.
            *z = match share > 0.0 {
                true => from + (*z - from) * share,
                false => from,
            };
        }
        let pressures = state.pressures.as_flattened().iter();
        let reached = scratch.implicit.pressures.as_flattened_mut().iter_mut();
        for (q, from) in reached.zip(pressures) {
            *q = match share > 0.0 {
                true => from + (*q - from) * share,
                false => *from,
            };
        }
        scratch.shortened = true;
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
                if !scratch.arrived {
                    self.arrive(state, scratch);
                }
                if scratch.share < 1.0 {
                    self.shorten(state, scratch, scratch.share);
                }
                self.settle(state, scratch);
                implicit.end(state, scratch);
                scratch.follows = implicit.look(&self.matter, state, scratch);
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
        let balanced = state.stillness.steps + 1 >= STILL_STEPS && self.is_borne(state, scratch);
        self.count_still(state, touched, handled || flowed, balanced);
    }

    /// What the last step found of its matrix: where it [began](Follows::Begun) another, [`Deformable::make`] it.
    pub fn follows(&self, scratch: &DeformableScratch) -> Follows {
        scratch.follows
    }

    /// It may ask for a matrix that follows it.
    pub fn makes_matrices(&self) -> bool {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.pressure_lanes(&self.matter) > 0,
            Stepper::Explicit(_) | Stepper::Xpbd(_) => false,
        }
    }

    /// Makes the matrix that a body is to take over. It may be made anywhere: the same state makes the same one.
    pub fn make(&self, state: &DeformableState) -> Option<Made> {
        match &self.stepper {
            Stepper::Implicit(implicit) if state.following.next.is_set => {
                implicit.make(&self.matter, &state.following.next)
            }
            _ => None,
        }
    }

    /// The matrix that one takes the place of which is [due](Following::is_due).
    pub fn let_go(&self, scratch: &mut DeformableScratch) -> Option<Made> {
        scratch.implicit.followed.take()
    }

    /// Takes over the matrix that is [due](Following::is_due). Without one that was made elsewhere it is made here.
    pub fn take_over(
        &self,
        state: &mut DeformableState,
        scratch: &mut DeformableScratch,
        made: Option<Made>,
    ) {
        if !state.following.is_due() {
            return;
        }
        if let Some(made) = made.or_else(|| self.make(state)) {
            let following = &mut state.following;
            std::mem::swap(&mut following.now, &mut following.next);
            scratch.implicit.followed = Some(made);
        }
        state.following.next.is_set = false;
        scratch.at_rest = false;
    }

    /// x' is where the step has come, v = (x' − x) / dt; a free body keeps its momentum.
    fn settle(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        let matter = &self.matter;
        scratch.arrived = false;
        let before =
            (matter.is_free()).then(|| Momentum::of(matter, &state.positions, &state.velocities));
        if before.is_some() {
            // What free points feel now; places are about to change.
            let points = state.positions.iter().zip(&state.velocities);
            for ((load, (x, v)), m) in scratch.speed.iter_mut().zip(points).zip(&matter.masses) {
                *load = scratch.field.at(x, v) * *m;
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
            state.contact_n[self.column[coordinate as usize] as usize] = force;
        }
        if let Some(before) = before {
            self.keep_momentum(&before, state, scratch);
        }
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
        let places = self.matter.nodes_of(coordinates, nodes);
        flow.flow(
            &self.matter.law,
            places,
            &mut state.rest_lengths,
            &mut state.plastic_strain,
            changes,
        )
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
            state.convergence = implicit.convergence(&self.matter);
            state.pressures = vec![[0.0; 4]; implicit.pressure_lanes(&self.matter)];
            if !state.pressures.is_empty() {
                state.following =
                    Following::for_state(&state.positions, &state.pressures, &state.rest_lengths);
            }
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
            scratch.missed = self.about.scratch(&self.matter);
            if implicit.iterations() > 1 {
                scratch.looked = scratch.implicit.pressures.clone();
                let forces = 2 * scratch.carried.capacity();
                scratch.before = Before::new(&scratch.reached, &scratch.implicit.pressures, forces);
            }
        }
        scratch
    }
}
