//! Velocity of a rigid motion.

use palpate_geometry::math::{Point3, Vector3};

/// Velocity of a rigid body; by default at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RigidVelocity {
    pub centre: Point3,
    pub linear: Vector3,
    /// rad/s.
    pub angular: Vector3,
}

impl RigidVelocity {
    /// At a place.
    #[inline]
    pub fn velocity(&self, place: &Point3) -> Vector3 {
        self.linear + self.angular.cross(&(place - self.centre))
    }

    /// From where a step along the velocity, the chord of the last step, takes a place to the circle on
    /// which it turns, m: (ω dt)² of its distance from the axis. Without it a body that turns is found
    /// stretched by every step, and corrections as large as that feed whatever swings.
    #[inline]
    pub fn inwards(&self, place: &Point3, dt_s: f64) -> Vector3 {
        let turn = self.angular * dt_s;
        let squared = turn.norm_squared();
        if squared == 0.0 {
            return Vector3::zeros();
        }
        let arm = place - self.centre;
        let across = arm - turn * (turn.dot(&arm) / squared);
        (across + turn.cross(&across)) * (1.0 / (1.0 + squared) - 1.0)
    }
}
