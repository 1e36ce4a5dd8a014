//! Shapes of tools.

use super::Features;
use super::implicit::ImplicitTool;
use super::mesh::MeshTool;
use crate::math::{Point3, Pose, Vector3};
use crate::surface::Surface;

/// A tool around its reference point, in its own frame.
///
/// # Examples
/// ```
/// use palpate_geometry::contact::ToolShape;
/// let ball = ToolShape::Sphere { radius_m: 0.01 };
/// assert_eq!((ball.ball_radius_m(), ball.reach_m()), (Some(0.01), Some(0.01)));
/// assert_eq!(ball.name(), "sphere");
/// ```
#[derive(Clone, Debug)]
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
    /// A rigid B-spline surface; solid when it is closed.
    Surface(Box<SurfaceShape>),
    /// A solid where a function is at most 0.
    Implicit {
        /// The function.
        tool: Box<ImplicitTool>,
        /// Distance from the reference point that holds all of the solid, m.
        reach_m: Option<f64>,
    },
    /// A closed triangle mesh.
    Mesh(Box<MeshTool>),
}

/// A surface as a tool.
#[derive(Clone, Debug)]
pub struct SurfaceShape {
    surface: Surface,
    reach_m: f64,
    features: Features,
}

impl SurfaceShape {
    /// `surface` in the tool's frame, m.
    pub fn new(surface: Surface) -> Self {
        let surface = surface.oriented_outward();
        let reach_m = surface
            .net()
            .points()
            .iter()
            .map(|p| p.coords.norm())
            .fold(0.0, f64::max);
        let features = Features::of_surface(&surface);
        Self {
            surface,
            reach_m,
            features,
        }
    }

    /// Its corners and edges, in the tool's frame.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// Tool frame.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }
}

impl ToolShape {
    /// Radius of the ball around the reference point, m: 0 for a point, `None` for other shapes.
    pub fn ball_radius_m(&self) -> Option<f64> {
        match self {
            Self::Point => Some(0.0),
            Self::Sphere { radius_m } => Some(*radius_m),
            _ => None,
        }
    }

    /// Largest distance of the tool's surface from its reference point, m; `None` if it is unbounded.
    pub fn reach_m(&self) -> Option<f64> {
        match self {
            Self::Point => Some(0.0),
            Self::Sphere { radius_m } => Some(*radius_m),
            Self::Plane { .. } => None,
            Self::Surface(shape) => Some(shape.reach_m),
            Self::Implicit { reach_m, .. } => *reach_m,
            Self::Mesh(mesh) => Some(mesh.reach_m()),
        }
    }

    /// Corners and edges that are known of it.
    pub fn features(&self) -> Option<&Features> {
        let features = match self {
            Self::Implicit { tool, .. } => tool.features(),
            Self::Mesh(mesh) => mesh.features(),
            Self::Surface(shape) => shape.features(),
            Self::Point | Self::Sphere { .. } | Self::Plane { .. } => return None,
        };
        Some(features).filter(|features| !features.is_empty())
    }

    /// True for half-spaces.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane { .. })
    }

    /// Axis-aligned box around the tool at a pose (lower and upper corner, m); `None` if it is
    /// unbounded.
    pub fn bounds(&self, pose: &Pose) -> Option<(Point3, Point3)> {
        let reach = Vector3::repeat(self.reach_m()?);
        let centre = Point3::from(pose.translation.vector);
        Some((centre - reach, centre + reach))
    }

    /// Name in files and messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Sphere { .. } => "sphere",
            Self::Plane { .. } => "plane",
            Self::Surface(_) => "surface",
            Self::Implicit { .. } => "implicit",
            Self::Mesh(_) => "mesh",
        }
    }
}
