//! Shapes of tools.

use crate::math::{Point3, Pose, Vector3};

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

    /// True for half-spaces: unbounded, the same from everywhere.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane { .. })
    }

    /// A box that holds the tool; `None` when it has no bounds.
    pub fn bounds(&self, pose: &Pose) -> Option<(Point3, Point3)> {
        let reach = Vector3::repeat(self.ball_radius_m()?);
        let centre = Point3::from(pose.translation.vector);
        Some((centre - reach, centre + reach))
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
