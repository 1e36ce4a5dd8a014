//! The shapes of tools, as triangles in their frames: what `/tools.json` lists.

use palpate_sim::scene::Scene;
use serde::Serialize;

/// The shape of a tool.
#[derive(Clone, Debug, Serialize)]
struct Outline {
    id: String,
    shape: &'static str,
    /// m.
    points: Vec<[f32; 3]>,
    /// Counter-clockwise seen from outside.
    triangles: Vec<[u32; 3]>,
}

/// JSON: the shapes of all tools of a scene. Planes and other shapes without an end are cut at the
/// size of the largest body.
pub(super) fn json(scene: &Scene) -> String {
    let size_m = (0..scene.body_count())
        .map(|body| scene.rest_surface(body).size())
        .fold(1e-3, f64::max);
    let outlines = (0..scene.tool_count()).map(|tool| {
        let mesh = scene.tool_outline(tool, size_m);
        Outline {
            id: scene.tool_id(tool).to_owned(),
            shape: scene.shape_name(tool),
            points: (mesh.points.iter())
                .map(|p| [p.x as f32, p.y as f32, p.z as f32])
                .collect(),
            triangles: mesh.triangles,
        }
    });
    serde_json::to_string(&outlines.collect::<Vec<_>>()).unwrap_or_default()
}
