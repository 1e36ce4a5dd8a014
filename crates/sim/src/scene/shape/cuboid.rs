//! A cuboid.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `box = { half_extents_m = [0.01, 0.02, 0.005] }`: around the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Half of each edge.
    #[cfg_attr(test, schemars(inner(range(min = 1e-9, max = 1e9))))]
    pub half_extents_m: [f64; 3],
}

impl Shape for Cuboid {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let half_extents_m = self.half_extents_m;
        let reach_m = Point3::from(half_extents_m).coords.norm();
        solid(&ImplicitShape::Box { half_extents_m }, Some(reach_m), at)
    }

    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        outline::cuboid(self.half_extents_m)
    }
}
