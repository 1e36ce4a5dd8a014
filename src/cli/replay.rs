//! `palpate replay`: the recorded inputs through the same step.

use super::Outcome;
use crate::recording::{Session, replay};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording.
    file: PathBuf,
    /// Start at the keyframe at or before this tick.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let session = Session::open(&args.file)?;
    let bar = if std::io::IsTerminal::is_terminal(&std::io::stderr()) {
        indicatif::ProgressBar::new(session.ticks.len() as u64)
    } else {
        indicatif::ProgressBar::hidden()
    };
    let report = replay(&session, args.from, |done, all| {
        bar.set_length(all);
        bar.set_position(done);
    })?;
    bar.finish_and_clear();
    if args.json {
        println!("{}", serde_json::to_string(&report)?);
    } else {
        println!(
            "{} of {} ticks matched bit for bit, {} nets; {:.1} x real time; session hash {}",
            report.ticks_matched,
            report.ticks_recorded,
            report.nets_matched,
            report.realtime_factor,
            report.session_hash
        );
        if let Some(difference) = &report.first_difference {
            let ulps = difference.ulps.map_or(String::new(), |ulps| format!(" ({ulps} ULPs apart)"));
            println!(
                "first difference at tick {}: {} was {}, is {}{ulps}",
                difference.tick, difference.field, difference.recorded, difference.replayed
            );
        }
    }
    if !report.same_build {
        eprintln!("note: recorded by another build; equal bits are promised for the same build only");
    }
    if !report.clean || report.gaps > 0 {
        eprintln!("the recording is incomplete: {} ticks missing, finished cleanly: {}", report.gaps, report.clean);
    }
    Ok(match (&report.first_difference, report.clean && report.gaps == 0) {
        (Some(_), _) => Outcome::Difference,
        (None, true) => Outcome::Ok,
        (None, false) => Outcome::Fault,
    })
}
