//! Outcomes that are known already, by what they follow from: a file per run, named by the SHA-256 of
//! its effective scene, motion, seed, length and build.
//!
//! Files are written under another name and renamed: whoever shares the folder, or stops in the
//! middle, sees whole ones. One that does not read is as one that is not there.

use super::outcome::Outcome;
use serde::{Deserialize, Serialize};
use sha2::Digest as _;
use std::path::{Path, PathBuf};

/// Meaning of the files.
const FORMAT: u32 = 1;

/// A folder of outcomes.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

#[derive(Serialize, Deserialize)]
struct Entry {
    format: u32,
    key: String,
    /// Of `outcome` as JSON: a damaged file is not a result.
    sha256: String,
    outcome: Outcome,
}

impl Cache {
    /// In a folder, which is made when it is needed.
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    /// The user's: `$XDG_CACHE_HOME/palpate/batch`, or `~/.cache/palpate/batch`.
    pub fn of_user() -> Option<Self> {
        let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let caches = set("XDG_CACHE_HOME")
            .map(PathBuf::from)
            .or_else(|| set("HOME").map(|home| Path::new(&home).join(".cache")))?;
        Some(Self::at(caches.join("palpate/batch")))
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(&key[..2]).join(format!("{key}.json"))
    }

    /// What is known of a key.
    pub(super) fn get(&self, key: &str) -> Option<Outcome> {
        let text = std::fs::read_to_string(self.path(key)).ok()?;
        let entry: Entry = serde_json::from_str(&text).ok()?;
        let whole =
            entry.format == FORMAT && entry.key == key && entry.sha256 == sum(&entry.outcome);
        whole.then_some(entry.outcome)
    }

    /// Keeps an outcome.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub(super) fn put(&self, key: &str, outcome: &Outcome) -> std::io::Result<()> {
        let entry = Entry {
            format: FORMAT,
            key: key.to_owned(),
            sha256: sum(outcome),
            outcome: outcome.clone(),
        };
        let path = self.path(key);
        std::fs::create_dir_all(path.parent().unwrap_or(&self.folder))?;
        // Two who find the same at the same time write the same: either may win.
        let thread = format!("{:?}", std::thread::current().id());
        let digits: String = thread.chars().filter(char::is_ascii_digit).collect();
        let part = path.with_extension(format!("{}-{digits}.part", std::process::id()));
        std::fs::write(&part, serde_json::to_vec(&entry)?)?;
        std::fs::rename(&part, &path)
    }
}

fn sum(outcome: &Outcome) -> String {
    let text = serde_json::to_vec(outcome).unwrap_or_default();
    let sum = sha2::Sha256::digest(&text);
    sum.iter().map(|byte| format!("{byte:02x}")).collect()
}
