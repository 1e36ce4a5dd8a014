//! One body in the place of several.

use super::Edited;
use palpate_geometry::surface::Surface;
use palpate_modeling::merge::{self, Arrangement, HideBy, MergeMethod, MergeSpec, Reading};
use palpate_sim::scene::{Scene, SceneChange};
use serde_json::json;

/// As a client asked.
pub(super) struct MergeRequest<'a> {
    pub id: Option<&'a str>,
    pub continuity: Option<u32>,
    pub method: Option<&'a str>,
    pub hidden: Option<&'a str>,
    pub tolerance_m: Option<f64>,
}

/// Two bodies at their closest edges; four as `[a b; c d]`; others in a row.
pub(super) fn merge(
    scene: &Scene,
    bodies: &[usize],
    surfaces: &[Surface],
    asked: &MergeRequest<'_>,
) -> Result<Edited, String> {
    let usual = MergeSpec::default();
    let method = match asked.method {
        None => usual.method,
        Some("seed") => MergeMethod::Seed,
        Some("constrained") => MergeMethod::Constrained,
        Some("exact") => MergeMethod::Exact,
        Some(name) => {
            return Err(format!(
                "{name:?} is not a merge method; use seed, constrained or exact"
            ));
        }
    };
    let hide_by = (asked.hidden)
        .map(|name| {
            HideBy::of(name)
                .ok_or_else(|| format!("{name:?} is not a way to hide points; use rows or lines"))
        })
        .transpose()?;
    let arrangement = match surfaces.len() {
        2 => Arrangement::Closest,
        4 => Arrangement::Grid {
            rows: 2,
            columns: 2,
        },
        columns => Arrangement::Grid { rows: 1, columns },
    };
    let continuity = asked.continuity.map_or(usual.continuity, |c| c as usize);
    let spec = MergeSpec {
        continuity,
        method,
        arrangement,
        hide_by,
        tolerance_m: asked.tolerance_m,
        ..usual
    };
    let merged = merge::merge(surfaces, &spec).map_err(|e| e.to_string())?;
    let names: Vec<&str> = bodies.iter().map(|&body| scene.body_id(body)).collect();
    let id = asked.id.map_or_else(|| joined(&names), ToOwned::to_owned);
    palpate_proto::keys::check_id(&id).map_err(|e| e.to_string())?;
    let change =
        SceneChange::merged(scene, bodies, &id, &merged.surface).map_err(|e| e.to_string())?;
    let found = merged.report(surfaces);
    let seams: Vec<serde_json::Value> = found
        .seams
        .iter()
        .map(|(_, continuity)| json!(continuity))
        .collect();
    let readings: Vec<serde_json::Value> = merged.readings.iter().map(Reading::words).collect();
    let hidden = merged.hide_by.map(HideBy::name);
    let net = merged.surface.net();
    let report = json!({
        "id": id, "net": [net.rows(), net.columns()], "deviation": found.deviation, "seams": seams, "before": found.before,
        "hidden": hidden, "readings": readings,
    });
    let what = format!("merged {} into {id} with C{continuity}", names.join(", "));
    Ok(Edited {
        change: Some(change),
        what,
        report,
    })
}

/// An id for what several bodies become.
fn joined(names: &[&str]) -> String {
    let mut id = names.join("-");
    // Ids are ASCII.
    id.truncate(64);
    id
}
