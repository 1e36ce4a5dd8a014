//! A disk that stalls, is full, fails, or loses what a killed process had not handed over.

use crate::recording::{Disk, DiskFile, FileSystem};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// As large as that of [`FileSystem`].
const BUFFER: usize = 64 << 10;

/// What is wrong with a disk, and with the process that writes to it.
#[derive(Debug, Default)]
pub(super) struct Health {
    /// Takes half of the next write, and nothing after it.
    pub full: AtomicBool,
    /// The next write fails.
    pub fails: AtomicBool,
    /// The process is gone: what it does now, it does not do.
    pub dead: AtomicBool,
    /// Bytes that the system has.
    pub written: AtomicU64,
}

/// Files in a folder of the real file system, by the health of a simulated disk.
pub(super) struct FaultyDisk {
    pub health: Arc<Health>,
}

struct FaultyFile {
    to: Box<dyn DiskFile>,
    /// What the process holds back, as the real one does.
    buffer: Vec<u8>,
    health: Arc<Health>,
}

impl Disk for FaultyDisk {
    fn create(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        if self.health.full.load(Ordering::Relaxed) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(Box::new(FaultyFile {
            to: FileSystem.create(path)?,
            buffer: Vec::with_capacity(BUFFER),
            health: self.health.clone(),
        }))
    }

    fn now(&self) -> Instant {
        super::now()
    }
}

impl FaultyFile {
    fn hand_over(&mut self, bytes: &[u8]) -> io::Result<()> {
        let health = &self.health;
        if health.dead.load(Ordering::Relaxed) || bytes.is_empty() {
            return Ok(());
        }
        if health.fails.swap(false, Ordering::Relaxed) {
            return Err(io::Error::other("the disk failed"));
        }
        let room = match health.full.load(Ordering::Relaxed) {
            true => bytes.len() / 2,
            false => bytes.len(),
        };
        self.to.write_all(&bytes[..room])?;
        self.to.flush()?;
        health.written.fetch_add(room as u64, Ordering::Relaxed);
        match room < bytes.len() {
            true => Err(io::ErrorKind::StorageFull.into()),
            false => Ok(()),
        }
    }
}

impl Write for FaultyFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.buffer.len() + bytes.len() > BUFFER {
            self.flush()?;
        }
        if bytes.len() >= BUFFER {
            self.hand_over(bytes)?;
        } else {
            self.buffer.extend_from_slice(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let buffer = std::mem::take(&mut self.buffer);
        self.hand_over(&buffer)
    }
}

impl DiskFile for FaultyFile {
    fn sync(&mut self) -> io::Result<()> {
        // To memory: what a power cut would take is not simulated.
        self.flush()
    }
}
