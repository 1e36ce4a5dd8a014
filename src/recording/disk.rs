//! Where files go. Recordings only append: what was written stays as it is, whatever happens next.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A file that only grows.
pub trait DiskFile: Write + Send {
    /// Waits until all that was written would survive a power cut.
    ///
    /// # Errors
    /// The disk refused.
    fn sync(&mut self) -> io::Result<()>;
}

/// A place for files. Tests put one here that stalls or is full.
pub trait Disk: Send + Sync {
    /// A new file; directories above it are made. Nothing that exists is ever overwritten.
    ///
    /// # Errors
    /// The file exists, or cannot be made.
    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileSystem;

impl Disk for FileSystem {
    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        if let Some(directory) = path
            .parent()
            .filter(|directory| !directory.as_os_str().is_empty())
        {
            std::fs::create_dir_all(directory)?;
        }
        let file = OpenOptions::new().write(true).create_new(true).open(path)?;
        Ok(Box::new(BufWriter::with_capacity(64 << 10, file)))
    }
}

impl DiskFile for BufWriter<File> {
    fn sync(&mut self) -> io::Result<()> {
        self.flush()?;
        self.get_ref().sync_all()
    }
}
