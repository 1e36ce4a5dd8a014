//! The server: its thread, and what every router has.

use crate::guard::{self, Hosts};
use crate::gzip;
use crate::listener::accept;
use axum::Router;
use axum::middleware::from_fn_with_state;
use std::net::SocketAddr;
use tokio::sync::oneshot;

/// Threads for what takes time: files, compressing. The loop needs the other cores.
const ASIDE: usize = 2;

/// A server in a thread of its own; it ends when dropped.
pub struct Server {
    address: SocketAddr,
    /// Until it is open.
    begin: Option<oneshot::Sender<()>>,
    _stop: oneshot::Sender<()>,
}

impl Server {
    /// Listens, and serves `routes` once it is opened: who connects before waits.
    ///
    /// # Errors
    /// The system refused a thread or the address.
    pub fn start(
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

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Lets those in who connect.
    pub fn open(&mut self) {
        if let Some(begin) = self.begin.take() {
            let _ = begin.send(());
        }
    }

    /// Where the page is.
    pub fn url(&self) -> String {
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
