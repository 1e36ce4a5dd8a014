//! What free points of a body feel.

use palpate_geometry::math::{Point3, Vector3};

/// Acceleration of a free point in the body's frame, which may be carried about: gravity less that
/// of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// At the frame's origin, m/s².
    pub at_origin: Vector3,
    /// ω of the frame, in it, rad/s.
    pub turning_rad_s: Vector3,
    /// dω/dt, rad/s².
    pub turning_rad_s2: Vector3,
}

impl Field {
    /// Of a frame that stands still.
    pub fn gravity(acceleration_m_s2: Vector3) -> Self {
        Self {
            at_origin: acceleration_m_s2,
            ..Self::default()
        }
    }

    /// g − a − dω/dt × r − ω × (ω × r) − 2 ω × v.
    #[inline]
    pub fn at(&self, place: &Point3, velocity: &Vector3) -> Vector3 {
        let (omega, zero) = (self.turning_rad_s, Vector3::zeros());
        if omega == zero && self.turning_rad_s2 == zero {
            return self.at_origin;
        }
        let inward = omega.cross(&(omega.cross(&place.coords) + velocity * 2.0));
        self.at_origin - self.turning_rad_s2.cross(&place.coords) - inward
    }
}
