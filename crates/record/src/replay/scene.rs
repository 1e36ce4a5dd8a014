//! The scene of a session.

use super::super::reader::{Session, recorded_spec};
use super::error::ReplayError;
use palpate_sim::scene::Scene;
use std::path::Path;

/// Builds the scene that a session holds.
///
/// # Errors
/// A scene that this program cannot read or build.
pub fn recorded_scene(session: &Session) -> Result<Scene, ReplayError> {
    let spec = recorded_spec(&session.header.effective_scene).map_err(ReplayError::SceneText)?;
    Ok(Scene::build_with(
        &spec,
        Path::new("."),
        palpate_thesis::METHODS,
    )?)
}
