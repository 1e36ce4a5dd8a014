//! OpenIGTLink, for 3D Slicer and trackers (PLUS): poses of tools out, poses of trackers in.
//!
//! ```text
//! tracker ─ TRANSFORM "ball" ─▶ pose of tool ball      (the first one takes the tool)
//! Slicer  ◀─ TRANSFORM "ball" ─ its proxy, 60 a second
//! ```
//! A tracker has no motors: nothing comes back to it. Loopback only.

use super::unix_ns;
use palpate_client::{Forces, Palpate, Tool, pose_at};
use palpate_devices::igtl::{HEADER, Header, TrackedPose, transform};
use palpate_http::door::{Door, Limits, Place};
use std::collections::BTreeMap;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Clients at once: for another one that which has said nothing for longest leaves. Slicer only listens, so no one
/// leaves for silence alone.
const LIMITS: Limits = Limits {
    waiting: 8,
    served: 0,
    of_one: 0,
    urgent: 0,
    idle: None,
};
/// Longest body that is read, bytes; images are longer, and of no use here.
const MOST_BYTES: u64 = 1 << 20;
/// Proxies a second.
const EVERY: Duration = Duration::from_micros(16_667);
/// Between two looks at whether to stop.
const TURN: Duration = Duration::from_millis(50);
/// A client that does not read for so long is given up.
const PATIENCE: Duration = Duration::from_secs(5);

/// A server at work; it ends when dropped.
pub struct Igtl {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What every client needs.
#[derive(Clone)]
struct Shared {
    session: zenoh::Session,
    instance: String,
    tools: Arc<[String]>,
    stop: Arc<AtomicBool>,
}

impl Igtl {
    /// Listens on a port of this machine; 0: any free one.
    ///
    /// # Errors
    /// The port is taken.
    pub fn start(
        session: &zenoh::Session,
        instance: &str,
        tools: Vec<String>,
        port: u16,
    ) -> std::io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let stop = Arc::<AtomicBool>::default();
        let shared = Shared {
            session: session.clone(),
            instance: instance.to_owned(),
            tools: tools.into(),
            stop: stop.clone(),
        };
        let thread = std::thread::Builder::new()
            .name("palpate-igtl".into())
            .spawn(move || accept(&listener, &shared))?;
        Ok(Self {
            address,
            stop,
            thread: Some(thread),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Igtl {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn accept(listener: &TcpListener, shared: &Shared) {
    let door = Door::new(LIMITS);
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.stop.load(Ordering::Acquire) {
        threads.retain(|thread| !thread.is_finished());
        door.sweep(Instant::now());
        let (stream, from) = match listener.accept() {
            Ok((stream, from)) => (Arc::new(stream), from),
            Err(_) => {
                std::thread::sleep(TURN);
                continue;
            }
        };
        let ended = stream.clone();
        let place = door.enter(from.ip(), move || drop(ended.shutdown(Shutdown::Both)));
        let Some(place) = place else {
            std::thread::sleep(TURN);
            continue;
        };
        let shared = shared.clone();
        let started = std::thread::Builder::new()
            .name("palpate-igtl-client".into())
            .spawn(move || {
                if let Err(error) = serve(&stream, &shared, &place) {
                    tracing::info!(%error, "an OpenIGTLink client left");
                }
            });
        match started {
            Ok(thread) => threads.push(thread),
            Err(error) => tracing::warn!(%error, "no thread for an OpenIGTLink client"),
        }
    }
    for thread in threads {
        let _ = thread.join();
    }
}

/// Speaks with one client: writes on this thread, reads on another.
fn serve(stream: &TcpStream, shared: &Shared, place: &Place) -> anyhow::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(TURN))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let palpate = Palpate::over(shared.session.clone(), &shared.instance)?;
    let mut proxies: Vec<(&String, Forces, u64)> = (shared.tools.iter())
        .map(|tool| Ok((tool, palpate.forces(tool)?, 0)))
        .collect::<anyhow::Result<_>>()?;
    let gone = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let read = read_all(stream, &palpate, shared, place, &gone);
            gone.store(true, Ordering::Release);
            read
        });
        let written = write_all(stream, &mut proxies, shared, &gone);
        gone.store(true, Ordering::Release);
        let read = reader.join().unwrap_or(Ok(()));
        written.map_err(anyhow::Error::from).and(read)
    })
}

fn write_all(
    mut stream: &TcpStream,
    proxies: &mut [(&String, Forces, u64)],
    shared: &Shared,
    gone: &AtomicBool,
) -> std::io::Result<()> {
    while !gone.load(Ordering::Acquire) && !shared.stop.load(Ordering::Acquire) {
        for (tool, forces, reported) in &mut *proxies {
            let newest = forces.newest();
            let is_new = std::mem::replace(reported, newest.received) != newest.received;
            if let Some(force) = newest.force.filter(|_| is_new) {
                let (at, turned) = (force.proxy_position, force.proxy_orientation);
                stream.write_all(&transform(tool, force.t_server_ns, at, turned))?;
            }
        }
        std::thread::sleep(EVERY);
    }
    Ok(())
}

fn read_all(
    stream: &TcpStream,
    palpate: &Palpate,
    shared: &Shared,
    place: &Place,
    gone: &AtomicBool,
) -> anyhow::Result<()> {
    let over = || gone.load(Ordering::Acquire) || shared.stop.load(Ordering::Acquire);
    let mut held: BTreeMap<String, Tool> = BTreeMap::new();
    let mut refused: Option<String> = None;
    let mut head = [0; HEADER];
    while fill(stream, place, &mut head, &over)? {
        let header = Header::read(&head)?;
        anyhow::ensure!(
            header.body <= MOST_BYTES,
            "a {} of {} bytes is longer than {MOST_BYTES}",
            header.kind,
            header.body
        );
        let mut body = vec![0; header.body as usize];
        if !fill(stream, place, &mut body, &over)? {
            break;
        }
        place.waits();
        let moved = header.pose(&body).map_err(anyhow::Error::from);
        let moved = moved.and_then(|pose| match pose {
            Some(pose) => move_tool(palpate, shared, &mut held, &header, &pose),
            None => Ok(()),
        });
        // Each reason once in a row: a tracker speaks sixty times a second.
        if let Err(error) = moved
            && refused.replace(error.to_string()) != Some(error.to_string())
        {
            tracing::warn!(%error, device = header.device, "an OpenIGTLink message was dropped");
        }
    }
    Ok(())
}

fn move_tool(
    palpate: &Palpate,
    shared: &Shared,
    held: &mut BTreeMap<String, Tool>,
    header: &Header,
    pose: &TrackedPose,
) -> anyhow::Result<()> {
    let id = &header.device;
    if !held.contains_key(id) {
        anyhow::ensure!(
            shared.tools.contains(id),
            "there is no tool {id:?}; the scene has {}",
            shared.tools.join(", ")
        );
        let token = palpate.keys().live_tool(id);
        let holders = palpate.live(&token, Duration::ZERO, |_| true)?;
        anyhow::ensure!(holders.is_empty(), "tool {id:?} is held by somebody else");
        // Without a description: the forces of a tracked tool press bodies, and no one feels them.
        held.insert(id.clone(), palpate.tool(id)?);
    }
    if let Some(tool) = held.get_mut(id) {
        let mut sent = pose_at(pose.position);
        sent.orientation = pose.orientation;
        sent.t_client_ns = match header.time_ns {
            0 => unix_ns(),
            time_ns => time_ns,
        };
        tool.send(sent)?;
    }
    Ok(())
}

/// Fills a buffer; false if the other side closed before its first byte, or all is over.
fn fill(
    mut stream: &TcpStream,
    place: &Place,
    buffer: &mut [u8],
    over: &dyn Fn() -> bool,
) -> anyhow::Result<bool> {
    let mut at = 0;
    while at < buffer.len() {
        match stream.read(&mut buffer[at..]) {
            Ok(0) if at == 0 => return Ok(false),
            Ok(0) => anyhow::bail!("a message is cut short"),
            Ok(count) => {
                at += count;
                place.hears();
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {}
                _ => return Err(error.into()),
            },
        }
        if over() {
            return Ok(false);
        }
    }
    Ok(true)
}
