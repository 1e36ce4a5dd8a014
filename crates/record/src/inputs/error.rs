//! Why the inputs of a session cannot be run, taken out of it, or recorded again.

use super::super::format::WriteError;
use super::super::reader::ReadError;
use super::super::replay::ReplayError;
use std::path::PathBuf;

/// Why the inputs of a session cannot be run from its start to its end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The session.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// Some ticks are not there.
    #[error("tick {tick} is missing, and a run needs every tick from the start of the recording")]
    Gap {
        /// First one.
        tick: u64,
    },
    /// Nothing to begin with.
    #[error(
        "the keyframe at tick {tick} does not fit this version ({reason}), and only a recording from tick 0 on can begin with the \
         scene's own start"
    )]
    Start {
        /// Of the first keyframe.
        tick: u64,
        /// Why it does not fit.
        reason: String,
    },
}

impl From<ReadError> for RunError {
    fn from(error: ReadError) -> Self {
        Self::Replay(error.into())
    }
}

/// Why a session could not be reduced to its inputs, or recorded again from them.
#[derive(Debug, thiserror::Error)]
pub enum InputsError {
    /// The inputs cannot be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The new file.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Its figures.
    #[error(transparent)]
    Figures(#[from] super::super::figures::FiguresError),
    /// What would be left out could not be made again.
    #[error(
        "{path}: its inputs give other outputs with this build than it holds, first in ticks {} to {}; it was recorded by {build}: \
         reduce it with that build", .ticks.0, .ticks.1
    )]
    Differs {
        /// The recording.
        path: PathBuf,
        /// First and last of the ticks in which the outputs differ first.
        ticks: (u64, u64),
        /// The build that recorded it.
        build: String,
    },
    /// It has no outputs to leave out.
    #[error("{0}: it holds inputs only already")]
    Reduced(PathBuf),
    /// Something is missing.
    #[error(
        "{path}: the recording is incomplete ({reason}): only a whole one can be reduced to its inputs"
    )]
    Incomplete {
        /// The recording.
        path: PathBuf,
        /// What is missing.
        reason: String,
    },
}
