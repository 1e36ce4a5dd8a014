//! The recording suite: what keeping a session costs the tick, how large it is, what a disk that stands still and a daemon that
//! is killed lose, and how fast a replay is.

mod kill;
mod loss;
mod session;
mod tick;

use super::figure::{Bar, Figure};
use super::{Effort, processes};
use crate::recording::{ReplayOptions, Session, replay_with};
use processes::Files;
use session::{Simulated, TEARDROP};

/// Runs the suite; `only` keeps the cases whose names contain it. Each figure is handed out as soon as it is measured.
pub fn recording(effort: Effort, only: Option<&str>, out: &mut dyn FnMut(Figure)) {
    let wanted = |case: &str| only.is_none_or(|part| case.contains(part));
    let cases: [(&str, Run); 4] =
        [("cost/tick", tick::run), ("size/teardrop", size), ("loss/stall", loss::run), ("kill/daemon", kill::run)];
    for (case, run) in cases.into_iter().filter(|(case, _)| wanted(case)) {
        if let Err(error) = run(effort, out) {
            eprintln!("{case}: {error}");
        }
    }
    if wanted("replay/teardrop")
        && let Err(error) = speed(effort, out)
    {
        eprintln!("replay/teardrop: {error}");
    }
}

type Run = fn(Effort, &mut dyn FnMut(Figure)) -> anyhow::Result<()>;

fn figure(case: &str, method: &str, value: f64, unit: &'static str, bar: Option<Bar>, note: String) -> Figure {
    let (reference, reference_is) = match bar {
        Some(Bar::AtMost(most)) => (most, "bar"),
        Some(Bar::AtLeast(least)) => (least, "bar"),
        None => (0.0, ""),
    };
    Figure {
        suite: "recording",
        case: case.to_owned(),
        method: method.to_owned(),
        value,
        unit,
        reference,
        reference_is,
        bar,
        note,
    }
}

/// Bytes on disk a second of simulated time, with and without what viewers read.
fn size(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let files = Files::new("size")?;
    let seconds = if effort == Effort::Quick { 4 } else { 60 };
    for views in [false, true] {
        let path = files.path(if views { "views.mcap" } else { "plain.mcap" });
        let mut simulated = Simulated::new(TEARDROP, |record| record.views = views)?;
        let summary = simulated.record(&path, seconds * 1_000)?;
        let bytes = std::fs::metadata(&path)?.len();
        let method = if views { "with views" } else { "one tool, one 8 x 8 body" };
        let bar = (!views).then_some(Bar::AtMost(200.0));
        let note = format!("{seconds} s, {bytes} bytes on disk, {} before compression", summary.bytes);
        out(figure("size/teardrop", method, bytes as f64 / seconds as f64 / 1e3, "kB/s", bar, note));
    }
    Ok(())
}

/// Simulated over wall time of a replay that compares every bit.
fn speed(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let files = Files::new("replay")?;
    let path = files.path("teardrop.mcap");
    let seconds = if effort == Effort::Quick { 4 } else { 20 };
    Simulated::new(TEARDROP, |record| record.views = false)?.record(&path, seconds * 1_000)?;
    let session = Session::open(&path)?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    for jobs in [1, cores] {
        let report = replay_with(&session, &ReplayOptions { jobs, ..ReplayOptions::default() }, |_, _| {})?;
        let note = format!(
            "{} of {} ticks equal by bits, {} nets",
            report.ticks_matched, report.ticks_recorded, report.nets_matched
        );
        let method = format!("{jobs} thread{}", if jobs == 1 { "" } else { "s" });
        out(figure("replay/teardrop", &method, report.realtime_factor, "x", Some(Bar::AtLeast(20.0)), note));
    }
    Ok(())
}
