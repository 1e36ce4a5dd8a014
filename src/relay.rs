//! Between a daemon and many who watch: a Zenoh router that thins nets, and on request lets no one write.
//!
//! ```text
//! daemon ◀─ one link ─▶ relay ◀─▶ viewers, further relays
//! ```
//! A daemon sends each message to every client that it is connected to. Behind a relay it sends it once.
//! What the router does with messages is configured in Zenoh as downsampling and access-control rules; nothing
//! of ours touches them on their way.

use crate::transport::{ROUTER_PATIENCE, bound};
use palpate_client::is_secured;
use palpate_client::links::{self, Exposed, LOOPBACK_INTERFACE, OpenError, Opening};
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
    /// Its links may leave this machine unguarded.
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
    /// Others than this machine could be at the other end of a link, unguarded.
    #[error("{error}{}", advice(.error))]
    Exposed {
        /// Which.
        #[from]
        error: Exposed,
    },
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
    /// No one answers.
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
        // Before anybody is asked anything; whose id the rules name does not matter yet.
        links::check(&settings.router("1")?, settings.insecure)?;
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

/// What else lets those behind a relay in.
fn advice(error: &Exposed) -> &'static str {
    match error.openings.iter().any(Opening::lacks_rules) {
        true => "; --read-only is a set of rules, too",
        false => "",
    }
}

impl From<OpenError> for RelayError {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Exposed(exposed) => exposed.into(),
            OpenError::Zenoh(words) => Self::Zenoh(words),
        }
    }
}

impl RelaySettings {
    fn config(&self, mode: &str) -> Result<zenoh::Config, RelayError> {
        let path = self.config.as_deref();
        let mut config =
            palpate_client::configuration(path, mode).map_err(|reason| RelayError::Config {
                path: self.config.clone().unwrap_or_default(),
                reason,
            })?;
        if let Some(identity) = &self.identity {
            palpate_client::add_identity(&mut config, identity).map_err(RelayError::Identity)?;
        }
        Ok(config)
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
        let session = match links::open(config, self.insecure) {
            Ok(session) => session,
            Err(OpenError::Zenoh(words)) => return Err(unreachable(words)),
            Err(exposed) => return Err(exposed.into()),
        };
        let info = session.info();
        let routers = info.routers_zid().wait();
        let upstream = routers.chain(info.peers_zid().wait()).next();
        let _ = session.close().wait();
        upstream
            .map(|zid| zid.to_string())
            .ok_or_else(|| unreachable("it did not say who it is".into()))
    }

    fn session(&self, upstream: &str) -> Result<zenoh::Session, RelayError> {
        Ok(links::open(self.router(upstream)?, self.insecure)?)
    }

    fn router(&self, upstream: &str) -> Result<zenoh::Config, RelayError> {
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
        Ok(config)
    }

    /// What Zenoh is to do with messages: key of its configuration, and value.
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
            rules.push(("access_control", read_only(self.far_end(upstream))));
        }
        rules
    }

    /// The session at `from`, as a subject of rules. Anybody can call himself by its id, so the link must be its
    /// own too.
    fn far_end(&self, id: &str) -> Value {
        let mut subject = json!({ "id": "upstream", "zids": [id] });
        let (key, value) = match self.from.split_once('/') {
            Some(("unixsock-stream", _)) => ("link_protocols", "unixsock-stream"),
            Some(("tcp", _)) if links::is_here(&self.from) => ("interfaces", LOOPBACK_INTERFACE),
            Some(_) if is_secured(&self.from) && self.identity.is_some() => {
                ("cert_common_names", "daemon")
            }
            _ => return subject,
        };
        subject[key] = json!([value]);
        subject
    }
}

fn set(config: &mut zenoh::Config, key: &str, value: &Value) -> Result<(), RelayError> {
    config
        .insert_json5(key, &value.to_string())
        .map_err(|error| RelayError::Zenoh(format!("{key}: {error}")))
}

/// Everything with the session at `from`; with all others only what watching needs.
fn read_only(upstream: Value) -> Value {
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
            upstream,
            { "id": "anyone" },
        ],
        "policies": [
            { "rules": ["all"], "subjects": ["upstream"] },
            { "rules": ["gets", "looks", "asks"], "subjects": ["anyone"] },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // An id is what a session says of itself: while the daemon is away, anyone could take its place.
    #[test]
    fn the_session_that_may_write_is_known_by_its_link_too() {
        let subject = |from: &str, identity: Option<&str>| {
            let settings = RelaySettings {
                from: from.into(),
                listen: Vec::new(),
                net_hz: None,
                read_only: true,
                insecure: true,
                identity: identity.map(PathBuf::from),
                config: None,
            };
            let rules = settings.rules("ab");
            let (_, access) = rules
                .iter()
                .find(|(key, _)| *key == "access_control")
                .unwrap();
            access["subjects"][0].clone()
        };
        let known = |key: &str, value: &str| {
            let mut known = json!({ "id": "upstream", "zids": ["ab"] });
            known[key] = json!([value]);
            known
        };
        let loopback = known("interfaces", LOOPBACK_INTERFACE);
        assert_eq!(subject("tcp/127.0.0.1:7447", None), loopback);
        let socket = known("link_protocols", "unixsock-stream");
        assert_eq!(subject("unixsock-stream//tmp/bus", None), socket);
        let daemon = known("cert_common_names", "daemon");
        assert_eq!(
            subject("tls/lab.example:7447", Some("keys/relay.json5")),
            daemon
        );
        // Nothing is known of whoever is there.
        assert_eq!(
            subject("tcp/10.0.0.2:7447", None),
            json!({ "id": "upstream", "zids": ["ab"] })
        );
    }
}
