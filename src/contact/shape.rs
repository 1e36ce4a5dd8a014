//! Shapes of tools.

use crate::math::Vector3;

/// A tool around its reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolShape {
    /// The reference point itself.
    Point,
    /// A ball.
    Sphere {
        /// m, above 0.
        radius_m: f64,
    },
    /// Everything below a plane through the reference point.
    Plane {
        /// Outward unit normal, tool frame.
        normal: Vector3,
    },
}

impl ToolShape {
    /// Radius of the ball around the reference point, 0 for a point; `None` for shapes that are no ball.
    pub fn ball_radius_m(&self) -> Option<f64> {
        match self {
            Self::Point => Some(0.0),
            Self::Sphere { radius_m } => Some(*radius_m),
            Self::Plane { .. } => None,
        }
    }

    /// Name in files and messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Sphere { .. } => "sphere",
            Self::Plane { .. } => "plane",
        }
    }
}
