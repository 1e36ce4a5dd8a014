//! A daemon as a separate process.
#![allow(dead_code)]

use palpate_client::{Connect, Palpate};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate");

static QUIET: Mutex<()> = Mutex::new(());

/// Held by tests that take most of a small machine, and by those that measure times to which it matters.
pub fn quiet() -> MutexGuard<'static, ()> {
    QUIET.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A port that nobody listens on and no other test of this program gets, below those that the system
/// gives to connections.
pub fn free_port() -> u16 {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = std::process::id() % 1000 * 251 + NEXT.fetch_add(1, Ordering::Relaxed);
        let port = 12_000 + (number % 20_000) as u16;
        // Not by listening: a process that is started meanwhile would hold the port for a moment.
        if TcpStream::connect(("127.0.0.1", port)).is_err() {
            return port;
        }
    }
}

/// A daemon in a process of its own; killed when dropped.
pub struct Daemon {
    pub child: Child,
    pub endpoint: String,
}

impl Daemon {
    /// Serves a scene on a free port.
    pub fn start(directory: &Path, text: &str, arguments: &[&str]) -> Self {
        Self::start_at(free_port(), directory, text, arguments)
    }

    /// Serves a scene on a port.
    pub fn start_at(port: u16, directory: &Path, text: &str, arguments: &[&str]) -> Self {
        let scene = directory.join("scene.toml");
        std::fs::write(&scene, text).unwrap();
        let mut command = Command::new(PROGRAM);
        command
            .arg("serve")
            .arg(&scene)
            .arg("--no-rt")
            .args(arguments);
        Self::spawn(port, &mut command)
    }

    /// Whatever listens on a port that it is told with `--listen`.
    pub fn spawn(port: u16, command: &mut Command) -> Self {
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let command = command.args(["--listen", &endpoint]).stdin(Stdio::null());
        let child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let started = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(
                started.elapsed() < Duration::from_secs(60),
                "nobody listens"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        Self { child, endpoint }
    }

    pub fn connect(&self) -> Palpate {
        Palpate::connect(&Connect {
            timeout: Duration::from_secs(20),
            ..Connect::to(&self.endpoint)
        })
        .unwrap()
    }

    /// Waits for the end; gives stdout and the exit code.
    pub fn end(mut self) -> (String, i32) {
        let mut text = String::new();
        std::io::Read::read_to_string(self.child.stdout.as_mut().unwrap(), &mut text).unwrap();
        let status = self.child.wait().unwrap();
        (text, status.code().unwrap_or(-1))
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs a simulated device to its end; gives stdout and the exit code.
pub fn device(endpoint: &str, arguments: &[&str]) -> (String, i32) {
    let output = Command::new(PROGRAM)
        .args(["device", "--tool", "ball", "--json", "--connect", endpoint])
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        output.status.code().unwrap_or(-1),
    )
}

/// Runs parts of a test at the same time, each under its name: those that wait more than they compute.
macro_rules! side_by_side {
    ($($part:path),* $(,)?) => {
        crate::daemon::run_side_by_side(&[$((stringify!($part), $part)),*])
    };
}
pub(crate) use side_by_side;

pub fn run_side_by_side(parts: &[(&str, fn())]) {
    std::thread::scope(|scope| {
        let run = |(name, part): &(&str, fn())| {
            let thread = std::thread::Builder::new().name((*name).to_owned());
            thread.spawn_scoped(scope, *part).unwrap()
        };
        let running: Vec<_> = parts.iter().map(run).collect();
        let ended: Vec<_> = running.into_iter().map(|part| part.join()).collect();
        let failed = parts.iter().zip(ended).filter(|(_, end)| end.is_err());
        let failed: Vec<&str> = failed.map(|((name, _), _)| *name).collect();
        assert!(failed.is_empty(), "failed: {failed:?}");
    });
}
