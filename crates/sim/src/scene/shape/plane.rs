//! A half-space.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Vector3, rotation_onto};
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `plane = { normal = [0, 0, 1] }`: everything below a plane through the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Outward normal in the tool's frame, any length above 0.
    pub normal: [f64; 3],
}

/// Thickness of the plate that is drawn, relative to its side.
const THICKNESS: f64 = 0.002;

impl Shape for Plane {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let normal = at.direction("normal", &self.normal)?;
        Some(ToolShape::Plane { normal })
    }

    /// A thin square plate as large as the scene, below the plane.
    fn outline(&self, _built: &ToolShape, view_m: f64) -> Mesh {
        let half = 0.5 * view_m;
        let mut plate = outline::cuboid([half, half, 0.5 * THICKNESS * view_m]);
        let turn = rotation_onto(&Vector3::z(), &Vector3::from(self.normal));
        for point in &mut plate.points {
            point.z -= 0.5 * THICKNESS * view_m;
            *point = turn * *point;
        }
        plate.normals.iter_mut().for_each(|n| *n = turn * *n);
        plate
    }

    fn half_space(&self) -> Option<[f64; 3]> {
        Some(self.normal)
    }
}
