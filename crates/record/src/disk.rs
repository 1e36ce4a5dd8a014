//! Where files go. Recordings only append: what was written stays as it is, whatever happens next.
//!
//! Bytes that are written survive the end of the process at once, and a power cut when the disk has
//! them. Who writes never waits for that: a second handle of the same file does, on a thread of its
//! own.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A file that only grows.
pub struct DiskFile {
    /// Takes its bytes.
    pub bytes: Box<dyn Write + Send>,
    /// Brings them to the disk meanwhile.
    pub sync: Box<dyn DiskSync>,
}

/// What a disk is asked to do with a file, beside the writing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DiskTask {
    /// What was written so far survives a power cut.
    Sync,
    /// The file gets another name. Nothing that has it already is overwritten.
    Name {
        /// As it is called now.
        part: PathBuf,
        /// As it is to be called.
        target: PathBuf,
    },
}

/// The side of a file that waits for the disk. Tasks are done in order; after one that failed, none
/// is. What is under way when this is dropped is done nevertheless.
pub trait DiskSync: Send {
    /// Asks for something; does not wait for it.
    fn begin(&mut self, task: DiskTask);

    /// How the oldest task has ended, of those that were not reported yet; `None` if none does within
    /// this time.
    fn ended(&mut self, within: Duration) -> Option<io::Result<()>>;
}

/// A place for files. Tests put one here that stalls or is full.
pub trait Disk: Send + Sync {
    /// A new file; directories above it are made. Nothing that exists is ever overwritten.
    ///
    /// # Errors
    /// The file exists, or cannot be made.
    fn create(&self, path: &Path) -> io::Result<DiskFile>;

    /// By which flushes are due. A disk that is simulated has a clock that is.
    fn now(&self) -> Instant {
        Instant::now()
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileSystem;

impl Disk for FileSystem {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let file = Arc::new(create_new(path)?);
        let sync = SyncThread::start(file.clone(), path).inspect_err(|_| {
            let _ = std::fs::remove_file(path);
        })?;
        Ok(DiskFile {
            bytes: Box::new(file),
            sync: Box::new(sync),
        })
    }
}

/// A place for one file in memory: a copy that is read as soon as it is whole.
#[derive(Clone, Default)]
pub(super) struct InMemory(Arc<Mutex<Vec<u8>>>);

impl InMemory {
    /// What was written since the start, or since it was last taken.
    pub fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Disk for InMemory {
    fn create(&self, _: &Path) -> io::Result<DiskFile> {
        Ok(DiskFile {
            bytes: Box::new(self.clone()),
            sync: Box::new(NothingToWaitFor(0)),
        })
    }
}

impl Write for InMemory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Tasks that end as they begin: how many have not been asked about.
struct NothingToWaitFor(u32);

impl DiskSync for NothingToWaitFor {
    fn begin(&mut self, _: DiskTask) {
        self.0 += 1;
    }

    fn ended(&mut self, _: Duration) -> Option<io::Result<()>> {
        self.0 = self.0.checked_sub(1)?;
        Some(Ok(()))
    }
}

/// A new file, and the directories above it.
pub fn create_new(path: &Path) -> io::Result<File> {
    if let Some(directory) = path.parent().filter(|above| !above.as_os_str().is_empty()) {
        std::fs::create_dir_all(directory)?;
    }
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// Gives a file its name.
///
/// # Errors
/// There is one of this name, or the file system refuses.
pub fn give_name(part: &Path, target: &Path) -> io::Result<()> {
    // A hard link fails where a rename would overwrite what came there meanwhile.
    match std::fs::hard_link(part, target) {
        Ok(()) => std::fs::remove_file(part),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(error),
        Err(_) => std::fs::rename(part, target),
    }
}

/// Brings the names in a file's directory to the disk.
fn sync_names(path: &Path) -> io::Result<()> {
    let above = path.parent().filter(|above| !above.as_os_str().is_empty());
    let synced = File::open(above.unwrap_or(Path::new("."))).and_then(|names| names.sync_all());
    match synced {
        // Some file systems sync no directories; one that may not be read cannot be opened for it.
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::PermissionDenied
            ) =>
        {
            Ok(())
        }
        other => other,
    }
}

struct SyncThread {
    tasks: Sender<DiskTask>,
    ended: Receiver<io::Result<()>>,
}

/// A sync needs little, and with locked memory all of a stack is there from the start.
const STACK: usize = 128 << 10;

impl SyncThread {
    fn start(file: Arc<File>, path: &Path) -> io::Result<Self> {
        let (tasks, wanted) = channel();
        let (done, ended) = channel();
        let path = path.to_owned();
        let work = move || {
            let mut named = false;
            for task in wanted {
                let result = match task {
                    DiskTask::Sync => file.sync_data().and_then(|()| {
                        // Without its name a new file is lost with all that is in it.
                        match std::mem::replace(&mut named, true) {
                            true => Ok(()),
                            false => sync_names(&path),
                        }
                    }),
                    DiskTask::Name { part, target } => {
                        give_name(&part, &target).and_then(|()| sync_names(&target))
                    }
                };
                let failed = result.is_err();
                // What is gone needs no answer. The system reports a failed sync once: a second one that
                // succeeds would not bring back what the first has lost.
                let _ = done.send(result);
                if failed {
                    break;
                }
            }
        };
        std::thread::Builder::new()
            .name("palpate-sync".into())
            .stack_size(STACK)
            .spawn(work)?;
        Ok(Self { tasks, ended })
    }
}

impl DiskSync for SyncThread {
    fn begin(&mut self, task: DiskTask) {
        // After a failure, which was reported, nothing takes it.
        let _ = self.tasks.send(task);
    }

    fn ended(&mut self, within: Duration) -> Option<io::Result<()>> {
        match self.ended.recv_timeout(within) {
            Ok(result) => Some(result),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                Some(Err(io::Error::other("an earlier sync of it failed")))
            }
        }
    }
}
