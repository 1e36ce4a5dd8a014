//! Overlapping bodies moved apart.

use super::Edited;
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;
use palpate_modeling::isolate::{IsolateMethod, IsolateSpec, isolate_all};
use palpate_sim::scene::{Scene, SceneChange};
use serde_json::json;

/// As a client asked.
pub(super) struct IsolateRequest<'a> {
    pub method: Option<&'a str>,
    pub gap_m: Option<f64>,
    pub max_turn_deg: Option<f64>,
}

/// Each body moves away from those named after it; the last stays.
pub(super) fn isolate(
    scene: &Scene,
    bodies: &[usize],
    surfaces: &[Surface],
    asked: &IsolateRequest<'_>,
) -> Result<Edited, String> {
    let usual = IsolateSpec::default();
    let method = match asked.method {
        None => usual.method,
        Some(name) => IsolateMethod::of(name).ok_or_else(|| {
            let known = IsolateMethod::ALL.map(IsolateMethod::name).join(", ");
            format!("{name:?} is not an isolation method; use one of {known}")
        })?,
    };
    let spec = IsolateSpec {
        method,
        gap_m: asked.gap_m,
        max_turn_deg: asked.max_turn_deg,
        ..usual
    };
    let id = |k: usize| scene.body_id(bodies[k]);
    let last = bodies.len() - 1;
    let turned: Vec<Surface> = surfaces.iter().rev().cloned().collect();
    let all = isolate_all(&turned, &spec)
        .map_err(|e| format!("{e} (surface k is the k-th from the end of those named)"))?;
    if let Some(reason) = all.unsettled {
        return Err(format!(
            "{reason} (body k is the k-th from the end of those named, from 0)"
        ));
    }
    let moves: Vec<(usize, Vector3)> = (0..bodies.len())
        .map(|k| (k, all.translations_m[last - k]))
        .filter(|(_, by)| *by != Vector3::zeros())
        .collect();
    let xyz = |by: &Vector3| [by.x, by.y, by.z];
    let pairs: Vec<serde_json::Value> = all
        .moves
        .iter()
        .map(|step| {
            let answer = &step.answer;
            json!({
                "moving": id(last - step.moving), "fixed": id(last - step.fixed), "pass": step.pass,
                "translation": xyz(&answer.translation_m), "gap": answer.gap_m, "turn": answer.turn_deg,
                "method": answer.method.name(), "fell_back": answer.fell_back.map(|reason| reason.to_string()),
                "iterations": answer.steps, "regions": answer.regions, "overlap_tests": answer.overlap_tests,
            })
        })
        .collect();
    let translations: serde_json::Map<String, serde_json::Value> = (0..bodies.len())
        .map(|k| (id(k).to_owned(), json!(xyz(&all.translations_m[last - k]))))
        .collect();
    let report = json!({
        "translation": xyz(&all.translations_m[last]), "translations": translations, "passes": all.passes, "moves": pairs,
    });
    if moves.is_empty() {
        return Ok(Edited {
            change: None,
            what: String::new(),
            report,
        });
    }
    let words = moves
        .iter()
        .map(|(k, by)| format!("{} by {:?} m", id(*k), xyz(by)));
    let what = format!("moved apart: {}", words.collect::<Vec<_>>().join(", "));
    let moved: Vec<(usize, Vector3)> = moves.iter().map(|&(k, by)| (bodies[k], by)).collect();
    let change = SceneChange::moved(scene, &moved).map_err(|e| e.to_string())?;
    Ok(Edited {
        change: Some(change),
        what,
        report,
    })
}
