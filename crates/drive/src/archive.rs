//! What the bus and the keeper of recordings say to each other, without knowing each other.

use std::path::PathBuf;

/// What a client may ask of the keeper of recordings.
#[derive(Clone, Debug, PartialEq)]
pub enum ArchiveRequest {
    /// Record from the next tick on; without a path, where the daemon keeps recordings.
    Start {
        /// File.
        path: Option<PathBuf>,
    },
    /// End the recording.
    Stop,
    /// Write what is in memory of the last seconds, and the next ones.
    Snapshot {
        /// Seconds before now, s; as much as there is when that is less.
        before_s: f64,
        /// Seconds after now, s.
        after_s: f64,
        /// File.
        path: Option<PathBuf>,
    },
}

/// What the keeper of recordings has to tell.
#[derive(Clone, Debug, PartialEq)]
pub enum ArchiveNews {
    /// A request was carried out.
    Done {
        /// Number of the request.
        id: u64,
        /// First tick of a recording, last of one that ended, last of a snapshot.
        tick: u64,
        /// File.
        path: PathBuf,
    },
    /// A request was refused.
    Refused {
        /// Number of the request.
        id: u64,
        /// Why.
        reason: String,
    },
    /// A file was begun.
    Started {
        /// File.
        path: PathBuf,
    },
    /// A file was finished.
    Stopped {
        /// File.
        path: PathBuf,
    },
    /// The disk refused; the loop goes on, what was flushed stays readable.
    Failed {
        /// File.
        path: PathBuf,
        /// Words of the system.
        reason: String,
    },
}

/// The keeper of recordings, as the bus thread sees it. Nothing here waits for a disk.
pub trait Archive: Send {
    /// Something happened that belongs into the recording: a name like `tool_joined`, and words
    /// about it.
    fn event(&mut self, tick: u64, kind: &str, detail: &str);
    /// Asks for something; the answer comes with [`Archive::news`] under the same number.
    fn ask(&mut self, id: u64, request: ArchiveRequest);
    /// The next piece of news, if there is one.
    fn news(&mut self) -> Option<ArchiveNews>;
}
