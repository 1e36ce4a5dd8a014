//! The narrow phase of each pair, with its scratch.

use super::state::BodyScratch;
use super::{Pair, Scene};
use crate::contact::rows::{DeformingView, Facing, SampleInTouch};
use crate::contact::{Contact, ContactSet, Reach, ToolShape};
use crate::math::{Point3, Pose};
use crate::surface::{ClosestSolver, Surface};

/// The contacts of a pair and what finds them.
#[derive(Debug)]
pub(crate) struct PairScratch {
    pub set: ContactSet,
}

impl PairScratch {
    /// What the pair needs, and no more.
    pub fn new(_scene: &Scene, _pair: &Pair) -> Self {
        Self { set: ContactSet::new() }
    }

    /// Contacts of a tool at `pose` with a body.
    pub fn contacts(
        &mut self,
        shape: &ToolShape,
        pose: &Pose,
        surface: &Surface,
        solver: &mut ClosestSolver,
        reach: Reach,
    ) {
        self.set.clear();
        if let ToolShape::Plane { normal } = shape {
            let plane = pose.rotation * normal;
            let point = Point3::from(pose.translation.vector);
            let (u, v, on_body) = solver.deepest_along(surface, &-plane);
            let depth_m = (point - on_body).dot(&plane);
            if depth_m > -reach.margin_m {
                let normal = -plane;
                self.set.push(Contact {
                    u,
                    v,
                    on_body,
                    on_tool: on_body - normal * depth_m,
                    normal,
                    depth_m,
                    tool_uv: None,
                });
            }
        }
    }

    /// Samples of a deforming body in touch with a tool.
    pub fn samples_in_touch(
        &mut self,
        shape: &ToolShape,
        pose: &Pose,
        view: &DeformingView<'_>,
        margin_m: f64,
        meets: impl Fn(&Point3, &Point3) -> bool,
        hits: &mut Vec<SampleInTouch>,
    ) {
        if let ToolShape::Plane { normal } = shape {
            let plane = pose.rotation * normal;
            let point = Point3::from(pose.translation.vector);
            let look = |x: &Point3| Some(Facing { gap_m: (x - point).dot(&plane), normal: -plane, uv: [0.0; 2] });
            view.samples_in_touch(margin_m, meets, look, hits);
        }
    }

    /// Contacts of two bodies.
    pub fn body_contacts(&mut self, _mine: &mut BodyScratch, _theirs: &mut BodyScratch, _reach: Reach) {
        self.set.clear();
    }

    /// Contacts of a body with itself.
    pub fn own_contacts(&mut self, _parts: &mut BodyScratch, _reach: Reach) {
        self.set.clear();
    }
}
