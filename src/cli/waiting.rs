//! Signs of life on stderr while something takes long.

use std::io::{IsTerminal as _, Write as _};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Between two changes of a line on a terminal.
const REDRAWN: Duration = Duration::from_millis(100);

/// Replaces the line that the terminal's cursor is on. A terminal that has gone away is no reason to stop.
fn redraw(line: &str) {
    let _ = write!(std::io::stderr(), "\r{line}\x1b[K");
}

/// What is done, with the seconds so far, on a terminal until it is dropped; nothing where stderr is none.
pub struct Waiting(Option<(Sender<()>, JoinHandle<()>)>);

impl Waiting {
    /// Begins; `what` is for example `fitting 14x14 control points`.
    pub fn begin(what: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let (end, ended) = channel();
        let (what, begun) = (what.to_owned(), Instant::now());
        let drawn = std::thread::Builder::new().spawn(move || {
            while ended.recv_timeout(REDRAWN) == Err(RecvTimeoutError::Timeout) {
                redraw(&format!("{what}, {} s", begun.elapsed().as_secs()));
            }
            redraw("");
        });
        Self(drawn.ok().map(|thread| (end, thread)))
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        if let Some((end, thread)) = self.0.take() {
            drop(end);
            let _ = thread.join();
        }
    }
}

/// How much is done of how much: one line that changes on a terminal; elsewhere, if wanted, a line now and then.
pub struct Progress {
    /// `ticks`, for example.
    unit: &'static str,
    terminal: bool,
    every: Option<Duration>,
    last: Mutex<Instant>,
}

impl Progress {
    /// Begins. `lines` is the time between two lines where stderr is not a terminal; with `None` nothing is printed there.
    pub fn begin(unit: &'static str, lines: Option<Duration>) -> Self {
        let terminal = std::io::stderr().is_terminal();
        Self {
            unit,
            terminal,
            every: if terminal { Some(REDRAWN) } else { lines },
            last: Mutex::new(Instant::now()),
        }
    }

    /// Shows it, unless it has just been shown.
    pub fn show(&self, done: u64, all: u64) {
        let Some(every) = self.every else { return };
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() < every {
            return;
        }
        *last = Instant::now();
        let line = format!("{done} of {all} {}", self.unit);
        if self.terminal {
            redraw(&line);
        } else {
            eprintln!("{line}");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.terminal {
            redraw("");
        }
    }
}
