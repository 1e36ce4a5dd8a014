//! Steps of bodies on other threads.

use crate::body::{DeformableState, Field};
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
    /// Forgets all steps that were begun.
    fn cancel(&mut self);
}
