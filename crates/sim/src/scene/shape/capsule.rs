//! A round bar with round ends.

use super::interface::Shape;
use super::{outline, solid};
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::{ImplicitError, ImplicitShape};
use palpate_geometry::surface::Mesh;
use serde::{Deserialize, Serialize};

/// `capsule = { radius_m = 0.004, half_length_m = 0.02 }`: every point within `radius_m` of a
/// segment on the tool's z axis, half of it on each side of the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Radius.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub radius_m: f64,
    /// Half the length of the segment, without the round ends.
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9)))]
    pub half_length_m: f64,
}

impl Shape for Capsule {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let (r, half) = (self.radius_m, self.half_length_m);
        let mut wrong = false;
        for (key, value) in [("radius_m", r), ("half_length_m", half)] {
            if let Err(error) = ImplicitError::check_length(key, value) {
                at.key(key).refuse(error);
                wrong = true;
            }
        }
        if wrong {
            return None;
        }
        // The distance to the segment: along z only what lies beyond its ends.
        let text = format!("hypot(hypot(x, y), max(abs(z) - {half:e}, 0)) - {r:e}");
        solid(&ImplicitShape::Expression { text }, Some(half + r), at)
    }

    fn outline(&self, _built: &ToolShape, _view_m: f64) -> Mesh {
        let (r, half) = (self.radius_m, self.half_length_m);
        let profile: Vec<[f64; 2]> = outline::half_circle()
            .flat_map(|[c, s]| {
                let end = |z: f64| [r * c, r * s + z];
                // The middle of the circle is the straight part.
                if s == 0.0 {
                    vec![end(-half), end(half)]
                } else {
                    vec![end(half.copysign(s))]
                }
            })
            .collect();
        outline::revolved(&profile)
    }
}
