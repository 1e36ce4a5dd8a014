//! `palpate serve --agones` beside a sidecar that is late, refuses, hangs or fails: a mock that answers as
//! Agones' SDK server does and notes what it is told.

use crate::daemon::{Daemon, PROGRAM, device, free_port, side_by_side};
use crate::scenes::SOFT_DROP;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What the sidecar does with a request; `calls`: requests of this path before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Does {
    Takes,
    Fails,
    Refuses,
    /// Accepts, reads and says nothing.
    Hangs,
    /// No HTTP.
    Babbles,
}

pub type Script = fn(path: &str, calls: usize) -> Does;

/// A request as it came.
#[derive(Clone, Debug)]
pub struct Call {
    path: String,
    method: String,
    body: String,
    json: bool,
    pub at: Instant,
    took: bool,
}

#[derive(Clone, Default)]
pub struct Log(Arc<Mutex<Vec<Call>>>);

impl Log {
    fn all(&self) -> Vec<Call> {
        self.0.lock().unwrap().clone()
    }

    pub fn of(&self, path: &str) -> Vec<Call> {
        let mut calls = self.all();
        calls.retain(|call| call.path == path);
        calls
    }

    /// Calls of a path that were taken.
    fn taken(&self, path: &str) -> usize {
        self.of(path).iter().filter(|call| call.took).count()
    }

    fn wait(&self, path: &str, count: usize) {
        let begun = Instant::now();
        while self.taken(path) < count {
            let waited = begun.elapsed();
            assert!(
                waited < Duration::from_secs(90),
                "{path} {count}: {:?}",
                self.all()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

pub struct Sidecar {
    port: u16,
    pub log: Log,
    allocated: Arc<AtomicBool>,
}

impl Sidecar {
    /// On a port on which nobody listens until [`Sidecar::listen`].
    fn later() -> Self {
        Self {
            port: free_port(),
            log: Log::default(),
            allocated: Arc::default(),
        }
    }

    pub fn start(script: Script) -> Self {
        let sidecar = Self::later();
        sidecar.listen(script);
        sidecar
    }

    fn listen(&self, script: Script) {
        let listener = TcpListener::bind(("127.0.0.1", self.port)).unwrap();
        let (log, allocated) = (self.log.clone(), self.allocated.clone());
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (log, allocated) = (log.clone(), allocated.clone());
                std::thread::spawn(move || answer(stream, script, &log, &allocated));
            }
        });
    }

    pub fn daemon(&self, directory: &Path, scene: &str, arguments: &[&str]) -> Daemon {
        let path = directory.join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let mut command = Command::new(PROGRAM);
        command
            .env("AGONES_SDK_HTTP_PORT", self.port.to_string())
            .args(["serve", "--agones", "--no-rt"])
            .arg(&path)
            .args(arguments);
        Daemon::spawn(free_port(), &mut command)
    }
}

fn answer(mut stream: TcpStream, script: Script, log: &Log, allocated: &AtomicBool) {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let mut line = String::new();
    if reader.read_line(&mut line).unwrap_or(0) == 0 {
        return;
    }
    let mut words = line.split(' ');
    let (method, path) = (words.next().unwrap(), words.next().unwrap());
    let (method, path) = (method.to_owned(), path.to_owned());
    let (mut length, mut json) = (0, false);
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        let line = line.trim().to_lowercase();
        if line.is_empty() {
            break;
        }
        if let Some(value) = line.strip_prefix("content-length: ") {
            length = value.parse().unwrap();
        }
        json |= line == "content-type: application/json";
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    let does = script(&path, log.of(&path).len());
    if path == "/allocate" && does == Does::Takes {
        allocated.store(true, Ordering::SeqCst);
    }
    log.0.lock().unwrap().push(Call {
        path: path.clone(),
        method,
        body: String::from_utf8(body).unwrap(),
        json,
        at: Instant::now(),
        took: does == Does::Takes,
    });
    let answered = match (does, path.as_str()) {
        (Does::Takes, "/gameserver") => {
            let state = match allocated.load(Ordering::SeqCst) {
                true => "Allocated",
                false => "Ready",
            };
            // As Agones' gateway writes it; numbers of 64 bits are texts there.
            let server = serde_json::json!({
                "object_meta": { "name": "palpate-x", "generation": "2" },
                "spec": { "health": { "disabled": false, "period_seconds": 1, "failure_threshold": 3 } },
                "status": { "state": state, "address": "127.0.0.1", "ports": [] },
            });
            http("200 OK", &server.to_string())
        }
        (Does::Takes, _) => http("200 OK", "{}"),
        (Does::Fails, _) => http("500 Internal Server Error", r#"{"code":13}"#),
        (Does::Refuses, _) => http("404 Not Found", ""),
        (Does::Babbles, _) => "\u{0}\u{7f}babble\r\n\r\n".to_owned(),
        (Does::Hangs, _) => {
            std::thread::sleep(Duration::from_secs(20));
            return;
        }
    };
    let _ = stream.write_all(answered.as_bytes());
}

fn http(status: &str, body: &str) -> String {
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )
}

/// Each call is a POST of an empty message, as the SDK's are.
fn check_form(log: &Log) {
    for call in log.all() {
        let form = (call.method.as_str(), call.body.as_str());
        match call.path.as_str() {
            "/gameserver" => assert_eq!(form, ("GET", "")),
            _ => assert_eq!((form, call.json), (("POST", "{}"), true), "{call:?}"),
        }
    }
}

#[test]
fn agones_is_told_of_a_daemon_by_any_sidecar() {
    side_by_side![
        agones_is_told_once_that_the_server_is_ready_in_use_and_over_and_often_that_it_is_healthy,
        a_sidecar_that_is_late_fails_hangs_or_babbles_is_tried_until_it_takes_the_news,
        a_sidecar_that_never_answers_keeps_nobody_from_ending,
    ];
}

fn agones_is_told_once_that_the_server_is_ready_in_use_and_over_and_often_that_it_is_healthy() {
    let directory = tempfile::tempdir().unwrap();
    let sidecar = Sidecar::start(|_, _| Does::Takes);
    let daemon = sidecar.daemon(directory.path(), SOFT_DROP, &["--idle-timeout", "1s"]);
    sidecar.log.wait("/ready", 1);
    // A server that waits to be taken is not idle.
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(sidecar.log.taken("/allocate"), 0);
    let (report, code) = device(&daemon.endpoint, &["--motion", "press", "--for", "2s"]);
    assert_eq!(code, 0, "{report}");
    sidecar.log.wait("/allocate", 1);
    // Nobody holds its tool any more: it ends, and says so last of all.
    let (_, code) = daemon.end();
    assert_eq!(code, 0);
    check_form(&sidecar.log);
    let all = sidecar.log.all();
    let once = |path| assert_eq!(sidecar.log.of(path).len(), 1, "{path}");
    ["/ready", "/allocate", "/shutdown"]
        .into_iter()
        .for_each(once);
    assert_eq!(all.last().unwrap().path, "/shutdown");
    let place = |path: &str| all.iter().position(|call| call.path == path).unwrap();
    assert!(place("/ready") < place("/allocate"));
    // The description asks for health within each second: it comes more often than the usual 2 s.
    let healthy = sidecar.log.of("/health");
    let seconds = (healthy[healthy.len() - 1].at - healthy[0].at).as_secs_f64();
    assert!(
        healthy.len() as f64 > 0.6 * seconds,
        "{} in {seconds} s",
        healthy.len()
    );
}

fn a_sidecar_that_is_late_fails_hangs_or_babbles_is_tried_until_it_takes_the_news() {
    let directory = tempfile::tempdir().unwrap();
    let sidecar = Sidecar::later();
    let daemon = sidecar.daemon(directory.path(), SOFT_DROP, &[]);
    // It plays all the while.
    let (report, code) = device(&daemon.endpoint, &["--motion", "press", "--for", "1s"]);
    assert_eq!(code, 0, "{report}");
    sidecar.listen(|path, calls| match (path, calls) {
        ("/ready", 0) | ("/allocate", 0 | 1) => Does::Fails,
        ("/ready", 1) | ("/health", 0) => Does::Hangs,
        ("/ready", 2) | ("/health", 1) => Does::Babbles,
        ("/ready", 3) | ("/shutdown", 0) => Does::Refuses,
        ("/gameserver", _) => Does::Fails,
        _ => Does::Takes,
    });
    sidecar.log.wait("/ready", 1);
    sidecar.log.wait("/allocate", 1);
    sidecar.log.wait("/health", 2);
    let (report, code) = device(&daemon.endpoint, &["--motion", "press", "--for", "1s"]);
    assert_eq!(code, 0, "{report}");
    let palpate = daemon.connect();
    palpate
        .rpc(palpate_client::proto::rpc::Call::Shutdown)
        .unwrap();
    drop(palpate);
    let (_, code) = daemon.end();
    assert_eq!(code, 0);
    check_form(&sidecar.log);
    assert_eq!(sidecar.log.of("/ready").len(), 5);
    assert_eq!(
        (
            sidecar.log.of("/shutdown").len(),
            sidecar.log.taken("/shutdown")
        ),
        (2, 1)
    );
    assert_eq!(
        (
            sidecar.log.of("/allocate").len(),
            sidecar.log.taken("/allocate")
        ),
        (3, 1)
    );
}

fn a_sidecar_that_never_answers_keeps_nobody_from_ending() {
    let directory = tempfile::tempdir().unwrap();
    let sidecar = Sidecar::start(|_, _| Does::Hangs);
    let daemon = sidecar.daemon(directory.path(), SOFT_DROP, &["--for", "1s"]);
    let (_, code) = daemon.end();
    assert_eq!(code, 0);
    assert!(!sidecar.log.of("/shutdown").is_empty());
    assert_eq!(sidecar.log.taken("/ready"), 0);
}

#[test]
fn without_agones_the_option_is_refused_in_plain_words() {
    for (port, word) in [
        (None, "is not set"),
        (Some("x"), "\"x\""),
        (Some("0"), "\"0\""),
        (Some("99999"), "99999"),
    ] {
        let mut command = Command::new(PROGRAM);
        command.args(["serve", "builtin:rigid-teardrop", "--agones", "--for", "1s"]);
        command
            .env_remove("AGONES_SDK_HTTP_PORT")
            .stdin(Stdio::null());
        if let Some(port) = port {
            command.env("AGONES_SDK_HTTP_PORT", port);
        }
        let done = command.output().unwrap();
        let err = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{err}");
        assert!(
            err.contains("AGONES_SDK_HTTP_PORT") && err.contains(word),
            "{err}"
        );
    }
}
