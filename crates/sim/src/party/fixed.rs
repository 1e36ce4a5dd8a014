//! A surface that stands still.

use super::body::{BodyScratch, BodyState, Of};
use super::contract::{Around, Party};
use crate::tick::record::TickFault;
use palpate_geometry::math::Point3;

/// It has no constants beyond its surface.
pub(crate) struct Fixed;

impl Party for Of<'_, Fixed> {
    type State = BodyState;
    type Scratch = BodyScratch;

    fn start(&self) -> BodyState {
        BodyState::default()
    }

    fn scratch(&self) -> BodyScratch {
        BodyScratch::of(self.body)
    }

    fn apply(&self, _: &Around<'_>, _: &mut BodyState, _: &mut BodyScratch) -> Option<TickFault> {
        None
    }

    fn net(&self, _: &BodyState, out: &mut [Point3]) {
        out.copy_from_slice(self.body.skin.points());
    }
}
