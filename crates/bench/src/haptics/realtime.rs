//! How punctual the loop is beside a bare timer, and how long a pose takes to its force beside a
//! bare ping.

use super::processes::{Files, Process, Servo, connect, free_port};
use super::{Bar, Figure};
use crate::Effort;
use palpate_client::raw_ping;
use palpate_drive::driver::{self, DriverReport, DriverSettings};
use palpate_drive::journal::NoJournal;
use palpate_drive::pacer::{Schedule, ask_privileges, now_ns, sleep_until};
use palpate_drive::ports::{SenderId, ports};
use palpate_drive::stats::{Histogram, LATE_NS, StageHistograms};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::spec::Clock;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::stage::Stage;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The scene of the bars: a soft teardrop with as many nodes as fill a tick.
const TEARDROP: &str = include_str!("../../../../scenes/teardrop.toml");

pub(super) fn run(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Figure),
    failed: &mut Vec<String>,
) {
    for client in &CLIENTS {
        if wanted(client.case) {
            let seconds = if effort == Effort::Quick { 2 } else { 10 };
            match latency(client, seconds) {
                Ok(figures) => figures.into_iter().for_each(&mut *out),
                Err(error) => failed.push(format!("{}: {error:#}", client.case)),
            }
        }
    }
    for loop_ in &LOOPS {
        if wanted(loop_.case) {
            let seconds = if effort == Effort::Quick { 5 } else { 60 };
            match lateness(loop_, seconds) {
                Ok(figures) => figures.into_iter().for_each(&mut *out),
                Err(error) => failed.push(format!("{}: {error:#}", loop_.case)),
            }
        }
    }
}

/// A client that sends poses to a rigid wall by its own clock, and what it asks of the daemon.
struct Client {
    case: &'static str,
    every: Duration,
    rate_hz: u32,
    serve: &'static [&'static str],
    /// What the median and the 99th percentile may be above those of the ping, s.
    above_s: Option<[f64; 2]>,
}

const FOLLOWED_S: Option<[f64; 2]> = Some([0.15e-3, 0.4e-3]);
const CLIENTS: [Client; 4] = [
    Client {
        case: "latency/pose-force/followed",
        every: Duration::from_micros(1_000),
        rate_hz: 1_000,
        serve: &[],
        above_s: FOLLOWED_S,
    },
    Client {
        case: "latency/pose-force/fixed-phase",
        every: Duration::from_micros(1_000),
        rate_hz: 1_000,
        serve: &["--fixed-phase"],
        above_s: None,
    },
    // Not a multiple of the tick, so that poses come at every phase of it.
    Client {
        case: "latency/pose-force/any-phase",
        every: Duration::from_micros(1_370),
        rate_hz: 1_000,
        serve: &[],
        above_s: Some([0.55e-3, 1.05e-3]),
    },
    Client {
        case: "latency/pose-force/4kHz",
        every: Duration::from_micros(250),
        rate_hz: 4_000,
        serve: &[],
        above_s: FOLLOWED_S,
    },
];

/// A scene in real time, its first tools at work, and what its ticks may take.
struct Loop {
    case: &'static str,
    scene: fn() -> String,
    /// Where the balls first touch, along x, m.
    touch_m: f64,
    rate_hz: u64,
    /// 99th percentile of the time from the latch to the end of a tick, s.
    tick_s: Option<f64>,
    /// Median and 99th percentile of the time from the latch to the force, s.
    force_s: Option<[f64; 2]>,
}

const LOOPS: [Loop; 4] = [
    Loop {
        case: "lateness/realtime",
        scene: || TEARDROP.to_owned(),
        touch_m: 0.0274,
        rate_hz: 1_000,
        tick_s: None,
        force_s: Some([0.12e-3, 0.2e-3]),
    },
    Loop {
        case: "rate/4000/rigid, 8 tools",
        scene: eight_tools,
        touch_m: 0.0204,
        rate_hz: 4_000,
        tick_s: Some(0.2e-3),
        force_s: None,
    },
    Loop {
        case: "rate/4000/teardrop, every = 4",
        scene: || at_4_khz("continuum"),
        touch_m: 0.0274,
        rate_hz: 4_000,
        tick_s: Some(0.2e-3),
        force_s: None,
    },
    Loop {
        case: "rate/4000/net, every = 4",
        scene: || at_4_khz("net"),
        touch_m: 0.0274,
        rate_hz: 4_000,
        tick_s: Some(0.2e-3),
        force_s: None,
    },
];

const RATE_4_KHZ: &str = "[loop]\nrate_hz = 4000\n";

/// Balls around a rigid teardrop.
fn eight_tools() -> String {
    let mut text = format!(
        "{RATE_4_KHZ}[[body]]\nid = \"drop\"\nsurface = {{ builtin = \"teardrop\", net = [8, 8] }}\n"
    );
    for k in 0..8 {
        text += &format!(
            "[[tool]]\nid = \"ball{k}\"\nshape = {{ sphere = {{ radius_m = 0.003 }} }}\npose = {{ position = [0.06, {:?}, 0.045] }}\n",
            0.002 * f64::from(k) - 0.004
        );
    }
    text
}

/// The main scene at 4 kHz, its body stepping a thousand times a second beside the loop.
fn at_4_khz(model: &str) -> String {
    let body = format!("model = \"{model}\"\nintegrator = {{ every = 4 }}");
    format!("{TEARDROP}{RATE_4_KHZ}").replace("model = \"continuum\"", &body)
}

fn figure(
    case: &str,
    method: &str,
    value: f64,
    unit: &'static str,
    reference: (f64, &'static str),
) -> Figure {
    Figure {
        suite: "haptics",
        case: case.to_owned(),
        method: method.to_owned(),
        value,
        unit,
        reference: reference.0,
        reference_is: reference.1,
        bar: None,
        note: String::new(),
    }
}

fn latency(client: &Client, seconds: u64) -> anyhow::Result<Vec<Figure>> {
    let files = Files::new("latency")?;
    let wall = super::rig::wall(1_000.0, 1.0, "");
    let rate = format!("[loop]\nrate_hz = {}\n", client.rate_hz);
    let scene = files.write("wall.toml", &(rate + &wall))?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let daemon =
        Process::start(&[&["serve", &scene, "--listen", &endpoint], client.serve].concat())?;
    let palpate = connect(&endpoint)?;
    // A second to be seated, and to be followed.
    let first = (1.0 / client.every.as_secs_f64()) as usize;
    let servo = Servo {
        every: client.every,
        first,
        count: first * seconds as usize,
    };
    let count = servo.count;
    let place = |k: usize| [0.0, 0.0, 0.001 * libm::cos(k as f64 * 0.01)];
    let (times, _) = servo.run(palpate.tool("tip")?, place)?;
    palpate.close();
    drop(daemon);
    let ping = raw_ping(free_port()?, count.min(3_000), client.every)?;
    let quantile = |q: f64| times[((times.len() - 1) as f64 * q) as usize];
    let raw = |q: f64| ping.quantile(q) as f64 * 1e-9;
    let lost = count - times.len();
    let note = format!("{} round trips, {lost} without answer", times.len());
    let row = |k: usize, method: &str, q: f64| Figure {
        bar: client
            .above_s
            .map(|above_s| Bar::AtMost(raw(q) + above_s[k])),
        note: if k == 0 { note.clone() } else { String::new() },
        ..figure(client.case, method, quantile(q), "s", (raw(q), "raw Zenoh"))
    };
    Ok(vec![row(0, "median", 0.5), row(1, "p99", 0.99)])
}

fn lateness(loop_: &Loop, seconds: u64) -> anyhow::Result<Vec<Figure>> {
    let ticks = seconds * loop_.rate_hz;
    let bare = bare_timer(ticks, 1_000_000_000 / loop_.rate_hz)?;
    let report = loop_at_work(&(loop_.scene)(), loop_.touch_m, ticks)?;
    let share = |late: u64, of: u64| 1.0 - late as f64 / of.max(1) as f64;
    let us = |h: &Histogram, q: f64| h.quantile(q) as f64 * 1e-3;
    let StageHistograms { stages, whole } = &report.stages;
    let note = format!(
        "{} ticks; late by p50 {:.0} µs, p99 {:.0} µs, max {:.0} µs; bare timer {:.0}, {:.0}, {:.0} µs; whole tick p50 {:.0} µs, p99 {:.0} µs; FIFO {}",
        report.ticks,
        us(&report.lateness, 0.5),
        us(&report.lateness, 0.99),
        report.lateness.max() as f64 * 1e-3,
        us(&bare.lateness, 0.5),
        us(&bare.lateness, 0.99),
        bare.lateness.max() as f64 * 1e-3,
        us(whole, 0.5),
        us(whole, 0.99),
        if report.privileges.fifo {
            "granted"
        } else {
            "refused"
        },
    );
    let row = |method: &str, value: f64, unit, reference, bar| Figure {
        bar,
        ..figure(loop_.case, method, value, unit, reference)
    };
    let on_time = share(report.late, report.ticks);
    let bare_on_time = share(bare.late, bare.lateness.count());
    // A loop is as punctual as the timer that wakes it.
    let least = bare_on_time.min(0.999);
    let reference = (bare_on_time, "bare timer");
    let punctual = loop_.tick_s.is_none().then_some(Bar::AtLeast(least));
    let mut rows = vec![Figure {
        note,
        ..row("ticks within 100 µs", on_time, "1", reference, punctual)
    }];
    let (skipped, bare_skipped) = (report.skipped as f64, bare.skipped as f64);
    let most = Some(Bar::AtMost(bare_skipped));
    rows.push(row(
        "deadlines skipped",
        skipped,
        "1",
        (bare_skipped, "bare timer"),
        most,
    ));
    let s = |h: &Histogram, q: f64| h.quantile(q) as f64 * 1e-9;
    let period = (1.0 / loop_.rate_hz as f64, "period");
    if let Some(most_s) = loop_.tick_s {
        let most = Some(Bar::AtMost(most_s));
        rows.push(row("tick, p99", s(whole, 0.99), "s", period, most));
    }
    if let Some(most_s) = loop_.force_s {
        for ((name, q), most_s) in [
            ("latch to force, median", 0.5),
            ("latch to force, p99", 0.99),
        ]
        .into_iter()
        .zip(most_s)
        {
            let most = Some(Bar::AtMost(most_s));
            rows.push(row(name, s(&stages[Stage::Render], q), "s", period, most));
        }
    }
    Ok(rows)
}

/// What a timer does that has nothing else to do.
struct BareTimer {
    lateness: Histogram,
    late: u64,
    skipped: u64,
}

/// Sleeps from deadline to deadline.
fn bare_timer(ticks: u64, period_ns: u64) -> anyhow::Result<BareTimer> {
    // A thread of its own: what it is granted ends with it.
    let thread = std::thread::spawn(move || {
        ask_privileges();
        let mut timer = BareTimer {
            lateness: Histogram::default(),
            late: 0,
            skipped: 0,
        };
        let mut schedule = Schedule::new(period_ns, now_ns());
        for _ in 0..ticks {
            sleep_until(schedule.next_ns());
            let wake = schedule.wake(now_ns());
            timer.lateness.add(wake.late_ns);
            timer.late += u64::from(wake.late_ns > LATE_NS);
            timer.skipped += u64::from(wake.skipped);
        }
        timer
    });
    thread
        .join()
        .map_err(|_| anyhow::anyhow!("the timer's thread panicked"))
}

/// A scene with its tools pressed 0.2 to 3.7 mm deep, over and over.
fn loop_at_work(text: &str, touch_m: f64, ticks: u64) -> anyhow::Result<DriverReport> {
    let loaded = file::parse(text, "scene.toml", Path::new("."))?;
    let scene = Arc::new(Scene::build(&loaded.spec, Path::new("."))?);
    let (tick_ports, mut bus_ports) = ports(&scene);
    let settings = DriverSettings {
        clock: Clock::Realtime,
        ticks: Some(ticks),
        privileged: true,
        follow: true,
        threads: usize::MAX,
    };
    let starts: Vec<_> = loaded
        .spec
        .tools
        .iter()
        .map(|tool| tool.pose.position)
        .collect();
    let pause = Duration::from_secs_f64(0.97 * scene.dt_s);
    let dt_s = scene.dt_s;
    let driver = driver::start(scene, tick_ports, Box::new(NoJournal), settings)?;
    let mut seq = 0;
    while !driver.is_finished() {
        std::thread::sleep(pause);
        seq += 1;
        let t = seq as f64 * dt_s;
        let deep = 2e-4 + 3.5e-3 * (0.5 - 0.5 * libm::cos(2.0 * t));
        let x = touch_m - deep + 0.01 * libm::exp(-10.0 * t);
        for (inbox, start) in bus_ports.poses.iter().zip(&starts) {
            let pose = DevicePose {
                seq,
                ..DevicePose::at_rest([x, start[1], start[2]])
            };
            inbox.offer(pose, SenderId::default());
        }
        while bus_ports.outputs.pop().is_ok() {}
        while bus_ports.records.pop().is_ok() {}
        bus_ports.nets.iter_mut().for_each(|net| drop(net.newest()));
    }
    driver
        .join()
        .map_err(|_| anyhow::anyhow!("the tick thread panicked"))
}
