//! A relay with many who watch: what they cost the daemon, and what each of them receives.
//!
//! ```text
//! daemon ◀─ press ─ device
//!   └─▶ relay ─▶ ten processes ─▶ fifty subscribers each
//! ```
//! Turns with and without subscribers alternate, so that what else the machine does is in both. On a machine
//! with few cores the subscribers also take time from the daemon; `--direct` shows what they would cost
//! without a relay.

use crate::figure::{Bar, Figure, figures_table};
use crate::processes::{Files, Process, connect, free_port, spawn_below};
use palpate::transport::{Role, SessionSettings, open};
use palpate_client::Palpate;
use palpate_proto::keys::Keys;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use zenoh::Wait as _;

const SCENE: &str = include_str!("../../../scenes/teardrop.toml");
/// After subscribers came or went.
const SETTLE: Duration = Duration::from_secs(1);
/// For subscribers to connect, all of them.
const LONGEST_START: Duration = Duration::from_secs(120);
/// The bar of the daemon's tick.
const MOST: f64 = 1.05;

/// How many watch, and for how long.
#[derive(clap::Args, Debug)]
pub struct RelayOptions {
    /// Sessions that watch, each with a connection of its own.
    #[arg(long, default_value_t = 500)]
    subscribers: usize,
    /// Processes that they are spread over.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100))]
    processes: u32,
    /// Turns with subscribers, and as many without.
    #[arg(long, default_value_t = 5)]
    turns: usize,
    /// Length of a turn.
    #[arg(long, value_parser = crate::soak::duration, default_value = "10s")]
    turn: Duration,
    /// Nets a second that the relay passes on, of each body.
    #[arg(long, default_value_t = 10.0)]
    net_hz: f64,
    /// Connect the subscribers to the daemon itself, for comparison.
    #[arg(long)]
    direct: bool,
    /// Print one JSON object per line instead of a table.
    #[arg(long)]
    json: bool,
}

/// Options of one process of subscribers.
#[derive(clap::Args, Debug)]
pub struct SubscriberOptions {
    /// Where they connect.
    #[arg(long)]
    connect: String,
    /// How many.
    #[arg(long)]
    count: usize,
}

/// What the subscribers of a process received between `go` and the end.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
struct Received {
    /// Nets, by subscriber.
    nets: Vec<u64>,
    /// Statuses, by subscriber.
    statuses: Vec<u64>,
    bytes: u64,
}

#[derive(Default)]
struct Counts {
    nets: AtomicU64,
    statuses: AtomicU64,
    bytes: AtomicU64,
}

/// One process: subscribes, says `ready`, counts from the line `go` until its input ends, and prints what
/// came.
///
/// # Errors
/// The endpoint does not let in as many.
pub fn subscribers(options: &SubscriberOptions) -> anyhow::Result<()> {
    let keys = Keys::new("default")?;
    let mut sessions = Vec::new();
    let all: Vec<Arc<Counts>> = (0..options.count).map(|_| Arc::default()).collect();
    for counts in &all {
        let session = open(&SessionSettings {
            connect: vec![options.connect.clone()],
            role: Role::Client,
            ..SessionSettings::default()
        })?;
        let wrong = |error: zenoh::Error| anyhow::anyhow!("{error}");
        for (key, is_net) in [(keys.body_net("*"), true), (keys.status(), false)] {
            let counts = counts.clone();
            let take = move |sample: zenoh::sample::Sample| {
                let counter = if is_net {
                    &counts.nets
                } else {
                    &counts.statuses
                };
                counter.fetch_add(1, Ordering::Relaxed);
                let bytes = sample.payload().len() as u64;
                counts.bytes.fetch_add(bytes, Ordering::Relaxed);
            };
            let subscriber = session.declare_subscriber(key).callback(take);
            subscriber.background().wait().map_err(wrong)?;
        }
        sessions.push(session);
    }
    println!("ready");
    std::io::stdout().flush()?;
    let read = || -> Received {
        let each = |counter: fn(&Counts) -> &AtomicU64| -> Vec<u64> {
            all.iter()
                .map(|counts| counter(counts).load(Ordering::Relaxed))
                .collect()
        };
        Received {
            nets: each(|counts| &counts.nets),
            statuses: each(|counts| &counts.statuses),
            bytes: each(|counts| &counts.bytes).iter().sum(),
        }
    };
    let mut line = String::new();
    std::io::stdin().read_line(&mut line)?;
    let before = read();
    line.clear();
    std::io::stdin().read_line(&mut line)?;
    let after = read();
    let less = |after: Vec<u64>, before: Vec<u64>| {
        after
            .iter()
            .zip(before)
            .map(|(after, before)| after - before)
            .collect()
    };
    let received = Received {
        nets: less(after.nets, before.nets),
        statuses: less(after.statuses, before.statuses),
        bytes: after.bytes - before.bytes,
    };
    println!("{}", serde_json::to_string(&received)?);
    std::io::stdout().flush()?;
    // The end of the process closes hundreds of sessions at once, as the end of a hall's network does.
    std::process::exit(0);
}

/// A process of subscribers, as this program sees it.
struct Crowd {
    child: Child,
    stdout: BufReader<ChildStdout>,
}

impl Drop for Crowd {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Crowd {
    fn start(endpoint: &str, count: usize) -> anyhow::Result<Self> {
        let mut command = Command::new(std::env::current_exe()?);
        command
            .args([
                "subscribers",
                "--connect",
                endpoint,
                "--count",
                &count.to_string(),
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut child = spawn_below(&mut command)?;
        let stdout = child.stdout.take();
        let stdout = stdout.ok_or_else(|| anyhow::anyhow!("a process without output"))?;
        Ok(Self {
            child,
            stdout: BufReader::new(stdout),
        })
    }

    fn line(&mut self) -> anyhow::Result<String> {
        let mut line = String::new();
        self.stdout.read_line(&mut line)?;
        anyhow::ensure!(
            !line.is_empty(),
            "a process of subscribers ended: not all could connect"
        );
        Ok(line)
    }

    fn go(&mut self) -> anyhow::Result<()> {
        let stdin = self.child.stdin.as_mut();
        let stdin = stdin.ok_or_else(|| anyhow::anyhow!("a process without input"))?;
        Ok(writeln!(stdin, "go")?)
    }

    fn end(mut self) -> anyhow::Result<Received> {
        drop(self.child.stdin.take());
        let line = self.line()?;
        Ok(serde_json::from_str(&line)?)
    }
}

/// What was seen in turns of one kind.
#[derive(Default)]
struct Seen {
    /// p99 of the tick in tenths of a second, µs.
    p99_us: Vec<f64>,
    late: u64,
    ticks: u64,
    daemon_s: f64,
    relay_s: f64,
    wall_s: f64,
}

impl Seen {
    /// Mean of the middle half: the figures of a tenth of a second are from bins wider than the bar.
    fn p99_us(&self) -> f64 {
        let mut sorted = self.p99_us.clone();
        sorted.sort_by(f64::total_cmp);
        let middle = &sorted[sorted.len() / 4..sorted.len() - sorted.len() / 4];
        middle.iter().sum::<f64>() / middle.len() as f64
    }
}

struct Bench {
    palpate: Palpate,
    daemon: Process,
    relay: Process,
    turn: Duration,
}

impl Bench {
    /// One turn: watches the daemon.
    fn watch(&self, seen: &mut Seen) -> anyhow::Result<()> {
        let cpu =
            || -> anyhow::Result<[f64; 2]> { Ok([self.daemon.cpu_s()?, self.relay.cpu_s()?]) };
        let (before, begun) = (cpu()?, Instant::now());
        let first = self.palpate.status()?;
        let statuses = self.palpate.statuses()?;
        while begun.elapsed() < self.turn {
            std::thread::sleep(Duration::from_millis(20));
            if let Some(status) = statuses.take() {
                seen.p99_us.push(status.step.p99_ns as f64 * 1e-3);
            }
        }
        let (last, after) = (self.palpate.status()?, cpu()?);
        seen.late += last.late_ticks - first.late_ticks;
        seen.ticks += last.tick - first.tick;
        seen.wall_s += begun.elapsed().as_secs_f64();
        seen.daemon_s += after[0] - before[0];
        seen.relay_s += after[1] - before[1];
        Ok(())
    }
}

/// Measures, and prints what came of it.
///
/// # Errors
/// Something did not start, or not all subscribers could connect.
pub fn relay(options: &RelayOptions) -> anyhow::Result<()> {
    let files = Files::new("relay")?;
    let scene = files.write("teardrop.toml", SCENE)?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let daemon = Process::start(&["serve", &scene, "--listen", &endpoint])?;
    let palpate = connect(&endpoint)?;
    palpate.scene()?;
    let behind = format!("tcp/127.0.0.1:{}", free_port()?);
    let net_hz = options.net_hz.to_string();
    let relay = Process::start(&[
        "relay",
        "--from",
        &endpoint,
        "--listen",
        &behind,
        "--net-hz",
        &net_hz,
        "--read-only",
    ])?;
    drop(connect(&behind)?);
    let _device = Process::pressing(&endpoint)?;
    std::thread::sleep(Duration::from_secs(2));
    let bench = Bench {
        palpate,
        daemon,
        relay,
        turn: options.turn,
    };
    let at = if options.direct { &endpoint } else { &behind };
    let processes = options.processes as usize;
    let (mut with, mut without) = (Seen::default(), Seen::default());
    let (mut nets, mut statuses, mut bytes) = (Vec::new(), Vec::new(), 0);
    let mut slowest_s: f64 = 0.0;
    for _ in 0..options.turns.max(1) {
        std::thread::sleep(SETTLE);
        bench.watch(&mut without)?;
        let begun = Instant::now();
        let mut crowds = Vec::new();
        for k in 0..processes {
            let count =
                options.subscribers / processes + usize::from(k < options.subscribers % processes);
            crowds.push(Crowd::start(at, count)?);
        }
        for crowd in &mut crowds {
            crowd.line()?;
            anyhow::ensure!(
                begun.elapsed() < LONGEST_START,
                "subscribers connect too slowly"
            );
        }
        slowest_s = slowest_s.max(begun.elapsed().as_secs_f64());
        std::thread::sleep(SETTLE);
        crowds.iter_mut().try_for_each(Crowd::go)?;
        bench.watch(&mut with)?;
        for crowd in crowds {
            let received = crowd.end()?;
            nets.extend(received.nets);
            statuses.extend(received.statuses);
            bytes += received.bytes;
        }
    }
    let turn_s = with.wall_s / options.turns.max(1) as f64;
    let rows = figures(
        options,
        &with,
        &without,
        turn_s,
        [&nets, &statuses],
        bytes,
        slowest_s,
    );
    match options.json {
        true => {
            for row in &rows {
                println!("{}", serde_json::to_string(row)?);
            }
        }
        false => print!("{}", figures_table(&rows)),
    }
    Ok(())
}

fn figures(
    options: &RelayOptions,
    with: &Seen,
    without: &Seen,
    turn_s: f64,
    [nets, statuses]: [&[u64]; 2],
    bytes: u64,
    slowest_s: f64,
) -> Vec<Figure> {
    let way = if options.direct { "direct" } else { "relay" };
    let case = format!("{way}/{}", options.subscribers);
    let figure = |method: &str, value, unit, (reference, is), bar, note| Figure {
        suite: "relay",
        case: case.clone(),
        method: method.to_owned(),
        value,
        unit,
        reference,
        reference_is: is,
        bar,
        note,
    };
    let least = |counts: &[u64]| counts.iter().copied().min().unwrap_or(0) as f64 / turn_s;
    let mean =
        |counts: &[u64]| counts.iter().sum::<u64>() as f64 / counts.len().max(1) as f64 / turn_s;
    let (p99, p99_without) = (with.p99_us(), without.p99_us());
    let late = |seen: &Seen| seen.late as f64 / seen.ticks.max(1) as f64;
    let megabytes = bytes as f64 * 1e-6 / with.wall_s;
    vec![
        figure(
            "p99 of the daemon's tick",
            p99,
            "us",
            (p99_without, "without"),
            (!options.direct).then_some(Bar::AtMost(MOST * p99_without)),
            format!(
                "ratio {:.3}; middle half of figures of 100 ms",
                p99 / p99_without
            ),
        ),
        figure(
            "late ticks",
            late(with),
            "1",
            (late(without), "without"),
            None,
            String::new(),
        ),
        figure(
            "cores of the daemon",
            with.daemon_s / with.wall_s,
            "1",
            (without.daemon_s / without.wall_s, "without"),
            None,
            String::new(),
        ),
        figure(
            "cores of the relay",
            with.relay_s / with.wall_s,
            "1",
            (without.relay_s / without.wall_s, "without"),
            None,
            format!("{megabytes:.1} MB/s to all"),
        ),
        figure(
            "nets/s, the least served",
            least(nets),
            "Hz",
            (mean(nets), "mean of all"),
            None,
            format!(
                "{} subscribers in {} turns",
                options.subscribers, options.turns
            ),
        ),
        figure(
            "statuses/s, the least served",
            least(statuses),
            "Hz",
            (mean(statuses), "mean of all"),
            None,
            String::new(),
        ),
        figure(
            "until all have connected",
            slowest_s,
            "s",
            (LONGEST_START.as_secs_f64(), "most"),
            None,
            "the longest of all turns".into(),
        ),
    ]
}
