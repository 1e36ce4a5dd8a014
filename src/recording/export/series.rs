//! Curves of a session, reduced to what a plot can show: of each stretch of time the least and the
//! largest value, so that no peak is lost, however long the session.

use super::super::names;
use super::super::reader::Session;
use super::{ExportError, Range, dt_s};
use palpate_sim::tick::record::TickRecord;

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
pub struct Curve {
    /// For example the id of a tool.
    pub name: String,
    /// Pieces without a gap between them.
    pub pieces: Vec<Vec<Bucket>>,
}

/// Force, depth and energy of each tool, and the time that ticks took.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// First and last tick, s.
    pub span_s: [f64; 2],
    /// N, by tool.
    pub force_n: Vec<Curve>,
    /// m, by tool; zero without contact.
    pub depth_m: Vec<Curve>,
    /// J, by tool.
    pub energy_j: Vec<Curve>,
    /// s.
    pub tick_s: Curve,
    /// Length of a tick, s.
    pub dt_s: f64,
}

/// The curves of a range.
///
/// # Errors
/// No tick in the range.
pub fn series(session: &Session, range: &Range) -> Result<Series, ExportError> {
    let records = range.of(session)?;
    let (tools, dt_s) = (names(session, "tools"), dt_s(session));
    let of_tools = |value: fn(&TickRecord, usize) -> f64| {
        let curve = |(t, name): (usize, &String)| {
            curve(name.clone(), records, dt_s, |record| value(record, t))
        };
        tools.iter().enumerate().map(curve).collect()
    };
    let time =
        |record: Option<&TickRecord>| record.map_or(0.0, |record| record.output.tick as f64 * dt_s);
    Ok(Series {
        span_s: [time(records.first()), time(records.last())],
        force_n: of_tools(|record, t| record.output.tools[t].force_n.norm()),
        depth_m: of_tools(|record, t| {
            record.output.tools[t]
                .contact
                .map_or(0.0, |contact| contact.depth_m)
        }),
        energy_j: of_tools(|record, t| record.output.tools[t].energy_j),
        tick_s: curve("tick".into(), records, dt_s, |record| {
            record.stage_ns.total() as f64 * 1e-9
        }),
        dt_s,
    })
}

fn curve(
    name: String,
    records: &[TickRecord],
    dt_s: f64,
    value: impl Fn(&TickRecord) -> f64,
) -> Curve {
    let tick = |record: &TickRecord| record.output.tick;
    let (first, last) = (
        records.first().map_or(0, tick),
        records.last().map_or(0, tick),
    );
    let width = (last - first) / BUCKETS + 1;
    let mut pieces: Vec<Vec<Bucket>> = Vec::new();
    let (mut before, mut open) = (None, None);
    for record in records {
        let (now, value) = (tick(record), value(record));
        if !value.is_finite() {
            continue;
        }
        let number = (now - first) / width;
        // A gap of a few ticks is none to see; one that a bucket does not cover ends the line.
        if before.is_none_or(|before| now - before > width) {
            pieces.push(Vec::new());
            open = None;
        }
        let piece = pieces.last_mut().expect("one was pushed");
        match piece.last_mut().filter(|_| open == Some(number)) {
            Some(bucket) => {
                (bucket.least, bucket.most) = (bucket.least.min(value), bucket.most.max(value))
            }
            None => piece.push(Bucket {
                t_s: now as f64 * dt_s,
                least: value,
                most: value,
            }),
        }
        (before, open) = (Some(now), Some(number));
    }
    Curve { name, pieces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_sim::tick::record::TickOutput;
    use palpate_sim::tick::stage::{Stage, StageTimes};

    #[test]
    fn no_peak_is_lost_and_gaps_are_seen() {
        let ticks = (1..=200_000u64).filter(|tick| !(90_000..100_000).contains(tick));
        let records: Vec<TickRecord> = ticks
            .map(|tick| {
                let mut stage_ns = StageTimes::default();
                stage_ns[Stage::Latch] = if tick == 123_457 { 5_000 } else { 10 };
                TickRecord {
                    output: TickOutput {
                        tick,
                        ..TickOutput::default()
                    },
                    stage_ns,
                    ..TickRecord::default()
                }
            })
            .collect();
        let curve = curve("tick".into(), &records, 1e-3, |record| {
            f64::from(record.stage_ns[Stage::Latch])
        });
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
