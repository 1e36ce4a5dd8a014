//! The daemon under faults over many seeds ([`palpate_faults`]): what must not happen, and whether a
//! seed repeats.

use palpate_faults::{Plan, Report, run};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Every so many seeds are run twice.
const TWICE: u64 = 50;

/// Which seeds.
#[derive(clap::Args, Debug)]
pub struct FaultOptions {
    /// How many seeds.
    #[arg(long, default_value_t = 1_000)]
    seeds: u64,
    /// The first.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Seeds at a time [default: the number of cores].
    #[arg(long)]
    jobs: Option<std::num::NonZeroUsize>,
    /// Begin no seed after this long, for example 10m.
    #[arg(long = "for", value_parser = crate::soak::duration)]
    most: Option<Duration>,
    /// Print the faults of each seed that fails, and keep its files.
    #[arg(long)]
    keep: bool,
}

/// What all came to.
#[derive(Default)]
struct Sum {
    done: u64,
    twice: u64,
    most: Report,
    wrong: Vec<String>,
}

/// Runs seeds.
///
/// # Errors
/// A seed came to what must not happen, or to something else the second time.
pub fn faults(options: &FaultOptions) -> anyhow::Result<()> {
    let memory = Path::new("/dev/shm");
    let base = match memory.is_dir() {
        true => memory.to_owned(),
        false => std::env::temp_dir(),
    };
    let base = base.join(format!("palpate-faults-{}", std::process::id()));
    std::fs::create_dir_all(&base)?;
    let jobs = match options.jobs {
        Some(jobs) => jobs.get(),
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    let (next, sum, begun) = (
        AtomicU64::new(0),
        Mutex::new(Sum::default()),
        Instant::now(),
    );
    let over = || options.most.is_some_and(|most| begun.elapsed() > most);
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= options.seeds || over() {
                        return;
                    }
                    take(options, options.from + number, &base, &sum);
                }
            });
        }
    });
    let sum = sum
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    if !options.keep || sum.wrong.is_empty() {
        std::fs::remove_dir_all(&base)?;
    }
    let most = &sum.most;
    println!(
        "{} seeds, {} of them twice, in {:.1} s: {} ticks, {} servo periods, {} daemons, {} packets lost, {} doubled; \
         {} ticks recorded and replayed, at most {} lost by a kill; greatest force {:.3} N; least energy at a controlled port {:.2e} J",
        sum.done,
        sum.twice,
        begun.elapsed().as_secs_f64(),
        most.ticks,
        most.periods,
        most.daemons,
        most.packets[0],
        most.packets[1],
        most.recorded,
        most.most_lost,
        most.peak_force_n,
        most.least_own_j,
    );
    for wrong in &sum.wrong {
        println!("{wrong}");
    }
    anyhow::ensure!(
        sum.wrong.is_empty(),
        "{} of {} seeds came to what must not happen",
        sum.wrong.len(),
        sum.done
    );
    Ok(())
}

fn take(options: &FaultOptions, seed: u64, base: &Path, sum: &Mutex<Sum>) {
    let once = |name: &str| {
        let folder: PathBuf = base.join(format!("{seed}{name}"));
        let _ = std::fs::create_dir_all(&folder);
        let done = run(seed, &folder);
        if done.is_ok() || !options.keep {
            let _ = std::fs::remove_dir_all(&folder);
        }
        done
    };
    let done = once("");
    let again = (seed.is_multiple_of(TWICE)).then(|| once("-again"));
    let mut sum = sum
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    sum.done += 1;
    if let Some(again) = again {
        sum.twice += 1;
        if again != done {
            sum.wrong.push(format!(
                "seed {seed} does not repeat: {done:?}, then {again:?}"
            ));
        }
    }
    match done {
        Ok(report) => add(&mut sum.most, &report),
        Err(violation) => {
            let faults = match options.keep {
                true => format!("\n  {:?}", Plan::of(seed).faults),
                false => String::new(),
            };
            sum.wrong.push(format!("{violation}{faults}"));
        }
    }
}

fn add(most: &mut Report, report: &Report) {
    most.ticks += report.ticks;
    most.periods += report.periods;
    most.daemons += report.daemons;
    most.recorded += report.recorded;
    most.packets[0] += report.packets[0];
    most.packets[1] += report.packets[1];
    most.most_lost = most.most_lost.max(report.most_lost);
    most.peak_force_n = most.peak_force_n.max(report.peak_force_n);
    most.least_own_j = most.least_own_j.min(report.least_own_j);
}
