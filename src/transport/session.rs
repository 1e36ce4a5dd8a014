//! Opening a Zenoh session: peer mode on a fixed loopback endpoint, no multicast needed.

use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::time::Duration;
use zenoh::Wait;

/// Where a daemon listens by default.
pub const DEFAULT_ENDPOINT: &str = "tcp/127.0.0.1:7447";

/// How to join the bus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SessionSettings {
    /// Endpoints to connect to.
    pub connect: Vec<String>,
    /// Endpoints to listen on.
    pub listen: Vec<String>,
    /// A stock Zenoh JSON5 configuration, taken before the endpoints above.
    pub config: Option<PathBuf>,
    /// What to be among the sessions of the bus.
    pub role: Role,
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
    /// Somebody listens there.
    #[error(
        "cannot listen on {endpoint}: {reason}; choose another with --listen, or stop whoever has it"
    )]
    InUse {
        /// As given.
        endpoint: String,
        /// Operating system's words.
        reason: String,
    },
    /// Nobody answers there.
    #[error(
        "nobody answers at {endpoint}: {reason}; is `palpate serve` running there? see --connect"
    )]
    Unreachable {
        /// As given.
        endpoint: String,
        /// Operating system's words.
        reason: String,
    },
    /// Zenoh's own refusal.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

/// Opens a session. Endpoints are tried before Zenoh is asked: it would retry without a word.
///
/// # Errors
/// A configuration, endpoint, port or peer that does not work, by name.
pub fn open(settings: &SessionSettings) -> Result<zenoh::Session, SessionError> {
    for endpoint in &settings.connect {
        match settings.role {
            Role::Router => drop(tcp_address(endpoint)?),
            Role::Peer | Role::Client => check_reachable(endpoint)?,
        }
    }
    for endpoint in &settings.listen {
        check_free(endpoint)?;
    }
    let mut config = match &settings.config {
        Some(path) => {
            let wrong = |reason: String| SessionError::Config {
                path: path.clone(),
                reason,
            };
            let config = zenoh::Config::from_file(path).map_err(|e| wrong(e.to_string()))?;
            palpate_client::check_built_in(&config).map_err(wrong)?;
            config
        }
        None => {
            let mut config = zenoh::Config::default();
            let mode = match settings.role {
                Role::Peer => "\"peer\"",
                Role::Client => "\"client\"",
                Role::Router => "\"router\"",
            };
            set(&mut config, "mode", mode)?;
            set(&mut config, "scouting/multicast/enabled", "false")?;
            set(&mut config, "listen/endpoints", "[]")?;
            config
        }
    };
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
    zenoh::open(config)
        .wait()
        .map_err(|e| SessionError::Zenoh(e.to_string()))
}

fn set(config: &mut zenoh::Config, key: &str, value: &str) -> Result<(), SessionError> {
    config
        .insert_json5(key, value)
        .map_err(|e| SessionError::Zenoh(format!("{key}: {e}")))
}

/// Host and port of a TCP endpoint; other transports are left to Zenoh.
fn tcp_address(endpoint: &str) -> Result<Option<std::net::SocketAddr>, SessionError> {
    let wrong = |reason: String| SessionError::Endpoint {
        endpoint: endpoint.to_owned(),
        reason,
    };
    let Some((protocol, address)) = endpoint.split_once('/') else {
        return Err(wrong("the protocol is missing".into()));
    };
    if protocol != "tcp" {
        return Ok(None);
    }
    let address = address.split(['#', '?']).next().unwrap_or_default();
    let mut addresses = address
        .to_socket_addrs()
        .map_err(|e| wrong(e.to_string()))?;
    addresses
        .next()
        .map(Some)
        .ok_or_else(|| wrong("the host has no address".into()))
}

/// Somebody listens at an endpoint.
pub fn is_taken(endpoint: &str) -> bool {
    matches!(check_free(endpoint), Err(SessionError::InUse { .. }))
}

fn check_reachable(endpoint: &str) -> Result<(), SessionError> {
    let Some(address) = tcp_address(endpoint)? else {
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

fn check_free(endpoint: &str) -> Result<(), SessionError> {
    let Some(address) = tcp_address(endpoint)? else {
        return Ok(());
    };
    match TcpListener::bind(address) {
        Ok(_) => Ok(()),
        Err(e) => Err(SessionError::InUse {
            endpoint: endpoint.to_owned(),
            reason: e.to_string(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for nonsense in ["127.0.0.1:7447", "tcp/nowhere", "tcp/127.0.0.1:99999"] {
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
