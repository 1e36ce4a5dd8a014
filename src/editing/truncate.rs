//! Two overlapping rigid bodies become parts with a common wall.

use super::Edited;
use palpate_geometry::exchange::step::write_part;
use palpate_geometry::surface::Surface;
use palpate_geometry::surface::file::Unit;
use palpate_modeling::truncate::{TruncateSpec, truncate as modelled};
use palpate_sim::scene::{Scene, SceneChange};
use serde_json::json;

/// The wall is as deep in one body as in the other.
pub(super) fn truncate(
    scene: &Scene,
    bodies: &[usize],
    surfaces: &[Surface],
    tolerance_m: Option<f64>,
) -> Result<Edited, String> {
    let (&[a, b], [of_a, of_b]) = (bodies, surfaces) else {
        return Err("truncate takes two bodies: {\"bodies\": [\"a\", \"b\"]}".into());
    };
    // Before the work is done.
    for body in [a, b] {
        SceneChange::check_part(scene, body).map_err(|e| e.to_string())?;
    }
    let names = [a, b].map(|body| scene.body_id(body));
    let spec = TruncateSpec { tolerance_m };
    let named = |e| format!("{e}; body 0 is {:?}, body 1 {:?}", names[0], names[1]);
    let Some(two) = modelled(of_a, of_b, &spec).map_err(named)? else {
        return Ok(Edited {
            change: None,
            what: String::new(),
            report: json!({ "overlap": 0.0 }),
        });
    };
    let text = |k: usize| {
        let text = write_part(&two.breps[k], &Unit::Metre.into(), names[k]);
        text.map_err(|e| e.to_string())
    };
    let change = SceneChange::truncated(scene, [(a, text(0)?), (b, text(1)?)]);
    let walls = two.walls.iter().map(|wall| {
        json!({ "edges": wall.rims, "net": wall.net, "uneven": wall.uneven_m, "off": wall.off_m })
    });
    let report = json!({
        "volumes": two.volumes_m3, "overlap": two.before_m3[2], "walls": walls.collect::<Vec<_>>(),
        "tolerance": two.tolerance_m, "within_tolerance": two.within_tolerance(),
    });
    Ok(Edited {
        change: Some(change.map_err(|e| e.to_string())?),
        what: format!("truncated {} and {}", names[0], names[1]),
        report,
    })
}
