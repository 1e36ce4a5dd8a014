//! A part as a solid, against a body.

use crate::contact::features::FeatureSearch;
use crate::contact::mesh::{MeshSolver, MeshTool};
use crate::contact::{ContactSet, Reach};
use crate::math::Pose;
use crate::skin::{Skin, SkinSide, SkinSolver};
use std::sync::Arc;

/// Scratch for a part against one body, sized once. Nothing in it outlives a query.
#[derive(Debug)]
pub struct PartSolid {
    tool: Arc<MeshTool>,
    solver: MeshSolver,
    /// The body has an inside.
    closed: bool,
    /// Of one with corners and edges.
    features: Option<FeatureSearch>,
}

impl PartSolid {
    /// Makes room for a body and a part that stands against it.
    pub fn new(body: &Skin, part: &Arc<MeshTool>) -> Self {
        let known = part.features();
        Self {
            solver: MeshSolver::new(body, part),
            features: (!known.is_empty()).then(|| FeatureSearch::new(body, known)),
            closed: body.is_closed(),
            tool: part.clone(),
        }
    }

    /// The body has no inside.
    pub fn is_on_sheet(&self) -> bool {
        !self.closed
    }

    /// Contacts of the part at a pose, as tool, with the body; each has a place on both.
    pub fn contacts(
        &mut self,
        skin: &Skin,
        closest: &mut SkinSolver,
        pose: &Pose,
        reach: &Reach,
        out: &mut ContactSet,
    ) {
        let Self {
            tool,
            solver,
            features,
            ..
        } = self;
        let known = tool.features();
        if let Some(features) = features {
            features.find(known, pose, skin, closest, reach);
        }
        let beside = features.as_ref().map_or(&[][..], FeatureSearch::found);
        let body = SkinSide {
            skin,
            solver: closest,
        };
        solver.contacts(body, tool, pose, reach, beside, out);
        if let Some(features) = features {
            features.join(known, pose, skin, closest, reach, out);
        }
        out.find_on_tool(|point| solver.place(tool, pose, point));
    }
}
