//! An operator's command has its effect at once, whatever clients do that stop reading.
//!
//! Readers reach the daemon through a tap: a socket between them that stops carrying what the daemon sends,
//! while everything that they ask still comes in.

use crate::daemon::{Daemon, free_port, quiet};
use crate::scenes::{RIGID_TEARDROP, with_large_net};
use palpate_client::Palpate;
use palpate_client::proto::messages::{EventKind, LoopState};
use palpate_client::proto::rpc::Call;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use zenoh::Wait;

/// What an operator is promised.
const PROMISED: Duration = Duration::from_millis(50);

/// A way to a daemon that can stop carrying what comes from there.
struct Tap {
    endpoint: String,
    stopped: Arc<AtomicBool>,
}

impl Tap {
    fn to(daemon: &Daemon) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", free_port())).unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        let upstream = daemon.endpoint.trim_start_matches("tcp/").to_owned();
        let stopped = Arc::new(AtomicBool::new(false));
        let closed = stopped.clone();
        std::thread::spawn(move || {
            for client in listener.incoming() {
                let (Ok(client), Ok(daemon)) = (client, TcpStream::connect(&upstream)) else {
                    return;
                };
                let (back, forth) = (daemon.try_clone().unwrap(), client.try_clone().unwrap());
                std::thread::spawn(move || carry(client, daemon, None));
                let closed = closed.clone();
                std::thread::spawn(move || carry(back, forth, Some(&closed)));
            }
        });
        Self { endpoint, stopped }
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::Release);
    }
}

fn carry(mut from: TcpStream, mut to: TcpStream, stopped: Option<&AtomicBool>) {
    let mut bytes = [0; 16 << 10];
    loop {
        while stopped.is_some_and(|stopped| stopped.load(Ordering::Acquire)) {
            std::thread::sleep(Duration::from_millis(50));
        }
        match from.read(&mut bytes) {
            Ok(count) if count > 0 && to.write_all(&bytes[..count]).is_ok() => {}
            _ => break,
        }
    }
    let _ = to.shutdown(Shutdown::Both);
}

/// The longest that a thread of this machine woke late meanwhile: what a busy machine adds to any answer.
struct Lateness {
    worst_us: Arc<AtomicU64>,
    over: Arc<AtomicBool>,
}

impl Lateness {
    fn watch() -> Self {
        let (worst_us, over) = (
            Arc::<AtomicU64>::default(),
            Arc::new(AtomicBool::new(false)),
        );
        let (seen, end) = (worst_us.clone(), over.clone());
        std::thread::spawn(move || {
            while !end.load(Ordering::Relaxed) {
                let before = Instant::now();
                std::thread::sleep(Duration::from_millis(1));
                let late = before.elapsed().saturating_sub(Duration::from_millis(1));
                seen.fetch_max(late.as_micros() as u64, Ordering::Relaxed);
            }
        });
        Self { worst_us, over }
    }

    fn take(&self) -> Duration {
        Duration::from_micros(self.worst_us.swap(0, Ordering::Relaxed))
    }
}

impl Drop for Lateness {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}

/// How long it took until a command had reached the loop, by the daemon's clock, which is this machine's,
/// beyond what the machine was late meanwhile. (The way back is through Zenoh's threads in this process,
/// which other tests keep busy.)
fn commanded(palpate: &Palpate, call: Call, late: &Lateness) -> Duration {
    let before = palpate
        .past_events(0)
        .unwrap()
        .last()
        .map_or(0, |event| event.seq);
    late.take();
    let sent = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    palpate.rpc(call).unwrap();
    let events = palpate.past_events(before).unwrap();
    let done = events
        .iter()
        .find(|event| matches!(event.kind, EventKind::Paused | EventKind::Resumed))
        .expect("its event");
    let took = Duration::from_nanos(done.t_ns).saturating_sub(sent);
    // Zenoh here and there, and the bus.
    took.saturating_sub(3 * late.take())
}

#[test]
fn a_pause_and_a_shutdown_wait_for_no_reader_that_has_stopped() {
    let _quiet = quiet();
    let scene = with_large_net();
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), &scene, &[]);
    let palpate = daemon.connect();
    let late = Lateness::watch();
    let quiet = commanded(&palpate, Call::Pause, &late);
    palpate.rpc(Call::Resume).unwrap();
    let taps: Vec<Tap> = (0..9).map(|_| Tap::to(&daemon)).collect();
    let sessions: Vec<zenoh::Session> = std::thread::scope(|scope| {
        let open = |tap: &Tap| {
            let endpoint = tap.endpoint.clone();
            scope.spawn(move || crate::wire::bare(&endpoint))
        };
        let opening: Vec<_> = taps.iter().map(open).collect();
        opening.into_iter().map(|one| one.join().unwrap()).collect()
    });
    let mut kept = Vec::new();
    let mut subscribers = Vec::new();
    for (k, (tap, session)) in taps.iter().zip(&sessions).enumerate() {
        match k % 3 {
            // Asks for large answers and stops.
            0 => {
                tap.stop();
                for _ in 0..100 {
                    kept.push(session.get("palpate/default/scene").wait().unwrap());
                }
            }
            // Hears everything and stops.
            1 => {
                let all = session.declare_subscriber("palpate/**");
                subscribers.push(all.callback(|_| {}).wait().unwrap());
                std::thread::sleep(Duration::from_millis(100));
                tap.stop();
            }
            // Gives commands that are refused, more than may wait, and stops.
            _ => {
                tap.stop();
                let nonsense = format!("{{\"{}\": 1}}", "x".repeat(4000));
                for _ in 0..1000 {
                    let get = session.get("palpate/default/rpc/step");
                    kept.push(get.payload(nonsense.as_str()).wait().unwrap());
                }
            }
        }
    }
    let mut worst = Duration::ZERO;
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(3) {
        worst = worst.max(commanded(&palpate, Call::Pause, &late));
        assert_eq!(palpate.status().unwrap().state, LoopState::Paused);
        worst = worst.max(commanded(&palpate, Call::Resume, &late));
        std::thread::sleep(Duration::from_millis(20));
    }
    println!("a pause alone: {quiet:?}; under readers that have stopped: {worst:?}");
    assert!(worst < PROMISED, "{worst:?}");
    // A shutdown goes the same way. Its answer has come before the forces have faded.
    let begun = Instant::now();
    palpate.rpc(Call::Shutdown).unwrap();
    assert!(begun.elapsed() < Duration::from_secs(2));
}

#[test]
fn connections_that_say_nothing_or_trickle_keep_no_client_out() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let address = daemon.endpoint.trim_start_matches("tcp/").to_owned();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let connect = || TcpStream::connect(&address).unwrap();
            let mut peers: Vec<TcpStream> = (0..150).map(|_| connect()).collect();
            while !over.load(Ordering::Relaxed) {
                for (k, peer) in peers.iter_mut().enumerate() {
                    // Every other one begins a message of 256 bytes, and comes again when it is closed.
                    if k % 2 == 0 && peer.write_all(&[0, 1]).is_err() {
                        *peer = connect();
                    }
                }
                std::thread::sleep(Duration::from_millis(200));
            }
        });
        std::thread::sleep(Duration::from_millis(500));
        for _ in 0..3 {
            let begun = Instant::now();
            let palpate = daemon.connect();
            palpate.status().unwrap();
            println!("a client came in within {:?}", begun.elapsed());
        }
        over.store(true, Ordering::Relaxed);
    });
}
