//! The page: one server on loopback, fed by the bus, spoken to over a binary WebSocket.
//!
//! ```text
//! bus thread ─▶ Feed ─▶ Board (newest of each key) ─▶ sockets ─▶ pages
//! pages ─▶ sockets ─▶ Hands ─▶ the daemon's own session ─▶ bus    (poses, commands: as any client's)
//! Board ─▶ foxglove ─▶ Foxglove, Lichtblick                       (views, as in recordings)
//! ```
//! Frames hold the bus's own messages (docs/wire.md). The bus thread never waits for a page, and
//! makes nothing for pages while none is open. The page itself is `clients/web`, built into `page/`.

mod board;
mod feed;
mod files;
mod foxglove;
mod frames;
mod hands;
mod health;
mod holders;
mod html;
mod neighbours;
mod recordings;
mod session;
mod socket;
mod steady;

pub use feed::Feed;
pub use html::{HtmlError, html_page};
pub use recordings::RecordingsViewer;

use axum::Router;
use axum::routing::get;
use board::Board;
use foxglove::Foxglove;
use holders::Holders;
use neighbours::Neighbours;
use palpate_http::{Hosts, Server};
use palpate_proto::keys::Keys;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use palpate_wire::{bodies_inside, tool_outlines};
use session::SessionInfo;
use std::collections::BTreeMap;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, PoisonError};

/// How a page is served.
#[derive(Clone, Debug)]
pub struct ViewerSettings {
    /// Port 0: any free one. `None`: no page.
    pub address: Option<SocketAddr>,
    /// Names, beside numbers and `localhost`, under which it may be opened.
    pub hosts: Vec<String>,
    /// Sites whose pages may connect to `/foxglove` and to routes of others.
    pub origins: Vec<String>,
    /// A port of its own on loopback for Foxglove and Lichtblick; 0: any free one.
    pub foxglove: Option<u16>,
    /// Pages may not write.
    pub view_only: bool,
    /// Name of the instance.
    pub instance: String,
    /// A recording is played: no one moves its tools.
    pub played: bool,
    /// Where others than this machine and holders of identities may come in.
    pub open: Vec<String>,
}

/// Why a page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The address.
    #[error("the page cannot be served at {address}: {source}; choose another with {option}")]
    Listen {
        /// The option that has it.
        option: &'static str,
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
    page: Option<Server>,
    foxglove: Option<Server>,
}

impl Viewer {
    /// Listens for pages of a scene, which are let in by [`Viewer::open`]. What pages do goes through `session`, the daemon's own. `others`:
    /// routes beside those of the page.
    ///
    /// # Errors
    /// An address is taken, or the system refused a thread or randomness.
    pub fn start(
        settings: &ViewerSettings,
        scene: &Arc<Scene>,
        session: &zenoh::Session,
        others: Router,
    ) -> Result<(Self, Feed), ViewerError> {
        let system = |error: &dyn std::fmt::Display| ViewerError::System(error.to_string());
        let page = (settings.address)
            .map(|address| listen(address, "--http"))
            .transpose()?;
        let foxglove = settings.foxglove.map(|port| {
            let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
            listen(address, "--foxglove")
        });
        let foxglove = foxglove.transpose()?;
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
            scene.clone(),
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
            scene: Arc::new(Mutex::new(scene.clone())),
            outlines: Arc::new(Mutex::new(tool_outlines(scene))),
        };
        let info = SessionInfo {
            open: settings.open.clone(),
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
        let id = make_token().map_err(|e| system(&e))?;
        let views = Foxglove::new(board.clone(), feed.scene.clone(), &settings.instance, &id);
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
        let scene_now = feed.scene.clone();
        let inside = move || {
            let scene = scene_now
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone();
            let json = [(axum::http::header::CONTENT_TYPE, "application/json")];
            // Aside: megabytes of a large body.
            let text = tokio::task::spawn_blocking(move || bodies_inside(&scene));
            async move { (json, text.await.unwrap_or_default()) }
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
            .route("/inside.json", get(inside))
            .merge(health::routes(feed.health.clone()))
            .merge(files::files())
            .route("/foxglove", get(foxglove::open).with_state(views.clone()))
            .merge(others);
        let hosts = Hosts {
            names: settings.hosts.clone().into(),
            origins: settings.origins.clone().into(),
            for_others: false,
        };
        let for_others = Hosts {
            for_others: true,
            ..hosts.clone()
        };
        let only_views = Router::new()
            .route("/", get(foxglove::open))
            .route("/foxglove", get(foxglove::open))
            .with_state(views);
        let serve = |listener: Option<TcpListener>, routes, hosts| {
            let started = listener.map(|listener| Server::start(listener, routes, hosts));
            started.transpose().map_err(|e| system(&e))
        };
        let viewer = Self {
            page: serve(page, routes, hosts)?,
            foxglove: serve(foxglove, only_views, for_others)?,
        };
        Ok((viewer, feed))
    }

    /// Lets pages in. Before, they wait: the bus may not be there yet, and would not hear their commands.
    pub fn open(&mut self) {
        let servers = [&mut self.page, &mut self.foxglove];
        servers.into_iter().flatten().for_each(Server::open);
    }

    /// Where the page is.
    pub fn url(&self) -> Option<String> {
        self.page.as_ref().map(Server::url)
    }

    /// Where Foxglove and Lichtblick connect, if they have a port of their own.
    pub fn foxglove_url(&self) -> Option<String> {
        let server = self.foxglove.as_ref()?;
        Some(format!("ws://{}", server.address()))
    }
}

fn listen(address: SocketAddr, option: &'static str) -> Result<TcpListener, ViewerError> {
    TcpListener::bind(address).map_err(|source| ViewerError::Listen {
        option,
        address,
        source,
    })
}

/// 128 random bits as text: other sites cannot read it, and no one guesses it.
pub(crate) fn make_token() -> Result<String, getrandom::Error> {
    let mut bits = [0; 16];
    getrandom::fill(&mut bits)?;
    Ok(bits.iter().map(|byte| format!("{byte:02x}")).collect())
}
