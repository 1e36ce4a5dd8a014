//! Steps of bodies on other threads.

use crate::body::{DeformableState, Field, Made};
use palpate_geometry::math::{Point3, Vector3};

/// Steps of bodies on other threads: begun with the loads of one tick, taken over some ticks later,
/// always the same number but for those in which they were put off.
pub trait Pipeline: Send + std::fmt::Debug {
    /// Begins the step of a body: `predicted` is its free motion, `loads` are its contact forces.
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    );
    /// True when neither beginning a step nor taking over the one that was begun would wait.
    fn is_ready(&mut self, body: usize) -> bool;
    /// Waits for that step: the state after it, and the free motion of the next. False if none was
    /// begun.
    fn finish(
        &mut self,
        body: usize,
        state: &mut DeformableState,
        predicted: &mut [Point3],
    ) -> bool;
    /// Begins to [make](crate::body::Deformable::make) the next matrix of a body.
    fn make(&mut self, _body: usize, _state: &DeformableState) {}
    /// True when taking that over would not wait.
    fn is_made(&mut self, _body: usize) -> bool {
        true
    }
    /// Waits for that matrix, and takes the one that it replaces, to be dropped elsewhere. `None` if none was begun: it is
    /// then made in the tick.
    fn made(&mut self, _body: usize, _old: Option<Made>) -> Option<Made> {
        None
    }
    /// Forgets all steps and matrices that were begun.
    fn cancel(&mut self);
}
