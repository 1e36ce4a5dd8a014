//! `palpate batch`: many runs of a scene, over its values, motions and seeds.

use super::Outcome;
use super::waiting::Progress;
use anyhow::Context as _;
use palpate_experiment::batch::{Cache, Format, Settings, Sweep, Table};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

/// Without a terminal: a line at most this often.
const LINE: Duration = Duration::from_secs(5);

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 every run was made, 2 the sweep cannot be run, 3 runs failed (their rows say why)."
)]
pub struct Args {
    /// Sweep: a TOML file with the scene, what varies, motions and seeds (docs/batch.md).
    sweep: PathBuf,
    /// Runs at a time [default: the number of cores].
    #[arg(long)]
    jobs: Option<NonZeroUsize>,
    /// Only part I of N, for example 1/4: what the parts come to together is what all come to.
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "1/1")]
    shard: (usize, usize),
    /// Results: .csv, .json or .parquet; can be repeated.
    #[arg(
        short,
        long = "output",
        value_name = "FILE",
        required_unless_present = "list"
    )]
    output: Vec<PathBuf>,
    /// Keep what runs come to in this folder, and take from it what is known [default: the user's
    /// cache folder].
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Make every run anew, and keep nothing.
    #[arg(long)]
    no_cache: bool,
    /// Write the wall time of each run too; results are then not the same twice.
    #[arg(long)]
    timings: bool,
    /// Print the runs of the shard with their values, and run none.
    #[arg(long)]
    list: bool,
    /// Print one JSON object with counts and times.
    #[arg(long)]
    json: bool,
}

/// `1/4`.
fn shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/');
    let parts = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((i, n)) if (1..=n).contains(&i) => Ok((i, n)),
        _ => Err(format!("{text:?} is not a part: write 1/4 to 4/4")),
    }
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let sweep = Sweep::load(&args.sweep)?;
    let plan = sweep.plan();
    // An unknown file type is refused before hours of work.
    let formats = args.output.iter().map(|path| Format::of(path));
    let formats = formats.collect::<Result<Vec<_>, _>>()?;
    for path in &args.output {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder {
            anyhow::ensure!(folder.is_dir(), "{}: no such folder", folder.display());
        }
    }
    let jobs = match args.jobs {
        Some(jobs) => jobs.get(),
        None => std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
    };
    if args.list {
        for run in (0..plan.count()).filter(|run| run % args.shard.1 == args.shard.0 - 1) {
            let case = plan.case(run);
            let values = plan.keys().zip(&case.values);
            let values: Vec<String> = values
                .map(|(key, value)| format!("{key} = {value}"))
                .collect();
            println!(
                "{run} motion = {:?} seed = {} {}",
                plan.motion_name(case.motion),
                case.seed,
                values.join(" ")
            );
        }
        return Ok(Outcome::Ok);
    }
    let cache = match (&args.cache, args.no_cache) {
        (_, true) => None,
        (Some(folder), false) => Some(Cache::at(folder)),
        (None, false) => Some(Cache::of_user().context(
            "no folder for the cache: set HOME or XDG_CACHE_HOME, name one with --cache, or use --no-cache",
        )?),
    };
    let settings = Settings {
        jobs,
        shard: args.shard,
        cache,
    };
    let progress = Progress::begin("runs", Some(LINE));
    let batch = sweep.run(&settings, |done, all| {
        progress.show(done as u64, all as u64)
    });
    drop(progress);
    let table = Table::new(plan, &batch.rows, args.timings);
    for (path, format) in args.output.iter().zip(formats) {
        table.write(path, format)?;
    }
    let (count, failed) = (batch.rows.len(), batch.failed());
    let (took_s, busy_s) = (batch.took.as_secs_f64(), batch.busy.as_secs_f64());
    if args.json {
        println!(
            "{}",
            serde_json::json!({
                "runs": count, "cached": batch.cached, "failed": failed, "jobs": jobs,
                "wall_s": took_s, "busy_s": busy_s,
            })
        );
    } else {
        println!(
            "{count} runs, {} of them known, {failed} failed: {took_s:.2} s with {jobs} jobs, {:.1} runs/s, jobs busy {:.0} %",
            batch.cached,
            count as f64 / took_s.max(1e-9),
            100.0 * busy_s / (took_s * jobs as f64).max(1e-9),
        );
    }
    if let Some(row) = batch.rows.iter().find(|row| row.outcome.error.is_some()) {
        let error = row.outcome.error.as_deref().unwrap_or_default();
        eprintln!("{failed} runs failed; run {} first: {error}", row.case.run);
        return Ok(Outcome::Fault);
    }
    Ok(Outcome::Ok)
}
