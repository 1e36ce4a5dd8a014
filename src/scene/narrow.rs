//! The narrow phase of each pair, with its scratch.

use super::state::BodyScratch;
use super::{Pair, Scene};
use crate::contact::exact::{self, ExactScratch};
use crate::contact::pair::{PairSide, PairSolver};
use crate::contact::rows::{DeformingView, Facing, Holder, SampleInTouch};
use crate::contact::{ContactSet, Reach, ToolShape};
use crate::math::{Point3, Pose};
use crate::surface::ClosestSolver;

/// The contacts of a pair and what finds them.
#[derive(Debug)]
pub(crate) struct PairScratch {
    pub set: ContactSet,
    narrow: Narrow,
}

/// What finds the contacts of a pair.
#[derive(Debug)]
enum Narrow {
    /// Balls and planes.
    Simple(Box<ExactScratch>),
    /// Two bodies.
    Bodies(Box<PairSolver>),
    /// A body with itself.
    Own,
}

impl PairScratch {
    /// What the pair needs, and no more.
    pub fn new(scene: &Scene, pair: &Pair) -> Self {
        let body = &scene.bodies[pair.body];
        let narrow = match pair.holder {
            Holder::Body(other) if other as usize == pair.body => Narrow::Own,
            Holder::Body(other) => {
                Narrow::Bodies(Box::new(PairSolver::new(&body.surface, &scene.bodies[other as usize].surface)))
            }
            Holder::Tool(_) => {
                let mut solver = ClosestSolver::new(&body.surface);
                Narrow::Simple(Box::new(ExactScratch::new(&body.surface, &mut solver)))
            }
        };
        Self { set: ContactSet::new(), narrow }
    }

    /// Contacts of a tool at `pose` with a body.
    pub fn contacts(&mut self, shape: &ToolShape, pose: &Pose, parts: &mut BodyScratch, reach: Reach) {
        self.set.clear();
        let (surface, solver) = (&parts.surface, &mut parts.solver);
        let place = Point3::from(pose.translation.vector);
        match (shape, &mut self.narrow) {
            (ToolShape::Plane { normal }, Narrow::Simple(scratch)) => {
                let plane = pose.rotation * normal;
                exact::plane::contacts(surface, solver, &place, &plane, &reach, scratch, &mut self.set);
            }
            (shape, Narrow::Simple(scratch)) => {
                if let Some(radius_m) = shape.ball_radius_m() {
                    exact::ball::contacts(surface, solver, &place, radius_m, &reach, scratch, &mut self.set);
                }
            }
            _ => {}
        }
    }

    /// Samples of a deforming body in touch with a tool that is no ball.
    pub fn samples_in_touch(
        &mut self,
        shape: &ToolShape,
        pose: &Pose,
        view: &DeformingView<'_>,
        margin_m: f64,
        meets: impl Fn(&Point3, &Point3) -> bool,
        hits: &mut Vec<SampleInTouch>,
    ) {
        let place = Point3::from(pose.translation.vector);
        if let ToolShape::Plane { normal } = shape {
            let plane = pose.rotation * normal;
            let look = |x: &Point3| {
                let (gap_m, normal) = exact::plane::signed_gap(&place, &plane, x);
                Some(Facing { gap_m, normal, uv: [0.0; 2] })
            };
            view.samples_in_touch(margin_m, meets, look, hits);
        }
    }

    /// Contacts of two bodies.
    pub fn body_contacts(&mut self, mine: &mut BodyScratch, theirs: &mut BodyScratch, reach: Reach) {
        self.set.clear();
        if let Narrow::Bodies(solver) = &mut self.narrow {
            let (mine, theirs) = (side(mine), side(theirs));
            solver.contacts(mine, theirs, reach, &mut self.set);
        }
    }

    /// Contacts of a body with itself.
    pub fn own_contacts(&mut self, _parts: &mut BodyScratch, _reach: Reach) {
        self.set.clear();
    }
}

fn side(parts: &mut BodyScratch) -> PairSide<'_> {
    PairSide { surface: &parts.surface, solver: &mut parts.solver }
}
