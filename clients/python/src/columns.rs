//! Columns of a tool over the ticks of a recording.

use crate::closest::cores;
use crate::output::{depth, proxy};
use palpate_record::{Follower, Happening, ReadError, Session, Topic};
use palpate_sim::tick::record::{TickRecord, ToolOutput};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A column of numbers: how many to a tick, and how they are read.
pub struct Column {
    /// As Python names it.
    pub name: &'static str,
    /// Numbers to a tick.
    pub width: usize,
    read: fn(&TickRecord, usize, &ToolOutput, &mut Vec<f64>),
}

/// Columns of a tool that hold numbers.
pub const COLUMNS: &[Column] = &[
    Column {
        name: "force",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.force_n.as_slice()),
    },
    Column {
        name: "torque",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.torque_nm.as_slice()),
    },
    Column {
        name: "contact_force",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.contact_force_n.as_slice()),
    },
    Column {
        name: "contact_torque",
        width: 3,
        read: |_, _, out, to| to.extend_from_slice(out.contact_torque_nm.as_slice()),
    },
    Column {
        name: "depth",
        width: 1,
        read: |_, _, out, to| to.push(depth(out)),
    },
    Column {
        name: "proxy",
        width: 7,
        read: |_, _, out, to| to.extend_from_slice(&proxy(out)),
    },
    Column {
        name: "energy",
        width: 1,
        read: |_, _, out, to| to.push(out.energy_j),
    },
    Column {
        name: "dissipated",
        width: 1,
        read: |_, _, out, to| to.push(out.dissipated_j),
    },
    Column {
        name: "error_n",
        width: 1,
        read: |_, _, out, to| to.push(out.error_n),
    },
    Column {
        name: "pose",
        width: 7,
        read: |record, tool, _, to| match &record.input.poses[tool] {
            Some(pose) => {
                to.extend_from_slice(pose.position.coords.as_slice());
                to.extend_from_slice(pose.orientation.coords.as_slice());
            }
            None => to.extend_from_slice(&[f64::NAN; 7]),
        },
    },
    Column {
        name: "velocity",
        width: 6,
        read: |record, tool, _, to| match &record.input.poses[tool] {
            Some(pose) => {
                to.extend_from_slice(pose.linear_velocity.as_slice());
                to.extend_from_slice(pose.angular_velocity.as_slice());
            }
            None => to.extend_from_slice(&[f64::NAN; 6]),
        },
    },
    Column {
        name: "contact_point",
        width: 3,
        read: |_, _, out, to| match &out.contact {
            Some(contact) => to.extend_from_slice(contact.point.coords.as_slice()),
            None => to.extend_from_slice(&[f64::NAN; 3]),
        },
    },
    Column {
        name: "contact_normal",
        width: 3,
        read: |_, _, out, to| match &out.contact {
            Some(contact) => to.extend_from_slice(contact.normal.as_slice()),
            None => to.extend_from_slice(&[f64::NAN; 3]),
        },
    },
];

/// A column of whole numbers.
pub struct Count {
    /// As Python names it.
    pub name: &'static str,
    read: fn(&TickRecord, &ToolOutput) -> u64,
}

/// Columns of whole numbers; the first ones are the same for every tool.
pub const COUNTS: &[Count] = &[
    Count {
        name: "tick",
        read: |record, _| record.output.tick,
    },
    Count {
        name: "hash",
        read: |record, _| record.output.state_hash,
    },
    Count {
        name: "late_ns",
        read: |record, _| record.late_ns,
    },
    Count {
        name: "skipped",
        read: |record, _| u64::from(record.input.skipped),
    },
    Count {
        name: "step_ns",
        read: |record, _| record.stage_ns.total(),
    },
    Count {
        name: "pose_seq",
        read: |_, out| out.pose_seq,
    },
    Count {
        name: "flags",
        read: |_, out| u64::from(out.flags),
    },
    Count {
        name: "contact_count",
        read: |_, out| u64::from(out.contact_count),
    },
];

/// What was read of a stretch of ticks: as the columns asked for.
#[derive(Default)]
pub struct Piece {
    /// As [`Wanted::numbers`].
    pub numbers: Vec<Vec<f64>>,
    /// As [`Wanted::counts`].
    pub counts: Vec<Vec<u64>>,
}

/// What to read.
pub struct Wanted {
    /// Index of the tool.
    pub tool: usize,
    /// Of [`COLUMNS`].
    pub numbers: Vec<usize>,
    /// Of [`COUNTS`].
    pub counts: Vec<usize>,
    /// First and last.
    pub ticks: (u64, u64),
}

fn read_piece(
    session: &Session,
    wanted: &Wanted,
    (from, until): (u64, u64),
    stop: &AtomicBool,
) -> Result<Piece, ReadError> {
    let mut piece = Piece {
        numbers: vec![Vec::new(); wanted.numbers.len()],
        counts: vec![Vec::new(); wanted.counts.len()],
    };
    for happening in Follower::between(session, from, until).only(&[Topic::Tick]) {
        let Happening::Tick(record) = happening? else {
            continue;
        };
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let out = &record.output.tools[wanted.tool];
        for (column, values) in wanted.numbers.iter().zip(&mut piece.numbers) {
            (COLUMNS[*column].read)(&record, wanted.tool, out, values);
        }
        for (column, values) in wanted.counts.iter().zip(&mut piece.counts) {
            values.push((COUNTS[*column].read)(&record, out));
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
    let mut whole = Piece {
        numbers: vec![Vec::new(); wanted.numbers.len()],
        counts: vec![Vec::new(); wanted.counts.len()],
    };
    for result in results {
        let Some(piece) = result.into_inner().ok().flatten().transpose()? else {
            continue;
        };
        whole
            .numbers
            .iter_mut()
            .zip(piece.numbers)
            .for_each(|(all, part)| all.extend(part));
        whole
            .counts
            .iter_mut()
            .zip(piece.counts)
            .for_each(|(all, part)| all.extend(part));
    }
    Ok(whole)
}
