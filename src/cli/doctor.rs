//! `palpate doctor`: what this machine allows, and what rate it can hold.

use super::connection::Connection;
use super::{Outcome, text};
use anyhow::Context as _;
use palpate_sim::scene::file;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

mod devices;
mod machine;
mod rate;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene to measure [default: a rigid and a soft teardrop].
    scene: Option<PathBuf>,
    /// Look at the devices of a daemon that runs at this endpoint instead, and warn of slow ones.
    #[arg(short = 'e', long, value_name = "ENDPOINT", conflicts_with = "scene")]
    connect: Option<String>,
    /// Instance name, with --connect.
    #[arg(long, default_value = "default", requires = "connect")]
    instance: String,
    /// Identity file for an endpoint with TLS, with --connect.
    #[arg(long, value_name = "FILE", requires = "connect")]
    identity: Option<PathBuf>,
    /// Also connect to another machine without TLS.
    #[arg(long, requires = "connect")]
    insecure: bool,
    /// How long to measure the timer.
    #[arg(long = "for", value_parser = text::duration, default_value = "2s")]
    duration: Duration,
    /// Number of ticks to run for each scene.
    #[arg(long, default_value_t = 4_000, value_parser = clap::value_parser!(u64).range(100..=1_000_000))]
    ticks: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Scenes that are run by default.
const SCENES: [(&str, &str); 2] = [
    (
        "rigid-teardrop.toml",
        include_str!("../../scenes/rigid-teardrop.toml"),
    ),
    ("teardrop.toml", include_str!("../../scenes/teardrop.toml")),
];

/// The results. Times are in µs.
#[derive(Serialize)]
struct DoctorReport {
    #[serde(flatten)]
    machine: machine::Machine,
    lateness_plain: rate::RateFigures,
    lateness_asked: rate::RateFigures,
    scenes: Vec<rate::SceneRate>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if let Some(endpoint) = &args.connect {
        let connection = Connection {
            connect: vec![endpoint.clone()],
            instance: args.instance.clone(),
            zenoh_config: None,
            identity: args.identity.clone(),
            insecure: args.insecure,
        };
        let held = devices::ask(&connection)?;
        if args.json {
            println!("{}", serde_json::json!({ "devices": held }));
        } else if held.is_empty() {
            println!("no device has described itself");
        } else {
            held.iter()
                .for_each(|held| println!("{}", devices::words(held)));
        }
        return Ok(Outcome::Ok);
    }
    let loaded = match &args.scene {
        Some(path) => vec![super::scenes::load(path)?],
        None => SCENES
            .iter()
            .map(|(name, text)| file::parse(text, name, Path::new(".")))
            .collect::<Result<_, _>>()
            .context("a built-in scene")?,
    };
    let scenes = loaded
        .iter()
        .map(rate::Pressing::new)
        .collect::<anyhow::Result<Vec<_>>>()?;
    let timer_ticks = (args.duration.as_secs_f64() * 1e3) as u64;
    let ticks = args.ticks;
    if !args.json {
        let seconds = 2.0 * args.duration.as_secs_f64()
            + scenes
                .iter()
                .map(|scene| scene.period_s() * ticks as f64)
                .sum::<f64>();
        eprintln!("measuring, {seconds:.0} s or more…");
    }
    // A thread of its own: what it is granted ends with it.
    let measured = std::thread::spawn(move || {
        let plain = rate::lateness_ns(timer_ticks);
        let privileges = palpate_drive::pacer::ask_privileges();
        let asked = rate::lateness_ns(timer_ticks);
        let scenes: Vec<_> = scenes
            .into_iter()
            .map(|scene| scene.run(ticks, &asked))
            .collect();
        (privileges, plain, asked, scenes)
    });
    let (privileges, plain, asked, scenes) = measured
        .join()
        .map_err(|_| anyhow::anyhow!("the measuring thread panicked"))?;
    let report = DoctorReport {
        machine: machine::Machine::look(privileges),
        lateness_plain: rate::RateFigures::of(&plain),
        lateness_asked: rate::RateFigures::of(&asked),
        scenes,
    };
    if args.json {
        println!("{}", serde_json::to_string(&report)?);
    } else {
        print(&report);
    }
    Ok(Outcome::Ok)
}

fn print(report: &DoctorReport) {
    report.machine.print();
    for (name, late) in [
        ("1 kHz timer, default", &report.lateness_plain),
        ("1 kHz timer, real-time", &report.lateness_asked),
    ] {
        println!(
            "{name:<26}late by p50 {:.0} us, p99 {:.0} us, p99.9 {:.0} us, max {:.0} us",
            late.p50_us, late.p99_us, late.p999_us, late.max_us
        );
    }
    for scene in &report.scenes {
        let tick = &scene.tick;
        println!(
            "tick of {:<18}p50 {:.0} us, p99 {:.0} us, p99.9 {:.0} us, max {:.0} us ({} of {} ticks in contact)",
            scene.scene,
            tick.p50_us,
            tick.p99_us,
            tick.p999_us,
            tick.max_us,
            scene.contact_ticks,
            scene.ticks
        );
    }
    for scene in &report.scenes {
        println!(
            "force of {:<17}p50 {:.0} us, p99 {:.0} us after the poses are taken",
            scene.scene, scene.force.p50_us, scene.force.p99_us
        );
    }
    for scene in &report.scenes {
        let (asked_hz, name) = (scene.scene_hz, format!("{} can run at", scene.scene));
        match scene.holds_hz {
            _ if scene.contact_ticks == 0 => {
                println!("{name:<35}not measured: the script touches nothing")
            }
            Some(hz) if hz >= asked_hz => println!("{name:<35}{hz} Hz"),
            Some(hz) => {
                println!(
                    "{name:<35}{hz} Hz; the scene asks for {asked_hz:.0}, so ticks will overrun"
                )
            }
            None => println!("{name:<35}none of {:?} Hz", rate::RATES_HZ),
        }
    }
    println!(
        "(99.9 % of its ticks, started as late as the timer wakes, end before the next deadline)"
    );
}
