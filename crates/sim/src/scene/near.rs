//! Pairs that the broad phase let through.

use super::Scene;
use palpate_geometry::contact::broad::{BroadPhase, MAX_BOXES};

/// Fewer pairs than this are looked at one by one; a tree would cost more than it saves.
const FEW: usize = 16;
/// Boxes of the tree are widened by this share of the smallest body's size.
const WIDER: f64 = 0.1;

/// A mark by pair, and the tree that sets them. Bodies come first in its numbers, then tools.
#[derive(Clone, Debug)]
pub(crate) struct Near {
    pub marks: Vec<bool>,
    /// In scenes of many pairs.
    pub tree: Option<Box<BroadPhase>>,
}

impl Near {
    /// Nothing is near.
    pub fn new(scene: &Scene) -> Self {
        let boxes = scene.bodies.len() + scene.tools.len();
        let smallest = scene
            .bodies
            .iter()
            .map(|body| body.size_m)
            .fold(f64::INFINITY, f64::min);
        let worth = scene.pairs.len() >= FEW && boxes <= MAX_BOXES;
        let tree = worth.then(|| Box::new(BroadPhase::new(boxes, WIDER * smallest)));
        Self {
            marks: vec![false; scene.pairs.len()],
            tree,
        }
    }

    /// True when it can.
    pub fn is_near(&self, p: usize) -> bool {
        self.marks[p]
    }
}
