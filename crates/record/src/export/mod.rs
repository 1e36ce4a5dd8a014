//! Sessions for other programs: a table of ticks, curves to plot, the net of a body at any tick.

mod bag;
mod csv;
mod explained;
mod net;
mod plot;
mod reached;
mod series;

pub use bag::ros2_bag;
pub use csv::csv;
pub use explained::explain;
pub use net::net_at;
pub use plot::plots;
pub use series::{BucketedCurve, Series, USUAL, series};

use super::channel::{Happening, Topic};
use super::reader::{Follower, ReadError, Session};
use super::replay::ReplayError;
use palpate_geometry::surface::SurfaceError;
use palpate_sim::tick::quantity::Number;
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
    /// A net that no surface can have.
    #[error("the net of that tick makes no surface: {0}")]
    Net(#[from] SurfaceError),
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
    /// No such quantity.
    #[error("{name:?} is no quantity of a tool; there are {}", quantities())]
    UnknownQuantity {
        /// The name that was asked for.
        name: String,
    },
    /// No such body.
    #[error("no body {body:?}; the scene has {}", bodies.join(", "))]
    UnknownBody {
        /// The body that was asked for.
        body: String,
        /// What there is.
        bodies: Vec<String>,
    },
    /// A body without a net.
    #[error(
        "{body:?} is a part, which has no control net; its shape is that of the scene's file, `palpate surface tessellate` \
         writes it"
    )]
    Part {
        /// Wanted.
        body: String,
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
    /// This build comes to another state, and nothing recorded answers.
    #[error(
        "this build diverges from the recording at tick {tick}: use the one that recorded it (`palpate info` names it)"
    )]
    Diverges {
        /// The tick that was asked for.
        tick: u64,
    },
}

impl From<ReadError> for ExportError {
    fn from(error: ReadError) -> Self {
        Self::Replay(ReplayError::Read(error))
    }
}

fn quantities() -> String {
    Number::names().collect::<Vec<_>>().join(", ")
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
    fn of(&self, session: &Session) -> impl Iterator<Item = Result<Box<TickRecord>, ExportError>> {
        let ticks = Follower::between(session, self.from, self.until).only(&[Topic::Tick]);
        let ticks = ticks.reading_ahead();
        ticks.filter_map(|happening| match happening {
            Ok(Happening::Tick(record)) => Some(Ok(record)),
            Ok(_) => None,
            Err(error) => Some(Err(ReplayError::Read(error).into())),
        })
    }

    fn no_ticks(&self, session: &Session) -> ExportError {
        ExportError::NoTicks {
            from: self.from,
            until: self.until,
            ticks: session.tick_range(),
        }
    }
}

/// Length of a tick, s.
fn dt_s(session: &Session) -> f64 {
    session.dt_ns() as f64 * 1e-9
}
