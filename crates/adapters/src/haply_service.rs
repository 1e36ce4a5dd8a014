//! A simulated device as a Haply Inverse Service: for programs written for Haply, without hardware.

use super::simulated::SimulatedHand;
use palpate_client::proto::messages::ToolPose;
use palpate_devices::haply::{Buttons, DeviceState, read_forces, state_message};
use palpate_http::door::{Door, Limits, Place};
use std::net::{IpAddr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::{Message, WebSocket};

/// Ids, as the service gives them.
const DEVICE_ID: &str = "049D";
const GRIP_ID: &str = "61548";
/// A force is not kept longer than this without a message.
const KEPT: Duration = Duration::from_millis(50);
/// A program that was away for longer is not caught up with.
const CATCH_UP: Duration = Duration::from_millis(50);
/// Between two looks at whether to stop.
const TURN: Duration = Duration::from_millis(20);
/// A program that takes nothing for so long is given up.
const PATIENCE: Duration = Duration::from_secs(5);
/// Programs at once: for another one that which has said nothing for longest leaves.
const LIMITS: Limits = Limits {
    waiting: 16,
    served: 0,
    of_one: 0,
    urgent: 0,
    idle: None,
};

/// When a device moves on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// With the clock.
    Time,
    /// By one servo period for each message: sessions repeat bit for bit.
    Message,
}

/// The device that all programs see.
struct Shared {
    hand: SimulatedHand,
    pose: ToolPose,
    pace: Pace,
    force: [f64; 3],
    reported: Instant,
    now: Instant,
}

impl Shared {
    /// Takes what a program sent; gives the state after it.
    fn message(&mut self, force: Option<[f64; 3]>) -> DeviceState {
        match self.pace {
            Pace::Message => {
                self.force = force.unwrap_or([0.0; 3]);
                self.pose = self.hand.step(self.force, [0.0; 3]);
            }
            Pace::Time => {
                self.catch_up();
                if let Some(force) = force {
                    (self.force, self.reported) = (force, Instant::now());
                }
            }
        }
        self.state()
    }

    fn catch_up(&mut self) {
        let period = Duration::from_secs_f64(self.hand.dt_s());
        let now = Instant::now();
        if now.saturating_duration_since(self.now) > CATCH_UP {
            self.now = now - period;
        }
        while now.saturating_duration_since(self.now) >= period {
            self.now += period;
            if self.now.saturating_duration_since(self.reported) > KEPT {
                self.force = [0.0; 3];
            }
            self.pose = self.hand.step(self.force, [0.0; 3]);
        }
    }

    fn state(&self) -> DeviceState {
        DeviceState {
            device_id: DEVICE_ID.to_owned(),
            grip_id: GRIP_ID.to_owned(),
            position: self.pose.position,
            velocity: self.pose.linear_velocity,
            orientation: self.pose.orientation,
            buttons: Buttons {
                a: self.pose.buttons & 1 == 1,
                ..Buttons::default()
            },
            force: self.force,
        }
    }
}

/// Serves at an address until `stop` is set; `ready` gets the address.
///
/// # Errors
/// The address is taken.
pub fn serve(
    address: SocketAddr,
    hand: SimulatedHand,
    pace: Pace,
    stop: &Arc<AtomicBool>,
    ready: impl FnOnce(SocketAddr),
) -> std::io::Result<()> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    ready(listener.local_addr()?);
    let shared = Arc::new(Mutex::new(Shared {
        pose: hand.pose(),
        hand,
        pace,
        force: [0.0; 3],
        reported: Instant::now(),
        now: Instant::now(),
    }));
    let door = Door::new(LIMITS);
    let mut session = 0;
    while !stop.load(Ordering::Relaxed) {
        door.sweep(Instant::now());
        let Ok((stream, from)) = listener.accept() else {
            std::thread::sleep(TURN);
            continue;
        };
        let place = stream
            .try_clone()
            .ok()
            .and_then(|ended| door.enter(from.ip(), move || drop(ended.shutdown(Shutdown::Both))));
        let Some(place) = place else {
            std::thread::sleep(TURN);
            continue;
        };
        session += 1;
        let (shared, stop) = (shared.clone(), stop.clone());
        std::thread::Builder::new()
            .name("palpate-haply".into())
            .spawn(move || {
                if let Err(error) = program(stream, &place, session, &shared, &stop) {
                    tracing::debug!(%error, "a program of the Inverse Service left");
                }
                lock(&shared).force = [0.0; 3];
            })?;
    }
    Ok(())
}

fn lock(shared: &Mutex<Shared>) -> std::sync::MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Programs have no `Origin`, pages of this machine one of this machine; pages of other sites are refused.
#[allow(clippy::result_large_err)] // The signature is tungstenite's.
fn own_site(request: &Request, response: Response) -> Result<Response, ErrorResponse> {
    let Some(origin) = request.headers().get("origin") else {
        return Ok(response);
    };
    let site = origin.to_str().unwrap_or_default();
    let host = site.split_once("://").map_or("", |(_, rest)| rest);
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split_once(']').map_or("", |(name, _)| name),
        None => host.split(':').next().unwrap_or_default(),
    };
    let here =
        name == "localhost" || (name.parse::<IpAddr>()).is_ok_and(|address| address.is_loopback());
    if here {
        return Ok(response);
    }
    let words = format!("pages of {site} may not move this device\n");
    let mut refusal = ErrorResponse::new(Some(words));
    *refusal.status_mut() = tungstenite::http::StatusCode::FORBIDDEN;
    Err(refusal)
}

/// One program: all at first, then a state for each message.
fn program(
    stream: TcpStream,
    place: &Place,
    session: u64,
    shared: &Mutex<Shared>,
    stop: &AtomicBool,
) -> tungstenite::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    // The handshake is a request like any other.
    place.hears();
    let mut socket: WebSocket<TcpStream> = match tungstenite::accept_hdr(stream, own_site) {
        Ok(socket) => socket,
        Err(tungstenite::HandshakeError::Failure(error)) => return Err(error),
        Err(tungstenite::HandshakeError::Interrupted(_)) => return Ok(()),
    };
    place.waits();
    socket.get_ref().set_read_timeout(Some(TURN))?;
    let first = lock(shared).state();
    socket.send(Message::text(state_message(&[first], Some(session))))?;
    while !stop.load(Ordering::Relaxed) {
        use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
        let text = match socket.read() {
            Ok(Message::Text(text)) => {
                place.waits();
                text.to_string()
            }
            Ok(Message::Close(_)) => return Ok(()),
            Ok(_) => continue,
            Err(tungstenite::Error::Io(error))
                if matches!(error.kind(), WouldBlock | TimedOut | Interrupted) =>
            {
                continue;
            }
            Err(error) => return Err(error),
        };
        let force = match read_forces(&text) {
            Ok(forces) => forces,
            Err(error) => {
                // One state for each message, also for one that says nothing.
                tracing::warn!(%error, "a message to the Inverse Service");
                Vec::new()
            }
        };
        let force = force
            .into_iter()
            .find(|(id, _)| id == DEVICE_ID)
            .map(|(_, force)| force);
        let state = lock(shared).message(force);
        socket.send(Message::text(state_message(&[state], None)))?;
    }
    socket.close(None)
}
