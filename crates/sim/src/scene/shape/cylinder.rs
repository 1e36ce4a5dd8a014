//! A round bar.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `cylinder = { radius_m = 0.005 }`: a round bar along the tool's z axis, around its reference
/// point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Radius.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub radius_m: f64,
    /// Half the length; without it the bar has no ends.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    #[serde(default)]
    pub half_length_m: Option<f64>,
}

impl Shape for Cylinder {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let &Self {
            radius_m,
            half_length_m,
        } = self;
        let shape = ImplicitShape::Cylinder {
            radius_m,
            half_length_m,
        };
        let reach_m = half_length_m.map(|half| libm::hypot(half, radius_m));
        solid(&shape, reach_m, at)
    }

    fn outline(&self, _built: &ToolShape, view_m: f64) -> Mesh {
        let (r, half) = (self.radius_m, self.half_length_m.unwrap_or(view_m));
        outline::revolved(&[[0.0, -half], [r, -half], [r, half], [0.0, half]])
    }
}
