//! A ring.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `torus = { major_radius_m = 0.02, minor_radius_m = 0.005 }`: a ring around the tool's z axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Torus {
    /// From the centre to the middle of the tube.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub major_radius_m: f64,
    /// Radius of the tube.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub minor_radius_m: f64,
}

impl Shape for Torus {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let &Self {
            major_radius_m,
            minor_radius_m,
        } = self;
        let shape = ImplicitShape::Torus {
            major_radius_m,
            minor_radius_m,
        };
        solid(&shape, Some(major_radius_m + minor_radius_m), at)
    }

    /// Of a ring whose tube is wider than its hole, only what is outside of it.
    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        outline::ring(self.major_radius_m, self.minor_radius_m)
    }
}
