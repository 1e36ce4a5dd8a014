//! The scene of a session.

use super::super::reader::Session;
use super::error::ReplayError;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::SceneSpec;
use std::path::Path;

/// Builds the scene that a session holds.
///
/// # Errors
/// A scene that this program cannot read or build.
pub fn recorded_scene(session: &Session) -> Result<Scene, ReplayError> {
    let spec: SceneSpec = toml::from_str(&session.header.effective_scene)
        .map_err(|e| ReplayError::SceneText(e.to_string()))?;
    Ok(Scene::build(&spec, Path::new("."))?)
}
