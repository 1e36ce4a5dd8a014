//! Contacts of an implicit solid with a body.

use super::shape::ImplicitTool;
use crate::contact::depth::{DepthField, SkinDepths};
use crate::contact::{Contact, ContactSet, Reach};
use crate::math::{Matrix3, Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSide};

/// Scratch against one body, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct ImplicitSolver {
    search: SkinDepths,
}

/// The solid at its pose.
struct PlacedShape<'a> {
    tool: &'a ImplicitTool,
    pose: &'a Pose,
    /// |entries| of the rotation into the tool's frame: turns half extents.
    turn: Matrix3,
    grow_m: f64,
}

impl DepthField for PlacedShape<'_> {
    fn may_reach(&self, centre: &Point3, half: &Vector3) -> bool {
        let half = self.turn * half * (1.0 + 1e-12) + Vector3::repeat(self.grow_m);
        // False for NaN too: then it may.
        let outside = self
            .tool
            .range_around(&self.pose.inverse_transform_point(centre), &half)
            .low
            > 0.0;
        !outside
    }

    fn rough(&self, p: &Point3) -> (f64, Vector3) {
        self.tool.rough(&self.pose.inverse_transform_point(p))
    }

    fn depth_m(&self, p: &Point3) -> f64 {
        self.tool.depth_m(&self.pose.inverse_transform_point(p))
    }

    fn side(&self, p: &Point3, after: usize) -> Option<usize> {
        self.tool.side(&self.pose.inverse_transform_point(p), after)
    }

    fn depth_below(&self, side: usize, p: &Point3) -> f64 {
        self.tool
            .depth_below(side, &self.pose.inverse_transform_point(p))
    }

    fn edges_known(&self) -> bool {
        self.tool.edges_known()
    }
}

impl ImplicitSolver {
    /// Makes room for the pieces of a surface, or the faces of a part.
    pub fn new(skin: &Skin) -> Self {
        Self {
            search: SkinDepths::new(skin),
        }
    }

    /// Contacts with a solid at a pose, deepest first; `out` is cleared first; `beside`: contacts of the tool's edges. A pose that is not
    /// finite touches nothing. Both sides of an open sheet are alike to a solid.
    pub fn contacts(
        &mut self,
        body: SkinSide<'_>,
        tool: &ImplicitTool,
        pose: &Pose,
        reach: &Reach,
        beside: &[Contact],
        out: &mut ContactSet,
    ) {
        let SkinSide { skin, solver } = body;
        out.clear();
        let finite = pose
            .translation
            .vector
            .iter()
            .chain(pose.rotation.coords.iter())
            .all(|x| x.is_finite());
        if !finite || !reach.margin_m.is_finite() || reach.margin_m < 0.0 {
            return;
        }
        let turn = pose
            .rotation
            .inverse()
            .to_rotation_matrix()
            .into_inner()
            .abs();
        let field = PlacedShape {
            tool,
            pose,
            turn,
            grow_m: reach.margin_m + 1e-12 * self.search.size_m(),
        };
        self.search
            .search(skin, solver, &field, reach.margin_m, beside, out);
        for top in self.search.found(skin) {
            let ([u, v], on_body) = (top.place, top.point);
            let Some(stand) = tool.stand(&pose.inverse_transform_point(&on_body)) else {
                continue;
            };
            let normal = -(pose.rotation * stand.uphill);
            let on_tool = on_body - normal * stand.depth_m;
            out.push(Contact {
                u,
                v,
                on_body,
                on_tool,
                normal,
                depth_m: stand.depth_m,
                tool_uv: None,
                point: top.mark,
            });
        }
        if out.deepest().is_some() {
            self.search.report(out);
        }
    }
}
