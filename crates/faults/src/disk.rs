//! A disk that stalls, is full, fails, or loses what a killed process had not handed over.

use palpate_record::{Disk, DiskFile, DiskSync, DiskTask, create_new, give_name};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What a sync takes while the disk is well, ns.
const SYNC_NS: u64 = 8_000_000;

/// What is wrong with a disk, and with the process that writes to it.
#[derive(Debug, Default)]
pub(super) struct Health {
    /// Takes half of the next write, and nothing after it.
    pub full: AtomicBool,
    /// The next write fails.
    pub fails: AtomicBool,
    /// The next sync fails.
    pub sync_fails: AtomicBool,
    /// No sync ends before this time, ns.
    pub syncs_at_ns: AtomicU64,
}

/// Files in a folder of the real file system, by the health of a simulated disk.
pub(super) struct FaultyDisk {
    pub health: Arc<Health>,
}

struct FaultyFile {
    to: File,
    health: Arc<Health>,
}

/// What waits for the disk takes virtual time. What a power cut would take is not simulated.
struct FaultySync {
    /// With the time that each ends, ns, while the disk is well.
    tasks: VecDeque<(u64, DiskTask)>,
    failed: bool,
    health: Arc<Health>,
}

impl Disk for FaultyDisk {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let health = &self.health;
        if health.full.load(Ordering::Relaxed) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(DiskFile {
            bytes: Box::new(FaultyFile {
                to: create_new(path)?,
                health: health.clone(),
            }),
            sync: Box::new(FaultySync {
                tasks: VecDeque::new(),
                failed: false,
                health: health.clone(),
            }),
        })
    }

    fn now(&self) -> Instant {
        super::now()
    }
}

impl Write for FaultyFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.health.fails.swap(false, Ordering::Relaxed) {
            return Err(io::Error::other("the disk failed"));
        }
        if self.health.full.load(Ordering::Relaxed) {
            self.to.write_all(&bytes[..bytes.len() / 2])?;
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.to.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl DiskSync for FaultySync {
    fn begin(&mut self, task: DiskTask) {
        let before_ns = self.tasks.back().map_or(0, |(ends_ns, _)| *ends_ns);
        let ends_ns = before_ns.max(super::now_ns()) + SYNC_NS;
        self.tasks.push_back((ends_ns, task));
    }

    fn ended(&mut self, within: Duration) -> Option<io::Result<()>> {
        let until_ns = super::now_ns().saturating_add(within.as_nanos() as u64);
        let (ends_ns, _) = self.tasks.front()?;
        if (*ends_ns).max(self.health.syncs_at_ns.load(Ordering::Relaxed)) > until_ns {
            return None;
        }
        let (_, task) = self.tasks.pop_front()?;
        self.failed |= self.health.sync_fails.swap(false, Ordering::Relaxed);
        Some(match task {
            _ if self.failed => Err(io::Error::other("the disk failed")),
            DiskTask::Sync => Ok(()),
            DiskTask::Name { part, target } => give_name(&part, &target),
        })
    }
}
