//! Rigid bodies that contact and gravity move.
//!
//! ```text
//! predict  free motion      v* = v + dt g, x* = x + dt v*, R* = turned by L; rows see how far it takes them
//!          contact          a row's force f at the arm r moves the body by dt² (f / m + (I⁻¹ (r × f)) × r')
//! apply    with its forces  v' = v* + dt Σ f / m, L' = L + dt Σ r × f, x' = x + dt v', R' = turned by L'
//! ```
//! That is symplectic Euler for the centre of mass and, for the rotation, the implicit midpoint rule of
//! [`Mass::turned`]. Contact takes all of the speed at which surfaces meet, unless the pair has a restitution
//! (Moreau 1988): then they part with that share of it. Angular momentum in the world changes by moments alone, so that in flight it keeps its bits.

use super::body::{BodyScratch, BodyState, Of};
use super::contract::{Around, Party, Problem};
use super::flight::{Flight, Gives, RigidMotion};
use super::moved::{arrive, buffers, go, net, prepare, starting, stay};
use super::rigid::{Course, RigidState, Turn};
use crate::body::Field;
use crate::scene::{Free, Mover};
use crate::solve::motions::Lever;
use crate::solve::rows::{Row, RowSet};
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Vector3, turn_between};

/// Rows of a free body lean on each other through its mass: three and more carry it where one would.
const SWEEPS: usize = 200;

/// What a free body has beside its surface.
#[derive(Clone, Copy)]
pub(crate) struct Freed<'a> {
    pub mover: &'a Mover,
    pub free: &'a Free,
}

impl Party for Of<'_, Freed<'_>> {
    type State = BodyState;
    type Scratch = BodyScratch;

    fn start(&self) -> BodyState {
        starting(self.with(Flight::start(self.kind.free)))
    }

    fn scratch(&self) -> BodyScratch {
        buffers(self.body, self.with(Flight::start(self.kind.free)))
    }

    fn prepare(&self, _: Field, state: &BodyState, scratch: &mut BodyScratch, _: bool) {
        prepare(self.body, &self.kind.mover.placement, state, scratch);
    }

    fn predict(&self, around: &Around<'_>, state: &BodyState, scratch: &mut BodyScratch) {
        stay(state, scratch);
        let (Some(rigid), Some(now)) = (&mut scratch.rigid, &state.rigid) else {
            return;
        };
        let mass = &self.kind.free.mass;
        rigid.load = Default::default();
        rigid.gives = Some(Gives::new(
            mass,
            &now.position,
            &now.rotation,
            self.scene.dt_s,
        ));
        if !around.moving || state.is_left_alone() {
            return;
        }
        let next = self.pushed(now, Default::default());
        let turn = Turn::Rate(turn_between(&now.rotation, &next.rotation));
        let placement = &self.kind.mover.placement;
        go(self.body, placement, (now, next), turn, scratch);
    }

    fn respond(&self, _: &BodyState, scratch: &BodyScratch, problem: &mut Problem<'_>) {
        let Some(gives) = scratch.gives() else {
            return;
        };
        let Problem { rows, solver } = problem;
        let inertia = gives.inertia(&self.kind.free.mass, self.scene.dt_s);
        let body = solver.motions.add_body(inertia);
        for (i, a) in rows.rows.iter().enumerate() {
            for (sign_a, _) in a.sides_on(self.index) {
                let (sign, arm) = (sign_a, gives.arm(a));
                (solver.motions).add_lever(i, Lever { body, sign, arm });
                let turned = gives.turned(a);
                for (j, b) in rows.rows.iter().enumerate().take(i + 1) {
                    for (sign_b, _) in b.sides_on(self.index) {
                        let block = gives.block(&turned, b) * (sign_a * sign_b);
                        solver.matrix.add(i, j, &block);
                    }
                }
            }
        }
    }

    fn gives(&self, _: &BodyState, scratch: &BodyScratch, row: &Row, _: &mut Problem<'_>) -> f64 {
        scratch.gives().map_or(0.0, |gives| {
            let block = gives.block(&gives.turned(row), row);
            let alone = row.normal.dot(&(block * row.normal));
            let signs: f64 = row.sides_on(self.index).map(|(sign, _)| sign).sum();
            alone * signs.powi(2)
        })
    }

    fn sweeps(&self, so_far: usize, touched: &dyn Fn() -> bool) -> usize {
        if so_far < SWEEPS && touched() {
            SWEEPS
        } else {
            0
        }
    }

    fn take(
        &self,
        scratch: &mut BodyScratch,
        _: &RowSet,
        row: &Row,
        push_n: Vector3,
        iteration: usize,
    ) {
        let Some(rigid) = scratch.rigid.as_mut().filter(|_| iteration == 0) else {
            return;
        };
        let Some(gives) = &rigid.gives else { return };
        if push_n == Vector3::zeros() || !push_n.iter().all(|x| x.is_finite()) {
            return;
        }
        for (sign, _) in row.sides_on(self.index) {
            let push_n = push_n * sign;
            rigid.load.0 += push_n;
            rigid.load.1 += gives.arm(row).cross(&push_n);
        }
    }

    fn shorten(&self, _: &BodyState, scratch: &mut BodyScratch, share: f64) {
        if let Some(rigid) = &mut scratch.rigid {
            rigid.load.0 *= share;
            rigid.load.1 *= share;
        }
    }

    fn apply(
        &self,
        _: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
    ) -> Option<TickFault> {
        if state.is_left_alone() {
            arrive(self.body, &self.kind.mover.placement, state, scratch);
            return None;
        }
        let (rigid, now) = (scratch.rigid.as_mut()?, state.rigid.as_ref()?);
        rigid.next = self.pushed(now, rigid.load);
        let fault = self.unsound(&rigid.next);
        if fault.is_some() {
            rigid.next = self.with(Flight::default());
        }
        let placement = &self.kind.mover.placement;
        let (rest, current) = (self.body.skin.points(), scratch.skin.points());
        scratch.step.most_m = rigid.place(placement, rest, current);
        arrive(self.body, placement, state, scratch);
        fault
    }

    fn may_rest(&self) -> bool {
        true
    }

    fn leave_alone(
        &self,
        around: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
        leave: bool,
    ) {
        if let Some(flight) = state.rigid.as_mut().and_then(RigidState::flight_mut) {
            flight.leave_alone(leave);
        }
        self.predict(around, state, scratch);
    }

    fn net(&self, state: &BodyState, out: &mut [Point3]) {
        net(self.body, &self.kind.mover.placement, state, out);
    }

    fn carry(&self, state: &BodyState, rest: &Point3) -> Point3 {
        let rigid = state.rigid.as_ref();
        rigid.map_or(*rest, |rigid| rigid.carry(&self.kind.mover.placement, rest))
    }

    fn speed_m_s(&self, state: &BodyState) -> f64 {
        state.moved_m / self.scene.dt_s
    }

    fn motion(&self, state: &BodyState) -> Option<RigidMotion> {
        let now = state.rigid.as_ref()?;
        let here = (&now.position, &now.rotation);
        Some(RigidMotion::of(&self.kind.free.mass, here, now.flight()?))
    }
}

impl Of<'_, Freed<'_>> {
    /// At the start, moving like this.
    fn with(&self, flight: Flight) -> RigidState {
        RigidState::start(&self.kind.mover.placement, Course::Free(flight))
    }

    /// After the next tick, under a force (N) and a moment about its centre (N·m) of its contacts.
    fn pushed(&self, now: &RigidState, load: (Vector3, Vector3)) -> RigidState {
        let Some(flight) = now.flight().filter(|flight| !flight.is_left_alone()) else {
            return *now;
        };
        let (scene, here) = (self.scene, (&now.position, &now.rotation));
        let gravity = Vector3::from(scene.spec.gravity.acceleration);
        let load = (&load.0, &load.1);
        let (position, rotation, flight) =
            flight.after(here, self.kind.free, &gravity, load, scene.dt_s);
        RigidState {
            ticks: now.ticks + 1,
            position,
            rotation,
            course: Course::Free(flight),
        }
    }

    /// What is wrong with a state, if anything: not all of it is a number, or it is faster than a body can be.
    fn unsound(&self, state: &RigidState) -> Option<TickFault> {
        let flight = state.flight()?;
        let placed = state
            .position
            .iter()
            .chain(state.rotation.as_vector().iter());
        let moves = flight.velocity_m_s + flight.momentum;
        if !placed
            .into_iter()
            .chain(moves.iter())
            .all(|x| x.is_finite())
        {
            return Some(TickFault::NotFinite);
        }
        let body = self.index as u32;
        let fast = flight.velocity_m_s.norm() > TickFault::MOST_SPEED_M_S;
        fast.then_some(TickFault::CameApart { body })
    }
}
