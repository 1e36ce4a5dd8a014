//! Why a scenario cannot be run.

/// Why a scenario cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// No such scenario.
    #[error(
        "{name:?} is neither a scenario of this program nor a folder with a scenario.toml; there are {known}"
    )]
    Unknown {
        /// As given.
        name: String,
        /// What there is.
        known: String,
    },
    /// A file that cannot be read or written, or that is not what it should be.
    #[error("{path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// Why it failed.
        reason: String,
    },
    /// Something in `scenario.toml` that names nothing, or that cannot be done.
    #[error("run {run:?}: {reason}")]
    Run {
        /// Name of the run.
        run: String,
        /// What is wrong.
        reason: String,
    },
    /// A scene that does not build.
    #[error("run {run:?}: {source}")]
    Scene {
        /// Name of the run.
        run: String,
        /// Its problems.
        source: palpate_sim::scene::SceneError,
    },
    /// A recording that could not be made.
    #[error(transparent)]
    Record(#[from] palpate_record::WriteError),
}

impl ScenarioError {
    pub(super) fn run(run: &str, reason: impl std::fmt::Display) -> Self {
        Self::Run {
            run: run.to_owned(),
            reason: reason.to_string(),
        }
    }
}
