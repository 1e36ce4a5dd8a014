//! The files that a sweep and its scenes name: each is read once and kept, so that all runs see the same, and so that
//! they can go to a machine that has none of them.

use palpate_sim::scene::Files;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// By path: the bytes of a file, or why they are not to be had, in words.
pub type FileBytes = BTreeMap<PathBuf, Result<Vec<u8>, String>>;

/// What was read so far.
#[derive(Debug)]
pub(super) struct Kept {
    known: Mutex<FileBytes>,
    /// Others are read from the disk.
    disk: bool,
}

impl Kept {
    /// Files of the disk.
    pub fn of_disk() -> Self {
        Self {
            known: Mutex::default(),
            disk: true,
        }
    }

    /// These, and no others.
    pub fn of(known: FileBytes) -> Self {
        Self {
            known: Mutex::new(known),
            disk: false,
        }
    }

    /// All that were read.
    pub fn all(&self) -> FileBytes {
        self.known().clone()
    }

    /// A file that is text.
    pub fn text(&self, path: &Path) -> Result<String, String> {
        let bytes = self.bytes(path, |path| {
            std::fs::read(path).map_err(|error| error.to_string())
        })?;
        String::from_utf8(bytes).map_err(|error| error.to_string())
    }

    fn known(&self) -> MutexGuard<'_, FileBytes> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn bytes(
        &self,
        path: &Path,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<Vec<u8>, String> {
        let mut known = self.known();
        if let Some(bytes) = known.get(path) {
            return bytes.clone();
        }
        let bytes = match self.disk {
            true => read(path),
            false => Err("it did not come with the sweep".to_owned()),
        };
        known.insert(path.to_owned(), bytes.clone());
        bytes
    }
}

/// Files of a folder, where the paths of a scene start.
pub(super) struct Folder<'k> {
    pub kept: &'k Kept,
    pub path: &'k Path,
}

impl Files for Folder<'_> {
    fn read(&self, name: &Path) -> Result<Vec<u8>, String> {
        (self.kept).bytes(&self.path.join(name), |_| self.path.read(name))
    }

    fn named(&self, name: &Path) -> String {
        self.path.named(name)
    }
}
