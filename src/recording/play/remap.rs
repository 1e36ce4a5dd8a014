//! The scene of a recording, under other names.

use super::PlayError;
use crate::recording::reader::Session;
use crate::scene::Scene;
use crate::scene::spec::{Clock, SceneSpec};
use palpate_proto::keys::check_id;
use std::path::Path;

/// The scene of a recording, with other ids for its tools and bodies where `remap` (old, new) says
/// so.
///
/// # Errors
/// A scene that does not build, or an id that is not there, not allowed, or taken.
pub fn played_scene(session: &Session, remap: &[(String, String)]) -> Result<Scene, PlayError> {
    let spec: SceneSpec = toml::from_str(&session.header.effective_scene)
        .map_err(|e| PlayError::SceneText(e.to_string()))?;
    let mut scene = Scene::build(&spec, Path::new("."))?;
    // Ticks come by the player's clock: nobody's poses are waited for.
    scene.clock = Clock::Realtime;
    let tools_before: Vec<String> = scene.tools.iter().map(|tool| tool.id.clone()).collect();
    let bodies_before: Vec<String> = scene.bodies.iter().map(|body| body.id.clone()).collect();
    for (old, new) in remap {
        let refuse = |reason: String| PlayError::Remap {
            old: old.clone(),
            new: new.clone(),
            reason,
        };
        check_id(new).map_err(|e| refuse(e.to_string()))?;
        let mut found = false;
        for (tool, _) in scene
            .tools
            .iter_mut()
            .zip(&tools_before)
            .filter(|(_, id)| *id == old)
        {
            tool.id.clone_from(new);
            found = true;
        }
        for (body, _) in scene
            .bodies
            .iter_mut()
            .zip(&bodies_before)
            .filter(|(_, id)| *id == old)
        {
            body.id.clone_from(new);
            found = true;
        }
        if !found {
            let known = [&tools_before[..], &bodies_before].concat().join(", ");
            return Err(refuse(format!(
                "the recording has no {old:?}; it has {known}"
            )));
        }
    }
    let tools: Vec<&String> = scene.tools.iter().map(|tool| &tool.id).collect();
    let bodies: Vec<&String> = scene.bodies.iter().map(|body| &body.id).collect();
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
    Ok(scene)
}
