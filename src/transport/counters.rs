//! Counters of the loop as messages.

use palpate_drive::journal::keeping;
use palpate_drive::ports::LinkCounters;
use palpate_drive::stats::Histogram;
use palpate_proto::messages as wire;
use std::sync::atomic::Ordering;

/// Quantiles of a histogram.
pub fn quantiles(histogram: &Histogram) -> wire::Quantiles {
    wire::Quantiles {
        p50_ns: histogram.quantile(0.5),
        p99_ns: histogram.quantile(0.99),
        max_ns: histogram.max(),
    }
}

/// Counters of a tool's poses; those of its forces are zero.
pub fn tool_link(
    id: &str,
    counters: &LinkCounters,
    jumps: u64,
    stale_ticks: u64,
    energy_j: f64,
) -> wire::ToolLink {
    let read = |counter: &std::sync::atomic::AtomicU64| counter.load(Ordering::Relaxed);
    let received = read(&counters.received);
    wire::ToolLink {
        tool: id.to_owned(),
        received,
        superseded: received.saturating_sub(read(&counters.latched)),
        wrong_version: read(&counters.wrong_version),
        malformed: read(&counters.malformed),
        oversized: read(&counters.oversized),
        not_finite: read(&counters.not_finite),
        bad_quaternion: read(&counters.bad_quaternion),
        duplicated: read(&counters.duplicated),
        out_of_order: read(&counters.out_of_order),
        jumps,
        stale_ticks,
        energy_j,
        ..wire::ToolLink::default()
    }
}

/// What a journal is doing.
pub fn recorder_state(keeping: u8) -> wire::RecorderState {
    match keeping {
        keeping::RECORDING => wire::RecorderState::Recording,
        keeping::RING => wire::RecorderState::Ring,
        keeping::FAILED => wire::RecorderState::Failed,
        _ => wire::RecorderState::Off,
    }
}
