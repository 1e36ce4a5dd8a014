//! Momentum of several bodies together, as of the pieces of one.

use super::deformable::Deformable;
use super::rigid_motion::inverse_of;
use super::rigid_velocity::RigidVelocity;
use super::state::DeformableState;
use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// Momentum of several bodies together.
#[derive(Debug, Default)]
pub(crate) struct SharedMomentum {
    mass_kg: f64,
    /// Σ m x, kg·m.
    first: Vector3,
    /// Moments of inertia about the origin, kg·m².
    second: Matrix3,
    /// kg·m/s.
    linear: Vector3,
    /// About the origin, kg·m²/s.
    angular: Vector3,
}

impl SharedMomentum {
    /// Adds what of a body can move.
    pub fn add(&mut self, body: &Deformable, state: &DeformableState) {
        let matter = body.matter();
        debug_assert_eq!(state.positions.len(), matter.masses.len(), "a mass a place");
        for &c in &matter.coordinate_of_unknown {
            let c = c as usize;
            let (m, x, v) = (
                matter.masses[c],
                state.positions[c].coords,
                state.velocities[c],
            );
            self.mass_kg += m;
            self.first += x * m;
            self.linear += v * m;
            self.angular += x.cross(&v) * m;
            self.second += (Matrix3::identity() * x.norm_squared() - x * x.transpose()) * m;
        }
    }

    /// The rigid motion that makes up for what is missing of another momentum.
    pub fn missing(&self, whole: &Self) -> SharedMotion {
        let centre = self.first / self.mass_kg;
        let linear = whole.linear - self.linear;
        let turning = whole.angular - self.angular - centre.cross(&linear);
        let about = Matrix3::identity() * centre.norm_squared() - centre * centre.transpose();
        SharedMotion(RigidVelocity {
            centre: Point3::from(centre),
            linear: linear / self.mass_kg,
            angular: inverse_of(&(self.second - about * self.mass_kg)) * turning,
        })
    }
}

/// A rigid motion that several bodies have in common.
pub(crate) struct SharedMotion(RigidVelocity);

impl SharedMotion {
    /// Adds it to what of a body can move.
    pub fn add_to(&self, body: &Deformable, state: &mut DeformableState) {
        for &c in &body.matter().coordinate_of_unknown {
            let c = c as usize;
            state.velocities[c] += self.0.velocity(&state.positions[c]);
        }
    }
}
