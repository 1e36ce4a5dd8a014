//! Connections over HTTP, each with its place at the door.
//!
//! ```text
//! accept ─▶ Connection (bytes: has a request begun, is what is sent taken?) ─▶ hyper ─▶ serve (whole requests) ─▶ routes
//! ```
//! What needs time, such as compressing, is done aside: one thread serves all connections, also those that ask for
//! health.

use crate::door::{Door, Limits, Peer, Place};
use axum::body::{Body, HttpBody};
use axum::extract::ConnectInfo;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Error, Router};
use hyper::body::{Bytes, Frame, Incoming, SizeHint};
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use socket2::SockRef;
use std::convert::Infallible;
use std::io::{self, IoSlice};
use std::net::{Shutdown, SocketAddr};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};

/// A browser keeps some six connections for each page. One machine leaves a quarter of the places to others.
const LIMITS: Limits = Limits {
    waiting: 64,
    served: 128,
    of_one: 96,
    urgent: 16,
    idle: Some(Duration::from_secs(15)),
};
/// For machines that decide whether this one lives, and gets more clients.
const URGENT: [&str; 3] = ["/healthz", "/readyz", "/metrics"];
/// How often the door looks for those whose time is over.
const SWEEP: Duration = Duration::from_millis(250);
/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 32 << 10;
/// A connection whose bytes are there already lets others have their turn after so many.
const TURN: usize = 4 << 10;
/// What the system keeps of what a client has not taken, bytes. Linux would keep megabytes, of which it is not seen
/// whether they move, and a page would get forces that are seconds old.
const SENT_AHEAD: usize = 256 << 10;
/// Bytes that are read of a client while it takes nothing of what it is sent. Less than what it must take until the
/// system says that it does: what is answered to these, such as a pong to each ping, cannot pile up.
const HEARD_STALLED: usize = 64 << 10;
/// After an error of the system, such as no descriptor.
const NAP: Duration = Duration::from_millis(100);

/// Serves connections as they come.
pub(crate) async fn accept(listener: TcpListener, app: Router) {
    accept_within(LIMITS, listener, app).await;
}

async fn accept_within(limits: Limits, listener: TcpListener, app: Router) {
    let door = Door::new(limits);
    let mut sweep = tokio::time::interval(SWEEP);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = sweep.tick() => {
                door.sweep(Instant::now());
                continue;
            }
        };
        let Ok((stream, address)) = accepted else {
            tokio::time::sleep(NAP).await;
            continue;
        };
        if let Some(connection) = Connection::new(stream, address, &door) {
            tokio::spawn(attend(connection, address, app.clone()));
        }
        // A request that has come with its connection is read before the next newcomer may need the place.
        tokio::task::yield_now().await;
    }
}

async fn attend(connection: Connection, address: SocketAddr, app: Router) {
    let place = connection.place.clone();
    let app = TowerToHyperService::new(app);
    let service = service_fn(move |mut request: hyper::Request<Incoming>| {
        let (app, place) = (app.clone(), place.clone());
        async move {
            let urgent = URGENT.contains(&request.uri().path());
            if let Err(crowded) = place.serve(urgent) {
                return Ok(refuse(&crowded.to_string()));
            }
            (request.extensions_mut()).insert(ConnectInfo(Peer(address)));
            let response = app.call(request.map(Body::new)).await?;
            Ok::<_, Infallible>(match response.status() {
                // A socket is served until it is closed.
                StatusCode::SWITCHING_PROTOCOLS => response,
                _ => response.map(|body| Body::new(Answer { body, place })),
            })
        }
    });
    let served = http1::Builder::new()
        .max_buf_size(LONGEST_HEAD)
        .serve_connection(TokioIo::new(connection), service)
        .with_upgrades()
        .await;
    if let Err(error) = served {
        tracing::debug!(%error, "a connection of the page");
    }
}

fn refuse(reason: &str) -> Response {
    let mut response = (StatusCode::SERVICE_UNAVAILABLE, format!("{reason}\n")).into_response();
    let headers = response.headers_mut();
    headers.insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
    headers.insert(header::CONNECTION, HeaderValue::from_static("close"));
    response
}

/// The body of an answer; when it is dropped, the answer has been made.
struct Answer {
    body: Body,
    place: Arc<Place>,
}

impl HttpBody for Answer {
    type Data = Bytes;
    type Error = Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

impl Drop for Answer {
    fn drop(&mut self) {
        self.place.answered();
    }
}

/// The bytes of a connection.
struct Connection {
    stream: Arc<TcpStream>,
    place: Arc<Place>,
    /// Read since others had their turn.
    read: usize,
    /// Read since it takes nothing; `None` while it does.
    stalled: Option<usize>,
    /// Who reads, once it takes something again.
    reader: Option<Waker>,
}

impl Connection {
    /// `None` when it is one too many.
    fn new(stream: TcpStream, address: SocketAddr, door: &Arc<Door>) -> Option<Self> {
        // Small frames at once: an arrow should follow a hand.
        let _ = stream.set_nodelay(true);
        let _ = SockRef::from(&stream).set_send_buffer_size(SENT_AHEAD);
        let stream = Arc::new(stream);
        let shut = {
            let stream = stream.clone();
            move || drop(SockRef::from(&*stream).shutdown(Shutdown::Both))
        };
        let place = door.enter(address.ip(), shut)?;
        Some(Self {
            stream,
            place: Arc::new(place),
            read: 0,
            stalled: None,
            reader: None,
        })
    }

    /// Writes what the system takes.
    fn poll_send(
        &mut self,
        context: &mut Context<'_>,
        send: impl Fn(&TcpStream) -> io::Result<usize>,
    ) -> Poll<io::Result<usize>> {
        loop {
            let Poll::Ready(ready) = self.stream.poll_write_ready(context) else {
                self.stalled.get_or_insert(0);
                self.place.stalls(true);
                return Poll::Pending;
            };
            ready?;
            match send(&self.stream) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                sent => {
                    if self.stalled.take().is_some() {
                        self.place.stalls(false);
                    }
                    if let Some(reader) = self.reader.take() {
                        reader.wake();
                    }
                    return Poll::Ready(sent);
                }
            }
        }
    }
}

impl AsyncRead for Connection {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if self.read >= TURN {
            self.read = 0;
            context.waker().wake_by_ref();
            return Poll::Pending;
        }
        if self.stalled.is_some_and(|heard| heard >= HEARD_STALLED) {
            self.reader = Some(context.waker().clone());
            return Poll::Pending;
        }
        loop {
            let Poll::Ready(ready) = self.stream.poll_read_ready(context) else {
                self.read = 0;
                return Poll::Pending;
            };
            ready?;
            let most = buffer.remaining().min(TURN);
            match self.stream.try_read(buffer.initialize_unfilled_to(most)) {
                Ok(count) => {
                    buffer.advance(count);
                    self.read += count;
                    if let Some(heard) = &mut self.stalled {
                        *heard += count;
                    }
                    if count > 0 {
                        self.place.hears();
                    }
                    return Poll::Ready(Ok(()));
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Poll::Ready(Err(error)),
            }
        }
    }
}

impl AsyncWrite for Connection {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.poll_send(context, |stream| stream.try_write(bytes))
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.poll_send(context, |stream| stream.try_write_vectored(slices))
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.place.sent();
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(SockRef::from(&*self.stream).shutdown(Shutdown::Write))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::door::STALL;
    use std::io::{ErrorKind, Read as _};

    // Seen: sockets that say nothing stayed for ever and kept others out.
    #[test]
    fn who_says_nothing_is_closed_and_who_asks_in_time_is_answered() {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .unwrap();
        let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).unwrap();
        let address = listener.local_addr().unwrap();
        assert!(LIMITS.idle.is_some_and(|idle| idle < STALL));
        let limits = Limits {
            idle: Some(Duration::from_millis(500)),
            ..LIMITS
        };
        let app = Router::new().route("/", axum::routing::get(|| async { "here" }));
        runtime.spawn(accept_within(limits, listener, app));
        let silent: Vec<_> = (0..4)
            .map(|_| std::net::TcpStream::connect(address).unwrap())
            .collect();
        let mut asks = std::net::TcpStream::connect(address).unwrap();
        io::Write::write_all(&mut asks, b"GET / HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
        for mut stream in silent.into_iter().chain([asks.try_clone().unwrap()]) {
            stream
                .set_read_timeout(Some(Duration::from_secs(60)))
                .unwrap();
            let mut heard = Vec::new();
            // Closed, perhaps by a reset; not still open after a minute.
            if let Err(error) = stream.read_to_end(&mut heard) {
                assert_eq!(error.kind(), ErrorKind::ConnectionReset, "{error}");
            }
            let asked = stream.local_addr().unwrap() == asks.local_addr().unwrap();
            assert_eq!(heard.ends_with(b"here"), asked);
        }
    }
}
