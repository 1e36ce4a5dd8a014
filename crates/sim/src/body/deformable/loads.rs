//! Contact forces that a body is given for a step.

use super::Deformable;
use crate::body::matter::FIXED;
use crate::body::scratch::DeformableScratch;
use palpate_geometry::math::Vector3;

impl Deformable {
    /// Some of the forces of this step are a tool's.
    pub fn handle(&self, scratch: &mut DeformableScratch) {
        scratch.handled = true;
    }

    /// Adds a force (N) on a coordinate of the net for this step.
    pub fn push(&self, scratch: &mut DeformableScratch, coordinate: usize, force: Vector3) {
        debug_assert!(coordinate < self.coordinate_count(), "no such coordinate");
        if self.column[coordinate] == FIXED {
            return;
        }
        if !scratch.is_loaded[coordinate] {
            scratch.is_loaded[coordinate] = true;
            scratch.loaded.push(coordinate as u32);
        }
        scratch.forces[coordinate] += force;
    }

    /// Moves the forces given so far into `loads` (coordinates).
    pub fn take_loads(&self, scratch: &mut DeformableScratch, loads: &mut [Vector3]) {
        debug_assert_eq!(loads.len(), self.coordinate_count(), "a load a coordinate");
        loads.fill(Vector3::zeros());
        for coordinate in scratch.loaded.drain(..) {
            let coordinate = coordinate as usize;
            loads[coordinate] =
                std::mem::replace(&mut scratch.forces[coordinate], Vector3::zeros());
            scratch.is_loaded[coordinate] = false;
        }
    }

    /// Gives back what [`Deformable::take_loads`] took.
    pub fn give_loads(&self, scratch: &mut DeformableScratch, loads: &[Vector3]) {
        debug_assert_eq!(loads.len(), self.coordinate_count(), "a load a coordinate");
        for (coordinate, load) in loads
            .iter()
            .enumerate()
            .filter(|(_, load)| **load != Vector3::zeros())
        {
            self.push(scratch, coordinate, *load);
        }
    }

    /// Forgets what was prepared for another state.
    pub fn forget(&self, scratch: &mut DeformableScratch) {
        scratch.at_rest = false;
        scratch.implicit.followed = None;
        self.drop_loads(scratch);
    }

    /// Forgets the forces given so far.
    pub fn drop_loads(&self, scratch: &mut DeformableScratch) {
        scratch.handled = false;
        for coordinate in scratch.loaded.drain(..) {
            scratch.forces[coordinate as usize] = Vector3::zeros();
            scratch.is_loaded[coordinate as usize] = false;
        }
    }

    /// Contact forces (N) by coordinate of the net with which the free motion of the scratch was predicted.
    pub(crate) fn carried<'a>(&self, scratch: &'a DeformableScratch) -> &'a [(u32, Vector3)] {
        &scratch.carried
    }
}
