//! A rigid B-spline surface.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use crate::scene::spec::SurfaceSpec;
use crate::scene::surface::Named;
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::contact::{SurfaceShape, ToolShape};
use palpate_geometry::surface::Mesh;
use std::sync::Arc;

impl Shape for SurfaceSpec {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        Some(match self.loaded(at)? {
            Named::Surface(loaded) => {
                loaded.merged.iter().for_each(|merged| at.note(merged));
                ToolShape::Surface(Box::new(SurfaceShape::new(loaded.surface)))
            }
            Named::Part(part, notes) => {
                notes.iter().for_each(|note| at.note(note));
                let tool = at.take(MeshTool::of_part(Arc::from(part)))?;
                ToolShape::Mesh(Box::new(tool))
            }
        })
    }

    /// Each knot span cut evenly, as finely as the number of triangles allows.
    fn outline(&self, built: &ToolShape, _view_m: f64) -> Mesh {
        let shape = match built {
            ToolShape::Surface(shape) => shape,
            ToolShape::Mesh(tool) => {
                return Mesh::from_triangles(tool.vertices().to_vec(), tool.triangles().to_vec())
                    .unwrap_or_else(outline::nothing);
            }
            _ => return outline::nothing(),
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
