//! Why a recording cannot be read, or be read on.

use super::super::FORMAT_VERSION;
use palpate_wire::ConvertError;
use std::path::PathBuf;

/// Why a file could not be read as a session.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// File.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// Not an MCAP file.
    #[error("{path}: not an MCAP file ({reason})")]
    NotMcap {
        /// File.
        path: PathBuf,
        /// What the reader met.
        reason: String,
    },
    /// An MCAP file of something else.
    #[error("{path}: an MCAP file, but not a Palpate recording: {missing} is missing")]
    Foreign {
        /// File.
        path: PathBuf,
        /// What.
        missing: &'static str,
    },
    /// A later layout.
    #[error(
        "{path}: recording format {found}, this program reads {FORMAT_VERSION}; use the program that made it"
    )]
    Format {
        /// File.
        path: PathBuf,
        /// Its version.
        found: String,
    },
    /// Outputs are wanted, and there are none.
    #[error(
        "{0}: it holds the inputs of a session, not what came of them; `palpate replay {0} --record OUT.mcap` runs them and makes a \
         whole recording"
    )]
    InputsOnly(PathBuf),
    /// Chunks that this program cannot unpack.
    #[error(
        "{path}: its chunks are compressed with {found:?}, and this program reads zstd and none; write it anew with \
         `mcap compress --compression zstd {path} -o OUT.mcap`"
    )]
    Compression {
        /// File.
        path: PathBuf,
        /// As the file names it.
        found: String,
    },
    /// A message that does not hold what its type promises.
    #[error("{path}: {source}")]
    Message {
        /// File.
        path: PathBuf,
        /// Cause.
        source: ConvertError,
    },
}
