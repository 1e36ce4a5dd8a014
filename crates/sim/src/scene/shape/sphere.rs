//! A ball.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `sphere = { radius_m = 0.01 }`: a ball around the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Radius.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub radius_m: f64,
}

impl Shape for Sphere {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let radius_m = at.above_zero("radius_m", self.radius_m, "m")?;
        Some(ToolShape::Sphere { radius_m })
    }

    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        outline::ellipsoid([self.radius_m; 3])
    }

    fn refines_to_radius_m(&self) -> Option<f64> {
        Some(self.radius_m)
    }
}
