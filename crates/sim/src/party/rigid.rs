//! Rigid bodies that move. Of most a script, the device of a tool or a command says where to, and contact
//! does not move them; of those that are free, [`super::free`].
//!
//! ```text
//! Render   aim      where the body goes in this tick; rows see how far it takes each of its points
//! Deform   advance  it is there, a free one where contact let it go; its net follows
//! ```
//! What they press gives way as to any other surface, and slip counts relative to them, so that
//! friction drags what lies on them along.

use super::body::{BodyScratch, BodyState, box_of};
use super::free::{Flight, Gives};
use super::moved::{Course, RigidState, RigidStep, Turn};
use super::tool::ToolState;
use crate::scene::{Body, Mover, Scene};
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Rotation, Vector3, turn_between};

/// Finds where a body goes in this tick; `tools`: those that may take it along.
pub(crate) fn aim(
    scene: &Scene,
    body: &Body,
    state: &BodyState,
    tools: &[ToolState],
    parts: &mut BodyScratch,
    moving: bool,
) {
    let (Some(mover), Some(now)) = (&body.mover, &state.rigid) else {
        return;
    };
    let BodyScratch {
        surface,
        bounds,
        step,
        rigid,
        ..
    } = parts;
    let Some(rigid) = rigid else { return };
    *step = RigidStep::NONE;
    rigid.next = *now;
    rigid.gives = mover
        .free()
        .map(|free| Gives::new(&free.mass, &now.position, &now.rotation, scene.dt_s));
    let current = surface.net().points();
    let here = box_of(current);
    *bounds = here;
    if !moving || now.flight().is_some_and(Flight::is_left_alone) {
        return;
    }
    rigid.next = now.next(mover, scene, tools);
    let rest = body.surface.net().points();
    let most = place(&rigid.next, mover, rest, current, &mut rigid.net);
    let there = box_of(&rigid.net);
    *bounds = (here.0.inf(&there.0), here.1.sup(&there.1));
    *step = RigidStep {
        from: now.position,
        shift: rigid.next.position - now.position,
        turn: match rigid.next.rotation == now.rotation {
            _ if now.flight().is_some() => {
                Turn::Rate(turn_between(&now.rotation, &rigid.next.rotation))
            }
            true => Turn::Whole(Rotation::identity()),
            false => Turn::Whole(rigid.next.rotation * now.rotation.inverse()),
        },
        most_m: most,
    };
}

/// Writes the net of a body in a state; how far from where its points are the farthest is, m.
fn place(
    state: &RigidState,
    mover: &Mover,
    rest: &[Point3],
    current: &[Point3],
    net: &mut [Point3],
) -> f64 {
    let mut most: f64 = 0.0;
    for ((to, rest), from) in net.iter_mut().zip(rest).zip(current) {
        *to = state.carry(mover, rest);
        most = most.max((*to - from).norm_squared());
    }
    most.sqrt()
}

/// Each body is where it was going, or where contact let it go; `load_on`: force and moment of contacts on a free
/// one. Gives the last fault for which one had to be set back to
/// its start.
pub(crate) fn advance(
    scene: &Scene,
    states: &mut [BodyState],
    bodies: &mut [BodyScratch],
    load_on: impl Fn(usize, &Gives) -> (Vector3, Vector3),
) -> Option<TickFault> {
    let mut fault = None;
    for (b, body) in scene.bodies.iter().enumerate() {
        let load = bodies[b].gives().map(|gives| load_on(b, gives));
        let BodyState {
            rigid: Some(now),
            revision,
            moved_m,
            ..
        } = &mut states[b]
        else {
            continue;
        };
        let BodyScratch {
            surface,
            solver,
            step,
            rigid,
            ..
        } = &mut bodies[b];
        let (Some(rigid), Some(mover)) = (rigid, &body.mover) else {
            continue;
        };
        if let Some(load) = load {
            rigid.next = now.pushed(mover, scene, load);
            if let Some(unsound) = rigid.next.unsound(b) {
                rigid.next = RigidState::start(mover);
                rigid.next.course = Course::Free(Flight::default());
                fault = Some(unsound);
            }
            let (rest, current) = (body.surface.net().points(), surface.net().points());
            step.most_m = place(&rigid.next, mover, rest, current, &mut rigid.net);
        }
        *now = rigid.next;
        *moved_m = step.most_m;
        if step.most_m > 0.0 {
            *revision += 1;
            surface.net_mut().points_mut().copy_from_slice(&rigid.net);
            solver.net_changed();
        }
        *step = RigidStep::NONE;
    }
    fault
}

/// Brings a body's buffers in line with its state.
pub(crate) fn prepare(mover: &Mover, rest: &[Point3], state: &RigidState, parts: &mut BodyScratch) {
    let points = parts.surface.net_mut().points_mut();
    for (point, rest) in points.iter_mut().zip(rest) {
        *point = state.carry(mover, rest);
    }
    parts.solver.net_changed();
    parts.bounds = box_of(parts.surface.net().points());
    parts.step = RigidStep::NONE;
    if let Some(rigid) = &mut parts.rigid {
        rigid.next = *state;
    }
}
