//! `palpate serve`: one scene, until it is asked to stop.

mod mouse;
mod ready;
mod watchdog;

pub use ready::summary;

use super::{Outcome, text};
use crate::editing::SceneEditor;
use crate::fleet::{self, Agones};
use crate::transport::{
    Bus, BusSettings, Health, Role, SessionSettings, daemon_of, default_listen, is_taken,
    open_told, patience,
};
use crate::viewer::Viewer;
use anyhow::Context as _;
use palpate_adapters::igtl::Igtl;
use palpate_adapters::ros2::{Plan, Ros2};
use palpate_drive::driver::{self, DriverReport, DriverSettings};
use palpate_drive::editor::Editor;
use palpate_drive::journal::Journal;
use palpate_drive::ports::ports;
use palpate_proto::keys::Keys;
use palpate_record::{
    Recorder, RecorderSettings, RecordingReport, SelfCheck, SelfCheckReport, Split, default_path,
};
use palpate_sim::scene::spec::{Clock, SceneSpec};
use palpate_sim::scene::{Scene, file, inline_files};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file, or builtin:NAME (see `palpate scenes`).
    scene: PathBuf,
    /// Run in real time or in lockstep; overrides the scene.
    #[arg(long, value_parser = ["realtime", "lockstep"])]
    clock: Option<String>,
    /// Add a tool `mouse` to the scene, a ball of this radius (10mm) or as large as the scene's smallest, for pages
    /// to press with.
    #[arg(long, value_name = "RADIUS", num_args = 0..=1, default_missing_value = "auto", value_parser = mouse::radius)]
    mouse_tool: Option<MouseRadius>,
    /// Print one JSON object when clients can connect, and one at the end, instead of a summary.
    #[arg(long)]
    json: bool,
    /// Tell Agones, in its pods on Kubernetes, when this daemon is ready, healthy, in use and over; the
    /// time of --idle-timeout begins with the use.
    #[arg(long)]
    agones: bool,
    /// Write the first of these objects to this open file descriptor, and close it.
    #[arg(long, value_name = "N")]
    ready_fd: Option<u32>,
    #[command(flatten)]
    common: Common,
}

/// Of a mouse's ball, m; `None`: as the scene has it.
type MouseRadius = Option<f64>;

/// What `serve` and `demo` share.
#[derive(clap::Args, Debug, Clone)]
pub struct Common {
    /// Stop after this long by the clock, for example 10s (in lockstep: simulated time).
    #[arg(long = "for", value_parser = text::duration, help_heading = "When it ends")]
    pub duration: Option<Duration>,
    /// Stop when no client has held a tool for this long, for example 10m.
    #[arg(long, value_parser = text::duration, help_heading = "When it ends")]
    pub idle_timeout: Option<Duration>,
    #[command(flatten)]
    pub recording: RecordArgs,
    /// Zenoh endpoint to listen on; port 0 is any free one; can be repeated [default:
    /// tcp/127.0.0.1:7447, with --identity tls/127.0.0.1:7447, with --connect none].
    #[arg(short, long, help_heading = "Bus")]
    pub listen: Vec<String>,
    /// Zenoh endpoint to connect to; can be repeated.
    #[arg(short = 'e', long, help_heading = "Bus")]
    pub connect: Vec<String>,
    /// Zenoh configuration file (JSON5).
    #[arg(long, help_heading = "Bus")]
    pub zenoh_config: Option<PathBuf>,
    /// Instance name.
    #[arg(long, default_value = "default", help_heading = "Bus")]
    pub instance: String,
    #[command(flatten)]
    pub access: super::access::AccessArgs,
    #[command(flatten)]
    pub page: super::page::PageArgs,
    /// Speak ROS 2 (rmw_zenoh) too: tools are moved by the topics of `[ros2]` in the scene.
    #[arg(long, help_heading = "Other protocols")]
    pub ros2: bool,
    /// Speak OpenIGTLink (3D Slicer, PLUS) on this port of this machine: proxies of tools out, poses of
    /// trackers in.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "18944", help_heading = "Other protocols")]
    pub igtl: Option<u16>,
    /// Do not request FIFO scheduling and locked memory.
    #[arg(long, help_heading = "Loop")]
    pub no_rt: bool,
    /// Keep ticks on a fixed grid of time. By default they move, a little each tick, to just after the
    /// poses of a device, so that its force answers sooner; the simulation is the same.
    #[arg(long, help_heading = "Loop")]
    pub fixed_phase: bool,
    /// Number of threads on which bodies that deform step, that of the tick among them; results do not
    /// depend on it [default: one per core, at most 8].
    #[arg(long, value_name = "N", help_heading = "Loop")]
    pub threads: Option<std::num::NonZeroUsize>,
    /// Stop when the process that started this one ends.
    #[arg(long, help_heading = "When it ends")]
    pub with_parent: bool,
    /// Re-run every N ticks on a second thread and check that the results are bit-identical.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Loop")]
    pub self_check: Option<u32>,
    /// Port of the Agones sidecar that gets the daemon's state.
    #[arg(skip)]
    pub agones: Option<u16>,
}

/// Recording options.
#[derive(clap::Args, Debug, Clone)]
#[command(next_help_heading = "Recording")]
pub struct RecordArgs {
    /// Record to this file from the first tick on; given a directory, choose a name in it.
    #[arg(long)]
    pub record: Option<PathBuf>,
    /// Directory for recordings and snapshots requested over RPC (record_start, snapshot).
    #[arg(long, default_value = "recordings/local")]
    pub record_dir: PathBuf,
    /// Keep this long in memory for `rpc snapshot`, for example 30s; at most 1h.
    #[arg(long, value_parser = ring)]
    pub ring: Option<Duration>,
    /// Start a new file at this size before compression, for example 500MB.
    #[arg(long, value_parser = text::bytes)]
    pub split_size: Option<u64>,
    /// Start a new file after this much simulated time, for example 10m.
    #[arg(long, value_parser = text::duration)]
    pub split_duration: Option<Duration>,
    /// Limit the disk space of a recording: it is split into files of at most a third of this, and the
    /// oldest are deleted.
    #[arg(long, value_parser = text::bytes)]
    pub max_total: Option<u64>,
    /// Omit the channels that only viewers read.
    #[arg(long)]
    pub no_views: bool,
}

/// Snapshots reach back an hour at most, and an hour of a large scene is gigabytes.
const LONGEST_RING: Duration = Duration::from_secs(3_600);

fn ring(text: &str) -> Result<Duration, String> {
    let ring = text::duration(text)?;
    match ring <= LONGEST_RING {
        true => Ok(ring),
        false => Err("at most 1h is kept in memory: record to a file instead".into()),
    }
}

impl RecordArgs {
    fn settings(
        &self,
        loaded: &file::Loaded,
        effective: &SceneSpec,
        instance: &str,
    ) -> RecorderSettings {
        let path = match &self.record {
            Some(path) if path.is_dir() => Some(default_path(path, "session")),
            path => path.clone(),
        };
        let split = Split {
            bytes: self.split_size,
            duration: self.split_duration,
            total_bytes: self.max_total,
        };
        RecorderSettings {
            directory: self.record_dir.clone(),
            path,
            ring: self.ring,
            split,
            extra: BTreeMap::from([("instance".to_owned(), instance.to_owned())]),
            ..RecorderSettings::new(&loaded.text, effective)
        }
    }
}

/// A daemon that has ended.
pub struct EndedSession {
    pub report: DriverReport,
    pub recording: RecordingReport,
    pub self_check: Option<SelfCheckReport>,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let mut begun = false;
    run_scene(args, &mut begun).inspect_err(|error| {
        // Whoever started this for its ready line waits for one.
        if args.json && !begun {
            println!("{}", ready::failure(&super::said(error)));
        }
    })
}

/// `begun` is set once clients can connect.
fn run_scene(args: &Args, begun: &mut bool) -> anyhow::Result<Outcome> {
    let mut loaded = super::scenes::load(&args.scene)?;
    if let Some(clock) = &args.clock {
        loaded.spec.loop_.clock = if clock == "lockstep" {
            Clock::Lockstep
        } else {
            Clock::Realtime
        };
    }
    if let Some(radius) = args.mouse_tool {
        mouse::add(&mut loaded, radius)?;
    }
    let mut common = args.common.clone();
    common.listen = ready::resolved(&common)?;
    common.agones = args.agones.then(fleet::agones_port).transpose()?;
    let served = serve(&loaded, &common, |page| {
        *begun = true;
        let line = ready::line(&common, page)?;
        if args.json {
            println!("{line}");
            let _ = std::io::stdout().flush();
        }
        args.ready_fd.map_or(Ok(()), |fd| ready::write(fd, &line))
    })?;
    if args.json {
        println!("{}", ready::report(&served));
    } else {
        summary(&served);
    }
    Ok(outcome(&served))
}

/// Exit code of a served session.
pub fn outcome(served: &EndedSession) -> Outcome {
    if served.self_check.is_some_and(|check| check.differences > 0) {
        return Outcome::Difference;
    }
    let incomplete = served.recording.failure.is_some() || served.recording.dropped > 0;
    if incomplete {
        Outcome::Fault
    } else {
        Outcome::Ok
    }
}

/// Runs a scene to its end. `ready` is called once all sockets are open, with the address of the
/// page.
pub fn serve(
    loaded: &file::Loaded,
    common: &Common,
    ready: impl FnOnce(Option<&str>) -> anyhow::Result<()>,
) -> anyhow::Result<EndedSession> {
    if common.with_parent {
        end_with_parent();
    }
    // A file that cannot be read is one problem of perhaps many: building lists them all.
    let unread = |error| loaded.build().err().unwrap_or_else(|| loaded.locate(error));
    let mut effective = inline_files(&loaded.spec, &loaded.directory).map_err(unread)?;
    effective.record.views &= !common.recording.no_views;
    let scene = Arc::new(loaded.built_to_run(&effective)?);
    super::scenes::warn(loaded, &scene);
    let ros2 = common
        .ros2
        .then(|| Plan::of(&effective).map_err(|error| loaded.locate(error)))
        .transpose()?;
    let config = common.zenoh_config.clone();
    // Who connects to a router leaves the default port, which is the router's own, alone.
    let secure = common.access.identity.is_some();
    let listen = default_listen(config.as_deref(), &common.listen, &common.connect, secure)?;
    let (connect, listen) = meet(common, listen);
    let may_meet_others = !connect.is_empty() || config.is_some();
    let (session, mut open) = open_told(&SessionSettings {
        connect,
        listen: listen.clone(),
        config,
        role: match common.ros2 {
            true => Role::Router,
            false => Role::Peer,
        },
        access: common.access.of(&common.instance, &scene)?,
        patience: Some(patience(&scene)),
    })?;
    open.everybody
        .extend(common.page.everybody(common.access.insecure)?);
    let open = super::access::announce(open);
    if may_meet_others {
        let keys = Keys::new(&common.instance)?;
        if let Some(other) = daemon_of(&session, &keys, LOOK_FOR_OTHERS)? {
            anyhow::bail!(
                "instance {:?} is served already, by session {other}: both would answer its tools; choose another \
                 name with --instance, or stop that daemon",
                common.instance
            );
        }
    }
    let for_ros2 = session.clone();
    let health = common.agones.map(|_| Arc::<Health>::default());
    let (mut viewer, feed) = common
        .page
        .start(&common.instance, &scene, &session, false, &open)?
        .unzip();
    // After all that may be refused: a file that was begun would be in the way of the next start.
    let (mut recorder, journal) = Recorder::start(
        common
            .recording
            .settings(loaded, &effective, &common.instance),
        &scene,
    )?;
    let (tick_ports, bus_ports) = ports(&scene);
    let counters = bus_ports.counters.clone();
    let stopper = counters.clone();
    let watched = session.clone();
    let stop_now = counters.clone();
    // The first signal lets forces fade and ends the recording; the second ends the program.
    let signals = AtomicU32::new(0);
    let _ = ctrlc::set_handler(move || {
        if signals.fetch_add(1, Ordering::Relaxed) > 0 {
            std::process::exit(130);
        }
        counters.stop.store(true, Ordering::Release);
    });
    // Who checks itself runs one scene twice.
    let editor = match common.self_check {
        None => Some(Box::new(SceneEditor::start(recorder.changes())?) as Box<dyn Editor>),
        Some(_) => None,
    };
    let counts = palpate_adapters::AdapterCounts::default();
    let bus = Bus::start(
        session,
        bus_ports,
        BusSettings {
            scene: scene.clone(),
            scene_hash: loaded.sha256,
            instance: common.instance.clone(),
            open,
            viewer: feed,
            recorder: Some(recorder.gauges()),
            archive: recorder.archive(),
            editor,
            viewer_url: viewer.as_ref().and_then(Viewer::url),
            player: None,
            adapters: counts.clone(),
            health: health.clone(),
        },
    )
    .map_err(|e| anyhow::anyhow!("{e}"))?;
    if let Some(viewer) = &mut viewer {
        viewer.open();
    }
    let settings = DriverSettings {
        clock: scene.clock,
        ticks: common
            .duration
            .filter(|_| scene.clock == Clock::Lockstep)
            .map(|duration| (duration.as_secs_f64() / scene.dt_s).round() as u64),
        privileged: !common.no_rt,
        follow: !common.fixed_phase,
        threads: common.threads.map_or(usize::MAX, usize::from),
    };
    let (self_check, journal) = match common.self_check {
        None => (None, Box::new(journal) as Box<dyn Journal>),
        Some(every) => {
            let (check, port) = SelfCheck::start(&scene, every as usize, Box::new(journal))?;
            (Some(check), Box::new(port) as Box<dyn Journal>)
        }
    };
    // Dropped last: it reports that the daemon ends.
    let agones = match (common.agones, health) {
        (Some(port), Some(health)) => {
            let keys = Keys::new(&common.instance)?;
            Some(Agones::start(port, &watched, &keys, health)?)
        }
        _ => None,
    };
    let in_use = agones.as_ref().map(|agones| Box::new(agones.in_use()) as _);
    watchdog::start(&scene, common, watched, stopper, in_use)?;
    let thread = driver::start(scene.clone(), tick_ports, journal, settings)?;
    tracing::info!(
        scene = scene.name, instance = common.instance, listen = listen.join(","), clock = ?scene.clock,
        "serving; poses on palpate/{}/tool/ID/pose", common.instance
    );
    let ros2 = ros2
        .map(|plan| Ros2::start(&for_ros2, &common.instance, &plan, &counts))
        .transpose();
    let igtl = common
        .igtl
        .map(|port| start_igtl(&for_ros2, common, &scene, port));
    let igtl = igtl.transpose();
    if ros2.is_err() || igtl.is_err() {
        // Without its devices the daemon is of no use.
        stop_now.stop.store(true, Ordering::Release);
    }
    let begun = ready(viewer.as_ref().and_then(Viewer::url).as_deref());
    let report = thread
        .join()
        .map_err(|_| anyhow::anyhow!("the tick thread panicked"));
    // While the session is open: devices get a last force of zero.
    let ros2 = ros2.map(drop);
    let igtl = igtl.map(drop);
    let bus_report = bus.finish();
    let self_check = self_check.map(SelfCheck::finish);
    drop(viewer);
    let recording = recorder.finish();
    if let Some(error) = &recording.failure {
        eprintln!("the recording is incomplete: {error}");
    }
    drop(agones);
    begun?;
    ros2?;
    igtl?;
    tracing::debug!(events = bus_report.events, poses = ?bus_report.poses, suppressed = ?bus_report.suppressed, "bus closed");
    let report = report?;
    if settings.privileged && !report.privileges.fifo && scene.clock == Clock::Realtime {
        tracing::warn!("SCHED_FIFO was refused: ticks can start late; see `palpate doctor`");
    }
    Ok(EndedSession {
        report,
        recording,
        self_check,
    })
}

/// How long a daemon that connects to others looks for one of its own name.
const LOOK_FOR_OTHERS: Duration = Duration::from_millis(500);

/// Where to connect and to listen. `rmw_zenohd` listens where we do by default: if it is there, it is
/// the router; if not, we are.
fn meet(common: &Common, listen: Vec<String>) -> (Vec<String>, Vec<String>) {
    let mut connect = common.connect.clone();
    let by_default = common.listen.is_empty() && common.zenoh_config.is_none();
    if !(common.ros2 && by_default) {
        return (connect, listen);
    }
    let (taken, free) = listen.into_iter().partition::<Vec<_>, _>(|at| is_taken(at));
    for endpoint in taken {
        tracing::info!(endpoint, "a router is there already: connecting to it");
        if !connect.contains(&endpoint) {
            connect.push(endpoint);
        }
    }
    (connect, free)
}

fn start_igtl(
    session: &zenoh::Session,
    common: &Common,
    scene: &Scene,
    port: u16,
) -> anyhow::Result<Igtl> {
    let tools = (0..scene.tool_count()).map(|tool| scene.tool_id(tool).to_owned());
    let igtl = Igtl::start(session, &common.instance, tools.collect(), port)
        .with_context(|| format!("--igtl {port}: cannot listen"))?;
    eprintln!("openigtlink: {}", igtl.address());
    Ok(igtl)
}

/// Asks the system to send the terminating signal when the parent process ends.
#[allow(unsafe_code)]
fn end_with_parent() {
    // SAFETY: a plain system call that concerns this process only.
    unsafe {
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
    }
}
