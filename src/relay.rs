//! Between a daemon and many who watch: a Zenoh router that thins nets, and on request lets nobody write.
//!
//! ```text
//! daemon ◀─ one link ─▶ relay ◀─▶ viewers, further relays
//! ```
//! A daemon sends each message to every client that it is connected to. Behind a relay it sends it once.
//! What the router does with messages is told to Zenoh as downsampling and access-control rules; nothing
//! of ours touches them on their way.

use crate::transport::{ROUTER_PATIENCE, bound};
use palpate_client::is_secured;
use palpate_proto::messages::{ControlNet, Message};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use zenoh::Wait;

/// How long a relay looks for whom it is to relay, each time.
const REACH: Duration = Duration::from_secs(3);

/// What a relay does.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaySettings {
    /// Endpoint of the daemon, or of another relay.
    pub from: String,
    /// Endpoints to listen on.
    pub listen: Vec<String>,
    /// Nets of a body a second at most; all of them if absent.
    pub net_hz: Option<f64>,
    /// Those who connect here can look and ask, not move tools, command or say anything.
    pub read_only: bool,
    /// It may listen to a network without TLS.
    pub insecure: bool,
    /// Identity file for TLS, as `palpate auth` makes them for daemons.
    pub identity: Option<PathBuf>,
    /// A Zenoh configuration file, for example with access rules: it changes only what it names.
    pub config: Option<PathBuf>,
}

/// Why a relay cannot run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RelayError {
    /// A figure that cannot be.
    #[error("--net-hz is {0}; above 0 and at most 1000")]
    Rate(f64),
    /// Others than this machine would reach it, and read what goes through.
    #[error(
        "{0} is open to the network without TLS; listen on 127.0.0.1, on a Unix socket or with tls/, or say --insecure"
    )]
    Open(String),
    /// Whoever has a certificate could do everything through it.
    #[error(
        "{0} is open to everybody with a certificate, whatever its role: say what roles may do with --zenoh-config and \
         the output of `palpate auth rules SCENE`, or --read-only, or --insecure"
    )]
    NoRules(String),
    /// The identity file.
    #[error("{0}")]
    Identity(String),
    /// The configuration file.
    #[error("Zenoh configuration {path}: {reason}")]
    Config {
        /// File.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Nobody answers.
    #[error("nobody answers at {endpoint}: {reason}; is `palpate serve` or a relay running there?")]
    Unreachable {
        /// As given.
        endpoint: String,
        /// What is wrong.
        reason: String,
    },
    /// Zenoh's own refusal, such as a port that is taken.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

/// A running relay.
pub struct Relay {
    settings: RelaySettings,
    session: Option<zenoh::Session>,
    /// Id of the session at `from`: in Zenoh's rules it is what may write.
    upstream: String,
    lost: Option<Instant>,
}

/// What changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RelayNews {
    /// The link to the daemon is down.
    Lost,
    /// It is there again, or another daemon is.
    Back,
}

impl Relay {
    /// Opens it; whoever is at `from` must be there.
    ///
    /// # Errors
    /// See [`RelayError`].
    pub fn open(settings: RelaySettings) -> Result<Self, RelayError> {
        if let Some(hz) = settings.net_hz
            && !(hz > 0.0 && hz <= 1_000.0)
        {
            return Err(RelayError::Rate(hz));
        }
        let open = (settings.listen.iter()).find(|endpoint| !stays_here(endpoint));
        if let (Some(open), false) = (open, settings.insecure) {
            return Err(RelayError::Open(open.clone()));
        }
        if let (Some(open), false) = (settings.without_rules()?, settings.insecure) {
            return Err(RelayError::NoRules(open));
        }
        let upstream = settings.upstream()?;
        let session = settings.session(&upstream)?;
        Ok(Self {
            settings,
            session: Some(session),
            upstream,
            lost: None,
        })
    }

    /// Looks after the link; call it a few times a second. A daemon that was started again has another
    /// id: the rules that name it are made anew, and those who are connected here connect again.
    ///
    /// # Errors
    /// The endpoints could not be opened again.
    pub fn look(&mut self) -> Result<Option<RelayNews>, RelayError> {
        let linked = self.session.as_ref().is_some_and(|session| {
            let info = session.info();
            let routers = info.routers_zid().wait();
            let mut all = routers.chain(info.peers_zid().wait());
            all.any(|zid| zid.to_string() == self.upstream)
        });
        match (linked, self.lost) {
            (true, None) => Ok(None),
            (true, Some(_)) => {
                self.lost = None;
                Ok(Some(RelayNews::Back))
            }
            (false, None) => {
                self.lost = Some(Instant::now());
                Ok(Some(RelayNews::Lost))
            }
            (false, Some(_)) => {
                let Ok(upstream) = self.settings.upstream() else {
                    return Ok(None);
                };
                if upstream == self.upstream || !self.settings.read_only {
                    // Zenoh joins it by itself.
                    self.upstream = upstream;
                    return Ok(None);
                }
                if let Some(session) = self.session.take() {
                    let _ = session.close().wait();
                }
                self.session = Some(self.settings.session(&upstream)?);
                self.upstream = upstream;
                self.lost = None;
                Ok(Some(RelayNews::Back))
            }
        }
    }

    /// Closes it.
    pub fn close(self) {
        if let Some(session) = self.session {
            let _ = session.close().wait();
        }
    }
}

/// Only this machine reaches an endpoint, or those who have a certificate for it.
pub(crate) fn stays_here(endpoint: &str) -> bool {
    let Some((protocol, address)) = endpoint.split_once('/') else {
        return false;
    };
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    let number = host.trim_matches(['[', ']']).parse::<std::net::IpAddr>();
    let loopback = host == "localhost" || number.is_ok_and(|number| number.is_loopback());
    loopback || protocol == "unixsock-stream" || is_secured(endpoint)
}

impl RelaySettings {
    /// An endpoint that certificates lead into, and behind which nothing asks for their roles.
    fn without_rules(&self) -> Result<Option<String>, RelayError> {
        let encrypted = |endpoint: &&String| is_secured(endpoint);
        let config = self.config("router")?;
        let has_rules = (config.get_json("access_control/enabled")).is_ok_and(|is| is == "true");
        let mut encrypted = self.listen.iter().filter(encrypted);
        Ok(match has_rules || self.read_only {
            true => None,
            false => encrypted.next().cloned(),
        })
    }

    fn config(&self, mode: &str) -> Result<zenoh::Config, RelayError> {
        let mut config = self.plain_config(mode)?;
        if let Some(identity) = &self.identity {
            palpate_client::add_identity(&mut config, identity).map_err(RelayError::Identity)?;
        }
        Ok(config)
    }

    fn plain_config(&self, mode: &str) -> Result<zenoh::Config, RelayError> {
        match &self.config {
            None => {
                let mut config = zenoh::Config::default();
                set(&mut config, "mode", &json!(mode))?;
                set(&mut config, "scouting/multicast/enabled", &json!(false))?;
                Ok(config)
            }
            Some(path) => palpate_client::read_config(path, mode)
                .map(|(config, _)| config)
                .map_err(|reason| RelayError::Config {
                    path: path.clone(),
                    reason,
                }),
        }
    }

    /// Asks who is at `from`.
    fn upstream(&self) -> Result<String, RelayError> {
        let unreachable = |reason: String| RelayError::Unreachable {
            endpoint: self.from.clone(),
            reason,
        };
        let mut config = self.config("client")?;
        set(&mut config, "listen/endpoints", &json!([]))?;
        set(&mut config, "connect/endpoints", &json!([self.from]))?;
        let patience_ms = REACH.as_millis() as u64;
        set(&mut config, "connect/timeout_ms", &json!(patience_ms))?;
        let session = zenoh::open(config)
            .wait()
            .map_err(|error| unreachable(error.to_string()))?;
        let info = session.info();
        let routers = info.routers_zid().wait();
        let upstream = routers.chain(info.peers_zid().wait()).next();
        let _ = session.close().wait();
        upstream
            .map(|zid| zid.to_string())
            .ok_or_else(|| unreachable("it did not say who it is".into()))
    }

    fn session(&self, upstream: &str) -> Result<zenoh::Session, RelayError> {
        let mut config = self.config("router")?;
        set(&mut config, "connect/endpoints", &json!([self.from]))?;
        set(&mut config, "listen/endpoints", &json!(self.listen))?;
        if self.read_only {
            // Gossip would tell those behind the relay where the daemon is: sessions in mode peer would
            // join it past the rules.
            set(&mut config, "scouting/gossip/enabled", &json!(false))?;
        }
        for (key, value) in self.rules(upstream) {
            set(&mut config, key, &value)?;
        }
        bound(&mut config, ROUTER_PATIENCE).map_err(RelayError::Zenoh)?;
        zenoh::open(config)
            .wait()
            .map_err(|error| RelayError::Zenoh(error.to_string()))
    }

    /// What Zenoh is told to do with messages: key of its configuration, and value.
    pub fn rules(&self, upstream: &str) -> Vec<(&'static str, Value)> {
        let mut rules = Vec::new();
        if let Some(hz) = self.net_hz {
            let nets = format!("palpate/*/{}", ControlNet::KEY.replace("{body}", "*"));
            let thinned = json!([{
                "messages": ["put"],
                "flows": ["egress"],
                "rules": [{ "key_expr": nets, "freq": hz }],
            }]);
            rules.push(("downsampling", thinned));
        }
        if self.read_only {
            rules.push(("access_control", read_only(upstream)));
        }
        rules
    }
}

fn set(config: &mut zenoh::Config, key: &str, value: &Value) -> Result<(), RelayError> {
    config
        .insert_json5(key, &value.to_string())
        .map_err(|error| RelayError::Zenoh(format!("{key}: {error}")))
}

/// Everything with the session at `from`; with all others only what watching needs.
fn read_only(upstream: &str) -> Value {
    let rule = |id: &str, flows: &[&str], messages: &[&str], keys: &[&str]| {
        json!({
            "id": id, "permission": "allow", "flows": flows, "messages": messages, "key_exprs": keys,
        })
    };
    let all = [
        "put",
        "delete",
        "declare_subscriber",
        "query",
        "declare_queryable",
        "reply",
        "liveliness_token",
        "declare_liveliness_subscriber",
        "liveliness_query",
    ];
    // `**` does not match chunks that begin with @.
    let keys = ["**", "palpate/*/@meta/**", "palpate/*/@live/**"];
    let asked = [
        "palpate/*/scene",
        "palpate/*/status",
        "palpate/*/event",
        "palpate/*/body/*/net",
        "palpate/*/tool/*/device",
        "palpate/*/@meta/**",
    ];
    let looks = [
        "declare_subscriber",
        "declare_liveliness_subscriber",
        "liveliness_query",
    ];
    json!({
        "enabled": true,
        "default_permission": "deny",
        "rules": [
            rule("all", &["ingress", "egress"], &all, &keys),
            rule("gets", &["egress"], &all, &keys),
            rule("looks", &["ingress"], &looks, &keys),
            rule("asks", &["ingress"], &["query"], &asked),
        ],
        "subjects": [
            { "id": "upstream", "zids": [upstream] },
            { "id": "anyone" },
        ],
        "policies": [
            { "rules": ["all"], "subjects": ["upstream"] },
            { "rules": ["gets", "looks", "asks"], "subjects": ["anyone"] },
        ],
    })
}
