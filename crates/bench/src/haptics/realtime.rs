//! How punctual the loop is beside a bare timer, and how long a pose takes to its force beside a
//! bare ping.

use super::processes::{Files, Process, connect, free_port};
use super::{Bar, Figure};
use crate::Effort;
use palpate_client::{pose_at, raw_ping};
use palpate_drive::driver::{self, DriverReport, DriverSettings};
use palpate_drive::journal::NoJournal;
use palpate_drive::pacer::{ask_privileges, now_ns, sleep_until};
use palpate_drive::ports::{SenderId, ports};
use palpate_drive::stats::{Histogram, LATE_NS};
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::spec::Clock;
use palpate_sim::scene::{Scene, file};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The scene of the bars: a soft teardrop with as many nodes as fill a tick.
const TEARDROP: &str = include_str!("../../../../scenes/teardrop.toml");

pub(super) fn run(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Figure),
    failed: &mut Vec<String>,
) {
    if wanted("latency/pose-force") {
        match latency(if effort == Effort::Quick {
            1_000
        } else {
            10_000
        }) {
            Ok(figures) => figures.into_iter().for_each(&mut *out),
            Err(error) => failed.push(format!("latency/pose-force: {error:#}")),
        }
    }
    if wanted("lateness/realtime") {
        let seconds = if effort == Effort::Quick { 5 } else { 60 };
        match lateness(seconds) {
            Ok(figures) => figures.into_iter().for_each(&mut *out),
            Err(error) => failed.push(format!("lateness/realtime: {error:#}")),
        }
    }
}

fn figure(
    case: &str,
    method: &str,
    value: f64,
    unit: &'static str,
    reference: (f64, &'static str),
    bar: Bar,
) -> Figure {
    Figure {
        suite: "haptics",
        case: case.to_owned(),
        method: method.to_owned(),
        value,
        unit,
        reference: reference.0,
        reference_is: reference.1,
        bar: Some(bar),
        note: String::new(),
    }
}

fn latency(count: usize) -> anyhow::Result<Vec<Figure>> {
    let files = Files::new("latency")?;
    let scene = files.write("wall.toml", &super::rig::wall(1_000.0, 1.0, ""))?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let daemon = Process::start(&["serve", &scene, "--listen", &endpoint])?;
    let palpate = connect(&endpoint)?;
    let mut tool = palpate.tool("tip")?;
    let mut times = Vec::with_capacity(count);
    // Not a multiple of the tick, so that poses come at every phase of it.
    let pause = Duration::from_micros(1_370);
    for k in 0..count + 200 {
        std::thread::sleep(pause);
        let z = 0.001 * libm::cos(k as f64 * 0.01);
        let sent = Instant::now();
        let seq = tool.send(pose_at([0.0, 0.0, z]))?;
        if tool.wait_force(seq, Duration::from_millis(100)).is_some() && k >= 200 {
            times.push(sent.elapsed().as_secs_f64());
        }
    }
    drop(tool);
    palpate.close();
    drop(daemon);
    anyhow::ensure!(!times.is_empty(), "no force came back");
    times.sort_by(f64::total_cmp);
    let ping = raw_ping(free_port()?, count.min(3_000), pause)?;
    let quantile = |q: f64| times[((times.len() - 1) as f64 * q) as usize];
    let raw = |q: f64| ping.quantile(q) as f64 * 1e-9;
    let lost = count - times.len();
    let note = format!("{} round trips, {lost} without answer", times.len());
    let row = |method: &str, q: f64, bar_s: f64| {
        let (reference, bar) = ((raw(q), "raw Zenoh"), Bar::AtMost(bar_s));
        figure(
            "latency/pose-force",
            method,
            quantile(q),
            "s",
            reference,
            bar,
        )
    };
    let (half, tail) = (
        row("median", 0.5, raw(0.5) + 0.55e-3),
        row("p99", 0.99, 2.0 * raw(0.99) + 1e-3),
    );
    Ok(vec![Figure { note, ..half }, tail])
}

fn lateness(seconds: u64) -> anyhow::Result<Vec<Figure>> {
    let bare = bare_timer(seconds * 1_000)?;
    let report = loop_at_work(seconds * 1_000)?;
    let share = |late: u64, of: u64| 1.0 - late as f64 / of.max(1) as f64;
    let punctual = share(report.late, report.ticks);
    let bare_punctual = share(bare.1, bare.0.count());
    let us = |h: &Histogram, q: f64| h.quantile(q) as f64 * 1e-3;
    let whole = &report.stages.whole;
    let note = format!(
        "{} ticks; late by p50 {:.0} µs, p99 {:.0} µs, max {:.0} µs; bare timer {:.0}, {:.0}, {:.0} µs; whole tick p50 {:.0} µs, p99 {:.0} µs; FIFO {}",
        report.ticks,
        us(&report.lateness, 0.5),
        us(&report.lateness, 0.99),
        report.lateness.max() as f64 * 1e-3,
        us(&bare.0, 0.5),
        us(&bare.0, 0.99),
        bare.0.max() as f64 * 1e-3,
        us(whole, 0.5),
        us(whole, 0.99),
        if report.privileges.fifo {
            "granted"
        } else {
            "refused"
        },
    );
    let case = "lateness/realtime";
    let on_time = figure(
        case,
        "ticks within 100 µs",
        punctual,
        "1",
        (bare_punctual, "bare timer"),
        Bar::AtLeast(0.999),
    );
    let skipped = figure(
        case,
        "deadlines skipped",
        report.skipped as f64,
        "1",
        (0.0, "none"),
        Bar::AtMost(0.0),
    );
    Ok(vec![Figure { note, ..on_time }, skipped])
}

/// Sleeps from deadline to deadline and does nothing: lateness, and how many were late.
fn bare_timer(ticks: u64) -> anyhow::Result<(Histogram, u64)> {
    // A thread of its own: what it is granted ends with it.
    let thread = std::thread::spawn(move || {
        ask_privileges();
        let (mut histogram, mut late) = (Histogram::default(), 0);
        let mut due = now_ns();
        for _ in 0..ticks {
            due += 1_000_000;
            sleep_until(due);
            let behind = now_ns().saturating_sub(due);
            histogram.add(behind);
            late += u64::from(behind > LATE_NS);
            due += behind / 1_000_000 * 1_000_000;
        }
        (histogram, late)
    });
    thread
        .join()
        .map_err(|_| anyhow::anyhow!("the timer's thread panicked"))
}

/// The loop on the teardrop, pressed 4 mm deep and let go, over and over.
fn loop_at_work(ticks: u64) -> anyhow::Result<DriverReport> {
    let loaded = file::parse(TEARDROP, "teardrop.toml", Path::new("."))?;
    let scene = Arc::new(Scene::build(&loaded.spec, Path::new("."))?);
    let (tick_ports, mut bus_ports) = ports(&scene);
    let settings = DriverSettings {
        clock: Clock::Realtime,
        ticks: Some(ticks),
        privileged: true,
    };
    let driver = driver::start(scene, tick_ports, Box::new(NoJournal), settings)?;
    let mut seq = 0;
    while !driver.is_finished() {
        std::thread::sleep(Duration::from_micros(970));
        seq += 1;
        let share = 0.5 - 0.5 * libm::cos(seq as f64 * 1e-3 * 2.0);
        bus_ports.poses[0].offer(
            DevicePose {
                seq,
                t_client_ns: 0,
                position: Point3::new(0.04 - 0.014 * share, 0.003, 0.045),
                orientation: Rotation::identity(),
                linear_velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                buttons: 0,
            },
            SenderId::default(),
        );
        while bus_ports.outputs.pop().is_ok() {}
        while bus_ports.records.pop().is_ok() {}
        bus_ports.nets.iter_mut().for_each(|net| drop(net.newest()));
    }
    driver
        .join()
        .map_err(|_| anyhow::anyhow!("the tick thread panicked"))
}
