//! The HTTP server: its thread, the page's files, and what every router has.

use super::guard::{self, Hosts};
use super::gzip;
use super::listener::accept;
use axum::Router;
use axum::http::header;
use axum::middleware::from_fn_with_state;
use axum::response::IntoResponse;
use axum::routing::get;
use std::borrow::Cow;
use std::net::SocketAddr;
use tokio::sync::oneshot;

/// Threads for what takes time: files, compressing. The loop needs the other cores.
const ASIDE: usize = 2;

/// The bundle that `clients/web` makes.
const PAGE: &str = include_str!("page/index.html");
const SCRIPT: &str = include_str!("page/app.js");
const STYLE: &str = include_str!("page/app.css");

/// Page, style and script, in this order.
pub(super) fn bundle() -> [&'static str; 3] {
    [PAGE, STYLE, SCRIPT]
}

/// A server in a thread of its own; it ends when dropped.
pub(crate) struct Server {
    pub(super) address: SocketAddr,
    /// Until it is open.
    begin: Option<oneshot::Sender<()>>,
    _stop: oneshot::Sender<()>,
}

impl Server {
    /// Listens, and serves `routes` once it is opened: who connects before waits.
    pub(crate) fn start(
        listener: std::net::TcpListener,
        routes: Router,
        hosts: Hosts,
    ) -> std::io::Result<Self> {
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(ASIDE)
            .build()?;
        let app = routes
            .layer(from_fn_with_state(gzip::Kept::default(), gzip::texts))
            .layer(from_fn_with_state(hosts, guard::check));
        let (stop, stopped) = oneshot::channel::<()>();
        let (begin, begun) = oneshot::channel::<()>();
        std::thread::Builder::new()
            .name("palpate-viewer".into())
            .spawn(move || {
                runtime.block_on(async move {
                    match tokio::net::TcpListener::from_std(listener) {
                        // Open sockets do not keep the daemon: the runtime ends when it is asked to.
                        Ok(listener) => {
                            let serve = async {
                                if begun.await.is_ok() {
                                    accept(listener, app).await;
                                }
                            };
                            tokio::select! {
                                () = serve => {}
                                _ = stopped => {}
                            }
                        }
                        Err(error) => tracing::warn!(%error, "viewer"),
                    }
                });
            })?;
        Ok(Self {
            address,
            begin: Some(begin),
            _stop: stop,
        })
    }

    /// Lets those in who connect.
    pub(crate) fn open(&mut self) {
        if let Some(begin) = self.begin.take() {
            let _ = begin.send(());
        }
    }

    /// Where the page is.
    pub(crate) fn url(&self) -> String {
        let mut address = self.address;
        // What listens everywhere is opened here.
        if address.ip().is_unspecified() {
            address.set_ip(match address {
                SocketAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
                SocketAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
            });
        }
        format!("http://{address}/")
    }
}

/// The page's files.
pub(super) fn files() -> Router {
    let file = |kind: &'static str, name: &'static str, built_in: &'static str| {
        get(move || {
            let text = from_disk(name).map_or(Cow::Borrowed(built_in), Cow::Owned);
            std::future::ready(([(header::CONTENT_TYPE, kind)], text).into_response())
        })
    };
    Router::new()
        .route("/", file("text/html; charset=utf-8", "index.html", PAGE))
        .route(
            "/app.js",
            file("text/javascript; charset=utf-8", "app.js", SCRIPT),
        )
        .route(
            "/app.css",
            file("text/css; charset=utf-8", "app.css", STYLE),
        )
}

/// For those who work on the page: a bundle that is newer than this program.
fn from_disk(name: &str) -> Option<String> {
    let directory = cfg!(debug_assertions).then(|| std::env::var_os("PALPATE_PAGE_DIR"))??;
    std::fs::read_to_string(std::path::Path::new(&directory).join(name)).ok()
}
