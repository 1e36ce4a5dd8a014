//! Extended position-based dynamics with small steps (Macklin et al. 2019): every spring a
//! compliant constraint, one Gauss–Seidel iteration a substep, Voigt damping with γ = d / h.
//!
//! Kept for comparison: with a fixed number of substeps it softens silently as stiffness grows.

use super::deformable::{Deformable, DeformableError};
use super::node_map::NodeMap;
use super::state::{DeformableScratch, DeformableState};

/// Constants of the method.
#[derive(Debug)]
pub(super) struct Xpbd {
    substeps: usize,
}

impl Xpbd {
    pub(super) fn new(body: &Deformable, substeps: usize) -> Result<Self, DeformableError> {
        if !matches!(body.map, NodeMap::Same) {
            return Err(DeformableError::Unsupported(
                "xpbd moves nodes themselves; reduced bodies need \"implicit\"",
            ));
        }
        if !body.law.is_plain_springs() {
            return Err(DeformableError::Unsupported(
                "xpbd knows linear springs only; use \"implicit\" or \"explicit\"",
            ));
        }
        Ok(Self {
            substeps: substeps.max(1),
        })
    }

    pub(super) fn substeps(&self) -> usize {
        self.substeps
    }

    /// A step from `state` with the scratch's forces, into its `predicted` and `speed`.
    pub(super) fn run(
        &self,
        body: &Deformable,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let h = body.settings.dt_s / self.substeps as f64;
        let gamma = body.damping_s / h;
        let rest = body.rest_lengths(state);
        let DeformableScratch {
            predicted,
            speed,
            forces,
            coordinates: before,
            field,
            ..
        } = scratch;
        predicted.copy_from_slice(&state.positions);
        speed.copy_from_slice(&state.velocities);
        let weight = |c: usize| {
            if body.unknown(c).is_some() {
                1.0 / body.masses[c]
            } else {
                0.0
            }
        };
        for _ in 0..self.substeps {
            super::deformable::lanes(predicted, before);
            for &c in &body.coordinate_of_unknown {
                let c = c as usize;
                let felt = field.at(&predicted[c], &speed[c]);
                speed[c] += (forces[c] / body.masses[c] + felt) * h;
                predicted[c] += speed[c] * h;
            }
            for (block, place, a, b, k) in body.law.springs.each() {
                let (wa, wb) = (weight(a), weight(b));
                let d = predicted[b] - predicted[a];
                let length = d.norm();
                if !(length > 0.0 && wa + wb > 0.0) {
                    continue;
                }
                let direction = d / length;
                let moved = |c: usize| {
                    let [x, y, z, _] = before[c];
                    predicted[c] - palpate_geometry::math::Point3::new(x, y, z)
                };
                let rate = direction.dot(&(moved(b) - moved(a)));
                let compliance = 1.0 / (k * h * h);
                let stretch = length - rest[block][place] + gamma * rate;
                let change = -stretch / ((1.0 + gamma) * (wa + wb) + compliance);
                predicted[a] -= direction * (change * wa);
                predicted[b] += direction * (change * wb);
            }
            for &c in &body.coordinate_of_unknown {
                let c = c as usize;
                let [x, y, z, _] = before[c];
                speed[c] = (predicted[c] - palpate_geometry::math::Point3::new(x, y, z)) / h;
            }
        }
    }
}
