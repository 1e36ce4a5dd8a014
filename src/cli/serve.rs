//! `palpate serve`: one scene, until it is told to stop.

use super::{Outcome, text};
use crate::recording::{Recorder, RecorderSettings, RecordingSummary, default_path, stage_infos, write_stages};
use crate::scene::spec::Clock;
use crate::scene::{Scene, file, inline_files};
use crate::tick::driver::{self, DriverReport, DriverSettings};
use crate::tick::journal::{Journal, NoJournal, keeping};
use crate::tick::ports::ports;
use crate::transport::{Bus, BusSettings, DEFAULT_ENDPOINT, SessionSettings, ViewSink, open};
use crate::viewer::Viewer;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file.
    scene: PathBuf,
    #[command(flatten)]
    common: Common,
    /// What makes a tick due; overrides the scene.
    #[arg(long, value_parser = ["realtime", "lockstep"])]
    clock: Option<String>,
}

/// What `serve` and `demo` share.
#[derive(clap::Args, Debug, Clone)]
pub struct Common {
    /// End after this long, for example 10s (in lockstep: of simulated time).
    #[arg(long = "for", value_parser = text::duration)]
    pub duration: Option<Duration>,
    /// Record to this file.
    #[arg(long)]
    pub record: Option<PathBuf>,
    /// Zenoh endpoint to listen on; several may be given.
    #[arg(short, long)]
    pub listen: Vec<String>,
    /// Zenoh endpoint to connect to; several may be given.
    #[arg(short = 'e', long)]
    pub connect: Vec<String>,
    /// Stock Zenoh JSON5 configuration.
    #[arg(long)]
    pub zenoh_config: Option<PathBuf>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    pub instance: String,
    /// Serve the viewer page here, for example 127.0.0.1:8080.
    #[arg(long)]
    pub http: Option<std::net::SocketAddr>,
    /// Do not ask for FIFO scheduling and locked memory.
    #[arg(long)]
    pub no_rt: bool,
}

/// A daemon that has ended.
pub struct Served {
    pub report: DriverReport,
    pub recording: Option<RecordingSummary>,
    pub recording_failed: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let mut loaded = file::load(&args.scene)?;
    if let Some(clock) = &args.clock {
        loaded.spec.loop_.clock = if clock == "lockstep" { Clock::Lockstep } else { Clock::Realtime };
    }
    let mut common = args.common.clone();
    if common.record.as_ref().is_some_and(|path| path.is_dir()) {
        common.record = common.record.map(|path| default_path(&path, "session"));
    }
    let served = serve(&loaded, &common, || Ok(()))?;
    summary(&served);
    Ok(outcome(&served))
}

/// Exit code of a served session.
pub fn outcome(served: &Served) -> Outcome {
    let lossy = served.recording.as_ref().is_some_and(|recording| recording.dropped > 0);
    if served.recording_failed || lossy { Outcome::Fault } else { Outcome::Ok }
}

/// Runs a scene to its end. `ready` is called once everything listens.
pub fn serve(
    loaded: &file::Loaded,
    common: &Common,
    ready: impl FnOnce() -> anyhow::Result<()>,
) -> anyhow::Result<Served> {
    let effective = inline_files(&loaded.spec, &loaded.directory)?;
    let scene = Arc::new(Scene::build(&effective, &loaded.directory)?);
    let config = common
        .zenoh_config
        .clone()
        .or_else(|| loaded.spec.zenoh.config.as_ref().map(|path| loaded.directory.join(path)));
    let listen = match (&config, common.listen.is_empty()) {
        (None, true) => vec![DEFAULT_ENDPOINT.to_owned()],
        _ => common.listen.clone(),
    };
    let session = open(&SessionSettings { connect: common.connect.clone(), listen: listen.clone(), config })?;
    let (recorder, journal): (Option<Recorder>, Box<dyn Journal>) = match &common.record {
        None => (None, Box::new(NoJournal)),
        Some(path) => {
            let settings = RecorderSettings { path: path.clone(), scene_text: loaded.text.clone(), effective };
            let (recorder, port) = Recorder::start(settings, &scene)?;
            recorder.gauges().state.store(keeping::RECORDING, Ordering::Relaxed);
            (Some(recorder), Box::new(port))
        }
    };
    let (viewer, feed) = match common.http {
        Some(address) => {
            let (viewer, feed) =
                Viewer::start(address).map_err(|e| anyhow::anyhow!("the viewer cannot listen on {address}: {e}"))?;
            eprintln!("viewer: {}", viewer.url());
            (Some(viewer), Some(feed))
        }
        None => (None, None),
    };
    let (tick_ports, bus_ports) = ports(&scene);
    let counters = bus_ports.counters.clone();
    // The first signal lets forces fade and ends the recording; the second ends the program.
    let signals = AtomicU32::new(0);
    let _ = ctrlc::set_handler(move || {
        if signals.fetch_add(1, Ordering::Relaxed) > 0 {
            std::process::exit(130);
        }
        counters.stop.store(true, Ordering::Release);
    });
    let bus = Bus::start(
        session,
        bus_ports,
        BusSettings {
            scene: scene.clone(),
            scene_hash: loaded.sha256,
            instance: common.instance.clone(),
            viewer: feed.map(|feed| Box::new(feed) as Box<dyn ViewSink>),
            recorder: recorder.as_ref().map(Recorder::gauges),
            archive: None,
            viewer_url: viewer.as_ref().map(Viewer::url),
            player: None,
        },
    )
    .map_err(|e| anyhow::anyhow!("{e}"))?;
    let settings = DriverSettings {
        clock: scene.clock,
        ticks: common.duration.map(|duration| (duration.as_secs_f64() / scene.dt_s).round() as u64),
        privileged: !common.no_rt,
    };
    let thread = driver::start(scene.clone(), tick_ports, journal, settings)?;
    tracing::info!(
        scene = scene.name, instance = common.instance, listen = listen.join(","), clock = ?scene.clock,
        "serving; poses on palpate/{}/tool/ID/pose", common.instance
    );
    let begun = ready();
    let report = thread.join().map_err(|_| anyhow::anyhow!("the tick thread panicked"));
    let bus_report = bus.finish();
    drop(viewer);
    let (mut recording, mut recording_failed) = (None, false);
    if let Some(recorder) = recorder {
        match recorder.finish() {
            Ok(summary) => recording = Some(summary),
            Err(error) => {
                eprintln!("the recording is incomplete: {error}");
                recording_failed = true;
            }
        }
    }
    begun?;
    tracing::debug!(events = bus_report.events, poses = ?bus_report.poses, suppressed = ?bus_report.suppressed, "bus closed");
    let report = report?;
    if settings.privileged && !report.privileges.fifo && scene.clock == Clock::Realtime {
        tracing::warn!("SCHED_FIFO was refused: ticks may start late; see `palpate doctor`");
    }
    Ok(Served { report, recording, recording_failed })
}

/// The figures of a session, on stdout.
pub fn summary(served: &Served) {
    let report = &served.report;
    let us = |q: f64| report.lateness.quantile(q) as f64 * 1e-3;
    println!("ticks {}, late {}, skipped {}", report.ticks, report.late, report.skipped);
    println!(
        "start after deadline: p50 {:.1} us, p99 {:.1} us, max {:.1} us",
        us(0.5),
        us(0.99),
        report.lateness.max() as f64 * 1e-3
    );
    let mut table = String::new();
    let _ = write_stages(&mut table, &stage_infos(&report.stages));
    print!("{table}");
    if let Some(recording) = &served.recording {
        println!(
            "recorded {} ({} ticks, {} lost), session hash {:016x}",
            recording.path.display(),
            recording.ticks,
            recording.dropped,
            recording.session_hash
        );
    }
}
