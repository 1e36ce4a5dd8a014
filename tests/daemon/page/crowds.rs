//! Crowds at the door: connections of every slow or silent kind, more than there are places. Health is asked for through
//! all of them, and a page is still served.

use super::TWO_BALLS;
use crate::page::{Page, serve};
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const HOST: &str = "Host: 127.0.0.1\r\n";
/// What a probe waits for an answer, as Kubernetes does if it is told nothing else.
const PROBE: Duration = Duration::from_secs(1);

/// One connection of a crowd: what it sends first, and then over and over.
struct Kind {
    name: &'static str,
    count: usize,
    first: Vec<u8>,
    then: Vec<u8>,
    reads: bool,
}

fn kind(name: &'static str, count: usize, first: impl Into<Vec<u8>>) -> Kind {
    Kind {
        name,
        count,
        first: first.into(),
        then: Vec::new(),
        reads: false,
    }
}

fn get(path: &str, headers: &str) -> String {
    format!("GET {path} HTTP/1.1\r\n{HOST}{headers}\r\n")
}

fn socket(path: &str) -> String {
    let headers = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
                   Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n";
    get(path, headers)
}

/// Frames of a WebSocket's client, masked with zero: their first byte and their bytes, many times.
fn frames(first: u8, payload: &[u8]) -> Vec<u8> {
    let one = [&[first, 0x80 | payload.len() as u8, 0, 0, 0, 0], payload].concat();
    one.repeat(4_000)
}

fn with_then(kind: Kind, then: impl Into<Vec<u8>>, reads: bool) -> Kind {
    let then = then.into();
    Kind {
        then,
        reads,
        ..kind
    }
}

fn crowds() -> Vec<Kind> {
    let half = format!("GET / HTTP/1.1\r\n{HOST}");
    let long = "Content-Length: 1000000000\r\n";
    let begun = |path, first: u8| [socket(path).as_bytes(), &[first, 0x80, 0, 0, 0, 0]].concat();
    vec![
        kind("idle", 200, ""),
        kind("half a head", 200, half.clone()),
        with_then(kind("a head that trickles", 200, half), "X: y\r\n", false),
        with_then(kind("a head byte by byte", 200, "G"), "E", false),
        kind("a script that nobody reads", 200, get("/app.js", "")),
        kind("pipelined", 150, get("/app.js", "").repeat(50)),
        kind(
            "metrics that nobody reads",
            150,
            get("/metrics", "").repeat(100),
        ),
        with_then(
            kind("a body that trickles", 150, get("/", long)),
            "x",
            false,
        ),
        with_then(
            kind(
                "health with a body that trickles",
                150,
                get("/healthz", long),
            ),
            "x",
            false,
        ),
        kind(
            "TLS",
            150,
            *b"\x16\x03\x01\x00\xc8\x01\x00\x00\xc4\x03\x03palpatepalpate",
        ),
        with_then(kind("kept alive", 150, get("/app.css", "")), "", true),
        kind("silent sockets", 150, socket("/live")),
        kind("silent viewers", 150, socket("/foxglove")),
        kind("silent clients of rosbridge", 150, socket("/rosbridge")),
        with_then(kind("pings", 16, socket("/live")), frames(0x89, b""), true),
        with_then(
            kind("pings of the mute", 16, socket("/live")),
            frames(0x89, b"ping"),
            false,
        ),
        with_then(
            kind("a byte a frame", 16, begun("/live", 2)),
            frames(0, b"x"),
            true,
        ),
        with_then(
            kind("frames without bytes", 16, begun("/live", 2)),
            frames(0, b""),
            true,
        ),
        with_then(
            kind("the same for rosbridge", 8, begun("/rosbridge", 1)),
            frames(0, b""),
            true,
        ),
    ]
}

/// Keeps a crowd at the door until `stop`; those that are closed come again. Counts how often it has looked after
/// all of them in `rounds`.
fn crowd(port: u16, kind: &Kind, count: usize, stop: &AtomicBool, rounds: &AtomicUsize) {
    let mut all: Vec<Option<TcpStream>> = (0..count).map(|_| None).collect();
    let mut buffer = vec![0; 64 << 10];
    while !stop.load(Ordering::Relaxed) {
        for one in &mut all {
            let open = || -> std::io::Result<TcpStream> {
                let mut stream = TcpStream::connect(("127.0.0.1", port))?;
                stream.write_all(&kind.first)?;
                stream.set_nonblocking(true)?;
                Ok(stream)
            };
            let Some(stream) = one.as_mut() else {
                *one = open().ok();
                continue;
            };
            let again = |error: &std::io::Error| error.kind() == ErrorKind::WouldBlock;
            let gone = if kind.reads {
                matches!(stream.read(&mut buffer), Ok(0))
            } else {
                matches!(stream.peek(&mut buffer), Ok(0))
            };
            let refused = stream.write(&kind.then).is_err_and(|e| !again(&e));
            if gone || refused {
                *one = None;
            }
        }
        rounds.fetch_add(1, Ordering::Relaxed);
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Asks within a time; the answer's status.
fn ask(port: u16, path: &str, patience: Duration) -> Result<u16, ErrorKind> {
    let begun = Instant::now();
    let mut stream = TcpStream::connect_timeout(&([127, 0, 0, 1], port).into(), patience)
        .map_err(|error| error.kind())?;
    let answer = (|| {
        stream.write_all(get(path, "Connection: close\r\n").as_bytes())?;
        let mut head = [0; 12];
        let left = patience.saturating_sub(begun.elapsed());
        stream.set_read_timeout(Some(left.max(Duration::from_millis(1))))?;
        stream.read_exact(&mut head)?;
        Ok(String::from_utf8_lossy(&head[9..]).into_owned())
    })();
    answer
        .map(|status: String| status.parse().unwrap_or(0))
        .map_err(|error: std::io::Error| error.kind())
}

/// A crowd comes; meanwhile, `probe`.
fn beset(port: u16, kind: &Kind, probe: impl FnOnce()) {
    let stop = AtomicBool::new(false);
    let rounds = [(); 2].map(|()| AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for rounds in &rounds {
            let stop = &stop;
            scope.spawn(move || crowd(port, kind, kind.count / 2, stop, rounds));
        }
        // All have come, and some more than once.
        let begun = Instant::now();
        let come = |rounds: &AtomicUsize| rounds.load(Ordering::Relaxed) > 3;
        while !rounds.iter().all(come) && begun.elapsed() < Duration::from_secs(1) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(probe));
        stop.store(true, Ordering::Relaxed);
        if let Err(panic) = done {
            std::panic::resume_unwind(panic);
        }
    });
}

/// Health answers in time. A try may fall to a machine that does other things; a server that takes seconds, or is mute for
/// fifteen, fails all six.
fn is_healthy(port: u16, path: &str, kind: &Kind) {
    let told = (0..6).any(|tried| {
        std::thread::sleep(Duration::from_millis(100 * tried));
        ask(port, path, PROBE) == Ok(200)
    });
    assert!(told, "{}: {path}", kind.name);
}

// Seen: 130 connections that say nothing, or one header a second, and health was not told for 15 s; sixteen sockets
// with frames of no bytes, and it took 3 s and more.
//
// The places of pages are the same for everybody, but those who ask go first.
#[test]
fn health_is_told_within_a_second_and_pages_open_whoever_stands_at_the_door() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    for kind in crowds() {
        beset(port, &kind, || {
            for path in ["/healthz", "/metrics"] {
                is_healthy(port, path, &kind);
            }
            let slow = ["idle", "a head that trickles", "a script that nobody reads"];
            if slow.contains(&kind.name) {
                page_opens(port, &kind);
            }
        });
    }
}

fn page_opens(port: u16, kind: &Kind) {
    let begun = Instant::now();
    // Who has not read for a second makes room.
    while ask(port, "/app.css", PROBE) != Ok(200) {
        assert!(begun.elapsed() < Duration::from_secs(10), "{}", kind.name);
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(Page::open(port).call("pause", "{}")["ok"], true);
}
