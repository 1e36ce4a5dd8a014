//! An hour in one file: how much memory it takes to look at it, to replay, export and recover it,
//! and how long. Resident memory is that of this process, from `/proc` of Linux.

use super::session::{RIGID, Simulated};
use super::{Bar, Effort, Figure, Files, figure};
use palpate_record::{
    Origin, Range, ReplayOptions, Session, computed_info, csv, info, recover, replay_with,
};
use std::io::{BufWriter, sink};
use std::time::Instant;

/// Most resident memory while a recording is read, MB.
const MEMORY: Bar = Bar::AtMost(200.0);
/// Longest for the figures of a file with its index, s.
const LOOK: Bar = Bar::AtMost(2.0);

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let seconds = if effort == Effort::Quick { 60 } else { 3_600 };
    let files = Files::new("long")?;
    let (path, part) = (files.path("long.mcap"), files.path("cut.mcap.part"));
    let begun = Instant::now();
    Simulated::new(RIGID, |_| {})?.record(&path, seconds * 1_000)?;
    let bytes = std::fs::metadata(&path)?.len();
    eprintln!(
        "{seconds} s recorded in {:.1} s: {bytes} bytes",
        begun.elapsed().as_secs_f64()
    );
    let mut measured = |method: &str, bar, run: &mut dyn FnMut() -> anyhow::Result<String>| {
        let reset = std::fs::write("/proc/self/clear_refs", "5");
        let begun = Instant::now();
        let note = run()?;
        let elapsed_s = begun.elapsed().as_secs_f64();
        let (case, notes) = (
            format!("long/{seconds} s"),
            format!("{note}, {bytes} bytes"),
        );
        out(figure(&case, method, elapsed_s, "s", bar, notes));
        if let (Ok(()), Some(peak_mb)) = (reset, peak_resident_mb()) {
            let method = format!("{method}, resident memory");
            out(figure(&case, &method, peak_mb, "MB", Some(MEMORY), note));
        }
        anyhow::Ok(())
    };
    let told = |from: Origin, ticks| match from {
        Origin::Index => format!("{ticks} ticks, as the recorder summed them up"),
        Origin::Chunks => format!("{ticks} ticks, from every chunk"),
    };
    measured("info", Some(LOOK), &mut || {
        let info = info(&Session::open(&path)?)?;
        Ok(told(info.figures_from, info.ticks))
    })?;
    measured("info --check", None, &mut || {
        let info = computed_info(&Session::open(&path)?)?;
        Ok(told(info.figures_from, info.ticks))
    })?;
    measured("replay", None, &mut || {
        let report = replay_with(&Session::open(&path)?, &ReplayOptions::default(), |_, _| {})?;
        anyhow::ensure!(report.passed(), "{:?}", report.first_difference);
        Ok(format!(
            "{} ticks equal by bits, {} threads",
            report.ticks_matched, report.jobs
        ))
    })?;
    measured("export --csv", None, &mut || {
        let session = Session::open(&path)?;
        csv(&session, &Range::default(), &mut BufWriter::new(sink()))?;
        Ok(format!("{} rows", session.tick_count()))
    })?;
    // What a kill in the last minute would have left.
    let cut = std::fs::File::options().write(true).open(&path)?;
    std::fs::rename(&path, &part)?;
    cut.set_len(bytes - bytes / (seconds / 30))?;
    measured("info, cut short", None, &mut || {
        let info = info(&Session::open(&part)?)?;
        Ok(told(info.figures_from, info.ticks))
    })?;
    measured("recover", None, &mut || {
        Ok(format!("{} ticks", recover(&part, &path)?.ticks))
    })
}

/// Most memory that this process had at once since the mark was reset, MB.
fn peak_resident_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kb: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kb / 1e3)
}
