//! What Agones, which runs fleets of servers on Kubernetes, learns of a daemon.
//!
//! ```text
//! loop ready ─▶ /ready      every 2 s while it is ready ─▶ /health
//! first holder of a tool ─▶ /allocate        end ─▶ /shutdown
//! ```
//! A loop that is stuck or too slow sends no health, so that Agones replaces it. Everything but health is
//! tried again until the sidecar takes it: it may start after the daemon.

use super::sidecar::{Sidecar, SidecarError};
use crate::transport::Health;
use palpate_proto::keys::Keys;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zenoh::Wait as _;
use zenoh::sample::SampleKind;

/// The variable that Agones sets in the pods of its servers.
pub const PORT_VARIABLE: &str = "AGONES_SDK_HTTP_PORT";

/// Health is reported this often, or twice in the period of the server's description if that is shorter.
const HEALTH_EVERY: Duration = Duration::from_secs(2);
/// How often is looked whether something is due.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Between the first two tries; each further pause is twice as long.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
const LONGEST_PAUSE: Duration = Duration::from_secs(1);
/// At the end, for a sidecar that does not take the news.
const LAST_TRIES: Duration = Duration::from_secs(3);

/// Why Agones cannot be reached.
#[derive(Debug, thiserror::Error)]
pub enum AgonesError {
    /// Not in a pod of Agones.
    #[error(
        "--agones: {PORT_VARIABLE} is not set, so this is no game server of Agones; leave --agones out, or set the variable \
         to the HTTP port of an SDK server"
    )]
    NotThere,
    /// The variable is wrong.
    #[error("--agones: {PORT_VARIABLE} is {0:?}; it must be a port, like 9358")]
    Port(String),
    /// The liveliness tokens of tools cannot be watched.
    #[error("--agones: {0}")]
    Bus(String),
    /// The system refused a thread.
    #[error("--agones: {0}")]
    Thread(#[from] std::io::Error),
}

/// Port of the sidecar, as the environment says.
///
/// # Errors
/// There is none, or it is no port.
pub fn port() -> Result<u16, AgonesError> {
    match std::env::var_os(PORT_VARIABLE) {
        None => Err(AgonesError::NotThere),
        Some(text) => {
            let text = text.to_string_lossy();
            let port = text.trim().parse().ok().filter(|port| *port > 0);
            port.ok_or_else(|| AgonesError::Port(text.into_owned()))
        }
    }
}

/// What happens in the daemon, for the thread that reports it.
#[derive(Debug, Default)]
struct Seen {
    /// Someone holds a tool, or did.
    held: AtomicBool,
    /// The server is in use: a client or Agones said so.
    allocated: AtomicBool,
    stop: AtomicBool,
}

/// Reports a daemon to Agones. Dropped, it reports that the daemon ends, and waits some seconds until that is
/// heard.
pub struct Agones {
    seen: Arc<Seen>,
    thread: Option<JoinHandle<()>>,
    _tokens: zenoh::pubsub::Subscriber<()>,
}

impl Agones {
    /// Starts to tell. `health` says whether the loop is ready, `session` who holds its tools.
    ///
    /// # Errors
    /// The bus or the system refused.
    pub fn start(
        port: u16,
        session: &zenoh::Session,
        keys: &Keys,
        health: Arc<Health>,
    ) -> Result<Self, AgonesError> {
        let seen = Arc::new(Seen::default());
        let held = seen.clone();
        let tokens = session
            .liveliness()
            .declare_subscriber(keys.live_tool("*"))
            .callback(move |sample| {
                if sample.kind() == SampleKind::Put {
                    held.held.store(true, Ordering::Release);
                }
            })
            .wait()
            .map_err(|error| AgonesError::Bus(error.to_string()))?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let mut teller = Teller::new(Sidecar { port }, health, seen.clone());
        let thread = std::thread::Builder::new()
            .name("palpate-agones".into())
            .spawn(move || runtime.block_on(teller.run()))?;
        Ok(Self {
            seen,
            thread: Some(thread),
            _tokens: tokens,
        })
    }

    /// True once the server is in use: a client held a tool, or Agones allocated it. Before, it waits to be
    /// taken, however long that takes.
    pub fn in_use(&self) -> impl Fn() -> bool + Send + 'static {
        let seen = self.seen.clone();
        move || seen.allocated.load(Ordering::Acquire) || seen.held.load(Ordering::Acquire)
    }
}

impl Drop for Agones {
    fn drop(&mut self) {
        self.seen.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Something that must be reported once, and is tried until it was.
#[derive(Debug)]
struct Once {
    path: &'static str,
    done: bool,
    next: Instant,
    pause: Duration,
}

impl Once {
    fn new(path: &'static str) -> Self {
        Self {
            path,
            done: false,
            next: Instant::now(),
            pause: FIRST_PAUSE,
        }
    }

    fn is_due(&self) -> bool {
        !self.done && Instant::now() >= self.next
    }

    /// Makes the call; true when the sidecar has accepted it.
    async fn tell(&mut self, sidecar: Sidecar) -> bool {
        match sidecar.call(self.path).await {
            Ok(()) => {
                tracing::info!(call = self.path, "reported to Agones");
                self.done = true;
            }
            Err(error) => {
                warn(self.path, &error, self.pause == FIRST_PAUSE);
                self.next = Instant::now() + self.pause;
                self.pause = (2 * self.pause).min(LONGEST_PAUSE);
            }
        }
        self.done
    }
}

/// The first of a row of failures is a warning, the others are for those who look closely.
fn warn(call: &str, error: &SidecarError, first: bool) {
    match first {
        true => {
            tracing::warn!(call, %error, "the Agones sidecar did not take a call; it is tried again")
        }
        false => tracing::debug!(call, %error, "the Agones sidecar did not take a call"),
    }
}

struct Teller {
    sidecar: Sidecar,
    health: Arc<Health>,
    seen: Arc<Seen>,
    ready: Once,
    allocate: Once,
    period: Duration,
    next_health: Instant,
    /// The last health was taken.
    taken: bool,
}

impl Teller {
    fn new(sidecar: Sidecar, health: Arc<Health>, seen: Arc<Seen>) -> Self {
        Self {
            sidecar,
            health,
            seen,
            ready: Once::new("/ready"),
            allocate: Once::new("/allocate"),
            period: HEALTH_EVERY,
            next_health: Instant::now(),
            taken: true,
        }
    }

    async fn run(&mut self) {
        while !self.seen.stop.load(Ordering::Acquire) {
            self.turn().await;
            tokio::time::sleep(LOOK_EVERY).await;
        }
        let mut shutdown = Once::new("/shutdown");
        let begun = Instant::now();
        while begun.elapsed() < LAST_TRIES {
            if shutdown.is_due() && shutdown.tell(self.sidecar).await {
                return;
            }
            tokio::time::sleep(LOOK_EVERY).await;
        }
        tracing::warn!("Agones does not know that this daemon ends; it will see its pod end");
    }

    /// Tells what is due.
    async fn turn(&mut self) {
        if self.health.not_ready().is_none() {
            if Instant::now() >= self.next_health {
                self.tell_health().await;
            }
            if self.ready.is_due() {
                self.ready.tell(self.sidecar).await;
            }
        }
        if self.health.moved() {
            self.seen.held.store(true, Ordering::Release);
        }
        // Agones allocates what is ready.
        let taken = self.ready.done && self.seen.held.load(Ordering::Acquire);
        if taken && self.allocate.is_due() && self.allocate.tell(self.sidecar).await {
            self.seen.allocated.store(true, Ordering::Release);
        }
    }

    async fn tell_health(&mut self) {
        self.next_health = Instant::now() + self.period;
        match self.sidecar.call("/health").await {
            Ok(()) => {
                if !self.taken {
                    tracing::info!("the Agones sidecar takes health again");
                }
                self.taken = true;
                self.look_at_server().await;
            }
            Err(error) => {
                warn("/health", &error, self.taken);
                self.taken = false;
            }
        }
    }

    /// Reads the server's description: how often health must be reported, and whether Agones gave the server to
    /// someone.
    async fn look_at_server(&mut self) {
        let Ok(server) = self.sidecar.get("/gameserver").await else {
            return;
        };
        if server["status"]["state"] == "Allocated" {
            self.seen.allocated.store(true, Ordering::Release);
            // What it did itself need not be reported.
            self.allocate.done = true;
        }
        // Field names as in the proto file or in its JSON form, by the version of Agones.
        let health = &server["spec"]["health"];
        let period = health["period_seconds"].as_f64();
        let period = period.or_else(|| health["periodSeconds"].as_f64());
        if let Some(period) = period.filter(|period| *period >= 1.0) {
            self.period = HEALTH_EVERY.min(Duration::from_secs_f64(0.5 * period.min(1e6)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tries_come_more_and_more_rarely() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        // A port that was free a moment ago.
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        drop(listener);
        let mut call = Once::new("/ready");
        for k in 0..8 {
            let reported = runtime.block_on(call.tell(Sidecar { port }));
            assert!(!reported && !call.is_due());
            let pause = FIRST_PAUSE * 2_u32.pow(k + 1);
            assert_eq!(call.pause, pause.min(LONGEST_PAUSE));
        }
    }
}
