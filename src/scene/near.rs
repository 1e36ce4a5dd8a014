//! Pairs that the broad phase let through.

use super::Scene;

/// A mark by pair.
#[derive(Clone, Debug)]
pub(crate) struct Near {
    marks: Vec<bool>,
}

impl Near {
    /// Nothing is near.
    pub fn new(scene: &Scene) -> Self {
        Self { marks: vec![false; scene.pairs.len()] }
    }

    /// Whether pair `p` can touch in this tick.
    pub fn mark(&mut self, p: usize, near: bool) {
        self.marks[p] = near;
    }

    /// True when it can.
    pub fn is_near(&self, p: usize) -> bool {
        self.marks[p]
    }
}
