//! What was measured, and what is promised.

use super::paths::MS;
use std::fmt::Write as _;
use std::time::Duration;

pub const EVENTS: [&str; 5] = [
    "daemon killed",
    "daemon stopped",
    "network gone",
    "client killed",
    "client stopped",
];
pub const KILLED: usize = 0;
pub const STOPPED: usize = 1;
pub const CUT: usize = 2;
pub const CLIENT_KILLED: usize = 3;
pub const CLIENT_STOPPED: usize = 4;

pub const RUST: &str = "Rust: `Tool::force`";
pub const DEVICE: &str = "`palpate device`";
pub const PYTHON: [&str; 3] = [
    "Python: `Tool.run`",
    "Python: `Tool.force`",
    "Python: `Session.forces`",
];
pub const C: &str = "C: `palpate_watchdog`";
pub const TYPESCRIPT: &str = "TypeScript: `Watchdog`";
pub const PAGE: &str = "the page, which shows it";
pub const ROSBRIDGE: &str = "rosbridge, client with `Watchdog`";
pub const HAPLY: &str = "Haply";
pub const ROS: &str = "ROS 2, driver without guard";
pub const GUARDED: &str = "ROS 2, driver with guard";
pub const DAEMON: &str = "daemon, of a client that is silent";

/// What is promised, ms; `HELD`: nothing can be, and the driver holds the force.
pub const HELD: u64 = 0;
pub const PROMISED: [(&str, [Option<u64>; 5]); 13] = [
    (RUST, [Some(60), Some(60), Some(60), None, None]),
    (DEVICE, [Some(60), Some(60), None, None, None]),
    (PYTHON[0], [Some(60), Some(60), Some(60), None, None]),
    (PYTHON[1], [Some(60), Some(60), Some(60), None, None]),
    (PYTHON[2], [Some(110), Some(110), Some(110), None, None]),
    (C, [Some(60), Some(60), None, None, None]),
    (TYPESCRIPT, [Some(60), Some(60), None, None, None]),
    (PAGE, [Some(110), Some(110), None, None, None]),
    (ROSBRIDGE, [Some(60), Some(60), None, None, None]),
    (HAPLY, [Some(60), Some(60), None, Some(60), Some(60)]),
    (ROS, [Some(HELD), Some(HELD), None, None, None]),
    (GUARDED, [Some(60), Some(60), None, Some(HELD), Some(HELD)]),
    (DAEMON, [None, None, None, Some(72), Some(72)]),
];

/// What was measured: the least of all attempts.
#[derive(Default)]
pub struct Table {
    cells: std::collections::BTreeMap<(&'static str, usize), (Option<Duration>, Duration)>,
    pub skipped: Vec<&'static str>,
}

impl Table {
    pub fn note(
        &mut self,
        name: &'static str,
        event: usize,
        zero: Option<Duration>,
        allowed: Duration,
    ) {
        let over = |(zero, allowed): (Option<Duration>, Duration)| {
            zero.map_or(Duration::MAX, |zero| zero.saturating_sub(allowed))
        };
        let cell = self.cells.entry((name, event)).or_insert((zero, allowed));
        if over((zero, allowed)) < over(*cell) {
            *cell = (zero, allowed);
        }
    }

    /// What does not keep what is promised.
    pub fn broken(&self) -> Vec<String> {
        let promised = |name: &str, event: usize| {
            let (_, row) = PROMISED.iter().find(|row| row.0 == name).unwrap();
            row[event].unwrap_or_else(|| panic!("nothing is promised of {name} at {event}"))
        };
        let mut broken = Vec::new();
        for ((name, event), (zero, allowed)) in &self.cells {
            let limit = promised(name, *event);
            let kept =
                limit == HELD || zero.is_some_and(|zero| zero <= MS * limit as u32 + *allowed);
            if !kept {
                broken.push(format!(
                    "{name}, {}: {zero:?}, promised {limit} ms, {allowed:?} more allowed",
                    EVENTS[*event]
                ));
            }
        }
        broken
    }

    pub fn markdown(&self) -> String {
        let mut text = format!(
            "| ms to zero | {} |\n|---|{}\n",
            EVENTS.join(" | "),
            "--:|".repeat(EVENTS.len())
        );
        for (name, row) in PROMISED {
            let cell = |event: usize| match (row[event], self.cells.get(&(name, event))) {
                (None, _) => String::new(),
                (Some(_), None) => "–".to_owned(),
                (Some(_), Some((None, _))) => "held".to_owned(),
                (Some(_), Some((Some(zero), _))) => zero.as_millis().to_string(),
            };
            let _ = writeln!(
                text,
                "| {name} | {} |",
                [0, 1, 2, 3, 4].map(cell).join(" | ")
            );
        }
        text
    }
}
