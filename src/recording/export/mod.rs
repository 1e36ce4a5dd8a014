//! Sessions for other programs: a table of ticks, curves to plot, the net of a body at any tick.

mod csv;
mod net;
mod series;

pub use csv::csv;
pub use net::net_at;
pub use series::{Bucket, Curve, Series, series};

use super::reader::Session;
use super::replay::ReplayError;
use palpate_sim::tick::record::TickRecord;

/// Why something could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The session.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// Where it goes.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// A range without ticks.
    #[error("no tick from {from} to {until}; {}", known(*.ticks))]
    NoTicks {
        /// Wanted start.
        from: u64,
        /// Wanted end.
        until: u64,
        /// First and last that there are.
        ticks: Option<(u64, u64)>,
    },
    /// No such body.
    #[error("no body {body:?}; the scene has {}", bodies.join(", "))]
    UnknownBody {
        /// Wanted.
        body: String,
        /// What there is.
        bodies: Vec<String>,
    },
    /// No state after that tick.
    #[error("no state after tick {tick}; {}", known(*.ticks))]
    UnknownTick {
        /// Wanted.
        tick: u64,
        /// First and last with a state.
        ticks: Option<(u64, u64)>,
    },
    /// Between a gap and the next keyframe.
    #[error("tick {tick} follows a gap, and no keyframe lies between them; the next is at tick {}", next.map_or("none".into(), |t| t.to_string()))]
    Unreached {
        /// Wanted.
        tick: u64,
        /// Keyframe after it.
        next: Option<u64>,
    },
    /// This build comes to another state.
    #[error(
        "this build diverges from the recording at tick {tick}; recorded nets exist for ticks {}",
        near(nets)
    )]
    Inexact {
        /// Wanted.
        tick: u64,
        /// Nearest ticks with a net in the file.
        nets: Vec<u64>,
    },
}

fn known(ticks: Option<(u64, u64)>) -> String {
    ticks.map_or("the recording has none".into(), |(first, last)| {
        format!("the recording has {first} to {last}")
    })
}

fn near(nets: &[u64]) -> String {
    let list: Vec<String> = nets.iter().map(ToString::to_string).collect();
    if list.is_empty() {
        "(none)".into()
    } else {
        list.join(" and ")
    }
}

/// Ticks to export, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// First tick.
    pub from: u64,
    /// Last tick.
    pub until: u64,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            from: 0,
            until: u64::MAX,
        }
    }
}

impl Range {
    /// The ticks in it.
    fn of<'a>(&self, session: &'a Session) -> Result<&'a [TickRecord], ExportError> {
        let start = session
            .ticks
            .partition_point(|record| record.output.tick < self.from);
        let end = session
            .ticks
            .partition_point(|record| record.output.tick <= self.until);
        if start >= end {
            let ticks = edges(session);
            return Err(ExportError::NoTicks {
                from: self.from,
                until: self.until,
                ticks,
            });
        }
        Ok(&session.ticks[start..end])
    }
}

fn edges(session: &Session) -> Option<(u64, u64)> {
    Some((
        session.ticks.first()?.output.tick,
        session.ticks.last()?.output.tick,
    ))
}

/// Length of a tick, s.
fn dt_s(session: &Session) -> f64 {
    session.run_number("dt_ns").unwrap_or(1_000_000) as f64 * 1e-9
}
