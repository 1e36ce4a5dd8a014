//! Where files go. Recordings only append: what was written stays as it is, whatever happens next.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

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

    /// By which flushes are due. A disk that is simulated has a clock that is.
    fn now(&self) -> Instant {
        Instant::now()
    }
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
        Ok(Box::new(SyncedFile {
            buffer: BufWriter::with_capacity(64 << 10, file),
            synced: Instant::now(),
        }))
    }
}

/// A file whose flushes reach the disk once a second: without that the system keeps them for half a
/// minute, and a power cut takes them.
struct SyncedFile {
    buffer: BufWriter<File>,
    synced: Instant,
}

/// Longest time between a flush and the disk.
const SYNC_EVERY: Duration = Duration::from_secs(1);

impl Write for SyncedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.buffer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.buffer.flush()?;
        if self.synced.elapsed() >= SYNC_EVERY {
            self.buffer.get_ref().sync_data()?;
            // After it: a slow disk is not asked all the time.
            self.synced = Instant::now();
        }
        Ok(())
    }
}

impl DiskFile for SyncedFile {
    fn sync(&mut self) -> io::Result<()> {
        self.buffer.flush()?;
        self.buffer.get_ref().sync_all()
    }
}
