//! Shapes of tools: one file each, which knows how a scene writes the shape, what may be wrong with
//! it, what contact queries it becomes, and how it is drawn.
//!
//! To add a shape: its file, with a type that implements `Shape`, and its two lines here.

mod capsule;
mod cone;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod implicit;
mod interface;
mod mesh;
mod outline;
mod plane;
mod point;
mod sphere;
mod surface;
mod torus;

use super::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::implicit::{ImplicitError, ImplicitShape};
use serde::{Deserialize, Serialize};

pub(super) use interface::Shape;

pub use capsule::Capsule;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use implicit::Implicit;
pub use mesh::{InlineMesh, MeshSpec, MeshUnit};
pub use plane::Plane;
pub use point::Point;
pub use sphere::Sphere;
pub use torus::Torus;

macro_rules! shapes {
    ($($(#[$doc:meta])* $variant:ident($spec:ty) = $name:literal),* $(,)?) => {
        /// Shape of a tool: `shape = { point = {} }`, `{ sphere = { radius_m = 0.01 } }`,
        /// `{ plane = { normal = [0, 0, 1] } }`, `{ surface = { builtin = "torus" } }`,
        /// `{ cylinder = { radius_m = 0.005 } }`, `{ mesh = { file = "probe.stl" } }` …
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(test, derive(schemars::JsonSchema))]
        #[serde(deny_unknown_fields)]
        pub enum ShapeSpec {
            $($(#[$doc])* #[serde(rename = $name)] $variant($spec)),*
        }

        impl ShapeSpec {
            /// Name of the shape, as scenes write it.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name),* }
            }

            pub(super) fn shape(&self) -> &dyn Shape {
                match self { $(Self::$variant(spec) => spec),* }
            }

            fn shape_mut(&mut self) -> &mut dyn Shape {
                match self { $(Self::$variant(spec) => spec),* }
            }
        }
    };
}

shapes! {
    /// A point.
    Point(Point) = "point",
    /// A ball around the reference point.
    Sphere(Sphere) = "sphere",
    /// Everything below a plane through the reference point.
    Plane(Plane) = "plane",
    /// A rigid B-spline surface in the tool's frame.
    Surface(super::spec::SurfaceSpec) = "surface",
    /// A round bar along the tool's z axis, around its reference point.
    Cylinder(Cylinder) = "cylinder",
    /// A round bar along the tool's z axis with half balls as ends.
    Capsule(Capsule) = "capsule",
    /// A cone with its tip at the reference point, opening towards the tool's +z.
    Cone(Cone) = "cone",
    /// An ellipsoid around the reference point.
    Ellipsoid(Ellipsoid) = "ellipsoid",
    /// A ring around the tool's z axis.
    Torus(Torus) = "torus",
    /// A cuboid around the reference point.
    Box(Cuboid) = "box",
    /// The solid in which a function is at most 0.
    Implicit(Implicit) = "implicit",
    /// A closed triangle mesh in the tool's frame.
    Mesh(MeshSpec) = "mesh",
}

impl Default for ShapeSpec {
    fn default() -> Self {
        Self::Sphere(Sphere { radius_m: 0.01 })
    }
}

impl ShapeSpec {
    /// Checks and builds the shape; `at` is the key `shape`.
    pub(super) fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        self.shape().build(&at.key(self.name()))
    }

    /// Replaces files by what is in them; `at` is the key `shape`.
    pub(super) fn inline_files(&mut self, at: &At<'_>) -> Option<()> {
        let at = at.key(self.name());
        self.shape_mut().inline_files(&at)
    }
}

/// A solid given by a function; problems stand at the keys that its sizes come from.
fn solid(shape: &ImplicitShape, reach_m: Option<f64>, at: &At<'_>) -> Option<ToolShape> {
    let wrong = shape.wrong_sizes();
    for error in &wrong {
        match error {
            ImplicitError::Size { name, .. } => at.key(name).refuse(error),
            ImplicitError::Expression(_) => at.refuse(error),
        }
    }
    if !wrong.is_empty() {
        return None;
    }
    let mut tool = at.take(shape.compile())?;
    if let Some(reach_m) = reach_m {
        tool = tool.with_edges_found(reach_m);
    }
    Some(ToolShape::Implicit {
        tool: Box::new(tool),
        reach_m,
    })
}

#[cfg(test)]
mod tests;
