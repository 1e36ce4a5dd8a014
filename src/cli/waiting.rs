//! A sign of life on a terminal while something takes long.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Turns on stderr, with the time so far, until it is dropped; nothing where stderr is not a terminal.
pub struct Waiting(ProgressBar);

impl Waiting {
    /// Begins; `what` is for example `fitting 14x14 control points`.
    pub fn begin(what: &str) -> Self {
        if !std::io::IsTerminal::is_terminal(&std::io::stderr()) {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
