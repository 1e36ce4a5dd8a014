//! `palpate device`: a simulated device on the bus.

mod adapter;

use super::connection::Connection;
use super::{Outcome, text};
use anyhow::Context as _;
use palpate_client::device::run::{PATIENCE, RunReport, RunSettings, Sample, run as run_device};
use palpate_client::device::{DeviceModel, Hand, Motion, Network, SimulatedDevice, devices};
use palpate_client::proto::messages::{DeviceInfo, SceneSnapshot};
use palpate_client::{Palpate, Tool};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A silence of the daemon that makes a run a failed one, s.
const LONG_SILENCE_S: f64 = 1.0;
/// How long a daemon is waited for that is not there yet, unless --wait says otherwise.
const START: Duration = Duration::from_secs(10);

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Tool of the scene to move.
    #[arg(long, required_unless_present_any = ["list", "pretend", "guard"])]
    tool: Option<String>,
    /// Print the available devices and exit.
    #[arg(long)]
    list: bool,
    /// Device name (see --list), or a TOML file with its figures (docs/devices.md).
    #[arg(long, default_value = "ideal", help_heading = "Simulated device")]
    device: String,
    /// Hand: light, relaxed, firm, or a TOML file.
    #[arg(long, default_value = "relaxed", help_heading = "Simulated device")]
    hand: String,
    /// Motion: press, slide, tap, circle, pull, tremor, hold, or a TOML file of [[step]] or
    /// [[waypoint]] entries.
    #[arg(long, default_value = "press", help_heading = "Simulated device")]
    motion: String,
    /// How far beyond first contact the hand aims, m.
    #[arg(long, default_value_t = 0.004, help_heading = "Simulated device")]
    depth: f64,
    /// Poses per second [default: the device's own rate; in lockstep one per tick].
    #[arg(long, help_heading = "Simulated device")]
    rate: Option<f64>,
    /// Duration, for example 10s.
    #[arg(long = "for", value_parser = text::duration, default_value = "10s")]
    duration: Duration,
    /// Seed of everything random in the device, the hand and the network.
    #[arg(long, default_value_t = 1, help_heading = "Simulated device")]
    seed: u64,
    /// Bound of the hand's tremor in each axis, m [default: that of the hand].
    #[arg(long, help_heading = "Simulated device")]
    tremor: Option<f64>,
    /// Network delay in each direction, for example 5ms.
    #[arg(long, value_parser = text::duration, help_heading = "Network between device and daemon")]
    delay: Option<Duration>,
    /// Random additional delay, up to this much.
    #[arg(long, value_parser = text::duration, help_heading = "Network between device and daemon")]
    jitter: Option<Duration>,
    /// Fraction of poses and of forces that are lost, 0 to 1.
    #[arg(
        long,
        default_value_t = 0.0,
        help_heading = "Network between device and daemon"
    )]
    loss: f64,
    /// Fraction that arrives after the next one, 0 to 1.
    #[arg(
        long,
        default_value_t = 0.0,
        help_heading = "Network between device and daemon"
    )]
    reorder: f64,
    /// How long to wait for a daemon that is not there yet [default: 10s], or that falls silent [default:
    /// 5s, which is also the least]; the device is let go meanwhile.
    #[arg(long, value_parser = text::duration)]
    wait: Option<Duration>,
    /// Keep the device's port passive (time-domain passivity control).
    #[arg(long, help_heading = "Simulated device")]
    passivity: bool,
    /// Write every servo period to a CSV file.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    adapter: adapter::AdapterArgs,
    #[command(flatten)]
    connection: Connection,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if args.list {
        list(args.json)?;
        return Ok(Outcome::Ok);
    }
    if args.adapter.hardware.is_some() {
        return adapter::drive(args);
    }
    if let Some(kind) = &args.adapter.pretend {
        return adapter::pretend(args, kind);
    }
    if args.adapter.guard.is_some() {
        return adapter::guard(args);
    }
    let tool_id = args
        .tool
        .as_deref()
        .context("--tool is missing: name the tool of the scene to move")?;
    let model = model(&args.device)?;
    if let Some(rate_hz) = args.rate {
        anyhow::ensure!(
            (1.0..=20_000.0).contains(&rate_hz),
            "--rate must be 1 to 20000 Hz"
        );
    }
    let mut hand = hand(&args.hand)?;
    if let Some(tremor_m) = args.tremor {
        hand = Hand { tremor_m, ..hand }.checked()?;
    }
    let palpate = args.connection.open_within(args.wait.unwrap_or(START))?;
    let scene = palpate.scene()?;
    let known: Vec<&str> = scene.tools.iter().map(|tool| tool.id.as_str()).collect();
    anyhow::ensure!(
        known.contains(&tool_id),
        "the scene has no tool {tool_id:?}; it has {}",
        known.join(", ")
    );
    let motion = motion(args, &scene, tool_id)?;
    let mut tool = palpate.tool(tool_id)?;
    let delay_s = args.delay.map_or(0.0, |delay| delay.as_secs_f64());
    announce(&palpate, &mut tool, tool_id, &model.info(delay_s))?;
    let mut device = SimulatedDevice::new(model, hand, motion.goal(0.0).position, args.seed);
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    let network = Network {
        delay_s,
        jitter_s: args.jitter.map_or(0.0, |jitter| jitter.as_secs_f64()),
        loss: args.loss,
        reorder: args.reorder,
        seed: args.seed,
    };
    let duration_s = args.duration.as_secs_f64();
    // In lockstep a tick waits for one pose, so the device's period is a tick.
    let own_hz = if tool.is_lockstep() {
        1e9 / scene.dt_ns as f64
    } else {
        device.model().rate_hz
    };
    let rate_hz = args.rate.unwrap_or(own_hz);
    let run = RunSettings {
        rate_hz,
        duration_s,
        network,
        passivity: args.passivity,
        patience: args.wait.unwrap_or(PATIENCE).max(PATIENCE),
    };
    let mut csv = args.csv.as_deref().map(Csv::create).transpose()?;
    let mut watch = |sample: &Sample| {
        if let Some(csv) = &mut csv {
            csv.add(sample);
        }
    };
    let report = run_device(&mut tool, &mut device, &motion, &run, &stop, &mut watch)?;
    if let Some(csv) = csv {
        csv.finish()?;
    }
    drop(tool);
    palpate.close();
    print(&report, args.json)?;
    warn(&report, device.model());
    // Longer than a hiccup of this machine: whoever reads the exit code should know.
    let was_alone = report.silences.longest_s > LONG_SILENCE_S;
    Ok(if report.gave_up || was_alone {
        Outcome::Fault
    } else if report.forces == 0 {
        eprintln!(
            "no force was received: is the daemon in lockstep and waiting for other tools, or is the network losing all?"
        );
        Outcome::Difference
    } else {
        Outcome::Ok
    })
}

/// Sends the device's description to the daemon. In lockstep the first tick waits until the daemon
/// has it, so that sessions are reproducible.
fn announce(palpate: &Palpate, tool: &mut Tool, id: &str, info: &DeviceInfo) -> anyhow::Result<()> {
    tool.announce(info)?;
    let begun = Instant::now();
    while tool.is_lockstep() && palpate.device(id).ok().as_ref() != Some(info) {
        anyhow::ensure!(
            begun.elapsed() < Duration::from_secs(5),
            "the daemon did not accept the device's description"
        );
        if begun.elapsed() > Duration::from_millis(500) {
            palpate.check_holder(tool)?;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

fn model(name: &str) -> anyhow::Result<DeviceModel> {
    if Path::new(name).is_file() {
        let text = std::fs::read_to_string(name).with_context(|| name.to_owned())?;
        return Ok(DeviceModel::from_toml(&text, name)?);
    }
    Ok(DeviceModel::preset(name)?)
}

fn hand(name: &str) -> anyhow::Result<Hand> {
    if Path::new(name).is_file() {
        let text = std::fs::read_to_string(name).with_context(|| name.to_owned())?;
        return Ok(Hand::from_toml(&text, name)?);
    }
    Ok(Hand::preset(name)?)
}

fn motion(args: &Args, scene: &SceneSnapshot, tool: &str) -> anyhow::Result<Motion> {
    if Path::new(&args.motion).is_file() {
        let text = std::fs::read_to_string(&args.motion).with_context(|| args.motion.clone())?;
        return Ok(Motion::from_toml(
            &text,
            &args.motion,
            scene,
            tool,
            args.depth,
        )?);
    }
    Ok(Motion::named(&args.motion, scene, tool, args.depth)?)
}

/// Every period of a run: time, true and reported position, force received and applied, energy
/// given to the loop.
struct Csv {
    file: std::io::BufWriter<std::fs::File>,
    failed: Option<std::io::Error>,
}

impl Csv {
    fn create(path: &Path) -> anyhow::Result<Self> {
        let file = std::fs::File::create(path).with_context(|| path.display().to_string())?;
        let mut csv = Self {
            file: std::io::BufWriter::new(file),
            failed: None,
        };
        let columns = ["true", "reported"].map(|what| format!("{what}_x_m,{what}_y_m,{what}_z_m"));
        let forces =
            ["received", "applied"].map(|what| format!("{what}_x_n,{what}_y_n,{what}_z_n"));
        csv.line(&format!(
            "time_s,{},{},loop_j",
            columns.join(","),
            forces.join(",")
        ));
        Ok(csv)
    }

    fn line(&mut self, line: &str) {
        if self.failed.is_none() {
            self.failed = writeln!(self.file, "{line}").err();
        }
    }

    fn add(&mut self, sample: &Sample) {
        let three = |[x, y, z]: [f64; 3]| format!("{x},{y},{z}");
        let line = format!(
            "{:.6},{},{},{},{},{}",
            sample.time_s,
            three(sample.true_position),
            three(sample.reported_position),
            three(sample.received_n),
            three(sample.applied_n),
            sample.loop_j
        );
        self.line(&line);
    }

    fn finish(mut self) -> anyhow::Result<()> {
        self.failed
            .map_or(Ok(()), Err)
            .and_then(|()| self.file.flush())
            .context("writing the CSV file")
    }
}

fn list(json: bool) -> anyhow::Result<()> {
    let devices = devices();
    if json {
        println!("{}", serde_json::to_string(&devices)?);
        return Ok(());
    }
    println!(
        "{:12} {:>5} {:>18} {:>7} {:>8} {:>7} {:>8} {:>6} {:>7} {:>7} {:>7} {:>7}",
        "device",
        "twist",
        "workspace mm",
        "mass g",
        "b N·s/m",
        "dry N",
        "step um",
        "Hz",
        "peak N",
        "cont N",
        "peak Nm",
        "amp Hz"
    );
    let figure = |value: f64, digits: usize| match value.is_finite() {
        true => format!("{value:.digits$}"),
        false => "-".to_owned(),
    };
    for device in devices {
        let [x, y, z] = device
            .workspace_m
            .map(|extent| format!("{:.0}", extent * 1e3));
        println!(
            "{:12} {:>5} {:>18} {:>7.0} {:>8} {:>7} {:>8} {:>6.0} {:>7} {:>7} {:>7} {:>7}",
            device.name,
            device.torque_dof,
            format!("{x} x {y} x {z}"),
            device.mass_kg * 1e3,
            device.damping_n_s_m,
            device.coulomb_n,
            figure(device.encoder_m * 1e6, 1),
            device.rate_hz,
            figure(device.force_max_n, 1),
            figure(device.force_continuous_n, 2),
            device.torque_max_nm,
            figure(device.bandwidth_hz, 0),
        );
    }
    println!("sources, and which figures are assumed: docs/devices.md");
    Ok(())
}

fn print(report: &RunReport, json: bool) -> anyhow::Result<()> {
    if json {
        println!("{}", serde_json::to_string(report)?);
    } else {
        let [p50, p99, max] = report.round_trip_us;
        let [peak, rms] = report.applied_force_n;
        println!(
            "device {}: {} poses sent, {} forces received",
            report.device, report.poses, report.forces
        );
        println!(
            "peak force {:.4} N, peak depth {:.3} mm",
            report.peak_force_n,
            report.peak_depth_m * 1e3
        );
        println!("applied: peak {peak:.4} N, rms {rms:.4} N");
        println!("pose to force: p50 {p50:.0} us, p99 {p99:.0} us, max {max:.0} us");
        let [p50, p99, max] = report.force_age_us;
        println!(
            "age of the force at the device: p50 {p50:.0} us, p99 {p99:.0} us, max {max:.0} us"
        );
        println!(
            "energy: {:.6} J put into the loop, at most {:.6} J generated by it, {:.6} J removed by the controller",
            report.loop_j, report.made_j, report.dissipated_j
        );
        if report.lost != [0; 2] || report.late > 0 {
            let [poses, forces] = report.lost;
            println!(
                "network: {poses} poses and {forces} forces lost, {} forces late",
                report.late
            );
        }
    }
    if report.withheld > 0 {
        eprintln!(
            "the tool was inside a body when it was taken: {} forces were withheld, until it was out of it",
            report.withheld
        );
    }
    if report.silences.count > 0 {
        eprintln!(
            "no force came for up to {:.0} ms ({} times): the device was let go meanwhile",
            report.silences.longest_s * 1e3,
            report.silences.count
        );
    }
    if report.gave_up {
        eprintln!("the daemon stopped answering");
    }
    Ok(())
}

/// Prints what the real device could not have done.
fn warn(report: &RunReport, model: &DeviceModel) {
    for (axis, (range, extent)) in ["x", "y", "z"]
        .iter()
        .zip(report.range_m.iter().zip(model.workspace_m))
    {
        if *range > extent {
            eprintln!(
                "motion along {axis} spans {:.0} mm, the workspace {:.0} mm",
                range * 1e3,
                extent * 1e3
            );
        }
    }
    if report.applied_force_n[1] > model.force_continuous_n {
        eprintln!(
            "mean force {:.2} N, the motors sustain {:.2} N",
            report.applied_force_n[1], model.force_continuous_n
        );
    }
}
