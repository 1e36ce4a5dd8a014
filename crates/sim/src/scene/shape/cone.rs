//! A cone.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `cone = { half_angle_rad = 0.3, height_m = 0.02 }`: its tip is the reference point, and it opens
/// towards the tool's +z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Angle between axis and side, below π/2.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = std::f64::consts::FRAC_PI_2)))]
    pub half_angle_rad: f64,
    /// From tip to base.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub height_m: f64,
}

impl Shape for Cone {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let &Self {
            half_angle_rad,
            height_m,
        } = self;
        let shape = ImplicitShape::Cone {
            half_angle_rad,
            height_m,
        };
        let reach_m = height_m / libm::cos(half_angle_rad);
        solid(&shape, Some(reach_m), at)
    }

    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        let h = self.height_m;
        outline::revolved(&[
            [0.0, 0.0],
            [h * libm::tan(self.half_angle_rad), h],
            [0.0, h],
        ])
    }
}
