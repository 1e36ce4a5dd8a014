//! Columns of a tool over the ticks of a recording.

use crate::closest::cores;
use palpate_record::{Follower, Happening, ReadError, Session, Topic};
use palpate_sim::tick::quantity::{OF_LOOP, OfLoop, Quantity, Read, ToolTick};
use palpate_sim::tick::record::TickRecord;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A column: of a tool, or of the loop.
#[derive(Clone, Copy)]
pub enum Column {
    Tool(&'static Quantity),
    Loop(&'static OfLoop),
}

/// Values of a column, one tick after the other.
pub enum Values {
    /// So many to a tick.
    Numbers(Vec<f64>, usize),
    Whole(Vec<u64>),
}

/// As many as columns were asked for, of a stretch of ticks.
type Piece = Vec<Values>;

impl Column {
    /// As Python names it.
    pub fn named(name: &str) -> Option<Self> {
        let of_loop = OF_LOOP.iter().find(|quantity| quantity.name == name);
        let of_tool = Quantity::named(name).map(Self::Tool);
        of_loop.map(Self::Loop).or(of_tool)
    }

    /// Without a tick.
    pub fn empty(self) -> Values {
        match self {
            Self::Tool(quantity) if !matches!(quantity.read, Read::Whole(_)) => {
                Values::Numbers(Vec::new(), quantity.width())
            }
            _ => Values::Whole(Vec::new()),
        }
    }

    fn read(self, record: &TickRecord, tool: usize, to: &mut Values) {
        match (self, to) {
            (Self::Tool(quantity), Values::Numbers(to, _)) => {
                quantity.push(&ToolTick::of(record, tool), to);
            }
            (Self::Tool(quantity), Values::Whole(to)) => {
                if let Read::Whole(read) = quantity.read {
                    to.push(read(&record.output.tools[tool]));
                }
            }
            (Self::Loop(quantity), Values::Whole(to)) => to.push((quantity.read)(record)),
            (Self::Loop(_), Values::Numbers(..)) => {}
        }
    }
}

/// What to read.
pub struct Wanted {
    /// Index of the tool.
    pub tool: usize,
    /// In the order of what is read.
    pub columns: Vec<Column>,
    /// First and last.
    pub ticks: (u64, u64),
}

impl Wanted {
    /// Columns without a tick.
    pub fn empty(&self) -> Vec<Values> {
        self.columns.iter().map(|column| column.empty()).collect()
    }
}

fn read_piece(
    session: &Session,
    wanted: &Wanted,
    (from, until): (u64, u64),
    stop: &AtomicBool,
) -> Result<Piece, ReadError> {
    let mut piece = wanted.empty();
    for happening in Follower::between(session, from, until).only(&[Topic::Tick]) {
        let Happening::Tick(record) = happening? else {
            continue;
        };
        if stop.load(Ordering::Relaxed) {
            break;
        }
        for (column, values) in wanted.columns.iter().zip(&mut piece) {
            column.read(&record, wanted.tool, values);
        }
    }
    Ok(piece)
}

/// Stretches of ticks read by all cores and put end to end.
pub fn read_columns(
    session: &Session,
    wanted: &Wanted,
    stop: &AtomicBool,
) -> Result<Piece, ReadError> {
    let (first, last) = wanted.ticks;
    let workers = cores();
    let span = (last - first).saturating_add(1);
    // Stretches of a minute or so, so that what is in flight stays small.
    let stretches = span.div_ceil(50_000).max(1);
    let length = span.div_ceil(stretches);
    let next = AtomicU64::new(0);
    let results: Vec<Mutex<Option<Result<Piece, ReadError>>>> =
        (0..stretches).map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        let work = || {
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= stretches || stop.load(Ordering::Relaxed) {
                    return;
                }
                let from = first + k * length;
                let piece =
                    read_piece(session, wanted, (from, (from + length - 1).min(last)), stop);
                if let Ok(mut result) = results[k as usize].lock() {
                    *result = Some(piece);
                }
            }
        };
        (1..workers.min(stretches as usize)).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let mut whole = wanted.empty();
    for result in results {
        let piece = result.into_inner().ok().flatten().transpose()?;
        for pair in whole.iter_mut().zip(piece.into_iter().flatten()) {
            match pair {
                (Values::Numbers(all, _), Values::Numbers(part, _)) => all.extend(part),
                (Values::Whole(all), Values::Whole(part)) => all.extend(part),
                _ => {}
            }
        }
    }
    Ok(whole)
}
