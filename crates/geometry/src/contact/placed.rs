//! What stands against a body where it is: tools at their poses, and points of two surfaces.

use super::ToolShape;
use super::implicit::ImplicitTool;
use super::mesh::MeshTool;
use super::pair::PairSide;
use super::spheres::{Solid, Spheres, SpheresPair};
use crate::math::{Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSolver};
use crate::surface::Surface;

/// Points of two surfaces.
#[derive(Debug)]
pub(super) struct TwoSpheres {
    pub body: Spheres,
    pub other: Spheres,
    pub pair: SpheresPair,
}

impl TwoSpheres {
    pub fn new(body: &Surface, other: &Surface, rows: [usize; 2]) -> Self {
        let (body, other) = (Spheres::new(body, rows), Spheres::new(other, rows));
        let pair = SpheresPair::new(&body, &other);
        Self { body, other, pair }
    }
}

/// A solid tool at a pose, as the `spheres` method sees it.
pub(super) struct Placed<'a, T> {
    tool: &'a T,
    pose: &'a Pose,
    bounds: Option<(Point3, Point3)>,
}

impl<'a, T> Placed<'a, T> {
    pub fn new(tool: &'a T, shape: &ToolShape, pose: &'a Pose) -> Self {
        let bounds = shape.bounds(pose);
        Self { tool, pose, bounds }
    }

    fn may_meet(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.bounds.is_none_or(|(from, to)| {
            (0..3).all(|c| low[c] <= to[c] + margin_m && high[c] >= from[c] - margin_m)
        })
    }
}

// The normals of tools point towards their matter, those of solids out of it.
impl Solid for Placed<'_, ImplicitTool> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let seen = self.tool.signed_gap(self.pose, point);
        let (gap_m, inwards) = seen.unwrap_or((f64::INFINITY, Vector3::z()));
        (gap_m, -inwards)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.may_meet(low, high, margin_m)
    }
}

impl Solid for Placed<'_, MeshTool> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let (gap_m, inwards) = self.tool.signed_gap(self.pose, point);
        (gap_m, -inwards)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some(self.tool.signed_gap(self.pose, point).0)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.may_meet(low, high, margin_m)
    }
}

/// A rigid surface where its tool stands.
#[derive(Debug)]
pub(super) struct PlacedSurface {
    pub skin: Skin,
    pub solver: SkinSolver,
}

impl PlacedSurface {
    pub fn new(at_rest: &Surface) -> Self {
        let skin = Skin::from(at_rest.clone());
        Self {
            solver: SkinSolver::new(&skin),
            skin,
        }
    }

    pub fn place(&mut self, at_rest: &Surface, pose: &Pose) {
        let now = self
            .skin
            .surface_mut()
            .map(|now| now.net_mut().points_mut());
        for (now, rest) in now.into_iter().flatten().zip(at_rest.net().points()) {
            *now = pose * rest;
        }
        self.solver.net_changed();
    }

    pub fn side(&mut self) -> Option<PairSide<'_>> {
        Some(PairSide {
            surface: self.skin.surface()?,
            solver: self.solver.surface_mut()?,
        })
    }
}
