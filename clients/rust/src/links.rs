//! The one door to the bus: no session opens but here, and only if every link of it, in or out, stays on
//! this machine or is guarded by certificates.
//!
//! The rule looks at the configuration as Zenoh will use it, after all files and options: endpoints of both
//! kinds, what the session would find by itself, and whether others may change all that.

use crate::config::Said;
use serde_json::Value;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr as _;
use zenoh::Wait;
use zenoh::config::EndPoint;

/// The interface on which a machine reaches itself. Access rules know this machine's own links by it.
pub const LOOPBACK_INTERFACE: &str = match cfg!(any(target_os = "linux", target_os = "android")) {
    true => "lo",
    false => "lo0",
};

/// A way in or out at which everybody may be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opening {
    /// The endpoint, or the key of Zenoh's configuration.
    pub what: String,
    /// What it lacks.
    pub why: &'static str,
}

const NO_RULES: &str = "without access rules that deny by default, as `palpate auth rules` prints";

impl Opening {
    /// Only rules for holders of certificates are missing.
    pub fn lacks_rules(&self) -> bool {
        self.why == NO_RULES
    }
}

/// Everybody could be at the other end of a link.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{}: other machines may be at the other end, and everybody there could move tools, give commands or pass for \
     a daemon; use TLS (`palpate auth init DIR`, then tls/… and --identity FILE on both sides), stay on this \
     machine (127.0.0.1, `ssh -L`), or say --insecure (in programs `insecure`)",
    listed(openings)
)]
pub struct Exposed {
    /// Where.
    pub openings: Vec<Opening>,
}

/// Why a session was not opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// Links that nothing guards.
    #[error(transparent)]
    Exposed(#[from] Exposed),
    /// Zenoh's own refusal.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

fn listed(openings: &[Opening]) -> String {
    let one = |opening: &Opening| format!("{} ({})", opening.what, opening.why);
    openings.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Opens a session that [`check`] lets pass.
///
/// # Errors
/// It has openings, without `insecure`; Zenoh refused.
pub fn open(config: zenoh::Config, insecure: bool) -> Result<zenoh::Session, OpenError> {
    check(&config, insecure)?;
    #[allow(clippy::disallowed_methods)] // Here it is checked.
    let session = zenoh::open(config).wait();
    session.map_err(|error| OpenError::Zenoh(error.to_string()))
}

/// The openings of a session with this configuration, if it may have any.
///
/// # Errors
/// It has some, and `insecure` was not said.
pub fn check(config: &zenoh::Config, insecure: bool) -> Result<Vec<Opening>, Exposed> {
    let openings = openings(config);
    match openings.is_empty() || insecure {
        true => Ok(openings),
        false => Err(Exposed { openings }),
    }
}

/// Endpoints to which a session with this configuration connects.
pub fn connects_to(config: &zenoh::Config) -> Vec<String> {
    let endpoints = Said(config).endpoints("connect/endpoints");
    endpoints.iter().map(|endpoint| shown(endpoint)).collect()
}

/// An endpoint for people: parameters that are not harmless may be keys.
fn shown(endpoint: &str) -> String {
    match (endpoint.split_once('#'), EndPoint::from_str(endpoint)) {
        (Some(_), Ok(parsed)) if is_plain(&parsed) => endpoint.to_owned(),
        (Some((address, _)), _) => format!("{address}#…"),
        (None, _) => endpoint.to_owned(),
    }
}

/// Every way in and out that neither stays on this machine nor is guarded.
fn openings(config: &zenoh::Config) -> Vec<Opening> {
    let said = Said(config);
    let mut all = Vec::new();
    let mut add = |what: &str, why: &'static str| {
        let what = what.to_owned();
        all.push(Opening { what, why });
    };
    for (key, side) in [
        ("listen/endpoints", Side::Listen),
        ("connect/endpoints", Side::Connect),
    ] {
        for endpoint in said.endpoints(key) {
            if let Err(why) = said.guarded(&endpoint, side) {
                add(&shown(&endpoint), why);
            }
        }
    }
    // Certificates do not help here: clients also believe public authorities, and a stranger can have one of
    // those for a name of his own.
    for found in ["scouting/multicast", "scouting/gossip"] {
        if said.links_to_found(found) {
            add(
                found,
                "it links to whoever is found; set its autoconnect to [], or enabled to false",
            );
        }
    }
    if said.is(true, "adminspace/enabled") && said.is(true, "adminspace/permissions/write") {
        add(
            "adminspace/permissions/write",
            "it lets others change this configuration",
        );
    }
    all
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Listen,
    Connect,
}

/// Parameters of an endpoint that leave its certificates as the configuration has them.
const HARMLESS: [&str; 8] = [
    "bind",
    "dscp",
    "iface",
    "initial_mtu",
    "mtu_discovery_interval_secs",
    "segmentation_offload",
    "so_rcvbuf",
    "so_sndbuf",
];

impl Said<'_> {
    fn is(&self, wanted: bool, key: &str) -> bool {
        self.value(key) == Value::Bool(wanted)
    }

    /// Why everybody may be at the other end of an endpoint's links, unless they are guarded.
    fn guarded(&self, endpoint: &str, side: Side) -> Result<(), &'static str> {
        let endpoint = EndPoint::from_str(endpoint).map_err(|_| "it is no endpoint")?;
        if stays_here(&endpoint) {
            return Ok(());
        }
        let protocol = endpoint.protocol();
        if !crate::is_secured(&format!("{protocol}/")) {
            return Err("without TLS");
        }
        let tls = |key: &str| self.value(&format!("transport/link/tls/{key}"));
        let has_authority =
            ["", "_base64"].map(|kind| tls(&format!("root_ca_certificate{kind}")).is_string());
        match side {
            _ if !is_plain(&endpoint) => Err("its parameters may change who is let in"),
            _ if tls("enable_mtls") != Value::Bool(true) || has_authority == [false, false] => {
                Err("without an identity")
            }
            Side::Connect if tls("verify_name_on_connect") == Value::Bool(false) => {
                Err("with verify_name_on_connect off")
            }
            Side::Listen if !self.has_rules() => Err(NO_RULES),
            Side::Listen | Side::Connect => Ok(()),
        }
    }

    fn has_rules(&self) -> bool {
        self.is(true, "access_control/enabled")
            && self.value("access_control/default_permission") == "deny"
    }

    /// Links to whoever it finds in this way, or hears of.
    fn links_to_found(&self, found: &str) -> bool {
        let enabled = match found {
            "scouting/multicast" => !self.is(false, "scouting/multicast/enabled"),
            _ => !self.is(false, "scouting/gossip/enabled"),
        };
        let targets = match self.of_mode(&format!("{found}/autoconnect")) {
            Value::Null => self.mode() != "router", // Zenoh's default.
            Value::Array(targets) => !targets.is_empty(),
            targets => targets != "",
        };
        enabled && targets
    }
}

fn is_plain(endpoint: &EndPoint) -> bool {
    (endpoint.config().iter()).all(|(key, _)| HARMLESS.contains(&key))
}

/// Only programs of this machine can be at the other end of an endpoint's links.
pub fn is_here(endpoint: &str) -> bool {
    EndPoint::from_str(endpoint).is_ok_and(|endpoint| stays_here(&endpoint))
}

fn stays_here(endpoint: &EndPoint) -> bool {
    // An address of loopback through another interface goes out there.
    let mut parameters = endpoint.config().iter();
    let leaves = parameters.any(|(key, value)| key == "iface" && value != LOOPBACK_INTERFACE);
    match endpoint.protocol().as_str() {
        "unixsock-stream" => true,
        "tcp" | "tls" | "quic" => !leaves && is_own_address(endpoint.address().as_str()),
        _ => false,
    }
}

/// HOST:PORT is loopback. Of names only `localhost` is believed: what others mean is decided by whoever
/// answers for them, and anew for each connection.
pub fn is_own_address(address: &str) -> bool {
    if let Ok(address) = SocketAddr::from_str(address) {
        return is_loopback(address.ip());
    }
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    host.trim_end_matches('.').eq_ignore_ascii_case("localhost")
        && (address.to_socket_addrs())
            .is_ok_and(|mut all| all.all(|address| is_loopback(address.ip())))
}

/// Loopback, also when it is written as IPv6.
pub fn is_loopback(address: std::net::IpAddr) -> bool {
    address.to_canonical().is_loopback()
}

#[cfg(test)]
mod tests;
