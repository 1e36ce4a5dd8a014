//! The page: one server on loopback, fed by the bus, spoken to over a binary WebSocket.
//!
//! ```text
//! bus thread ─▶ Feed ─▶ Board (newest of each key) ─▶ sockets ─▶ pages
//! pages ─▶ sockets ─▶ Hands ─▶ the daemon's own session ─▶ bus    (poses, commands: as any client's)
//! ```
//! Frames hold the bus's own messages (docs/wire.md). The bus thread never waits for a page, and
//! makes nothing for pages while none is open. The page itself is `clients/web`, built into `page/`.

mod board;
mod feed;
mod frames;
mod guard;
mod hands;
mod health;
mod holders;
mod html;
mod listener;
mod neighbours;
mod recordings;
mod server;
mod session;
mod socket;

pub use feed::Feed;
pub use html::{HtmlError, html_page};
pub use recordings::RecordingsViewer;

use crate::wire::tool_outlines;
use axum::Router;
use axum::routing::get;
use board::Board;
use guard::Hosts;
use holders::Holders;
use neighbours::Neighbours;
use palpate_proto::keys::Keys;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use server::Server;
use session::SessionInfo;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, PoisonError};

/// How a page is served.
#[derive(Clone, Debug)]
pub struct ViewerSettings {
    /// Port 0: any free one.
    pub address: SocketAddr,
    /// Names, beside numbers and `localhost`, under which it may be opened.
    pub hosts: Vec<String>,
    /// Pages may not write.
    pub view_only: bool,
    /// Name of the instance.
    pub instance: String,
    /// A recording is played: nobody moves its tools.
    pub played: bool,
}

/// Why a page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The address.
    #[error("the page cannot be served at {address}: {source}; choose another with --http")]
    Listen {
        /// As given.
        address: SocketAddr,
        /// The system's words.
        source: std::io::Error,
    },
    /// Something of the system.
    #[error("the page cannot be served: {0}")]
    System(String),
}

/// A running viewer; it ends when dropped.
pub struct Viewer {
    server: Server,
}

impl Viewer {
    /// Serves the page of a scene. What pages do goes through `session`, the daemon's own.
    ///
    /// # Errors
    /// The address is taken, or the system refused a thread or randomness.
    pub fn start(
        settings: &ViewerSettings,
        scene: &Scene,
        session: &zenoh::Session,
    ) -> Result<(Self, Feed), ViewerError> {
        let system = |error: &dyn std::fmt::Display| ViewerError::System(error.to_string());
        let listener = std::net::TcpListener::bind(settings.address).map_err(|source| {
            ViewerError::Listen {
                address: settings.address,
                source,
            }
        })?;
        let keys = Keys::new(&settings.instance).map_err(|e| system(&e))?;
        let board = Arc::new(Board::new());
        let tools: Vec<String> = (0..scene.tool_count())
            .map(|tool| scene.tool_id(tool).to_owned())
            .collect();
        let holders = Arc::new(Holders::new(&tools, board.clone()));
        let lockstep = scene.clock == Clock::Lockstep;
        let orders = hands::start(
            session.clone(),
            keys,
            holders.clone(),
            settings.played,
            lockstep.then_some(scene.dt_s),
        )
        .map_err(|e| system(&e))?;
        let token = match settings.view_only {
            true => None,
            false => Some(make_token().map_err(|e| system(&e))?),
        };
        let neighbours = Neighbours::watch(session, &settings.instance).map_err(|e| system(&e))?;
        let feed = Feed {
            board: board.clone(),
            holders,
            health: Arc::default(),
            outlines: Arc::new(Mutex::new(tool_outlines(scene))),
        };
        let info = SessionInfo {
            mode: "live",
            instance: settings.instance.clone(),
            version: env!("CARGO_PKG_VERSION"),
            token: token.clone(),
            recordings: Vec::new(),
            instances: Vec::new(),
            pages: BTreeMap::new(),
            played: settings.played,
            lockstep,
        };
        let live = socket::Live {
            board,
            orders,
            token: token.map(Into::into),
            next: Arc::new(AtomicU64::new(1)),
        };
        let outlines = feed.outlines.clone();
        let tools = move || {
            let text = outlines.lock().unwrap_or_else(PoisonError::into_inner);
            let json = [(axum::http::header::CONTENT_TYPE, "application/json")];
            std::future::ready((json, text.clone()))
        };
        let session_json = move || {
            let (mut info, neighbours) = (info.clone(), neighbours.clone());
            async move {
                info.instances = neighbours.instances();
                info.pages = neighbours.pages().await;
                session::json(&info)
            }
        };
        let routes = Router::new()
            .route("/live", get(socket::open))
            .with_state(live)
            .route("/session.json", get(session_json))
            .route("/tools.json", get(tools))
            .merge(health::routes(feed.health.clone()));
        let hosts = Hosts(settings.hosts.clone().into());
        let server = Server::start(listener, routes, hosts).map_err(|e| system(&e))?;
        Ok((Self { server }, feed))
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        self.server.url()
    }
}

/// 128 random bits as text: other sites cannot read it, and nobody guesses it.
fn make_token() -> Result<String, getrandom::Error> {
    let mut bits = [0; 16];
    getrandom::fill(&mut bits)?;
    Ok(bits.iter().map(|byte| format!("{byte:02x}")).collect())
}
