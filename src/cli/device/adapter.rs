//! `palpate device` with hardware of other makers, or in its place.

use super::super::Outcome;
use super::Args;
use anyhow::Context as _;
use palpate_adapters::haply_service::{self, Pace};
use palpate_adapters::ros2::{guard_crtk, simulate_arm};
use palpate_adapters::simulated::SimulatedHand;
use palpate_adapters::{Coupling, HARDWARE, Hardware, couple};
use palpate_client::device::{Hand, Motion, SimulatedDevice};
use palpate_client::proto::messages::{DeviceInfo, SceneSnapshot};
use palpate_devices::{Cap, Coupler, CouplerSettings};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Hardware of other makers.
#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Hardware and other programs")]
#[group(id = "adapters", multiple = true)]
pub struct AdapterArgs {
    /// Move the tool with this hardware instead of a simulated device.
    #[arg(long, value_name = "KIND", value_parser = kinds(), requires = "tool")]
    pub hardware: Option<String>,
    /// Address of its maker's software, where that is not the usual one.
    #[arg(long, requires = "hardware")]
    uri: Option<String>,
    /// Device to use, where the service has several.
    #[arg(long, value_name = "ID", requires = "hardware")]
    device_id: Option<String>,
    /// Present the simulated device as hardware to other programs: crtk (a ROS 2 arm, in NAMESPACE) or
    /// haply (an Inverse Service).
    #[arg(long = "as", value_name = "KIND", value_parser = ["crtk", "haply"], conflicts_with = "hardware")]
    pub pretend: Option<String>,
    /// Port of the simulated Inverse Service; 0: any free one.
    #[arg(long, default_value_t = 10_001, requires = "pretend")]
    port: u16,
    /// With --as haply: move on by one servo period for each message instead of with time.
    #[arg(long, requires = "pretend")]
    per_message: bool,
    /// Stand beside a driver and hand its forces on only while they are fresh (50 ms): crtk, in
    /// NAMESPACE.
    #[arg(long, value_name = "KIND", value_parser = ["crtk"], conflicts_with_all = ["hardware", "pretend"])]
    pub guard: Option<String>,
    /// Greatest force handed on to hardware, N.
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    force_max: f64,
    /// ROS namespace of the arm, with --as crtk or --guard crtk.
    #[arg(default_value = "/arm")]
    namespace: String,
}

/// Names of hardware.
fn kinds() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(HARDWARE.iter().map(|kind| kind.name))
}

/// Set by Ctrl-C.
fn stop_flag() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    stop
}

/// A flag that is also set after a time.
fn stop_after(duration: Duration) -> Arc<AtomicBool> {
    let stop = stop_flag();
    let timed = stop.clone();
    // It ends with the program.
    let _ = std::thread::Builder::new().spawn(move || {
        std::thread::sleep(duration);
        timed.store(true, Ordering::Relaxed);
    });
    stop
}

/// Hardware moves the tool.
pub fn drive(args: &Args) -> anyhow::Result<Outcome> {
    let adapter = &args.adapter;
    let tool_id = args.tool.as_deref().context("--tool is missing")?;
    let cap = cap(adapter)?;
    let named = |kind: &&Hardware| adapter.hardware.as_deref() == Some(kind.name);
    let kind = (HARDWARE.iter().find(named)).context("--hardware is missing")?;
    let address = adapter.uri.as_deref().unwrap_or(kind.address);
    let reached = (kind.connect)(
        address,
        adapter.device_id.as_deref(),
        args.connection.insecure,
    );
    let mut device = reached.map_err(|error| anyhow::anyhow!(error))?;
    let palpate = args.connection.open()?;
    let mut tool = palpate.tool(tool_id)?;
    let info = DeviceInfo {
        force_max: cap.force_n,
        ..device.info.clone()
    };
    super::announce(&palpate, &mut tool, tool_id, &info)?;
    let coupler = Coupler::new(CouplerSettings {
        clutch_button: Some(1),
        cap,
        dt_s: palpate.scene()?.dt_ns as f64 * 1e-9,
        ..CouplerSettings::default()
    });
    let stop = stop_after(args.duration);
    let report = couple(
        &mut *device.end,
        &mut tool,
        Coupling {
            coupler,
            info,
            stop: &stop,
        },
    );
    drop(tool);
    palpate.close();
    let report = match report {
        Ok(report) => report,
        Err(error) => {
            eprintln!("error: {error}");
            return Ok(Outcome::Fault);
        }
    };
    if args.json {
        println!(
            "{}",
            serde_json::json!({
                "device": device.id, "poses": report.readings, "refused": report.refused,
                "forces": report.commands, "peak_force_n": report.peak_force_n, "rate_hz": report.rate_hz,
            })
        );
    } else {
        println!(
            "device {}: {} poses sent, {} refused, {} forces passed on, peak {:.4} N, {:.0} Hz",
            device.id,
            report.readings,
            report.refused,
            report.commands,
            report.peak_force_n,
            report.rate_hz
        );
    }
    Ok(Outcome::Ok)
}

fn cap(adapter: &AdapterArgs) -> anyhow::Result<Cap> {
    anyhow::ensure!(
        (0.0..=100.0).contains(&adapter.force_max),
        "--force-max must be 0 to 100 N"
    );
    Ok(Cap {
        force_n: adapter.force_max,
        torque_nm: 0.0,
    })
}

/// The simulated device takes the place of hardware.
pub fn pretend(args: &Args, kind: &str) -> anyhow::Result<Outcome> {
    let hand = simulated(args)?;
    let stop = stop_after(args.duration);
    if kind == "haply" {
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, args.adapter.port));
        let pace = match args.adapter.per_message {
            true => Pace::Message,
            false => Pace::Time,
        };
        let ready = |address: SocketAddr| println!("Inverse Service: ws://{address}");
        haply_service::serve(address, hand, pace, &stop, ready).with_context(|| {
            format!("an Inverse Service at {address}; choose another with --port")
        })?;
        return Ok(Outcome::Ok);
    }
    let session = args.connection.session()?;
    let report = simulate_arm(
        &session,
        &args.adapter.namespace,
        hand,
        args.duration,
        &stop,
    )
    .map_err(|error| anyhow::anyhow!("Zenoh: {error}"))?;
    println!(
        "arm {}: {} poses published, {} forces received, peak {:.4} N",
        args.adapter.namespace, report.poses, report.forces, report.peak_force_n
    );
    Ok(Outcome::Ok)
}

/// Stands beside a driver.
pub fn guard(args: &Args) -> anyhow::Result<Outcome> {
    let cap = Cap {
        torque_nm: 0.1,
        ..cap(&args.adapter)?
    };
    let session = args.connection.session()?;
    let stop = stop_after(args.duration);
    let report = guard_crtk(&session, &args.adapter.namespace, cap, &stop)
        .map_err(|error| anyhow::anyhow!("Zenoh: {error}"))?;
    println!(
        "guard {}: {} forces passed on, stopped {} times",
        args.adapter.namespace, report.passed, report.stopped
    );
    Ok(Outcome::Ok)
}

/// The device, the hand and the motion of the arguments. Named motions need a tool of a scene to aim
/// at; without one the hand follows waypoints, or stays at the origin.
fn simulated(args: &Args) -> anyhow::Result<SimulatedHand> {
    let model = super::model(&args.device)?;
    let mut hand = super::hand(&args.hand)?;
    if let Some(tremor_m) = args.tremor {
        hand = Hand { tremor_m, ..hand }.checked()?;
    }
    let motion = match &args.tool {
        Some(tool) => {
            let palpate = args.connection.open()?;
            let motion = super::motion(args, &palpate.scene()?, tool)?;
            palpate.close();
            motion
        }
        None if Path::new(&args.motion).is_file() => super::motion(args, &no_scene(), "")?,
        None => Motion::from_toml(STILL, "still", &no_scene(), "", 0.0)?,
    };
    let start = motion.goal(0.0).position;
    let device = SimulatedDevice::new(model, hand, start, args.seed);
    Ok(SimulatedHand::new(device, motion))
}

const STILL: &str = "[[waypoint]]\ntime_s = 0\nposition = [0, 0, 0]\n[[waypoint]]\ntime_s = 1\nposition = [0, 0, 0]\n";

fn no_scene() -> SceneSnapshot {
    SceneSnapshot {
        tick: 0,
        scene_hash: [0; 32],
        scene_name: String::new(),
        dt_ns: 1_000_000,
        lockstep: false,
        bodies: Vec::new(),
        tools: Vec::new(),
    }
}
