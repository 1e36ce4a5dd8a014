//! What every shape provides.

use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::surface::Mesh;

/// What the rest of the program asks of a shape.
pub(in crate::scene) trait Shape {
    /// Checks the values and builds what contact queries work with. `at` is the shape's own table.
    fn build(&self, at: &At<'_>) -> Option<ToolShape>;

    /// The shape as a viewer draws it: triangles in the tool's frame, m, counter-clockwise seen from
    /// outside. `built` is what [`Shape::build`] gave; `view_m` is the size of the scene, which
    /// bounds what has no bounds and gives a size to what has none.
    fn outline(&self, built: &ToolShape, view_m: f64) -> Mesh;

    /// Replaces files by what is in them.
    fn inline_files(&mut self, _at: &At<'_>) -> Option<()> {
        Some(())
    }

    /// Radius of a ball, m, to which nets are refined; `None` for other shapes.
    fn refines_to_radius_m(&self) -> Option<f64> {
        None
    }

    /// Outward normal of a half-space, in the tool's frame, any length; `None` for other shapes.
    fn half_space(&self) -> Option<[f64; 3]> {
        None
    }
}
