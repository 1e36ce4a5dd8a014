//! Where a rigid body is that moves, and its way through a tick.

use super::flight::{Flight, Gives};
use crate::scene::{SPEED_MAX_M_S, TURNING_MAX_RAD_S};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3, turn_between};
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
    /// Contact and gravity.
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
    pub(super) fn start(placement: &Pose, course: Course) -> Self {
        Self {
            ticks: 0,
            position: Point3::from(placement.translation.vector),
            rotation: placement.rotation,
            course,
        }
    }

    /// How it moves, when it is free.
    pub fn flight(&self) -> Option<&Flight> {
        match &self.course {
            Course::Free(flight) => Some(flight),
            Course::Sent(_) => None,
        }
    }

    /// How it moves, when it is free; mutable.
    pub(crate) fn flight_mut(&mut self) -> Option<&mut Flight> {
        match &mut self.course {
            Course::Free(flight) => Some(flight),
            Course::Sent(_) => None,
        }
    }

    /// Sends it to a place, in so many ticks, or more if it would be too fast. A free body stays where it
    /// is.
    pub(crate) fn send(&mut self, to: (Point3, Rotation), ticks: u32, dt_s: f64) {
        debug_assert!(dt_s > 0.0, "a tick takes time");
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

    /// This state moved by a vector (m, world axes).
    pub(crate) fn moved(&self, by: &Vector3) -> Self {
        let mut moved = *self;
        moved.position += by;
        if let Course::Sent(sent) = &mut moved.course {
            sent.from.0 += by;
            sent.to.0 += by;
        }
        moved
    }

    /// A point of the body at rest, where it is now.
    pub(super) fn carry(&self, placement: &Pose, rest: &Point3) -> Point3 {
        let origin = Point3::from(placement.translation.vector);
        if self.rotation == placement.rotation {
            return rest + (self.position - origin);
        }
        let turn = self.rotation * placement.rotation.inverse();
        self.position + turn * (rest - origin)
    }
}

impl RigidState {
    /// A frame that the body holds at rest, where it is now.
    pub(super) fn carry_pose(&self, placement: &Pose, rest: &Pose) -> Pose {
        Pose::from_parts(self.position.coords.into(), self.rotation) * placement.inverse() * rest
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
    pub net: Vec<Point3>,
    /// Its state after it; of a free body: if nothing touches it.
    pub next: RigidState,
    /// What it gives way in it, when it is free.
    pub gives: Option<Gives>,
    /// Force (N) and moment about its centre of mass (N·m) that it took in it.
    pub load: (Vector3, Vector3),
}

impl RigidScratch {
    pub(super) fn new(start: RigidState, net: &[Point3]) -> Box<Self> {
        Box::new(Self {
            net: net.to_vec(),
            next: start,
            gives: None,
            load: Default::default(),
        })
    }

    /// Writes the net of the state to come; how far from `current` the farthest of its points is, m.
    pub(super) fn place(&mut self, placement: &Pose, rest: &[Point3], current: &[Point3]) -> f64 {
        let mut most: f64 = 0.0;
        for ((to, rest), from) in self.net.iter_mut().zip(rest).zip(current) {
            *to = self.next.carry(placement, rest);
            most = most.max((*to - from).norm_squared());
        }
        most.sqrt()
    }
}
