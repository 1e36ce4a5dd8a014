//! A solid given by a function.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `implicit = { f = "x^2 + y^2 + 4*z^2 - 1e-4", reach_m = 0.02 }`: the solid in which a function is
/// at most 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Implicit {
    /// Function of x, y, z in metres, in the tool's frame: `"x^2 + y^2 + 4*z^2 - 1e-4"`.
    pub f: String,
    /// Distance from the reference point that contains the whole solid; without it the tool is
    /// tested against everything.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    #[serde(default)]
    pub reach_m: Option<f64>,
}

impl Shape for Implicit {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let text = self.f.clone();
        let shape = solid(
            &ImplicitShape::Expression { text },
            self.reach_m,
            &at.key("f"),
        );
        if let Some(reach_m) = self.reach_m {
            at.above_zero("reach_m", reach_m, "m (or left out)")?;
        }
        shape
    }

    /// Sampled within the reach, or within the scene where there is none.
    fn outline(&self, built: &ToolShape, view_m: f64) -> Mesh {
        match built {
            ToolShape::Implicit { tool, .. } => {
                tool.outline(self.reach_m.unwrap_or(view_m), outline::MOST_TRIANGLES)
            }
            _ => outline::nothing(),
        }
    }
}
