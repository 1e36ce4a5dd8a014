//! An ellipsoid.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `ellipsoid = { semi_axes_m = [0.01, 0.01, 0.02] }`: around the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// Semi-axes along the tool's x, y, z.
    #[cfg_attr(test, schemars(inner(range(min = 1e-9, max = 1e9))))]
    pub semi_axes_m: [f64; 3],
}

impl Shape for Ellipsoid {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let semi_axes_m = self.semi_axes_m;
        let reach_m = semi_axes_m.into_iter().fold(0.0, f64::max);
        solid(&ImplicitShape::Ellipsoid { semi_axes_m }, Some(reach_m), at)
    }

    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        outline::ellipsoid(self.semi_axes_m)
    }
}
