//! Rigid motion of a free body: its linear and angular momentum, which no step may change.
//!
//! Backward Euler loses angular momentum: a body that turns by φ in a step goes on by
//! atan(sin φ / (2 − cos φ)), a third of its spin in a turn of 100 ms at 1 ms. What the step loses is
//! given back as a rigid motion of the velocities.

use super::matter::Matter;
use super::rigid_velocity::RigidVelocity;
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

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
        RigidVelocity {
            centre: self.centre,
            linear: self.linear / self.mass_kg,
            angular: inverse_inertia(matter, places, &self.centre) * self.angular,
        }
    }
}

/// The inverse of the moments of inertia, 1/(kg·m²); zero of bodies on a line or at a point.
fn inverse_inertia(matter: &Matter, places: &[Point3], centre: &Point3) -> Matrix3 {
    let mut inertia = Matrix3::zeros();
    for (m, x) in matter.masses.iter().zip(places) {
        let r = x - centre;
        inertia += (Matrix3::from_diagonal_element(r.norm_squared()) - r * r.transpose()) * *m;
    }
    inverse_of(&inertia)
}

/// The inverse of moments of inertia, 1/(kg·m²); zero of bodies on a line or at a point.
pub(super) fn inverse_of(inertia: &Matrix3) -> Matrix3 {
    let whole = inertia.trace();
    match inertia.try_inverse() {
        Some(inverse) if inertia.determinant() > 1e-12 * whole.powi(3) => inverse,
        _ => Matrix3::zeros(),
    }
}

/// What a free body is as a rigid one: with T its rigid motions, (Tᵀ M T)⁻¹.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertia {
    pub centre: Point3,
    pub mass_kg: f64,
    pub inverse: Matrix3,
}

impl Inertia {
    pub fn of(matter: &Matter, places: &[Point3]) -> Self {
        let mass_kg: f64 = matter.masses.iter().sum();
        let weighed = matter.masses.iter().zip(places);
        let sum: Vector3 = weighed.map(|(m, x)| x.coords * *m).sum();
        let centre = Point3::from(sum / mass_kg);
        Self {
            centre,
            mass_kg,
            inverse: inverse_inertia(matter, places, &centre),
        }
    }

    /// The rigid acceleration under loads (coordinates, N): (Tᵀ M T)⁻¹ Tᵀ; takes from each load what accelerates
    /// its own mass so.
    pub fn take_rigid(
        &self,
        matter: &Matter,
        places: &[Point3],
        loads: &mut [Lane],
    ) -> RigidVelocity {
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (load, x) in loads.iter().zip(places) {
            let load = Vector3::new(load[0], load[1], load[2]);
            force += load;
            torque += (x - self.centre).cross(&load);
        }
        let rigid = self.moved_by(force, torque);
        for ((load, x), m) in loads.iter_mut().zip(places).zip(&matter.masses) {
            let own = rigid.velocity(x) * *m;
            for (value, part) in load.iter_mut().zip(own.iter()) {
                *value -= part;
            }
        }
        rigid
    }

    /// Replaces the rigid part of a displacement (coordinates, m) by that which an acceleration makes in a step.
    pub fn set_rigid(
        &self,
        matter: &Matter,
        places: &[Point3],
        acceleration: &RigidVelocity,
        moved: &mut [Vector3],
    ) {
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        for ((d, x), m) in moved.iter().zip(places).zip(&matter.masses) {
            linear += d * *m;
            angular += (x - self.centre).cross(d) * *m;
        }
        let square = matter.settings.dt_s * matter.settings.dt_s;
        let own = self.moved_by(linear, angular);
        let change = RigidVelocity {
            centre: self.centre,
            linear: acceleration.linear * square - own.linear,
            angular: acceleration.angular * square - own.angular,
        };
        for (d, x) in moved.iter_mut().zip(places) {
            *d += change.velocity(x);
        }
    }

    /// One of the six motions at 1 m/s along an axis, or 1 rad/s about it.
    pub fn unit(&self, k: usize) -> RigidVelocity {
        let mut motion = RigidVelocity {
            centre: self.centre,
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        };
        match k < 3 {
            true => motion.linear[k] = 1.0,
            false => motion.angular[k - 3] = 1.0,
        }
        motion
    }

    fn moved_by(&self, force: Vector3, torque: Vector3) -> RigidVelocity {
        RigidVelocity {
            centre: self.centre,
            linear: force / self.mass_kg,
            angular: self.inverse * torque,
        }
    }
}
