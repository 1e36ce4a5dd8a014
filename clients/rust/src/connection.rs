//! A session with one daemon.

use crate::exact::is_one_key;
use crate::links::{self, Exposed, OpenError};
use palpate_proto::DeviceError;
use palpate_proto::codec::{DecodeError, decode};
use palpate_proto::keys::{IdError, Keys};
use palpate_proto::messages::{
    ControlNet, DeviceInfo, LoopStatus, Message, SceneSnapshot, SimEvent, ToolContact,
};
use palpate_proto::rpc::{Answer, Call, CallError, Done};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zenoh::Wait;

/// How to find a daemon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connect {
    /// Endpoints, for example `tcp/127.0.0.1:7447`.
    pub endpoints: Vec<String>,
    /// Instance name.
    pub instance: String,
    /// Zenoh configuration file (JSON5) to use instead of a plain peer.
    pub zenoh_config: Option<PathBuf>,
    /// Identity file that `palpate auth issue` made, for endpoints with TLS.
    pub identity: Option<PathBuf>,
    /// How long to wait for replies.
    pub timeout: Duration,
    /// Join in Zenoh client mode instead of as a peer, for observers: messages then take one more hop,
    /// and what other clients publish is received too, which peers receive only if they can reach
    /// each other.
    pub onlooker: bool,
    /// Also connect to other machines without TLS, where nobody knows who answers: whoever does moves the hand.
    pub insecure: bool,
}

impl Connect {
    /// One endpoint, instance `default`.
    pub fn to(endpoint: &str) -> Self {
        Self {
            endpoints: vec![endpoint.to_owned()],
            instance: "default".into(),
            zenoh_config: None,
            identity: None,
            timeout: Duration::from_secs(3),
            onlooker: false,
            insecure: false,
        }
    }
}

/// Why the daemon could not be spoken to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClientError {
    /// Nobody listens there.
    #[error("no daemon answers at {endpoint} ({reason}); is `palpate serve` running there?")]
    Unreachable {
        /// As given.
        endpoint: String,
        /// Operating system's words.
        reason: String,
    },
    /// A link would leave this machine unguarded.
    #[error(transparent)]
    Exposed(#[from] Exposed),
    /// A configuration or identity file that cannot be used.
    #[error("{0}")]
    File(String),
    /// The daemon and we do not accept each other's certificates.
    #[error("{endpoint}: {reason}")]
    Certificate {
        /// As given.
        endpoint: String,
        /// What is wrong with which, as far as TLS says.
        reason: String,
    },
    /// A query went unanswered.
    #[error(
        "no answer to {key} within {timeout:?}: is instance {instance:?} served there{}?",
        role_hint(*has_identity)
    )]
    NoAnswer {
        /// Key expression.
        key: String,
        /// Name of the instance.
        instance: String,
        /// How long we waited.
        timeout: Duration,
        /// We have a role, which may not include this.
        has_identity: bool,
    },
    /// An answer of another version.
    #[error(transparent)]
    Decode(#[from] DecodeError),
    /// An id that cannot be.
    #[error(transparent)]
    Id(#[from] IdError),
    /// The scene has no such tool or body.
    #[error("this scene has no {kind} {id:?}; it has {known}")]
    Unknown {
        /// `tool` or `body`.
        kind: &'static str,
        /// As given.
        id: String,
        /// What there is.
        known: String,
    },
    /// Another client holds the tool.
    #[error(
        "tool {tool:?} is held by another client ({holder}); stop it first, or move another tool"
    )]
    Held {
        /// Its id.
        tool: String,
        /// Name of the other's device, or what the daemon calls the other client.
        holder: String,
    },
    /// A description that fits no device.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A command that no daemon would carry out.
    #[error(transparent)]
    Call(#[from] CallError),
    /// The daemon refused a command.
    #[error("{method} was refused: {reason}")]
    Refused {
        /// Name of the method.
        method: String,
        /// Its words.
        reason: String,
    },
    /// Zenoh's own refusal.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

impl ClientError {
    pub(crate) fn zenoh(error: impl std::fmt::Display) -> Self {
        Self::Zenoh(error.to_string())
    }

    /// What a daemon said in an answer that is an error; `None` for Zenoh's own, like a query whose
    /// time is over.
    pub(crate) fn words(error: &zenoh::query::ReplyError) -> Option<String> {
        let answer: Answer = serde_json::from_slice(&error.payload().to_bytes()).ok()?;
        answer.into_result().err()
    }
}

/// The newest message of a kind; older ones are forgotten.
#[derive(Clone, Debug)]
pub struct Latest<M> {
    slot: Arc<Mutex<Option<M>>>,
    _subscriber: Arc<zenoh::pubsub::Subscriber<()>>,
}

impl<M: Message + Send + 'static> Latest<M> {
    pub(crate) fn subscribe(session: &zenoh::Session, key: String) -> Result<Self, ClientError> {
        let slot = Arc::new(Mutex::new(None));
        let shared = slot.clone();
        let callback = move |sample: zenoh::sample::Sample| {
            if is_one_key(sample.key_expr())
                && let Ok(message) = decode::<M>(&sample.payload().to_bytes(), "")
            {
                *shared.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
            }
        };
        let subscriber = session
            .declare_subscriber(key)
            .callback(callback)
            .wait()
            .map_err(ClientError::zenoh)?;
        Ok(Self {
            slot,
            _subscriber: Arc::new(subscriber),
        })
    }
}

impl<M: Clone> Latest<M> {
    /// The newest so far.
    pub fn get(&self) -> Option<M> {
        self.slot
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// The newest, leaving nothing: each message is seen once at most.
    pub fn take(&self) -> Option<M> {
        self.slot
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }
}

/// Between tries to connect again after a link was lost.
const RETRY: &str = "{ period_init_ms: 200, period_max_ms: 1000, period_increase_factor: 2 }";

/// A link to whoever accepts connections is there after this long.
const LINK: Duration = Duration::from_secs(2);

/// A session with one daemon.
pub struct Palpate {
    session: zenoh::Session,
    keys: Keys,
    settings: Connect,
}

impl Palpate {
    /// Connects as a peer, or as a client to a router: one passes nothing on between peers.
    ///
    /// # Errors
    /// An endpoint without a listener, or on another machine without TLS; a configuration Zenoh refuses, or an
    /// instance name that is no id.
    pub fn connect(settings: &Connect) -> Result<Self, ClientError> {
        let keys = Keys::new(&settings.instance)?;
        for endpoint in &settings.endpoints {
            check_endpoint(endpoint)?;
        }
        let mode = if settings.onlooker { "client" } else { "peer" };
        let (mut session, is_peer) = open(settings, mode)?;
        if is_peer && joins_router(&session, settings.timeout.min(LINK)) {
            let _ = session.close().wait();
            (session, _) = open(settings, "client")?;
        }
        Ok(Self {
            session,
            keys,
            settings: settings.clone(),
        })
    }

    /// Speaks to an instance over a session that exists: for programs that have one already, like the
    /// daemon's own adapters.
    ///
    /// # Errors
    /// The instance name has characters that an id may not have.
    pub fn over(session: zenoh::Session, instance: &str) -> Result<Self, ClientError> {
        Ok(Self {
            session,
            keys: Keys::new(instance)?,
            settings: Connect {
                endpoints: Vec::new(),
                instance: instance.to_owned(),
                ..Connect::to("")
            },
        })
    }

    pub(crate) fn session(&self) -> &zenoh::Session {
        &self.session
    }

    /// Keys of the instance.
    pub fn keys(&self) -> &Keys {
        &self.keys
    }

    fn query<T>(
        &self,
        key: String,
        payload: Option<Vec<u8>>,
        read: impl FnMut(&[u8]) -> Result<T, ClientError>,
    ) -> Result<T, ClientError> {
        self.query_within(self.settings.timeout, key, payload, read)
    }

    fn query_within<T>(
        &self,
        timeout: Duration,
        key: String,
        payload: Option<Vec<u8>>,
        mut read: impl FnMut(&[u8]) -> Result<T, ClientError>,
    ) -> Result<T, ClientError> {
        let started = Instant::now();
        // A fresh link may not have carried the daemon's declarations yet: ask again until the time
        // is over.
        loop {
            let left = timeout.saturating_sub(started.elapsed());
            let mut get = self
                .session
                .get(&key)
                .timeout(left.max(Duration::from_millis(10)));
            if let Some(payload) = &payload {
                get = get.payload(payload.clone());
            }
            let replies = get.wait().map_err(ClientError::zenoh)?;
            match replies.recv().as_ref().map(zenoh::query::Reply::result) {
                Ok(Ok(sample)) => return read(&sample.payload().to_bytes()),
                Ok(Err(error)) => {
                    if let Some(reason) = ClientError::words(error) {
                        return Err(ClientError::Refused {
                            method: key,
                            reason,
                        });
                    }
                }
                Err(_) => {}
            }
            if started.elapsed() >= timeout {
                let instance = self.settings.instance.clone();
                return Err(ClientError::NoAnswer {
                    key,
                    instance,
                    timeout,
                    has_identity: self.settings.identity.is_some(),
                });
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Bodies, tools, knots and nets as they are now.
    ///
    /// # Errors
    /// No answer, or one of another version.
    pub fn scene(&self) -> Result<SceneSnapshot, ClientError> {
        self.query(self.keys.scene(), None, |bytes| Ok(decode(bytes, "")?))
    }

    /// Health of the loop now.
    ///
    /// # Errors
    /// No answer, or one of another version.
    pub fn status(&self) -> Result<LoopStatus, ClientError> {
        self.query(self.keys.status(), None, |bytes| Ok(decode(bytes, "")?))
    }

    /// What the device that holds a tool can do.
    ///
    /// # Errors
    /// No reply: no device sent a description, or there is no such tool.
    pub fn device(&self, tool: &str) -> Result<DeviceInfo, ClientError> {
        self.query(self.keys.tool_device(tool), None, |bytes| {
            Ok(decode(bytes, "")?)
        })
    }

    /// JSON about the daemon: its scene, its messages, the device descriptions it received.
    ///
    /// # Errors
    /// No answer.
    pub fn info(&self) -> Result<String, ClientError> {
        self.query(self.keys.meta_info(), None, |bytes| {
            Ok(String::from_utf8_lossy(bytes).into_owned())
        })
    }

    /// The daemon's counters as OpenMetrics text.
    ///
    /// # Errors
    /// No answer.
    pub fn metrics(&self) -> Result<String, ClientError> {
        self.query(self.keys.meta_metrics(), None, |bytes| {
            Ok(String::from_utf8_lossy(bytes).into_owned())
        })
    }

    /// The layout of a message by its versioned name, as JSON.
    ///
    /// # Errors
    /// No answer, or no such type.
    pub fn schema(&self, name: &str) -> Result<String, ClientError> {
        self.query(self.keys.meta_schema(name), None, |bytes| {
            Ok(String::from_utf8_lossy(bytes).into_owned())
        })
    }

    /// The last events that the daemon still has (256) with numbers above `after`, oldest first:
    /// for clients that connect late or saw a gap in `seq`. Kinds of events that this client does not know
    /// are left out.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn past_events(&self, after: u64) -> Result<Vec<SimEvent>, ClientError> {
        let selector = format!("{}?after={after}", self.keys.event());
        let answers = self.ask(&selector, self.settings.timeout)?;
        let mut events: Vec<SimEvent> = answers
            .iter()
            .filter_map(|seen| decode(&seen.bytes, seen.schema()).ok())
            .collect();
        events.sort_by_key(|event| event.seq);
        Ok(events)
    }

    /// Carries out a command; gives the first tick on which it has effect.
    ///
    /// # Errors
    /// A number out of its range, no answer, or the daemon refused.
    pub fn rpc(&self, call: Call) -> Result<u64, ClientError> {
        self.call(call).map(|done| done.tick)
    }

    /// Carries out a command; gives all that its answer has.
    ///
    /// # Errors
    /// A number out of its range, no answer, or the daemon refused.
    pub fn call(&self, call: Call) -> Result<Done, ClientError> {
        let call = call.checked()?;
        let payload = serde_json::to_vec(&call.arguments()).map_err(ClientError::zenoh)?;
        let method = call.method();
        let refused = |reason: String| ClientError::Refused {
            method: method.to_owned(),
            reason,
        };
        // A snapshot of the next seconds is answered after them.
        let after = match call {
            Call::Snapshot { after, .. } => Duration::try_from_secs_f64(after).unwrap_or_default(),
            _ => Duration::ZERO,
        };
        let timeout = self.settings.timeout.saturating_add(after);
        let answer: Answer =
            self.query_within(timeout, self.keys.rpc(method), Some(payload), |bytes| {
                serde_json::from_slice(bytes)
                    .map_err(|e| refused(format!("its answer does not parse: {e}")))
            })?;
        answer.into_result().map_err(refused)
    }

    /// The newest net of a body, as it changes.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn nets(&self, body: &str) -> Result<Latest<ControlNet>, ClientError> {
        self.latest(self.keys.body_net(body))
    }

    /// What contacts do to a tool, the newest, for those who watch.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn contacts(&self, tool: &str) -> Result<Latest<ToolContact>, ClientError> {
        self.latest(self.keys.tool_contact(tool))
    }

    /// The newest status, ten times a second.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn statuses(&self) -> Result<Latest<LoopStatus>, ClientError> {
        self.latest(self.keys.status())
    }

    /// Calls `take` on each event, on a receive thread: be quick.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn events(
        &self,
        take: impl Fn(SimEvent) + Send + Sync + 'static,
    ) -> Result<zenoh::pubsub::Subscriber<()>, ClientError> {
        let callback = move |sample: zenoh::sample::Sample| {
            if is_one_key(sample.key_expr())
                && let Ok(event) = decode::<SimEvent>(&sample.payload().to_bytes(), "")
            {
                take(event);
            }
        };
        self.session
            .declare_subscriber(self.keys.event())
            .callback(callback)
            .wait()
            .map_err(ClientError::zenoh)
    }

    fn latest<M: Message + Clone + Send + 'static>(
        &self,
        key: String,
    ) -> Result<Latest<M>, ClientError> {
        Latest::subscribe(&self.session, key)
    }

    /// Closes the session; drop tools first.
    pub fn close(self) {
        let _ = self.session.close().wait();
    }
}

/// What else may be why nobody answers.
fn role_hint(has_identity: bool) -> &'static str {
    match has_identity {
        true => ", and may this identity ask it (`palpate auth show`)",
        false => "",
    }
}

/// Whether a router is at the other end of the first link.
fn joins_router(session: &zenoh::Session, patience: Duration) -> bool {
    let (info, begun) = (session.info(), Instant::now());
    loop {
        let is_router = info.routers_zid().wait().next().is_some();
        let is_linked = is_router || info.peers_zid().wait().next().is_some();
        if is_linked || begun.elapsed() >= patience {
            return is_router;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A session in a mode, unless the configuration names another; and whether it is a peer.
fn open(settings: &Connect, mode: &str) -> Result<(zenoh::Session, bool), ClientError> {
    let path = settings.zenoh_config.as_deref();
    let mut config = crate::configuration(path, mode).map_err(ClientError::File)?;
    let is_peer = config.get_json("mode").is_ok_and(|mode| mode == "\"peer\"");
    let endpoints = serde_json::to_string(&settings.endpoints).map_err(ClientError::zenoh)?;
    config
        .insert_json5("connect/endpoints", &endpoints)
        .map_err(ClientError::zenoh)?;
    // Zenoh's own pauses grow to four seconds: a hand would wait for a router that is back already.
    if config
        .get_json("connect/retry")
        .is_ok_and(|retry| retry == "null")
    {
        config
            .insert_json5("connect/retry", RETRY)
            .map_err(ClientError::zenoh)?;
    }
    if let Some(identity) = &settings.identity {
        crate::add_identity(&mut config, identity).map_err(ClientError::File)?;
    }
    let secured = settings.endpoints.iter().find(|at| crate::is_secured(at));
    if let Some(endpoint) = secured {
        crate::tls::demand(&mut config, endpoint, settings)?;
    }
    links::check(&config, settings.insecure)?;
    for endpoint in &settings.endpoints {
        check_reachable(endpoint, settings.timeout)?;
    }
    let opened = links::open(config, settings.insecure);
    let session = opened.map_err(|error| match (secured, error) {
        (Some(endpoint), OpenError::Zenoh(words)) => crate::tls::refused(endpoint, &words),
        (None, OpenError::Zenoh(words)) => ClientError::Zenoh(words),
        (_, OpenError::Exposed(exposed)) => exposed.into(),
    })?;
    Ok((session, is_peer))
}

fn unreachable(endpoint: &str, reason: impl ToString) -> ClientError {
    ClientError::Unreachable {
        endpoint: endpoint.to_owned(),
        reason: reason.to_string(),
    }
}

fn check_endpoint(endpoint: &str) -> Result<(), ClientError> {
    if !endpoint.contains('/') {
        let reason = "write an endpoint like tcp/127.0.0.1:7447";
        return Err(unreachable(endpoint, reason));
    }
    crate::check_protocol(endpoint).map_err(|reason| unreachable(endpoint, reason))
}

/// Zenoh would retry an absent peer without a word: ask the socket first.
fn check_reachable(endpoint: &str, timeout: Duration) -> Result<(), ClientError> {
    // With TLS a bare connection would be a failed handshake in the daemon's log; `tls` asks Zenoh instead.
    let Some(address) = endpoint.strip_prefix("tcp/") else {
        return Ok(());
    };
    let address = address.split(['#', '?']).next().unwrap_or_default();
    let mut addresses = address
        .to_socket_addrs()
        .map_err(|e| unreachable(endpoint, e))?;
    let address = addresses
        .next()
        .ok_or_else(|| unreachable(endpoint, "the host has no address"))?;
    TcpStream::connect_timeout(&address, timeout)
        .map(drop)
        .map_err(|e| unreachable(endpoint, e))
}
