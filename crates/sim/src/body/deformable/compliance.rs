//! How a body answers contact forces in the step that its scratch stands for.

use super::Deformable;
use crate::body::frame::{Frame, IDENTITY, from_rest, into_rest};
use crate::body::matter::FIXED;
use crate::body::scratch::DeformableScratch;
use crate::body::stepper::Stepper;
use crate::solve::rigid_part::RigidPart;
use palpate_geometry::math::Vector3;

impl Deformable {
    /// Place of a coordinate of the net among those that can move; `None` if it is fixed.
    pub(crate) fn surface_place(&self, coordinate: usize) -> Option<usize> {
        debug_assert!(coordinate < self.coordinate_count(), "no such coordinate");
        let place = self.column[coordinate];
        (place != FIXED).then_some(place as usize)
    }

    /// How a force held through the step on one coordinate of the net (by [`Deformable::surface_place`]) moves all of
    /// them, m/N: blocks by columns, between the frames of the coordinates.
    pub(crate) fn compliance_of<'a>(
        &'a self,
        scratch: &'a DeformableScratch,
        place: usize,
    ) -> &'a [[f32; 9]] {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.core(&scratch.implicit).surface.column(place),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => self.by_trial.column(place),
        }
    }

    /// The frame of a coordinate of the net in the step that the scratch stands for: rows of a rotation.
    pub(crate) fn frame_of<'a>(&self, scratch: &'a DeformableScratch, place: usize) -> &'a Frame {
        let coordinate = self.matter.surface[place] as usize;
        match &self.stepper {
            Stepper::Implicit(_) => {
                (scratch.implicit).frame(self.matter.unknown[coordinate] as usize)
            }
            Stepper::Explicit(_) | Stepper::Xpbd(_) => &IDENTITY,
        }
    }

    /// Finds how the rigid motions of a free body answer loads in the step that the scratch stands for: what touches it
    /// asks for that.
    pub(crate) fn find_rigid_part(&self, scratch: &mut DeformableScratch) {
        if let Stepper::Implicit(implicit) = &self.stepper {
            implicit.find_rigid_part(&self.matter, scratch);
        }
    }

    /// What was found; `None` of a body that something holds.
    pub(crate) fn rigid_part<'a>(&self, scratch: &'a DeformableScratch) -> Option<&'a RigidPart> {
        let implicit = &scratch.implicit;
        (implicit.inertia.is_some()).then_some(&implicit.rigid)
    }

    /// How a force (N) held through the step on one coordinate of the net moves another, m, without what rigid motions
    /// add; `None` where either is fixed.
    pub fn moved_by(
        &self,
        scratch: &DeformableScratch,
        (from, force): (usize, &Vector3),
        to: usize,
    ) -> Option<Vector3> {
        let (from, to) = (self.surface_place(from)?, self.surface_place(to)?);
        let block = &self.compliance_of(scratch, from)[to];
        let load = into_rest(
            self.frame_of(scratch, from),
            &[force.x, force.y, force.z, 0.0],
        );
        let along = |row: usize| {
            (0..3)
                .map(|c| f64::from(block[3 * c + row]) * load[c])
                .sum()
        };
        let moved = [along(0), along(1), along(2), 0.0];
        let [x, y, z, _] = from_rest(self.frame_of(scratch, to), &moved);
        Some(Vector3::new(x, y, z))
    }
}
