//! One daemon as a child process: started, heard, ended.

use super::session::Ask;
use crate::program;
use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Read as _};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, ChildStdout, ExitStatus, Stdio};
use std::sync::mpsc::Sender;

/// A ready line is shorter.
const LONGEST_LINE: u64 = 64 << 10;

/// A running daemon. Dropped, it is killed.
pub(super) struct Daemon {
    child: Child,
}

impl Daemon {
    /// Starts `palpate serve` with these arguments. Its first line is reported as [`Ask::Said`], the end
    /// of its output as [`Ask::Closed`].
    ///
    /// The system ends it (SIGTERM, so that forces fade) when the calling thread ends, however that
    /// happens: call this from a thread that lives as long as the lobby.
    pub(super) fn start(
        id: &str,
        arguments: &[OsString],
        tell: Sender<Ask>,
    ) -> std::io::Result<Self> {
        let mut command = program::command()?;
        command
            .arg("serve")
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        let parent = std::process::id();
        // SAFETY: between fork and exec only calls that are async-signal-safe: prctl, getppid.
        #[allow(unsafe_code)]
        unsafe {
            command.pre_exec(move || {
                libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
                // A parent that ended before the call above sends no signal any more.
                match std::os::unix::process::parent_id() == parent {
                    true => Ok(()),
                    false => Err(std::io::ErrorKind::Interrupted.into()),
                }
            });
        }
        let mut daemon = Self {
            child: command.spawn()?,
        };
        if let Some(stdout) = daemon.child.stdout.take() {
            let id = id.to_owned();
            std::thread::Builder::new()
                .name("palpate-hears".into())
                .spawn(move || hear(&id, stdout, &tell))?;
        }
        Ok(daemon)
    }

    /// Process id.
    pub(super) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Asks it to end: forces fade first, and its recording is finished.
    pub(super) fn ask_to_end(&self) {
        let pid = i32::try_from(self.child.id()).ok();
        if let Some(pid) = pid.and_then(rustix::process::Pid::from_raw) {
            // It is a child that has not been waited for: the number is still its own.
            let _ = rustix::process::kill_process(pid, rustix::process::Signal::TERM);
        }
    }

    /// Ends it at once.
    pub(super) fn kill(&mut self) {
        let _ = self.child.kill();
    }

    /// How it ended, if it has.
    pub(super) fn ended(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().ok().flatten()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Tells the first line, and takes the rest so that the daemon never waits for a reader.
fn hear(id: &str, stdout: ChildStdout, tell: &Sender<Ask>) {
    let mut reader = BufReader::new(stdout);
    let mut line = Vec::new();
    let read = reader
        .by_ref()
        .take(LONGEST_LINE)
        .read_until(b'\n', &mut line);
    if read.is_ok_and(|bytes| bytes > 0) {
        let line = serde_json::from_slice(&line).unwrap_or_default();
        let id = id.to_owned();
        let _ = tell.send(Ask::Said { id, line });
    }
    let _ = std::io::copy(&mut reader, &mut std::io::sink());
    let _ = tell.send(Ask::Closed(id.to_owned()));
}
