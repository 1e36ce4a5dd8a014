//! Rigid bodies that are moved: a script, the device of a tool or a command says where to, and contact does
//! not change that.
//!
//! ```text
//! predict  where the body goes in this tick; rows see how far it takes each of its points
//! apply    it is there, a free one where contact let it go; its net follows
//! ```
//! What they press gives way as to any other surface, and slip counts relative to them, so that
//! friction drags what lies on them along.

use super::body::{BodyScratch, BodyState, Of, box_of};
use super::contract::{Around, Party};
use super::rigid::{Course, RigidScratch, RigidState, RigidStep, Sent, Turn};
use crate::body::Field;
use crate::haptics::LinkPhase;
use crate::scene::{Body, MovedBy, Mover, SPEED_MAX_M_S, TURNING_MAX_RAD_S, between, smooth};
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Pose, Rotation, rotation_by, turn_between};
use palpate_geometry::skin::Skin;

impl Party for Of<'_, &Mover> {
    type State = BodyState;
    type Scratch = BodyScratch;

    fn start(&self) -> BodyState {
        starting(self.at_start())
    }

    fn scratch(&self) -> BodyScratch {
        buffers(self.body, self.at_start())
    }

    fn prepare(&self, _: Field, state: &BodyState, scratch: &mut BodyScratch, _: bool) {
        prepare(self.body, &self.kind.placement, state, scratch);
    }

    fn predict(&self, around: &Around<'_>, state: &BodyState, scratch: &mut BodyScratch) {
        stay(state, scratch);
        let Some(now) = state.rigid.as_ref().filter(|_| around.moving) else {
            return;
        };
        let next = self.next(now, around);
        let turn = match next.rotation == now.rotation {
            true => Rotation::identity(),
            false => next.rotation * now.rotation.inverse(),
        };
        go(
            self.body,
            &self.kind.placement,
            (now, next),
            Turn::Whole(turn),
            scratch,
        );
    }

    fn apply(
        &self,
        _: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
    ) -> Option<TickFault> {
        arrive(self.body, &self.kind.placement, state, scratch);
        None
    }

    fn net(&self, state: &BodyState, out: &mut [Point3]) {
        net(self.body, &self.kind.placement, state, out);
    }

    fn carry(&self, state: &BodyState, rest: &Point3) -> Point3 {
        let rigid = state.rigid.as_ref();
        rigid.map_or(*rest, |rigid| rigid.carry(&self.kind.placement, rest))
    }

    fn speed_m_s(&self, state: &BodyState) -> f64 {
        state.moved_m / self.scene.dt_s
    }
}

impl Of<'_, &Mover> {
    fn at_start(&self) -> RigidState {
        RigidState::start(&self.kind.placement, Course::Sent(Sent::default()))
    }

    /// After the next tick.
    fn next(&self, now: &RigidState, around: &Around<'_>) -> RigidState {
        let (mover, dt_s) = (self.kind, self.scene.dt_s);
        let mut next = RigidState {
            ticks: now.ticks + 1,
            ..*now
        };
        if let Course::Sent(sent) = &mut next.course
            && sent.ticks > 0
        {
            sent.done = (sent.done + 1).min(sent.ticks);
            let share = f64::from(sent.done) / f64::from(sent.ticks);
            (next.position, next.rotation) = match sent.done == sent.ticks {
                true => sent.to,
                false => between(
                    (&sent.from.0, &sent.from.1),
                    (&sent.to.0, &sent.to.1),
                    smooth(share),
                ),
            };
            return next;
        }
        (next.position, next.rotation) = match &mover.by {
            MovedBy::Script(script) => script.place(&mover.placement, next.ticks as f64 * dt_s),
            MovedBy::Tool { tool, start } => {
                let link = &around.tools[*tool].link;
                if link.phase == LinkPhase::Absent {
                    return next;
                }
                let device =
                    Pose::from_parts(link.pose.position.coords.into(), link.pose.orientation);
                towards(now, &(device * start.inverse() * mover.placement), dt_s)
            }
            // Contact moves it: another kind of party.
            _ => return *now,
        };
        next
    }
}

/// As near to a placement as the speed of a body allows in a tick: a device that appears far off
/// does not tear the body through others.
fn towards(now: &RigidState, wanted: &Pose, dt_s: f64) -> (Point3, Rotation) {
    let way = wanted.translation.vector - now.position.coords;
    let turn = turn_between(&now.rotation, &wanted.rotation);
    let share = |length: f64, most: f64| if length > most { most / length } else { 1.0 };
    let along = share(way.norm(), SPEED_MAX_M_S * dt_s);
    let round = share(turn.norm(), TURNING_MAX_RAD_S * dt_s);
    let rotation = match round < 1.0 {
        true => rotation_by(&(turn * round)) * now.rotation,
        false => wanted.rotation,
    };
    (now.position + way * along, rotation)
}

/// The state at the start of a body that moves.
pub(super) fn starting(rigid: RigidState) -> BodyState {
    BodyState {
        rigid: Some(rigid),
        ..BodyState::default()
    }
}

/// Its buffers.
pub(super) fn buffers(body: &Body, start: RigidState) -> BodyScratch {
    BodyScratch {
        rigid: Some(RigidScratch::new(start, body.skin.points())),
        ..BodyScratch::of(body)
    }
}

/// Brings its buffers in line with its state.
pub(super) fn prepare(body: &Body, placement: &Pose, state: &BodyState, scratch: &mut BodyScratch) {
    if let Some(now) = &state.rigid {
        put(body, placement, now, scratch);
    }
    scratch.bounds = box_of(scratch.skin.points());
    scratch.step = RigidStep::NONE;
    if let (Some(rigid), Some(now)) = (&mut scratch.rigid, &state.rigid) {
        rigid.next = *now;
    }
}

/// It does not move in the tick that begins.
pub(super) fn stay(state: &BodyState, scratch: &mut BodyScratch) {
    scratch.step = RigidStep::NONE;
    scratch.bounds = box_of(scratch.skin.points());
    if let (Some(rigid), Some(now)) = (&mut scratch.rigid, &state.rigid) {
        rigid.next = *now;
    }
}

/// It goes from one state to the next in the tick that begins.
pub(super) fn go(
    body: &Body,
    placement: &Pose,
    (now, next): (&RigidState, RigidState),
    turn: Turn,
    scratch: &mut BodyScratch,
) {
    let Some(rigid) = &mut scratch.rigid else {
        return;
    };
    rigid.next = next;
    let current = scratch.skin.points();
    let most_m = rigid.place(placement, body.skin.points(), current);
    let (here, there) = (scratch.bounds, box_of(&rigid.net));
    scratch.bounds = (here.0.inf(&there.0), here.1.sup(&there.1));
    scratch.step = RigidStep {
        from: now.position,
        shift: next.position - now.position,
        turn,
        most_m,
    };
}

/// Puts its skin where it is.
fn put(body: &Body, placement: &Pose, now: &RigidState, scratch: &mut BodyScratch) {
    match (&mut scratch.skin, &body.skin) {
        (Skin::Surface(surface), Skin::Surface(rest)) => {
            let points = surface.net_mut().points_mut().iter_mut();
            for (point, rest) in points.zip(rest.net().points()) {
                *point = now.carry(placement, rest);
            }
        }
        (Skin::Part(placed), Skin::Part(rest)) => {
            placed.place(now.carry_pose(placement, rest.pose()));
        }
        _ => debug_assert!(false, "buffers of another body"),
    }
    scratch.solver.net_changed();
}

/// It is where it went.
pub(super) fn arrive(
    body: &Body,
    placement: &Pose,
    state: &mut BodyState,
    scratch: &mut BodyScratch,
) {
    let (Some(rigid), Some(now)) = (&scratch.rigid, &mut state.rigid) else {
        return;
    };
    *now = rigid.next;
    state.moved_m = scratch.step.most_m;
    if scratch.step.most_m > 0.0 {
        state.revision += 1;
        match scratch.skin.surface_mut() {
            Some(surface) => {
                surface.net_mut().points_mut().copy_from_slice(&rigid.net);
                scratch.solver.net_changed();
            }
            None => put(body, placement, now, scratch),
        }
    }
    scratch.step = RigidStep::NONE;
}

/// Its net in a state.
pub(super) fn net(body: &Body, placement: &Pose, state: &BodyState, out: &mut [Point3]) {
    if let Some(rigid) = &state.rigid {
        for (point, rest) in out.iter_mut().zip(body.skin.points()) {
            *point = rigid.carry(placement, rest);
        }
    }
}
