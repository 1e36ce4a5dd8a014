//! Natural monotonicity (Deuflhard): the residual of an iteration, in the norm of B⁻¹, may not grow.
//!
//! That norm is the product of the residual with its correction, which is there anyway. Where it grows, half of the last
//! correction is taken back.

use super::state::DeformableScratch;
use palpate_geometry::math::{Lane, Point3, Vector3};

/// Where a step of several iterations was looked at last.
#[derive(Clone, Debug, Default)]
pub(super) struct Before {
    reached: Vec<Point3>,
    predicted: Vec<Point3>,
    pressures: Vec<Lane>,
    carried: Vec<(u32, Vector3)>,
    /// Half of a correction was taken back in this step.
    pub halved: bool,
}

impl Before {
    /// Room for the places and pressures of a scratch.
    pub fn for_scratch(scratch: &DeformableScratch) -> Self {
        Self {
            reached: scratch.reached.clone(),
            predicted: scratch.predicted.clone(),
            pressures: scratch.implicit.pressures.clone(),
            carried: Vec::with_capacity(2 * scratch.carried.capacity()),
            halved: false,
        }
    }

    /// Remembers where the step was looked at: before the correction in the scratch is added.
    pub fn keep(scratch: &mut DeformableScratch) {
        let before = &mut scratch.before;
        before.reached.copy_from_slice(&scratch.reached);
        before.predicted.copy_from_slice(&scratch.predicted);
        before.pressures.copy_from_slice(&scratch.looked);
        before.carried.clone_from(&scratch.carried);
    }

    /// Goes half of the way back to there.
    pub fn go_half_back(scratch: &mut DeformableScratch) {
        let DeformableScratch {
            before,
            reached,
            predicted,
            implicit,
            carried,
            looked,
            ..
        } = scratch;
        before.halved = true;
        let places = reached.iter_mut().chain(predicted);
        for (z, from) in places.zip(before.reached.iter().chain(&before.predicted)) {
            *z = nalgebra::center(z, from);
        }
        let of_look = looked
            .as_flattened()
            .iter()
            .zip(before.pressures.as_flattened());
        let pressures = implicit.pressures.as_flattened_mut().iter_mut();
        for (q, (last, from)) in pressures.zip(of_look) {
            *q = 0.5 * (last + from);
        }
        carried.iter_mut().for_each(|(_, force)| *force *= 0.5);
        for &(c, force) in &before.carried {
            match carried.binary_search_by_key(&c, |entry| entry.0) {
                Ok(k) => carried[k].1 += force * 0.5,
                Err(k) => carried.insert(k, (c, force * 0.5)),
            }
        }
    }
}
