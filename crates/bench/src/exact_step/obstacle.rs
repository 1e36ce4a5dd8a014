//! What a body is pressed with.

use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// A rigid frictionless obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// A ball.
    Sphere {
        /// Its centre, m.
        centre: Point3,
        /// Its radius, m.
        radius_m: f64,
    },
    /// All that lies behind a plane.
    Plane {
        /// A point of the plane, m.
        point: Point3,
        /// Unit normal, out of the obstacle.
        normal: Vector3,
    },
}

impl Obstacle {
    /// Gap g (m, negative inside), ∂g/∂x (out of the obstacle) and ∂²g/∂x² at a place.
    pub fn gap(&self, at: &Point3) -> (f64, Vector3, Matrix3) {
        match *self {
            Self::Sphere { centre, radius_m } => {
                let from = at - centre;
                let distance = from.norm();
                if distance == 0.0 {
                    // The centre has no nearest side; any will do.
                    return (-radius_m, Vector3::z(), Matrix3::zeros());
                }
                let normal = from / distance;
                (
                    distance - radius_m,
                    normal,
                    (Matrix3::identity() - normal * normal.transpose()) / distance,
                )
            }
            Self::Plane { point, normal } => ((at - point).dot(&normal), normal, Matrix3::zeros()),
        }
    }
}
