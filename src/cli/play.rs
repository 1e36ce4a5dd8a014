//! `palpate play`: a recording on the bus, as if it were live.

use super::Outcome;
use super::keys::{Key, Keys};
use crate::transport::{
    Bus, BusSettings, Role, SessionSettings, default_listen, open_told, patience,
};
use crate::viewer::Viewer;
use palpate_drive::playback::{PlayRequest, playback};
use palpate_drive::ports::ports;
use palpate_record::{PlayReport, PlaySettings, Player, Session, played_scene};
use sha2::Digest as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Sender;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// Ratio of simulated to real time: 0.1 is slow motion, 10000 as fast as possible.
    #[arg(long, default_value_t = 1.0, value_parser = rate)]
    rate: f64,
    /// Start paused.
    #[arg(long)]
    paused: bool,
    /// At the end, continue from the start.
    #[arg(long = "loop")]
    looped: bool,
    /// At the end, pause instead of exiting.
    #[arg(long, conflicts_with = "looped")]
    stay: bool,
    /// First tick to play.
    #[arg(long)]
    start: Option<u64>,
    /// Last tick to play.
    #[arg(long)]
    end: Option<u64>,
    /// Rename a tool or body, old:=new; can be repeated.
    #[arg(long, value_parser = remap)]
    remap: Vec<(String, String)>,
    /// Zenoh endpoint to listen on; can be repeated.
    #[arg(short, long, help_heading = "Bus")]
    listen: Vec<String>,
    /// Zenoh endpoint to connect to; can be repeated.
    #[arg(short = 'e', long, help_heading = "Bus")]
    connect: Vec<String>,
    /// Zenoh configuration file (JSON5).
    #[arg(long, help_heading = "Bus")]
    zenoh_config: Option<PathBuf>,
    /// Instance name.
    #[arg(long, default_value = "default", help_heading = "Bus")]
    instance: String,
    /// Print the summary as one JSON object.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    access: super::access::AccessArgs,
    #[command(flatten)]
    page: super::page::PageArgs,
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text
        .parse::<f64>()
        .ok()
        .filter(|rate| (1e-3..=1e4).contains(rate));
    rate.ok_or_else(|| "the rate must be a number from 0.001 to 10000".into())
}

fn remap(text: &str) -> Result<(String, String), String> {
    let (old, new) = text
        .split_once(":=")
        .ok_or("write old:=new, for example ball:=pen")?;
    Ok((old.to_owned(), new.to_owned()))
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let session = Session::open(&args.file)?;
    if let Some(reason) = session.cut_short() {
        eprintln!("note: the recording was cut short ({reason}); playing what it contains");
    }
    let scene = Arc::new(played_scene(&session, &args.remap)?);
    let scene_hash = sha2::Sha256::digest(session.header.scene_text.as_bytes()).into();
    let (tick_ports, bus_ports) = ports(&scene);
    let (end, port, own) = playback();
    let counters = bus_ports.counters.clone();
    let settings = PlaySettings {
        start: args.start,
        end: args.end,
        rate: args.rate,
        paused: args.paused,
        looped: args.looped,
        stay: args.stay,
    };
    let player = Player::new(session, scene.clone(), tick_ports, port, settings)?;
    let bus_of = |player_end| -> anyhow::Result<(Bus, Option<Viewer>)> {
        let own = args.zenoh_config.as_deref();
        let listen = default_listen(own, &args.listen, &[], args.access.identity.is_some())?;
        let config = args.zenoh_config.clone();
        let (bus_session, mut open) = open_told(&SessionSettings {
            connect: args.connect.clone(),
            listen,
            config,
            role: Role::Peer,
            access: args.access.of(&args.instance, &scene)?,
            patience: Some(patience(&scene)),
        })?;
        open.everybody
            .extend(args.page.everybody(args.access.insecure)?);
        let open = super::access::announce(open);
        let (mut viewer, feed) = args
            .page
            .start(&args.instance, &scene, &bus_session, true, &open)?
            .unzip();
        let settings = BusSettings {
            scene: scene.clone(),
            scene_hash,
            instance: args.instance.clone(),
            open,
            viewer: feed,
            viewer_url: viewer.as_ref().and_then(Viewer::url),
            recorder: None,
            archive: None,
            editor: None,
            player: Some(player_end),
            adapters: Default::default(),
            health: None,
        };
        let bus = Bus::start(bus_session, bus_ports, settings);
        let bus = bus.map_err(|e| anyhow::anyhow!("{e}"))?;
        if let Some(viewer) = &mut viewer {
            viewer.open();
        }
        Ok((bus, viewer))
    };
    let (bus, viewer) = bus_of(end)?;
    let signals = AtomicU32::new(0);
    let _ = ctrlc::set_handler(move || {
        counters.stop.store(true, Ordering::Release);
        if signals.fetch_add(1, Ordering::Relaxed) > 0 {
            Keys::restore();
            std::process::exit(130);
        }
    });
    let keys = Keys::listen(move |key| steer(key, &own));
    if keys.is_some() {
        eprintln!(
            "space: pause, right: one tick forward, left: one second back, up and down: rate, r: restart, q: quit"
        );
    }
    let (first, last) = player.range();
    tracing::info!(
        instance = args.instance,
        first,
        last,
        rate = args.rate,
        "playing {}",
        args.file.display()
    );
    let report = player.run(&scene);
    drop(keys);
    bus.finish();
    drop(viewer);
    let report = report?;
    print(&report, args)?;
    Ok(if report.gaps > 0 {
        Outcome::Fault
    } else {
        Outcome::Ok
    })
}

/// The command of a key. Number 0 means that no reply is awaited.
fn steer(key: Key, requests: &Sender<(u64, PlayRequest)>) {
    let request = match key {
        Key::Letter(b' ') => PlayRequest::Toggle,
        Key::Letter(b'r') => PlayRequest::Reset,
        Key::Letter(b'q') => PlayRequest::Stop,
        Key::Right => PlayRequest::Step(1),
        Key::Left => PlayRequest::Back,
        Key::Up => PlayRequest::Scale(2.0),
        Key::Down => PlayRequest::Scale(0.5),
        Key::Letter(_) => return,
    };
    let _ = requests.send((0, request));
}

fn print(report: &PlayReport, args: &Args) -> anyhow::Result<()> {
    if args.json {
        println!("{}", serde_json::to_string(report)?);
        return Ok(());
    }
    println!(
        "played {} ticks in {:.3} s: {:.3} x real time (asked for {}), {} late",
        report.ticks, report.wall_s, report.rate, args.rate, report.late
    );
    if report.gaps > 0 {
        println!("{} gaps in the recording were skipped", report.gaps);
    }
    if let Some(tick) = report.diverged {
        println!(
            "from tick {tick} on, forces are taken from the recording: this build diverges from it"
        );
    }
    Ok(())
}
