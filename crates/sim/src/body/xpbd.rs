//! Extended position-based dynamics with small steps (Macklin et al. 2019): every spring a
//! compliant constraint, one Gauss–Seidel iteration a substep, Voigt damping with γ = d / h.
//!
//! Kept for comparison: with a fixed number of substeps it softens silently as stiffness grows.

use super::matter::Matter;
use super::node_map::NodeMap;
use super::scratch::DeformableScratch;
use super::settings::DeformableError;
use super::state::DeformableState;

/// Constants of the method.
#[derive(Debug)]
pub(super) struct Xpbd {
    substeps: usize,
}

impl Xpbd {
    pub(super) fn new(matter: &Matter, substeps: usize) -> Result<Self, DeformableError> {
        if !matches!(matter.map, NodeMap::Same) {
            return Err(DeformableError::Unsupported(
                "xpbd moves nodes themselves; reduced bodies need \"implicit\"",
            ));
        }
        if !matter.law.is_plain_springs() {
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
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let h = matter.settings.dt_s / self.substeps as f64;
        let gamma = matter.damping_s / h;
        let rest = matter.rest_lengths(state);
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
            if matter.unknown(c).is_some() {
                1.0 / matter.masses[c]
            } else {
                0.0
            }
        };
        for _ in 0..self.substeps {
            super::matter::lanes(predicted, before);
            for &c in &matter.coordinate_of_unknown {
                let c = c as usize;
                let felt = field.at(&predicted[c], &speed[c]);
                speed[c] += (forces[c] / matter.masses[c] + felt) * h;
                predicted[c] += speed[c] * h;
            }
            for (block, place, a, b, k) in matter.law.springs.each() {
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
            for &c in &matter.coordinate_of_unknown {
                let c = c as usize;
                let [x, y, z, _] = before[c];
                speed[c] = (predicted[c] - palpate_geometry::math::Point3::new(x, y, z)) / h;
            }
        }
    }
}
