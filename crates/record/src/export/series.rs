//! Curves of a session, reduced to what a plot can show: of each stretch of time the least and the
//! largest value, so that no peak is lost, however long the session.

use super::super::reader::{Session, last_tick_between};
use super::super::replay::ReplayError;
use super::{ExportError, Range, dt_s};
use palpate_sim::tick::quantity::{Number, ToolTick};

/// What a plot shows if nothing else is asked for.
pub const USUAL: [&str; 3] = ["force", "depth", "energy"];

/// Stretches of time that a curve is divided into at most.
const BUCKETS: u64 = 800;

/// Least and largest value of a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bucket {
    /// Its first tick, s.
    pub t_s: f64,
    /// Least value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
}

/// A quantity over time.
#[derive(Clone, Debug, PartialEq)]
pub struct BucketedCurve {
    /// For example the id of a tool.
    pub name: String,
    /// Pieces without a gap between them.
    pub pieces: Vec<Vec<Bucket>>,
}

/// A quantity of each tool over time.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What, in its unit of SI.
    pub number: Number,
    /// By tool.
    pub curves: Vec<BucketedCurve>,
}

/// Quantities of each tool, and the time that ticks took.
#[derive(Clone, Debug)]
pub struct Series {
    /// First and last tick, s.
    pub span_s: [f64; 2],
    /// In the order asked for.
    pub panels: Vec<Panel>,
    /// s.
    pub tick_s: BucketedCurve,
    /// Length of a tick, s.
    pub dt_s: f64,
}

/// The curves of a range, of numbers by their names: [`USUAL`] or others of [`Number::names`].
///
/// # Errors
/// A name that there is not, no tick in the range, or a file that cannot be read.
pub fn series(
    session: &Session,
    range: &Range,
    names: &[impl AsRef<str>],
) -> Result<Series, ExportError> {
    let named = names.iter().map(AsRef::as_ref).map(|name| {
        Number::named(name).ok_or_else(|| ExportError::UnknownQuantity {
            name: name.to_owned(),
        })
    });
    let numbers = named.collect::<Result<Vec<Number>, ExportError>>()?;
    let (tools, dt_s) = (session.header.names("tools"), dt_s(session));
    let mut records = range.of(session).peekable();
    let first = match records.peek() {
        None => return Err(range.no_ticks(session)),
        // An error comes again below.
        Some(record) => record
            .as_ref()
            .map_or(range.from, |record| record.output.tick),
    };
    let last = last_tick_between(session, first, range.until).map_err(ReplayError::Read)?;
    let ticks = [first, last.unwrap_or(first)];
    let of_tools = |_| -> Vec<Drawing> {
        let tools = tools.iter();
        tools
            .map(|name| Drawing::new(name.clone(), ticks, dt_s))
            .collect()
    };
    let mut drawn: Vec<Vec<Drawing>> = numbers.iter().map(of_tools).collect();
    let mut tick_s = Drawing::new("tick".into(), ticks, dt_s);
    for record in records {
        let record = *record?;
        let tick = record.output.tick;
        for (number, drawn) in numbers.iter().zip(&mut drawn) {
            for (tool, drawing) in drawn.iter_mut().enumerate() {
                drawing.push(tick, number.of(&ToolTick::of(&record, tool)));
            }
        }
        tick_s.push(tick, record.stage_ns.total() as f64 * 1e-9);
    }
    let panel = |(number, drawn): (Number, Vec<Drawing>)| Panel {
        number,
        curves: drawn.into_iter().map(Drawing::finish).collect(),
    };
    Ok(Series {
        span_s: ticks.map(|tick| tick as f64 * dt_s),
        panels: numbers.into_iter().zip(drawn).map(panel).collect(),
        tick_s: tick_s.finish(),
        dt_s,
    })
}

/// A curve to which one tick after the other is added.
struct Drawing {
    curve: BucketedCurve,
    first: u64,
    /// Ticks of a bucket.
    width: u64,
    dt_s: f64,
    /// Tick of the last value, and the bucket that takes more.
    before: Option<u64>,
    open: Option<u64>,
}

impl Drawing {
    /// Of ticks from one to another.
    fn new(name: String, [first, last]: [u64; 2], dt_s: f64) -> Self {
        Self {
            curve: BucketedCurve {
                name,
                pieces: Vec::new(),
            },
            first,
            width: last.saturating_sub(first) / BUCKETS + 1,
            dt_s,
            before: None,
            open: None,
        }
    }

    fn push(&mut self, now: u64, value: f64) {
        // What is not in order has no place on the axis.
        if !value.is_finite() || now < self.before.unwrap_or(self.first) {
            return;
        }
        let number = (now - self.first) / self.width;
        let pieces = &mut self.curve.pieces;
        // A gap of a few ticks is too small to be seen; one that a bucket does not cover ends the
        // line.
        if self.before.is_none_or(|before| now - before > self.width) {
            pieces.push(Vec::new());
            self.open = None;
        }
        if let Some(piece) = pieces.last_mut() {
            match piece.last_mut().filter(|_| self.open == Some(number)) {
                Some(bucket) => {
                    bucket.least = bucket.least.min(value);
                    bucket.most = bucket.most.max(value);
                }
                None => piece.push(Bucket {
                    t_s: now as f64 * self.dt_s,
                    least: value,
                    most: value,
                }),
            }
        }
        (self.before, self.open) = (Some(now), Some(number));
    }

    fn finish(self) -> BucketedCurve {
        self.curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_peak_is_lost_and_gaps_are_seen() {
        let ticks = (1..=200_000u64).filter(|tick| !(90_000..100_000).contains(tick));
        let mut drawing = Drawing::new("tick".into(), [1, 200_000], 1e-3);
        for tick in ticks {
            drawing.push(tick, if tick == 123_457 { 5_000.0 } else { 10.0 });
        }
        let curve = drawing.finish();
        assert_eq!(curve.pieces.len(), 2);
        let all: Vec<Bucket> = curve.pieces.concat();
        assert!(all.len() <= BUCKETS as usize + 1, "{}", all.len());
        let peaks: Vec<&Bucket> = all.iter().filter(|bucket| bucket.most == 5_000.0).collect();
        assert!(
            peaks.len() == 1 && peaks[0].least == 10.0 && (peaks[0].t_s - 123.457).abs() < 0.3,
            "{peaks:?}"
        );
    }
}
