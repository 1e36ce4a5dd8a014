//! Why a batch cannot be run at all. What goes wrong in one run is in its row.

use std::path::Path;

/// See the module.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// A file that cannot be read or written.
    #[error("{path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// Why it failed.
        reason: String,
    },
    /// Something in the sweep that cannot be.
    #[error("{sweep}: {key}: {reason}")]
    Key {
        /// Name of the sweep's file.
        sweep: String,
        /// Where in it.
        key: String,
        /// What is wrong, and what would do.
        reason: String,
    },
    /// The scene, with the values of the first run.
    #[error("{sweep}: the scene with the values of run 0: {source}")]
    Scene {
        /// Name of the sweep's file.
        sweep: String,
        /// Its problems.
        source: palpate_sim::scene::SceneError,
    },
    /// The name of a file of results.
    #[error("{path}: results are .csv, .json or .parquet")]
    Format {
        /// As given.
        path: String,
    },
}

impl BatchError {
    pub(super) fn file(path: &Path, error: impl std::fmt::Display) -> Self {
        Self::File {
            path: path.display().to_string(),
            reason: error.to_string(),
        }
    }
}
