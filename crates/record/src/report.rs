//! What a recorder did.

use super::format::WriteError;
use std::path::PathBuf;

/// A finished file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingSummary {
    /// Path of the file.
    pub path: PathBuf,
    /// Ticks in it.
    pub ticks: u64,
    /// First of them.
    pub first_tick: u64,
    /// Last of them.
    pub last_tick: u64,
    /// Hash of the last state.
    pub final_hash: u64,
    /// Hash of all ticks.
    pub session_hash: u64,
    /// Records lost.
    pub dropped: u64,
    /// Message bytes before compression.
    pub bytes: u64,
    /// It was deleted since, to stay within the disk budget.
    pub deleted: bool,
}

/// What a recorder did.
#[derive(Debug, Default)]
pub struct RecordingReport {
    /// Finished recordings, or parts of them, in order.
    pub files: Vec<RecordingSummary>,
    /// Why the last one ended early, if it did; what was flushed stays readable in the `.part`
    /// file.
    pub failure: Option<WriteError>,
    /// Records lost over all.
    pub dropped: u64,
}

impl RecordingReport {
    /// The last file, if all went well.
    ///
    /// # Errors
    /// The disk refused, or nothing was recorded.
    pub fn last(mut self) -> Result<RecordingSummary, WriteError> {
        match (self.failure, self.files.pop()) {
            (Some(error), _) => Err(error),
            (None, Some(file)) => Ok(file),
            (None, None) => Err(WriteError::Nothing),
        }
    }
}
