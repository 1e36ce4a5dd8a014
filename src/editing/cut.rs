//! The pieces that a plane makes of a body that deforms, in its place.

use super::Edited;
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::Point3;
use palpate_sim::scene::spec::{BodySpec, ModelSpec};
use palpate_sim::scene::{BodyPiece, Scene, SceneChange, SceneCut};
use serde_json::{Value, json};
use std::fmt::Write as _;
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
        "pieces": cut.pieces.iter().map(|piece| words(&cut.change, piece)).collect::<Vec<_>>(),
        "lost": cut.lost_m3,
        "plane": { "point": xyz(&plane.origin()), "normal": <[f64; 3]>::from(plane.normal) },
    });
    Ok(Edited {
        what: what(scene, body, &cut),
        change: Some(cut.change),
        report,
    })
}

/// What was done, and of which pieces something is else than of the body.
fn what(scene: &Scene, body: usize, cut: &SceneCut) -> String {
    let (id, whole) = (scene.body_id(body), &scene.spec.bodies[body]);
    let mut what = format!("cut {id} into {} pieces", cut.pieces.len());
    let before = (whole.model(), whole.layers());
    for piece in &cut.pieces {
        let spec = cut.change.body(&piece.id);
        if let Some(now) = spec.map(|spec| (spec.model(), spec.layers()))
            && now != before
        {
            let (model, layers) = (now.0.name(), now.1);
            let _ = match now.0 {
                ModelSpec::Rigid => {
                    write!(what, "; {} is rigid, since it is held everywhere", piece.id)
                }
                _ => write!(what, "; {} is a {model} of {layers} layers", piece.id),
            };
        }
    }
    what
}

/// A piece for the client: of the cut as the body stood, but its net, model and layers.
fn words(change: &SceneChange, BodyPiece { id, piece, skin }: &BodyPiece) -> Value {
    let net = skin.surface.net();
    let spec = change.body(id);
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
        "layers": spec.filter(|spec| spec.model() != ModelSpec::Rigid).map(BodySpec::layers),
    })
}

fn xyz(point: &Point3) -> [f64; 3] {
    point.coords.into()
}
