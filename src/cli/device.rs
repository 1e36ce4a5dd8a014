//! `palpate device`: a simulated device on the bus.

use super::{Outcome, text};
use crate::transport::DEFAULT_ENDPOINT;
use anyhow::Context as _;
use palpate_client::device::run::{RunReport, RunSettings, run as run_device};
use palpate_client::device::{DeviceParameters, Motion, MotionFile, SimulatedDevice};
use palpate_client::{Connect, Palpate};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Tool of the scene to hold.
    #[arg(long)]
    tool: String,
    /// press, slide, tap, circle, pull, or a TOML file of [[waypoint]] entries.
    #[arg(long, default_value = "press")]
    motion: String,
    /// How far past the first touch the hand wants to go, m.
    #[arg(long, default_value_t = 0.004)]
    depth: f64,
    /// Poses a second.
    #[arg(long, default_value_t = 1_000.0)]
    rate: f64,
    /// How long, for example 10s.
    #[arg(long = "for", value_parser = text::duration, default_value = "10s")]
    duration: Duration,
    /// Decides whatever is random in the device.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Amplitude of the hand's tremor, m.
    #[arg(long, default_value_t = 0.0)]
    tremor: f64,
    /// Where the daemon listens.
    #[arg(short = 'e', long, default_value = DEFAULT_ENDPOINT)]
    connect: Vec<String>,
    /// Stock Zenoh JSON5 configuration.
    #[arg(long)]
    zenoh_config: Option<PathBuf>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    instance: String,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    anyhow::ensure!(args.rate.is_finite() && (1.0..=20_000.0).contains(&args.rate), "--rate must be 1 to 20000 Hz");
    let settings = Connect {
        endpoints: args.connect.clone(),
        instance: args.instance.clone(),
        zenoh_config: args.zenoh_config.clone(),
        timeout: Duration::from_secs(5),
    };
    let palpate = Palpate::connect(&settings)?;
    let scene = palpate.scene()?;
    let mut tool = palpate.tool(&args.tool)?;
    let motion = if Path::new(&args.motion).is_file() {
        let text = std::fs::read_to_string(&args.motion).with_context(|| args.motion.clone())?;
        let file: MotionFile = toml::from_str(&text).with_context(|| args.motion.clone())?;
        Motion::through(file)?
    } else {
        Motion::named(&args.motion, &scene, &args.tool, args.depth)?
    };
    let parameters = DeviceParameters { tremor_m: args.tremor, ..DeviceParameters::default() };
    let mut device = SimulatedDevice::new(parameters, motion.goal(0.0), args.seed);
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    let run = RunSettings { rate_hz: args.rate, duration_s: args.duration.as_secs_f64() };
    let report = run_device(&mut tool, &mut device, &motion, &run, &stop)?;
    drop(tool);
    palpate.close();
    print(&report, args.json)?;
    Ok(if report.gave_up { Outcome::Fault } else { Outcome::Ok })
}

fn print(report: &RunReport, json: bool) -> anyhow::Result<()> {
    if json {
        println!("{}", serde_json::to_string(report)?);
    } else {
        let [p50, p99, max] = report.round_trip_us;
        println!("{} poses sent, {} forces received", report.poses, report.forces);
        println!("peak force {:.4} N, peak depth {:.3} mm", report.peak_force_n, report.peak_depth_m * 1e3);
        println!("pose to force: p50 {p50:.0} us, p99 {p99:.0} us, max {max:.0} us");
    }
    if report.gave_up {
        eprintln!("the daemon stopped answering");
    }
    Ok(())
}
