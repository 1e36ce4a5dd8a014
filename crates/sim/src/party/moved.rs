//! A rigid body that moves: where it is, and what takes it on.

use super::free::{Flight, Gives};
use super::tool::ToolState;
use crate::haptics::LinkPhase;
use crate::scene::{MovedBy, Mover, SPEED_MAX_M_S, Scene, TURNING_MAX_RAD_S, between, smooth};
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3, rotation_by, turn_between};
use palpate_geometry::stateful;

/// Where a rigid body that moves is, and what takes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidState {
    /// Ticks in which it could move: the time of its script.
    pub ticks: u64,
    /// Origin of its frame in the world, m; of a free body: its centre of mass.
    pub position: Point3,
    /// Of its frame; of a free body: of its principal axes.
    pub rotation: Rotation,
    /// What takes it on.
    pub course: Course,
}

/// What takes a rigid body on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// A command, once there was one; from then on nothing else does.
    Sent(Sent),
    /// Forces.
    Free(Flight),
}

/// A way that a command asked for; of 0 ticks: none did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sent {
    /// From there.
    pub from: (Point3, Rotation),
    /// To there.
    pub to: (Point3, Rotation),
    /// In so many ticks.
    pub ticks: u32,
    /// Of which so many are over.
    pub done: u32,
}

impl Default for Sent {
    fn default() -> Self {
        let here = (Point3::origin(), Rotation::identity());
        Self {
            from: here,
            to: here,
            ticks: 0,
            done: 0,
        }
    }
}

stateful!(RigidState, |this, walk| {
    let RigidState {
        ticks,
        position,
        rotation,
        course,
    } = this;
    walk.word(ticks)?;
    walk.point(position)?;
    walk.rotation(rotation)?;
    // Which of the two it is, the scene says.
    match course {
        Course::Sent(sent) => walk.part(sent),
        Course::Free(flight) => walk.part(flight),
    }
});

stateful!(Sent, |this, walk| {
    let Sent {
        from: (from, from_turned),
        to: (to, to_turned),
        ticks,
        done,
    } = this;
    walk.packed("ticks of a body's way", [(0, ticks), (32, done)])?;
    walk.ensure(*done <= *ticks, "tick of a body's way", u64::from(*done))?;
    walk.point(from)?;
    walk.rotation(from_turned)?;
    walk.point(to)?;
    walk.rotation(to_turned)
});

impl RigidState {
    /// At the start.
    pub(crate) fn start(mover: &Mover) -> Self {
        Self {
            ticks: 0,
            position: Point3::from(mover.placement.translation.vector),
            rotation: mover.placement.rotation,
            course: match mover.free() {
                Some(free) => Course::Free(Flight::start(free)),
                None => Course::Sent(Sent::default()),
            },
        }
    }

    /// How it moves, when it is free.
    pub fn flight(&self) -> Option<&Flight> {
        match &self.course {
            Course::Free(flight) => Some(flight),
            Course::Sent(_) => None,
        }
    }

    /// The same, to be changed.
    pub(crate) fn flight_mut(&mut self) -> Option<&mut Flight> {
        match &mut self.course {
            Course::Free(flight) => Some(flight),
            Course::Sent(_) => None,
        }
    }

    /// Sends it to a place, in so many ticks, or more if it would be too fast. A free body stays where it
    /// is.
    pub(crate) fn send(&mut self, to: (Point3, Rotation), ticks: u32, dt_s: f64) {
        let Course::Sent(sent) = &mut self.course else {
            return;
        };
        // The smooth way is 15/8 as fast in its middle.
        let ticks_at = |length: f64, most: f64| (1.875 * length / (most * dt_s)).ceil() as u32;
        let ticks = ticks
            .max(ticks_at((to.0 - self.position).norm(), SPEED_MAX_M_S))
            .max(ticks_at(
                turn_between(&self.rotation, &to.1).norm(),
                TURNING_MAX_RAD_S,
            ));
        *sent = Sent {
            from: (self.position, self.rotation),
            to,
            ticks: ticks.max(1),
            done: 0,
        };
    }

    /// The same somewhere else, by so much (m, world axes).
    pub(crate) fn moved(&self, by: &Vector3) -> Self {
        let mut moved = *self;
        moved.position += by;
        if let Course::Sent(sent) = &mut moved.course {
            sent.from.0 += by;
            sent.to.0 += by;
        }
        moved
    }

    /// After the next tick; a free body: if nothing touches it.
    pub(super) fn next(&self, mover: &Mover, scene: &Scene, tools: &[ToolState]) -> Self {
        let mut next = Self {
            ticks: self.ticks + 1,
            ..*self
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
            MovedBy::Script(script) => {
                script.place(&mover.placement, next.ticks as f64 * scene.dt_s)
            }
            MovedBy::Tool { tool, start } => {
                let link = &tools[*tool].link;
                if link.phase == LinkPhase::Absent {
                    return next;
                }
                let device =
                    Pose::from_parts(link.pose.position.coords.into(), link.pose.orientation);
                let wanted = device * start.inverse() * mover.placement;
                self.towards(&wanted, scene.dt_s)
            }
            MovedBy::Forces(_) => return self.pushed(mover, scene, Default::default()),
        };
        next
    }

    /// A free body after the next tick, under a force (N) and a moment about its centre (N·m) of its
    /// contacts.
    pub(super) fn pushed(&self, mover: &Mover, scene: &Scene, load: (Vector3, Vector3)) -> Self {
        let (Some(free), Some(flight)) = (mover.free(), self.flight()) else {
            return *self;
        };
        if flight.is_left_alone() {
            return *self;
        }
        let gravity = Vector3::from(scene.spec.gravity.acceleration);
        let here = (&self.position, &self.rotation);
        let (position, rotation, flight) =
            flight.after(here, free, &gravity, (&load.0, &load.1), scene.dt_s);
        Self {
            ticks: self.ticks + 1,
            position,
            rotation,
            course: Course::Free(flight),
        }
    }

    /// What is wrong with a free body in this state, if anything: not all of it is a number, or it is faster than a
    /// body can be.
    pub(super) fn unsound(&self, body: usize) -> Option<TickFault> {
        let (mut moves, mut fast) = (true, false);
        if let Some(flight) = self.flight() {
            moves = (flight.velocity_m_s + flight.momentum)
                .iter()
                .all(|x| x.is_finite());
            fast = flight.velocity_m_s.norm() > TickFault::MOST_SPEED_M_S;
        }
        let placed = self.position.iter().chain(self.rotation.as_vector().iter());
        if !(moves && placed.into_iter().all(|x| x.is_finite())) {
            return Some(TickFault::NotFinite);
        }
        fast.then_some(TickFault::CameApart { body: body as u32 })
    }

    /// As near to a placement as the speed of a body allows in a tick: a device that appears far off
    /// does not tear the body through others.
    fn towards(&self, wanted: &Pose, dt_s: f64) -> (Point3, Rotation) {
        let way = wanted.translation.vector - self.position.coords;
        let turn = turn_between(&self.rotation, &wanted.rotation);
        let share = |length: f64, most: f64| if length > most { most / length } else { 1.0 };
        let along = share(way.norm(), SPEED_MAX_M_S * dt_s);
        let round = share(turn.norm(), TURNING_MAX_RAD_S * dt_s);
        let rotation = match round < 1.0 {
            true => rotation_by(&(turn * round)) * self.rotation,
            false => wanted.rotation,
        };
        (self.position + way * along, rotation)
    }

    /// A point of the body at rest, where it is now.
    pub(crate) fn carry(&self, mover: &Mover, rest: &Point3) -> Point3 {
        let origin = Point3::from(mover.placement.translation.vector);
        if self.rotation == mover.placement.rotation {
            return rest + (self.position - origin);
        }
        let turn = self.rotation * mover.placement.rotation.inverse();
        self.position + turn * (rest - origin)
    }
}

/// How a body turns in this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turn {
    /// Each point goes where it will be.
    Whole(Rotation),
    /// Each point goes along its velocity, rad: what the turn of a free body lifts a point that rolls off
    /// is no room for the next one to sink into.
    Rate(Vector3),
}

/// How far a body goes in this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RigidStep {
    /// Origin of its frame before, m.
    pub(super) from: Point3,
    /// Of that, m.
    pub(super) shift: Vector3,
    /// About it.
    pub(super) turn: Turn,
    /// Of the control point that goes farthest, m.
    pub most_m: f64,
}

impl RigidStep {
    /// It stays where it is.
    pub const NONE: Self = Self {
        from: Point3::new(0.0, 0.0, 0.0),
        shift: Vector3::new(0.0, 0.0, 0.0),
        turn: Turn::Rate(Vector3::new(0.0, 0.0, 0.0)),
        most_m: 0.0,
    };

    /// Of a point of the body, m.
    pub fn at(&self, point: &Point3) -> Vector3 {
        if self.most_m == 0.0 {
            return Vector3::zeros();
        }
        let arm = point - self.from;
        match self.turn {
            Turn::Whole(turn) => self.shift + (turn * arm - arm),
            Turn::Rate(turn) => self.shift + turn.cross(&arm),
        }
    }
}

/// Buffers of a body that moves.
#[derive(Debug)]
pub(crate) struct RigidScratch {
    /// Its net after the tick under way.
    pub(super) net: Vec<Point3>,
    /// Its state after it; of a free body: if nothing touches it.
    pub(super) next: RigidState,
    /// What it gives way in it, when it is free.
    pub(crate) gives: Option<Gives>,
}

impl RigidScratch {
    pub(crate) fn new(mover: &Mover, net: &[Point3]) -> Box<Self> {
        Box::new(Self {
            net: net.to_vec(),
            next: RigidState::start(mover),
            gives: None,
        })
    }
}
