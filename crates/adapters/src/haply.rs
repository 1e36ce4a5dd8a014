//! A Haply device behind its Inverse Service.

use palpate_client::links;
use palpate_devices::haply::{HaplyError, force_message, read_state};
use palpate_devices::{Command, DeviceEnd, Reading};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// Where the service listens.
pub const DEFAULT_URI: &str = "ws://localhost:10001";
/// What the service shows of us.
const PROFILE: &str = "palpate";
/// The service's own time to connect and to send what it has.
const PATIENCE: Duration = Duration::from_secs(5);
/// A turn without a command sends the last one again after this long: every state needs a message.
const REPEAT: Duration = Duration::from_millis(2);

/// Why a Haply device is of no use.
#[derive(Debug, thiserror::Error)]
pub enum HaplyLinkError {
    /// Not an address.
    #[error("{0:?} is no address of an Inverse Service; write one like {DEFAULT_URI}")]
    Uri(String),
    /// Whoever answers there would move the hand and the tool.
    #[error(
        "{0} is another machine, and a WebSocket does not say who answers there: reach it through `ssh -L`, or say --insecure"
    )]
    Exposed(String),
    /// No one answers.
    #[error("no Inverse Service answers at {uri}: {reason}; is it running? see --uri")]
    Unreachable {
        /// As given.
        uri: String,
        /// The system's words.
        reason: String,
    },
    /// The connection ended.
    #[error("the Inverse Service at {uri} is gone: {reason}")]
    Gone {
        /// As given.
        uri: String,
        /// What happened.
        reason: String,
    },
    /// It says something else.
    #[error(transparent)]
    Haply(#[from] HaplyError),
}

/// A connection that drives one device.
pub struct HaplyEnd {
    socket: WebSocket<TcpStream>,
    uri: String,
    device_id: String,
    begun: Instant,
    /// A message was sent, and its state has not come: since when.
    asked: Option<Instant>,
    /// The state that came last has no command yet: since when.
    idle: Instant,
    force: [f64; 3],
}

impl HaplyEnd {
    /// Connects and takes a device: the only one, unless `device_id` names it. `insecure`: on another machine too.
    ///
    /// # Errors
    /// No service there, or no such device; a service on another machine.
    pub fn connect(
        uri: &str,
        device_id: Option<&str>,
        insecure: bool,
    ) -> Result<Self, HaplyLinkError> {
        let unreachable = |reason: String| HaplyLinkError::Unreachable {
            uri: uri.to_owned(),
            reason,
        };
        let host = uri
            .strip_prefix("ws://")
            .and_then(|rest| rest.split('/').next())
            .filter(|host| !host.is_empty())
            .ok_or_else(|| HaplyLinkError::Uri(uri.to_owned()))?;
        let with_port = match host.rsplit_once(':') {
            Some((_, port)) if port.parse::<u16>().is_ok() => host.to_owned(),
            _ => format!("{host}:10001"),
        };
        if !insecure && !links::is_own_address(&with_port) {
            return Err(HaplyLinkError::Exposed(uri.to_owned()));
        }
        let addresses = with_port
            .to_socket_addrs()
            .map_err(|error| unreachable(error.to_string()))?;
        let mut last = unreachable("the host has no address".into());
        for address in addresses {
            match TcpStream::connect_timeout(&address, PATIENCE) {
                Ok(stream) => return Self::begin(stream, uri, device_id),
                Err(error) => last = unreachable(error.to_string()),
            }
        }
        Err(last)
    }

    fn begin(
        stream: TcpStream,
        uri: &str,
        device_id: Option<&str>,
    ) -> Result<Self, HaplyLinkError> {
        let unreachable = |reason: String| HaplyLinkError::Unreachable {
            uri: uri.to_owned(),
            reason,
        };
        let io = |error: std::io::Error| unreachable(error.to_string());
        stream.set_nodelay(true).map_err(io)?;
        stream.set_read_timeout(Some(PATIENCE)).map_err(io)?;
        stream.set_write_timeout(Some(PATIENCE)).map_err(io)?;
        let (mut socket, _) = tungstenite::client::client(uri, stream)
            .map_err(|error| unreachable(error.to_string()))?;
        let first = loop {
            match socket.read() {
                Ok(Message::Text(text)) => break text.to_string(),
                Ok(_) => {}
                Err(error) => return Err(unreachable(error.to_string())),
            }
        };
        // What it says of the device is not a reading: nothing was asked yet.
        let (device_id, _) = read_state(&first, device_id, 0)?;
        let mut end = Self {
            socket,
            uri: uri.to_owned(),
            device_id,
            begun: Instant::now(),
            asked: None,
            idle: Instant::now(),
            force: [0.0; 3],
        };
        end.send(Some(PROFILE))?;
        Ok(end)
    }

    /// Id of the device.
    pub fn device_id(&self) -> &str {
        &self.device_id
    }

    fn gone(&self, reason: impl std::fmt::Display) -> HaplyLinkError {
        HaplyLinkError::Gone {
            uri: self.uri.clone(),
            reason: reason.to_string(),
        }
    }

    fn send(&mut self, profile: Option<&str>) -> Result<(), HaplyLinkError> {
        let text = force_message(&self.device_id, self.force, profile);
        self.socket
            .send(Message::text(text))
            .map_err(|error| self.gone(error))?;
        self.asked = Some(Instant::now());
        Ok(())
    }

    /// The next text within `patience`.
    fn text(&mut self, patience: Duration) -> Result<Option<String>, HaplyLinkError> {
        // A process that was stopped and goes on finds its waits interrupted.
        use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
        let timeout = patience.max(Duration::from_micros(100));
        let set = self.socket.get_ref().set_read_timeout(Some(timeout));
        set.map_err(|error| self.gone(error))?;
        match self.socket.read() {
            Ok(Message::Text(text)) => Ok(Some(text.to_string())),
            Ok(Message::Close(_)) => Err(self.gone("it closed the connection")),
            Ok(_) => Ok(None),
            Err(tungstenite::Error::Io(error))
                if matches!(error.kind(), WouldBlock | TimedOut | Interrupted) =>
            {
                Ok(None)
            }
            Err(error) => Err(self.gone(error)),
        }
    }
}

impl DeviceEnd for HaplyEnd {
    type Error = HaplyLinkError;

    fn reading(&mut self, patience: Duration) -> Result<Option<Reading>, HaplyLinkError> {
        match self.asked {
            Some(since) if since.elapsed() > PATIENCE => {
                return Err(self.gone("it does not answer any more"));
            }
            Some(_) => {}
            None if self.idle.elapsed() < REPEAT => {
                std::thread::sleep(patience.min(REPEAT));
                return Ok(None);
            }
            None => self.send(None)?,
        }
        let Some(text) = self.text(patience)? else {
            return Ok(None);
        };
        (self.asked, self.idle) = (None, Instant::now());
        let time_ns = self.begun.elapsed().as_nanos() as u64;
        let (_, reading) = read_state(&text, Some(&self.device_id), time_ns)?;
        Ok(Some(reading))
    }

    /// A state of which the message is still awaited is not asked for again; the force goes with the
    /// next message.
    fn apply(&mut self, command: &Command) -> Result<(), HaplyLinkError> {
        self.force = command.force;
        match self.asked {
            None => self.send(None),
            Some(_) => Ok(()),
        }
    }
}

impl Drop for HaplyEnd {
    /// The service drops the force of a program that is gone; zero is said nevertheless.
    fn drop(&mut self) {
        self.force = [0.0; 3];
        let _ = self.send(None);
        let _ = self.socket.close(None);
    }
}
