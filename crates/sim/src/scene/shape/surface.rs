//! A rigid B-spline surface.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use crate::scene::spec::SurfaceSpec;
use palpate_geometry::contact::{SurfaceShape, ToolShape};
use palpate_geometry::surface::Mesh;

impl Shape for SurfaceSpec {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let surface = self.surface(at)?;
        Some(ToolShape::Surface(Box::new(SurfaceShape::new(surface))))
    }

    /// Each knot span cut evenly, as finely as the number of triangles allows.
    fn outline(&self, built: &ToolShape, _view_m: f64) -> Mesh {
        let ToolShape::Surface(shape) = built else {
            return outline::nothing();
        };
        let surface = shape.surface();
        let spans = surface.knots_u().spans().count() * surface.knots_v().spans().count();
        let cells = (outline::MOST_TRIANGLES / 2 / spans.max(1)).isqrt().max(1);
        surface
            .tessellated([cells; 2])
            .unwrap_or_else(|_| outline::nothing())
    }

    fn inline_files(&mut self, at: &At<'_>) -> Option<()> {
        self.inline_file(at)
    }
}
