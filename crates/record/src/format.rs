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
    /// A name that terminals, logs and pages would not show as it is.
    #[error(
        "{:?} is not a valid file name: it has a character that is not seen ({}); leave it out",
        .name, .character.escape_unicode()
    )]
    Name {
        /// The name.
        name: String,
        /// The first such character.
        character: char,
    },
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// The file being written.
        path: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The disk failed to keep what the system had taken. What is in the file can be read for as
    /// long as the machine runs, or not at all.
    #[error(
        "{path}: the disk failed to keep what was written ({source}); what was written after tick {after_tick} may be gone, now or when the machine restarts"
    )]
    Sync {
        /// The file being written.
        path: PathBuf,
        /// Last tick that the disk has for certain.
        after_tick: u64,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The disk does not answer. Nothing is lost unless the power goes.
    #[error(
        "{path}: everything is written, but the disk did not confirm it within {waited_s} s; if the file still has this name once it has, `palpate recover` completes it"
    )]
    Unconfirmed {
        /// The file.
        path: PathBuf,
        /// Time waited, s.
        waited_s: u64,
    },
    /// A part may be longer than all of them together.
    #[error(
        "--split-size {part_bytes} bytes is more than --max-total {total_bytes} bytes leaves for all parts; give a smaller --split-size or a larger --max-total"
    )]
    PartAboveTotal {
        /// Most bytes of a part, before compression.
        part_bytes: u64,
        /// Most bytes of all parts.
        total_bytes: u64,
    },
    /// Heads of parts would take it all.
    #[error(
        "--max-total {total_bytes} bytes is too little for this scene: each file begins with {head_bytes} bytes about it; give at least {least_bytes}"
    )]
    SmallTotal {
        /// Most bytes of all parts.
        total_bytes: u64,
        /// Bytes of a file before its first message.
        head_bytes: u64,
        /// The least that is accepted.
        least_bytes: u64,
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
/// Key of the metadata at the start: what is in the file, where that is not everything.
pub(super) const HOLDS: &str = "holds";
/// Value of [`HOLDS`]: what goes into ticks, without what came of them.
pub(super) const HOLDS_INPUTS: &str = "inputs";
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
pub(super) const LIBRARY: &str = concat!("palpate ", env!("CARGO_PKG_VERSION"));

/// [`LIBRARY`], for the writer of the `mcap` crate.
pub(super) fn options() -> mcap::WriteOptions {
    mcap::WriteOptions::library(mcap::WriteOptions::new(), LIBRARY)
}
