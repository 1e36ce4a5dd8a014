//! The scene of a recording, under other names.

use super::PlayError;
use crate::reader::{Session, recorded_spec};
use palpate_proto::keys::check_id;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use std::path::Path;

/// The scene of a recording, with other ids for its tools and bodies where `remap` (old, new) says
/// so.
///
/// # Errors
/// A scene that does not build, or an id that is not there, not allowed, or taken.
pub fn played_scene(session: &Session, remap: &[(String, String)]) -> Result<Scene, PlayError> {
    let mut spec = recorded_spec(&session.header.effective_scene).map_err(PlayError::SceneText)?;
    // The player's clock makes ticks due: no pose is waited for.
    spec.loop_.clock = Clock::Realtime;
    let tools = spec.tools.iter().map(|tool| tool.id.clone());
    let known: Vec<String> = tools
        .chain(spec.bodies.iter().map(|body| body.id.clone()))
        .collect();
    for (old, new) in remap {
        let refuse = |reason: String| PlayError::Remap {
            old: old.clone(),
            new: new.clone(),
            reason,
        };
        check_id(new).map_err(|e| refuse(e.to_string()))?;
        if !known.contains(old) {
            let known = known.join(", ");
            return Err(refuse(format!(
                "the recording has no {old:?}; it has {known}"
            )));
        }
    }
    spec.rename(remap);
    let tools: Vec<&String> = spec.tools.iter().map(|tool| &tool.id).collect();
    let bodies: Vec<&String> = spec.bodies.iter().map(|body| &body.id).collect();
    for ids in [tools, bodies] {
        let twice = (1..ids.len()).find(|&k| ids[..k].contains(&ids[k]));
        if let Some(k) = twice {
            let (old, new) = (remap.iter().find(|(_, new)| new == ids[k]))
                .cloned()
                .unwrap_or_default();
            return Err(PlayError::Remap {
                old,
                new,
                reason: "that id is taken".into(),
            });
        }
    }
    Ok(Scene::build_with(
        &spec,
        Path::new("."),
        palpate_thesis::METHODS,
    )?)
}
