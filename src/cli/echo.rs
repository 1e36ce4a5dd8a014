//! `palpate echo`: messages of the bus as they pass.

use super::connection::Connection;
use super::{Outcome, text};
use palpate_client::Seen;
use palpate_proto::messages::force_flags;
use palpate_proto::text::printable;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Key, or short form: status, event, contact, force, pose, net, tool/ball/force, all.
    key: String,
    /// Stop after this many messages.
    #[arg(long)]
    count: Option<u64>,
    /// Stop after this long, for example 5s.
    #[arg(long = "for", value_parser = text::duration)]
    duration: Option<Duration>,
    /// Print one JSON object per line.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

/// Messages that can wait to be printed; further ones are dropped and counted.
const QUEUE: usize = 4096;
/// Bytes shown of a message of unknown type.
const SHOWN_BYTES: usize = 48;

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let palpate = args.connection.look_on()?;
    let (sender, messages) = sync_channel(QUEUE);
    let missed = std::sync::Arc::new(std::sync::atomic::AtomicU64::new(0));
    let counter = missed.clone();
    let watching = palpate.watch(&palpate.keys().expand(&args.key), move |seen| {
        if sender.try_send(seen).is_err() {
            counter.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        }
    })?;
    let end = args.duration.map(|duration| Instant::now() + duration);
    let mut shown = 0;
    while args.count.is_none_or(|most| shown < most) {
        let left = end.map_or(Duration::from_secs(3600), |end| {
            end.saturating_duration_since(Instant::now())
        });
        match messages.recv_timeout(left) {
            Ok(seen) => {
                // Whoever reads may have gone, as `head` does.
                if !print(&seen, args.json) {
                    break;
                }
                shown += 1;
            }
            Err(RecvTimeoutError::Timeout) if end.is_none() => {}
            Err(_) => break,
        }
    }
    drop(watching);
    let missed = missed.load(std::sync::atomic::Ordering::Relaxed);
    if missed > 0 {
        eprintln!(
            "{missed} messages were dropped because they arrived faster than they could be printed"
        );
    }
    palpate.close();
    Ok(Outcome::Ok)
}

fn print(seen: &Seen, as_json: bool) -> bool {
    use std::io::Write as _;
    let line = if as_json {
        in_json(seen).to_string()
    } else {
        printable(&in_words(seen)).into_owned()
    };
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").and_then(|()| out.flush()).is_ok()
}

fn hex(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// Writes the flags of a force by their names; bits without one stay a number.
fn name_flags(seen: &Seen, value: &mut Value) {
    let Some(bits) = value["flags"].as_u64().filter(|_| {
        let name = seen.name();
        name.is_some_and(|name| name.starts_with("palpate.ToolForce."))
    }) else {
        return;
    };
    let all = force_flags::NAMES.iter();
    let known = (all.clone()).filter(|(bit, _)| bits & u64::from(*bit) != 0);
    let mut names: Vec<Value> = known.map(|(_, name)| (*name).into()).collect();
    let rest = all.fold(bits, |rest, (bit, _)| rest & !u64::from(*bit));
    if rest != 0 {
        names.push(rest.into());
    }
    value["flags"] = names.into();
}

/// A known message has `type` and `value`; any other its `encoding` and `hex`.
pub fn in_json(seen: &Seen) -> Value {
    match seen.to_json() {
        Some(value) => json!({ "key": seen.key, "type": seen.name(), "value": value }),
        None => json!({ "key": seen.key, "encoding": seen.encoding, "hex": hex(&seen.bytes) }),
    }
}

fn in_words(seen: &Seen) -> String {
    match seen.to_json() {
        Some(mut value) => {
            name_flags(seen, &mut value);
            format!("{} {} {value}", seen.key, seen.name().unwrap_or_default())
        }
        None => {
            let some = &seen.bytes[..seen.bytes.len().min(SHOWN_BYTES)];
            let more = if some.len() < seen.bytes.len() {
                "…"
            } else {
                ""
            };
            format!(
                "{} [{}] {} bytes: {}{more}",
                seen.key,
                seen.encoding,
                seen.bytes.len(),
                hex(some)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_messages_are_shown_as_bytes_with_their_encoding() {
        let foreign = Seen {
            key: "palpate/default/x".into(),
            encoding: "text/plain".into(),
            bytes: vec![0xab; 60],
        };
        assert_eq!(in_json(&foreign)["hex"].as_str().unwrap().len(), 120);
        assert!(in_words(&foreign).starts_with("palpate/default/x [text/plain] 60 bytes: abab"));
        let broken = Seen {
            key: "palpate/default/status".into(),
            encoding: "zenoh/bytes".into(),
            bytes: vec![1],
        };
        assert_eq!(
            in_json(&broken),
            json!({"key": broken.key, "encoding": "zenoh/bytes", "hex": "01"})
        );
    }
}
