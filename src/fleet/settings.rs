//! What a lobby does.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// What a lobby does.
#[derive(Clone, Debug, PartialEq)]
pub struct LobbySettings {
    /// Where requests come in; port 0: any free one.
    pub http: SocketAddr,
    /// Names, beside numbers and `localhost`, under which it may be asked.
    pub http_hosts: Vec<String>,
    /// Folder of further scenes.
    pub scenes: Option<PathBuf>,
    /// Sessions at a time.
    pub max: usize,
    /// A daemon ends when no one has held a tool for this long.
    pub idle_timeout: Duration,
    /// Endpoint on which each daemon listens, with port 0.
    pub listen: String,
    /// Identity file of the daemons, for TLS.
    pub identity: Option<PathBuf>,
    /// Host under which clients reach the daemons; as in `listen` if absent.
    pub host: Option<String>,
    /// The lobby and its daemons may be open to the network.
    pub insecure: bool,
    /// Further arguments of each `palpate serve`.
    pub serve: Vec<String>,
}
