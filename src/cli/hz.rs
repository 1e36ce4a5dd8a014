//! `palpate hz`: how often messages come, and which do not.

use super::connection::Connection;
use super::{Outcome, text};
use palpate_client::Seen;
use palpate_drive::stats::Histogram;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Key, or short form: status, event, contact, force, pose, net, tool/ball/force, all.
    key: String,
    /// How long to watch, for example 5s; rates of the last second are printed meanwhile, without
    /// --json.
    #[arg(long = "for", value_parser = text::duration, default_value = "5s")]
    duration: Duration,
    /// Print one JSON object per key.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

/// Statistics of one key while it is watched.
#[derive(Default)]
struct KeyRate {
    periods: Histogram,
    first: Option<Instant>,
    last: Option<Instant>,
    messages: u64,
    bytes: u64,
    newest: Option<u64>,
    lost: Option<u64>,
}

/// Printed statistics of one key.
#[derive(Debug, Serialize)]
struct Line {
    key: String,
    messages: u64,
    rate_hz: f64,
    p50_ms: f64,
    p99_ms: f64,
    max_ms: f64,
    bytes_per_s: f64,
    /// Numbers that were skipped; null if messages are not numbered consecutively.
    lost: Option<u64>,
}

impl KeyRate {
    fn add(&mut self, at: Instant, bytes: usize, number: Option<u64>) {
        if let Some(last) = self.last {
            self.periods.add((at - last).as_nanos() as u64);
        }
        self.first.get_or_insert(at);
        self.last = Some(at);
        self.messages += 1;
        self.bytes += bytes as u64;
        if let Some(number) = number {
            let lost = self.lost.get_or_insert(0);
            if let Some(newest) = self.newest {
                *lost += number.saturating_sub(newest.saturating_add(1));
            }
            self.newest = Some(number);
        }
    }

    fn line(&self, key: &str) -> Line {
        let seconds = self
            .first
            .zip(self.last)
            .map_or(0.0, |(first, last)| (last - first).as_secs_f64());
        let per_second = |value: f64| if seconds > 0.0 { value / seconds } else { 0.0 };
        let ms = |ns: u64| ns as f64 * 1e-6;
        Line {
            key: key.to_owned(),
            messages: self.messages,
            rate_hz: per_second(self.messages.saturating_sub(1) as f64),
            p50_ms: ms(self.periods.quantile(0.5)),
            p99_ms: ms(self.periods.quantile(0.99)),
            max_ms: ms(self.periods.max()),
            bytes_per_s: per_second(self.bytes as f64),
            lost: self.lost,
        }
    }
}

/// Between two lines of a key while it is watched.
const SECOND: Duration = Duration::from_secs(1);

/// Prints how many messages came in the last second, by key.
fn now(streams: &BTreeMap<String, KeyRate>, before: &mut BTreeMap<String, u64>) {
    for (key, stream) in streams {
        let known = before.insert(key.clone(), stream.messages).unwrap_or(0);
        println!("{key}: {} Hz now", stream.messages - known);
    }
    if streams.is_empty() {
        println!("no message yet");
    }
}

/// Name of the field that grows by one from message to message, if the type has one.
fn number(seen: &Seen) -> Option<u64> {
    let field = match seen.name()? {
        "palpate.ToolPose.v1" | "palpate.SimEvent.v1" => "seq",
        "palpate.ToolForce.v1" | "palpate.ToolForce.v2" | "palpate.ToolContact.v1" => "tick",
        _ => return None,
    };
    seen.to_json()?[field].as_u64()
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let palpate = args.connection.look_on()?;
    let streams = Arc::new(Mutex::new(BTreeMap::<String, KeyRate>::new()));
    let shared = streams.clone();
    let watching = palpate.watch(&palpate.keys().expand(&args.key), move |seen| {
        let (at, number) = (Instant::now(), number(&seen));
        let mut streams = shared.lock().unwrap_or_else(PoisonError::into_inner);
        streams
            .entry(seen.key)
            .or_default()
            .add(at, seen.bytes.len(), number);
    })?;
    let end = Instant::now() + args.duration;
    let mut before = BTreeMap::<String, u64>::new();
    loop {
        let left = end.saturating_duration_since(Instant::now());
        std::thread::sleep(left.min(SECOND));
        if left <= SECOND {
            break;
        }
        if !args.json {
            now(
                &streams.lock().unwrap_or_else(PoisonError::into_inner),
                &mut before,
            );
        }
    }
    drop(watching);
    let streams = streams.lock().unwrap_or_else(PoisonError::into_inner);
    for (key, stream) in streams.iter() {
        let line = stream.line(key);
        if args.json {
            println!("{}", serde_json::to_string(&line)?);
        } else {
            let lost = line
                .lost
                .map_or(String::new(), |lost| format!(", {lost} lost"));
            println!(
                "{key}: {:.1} Hz, period p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms, {:.1} kB/s, {} messages{lost}",
                line.rate_hz,
                line.p50_ms,
                line.p99_ms,
                line.max_ms,
                line.bytes_per_s * 1e-3,
                line.messages
            );
        }
    }
    if streams.is_empty() {
        eprintln!(
            "no message arrived under {} within {:?}",
            args.key, args.duration
        );
    }
    drop(streams);
    palpate.close();
    Ok(Outcome::Ok)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_losses_are_counted() {
        let mut stream = KeyRate::default();
        let start = Instant::now();
        for (k, number) in [1u64, 2, 5, 6, 6, 3].into_iter().enumerate() {
            stream.add(
                start + Duration::from_millis(10 * k as u64),
                100,
                Some(number),
            );
        }
        let line = stream.line("x");
        assert_eq!((line.messages, line.lost), (6, Some(2)));
        assert!(
            (line.rate_hz - 100.0).abs() < 1e-9 && (line.bytes_per_s - 12_000.0).abs() < 1e-6,
            "{line:?}"
        );
        assert!((9.0..=11.3).contains(&line.p50_ms), "{line:?}");
    }
}
