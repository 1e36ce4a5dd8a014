//! `palpate doctor`: what this machine allows.

use super::{Outcome, text};
use crate::tick::pacer::{ask_privileges, now_ns, sleep_until};
use crate::tick::stats::Histogram;
use serde_json::json;
use std::net::TcpListener;
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// How long to measure the timer.
    #[arg(long = "for", value_parser = text::duration, default_value = "2s")]
    duration: Duration,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let ticks = (args.duration.as_secs_f64() * 1e3) as u64;
    // A thread of its own: what it is granted ends with it.
    let (privileges, plain, asked) = std::thread::spawn(move || {
        let plain = lateness(ticks);
        let privileges = ask_privileges();
        (privileges, plain, lateness(ticks))
    })
    .join()
    .map_err(|_| anyhow::anyhow!("the measuring thread panicked"))?;
    let port_free = TcpListener::bind("127.0.0.1:7447").is_ok();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let us = |h: &Histogram, q: f64| h.quantile(q) as f64 * 1e-3;
    if args.json {
        let figures =
            |h: &Histogram| json!({ "p50_us": us(h, 0.5), "p99_us": us(h, 0.99), "max_us": h.max() as f64 * 1e-3 });
        let report = json!({
            "cores": cores, "sched_fifo": privileges.fifo, "mlockall": privileges.locked, "timer_slack": privileges.slack,
            "lateness_plain": figures(&plain), "lateness_asked": figures(&asked), "port_7447_free": port_free,
        });
        println!("{report}");
    } else {
        let granted = |yes: bool| if yes { "granted" } else { "refused (the loop runs without)" };
        println!("cores                    {cores}");
        println!("SCHED_FIFO               {}", granted(privileges.fifo));
        println!("mlockall                 {}", granted(privileges.locked));
        println!("timer slack of 1 ns      {}", granted(privileges.slack));
        for (name, h) in [("1 kHz timer, as it is", &plain), ("1 kHz timer, having asked", &asked)] {
            println!(
                "{name:<25}late by p50 {:.0} us, p99 {:.0} us, max {:.0} us",
                us(h, 0.5),
                us(h, 0.99),
                h.max() as f64 * 1e-3
            );
        }
        println!(
            "port 7447                {}",
            if port_free { "free" } else { "taken: use --listen tcp/127.0.0.1:PORT" }
        );
    }
    Ok(Outcome::Ok)
}

fn lateness(ticks: u64) -> Histogram {
    let mut histogram = Histogram::default();
    let mut due = now_ns();
    for _ in 0..ticks {
        due += 1_000_000;
        sleep_until(due);
        let now = now_ns();
        histogram.add(now.saturating_sub(due));
        due = due.max(now.saturating_sub(1_000_000));
    }
    histogram
}
