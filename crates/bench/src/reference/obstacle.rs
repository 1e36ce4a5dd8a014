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
    /// All that lies below z = bend (x² + y²) from the bottom.
    Bowl {
        /// Its lowest point, m.
        bottom: Point3,
        /// Half of the curvature there, 1/m, above zero.
        bend: f64,
    },
}

impl Obstacle {
    /// Gap g (m, negative inside), ∂g/∂x (out of the obstacle) and ∂²g/∂x² at a place. Of a bowl, all
    /// three are exact on its surface; away from it they are those of heights over it, along its
    /// normal below the place.
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
            Self::Bowl { bottom, bend } => {
                let from = at - bottom;
                let (x, y) = (from.x, from.y);
                let slope = Vector3::new(-2.0 * bend * x, -2.0 * bend * y, 1.0);
                let steep = slope.norm();
                let across = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
                (
                    (from.z - bend * (x * x + y * y)) / steep,
                    slope / steep,
                    across * (-2.0 * bend / steep),
                )
            }
        }
    }
}
