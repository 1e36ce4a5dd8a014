//! What all our files have in common: names of their records, who wrote them, and why writing one
//! can fail.

use std::path::PathBuf;

/// Why a recording could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A file is in the way; nothing is overwritten.
    #[error("{path} exists already; {advice}")]
    Exists {
        /// The file that is in the way.
        path: PathBuf,
        /// How to get around it.
        advice: &'static str,
    },
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// The file being written.
        path: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The MCAP writer.
    #[error("{path}: {source}")]
    Mcap {
        /// The file being written.
        path: PathBuf,
        /// The error of the MCAP library.
        source: mcap::McapError,
    },
    /// There was nothing to write.
    #[error("nothing was recorded")]
    Nothing,
    /// The scene has no text form, so nothing could be replayed.
    #[error("the scene cannot be written out: {0}")]
    Scene(String),
}

/// Metadata record at the start.
pub(super) const RUN: &str = "palpate.run";
/// Metadata record at the end.
pub(super) const END: &str = "palpate.end";
/// Attachment: the scene file as written.
/// The scene before the first tick, `SceneSnapshot`: for pages.
pub(super) const SNAPSHOT: &str = "scene.snapshot";
/// Shapes of tools, for pages.
pub(super) const TOOLS: &str = "tools.json";
pub(super) const SCENE_TEXT: &str = "scene.toml";
/// Attachment: the scene as built.
pub(super) const SCENE_EFFECTIVE: &str = "scene.effective.toml";
/// Attachment at the end: [`super::Totals`] as JSON.
pub(super) const TOTALS: &str = "totals.json";

/// What all our files say of who wrote them.
pub(super) fn options() -> mcap::WriteOptions {
    mcap::WriteOptions::library(
        mcap::WriteOptions::new(),
        format!("palpate {}", env!("CARGO_PKG_VERSION")),
    )
}
