//! A lobby: who asks for a scene gets a daemon of its own.

use super::keeper::Keeper;
use super::routes;
use super::settings::LobbySettings;
use super::shelf::Shelf;
use palpate_client::is_secured;
use palpate_client::links::{is_here, is_loopback};
use palpate_http::{Hosts, Server};
use std::ffi::OsString;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Why a lobby cannot run.
#[derive(Debug, thiserror::Error)]
pub enum LobbyError {
    /// Everybody could start daemons.
    #[error(
        "--http {0} can be reached from other machines, and everybody there could start and end sessions: serve it on \
         127.0.0.1 (and reach it through ssh -L or a proxy that knows who asks), or say --insecure"
    )]
    Open(SocketAddr),
    /// Everybody could move tools.
    #[error(
        "daemons on {0} can be reached from other machines without TLS: give --listen tls/0.0.0.0:0 with --identity, or \
         say --insecure"
    )]
    OpenDaemons(String),
    /// TLS without certificates.
    #[error("--listen {0} needs --identity (see `palpate auth init`)")]
    NoIdentity(String),
    /// A fixed port.
    #[error("--listen {0}: each daemon needs a port of its own; end the endpoint with :0")]
    Port(String),
    /// The folder of scenes.
    #[error("--scenes {path}: {source}")]
    Scenes {
        /// As given.
        path: PathBuf,
        /// The system's words.
        source: std::io::Error,
    },
    /// No place at all.
    #[error("--max 0 leaves no place for a session; give 1 or more")]
    NoPlace,
    /// The address is taken, or the system refused a thread.
    #[error("the lobby cannot be served at {address}: {source}; choose another with --http")]
    Listen {
        /// As given.
        address: SocketAddr,
        /// The system's words.
        source: std::io::Error,
    },
}

/// A lobby that answers requests; daemons run once [`Lobby::run`] is called.
pub struct Lobby {
    server: Server,
    keeper: Keeper,
}

impl Lobby {
    /// Begins to listen; requests wait for [`Lobby::run`].
    ///
    /// # Errors
    /// See [`LobbyError`].
    pub fn open(settings: LobbySettings) -> Result<Self, LobbyError> {
        settings.check()?;
        let shelf =
            Shelf::new(settings.scenes.as_deref()).map_err(|source| LobbyError::Scenes {
                path: settings.scenes.clone().unwrap_or_default(),
                source,
            })?;
        let address = settings.http;
        let failed = |source| LobbyError::Listen { address, source };
        let listener = TcpListener::bind(address).map_err(failed)?;
        let hosts = Hosts {
            names: settings.http_hosts.clone().into(),
            ..Hosts::default()
        };
        let keeper = Keeper::new(settings, shelf.clone());
        let routes = routes::routes(keeper.asks(), shelf);
        let server = Server::start(listener, routes, hosts).map_err(failed)?;
        Ok(Self { server, keeper })
    }

    /// Where to ask, with a slash at its end.
    pub fn url(&self) -> String {
        self.server.url()
    }

    /// Serves until `stop` is set, then ends its daemons. They also end when the thread that calls this
    /// ends, however that happens.
    pub fn run(mut self, stop: &AtomicBool) {
        self.server.open();
        self.keeper.run(stop);
    }
}

impl LobbySettings {
    fn check(&self) -> Result<(), LobbyError> {
        if self.max == 0 {
            return Err(LobbyError::NoPlace);
        }
        if !is_loopback(self.http.ip()) && !self.insecure {
            return Err(LobbyError::Open(self.http));
        }
        let listen = || self.listen.clone();
        if is_secured(&self.listen) && self.identity.is_none() {
            return Err(LobbyError::NoIdentity(listen()));
        }
        let has_ports = ["tcp/", "tls/", "quic/"]
            .iter()
            .any(|head| self.listen.starts_with(head));
        if !has_ports || !self.listen.ends_with(":0") {
            return Err(LobbyError::Port(listen()));
        }
        if !is_here(&self.listen) && !is_secured(&self.listen) && !self.insecure {
            return Err(LobbyError::OpenDaemons(listen()));
        }
        Ok(())
    }

    /// Of `palpate serve`, for one session.
    pub(super) fn arguments(&self, scene: &Path, instance: &str) -> Vec<OsString> {
        let idle = format!("{}s", self.idle_timeout.as_secs_f64());
        let options = [
            ("--instance", instance),
            ("--idle-timeout", &idle),
            ("--listen", &self.listen),
            ("--http", "127.0.0.1:0"),
        ];
        let mut arguments: Vec<OsString> = vec!["--json".into()];
        for (option, value) in options {
            arguments.extend([option.into(), value.into()]);
        }
        if let Some(identity) = &self.identity {
            arguments.extend(["--identity".into(), identity.into()]);
        }
        if self.insecure {
            arguments.push("--insecure".into());
        }
        arguments.extend(self.serve.iter().map(OsString::from));
        // A folder may be called as an option is.
        arguments.extend(["--".into(), scene.into()]);
        arguments
    }
}
