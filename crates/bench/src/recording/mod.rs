//! The recording suite: what keeping a session costs the tick, how large it is, what a disk that
//! stands still or takes seconds for a sync and a daemon that is killed lose, and how fast a replay is.

mod kill;
mod long;
mod loss;
mod session;
mod slow;
mod tick;

use super::figure::{Bar, Figure};
use super::{Cases, Effort, processes};
use palpate_record::{ReplayOptions, Session, replay_with};
use processes::Files;
use session::{RIGID, Simulated, TEARDROP};
pub use slow::{RecorderOptions, record_until_killed};

/// Runs cases of the suite. Each figure is handed out as soon
/// as it is measured. Gives the cases that could not be measured, with the reason.
pub fn recording(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Figure)) -> Vec<String> {
    let all: [(&str, Run); 7] = [
        ("cost/tick", tick::run),
        ("size/teardrop", size),
        ("loss/stall", loss::run),
        ("kill/daemon", kill::run),
        ("kill/sync", slow::run),
        ("replay/speed", speed),
        ("long", long::run),
    ];
    // The last takes minutes, and a gigabyte on disk: only for those who ask.
    let wanted = |case: &str| cases.has(case) && (cases.are_chosen() || case != "long");
    let mut failed = Vec::new();
    for (case, run) in all.into_iter().filter(|(case, _)| wanted(case)) {
        if let Err(error) = run(effort, out) {
            failed.push(format!("{case}: {error:#}"));
        }
    }
    failed
}

type Run = fn(Effort, &mut dyn FnMut(Figure)) -> anyhow::Result<()>;

fn figure(
    case: &str,
    method: &str,
    value: f64,
    unit: &'static str,
    bar: Option<Bar>,
    note: String,
) -> Figure {
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
    // The main scene refines its net for contact; a body of 8 × 8 is the same without.
    let plain = coarse();
    let cases = [
        ("one tool, one 8 x 8 body", plain.as_str(), false),
        ("the same with views", plain.as_str(), true),
        ("scene teardrop, refined net", TEARDROP, false),
    ];
    for (k, (method, text, views)) in cases.into_iter().enumerate() {
        let path = files.path(&format!("{k}.mcap"));
        let mut simulated = Simulated::new(text, |record| record.views = views)?;
        let summary = simulated.record(&path, seconds * 1_000)?;
        let bytes = std::fs::metadata(&path)?.len();
        let bar = (k == 0).then_some(Bar::AtMost(200.0));
        let note = format!(
            "{seconds} s, {bytes} bytes on disk, {} before compression",
            summary.bytes
        );
        out(figure(
            "size/teardrop",
            method,
            bytes as f64 / seconds as f64 / 1e3,
            "kB/s",
            bar,
            note,
        ));
    }
    Ok(())
}

/// Simulated over wall time of a replay that compares every bit.
fn speed(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let files = Files::new("replay")?;
    let seconds = if effort == Effort::Quick { 4 } else { 20 };
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    // The main scene fills a tick; the other two are a coarser and a rigid body under the same
    // ball.
    let coarse = coarse();
    let cases = [
        ("teardrop", TEARDROP, Some(2.5)),
        ("teardrop, 8 x 8", coarse.as_str(), None),
        ("rigid-teardrop", RIGID, None),
    ];
    for (name, text, least) in cases {
        let path = files.path(&format!("{name}.mcap"));
        Simulated::new(text, |record| record.views = false)?.record(&path, seconds * 1_000)?;
        let session = Session::open(&path)?;
        // On one core, and in proportion on more.
        let mut alone = f64::INFINITY;
        for jobs in [1, cores] {
            let report = replay_with(
                &session,
                &ReplayOptions {
                    jobs,
                    ..ReplayOptions::default()
                },
                |_, _| {},
            )?;
            let note = format!(
                "{} of {} ticks equal by bits, {} nets",
                report.ticks_matched, report.ticks_recorded, report.nets_matched
            );
            alone = alone.min(report.realtime_factor);
            let bar = match jobs {
                1 => least,
                _ => least.map(|_| 0.9 * jobs as f64 * alone),
            };
            let method = format!("{name}, {jobs} thread{}", if jobs == 1 { "" } else { "s" });
            out(figure(
                "replay/speed",
                &method,
                report.realtime_factor,
                "x",
                bar.map(Bar::AtLeast),
                note,
            ));
        }
    }
    Ok(())
}

/// The main scene without the refinement of its net.
fn coarse() -> String {
    let refined = "refine = { focus = [[0.024, 0.003, 0.045]] }";
    let text = TEARDROP.replace(refined, "refine = \"none\"");
    assert_ne!(text, TEARDROP, "the main scene is refined in another way");
    text
}
