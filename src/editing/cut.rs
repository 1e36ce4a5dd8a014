//! The pieces that a plane makes of a body that deforms, in its place.

use super::Edited;
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::Point3;
use palpate_sim::scene::spec::BodySpec;
use palpate_sim::scene::{BodyPiece, Scene, SceneChange, SceneCut};
use serde_json::{Value, json};
use std::time::Instant;

/// Cuts a body as it stands: its control points and the coordinates of its nodes, of the same tick. With a kerf, what is
/// between two planes is lost.
pub(super) fn cut(
    scene: &Scene,
    body: usize,
    standing: (&[Point3], &[Point3]),
    plane: &CutPlane,
    kerf_m: f64,
) -> Result<Edited, String> {
    let begun = Instant::now();
    let cut = SceneCut::new(scene, body, standing, plane, kerf_m).map_err(|e| e.to_string())?;
    tracing::debug!(took_s = begun.elapsed().as_secs_f64(), "cut");
    let report = json!({
        "pieces": cut.pieces.iter().map(|piece| told(&cut.change, piece)).collect::<Vec<_>>(),
        "lost": cut.lost_m3,
        "plane": { "point": xyz(&plane.origin()), "normal": <[f64; 3]>::from(plane.normal) },
    });
    Ok(Edited {
        what: format!(
            "cut {} into {} pieces",
            scene.body_id(body),
            cut.pieces.len()
        ),
        change: Some(cut.change),
        report,
    })
}

/// A piece for the client: of the cut as the body stood, but its net, model and layers.
fn told(change: &SceneChange, BodyPiece { id, piece, skin }: &BodyPiece) -> Value {
    let net = skin.surface.net();
    let spec = change.spec.bodies.iter().find(|body| &body.id == id);
    json!({
        "id": id,
        "above": piece.above,
        "volume": piece.volume_m3,
        "cap_area": piece.cap_area_m2,
        "centroid": xyz(&piece.centroid),
        "off": skin.off_m,
        "creases": skin.creases,
        "rims": skin.rims,
        "net": [net.rows(), net.columns()],
        "model": spec.map(BodySpec::model),
        "layers": spec.map(BodySpec::layers),
    })
}

fn xyz(point: &Point3) -> [f64; 3] {
    point.coords.into()
}
