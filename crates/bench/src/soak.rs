//! A daemon at work for a long time: its memory, descriptors and threads must not grow, and its ticks
//! are as late as a bare timer's.

use crate::processes::{Files, Process, connect, free_port};
use anyhow::Context as _;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_drive::stats::{Histogram, LATE_NS};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const SCENE: &str = include_str!("../../../scenes/teardrop.toml");
/// Until caches and pools are full, share of the time.
const WARM: f64 = 0.25;
/// Growth below this is not told from noise, kB/min; a real leak shows in its multiples.
const MEMORY_NOISE: f64 = 128.0;

/// Files of the recording: each keeps the index of its chunks until it ends, at most 40 kB a minute.
const PARTS: f64 = 12.0;

/// How long.
#[derive(clap::Args, Debug)]
pub struct SoakOptions {
    /// Duration, for example 10m or 1h.
    #[arg(long = "for", value_parser = duration, default_value = "10m")]
    length: Duration,
    /// Between two looks.
    #[arg(long, value_parser = duration, default_value = "1s")]
    every: Duration,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// `10m`, `30s`, `1h`.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3_600.0)];
    let found = units.iter().find_map(|(unit, scale)| {
        let number = text.strip_suffix(unit)?.parse::<f64>().ok()?;
        Some(number * scale)
    });
    match found {
        Some(seconds) if seconds > 0.0 && seconds < 1e7 => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(format!(
            "{text:?} is not a duration; write it as 30s, 10m or 1h"
        )),
    }
}

/// What a process holds.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    minutes: f64,
    rss_kb: f64,
    fds: f64,
    threads: f64,
}

fn held(pid: u32, begun: Instant) -> anyhow::Result<Held> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status"))?;
    let number = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        let first = line.and_then(|line| line.split_whitespace().next());
        let number = first.and_then(|first| first.parse::<f64>().ok());
        number.with_context(|| format!("/proc/{pid}/status has no number for {name:?}"))
    };
    Ok(Held {
        minutes: begun.elapsed().as_secs_f64() / 60.0,
        rss_kb: number("VmRSS:")?,
        fds: std::fs::read_dir(format!("/proc/{pid}/fd"))?.count() as f64,
        threads: number("Threads:")?,
    })
}

/// Slope of a straight line by least squares, and its standard error, a minute.
fn slope(looks: &[Held], of: fn(&Held) -> f64) -> (f64, f64) {
    let n = looks.len() as f64;
    let mean = |f: &dyn Fn(&Held) -> f64| looks.iter().map(f).sum::<f64>() / n;
    let (t, y) = (mean(&|look| look.minutes), mean(&|look| of(look)));
    let spread: f64 = looks
        .iter()
        .map(|look| (look.minutes - t) * (look.minutes - t))
        .sum();
    let slope = looks
        .iter()
        .map(|look| (look.minutes - t) * (of(look) - y))
        .sum::<f64>()
        / spread;
    let rest: f64 = (looks.iter())
        .map(|look| of(look) - y - slope * (look.minutes - t))
        .map(|rest| rest * rest)
        .sum();
    (slope, (rest / (n - 2.0).max(1.0) / spread).sqrt())
}

/// Keeps a daemon, its recorder and a device at work.
///
/// # Errors
/// The daemon ended or held more and more.
pub fn soak(options: &SoakOptions) -> anyhow::Result<()> {
    let files = Files::new("soak")?;
    let scene = files.write("teardrop.toml", SCENE)?;
    let recording = files.path("soak.mcap").display().to_string();
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let part = format!("{}s", options.length.div_f64(PARTS).as_secs().max(1));
    let daemon = Process::start(&[
        "serve",
        &scene,
        "--listen",
        &endpoint,
        "--record",
        &recording,
        "--split-duration",
        &part,
    ])?;
    let palpate = connect(&endpoint)?;
    let length = format!("{}s", options.length.as_secs() + 60);
    let device = [
        "device",
        "--tool",
        "ball",
        "--device",
        "touch",
        "--motion",
        "press",
        "--for",
        &length,
        "--connect",
        &endpoint,
    ];
    let device = Process::start(&device)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let bare = std::thread::spawn(move || bare_timer(&flag));
    let statuses = palpate.statuses()?;
    let (begun, mut looks) = (Instant::now(), Vec::new());
    let mut newest = None;
    while begun.elapsed() < options.length {
        std::thread::sleep(options.every);
        looks.push(held(daemon.id(), begun)?);
        newest = statuses.take().or(newest);
    }
    stop.store(true, Ordering::Relaxed);
    let (timer, late) = bare
        .join()
        .map_err(|_| anyhow::anyhow!("the bare timer panicked"))?;
    drop((device, daemon));
    let status = newest.ok_or_else(|| anyhow::anyhow!("the daemon said nothing of itself"))?;
    let warm = (looks.len() as f64 * WARM) as usize;
    let looks = &looks[warm..];
    anyhow::ensure!(
        looks.len() >= 8,
        "only {} looks: run for longer, or look more often",
        looks.len()
    );
    let (rss, fds, threads) = (
        slope(looks, |look| look.rss_kb),
        slope(looks, |look| look.fds),
        slope(looks, |look| look.threads),
    );
    let share = |late: u64, of: u64| late as f64 / of.max(1) as f64;
    let last = looks[looks.len() - 1];
    if options.json {
        println!(
            "{}",
            serde_json::json!({
                "minutes": last.minutes, "looks": looks.len(), "rss_kb": last.rss_kb, "fds": last.fds, "threads": last.threads,
                "rss_kb_per_min": rss, "fds_per_min": fds, "threads_per_min": threads,
                "ticks": status.tick, "late": share(status.late_ticks, status.tick), "skipped": status.skipped_ticks,
                "bare_late": share(late, timer.count()),
            })
        );
    } else {
        println!(
            "{:.1} min: {:.0} kB ({:+.1} ± {:.1} kB/min), {} descriptors ({:+.3} ± {:.3} /min), {} threads ({:+.3} ± {:.3} /min)\n\
             {} ticks, {:.3} % late, {} skipped; a bare timer: {:.3} % late",
            last.minutes,
            last.rss_kb,
            rss.0,
            rss.1,
            last.fds,
            fds.0,
            fds.1,
            last.threads,
            threads.0,
            threads.1,
            status.tick,
            100.0 * share(status.late_ticks, status.tick),
            status.skipped_ticks,
            100.0 * share(late, timer.count()),
        );
    }
    for (what, (slope, error), noise) in [
        ("memory, kB", rss, MEMORY_NOISE),
        ("descriptors", fds, 0.1),
        ("threads", threads, 0.1),
    ] {
        anyhow::ensure!(
            slope <= noise + 3.0 * error,
            "{what}: grows by {slope:.3} ± {error:.3} a minute"
        );
    }
    Ok(())
}

/// Wakes every ms and does nothing: its lateness, and how often it was as late as a tick that counts so.
fn bare_timer(stop: &AtomicBool) -> (Histogram, u64) {
    let (mut lateness, mut late) = (Histogram::default(), 0);
    let mut due = now_ns() + 1_000_000;
    while !stop.load(Ordering::Relaxed) {
        sleep_until(due);
        let by = now_ns().saturating_sub(due);
        lateness.add(by);
        late += u64::from(by > LATE_NS);
        due += (by / 1_000_000 + 1) * 1_000_000;
    }
    (lateness, late)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leak_has_its_slope_and_noise_has_none() {
        let looks = |leak: f64| -> Vec<Held> {
            (0..600)
                .map(|k| Held {
                    minutes: f64::from(k) / 60.0,
                    rss_kb: 1e5 + leak * f64::from(k) / 60.0 + 50.0 * libm::sin(f64::from(k * k)),
                    ..Held::default()
                })
                .collect()
        };
        let (flat, error) = slope(&looks(0.0), |look| look.rss_kb);
        assert!(flat.abs() < 3.0 * error, "{flat} {error}");
        let (steep, error) = slope(&looks(500.0), |look| look.rss_kb);
        assert!(
            (steep - 500.0).abs() < 3.0 * error && error < 2.0,
            "{steep} {error}"
        );
    }
}
