//! The pose of a device.

use palpate_geometry::math::{Point3, Rotation, Vector3, first_outside};

/// A pose as the loop takes it: finite, unit quaternion. World frame, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DevicePose {
    /// Sender's count.
    pub seq: u64,
    /// Sender's clock, ns.
    pub t_client_ns: u64,
    /// Reference point of the tool, m.
    pub position: Point3,
    /// Orientation of the tool.
    pub orientation: Rotation,
    /// Linear velocity, m/s.
    pub linear_velocity: Vector3,
    /// Angular velocity, rad/s.
    pub angular_velocity: Vector3,
    /// Bit 0: grab. While it is set, the tool holds on to what it touches.
    pub buttons: u32,
}

impl DevicePose {
    /// A device at rest at a place, m, not turned, without a number.
    pub fn at_rest(position: [f64; 3]) -> Self {
        Self {
            seq: 0,
            t_client_ns: 0,
            position: Point3::from(position),
            orientation: Rotation::identity(),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        }
    }

    /// Its place and velocities are numbers that something can be calculated with.
    pub(super) fn is_somewhere(&self) -> bool {
        let velocities = [self.linear_velocity, self.angular_velocity].map(Point3::from);
        first_outside(&[self.position, velocities[0], velocities[1]]).is_none()
    }
}
