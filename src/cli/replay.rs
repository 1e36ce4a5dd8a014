//! `palpate replay`: the recorded inputs through the same step.

use super::Outcome;
use super::waiting::Progress;
use crate::recording::{
    Deviation, Figures, ReplayOptions, ReplayReport, Session, Start, deviations, replay_with,
    simulate_figures,
};
use anyhow::Context as _;
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
    /// What to compare: every bit, or the figures in FILE.figures.json within their tolerances.
    #[arg(long, value_enum, default_value_t = Check::Bits)]
    check: Check,
    /// With --check figures: write the figures of this build to FILE.figures.json and print what
    /// changed.
    #[arg(long)]
    bless: bool,
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
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if args.check == Check::Figures {
        let whole = args.from == 0 && args.until.is_none();
        anyhow::ensure!(
            whole,
            "figures cover a whole recording: --from and --until work with --check bits only"
        );
    }
    anyhow::ensure!(
        !args.bless || args.check == Check::Figures,
        "--bless writes figures: add --check figures"
    );
    let session = Session::open(&args.file)?;
    match args.check {
        Check::Bits => bits(args, &session),
        Check::Figures => figures(args, &session),
    }
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

fn figures(
    args: &Args,
    session: &Session,
) -> anyhow::Result<Outcome> {
    let path = Figures::path_for(&args.file);
    let before = if args.bless {
        Figures::read(&path).ok()
    } else {
        Some(Figures::read(&path)?)
    };
    let progress = Progress::begin("ticks", None);
    let (mut now, start) = simulate_figures(session, |done, all| progress.show(done, all))?;
    drop(progress);
    if let Start::Scene { reason } = &start {
        eprintln!(
            "note: the first keyframe does not fit this version ({reason}); the replay started from the scene's initial state"
        );
    }
    if args.bless {
        // Tolerances are of the author: they stay.
        now.tolerances = before
            .as_ref()
            .map_or(now.tolerances, |before| before.tolerances);
        let changed = before.as_ref().map(|before| deviations(before, &now, true));
        if changed.as_ref().is_none_or(|changed| !changed.is_empty()) {
            now.write(&path)?;
        }
        print_figures(args, &now, &start, changed.as_deref().unwrap_or_default())?;
        if !args.json {
            match &changed {
                None => println!("{} was written", path.display()),
                Some(changed) => println!("{}: {} figures changed", path.display(), changed.len()),
            }
        }
        return Ok(Outcome::Ok);
    }
    let found = before.map_or_else(Vec::new, |before| deviations(&before, &now, false));
    print_figures(args, &now, &start, &found)?;
    if !args.json {
        let verdict = if found.is_empty() {
            "all figures are within their tolerances"
        } else {
            "figures deviate"
        };
        println!(
            "{} ticks simulated: {verdict} in {}",
            now.ticks,
            path.display()
        );
    }
    Ok(if found.is_empty() {
        Outcome::Ok
    } else {
        Outcome::Difference
    })
}

fn print_figures(
    args: &Args,
    figures: &Figures,
    start: &Start,
    found: &[Deviation],
) -> anyhow::Result<()> {
    let report_text =
        serde_json::json!({ "figures": figures, "start": start, "deviations": found }).to_string();
    if args.json {
        println!("{report_text}");
    } else {
        found.iter().for_each(|deviation| println!("{deviation}"));
    }
    write_report(args, &report_text)
}
