//! `palpate relay`: a router between a daemon and many who watch.

use super::Outcome;
use crate::auth::Identity;
use crate::relay::{Relay, RelayNews, RelaySettings};
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often the link is looked after.
const LOOK_EVERY: Duration = Duration::from_millis(250);

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Endpoint of the daemon, or of another relay.
    #[arg(long, value_name = "ENDPOINT")]
    from: String,
    /// Endpoint to listen on; can be repeated.
    #[arg(long, value_name = "ENDPOINT", required = true)]
    listen: Vec<String>,
    /// Pass on at most this many control nets a second of each body [default: all].
    #[arg(long, value_name = "HZ")]
    net_hz: Option<f64>,
    /// Let no one behind it move tools, send commands or publish anything.
    #[arg(long)]
    read_only: bool,
    /// Also listen and connect without TLS to other machines: anyone there reads what goes through, and
    /// without --read-only moves tools. With TLS: everybody with a certificate, whatever its role.
    #[arg(long)]
    insecure: bool,
    /// Identity file of a daemon for TLS (see `palpate auth`), of the same authority as that of the daemon.
    #[arg(long, value_name = "FILE")]
    identity: Option<PathBuf>,
    /// Zenoh configuration file, such as the output of `palpate auth rules SCENE`; it changes only what it names.
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    /// End after this long, for example 10m.
    #[arg(long = "for", value_parser = super::text::duration)]
    duration: Option<Duration>,
    /// Print one JSON object per line: ready, lost, back.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    if let Some(identity) = &args.identity {
        Identity::usable(identity)?;
    }
    let mut relay = Relay::open(RelaySettings {
        from: args.from.clone(),
        listen: args.listen.clone(),
        net_hz: args.net_hz,
        read_only: args.read_only,
        insecure: args.insecure,
        identity: args.identity.clone(),
        config: args.zenoh_config.clone(),
    })?;
    let tell = |what: &str| {
        if args.json {
            let line = serde_json::json!({
                what: true, "from": args.from, "listen": args.listen, "read_only": args.read_only, "net_hz": args.net_hz,
            });
            println!("{line}");
            let _ = std::io::stdout().flush();
        } else {
            eprintln!(
                "relay from {} to {}: {what}",
                args.from,
                args.listen.join(", ")
            );
        }
    };
    tell("ready");
    let begun = Instant::now();
    while !stop.load(Ordering::Relaxed) && args.duration.is_none_or(|most| begun.elapsed() < most) {
        std::thread::sleep(LOOK_EVERY);
        match relay.look()? {
            Some(RelayNews::Lost) => tell("lost"),
            Some(RelayNews::Back) => tell("back"),
            None => {}
        }
    }
    relay.close();
    Ok(Outcome::Ok)
}
