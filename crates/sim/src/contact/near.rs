//! Broad phase: which pairs can touch in this tick.
//!
//! In scenes of many pairs a tree of boxes sorts out most. What it lets through is looked at again,
//! box against box, so that the answer does not depend on what the tree remembers.

use super::feet::{margin_m, meet};
use crate::party::ToolState;
use crate::party::{BodyScratch, ToolScratch};
use crate::scene::Scene;
use crate::solve::rows::Holder;
use palpate_geometry::contact::broad::{BroadPhase, MAX_BOXES};
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::Bounds;

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
    pub(crate) fn new(scene: &Scene) -> Self {
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
    pub(crate) fn is_near(&self, p: usize) -> bool {
        self.marks[p]
    }
}

type Corners = (Point3, Point3);

/// Marks the pairs whose boxes meet. A tool's box holds its whole way from the last proxy to where
/// it is free to go.
pub(crate) fn find(
    scene: &Scene,
    states: &[ToolState],
    tools: &[ToolScratch],
    bodies: &[BodyScratch],
    near: &mut Near,
) {
    let way_of = |t: usize| -> Option<Corners> {
        let (shape, rotation) = (&scene.tools[t].shape, states[t].link.pose.orientation);
        let at = |place: Point3| shape.bounds(&Pose::from_parts(place.coords.into(), rotation));
        let ((low, high), (free_low, free_high)) = (at(states[t].proxy)?, at(tools[t].free)?);
        Some((low.inf(&free_low), high.sup(&free_high)))
    };
    let Near { marks, tree } = near;
    let candidates = tree.as_deref_mut().map(|tree| {
        let count = scene.bodies.len() as u32;
        for (b, parts) in bodies.iter().enumerate() {
            let margin = Vector3::repeat(margin_m(0.0, scene.bodies[b].size_m));
            let bounds = Bounds {
                min: parts.bounds.0 - margin,
                max: parts.bounds.1 + margin,
            };
            tree.set(b as u32, &bounds, &Vector3::zeros());
        }
        for t in 0..scene.tools.len() {
            let number = count + t as u32;
            match way_of(t) {
                Some((low, high)) => {
                    let margin = Vector3::repeat(margin_m(
                        scene.tools[t].shape.ball_radius_m().unwrap_or(0.0),
                        0.0,
                    ));
                    tree.set(
                        number,
                        &Bounds {
                            min: low - margin,
                            max: high + margin,
                        },
                        &Vector3::zeros(),
                    );
                }
                None => {
                    tree.remove(number);
                }
            }
        }
        (count, tree.pairs())
    });
    for (p, pair) in scene.pairs.iter().enumerate() {
        let body = &scene.bodies[pair.body];
        let number = |count: u32| match pair.holder {
            Holder::Tool(t) => count + t,
            Holder::Body(other) => other,
        };
        let let_through = |&(count, pairs): &(u32, &[(u32, u32)])| {
            let (a, b) = (pair.body as u32, number(count));
            pairs.binary_search(&(a.min(b), a.max(b))).is_ok()
        };
        let bounds = &bodies[pair.body].bounds;
        let near = match pair.holder {
            Holder::Body(other) if other as usize == pair.body => true,
            Holder::Body(other) => {
                let (low, high) = &bodies[other as usize].bounds;
                let margin = margin_m(0.0, body.size_m.max(scene.bodies[other as usize].size_m));
                candidates.as_ref().is_none_or(let_through) && meet(bounds, low, high, margin)
            }
            Holder::Tool(t) => match way_of(t as usize) {
                Some((low, high)) => {
                    let radius = scene.tools[t as usize].shape.ball_radius_m().unwrap_or(0.0);
                    let margin = margin_m(radius, body.size_m);
                    candidates.as_ref().is_none_or(let_through) && meet(bounds, &low, &high, margin)
                }
                None => true,
            },
        };
        marks[p] = near;
    }
}
