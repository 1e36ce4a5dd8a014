//! The viewer suite: what pages cost the loop and the daemon, and how soon they have something to
//! show.
//!
//! A ball presses a body with a net of 20 × 20 while pages come and go, by turns, so that what else
//! the machine does is in both measurements. Pages are sockets that read: what a browser draws is
//! measured in `clients/web/tests/browser.mjs`.

mod socket;

use super::figure::{Bar, Figure};
use super::processes::{Files, Process, connect, free_port};
use super::{Cases, Effort};
use anyhow::ensure;
use palpate_client::Palpate;
use socket::Socket;
use std::time::{Duration, Instant};

const SCENE: &str = r#"
name = "net of 20 x 20"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [20, 20] }
model = "lattice"
lattice = { layers = 1, refine = "none" }
fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
"#;

/// A turn with pages, or without.
const TURN: Duration = Duration::from_secs(3);
/// After pages came or went.
const SETTLE: Duration = Duration::from_millis(300);

/// Runs cases of the suite. Gives the cases that could not be
/// measured, with the reason.
pub fn viewer(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Figure)) -> Vec<String> {
    let mut failed = Vec::new();
    for pages in [1, 3] {
        let case = format!("pages/{pages}");
        if cases.has(&case)
            && let Err(error) = run(&case, pages, effort, out)
        {
            failed.push(format!("{case}: {error:#}"));
        }
    }
    failed
}

/// What was seen in turns of one kind.
#[derive(Default)]
struct Seen {
    /// p99 of the tick in tenths of a second, µs.
    p99_us: Vec<f64>,
    cpu_s: f64,
    wall_s: f64,
    nets: u64,
    bytes: u64,
}

impl Seen {
    /// Mean of the middle half: a single figure is of a bin that is wider than the bar.
    fn p99_us(&mut self) -> f64 {
        self.p99_us.sort_by(f64::total_cmp);
        let count = self.p99_us.len();
        let middle = &self.p99_us[count / 4..count - count / 4];
        middle.iter().sum::<f64>() / middle.len() as f64
    }

    fn cores(&self) -> f64 {
        self.cpu_s / self.wall_s
    }
}

fn run(case: &str, pages: u32, effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let files = Files::new("viewer")?;
    let scene = files.write("scene.toml", SCENE)?;
    let (port, http) = (free_port()?, free_port()?);
    let (endpoint, address) = (format!("tcp/127.0.0.1:{port}"), format!("127.0.0.1:{http}"));
    let daemon = Process::start(&["serve", &scene, "--listen", &endpoint, "--http", &address])?;
    let palpate = connect(&endpoint)?;
    palpate.scene()?;
    let turns = if effort == Effort::Quick { 2 } else { 10 };
    let _device = Process::pressing(&endpoint)?;
    std::thread::sleep(Duration::from_secs(2));
    let (mut with, mut without) = (Seen::default(), Seen::default());
    let mut first_s: f64 = 0.0;
    for _ in 0..turns {
        watch(&palpate, &daemon, Vec::new(), &mut without)?;
        let begun = Instant::now();
        let sockets: Vec<Socket> = (0..pages)
            .map(|_| Socket::open(http))
            .collect::<anyhow::Result<_>>()?;
        for socket in &sockets {
            socket.wait_for_net()?;
        }
        first_s = first_s.max(begun.elapsed().as_secs_f64());
        watch(&palpate, &daemon, sockets, &mut with)?;
    }
    let figure = |method: &str, value, unit, (reference, is), bar, note| Figure {
        suite: "viewer",
        case: case.to_owned(),
        method: method.to_owned(),
        value,
        unit,
        reference,
        reference_is: is,
        bar,
        note,
    };
    ensure!(
        !with.p99_us.is_empty() && !without.p99_us.is_empty(),
        "the daemon told no times of ticks"
    );
    let (p99, p99_without) = (with.p99_us(), without.p99_us());
    let rate = with.nets as f64 / with.wall_s / f64::from(pages);
    let megabytes = with.bytes as f64 * 1e-6 / with.wall_s / f64::from(pages);
    out(figure(
        "p99 of a tick",
        p99,
        "us",
        (p99_without, "without pages"),
        Some(Bar::AtMost(1.05 * p99_without)),
        "middle half of figures of 100 ms".into(),
    ));
    out(figure(
        "cores for pages",
        with.cores() - without.cores(),
        "1",
        (without.cores(), "daemon without pages"),
        (pages == 1).then_some(Bar::AtMost(0.1)),
        format!("{rate:.0} nets/s and {megabytes:.2} MB/s for each page"),
    ));
    out(figure(
        "first net on every page",
        first_s,
        "s",
        (1.0, "bar"),
        Some(Bar::AtMost(1.0)),
        "the longest of all turns; without a browser".into(),
    ));
    Ok(())
}

/// One turn.
fn watch(
    palpate: &Palpate,
    daemon: &Process,
    sockets: Vec<Socket>,
    seen: &mut Seen,
) -> anyhow::Result<()> {
    std::thread::sleep(SETTLE);
    let (before, begun) = (daemon.cpu_s()?, Instant::now());
    let counted = |sockets: &[Socket]| {
        let counts = sockets.iter().map(Socket::counts);
        counts.fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    };
    let first = counted(&sockets);
    let statuses = palpate.statuses()?;
    while begun.elapsed() < TURN {
        std::thread::sleep(Duration::from_millis(20));
        if let Some(status) = statuses.take() {
            seen.p99_us.push(status.step.p99_ns as f64 * 1e-3);
        }
    }
    let last = counted(&sockets);
    seen.wall_s += begun.elapsed().as_secs_f64();
    seen.cpu_s += daemon.cpu_s()? - before;
    seen.nets += last.0 - first.0;
    seen.bytes += last.1 - first.1;
    Ok(())
}
