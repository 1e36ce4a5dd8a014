//! `palpate replay`: the recorded inputs through the same step.

use super::Outcome;
use super::waiting::Progress;
use anyhow::Context as _;
use palpate_record::{
    Deviation, Figures, HashDifference, ReplayOptions, ReplayReport, Session, Simulation, Start,
    deviations, record_again, replay_with, simulate,
};
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// Start at the keyframe at or before this tick.
    #[arg(long, value_name = "TICK", default_value_t = 0)]
    from: u64,
    /// Last tick to replay.
    #[arg(long, value_name = "TICK")]
    until: Option<u64>,
    /// Number of threads; results do not depend on it [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// What to compare: every bit with the recording; the figures in FILE.figures.json within their
    /// tolerances; or its hashes of all bits, also of a recording reduced to its inputs [default:
    /// bits; hashes of one that is reduced].
    #[arg(long, value_enum)]
    check: Option<Check>,
    /// With --check figures or hashes: write those of this build to FILE.figures.json and print what
    /// changed.
    #[arg(long)]
    bless: bool,
    /// Compare nothing: run the inputs and record what comes of them, whole, to this new file.
    #[arg(long, value_name = "OUT.mcap", conflicts_with_all = ["check", "bless", "from", "until", "jobs", "report", "json"])]
    record: Option<PathBuf>,
    /// Write the report and, on a difference, the ticks around it to this FILE.json or directory.
    #[arg(long, value_name = "PATH")]
    report: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    Bits,
    Figures,
    Hashes,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let mut session = Session::open_any(&args.file)?;
    let check = args.check.unwrap_or(match session.holds_inputs_only() {
        true => Check::Hashes,
        false => Check::Bits,
    });
    if check == Check::Bits && args.record.is_none() {
        session = session.with_outputs()?;
    } else {
        anyhow::ensure!(
            args.from == 0 && args.until.is_none(),
            "figures and hashes cover a whole recording: --from and --until work with --check bits only"
        );
    }
    anyhow::ensure!(
        !args.bless || check != Check::Bits,
        "--bless writes figures or hashes: add --check figures or --check hashes"
    );
    match (&args.record, check) {
        (Some(target), _) => record(&session, target),
        (None, Check::Bits) => bits(args, &session),
        (None, Check::Figures | Check::Hashes) => figures(args, check, &session),
    }
}

fn record(session: &Session, target: &Path) -> anyhow::Result<Outcome> {
    let progress = Progress::begin("ticks", None);
    let summary = record_again(session, target, |done, all| progress.show(done, all))?;
    drop(progress);
    println!(
        "{}: {} ticks, session hash {:016x}",
        target.display(),
        summary.ticks,
        summary.session_hash
    );
    Ok(whole(session))
}

/// Says so where something is missing.
fn whole(session: &Session) -> Outcome {
    if session.is_whole() {
        return Outcome::Ok;
    }
    let reason = session.cut_short().unwrap_or("it was not ended");
    eprintln!("the recording is incomplete: {reason}");
    Outcome::Fault
}

fn bits(args: &Args, session: &Session) -> anyhow::Result<Outcome> {
    let defaults = ReplayOptions::default();
    let options = ReplayOptions {
        from: args.from,
        until: args.until.unwrap_or(defaults.until),
        jobs: args.jobs.map_or(defaults.jobs, usize::from),
    };
    let progress = Progress::begin("ticks", None);
    let report = replay_with(session, &options, |done, all| progress.show(done, all))?;
    drop(progress);
    let report_text = serde_json::to_string(&report)?;
    if args.json {
        println!("{report_text}");
    } else {
        tell(&report);
    }
    if !report.same_build {
        eprintln!(
            "note: recorded by another build; identical bits are guaranteed for the same build only"
        );
    }
    if !report.is_complete() {
        eprintln!(
            "the recording is incomplete: {} ticks missing, {} unreachable from a keyframe, finished cleanly: {}",
            report.gaps, report.ticks_unreached, report.clean
        );
    }
    if let Some(divergence) = &report.divergence {
        match divergence.write(session, &places(args).0) {
            Ok(path) => eprintln!("the ticks around it, from both runs: {}", path.display()),
            // What was found is printed all the same.
            Err(error) => {
                eprintln!(
                    "the ticks around it could not be written: {error}; give a directory with --report"
                )
            }
        }
    }
    write_report(args, &report_text)?;
    Ok(match (&report.first_difference, report.is_complete()) {
        (Some(_), _) => Outcome::Difference,
        (None, true) => Outcome::Ok,
        (None, false) => Outcome::Fault,
    })
}

fn tell(report: &ReplayReport) {
    println!(
        "{} of {} ticks matched bit for bit, {} nets; {:.1} x real time on {} threads; session hash {}",
        report.ticks_matched,
        report.ticks_recorded,
        report.nets_matched,
        report.realtime_factor,
        report.jobs,
        report.session_hash
    );
    if let Some(difference) = &report.first_difference {
        println!("first difference at {difference}");
    }
}

/// Where the ticks around a difference go, and where the report.
fn places(args: &Args) -> (PathBuf, Option<PathBuf>) {
    let directory = |path: &Path| {
        path.parent()
            .filter(|d| !d.as_os_str().is_empty())
            .unwrap_or(Path::new("."))
            .into()
    };
    match &args.report {
        None => (directory(&args.file), None),
        Some(path) if path.extension().is_some_and(|e| e == "json") => {
            (directory(path), Some(path.clone()))
        }
        Some(path) => (path.clone(), Some(path.join("replay.json"))),
    }
}

fn write_report(args: &Args, report_text: &str) -> anyhow::Result<()> {
    let (directory, Some(path)) = places(args) else {
        return Ok(());
    };
    std::fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
    std::fs::write(&path, format!("{report_text}\n")).with_context(|| path.display().to_string())
}

/// What is held against what is written down.
#[derive(serde::Serialize)]
struct FiguresReport<'a> {
    figures: &'a Figures,
    start: &'a Start,
    deviations: Vec<Deviation>,
    /// Where hashes were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_difference: Option<Option<HashDifference>>,
}

fn figures(args: &Args, check: Check, session: &Session) -> anyhow::Result<Outcome> {
    let path = Figures::path_for(&args.file);
    let before = match Figures::read(&path) {
        Err(_) if args.bless => None,
        read => Some(read?),
    };
    let progress = Progress::begin("ticks", None);
    let found = simulate(session, |done, all| progress.show(done, all))?;
    drop(progress);
    if let Start::Scene {
        reason: Some(reason),
    } = &found.start
    {
        eprintln!(
            "note: the first keyframe does not fit this version ({reason}); the replay started from the scene's initial state"
        );
    }
    let hashed = check == Check::Hashes;
    if hashed && whole(session) != Outcome::Ok {
        return Ok(Outcome::Fault);
    }
    if args.bless {
        return bless(args, hashed, found, before, &path);
    }
    let Some(before) = before else {
        unreachable!("read, or an error")
    };
    let hashes = hashed.then(|| before.hashes_of_session(&found, &path));
    let hashes = hashes.transpose()?;
    let first =
        hashes.and_then(|hashes| hashes.first_difference(&found.hashes, found.figures.ticks));
    // Hashes that differ say little: the figures say what has changed.
    let exact = first.is_some();
    let report = FiguresReport {
        figures: &found.figures,
        start: &found.start,
        deviations: match hashed && !exact {
            true => Vec::new(),
            false => deviations(&before, &found.figures, exact),
        },
        first_difference: hashed.then_some(first),
    };
    print_figures(args, &report)?;
    let ticks = found.figures.ticks;
    let first = report.first_difference.as_ref().and_then(Option::as_ref);
    let same = first.is_none() && report.deviations.is_empty();
    if !args.json {
        match hashes {
            None => {
                let verdict = match same {
                    true => "all figures are within their tolerances",
                    false => "figures deviate",
                };
                println!("{ticks} ticks simulated: {verdict} in {}", path.display());
            }
            Some(hashes) => {
                let all = hashes.stretches.len();
                println!(
                    "{}{ticks} ticks run, {} of {all} hashes matched; session hash {}",
                    match session.holds_inputs_only() {
                        true => "no outputs recorded; ",
                        false => "",
                    },
                    first.map_or(all, |first| first.matched),
                    found.hashes.session
                );
            }
        }
    }
    Ok(match same {
        true => Outcome::Ok,
        false => Outcome::Difference,
    })
}

/// Writes what was found, and says what of it has changed.
fn bless(
    args: &Args,
    hashed: bool,
    found: Simulation,
    before: Option<Figures>,
    path: &Path,
) -> anyhow::Result<Outcome> {
    let mut now = found.figures;
    let mut changed = None;
    // Hashes that are there do not become stale.
    let hashed = hashed
        || before
            .as_ref()
            .is_some_and(|before| before.hashes.is_some());
    now.hashes = hashed.then_some(found.hashes);
    if let Some(before) = &before {
        // Tolerances are of the author: they stay.
        now.tolerances = before.tolerances;
        changed = Some(deviations(before, &now, true));
    }
    if before.as_ref() != Some(&now) {
        now.write(path)?;
    }
    print_figures(
        args,
        &FiguresReport {
            figures: &now,
            start: &found.start,
            deviations: changed.clone().unwrap_or_default(),
            first_difference: None,
        },
    )?;
    if !args.json {
        let hashes = |figures: Option<&Figures>| {
            let hashes = figures.and_then(|figures| figures.hashes.clone());
            hashes.map(|hashes| (hashes.session, hashes.nets, hashes.stretches))
        };
        let same = hashes(before.as_ref()) == hashes(Some(&now));
        match &changed {
            None => println!("{} was written", path.display()),
            Some(changed) => println!(
                "{}: {} figures changed{}",
                path.display(),
                changed.len(),
                if same { "" } else { ", and hashes" }
            ),
        }
    }
    Ok(Outcome::Ok)
}

fn print_figures(args: &Args, report: &FiguresReport<'_>) -> anyhow::Result<()> {
    let report_text = serde_json::to_string(report)?;
    if args.json {
        println!("{report_text}");
    } else {
        if let Some(Some(first)) = &report.first_difference {
            println!("first difference in {first}");
        }
        let found = report.deviations.iter();
        found.for_each(|deviation| println!("{deviation}"));
    }
    write_report(args, &report_text)
}
