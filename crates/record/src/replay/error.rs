//! Why a session cannot be replayed.

use super::super::reader::ReadError;
use palpate_sim::scene::SceneError;

/// Why a session cannot be replayed at all.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The scene in the file is not one that this program can parse.
    #[error("the recorded scene does not parse: {0}")]
    SceneText(String),
    /// The scene in the file cannot be built.
    #[error("the recorded scene does not build: {0}")]
    Scene(#[from] SceneError),
    /// No state to start from.
    #[error("no keyframe at or before tick {from}, and one is needed to start from{}", first_known(*.first))]
    NoKeyframe {
        /// Wanted start.
        from: u64,
        /// Tick of the first keyframe that there is.
        first: Option<u64>,
    },
    /// The state is of another scene.
    #[error("keyframe at tick {tick}: {source}")]
    State {
        /// Tick of the keyframe.
        tick: u64,
        /// Why its state does not fit the scene.
        source: palpate_geometry::math::StateError,
    },
    /// A range without ticks.
    #[error("no tick from {from} to {until}; the recording has ticks {first} to {last}")]
    NoTicks {
        /// Wanted start.
        from: u64,
        /// Wanted end.
        until: u64,
        /// First tick of the recording.
        first: u64,
        /// Last tick of the recording.
        last: u64,
    },
}

fn first_known(first: Option<u64>) -> String {
    first.map_or_else(
        || "; there is none at all".into(),
        |tick| format!("; the first one is at tick {tick}"),
    )
}
