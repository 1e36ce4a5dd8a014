//! For how long a force acts after the last one came: every client and adapter, when daemon, client or
//! network stop without a word. Prints the table of docs/security.md; `BLESS=1` writes it there.

mod paths;
mod table;

use crate::daemon::{Daemon, free_port, quiet};
use crate::devices::peer::{Peer, pose};
use crate::devices::ros2::open_router;
use crate::page::serve;
use palpate_devices::ros2::PoseStamped;
use paths::*;
use rustix::process::Signal;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use table::*;

/// The force acts, N.
const FELT: f64 = 0.4;
/// After an event.
const WATCHED: Duration = Duration::from_millis(400);
/// For traces that look each millisecond, ticks of 4 ms, pipes and pictures of 16 ms.
const ALLOWANCE: Duration = Duration::from_millis(25);
/// Most that is allowed for a busy machine: three times what a bare timer was late, and what threads of the daemons and
/// of this process waited for a processor. With the longest promise this is less than [`WATCHED`], so a force that stays
/// is still seen.
const MOST_BUSY: Duration = Duration::from_millis(200);
/// An attempt in which this machine was busier than its timer says is made again.
const ATTEMPTS: usize = 3;

fn scene(tools: &[&str]) -> String {
    // With all clients at 1 kHz two slow cores cannot keep the rate, and a loop that cannot sends no force.
    let mut text =
        "[loop]\nrate_hz = 250\n[[body]]\nid = \"ball\"\nsurface = { builtin = \"sphere\", size = 0.02 }\n".to_owned();
    for tool in tools {
        let _ = write!(
            text,
            "[[tool]]\nid = \"{tool}\"\nshape = {{ sphere = {{ radius_m = 0.01 }} }}\n\
             pose = {{ position = [0.0, 0.0, 0.035] }}\ncoupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}\n"
        );
    }
    text
}

/// A path that a force takes to a hand.
struct Line {
    name: &'static str,
    trace: Trace,
}

/// Everything that is on the daemon of one attempt.
struct Rig {
    daemon: Daemon,
    ros: Daemon,
    paths: Vec<Line>,
    /// Behind the link that can be cut.
    far: Vec<Line>,
    mute: Trace,
    haply: Trace,
    driver: Trace,
    cut: Arc<AtomicBool>,
    adapter: Process,
    guard: Process,
    silent: Process,
    device: Process,
    skipped: Vec<&'static str>,
    /// Daemon, Haply service, router; and the file of the motion.
    places: [String; 4],
    probe: Probe,
    // Dropped last: what they read is gone then.
    _children: Vec<Process>,
    _router: zenoh::Session,
    _files: tempfile::TempDir,
    _threads: Threads,
}

fn haply_adapter(endpoint: &str, service: &str) -> Process {
    Process::palpate(&format!(
        "device --tool haply --hardware haply --uri {service} --force-max 6 --connect {endpoint} --for 300s"
    ))
}

fn silent_client(endpoint: &str, motion: &str) -> Process {
    Process::palpate(&format!(
        "device --tool silent --connect {endpoint} --motion {motion} --hand firm --for 300s"
    ))
}

fn ros_guard(router: &str) -> Process {
    Process::palpate(&format!(
        "device --guard crtk /arm --connect {router} --for 300s"
    ))
}

impl Rig {
    fn start() -> Self {
        let files = tempfile::tempdir().unwrap();
        let mut threads = Threads::default();
        let probe = Probe::start(&mut threads);
        let (mut children, mut skipped) = (Vec::new(), Vec::new());
        let tools = [
            "hand", "far", "py", "pyfar", "bridge", "haply", "device", "silent",
        ];
        let text = scene(&tools);
        let (daemon, port) = serve(files.path(), &text, &[]);
        let endpoint = daemon.endpoint.clone();
        let (beyond, cut) = cuttable(&endpoint);
        let path = |name, trace| Line { name, trace };
        let mut paths = vec![path(RUST, rust_client(&mut threads, &endpoint, "hand"))];
        let mut far = vec![path(RUST, rust_client(&mut threads, &beyond, "far"))];

        let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        if has_package(&python) {
            for (endpoint, tool, into) in
                [(&endpoint, "py", &mut paths), (&beyond, "pyfar", &mut far)]
            {
                let mut command = Command::new(&python);
                command
                    .arg(format!("{ROOT}/tests/readers/felt.py"))
                    .args([endpoint, tool])
                    .args(PRESSED.map(|x| x.to_string()))
                    .stderr(Stdio::null());
                let (process, traces) = printing::<3>(&mut threads, &mut command);
                children.push(process);
                into.extend(
                    PYTHON
                        .into_iter()
                        .zip(traces)
                        .map(|(name, trace)| path(name, trace)),
                );
            }
        } else {
            skipped.push("Python: the package is not installed");
        }
        let session = daemon.connect();
        match c_client(&mut threads, files.path(), &session) {
            Some((process, trace)) => {
                children.push(process);
                paths.push(path(C, trace));
            }
            None => skipped.push("C: no cc"),
        }
        match node_clients(&mut threads, files.path(), port) {
            Some((process, [package, page])) => {
                children.push(process);
                paths.extend([path(TYPESCRIPT, package), path(PAGE, page)]);
            }
            None => skipped.push("TypeScript, page: nothing is installed in clients/web (npm ci)"),
        }
        paths.push(path(ROSBRIDGE, rosbridge_client(&mut threads, port)));

        let motion = files.path().join("press.toml");
        let point = |time: f64, z: f64| {
            format!("[[waypoint]]\ntime_s = {time}\nposition = [0.0, 0.0, {z}]\n")
        };
        std::fs::write(&motion, point(0.0, 0.035) + &point(1.0, 0.0275)).unwrap();
        // Comes out now and then: after an adapter or a client was away its tool is inside, and feels nothing until it was out.
        let out = files.path().join("press_again.toml");
        let cycle = |k: i32| {
            let start = 6.0 * f64::from(k);
            point(start, 0.035) + &point(start + 0.2, 0.0275) + &point(start + 5.8, 0.0275)
        };
        std::fs::write(&out, (0..50).map(cycle).collect::<String>()).unwrap();
        let [motion, again] = [&motion, &out].map(|path| path.to_str().unwrap());
        let haply_port = free_port();
        children.push(Process::palpate(&format!(
            "device --as haply --port {haply_port} --motion {again} --hand firm --for 300s"
        )));
        let haply = haply_service(&mut threads, haply_port);
        let service = format!("ws://127.0.0.1:{haply_port}");
        let adapter = haply_adapter(&endpoint, &service);
        paths.push(path(HAPLY, haply.clone()));

        // A device of its own, whose tremor makes every force another one.
        let device = Process::palpate(&format!(
            "device --tool device --connect {endpoint} --motion {motion} --hand firm --tremor 2e-4 --for 300s --csv {}",
            files.path().join("device.csv").display()
        ));
        let silent = silent_client(&endpoint, again);
        let mute = Trace::default();
        let (heard, told) = (session.forces("silent").unwrap(), mute.clone());
        threads.spawn(move || {
            let _session = &session;
            let came = heard.newest().force;
            told.note(came.map_or(0.0, |force| norm(force.force)));
            std::thread::sleep(MS);
            true
        });

        // ROS 2 has a daemon of its own, which holds its tools for as long as it runs.
        let router = format!("tcp/127.0.0.1:{}", free_port());
        let routing = open_router(&router);
        let folder = files.path().join("ros");
        std::fs::create_dir(&folder).unwrap();
        let text =
            scene(&["arm"]) + "[[ros2.tool]]\ntool = \"arm\"\nforce = \"/arm/palpate/servo_cf\"\n";
        let ros = Daemon::start(&folder, &text, &["--ros2", "--connect", &router]);
        let guard = ros_guard(&router);
        let peer = Peer::connect(&router);
        let (bare, driver) = (
            ros_topic(&peer, "/arm/palpate/servo_cf"),
            ros_topic(&peer, "/arm/body/servo_cf"),
        );
        peer.await_listener::<PoseStamped>("/arm/measured_cp");
        paths.extend([path(ROS, bare), path(GUARDED, driver.clone())]);
        let (mut sent, mut hand, felt) = (0, Hand::default(), driver.clone());
        threads.spawn(move || {
            sent += 1;
            let place = hand.next(felt.newest());
            peer.put("/arm/measured_cp", &pose(1_000 + sent, place));
            std::thread::sleep(MS);
            true
        });
        Self {
            daemon,
            ros,
            paths,
            far,
            mute,
            haply,
            driver,
            cut,
            adapter,
            guard,
            silent,
            device,
            skipped,
            places: [endpoint, service, router, again.to_owned()],
            probe,
            _children: children,
            _router: routing,
            _files: files,
            _threads: threads,
        }
    }

    /// Waits until all of these are pressed.
    fn await_forces<'a>(&self, traces: impl Iterator<Item = (&'a str, &'a Trace)>) {
        for (name, trace) in traces {
            let begun = Instant::now();
            while trace.newest() < FELT {
                let patience = Duration::from_secs(60);
                assert!(begun.elapsed() < patience, "{name}: {} N", trace.newest());
                std::thread::sleep(5 * MS);
            }
        }
    }

    fn await_all(&self) {
        let far = self
            .far
            .iter()
            .filter(|_| !self.cut.load(Ordering::Relaxed));
        let paths = self.paths.iter().chain(far);
        let paths = paths.map(|path| (path.name, &path.trace));
        self.await_forces(paths.chain([("the daemon", &self.mute)]));
    }

    /// What comes of an event, at the ends of these paths.
    fn after(
        &self,
        table: &mut Table,
        event: usize,
        ends: &[(&'static str, &Trace)],
        happens: impl FnOnce(),
    ) {
        let at = Instant::now();
        let processes = [
            self.daemon.child.id(),
            self.ros.child.id(),
            std::process::id(),
        ];
        let before = processes.map(waited);
        happens();
        std::thread::sleep(WATCHED);
        let waits = processes.iter().zip(&before);
        let waits: Duration = waits
            .map(|(&process, before)| longest_wait(process, before))
            .sum();
        let allowed = ALLOWANCE + MOST_BUSY.min(3 * self.probe.worst_since(at) + waits);
        for (name, trace) in ends {
            table.note(name, event, trace.zero_after(at), allowed);
        }
    }

    fn run(mut self, table: &mut Table) {
        let (silent, haply, driver) = (self.mute.clone(), self.haply.clone(), self.driver.clone());
        let ends = [(DAEMON, &silent), (HAPLY, &haply), (GUARDED, &driver)];
        self.await_all();
        let clients = |signal| {
            for process in [&self.silent, &self.adapter, &self.guard] {
                process.signal(signal);
            }
        };
        self.after(table, CLIENT_STOPPED, &ends, || clients(Signal::STOP));
        clients(Signal::CONT);
        self.await_all();
        self.after(table, CLIENT_KILLED, &ends, || clients(Signal::KILL));
        let [endpoint, service, router, motion] = self.places.clone();
        // The tokens of those before are gone by then.
        self.adapter = haply_adapter(&endpoint, &service);
        self.guard = ros_guard(&router);
        self.silent = silent_client(&endpoint, &motion);
        self.await_all();
        let far: Vec<_> = self
            .far
            .iter()
            .map(|line| (line.name, &line.trace))
            .collect();
        self.after(table, CUT, &far, || self.cut.store(true, Ordering::Relaxed));
        let paths: Vec<_> = self
            .paths
            .iter()
            .map(|line| (line.name, &line.trace))
            .collect();
        let daemons = |signal| {
            for child in [&self.daemon.child, &self.ros.child] {
                send(child, signal);
            }
        };
        let at_stop = Instant::now();
        self.after(table, STOPPED, &paths, || daemons(Signal::STOP));
        daemons(Signal::CONT);
        self.await_all();
        let at_kill = Instant::now();
        self.after(table, KILLED, &paths, || daemons(Signal::KILL));
        self.device.signal(Signal::INT);
        self.device.0.wait().unwrap();
        let silences = silences(&self._files.path().join("device.csv"));
        for (event, at, silence) in [(STOPPED, at_stop, 0), (KILLED, at_kill, 1)] {
            let allowed = ALLOWANCE + MOST_BUSY.min(3 * self.probe.worst_since(at));
            table.note(DEVICE, event, silences.get(silence).copied(), allowed);
        }
        table.skipped.clone_from(&self.skipped);
    }
}

const MARKERS: [&str; 2] = [
    "<!-- watchdogs: measured by tests/daemon/watchdogs -->\n",
    "<!-- /watchdogs -->",
];

#[test]
fn a_force_is_gone_within_what_docs_security_md_promises_on_every_path() {
    let _quiet = quiet();
    let mut table = Table::default();
    for _ in 0..ATTEMPTS {
        Rig::start().run(&mut table);
        if table.broken().is_empty() {
            break;
        }
        println!("again: {:#?}", table.broken());
    }
    for skipped in &table.skipped {
        println!("skipped: {skipped}");
    }
    let measured = table.markdown();
    println!("{measured}");
    let broken = table.broken();
    assert!(broken.is_empty(), "{broken:#?}");

    let path = Path::new(ROOT).join("docs/security.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(MARKERS[0]).unwrap();
    let (written, after) = rest.split_once(MARKERS[1]).unwrap();
    if std::env::var_os("BLESS").is_some() {
        assert!(
            table.skipped.is_empty(),
            "the table needs every path: {:?}",
            table.skipped
        );
        std::fs::write(
            path,
            [before, MARKERS[0], &measured, MARKERS[1], after].concat(),
        )
        .unwrap();
        return;
    }
    let names = |table: &str| -> Vec<String> {
        let name = |line: &str| line.split('|').nth(1).unwrap_or_default().trim().to_owned();
        table.lines().map(name).collect()
    };
    assert_eq!(names(written), names(&measured), "BLESS=1 writes the table");
}
