//! A point.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `point = {}`: the reference point itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Point {}

/// A point has no size: it is drawn as a ball of this radius, relative to the scene.
const MARKER: f64 = 0.015;

impl Shape for Point {
    fn build(&self, _at: &At<'_>) -> Option<ToolShape> {
        Some(ToolShape::Point)
    }

    fn outline(&self, _built: &ToolShape, view_m: f64) -> Mesh {
        outline::ellipsoid([MARKER * view_m; 3])
    }
}
