//! A frame that a tool carries about: bodies in it feel how it tilts, shakes and turns.

use crate::body::Field;
use crate::party::ToolState;
use crate::scene::Scene;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::stateful;

/// How the frame moves, from the poses of its tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameState {
    /// Ticks seen, up to two: with the first there is a pose, with the second a velocity.
    seen: u32,
    position: Point3,
    rotation: Rotation,
    /// m/s, smoothed; in the world.
    velocity: Vector3,
    /// rad/s, smoothed; in the frame.
    turning: Vector3,
    /// m/s², in the world.
    acceleration: Vector3,
    /// rad/s², in the frame.
    turning_rate: Vector3,
}

impl FrameState {
    /// Takes the pose of a tick.
    pub(super) fn follow(
        &mut self,
        position: &Point3,
        rotation: &Rotation,
        dt_s: f64,
        smoothing_s: f64,
    ) {
        debug_assert!(dt_s > 0.0 && smoothing_s >= 0.0, "times");
        if self.seen > 0 {
            let velocity = (position - self.position) / dt_s;
            let turned = self.rotation.inverse() * rotation;
            // The small rotation as a vector: twice the imaginary part, by the short way round.
            let sign = if turned.w < 0.0 { -2.0 } else { 2.0 };
            let turning = Vector3::new(turned.i, turned.j, turned.k) * (sign / dt_s);
            let share = dt_s / (smoothing_s + dt_s);
            let (before, turned_before) = (self.velocity, self.turning);
            if self.seen == 1 {
                (self.velocity, self.turning) = (velocity, turning);
            } else {
                self.velocity += (velocity - before) * share;
                self.turning += (turning - turned_before) * share;
                self.acceleration = (self.velocity - before) / dt_s;
                self.turning_rate = (self.turning - turned_before) / dt_s;
            }
        }
        self.seen = (self.seen + 1).min(2);
        (self.position, self.rotation) = (*position, *rotation);
    }
}

stateful!(FrameState, |this, walk| {
    let FrameState {
        seen,
        position,
        rotation,
        velocity,
        turning,
        acceleration,
        turning_rate,
    } = this;
    walk.coded("ticks of a frame", seen)?;
    walk.rotation(rotation)?;
    walk.point(position)?;
    for rate in [velocity, turning, acceleration, turning_rate] {
        walk.vector(rate)?;
    }
    Ok(())
});

impl Scene {
    /// What free points of the bodies feel.
    pub(super) fn field(&self, frame: &FrameState) -> Field {
        let gravity = Vector3::from(self.spec.gravity.acceleration);
        if self.frame.is_none() {
            return Field::gravity(gravity);
        }
        Field {
            at_origin: frame.rotation.inverse() * (gravity - frame.acceleration),
            turning_rad_s: frame.turning,
            turning_rad_s2: frame.turning_rate,
        }
    }

    /// The frame follows its tool.
    pub(super) fn follow_frame(&self, state: &mut FrameState, tools: &[ToolState]) {
        if let Some(frame) = &self.frame {
            let pose = &tools[frame.tool].link.pose;
            state.follow(
                &pose.position,
                &pose.orientation,
                self.dt_s,
                frame.smoothing_s,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A point at rest in the world, seen from a frame that swings: the field is its acceleration
    // there.
    #[test]
    fn a_free_point_seen_from_a_swinging_frame_moves_as_the_field_says() {
        let dt = 1e-5;
        let world = Point3::new(0.3, -0.2, 0.5);
        let pose = |t: f64| {
            let angle = 0.4 * libm::sin(3.0 * t);
            let rotation = Rotation::from_axis_angle(&Vector3::z_axis(), angle);
            (
                Point3::new(0.1 * libm::cos(2.0 * t), 0.05 * t * t, 0.0),
                rotation,
            )
        };
        let seen = |t: f64| {
            let (position, rotation) = pose(t);
            Point3::from(rotation.inverse() * (world - position))
        };
        let mut frame = FrameState::default();
        let t = 0.7;
        for k in 0..=3 {
            let (position, rotation) = pose(t + dt * f64::from(k - 3));
            frame.follow(&position, &rotation, dt, 0.0);
        }
        let field = Field {
            at_origin: frame.rotation.inverse() * -frame.acceleration,
            turning_rad_s: frame.turning,
            turning_rad_s2: frame.turning_rate,
        };
        let (before, now, after) = (seen(t - dt), seen(t), seen(t + dt));
        let velocity = (after - before) / (2.0 * dt);
        let acceleration = (after.coords - now.coords * 2.0 + before.coords) / (dt * dt);
        // First differences lag by a step; rounding of second differences is 1e-16 / dt².
        let miss = (field.at(&now, &velocity) - acceleration).norm();
        assert!(
            miss < 1e-3,
            "the field is off by {miss} m/s² of {}",
            acceleration.norm()
        );
    }

    #[test]
    fn the_first_poses_shake_nothing() {
        let mut frame = FrameState::default();
        frame.follow(
            &Point3::new(5.0, 0.0, 0.0),
            &Rotation::identity(),
            1e-3,
            5e-3,
        );
        frame.follow(
            &Point3::new(5.0, 0.0, 0.0),
            &Rotation::identity(),
            1e-3,
            5e-3,
        );
        assert_eq!(frame.acceleration, Vector3::zeros());
        assert_eq!(frame.velocity, Vector3::zeros());
    }
}
