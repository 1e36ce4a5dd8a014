//! The paths of a force to a hand: clients, adapters, and what is felt at their ends.

use crate::daemon::PROGRAM;
use crate::devices::peer::Peer;
use palpate_client::{Connect, Palpate, Watchdog, pose_at};
use palpate_devices::ros2::{RosMessage as _, WrenchStamped, topic_subscription};
use rustix::process::{Pid, Signal};
use std::collections::HashMap;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use zenoh::Wait as _;

pub const ROOT: &str = env!("CARGO_MANIFEST_DIR");
pub const MS: Duration = Duration::from_millis(1);
/// Two millimetres into a ball of radius 20 mm, with one of 10 mm: 1 N.
pub const PRESSED: [f64; 3] = [0.0, 0.0, 0.028];

pub fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What a hand at the end of a path would feel over time, N.
#[derive(Clone, Default)]
pub struct Trace(Arc<Mutex<Vec<(Instant, f64)>>>);

impl Trace {
    pub fn note(&self, newtons: f64) {
        self.0.lock().unwrap().push((Instant::now(), newtons));
    }

    pub fn newest(&self) -> f64 {
        self.0.lock().unwrap().last().map_or(0.0, |last| last.1)
    }

    /// From an event to the begin of the zeros that last; `None` where the force does, or where there was none.
    pub fn zero_after(&self, event: Instant) -> Option<Duration> {
        let values = self.0.lock().unwrap();
        values
            .iter()
            .rfind(|value| value.0 < event && value.1 > 0.1)?;
        let first = values
            .iter()
            .rposition(|value| value.1 > 1e-9)
            .map_or(0, |last| last + 1);
        values
            .get(first)
            .map(|zero| zero.0.saturating_duration_since(event))
    }
}

/// A process of ours: killed at the end, and after it was stopped.
pub struct Process(pub Child);

impl Process {
    /// Our program, with arguments in one line.
    pub fn palpate(line: &str) -> Self {
        let mut command = Command::new(PROGRAM);
        command.args(line.split(' ')).stdin(Stdio::null());
        Self(
            command
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap(),
        )
    }

    pub fn signal(&self, signal: Signal) {
        send(&self.0, signal);
    }
}

pub fn send(child: &Child, signal: Signal) {
    rustix::process::kill_process(Pid::from_child(child), signal).unwrap();
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Work on a thread of its own until the test ends.
#[derive(Default)]
pub struct Threads {
    stop: Arc<AtomicBool>,
    all: Vec<std::thread::JoinHandle<()>>,
}

impl Threads {
    pub fn spawn(&mut self, mut turn: impl FnMut() -> bool + Send + 'static) {
        let stop = self.stop.clone();
        self.all.push(std::thread::spawn(move || {
            while !stop.load(Ordering::Relaxed) && turn() {}
        }));
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.all.drain(..) {
            let _ = thread.join();
        }
    }
}

/// How late this machine wakes threads: what nobody can be blamed for.
#[derive(Clone, Default)]
pub struct Probe(Arc<Mutex<Vec<(Instant, Duration)>>>);

impl Probe {
    pub fn start(threads: &mut Threads) -> Self {
        let probe = Self::default();
        let told = probe.clone();
        threads.spawn(move || {
            let due = Instant::now() + MS;
            std::thread::sleep(MS);
            let late = due.elapsed();
            told.0.lock().unwrap().push((Instant::now(), late));
            true
        });
        probe
    }

    pub fn worst_since(&self, event: Instant) -> Duration {
        let waits = self.0.lock().unwrap();
        let since = waits.iter().filter(|wait| wait.0 > event);
        since.map(|wait| wait.1).max().unwrap_or_default()
    }
}

/// How long the threads of a process stood ready and got no processor: by thread, since it began.
pub fn waited(process: u32) -> HashMap<String, Duration> {
    let threads = std::fs::read_dir(format!("/proc/{process}/task"));
    let waited = threads
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|thread| {
            let times = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
            let ns = times.split_whitespace().nth(1)?.parse().ok()?;
            let name = thread.file_name().into_string().ok()?;
            Some((name, Duration::from_nanos(ns)))
        });
    waited.collect()
}

/// The longest that one thread waited since then.
pub fn longest_wait(process: u32, before: &HashMap<String, Duration>) -> Duration {
    let since = |(thread, now): (String, Duration)| {
        now.saturating_sub(before.get(&thread).copied().unwrap_or_default())
    };
    waited(process)
        .into_iter()
        .map(since)
        .max()
        .unwrap_or_default()
}

/// A link that can go silent without closing.
pub fn cuttable(endpoint: &str) -> (String, Arc<AtomicBool>) {
    let to = endpoint.strip_prefix("tcp/").unwrap().to_owned();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let here = format!("tcp/{}", listener.local_addr().unwrap());
    let cut = Arc::new(AtomicBool::new(false));
    let is_cut = cut.clone();
    std::thread::spawn(move || {
        for near in listener.incoming() {
            let (Ok(near), Ok(far)) = (near, TcpStream::connect(&to)) else {
                return;
            };
            for (mut from, mut to) in [
                (near.try_clone().unwrap(), far.try_clone().unwrap()),
                (far, near),
            ] {
                let is_cut = is_cut.clone();
                std::thread::spawn(move || {
                    let mut bytes = [0; 65_536];
                    while let Ok(count @ 1..) = from.read(&mut bytes) {
                        // What is sent now gets lost, and nobody is told.
                        if !is_cut.load(Ordering::Relaxed) && to.write_all(&bytes[..count]).is_err()
                        {
                            return;
                        }
                    }
                });
            }
        }
    });
    (here, cut)
}

/// A hand that presses. Inside a body it would feel nothing: it comes from outside, again for as long as that did not help.
#[derive(Default)]
pub struct Hand {
    step: u32,
}

impl Hand {
    const STEPS: u32 = 50;

    pub fn next(&mut self, felt_n: f64) -> [f64; 3] {
        self.step = (self.step + 1) % (6 * Self::STEPS);
        if felt_n > 0.0 {
            self.step = self.step.min(Self::STEPS);
        }
        let share = (f64::from(self.step) / f64::from(Self::STEPS)).min(1.0);
        let [x, y, z] = PRESSED;
        [x, y, z + 0.007 * (1.0 - share)]
    }
}

/// A Rust client that presses, and what it would pass on.
pub fn rust_client(threads: &mut Threads, endpoint: &str, tool: &str) -> Trace {
    let palpate = Palpate::connect(&Connect {
        timeout: Duration::from_secs(20),
        ..Connect::to(endpoint)
    })
    .unwrap();
    let mut tool = palpate.tool(tool).unwrap();
    let trace = Trace::default();
    let (told, mut hand) = (trace.clone(), Hand::default());
    threads.spawn(move || {
        let _session = &palpate;
        let felt = tool.force().map_or(0.0, |force| norm(force.force));
        let _ = tool.send(pose_at(hand.next(felt)));
        told.note(felt);
        std::thread::sleep(MS);
        true
    });
    trace
}

/// A program that prints numbers; a trace of each column.
pub fn printing<const N: usize>(
    threads: &mut Threads,
    command: &mut Command,
) -> (Process, [Trace; N]) {
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let traces: [Trace; N] = std::array::from_fn(|_| Trace::default());
    let told = traces.clone();
    threads.spawn(move || {
        let Some(Ok(line)) = lines.next() else {
            return false;
        };
        for (word, trace) in line.split_whitespace().zip(&told) {
            trace.note(word.parse().unwrap());
        }
        true
    });
    (Process(child), traces)
}

/// The C program, which is handed the bytes of forces.
pub fn c_client(
    threads: &mut Threads,
    directory: &Path,
    session: &Palpate,
) -> Option<(Process, Trace)> {
    let program = directory.join("felt");
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-I"])
        .arg(format!("{ROOT}/clients/c"))
        .arg("-o")
        .arg(&program)
        .arg(format!("{ROOT}/tests/readers/felt.c"))
        .arg("-lm")
        .status()
        .ok()?;
    assert!(compiled.success());
    let (mut process, [trace]) = printing(threads, &mut Command::new(program));
    let mut input = process.0.stdin.take().unwrap();
    let (bytes, inbox) = std::sync::mpsc::channel::<Vec<u8>>();
    let subscriber = session
        .watch(&session.keys().tool_force("hand"), move |seen| {
            let _ = bytes.send(seen.bytes);
        })
        .unwrap();
    threads.spawn(move || {
        let _subscriber = &subscriber;
        let Ok(force) = inbox.recv_timeout(10 * MS) else {
            return true;
        };
        let mut framed = (force.len() as u16).to_le_bytes().to_vec();
        framed.extend(force);
        input.write_all(&framed).is_ok()
    });
    Some((process, trace))
}

/// The TypeScript package and the page, bundled aside: other tests bundle them in their place.
pub fn node_clients(
    threads: &mut Threads,
    directory: &Path,
    port: u16,
) -> Option<(Process, [Trace; 2])> {
    let web = format!("{ROOT}/clients/web");
    if !Path::new(&web).join("node_modules/ws").is_dir() {
        return None;
    }
    let bundle = |from: &str, to: &str| {
        let to = directory.join(to);
        let done = Command::new(format!("{web}/node_modules/.bin/esbuild"))
            .args([
                from,
                "--bundle",
                "--format=esm",
                "--platform=node",
                "--target=es2022",
            ])
            .args([
                "--log-level=warning",
                &format!("--outfile={}", to.display()),
            ])
            .current_dir(&web)
            .status();
        assert!(done.unwrap().success());
        to
    };
    let modules = [
        bundle("src/index.ts", "palpate.mjs"),
        bundle("src/page/testing.ts", "page.mjs"),
        Path::new(&web).join("node_modules/ws/wrapper.mjs"),
    ];
    let mut command = Command::new("node");
    command
        .arg(format!("{ROOT}/tests/readers/felt.mjs"))
        .args([&port.to_string(), "hand"])
        .args(modules);
    Some(printing(threads, &mut command))
}

/// A client of rosbridge with a watchdog of its own: over a socket that a stopped daemon does not close
/// nothing else can know.
pub fn rosbridge_client(threads: &mut Threads, port: u16) -> Trace {
    let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_nodelay(true).unwrap();
    let request = format!("ws://127.0.0.1:{port}/rosbridge");
    let (mut socket, _) = tungstenite::client(request, stream).unwrap();
    let mut say = move |text: serde_json::Value| {
        let _ = socket.send(tungstenite::Message::text(text.to_string()));
        socket.get_ref().set_read_timeout(Some(MS)).unwrap();
        socket.read()
    };
    let _ = say(serde_json::json!({ "op": "subscribe", "topic": "/bridge/body/servo_cf" }));
    let trace = Trace::default();
    let (told, mut dog, mut newest) = (trace.clone(), Watchdog::new(false), 0.0);
    let mut hand = Hand::default();
    let pose = |[x, y, z]: [f64; 3]| {
        serde_json::json!({ "op": "publish", "topic": "/bridge/measured_cp", "msg": {
            "header": { "frame_id": "world" },
            "pose": {
                "position": { "x": x, "y": y, "z": z }, "orientation": { "x": 0, "y": 0, "z": 0, "w": 1 },
            },
        }})
    };
    threads.spawn(move || {
        match say(pose(hand.next(newest))) {
            Ok(tungstenite::Message::Text(text)) => {
                let said: serde_json::Value = serde_json::from_str(&text).unwrap();
                let force = &said["msg"]["wrench"]["force"];
                if force.is_object() {
                    newest = norm(["x", "y", "z"].map(|c| force[c].as_f64().unwrap()));
                    dog.heard(Instant::now());
                }
            }
            Ok(_) => {}
            Err(_) => std::thread::sleep(MS),
        }
        told.note(dog.gain(Instant::now()) * newest);
        true
    });
    trace
}

/// What reaches a ROS driver, which applies the last wrench until another comes.
pub fn ros_topic(peer: &Peer, topic: &str) -> Trace {
    let trace = Trace::default();
    let told = trace.clone();
    peer.session
        .declare_subscriber(topic_subscription(0, topic, WrenchStamped::TYPE))
        .callback(move |sample| {
            let wrench: WrenchStamped =
                palpate_devices::cdr::decode(&sample.payload().to_bytes()).unwrap();
            told.note(norm(wrench.force));
        })
        .background()
        .wait()
        .unwrap();
    trace
}

/// The force of the simulated Haply device, asked for by a second program.
pub fn haply_service(threads: &mut Threads, port: u16) -> Trace {
    let connected = |port| TcpStream::connect(("127.0.0.1", port)).ok();
    let begun = Instant::now();
    let stream = loop {
        match connected(port) {
            Some(stream) => break stream,
            None => assert!(begun.elapsed() < Duration::from_secs(60), "no service"),
        }
        std::thread::sleep(20 * MS);
    };
    let (mut socket, _) = tungstenite::client(format!("ws://127.0.0.1:{port}"), stream).unwrap();
    let trace = Trace::default();
    let told = trace.clone();
    socket.read().unwrap();
    threads.spawn(move || {
        let text = tungstenite::Message::text("{\"inverse3\":[]}");
        let Ok(tungstenite::Message::Text(text)) = socket.send(text).and_then(|()| socket.read())
        else {
            return false;
        };
        let said: serde_json::Value = serde_json::from_str(&text).unwrap();
        let force = &said["inverse3"][0]["state"]["current_cursor_force"];
        told.note(norm(["x", "y", "z"].map(|c| force[c].as_f64().unwrap())));
        std::thread::sleep(MS);
        true
    });
    trace
}

pub fn has_package(python: &str) -> bool {
    let asked = Command::new(python)
        .args(["-c", "import palpate; palpate.Tool"])
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// From the last force that came to the first zero, of each time that a device was let go for long: it writes
/// a line a millisecond, and its tremor makes every force another one.
pub fn silences(csv: &Path) -> Vec<Duration> {
    let text = std::fs::read_to_string(csv).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heading = lines.next().unwrap();
    let first = heading
        .iter()
        .position(|name| *name == "received_x_n")
        .unwrap();
    let forces: Vec<f64> = lines
        .map(|row| norm([0, 1, 2].map(|c| row[first + c].parse().unwrap())))
        .collect();
    let mut found = Vec::new();
    let mut k = 1;
    while k < forces.len() {
        let zeros = forces[k..]
            .iter()
            .take_while(|force| **force == 0.0)
            .count();
        if zeros > 200 && forces[k - 1] > 0.0 {
            // Before the zeros the force fades, and before that it stays.
            let fades = |pair: &[f64]| pair[0] > pair[1];
            let fade = forces[..=k]
                .windows(2)
                .rev()
                .take_while(|pair| fades(pair))
                .count();
            let top = k - fade;
            let stays = forces[..=top]
                .iter()
                .rev()
                .take_while(|force| **force == forces[top]);
            found.push(MS * (fade + stays.count() - 1) as u32);
        }
        k += zeros.max(1);
    }
    found
}
