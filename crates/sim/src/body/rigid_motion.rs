//! Rigid motion of a free body: its linear and angular momentum, which no step may change.
//!
//! Backward Euler loses angular momentum: a body that turns by φ in a step goes on by
//! atan(sin φ / (2 − cos φ)), a third of its spin in a turn of 100 ms at 1 ms. What the step loses is
//! given back as a rigid motion of the velocities.

use super::matter::Matter;
use super::rigid_velocity::RigidVelocity;
use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// Linear momentum, and angular momentum about the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Momentum {
    pub mass_kg: f64,
    pub centre: Point3,
    pub linear: Vector3,
    pub angular: Vector3,
}

impl Momentum {
    pub fn of(matter: &Matter, places: &[Point3], velocities: &[Vector3]) -> Self {
        debug_assert_eq!(places.len(), velocities.len(), "a velocity a place");
        let (mut mass_kg, mut centre, mut linear) = (0.0, Vector3::zeros(), Vector3::zeros());
        for ((m, x), v) in matter.masses.iter().zip(places).zip(velocities) {
            mass_kg += m;
            centre += x.coords * *m;
            linear += v * *m;
        }
        let centre = Point3::from(centre / mass_kg);
        let mut angular = Vector3::zeros();
        for ((m, x), v) in matter.masses.iter().zip(places).zip(velocities) {
            angular += (x - centre).cross(v) * *m;
        }
        Self {
            mass_kg,
            centre,
            linear,
            angular,
        }
    }

    /// The rigid motion with this momentum; bodies on a line or at a point do not turn.
    pub fn rigid(&self, matter: &Matter, places: &[Point3]) -> RigidVelocity {
        let mut inertia = Matrix3::zeros();
        for (m, x) in matter.masses.iter().zip(places) {
            let r = x - self.centre;
            inertia += (Matrix3::from_diagonal_element(r.norm_squared()) - r * r.transpose()) * *m;
        }
        let whole = inertia.trace();
        let angular = match inertia.try_inverse() {
            Some(inverse) if inertia.determinant() > 1e-12 * whole.powi(3) => {
                inverse * self.angular
            }
            _ => Vector3::zeros(),
        };
        RigidVelocity {
            centre: self.centre,
            linear: self.linear / self.mass_kg,
            angular,
        }
    }
}
