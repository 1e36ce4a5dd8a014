//! Natural monotonicity (Deuflhard): the residual of an iteration, in the norm of B⁻¹, may not grow.
//!
//! That norm is the product of the residual with its correction, which is there anyway. Where it grows, half of the last
//! correction is taken back.

use palpate_geometry::math::{Lane, Point3, Vector3};

/// Where a step of several iterations is when its residual is looked at.
pub(super) struct Look<'a> {
    /// (coordinates), m: with contact forces, and without what these changed.
    pub reached: &'a mut [Point3],
    pub predicted: &'a mut [Point3],
    /// Pressures at this look, and after its correction, Pa.
    pub looked: &'a [Lane],
    pub pressures: &'a mut [Lane],
    /// Contact forces by coordinate, ascending, N.
    pub carried: &'a mut Vec<(u32, Vector3)>,
}

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
    /// Buffers for a body with these places and pressures, and room for so many contact forces.
    pub fn new(places: &[Point3], pressures: &[Lane], forces: usize) -> Self {
        Self {
            reached: places.to_vec(),
            predicted: places.to_vec(),
            pressures: pressures.to_vec(),
            carried: Vec::with_capacity(forces),
            halved: false,
        }
    }

    /// Remembers where the step was looked at, before its correction is added.
    pub fn keep(&mut self, at: &Look<'_>) {
        self.reached.copy_from_slice(at.reached);
        self.predicted.copy_from_slice(at.predicted);
        self.pressures.copy_from_slice(at.looked);
        self.carried.clone_from(at.carried);
    }

    /// Goes half of the way back to there.
    pub fn go_half_back(&mut self, at: &mut Look<'_>) {
        self.halved = true;
        let places = at.reached.iter_mut().chain(&mut *at.predicted);
        for (z, from) in places.zip(self.reached.iter().chain(&self.predicted)) {
            *z = nalgebra::center(z, from);
        }
        let of_look = (at.looked.as_flattened().iter()).zip(self.pressures.as_flattened());
        let pressures = at.pressures.as_flattened_mut().iter_mut();
        for (q, (last, from)) in pressures.zip(of_look) {
            *q = 0.5 * (last + from);
        }
        at.carried.iter_mut().for_each(|(_, force)| *force *= 0.5);
        for &(c, force) in &self.carried {
            match at.carried.binary_search_by_key(&c, |entry| entry.0) {
                Ok(k) => at.carried[k].1 += force * 0.5,
                Err(k) => at.carried.insert(k, (c, force * 0.5)),
            }
        }
    }
}
