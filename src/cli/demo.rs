//! `palpate demo`: the main job on built-in input.

use super::Outcome;
use super::page::open_in_browser;
use super::serve::{Common, RecordArgs, outcome, serve, summary};
use anyhow::Context as _;
use palpate_client::device::run::RunReport;
use palpate_record::{Session, default_path, info};
use palpate_sim::scene::file;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Do not serve the viewer page (default when not run from a terminal).
    #[arg(long)]
    headless: bool,
    #[command(flatten)]
    common: Common,
}

/// The demo's scene.
const SCENE: &str = include_str!("../../scenes/teardrop.toml");
const TOOL: &str = "ball";

/// How far beyond first contact the hand aims, m: it presses with 0.8 N, and the body bends by as much.
/// From 15 mm on the ball comes to lie on what holds the body, with all the force the device has.
const DEPTH_M: &str = "0.012";

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let mut common = args.common.clone();
    let terminal = std::io::IsTerminal::is_terminal(&std::io::stdout());
    let page = common.page.http.is_some() || terminal && !args.headless;
    // Who looks at the page wants to touch it afterwards.
    let stays = common.duration.is_none() && terminal && page;
    let duration = common.duration.unwrap_or(Duration::from_secs(10));
    if stays {
        limit(&mut common.recording);
    } else {
        common.duration = Some(duration);
    }
    if common.listen.is_empty() {
        common.listen = vec![format!("tcp/127.0.0.1:{}", free_port()?)];
    }
    if common.page.http.is_none() && page {
        common.page.http = Some(std::net::SocketAddr::from(([127, 0, 0, 1], 0)));
    }
    let endpoint = common.listen[0].clone();
    let record = common.recording.record.clone();
    common.recording.record =
        Some(record.unwrap_or_else(|| default_path(&common.recording.record_dir, "demo")));
    let loaded = file::parse(SCENE, "teardrop.toml", Path::new("."))?;
    eprintln!(
        "scene teardrop: a simulated device presses it for {} s…",
        duration.as_secs_f64()
    );
    if stays {
        eprintln!("afterwards the ball is yours: drag it on the page; Ctrl-C ends the demo");
    }
    let mut devices = None;
    let served = serve(&loaded, &common, |page| {
        if let Some(url) = page.filter(|_| !common.page.no_open) {
            open_in_browser(url);
        }
        // Half of the time pressing, half sliding; each in a process of its own, as a real device
        // would be.
        let half = duration.as_secs_f64() * 0.5;
        let seconds = (half - 0.3).max(0.2);
        devices = Some(press_then_slide(
            endpoint.clone(),
            common.instance.clone(),
            seconds,
        ));
        Ok(())
    })?;
    let reports = match devices {
        Some(devices) => devices
            .join()
            .map_err(|_| anyhow::anyhow!("waiting for a device failed"))?,
        None => Vec::new(),
    };
    summary(&served);
    for (motion, report) in &reports {
        match report {
            Ok(report) => {
                let [p50, p99, max] = report.round_trip_us;
                println!(
                    "device ({motion}): {} poses, {} forces, pose to force p50 {p50:.0} us, p99 {p99:.0} us, max {max:.0} us",
                    report.poses, report.forces
                );
            }
            Err(error) => println!("device ({motion}): {error:#}"),
        }
    }
    match palpate_client::raw_ping(free_port()?, 500, Duration::from_millis(2)) {
        Ok(ping) => println!(
            "raw Zenoh ping: p50 {:.0} us, p99 {:.0} us (a pose also waits for the next tick, half a period on average)",
            ping.quantile(0.5) as f64 * 1e-3,
            ping.quantile(0.99) as f64 * 1e-3
        ),
        Err(error) => println!("raw Zenoh ping: {error}"),
    }
    let kept = served.recording.files.iter().filter(|file| !file.deleted);
    for recording in kept {
        let info = info(&Session::open(&recording.path)?)?;
        for tool in &info.tools {
            println!(
                "tool {}: {} ticks in contact, peak force {:.4} N, peak depth {:.3} mm, work of the hand {:.6} J",
                tool.id,
                tool.contact_ticks,
                tool.peak_force_n,
                tool.peak_depth_m * 1e3,
                tool.energy_j
            );
        }
        println!("replay it: palpate replay {}", recording.path.display());
    }
    Ok(outcome(&served))
}

/// A demo that is left open does not fill the disk.
fn limit(recording: &mut RecordArgs) {
    if recording.split_duration.is_none() && recording.split_size.is_none() {
        recording.split_duration = Some(Duration::from_secs(600));
    }
    recording.max_total.get_or_insert(1_000_000_000);
}

type DeviceReports = Vec<(&'static str, anyhow::Result<RunReport>)>;

fn press_then_slide(
    endpoint: String,
    instance: String,
    seconds: f64,
) -> std::thread::JoinHandle<DeviceReports> {
    std::thread::spawn(move || {
        let run = |(motion, seed)| {
            let report = device(&endpoint, &instance, motion, seconds, seed).and_then(collect);
            (motion, report)
        };
        [("press", 1), ("slide", 2)].map(run).into()
    })
}

fn device(
    endpoint: &str,
    instance: &str,
    motion: &str,
    seconds: f64,
    seed: u64,
) -> anyhow::Result<Child> {
    crate::program::command()
        .context("the path of this program")?
        .args([
            "device",
            "--tool",
            TOOL,
            "--motion",
            motion,
            "--depth",
            DEPTH_M,
            "--hand",
            "firm",
            "--json",
            "--connect",
            endpoint,
            "--instance",
            instance,
        ])
        .args(["--for", &format!("{seconds}s"), "--seed", &seed.to_string()])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .context("starting the simulated device")
}

fn collect(child: Child) -> anyhow::Result<RunReport> {
    let output = child.wait_with_output()?;
    anyhow::ensure!(
        output.status.success(),
        "the device ended with {}",
        output.status
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// A loopback port that is free at the moment.
pub fn free_port() -> anyhow::Result<u16> {
    Ok(TcpListener::bind("127.0.0.1:0")?.local_addr()?.port())
}
