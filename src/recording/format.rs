//! What all our files have in common: names of their records, who wrote them, and why writing one
//! can fail.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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

impl WriteError {
    /// An error of the MCAP library, or of the file system below it: a full disk is called that.
    pub(super) fn mcap(path: &Path, source: mcap::McapError) -> Self {
        let path = path.to_owned();
        match source {
            mcap::McapError::Io(source) => Self::Io { path, source },
            source => Self::Mcap { path, source },
        }
    }
}

/// Metadata record at the start.
pub(super) const RUN: &str = "palpate.run";
/// Metadata record at the end.
pub(super) const END: &str = "palpate.end";
/// Key of both metadata records: [`checksum`] of their other entries. MCAP has none for them.
pub(super) const CHECK: &str = "check";
/// The scene before the first tick, `SceneSnapshot`: for pages.
pub(super) const SNAPSHOT: &str = "scene.snapshot";
/// Shapes of tools, for pages.
pub(super) const TOOLS: &str = "tools.json";
/// Attachment: the scene file as written.
pub(super) const SCENE_TEXT: &str = "scene.toml";
/// Attachment: the scene as built.
pub(super) const SCENE_EFFECTIVE: &str = "scene.effective.toml";
/// Attachment at the end: [`super::Totals`] as JSON.
pub(super) const TOTALS: &str = "totals.json";

/// Key beside [`CHECK`] that says that it must be there.
const CHECKED: &str = "checked";

/// CRC-32 of the entries of a metadata record but [`CHECK`], in the order of their keys, each ended
/// by a byte that no text has.
pub(super) fn checksum(entries: &BTreeMap<String, String>) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in entries.iter().filter(|(key, _)| *key != CHECK) {
        for text in [key, value] {
            hasher.update(text.as_bytes());
            hasher.update(&[0xff]);
        }
    }
    format!("{:08x}", hasher.finalize())
}

/// The metadata with its checksum.
pub(super) fn checked(mut entries: BTreeMap<String, String>) -> BTreeMap<String, String> {
    entries.insert(CHECKED.into(), "crc32".into());
    entries.insert(CHECK.into(), checksum(&entries));
    entries
}

/// The metadata is as it was written; that of recordings without a checksum is taken as it is.
pub(super) fn is_as_written(entries: &BTreeMap<String, String>) -> bool {
    match entries.get(CHECK) {
        Some(check) => *check == checksum(entries),
        None => !entries.contains_key(CHECKED),
    }
}

/// What all our files say of who wrote them.
pub(super) fn options() -> mcap::WriteOptions {
    mcap::WriteOptions::library(
        mcap::WriteOptions::new(),
        format!("palpate {}", env!("CARGO_PKG_VERSION")),
    )
}
