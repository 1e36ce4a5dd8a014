//! `palpate lobby`: who asks for a scene gets a daemon of its own.

use super::{Outcome, text};
use crate::auth::Identity;
use crate::fleet::{Lobby, LobbySettings};
use std::io::Write as _;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Address for requests over HTTP; port 0 is any free one.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:7440")]
    http: SocketAddr,
    /// A name under which it may be asked, beside numbers and localhost; can be repeated.
    #[arg(long, value_name = "NAME")]
    http_host: Vec<String>,
    /// Offer the scene files (*.toml) of this folder too.
    #[arg(long, value_name = "DIR")]
    scenes: Option<PathBuf>,
    /// Sessions at a time [default: the number of cores].
    #[arg(long, value_name = "N")]
    max: Option<usize>,
    /// End a session when no client has held a tool of it for this long.
    #[arg(long, default_value = "10m", value_parser = text::duration)]
    idle_timeout: Duration,
    /// Endpoint on which each daemon listens, its port 0 [default: tcp/127.0.0.1:0, with --identity
    /// tls/127.0.0.1:0].
    #[arg(short, long, value_name = "ENDPOINT")]
    listen: Option<String>,
    /// Identity file of the daemons for TLS (see `palpate auth`).
    #[arg(long, value_name = "FILE")]
    identity: Option<PathBuf>,
    /// Name or address under which clients reach the daemons, where it is not that of --listen.
    #[arg(long, value_name = "HOST")]
    host: Option<String>,
    /// Also listen where everybody on the network can start sessions, move tools and give commands.
    #[arg(long)]
    insecure: bool,
    /// End after this long, for example 10m.
    #[arg(long = "for", value_parser = text::duration)]
    duration: Option<Duration>,
    /// Print one JSON object when requests are taken.
    #[arg(long)]
    json: bool,
    /// Further options of each daemon (see `palpate serve`), after --.
    #[arg(last = true, value_name = "SERVE OPTIONS")]
    serve: Vec<String>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let max = args.max.unwrap_or(cores);
    let listen = args.listen.clone().unwrap_or_else(|| {
        let protocol = if args.identity.is_some() {
            "tls"
        } else {
            "tcp"
        };
        format!("{protocol}/127.0.0.1:0")
    });
    // Better now than by each daemon.
    if let Some(identity) = &args.identity {
        Identity::usable(identity)?;
    }
    let lobby = Lobby::open(LobbySettings {
        http: args.http,
        http_hosts: args.http_host.clone(),
        scenes: args.scenes.clone(),
        max,
        idle_timeout: args.idle_timeout,
        listen,
        identity: args.identity.clone(),
        host: args.host.clone(),
        insecure: args.insecure,
        serve: args.serve.clone(),
    })?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    if let Some(duration) = args.duration {
        let flag = stop.clone();
        std::thread::spawn(move || {
            std::thread::sleep(duration);
            flag.store(true, Ordering::Relaxed);
        });
    }
    let url = lobby.url();
    if args.json {
        let pid = std::process::id();
        println!(
            "{}",
            serde_json::json!({ "ready": true, "http": url, "max": max, "pid": pid })
        );
        let _ = std::io::stdout().flush();
    } else {
        let plural = if max == 1 { "" } else { "s" };
        eprintln!("lobby: {url} (at most {max} session{plural})");
    }
    // On this thread, which lasts as long as the program: daemons end with it.
    lobby.run(&stop);
    Ok(Outcome::Ok)
}
