//! Opening a Zenoh session: peer mode on a fixed loopback endpoint, no multicast needed.

use super::budget;
use palpate_client::is_secured;
use palpate_client::links::{self, Exposed, OpenError};
use palpate_proto::keys::Keys;
use socket2::{Domain, Socket, Type};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use zenoh::Wait;

/// Where a daemon listens by default.
pub const DEFAULT_ENDPOINT: &str = "tcp/127.0.0.1:7447";

/// The same for a daemon that has an identity.
pub const DEFAULT_SECURE_ENDPOINT: &str = "tls/127.0.0.1:7447";

/// How to join the bus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SessionSettings {
    /// Endpoints to connect to.
    pub connect: Vec<String>,
    /// Endpoints to listen on.
    pub listen: Vec<String>,
    /// A Zenoh configuration file: it changes only what it names, and the endpoints above come after it.
    pub config: Option<PathBuf>,
    /// What to be among the sessions of the bus.
    pub role: Role,
    /// Who may come, and what they may do.
    pub access: Access,
    /// How long it waits for a client that does not read, [`patience`](super::patience) of its scene;
    /// `None` where no one comes that others must be guarded from.
    pub patience: Option<Duration>,
}

/// Who may come to a session that listens, and what they may do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// Identity file for TLS, as `palpate auth` makes them.
    pub identity: Option<PathBuf>,
    /// Zenoh's section `access_control`; unless the configuration file has one.
    pub rules: Option<serde_json::Value>,
    /// Allow links beyond this machine that nothing guards.
    pub insecure: bool,
}

/// What a session is among others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// Speaks with those it is connected to.
    #[default]
    Peer,
    /// Gets everything through the one that it is connected to, also from those beyond.
    Client,
    /// Others reach each other through it; endpoints to connect to may appear later, go and come
    /// back.
    Router,
}

impl Role {
    /// As Zenoh calls it.
    fn mode(self) -> &'static str {
        match self {
            Self::Peer => "peer",
            Self::Client => "client",
            Self::Router => "router",
        }
    }
}

/// A daemon of this instance that the session reaches: the id of its session. Two of one name would both
/// answer a tool's poses.
///
/// # Errors
/// Zenoh refused.
pub fn daemon_of(
    session: &zenoh::Session,
    keys: &Keys,
    patience: Duration,
) -> Result<Option<String>, SessionError> {
    let begun = Instant::now();
    // What others have declared arrives a little after the link.
    loop {
        let replies = session
            .liveliness()
            .get(keys.live_server("*"))
            .timeout(patience)
            .wait()
            .map_err(|e| SessionError::Zenoh(e.to_string()))?;
        while let Ok(reply) = replies.recv() {
            if let Ok(sample) = reply.result() {
                let key = sample.key_expr().as_str();
                let id = key.rsplit_once('/').map_or(key, |(_, id)| id);
                return Ok(Some(id.to_owned()));
            }
        }
        if begun.elapsed() >= patience {
            return Ok(None);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Where a daemon listens that has no endpoint configured: on [`DEFAULT_ENDPOINT`] (`secure`: on
/// [`DEFAULT_SECURE_ENDPOINT`]), unless it connects to
/// others or its configuration file says what to listen on or to connect to.
///
/// # Errors
/// The configuration file cannot be read.
pub fn default_listen(
    config: Option<&Path>,
    listen: &[String],
    connect: &[String],
    secure: bool,
) -> Result<Vec<String>, SessionError> {
    let named = match config {
        None => palpate_client::Named::default(),
        Some(path) => palpate_client::named(path).map_err(|reason| SessionError::Config {
            path: path.to_owned(),
            reason,
        })?,
    };
    let configured = !listen.is_empty() || !connect.is_empty() || named.listen || named.connect;
    Ok(match configured {
        true => listen.to_vec(),
        false if secure => vec![DEFAULT_SECURE_ENDPOINT.to_owned()],
        false => vec![DEFAULT_ENDPOINT.to_owned()],
    })
}

/// Why the bus could not be joined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SessionError {
    /// The configuration file.
    #[error("Zenoh configuration {path}: {reason}")]
    Config {
        /// File.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// An endpoint Zenoh does not understand.
    #[error("{endpoint:?} is not a valid endpoint ({reason}); write one like {DEFAULT_ENDPOINT}")]
    Endpoint {
        /// As given.
        endpoint: String,
        /// What is wrong.
        reason: String,
    },
    /// Someone listens there.
    #[error(
        "cannot listen on {endpoint}: {reason}; choose another with --listen, or stop whoever has it"
    )]
    InUse {
        /// As given.
        endpoint: String,
        /// Operating system's words.
        reason: String,
    },
    /// No one answers there.
    #[error(
        "nobody answers at {endpoint}: {reason}; is `palpate serve` running there? see --connect"
    )]
    Unreachable {
        /// As given.
        endpoint: String,
        /// Operating system's words.
        reason: String,
    },
    /// Everybody could be at the other end of a link.
    #[error(transparent)]
    Exposed(#[from] Exposed),
    /// The identity file.
    #[error("{0}")]
    Identity(String),
    /// Zenoh's own refusal.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

impl From<OpenError> for SessionError {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Exposed(exposed) => Self::Exposed(exposed),
            OpenError::Zenoh(words) => Self::Zenoh(words),
        }
    }
}

/// Opens a session. Endpoints are tried before Zenoh is asked: it would retry without a word.
///
/// # Errors
/// A configuration, endpoint, port or peer that does not work, by name; links beyond this machine that nothing
/// guards, without `insecure`.
pub fn open(settings: &SessionSettings) -> Result<zenoh::Session, SessionError> {
    open_told(settings).map(|(session, _)| session)
}

/// Where others than this machine and holders of identities may come in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Open {
    /// Links that nothing guards.
    pub everybody: Vec<String>,
    /// Where the session connects to: whoever is there decides whom else to let in.
    pub others: Vec<String>,
}

/// [`open`], with where others may come in.
///
/// # Errors
/// As there.
pub fn open_told(settings: &SessionSettings) -> Result<(zenoh::Session, Open), SessionError> {
    for endpoint in settings.connect.iter().chain(&settings.listen) {
        ip_address(endpoint)?;
    }
    let config = configuration(settings)?;
    let insecure = settings.access.insecure;
    let openings = links::check(&config, insecure)?;
    for endpoint in &settings.connect {
        // With TLS a bare connection would be a failed handshake in the log of whoever listens.
        if settings.role != Role::Router && !is_secured(endpoint) {
            check_reachable(endpoint)?;
        }
    }
    for endpoint in &settings.listen {
        check_free(endpoint)?;
    }
    let everybody: Vec<String> = openings.into_iter().map(|opening| opening.what).collect();
    let mut others = links::connects_to(&config);
    others.retain(|endpoint| !everybody.contains(endpoint));
    let session = links::open(config, insecure)?;
    Ok((session, Open { everybody, others }))
}

/// The configuration of Zenoh.
fn configuration(settings: &SessionSettings) -> Result<zenoh::Config, SessionError> {
    let path = settings.config.as_deref();
    let mut config =
        palpate_client::configuration(path, settings.role.mode()).map_err(|reason| match path {
            Some(path) => SessionError::Config {
                path: path.to_owned(),
                reason,
            },
            None => SessionError::Zenoh(reason),
        })?;
    for (key, endpoints) in [
        ("connect/endpoints", &settings.connect),
        ("listen/endpoints", &settings.listen),
    ] {
        if !endpoints.is_empty() {
            let list = serde_json::to_string(endpoints).unwrap_or_default();
            config
                .insert_json5(key, &list)
                .map_err(|e| SessionError::Endpoint {
                    endpoint: endpoints.join(", "),
                    reason: e.to_string(),
                })?;
        }
    }
    if let Some(patience) = settings.patience {
        budget::bound(&mut config, patience).map_err(SessionError::Zenoh)?;
    }
    if let Some(identity) = &settings.access.identity {
        palpate_client::add_identity(&mut config, identity).map_err(SessionError::Identity)?;
        let has_rules = (config.get_json("access_control/enabled")).is_ok_and(|is| is == "true");
        if let Some(rules) = settings.access.rules.as_ref().filter(|_| !has_rules) {
            set(&mut config, "access_control", &rules.to_string())?;
        }
    }
    Ok(config)
}

fn set(config: &mut zenoh::Config, key: &str, value: &str) -> Result<(), SessionError> {
    config
        .insert_json5(key, value)
        .map_err(|e| SessionError::Zenoh(format!("{key}: {e}")))
}

/// Host and port of an endpoint over TCP or UDP; other transports are left to Zenoh.
fn ip_address(endpoint: &str) -> Result<Option<SocketAddr>, SessionError> {
    let wrong = |reason: String| SessionError::Endpoint {
        endpoint: endpoint.to_owned(),
        reason,
    };
    palpate_client::check_protocol(endpoint).map_err(wrong)?;
    let over_ip = ["tcp/", "tls/", "quic/"]
        .iter()
        .find_map(|head| endpoint.strip_prefix(head));
    let Some(address) = over_ip else {
        return Ok(None);
    };
    let address = address.split(['#', '?']).next().unwrap_or_default();
    let mut addresses = address
        .to_socket_addrs()
        .map_err(|e| wrong(e.to_string()))?;
    addresses
        .next()
        .map(Some)
        .ok_or_else(|| wrong("the host has no address".into()))
}

/// Someone listens at an endpoint.
pub fn is_taken(endpoint: &str) -> bool {
    matches!(check_free(endpoint), Err(SessionError::InUse { .. }))
}

fn check_reachable(endpoint: &str) -> Result<(), SessionError> {
    let Some(address) = ip_address(endpoint)? else {
        return Ok(());
    };
    match TcpStream::connect_timeout(&address, Duration::from_secs(3)) {
        Ok(_) => Ok(()),
        Err(e) => Err(SessionError::Unreachable {
            endpoint: endpoint.to_owned(),
            reason: e.to_string(),
        }),
    }
}

/// Binds as a listener does, without listening: a program that waits for the daemon would connect to this socket, and
/// find no one a moment later.
fn bind(address: SocketAddr) -> std::io::Result<Socket> {
    let socket = Socket::new(Domain::for_address(address), Type::STREAM, None)?;
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    socket.bind(&address.into())?;
    Ok(socket)
}

fn check_free(endpoint: &str) -> Result<(), SessionError> {
    let Some(address) = ip_address(endpoint)? else {
        return Ok(());
    };
    let bound = match endpoint.starts_with("quic/") {
        true => UdpSocket::bind(address).map(drop),
        false => bind(address).map(drop),
    };
    match bound {
        Ok(()) => Ok(()),
        Err(e) => Err(SessionError::InUse {
            endpoint: endpoint.to_owned(),
            reason: e.to_string(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn a_port_that_is_looked_at_accepts_no_one() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        assert!(bind(address).is_err());
        drop(listener);
        let held = bind(address).unwrap();
        assert!(TcpStream::connect(address).is_err());
        drop(held);
        assert!(check_free(&format!("tcp/{address}")).is_ok());
    }

    #[test]
    fn a_taken_port_and_a_silent_peer_are_named() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let taken = format!("tcp/{}", listener.local_addr().unwrap());
        let error = open(&SessionSettings {
            listen: vec![taken.clone()],
            ..Default::default()
        })
        .unwrap_err();
        assert!(
            matches!(&error, SessionError::InUse { endpoint, .. } if *endpoint == taken),
            "{error}"
        );
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        assert!(is_taken(&format!("quic/{}", socket.local_addr().unwrap())));
        drop(listener);
        let error = open(&SessionSettings {
            connect: vec![taken.clone()],
            ..Default::default()
        })
        .unwrap_err();
        assert!(
            matches!(&error, SessionError::Unreachable { endpoint, .. } if *endpoint == taken),
            "{error}"
        );
        for nonsense in [
            "127.0.0.1:7447",
            "tcp/nowhere",
            "tcp/127.0.0.1:99999",
            "udp/127.0.0.1:7447",
        ] {
            let settings = SessionSettings {
                connect: vec![nonsense.into()],
                ..Default::default()
            };
            assert!(
                matches!(open(&settings), Err(SessionError::Endpoint { .. })),
                "{nonsense}"
            );
        }
    }
}
