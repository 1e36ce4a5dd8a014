//! Requests to the SDK server of Agones, which runs beside the daemon in its pod.
//!
//! One connection a request, bounded in time and size: a sidecar that starts late, hangs or babbles costs
//! a try and nothing else.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use hyper_util::rt::TokioIo;
use std::time::Duration;
use tokio::net::TcpStream;

/// A request takes no longer, from connecting to the last byte.
const LONGEST: Duration = Duration::from_secs(1);
/// Most bytes of an answer; a game server's description has some thousand.
const LONGEST_ANSWER: usize = 256 << 10;

/// Why a request came to nothing.
#[derive(Debug, thiserror::Error)]
pub(super) enum SidecarError {
    /// No one listens, or the connection was cut.
    #[error("{0}")]
    Connection(#[from] std::io::Error),
    /// No answer of HTTP.
    #[error("{0}")]
    Http(#[from] hyper::Error),
    /// An answer that is too long or was cut.
    #[error("its answer: {0}")]
    Answer(axum::Error),
    /// It did not do what it was asked.
    #[error("it answered {0}")]
    Refused(StatusCode),
    /// It does not answer.
    #[error("no answer within {} s", LONGEST.as_secs())]
    Silent,
}

/// Where it listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sidecar {
    pub(super) port: u16,
}

impl Sidecar {
    /// Sends an empty message, which is how the SDK's calls are made.
    pub(super) async fn call(self, path: &str) -> Result<(), SidecarError> {
        self.ask(Method::POST, path, "{}").await.map(drop)
    }

    /// Asks for a document.
    pub(super) async fn get(self, path: &str) -> Result<serde_json::Value, SidecarError> {
        let bytes = self.ask(Method::GET, path, "").await?;
        // What is no JSON says nothing.
        Ok(serde_json::from_slice(&bytes).unwrap_or_default())
    }

    async fn ask(
        self,
        method: Method,
        path: &str,
        body: &'static str,
    ) -> Result<axum::body::Bytes, SidecarError> {
        let asked = tokio::time::timeout(LONGEST, self.exchange(method, path, body));
        asked.await.unwrap_or(Err(SidecarError::Silent))
    }

    async fn exchange(
        self,
        method: Method,
        path: &str,
        body: &'static str,
    ) -> Result<axum::body::Bytes, SidecarError> {
        let stream = TcpStream::connect(("localhost", self.port)).await?;
        let (mut sender, connection) =
            hyper::client::conn::http1::handshake(TokioIo::new(stream)).await?;
        let mut request = Request::new(Body::from(body));
        *request.method_mut() = method;
        // Paths are our own constants.
        *request.uri_mut() = path.parse().unwrap_or_default();
        let headers = request.headers_mut();
        let host = format!("localhost:{}", self.port);
        if let Ok(host) = host.parse() {
            headers.insert(header::HOST, host);
        }
        let json = header::HeaderValue::from_static("application/json");
        headers.insert(header::CONTENT_TYPE, json);
        // Dropped with the request, also where that takes too long.
        let exchange = async {
            let response = sender.send_request(request).await?;
            let status = response.status();
            let body = axum::body::to_bytes(Body::new(response.into_body()), LONGEST_ANSWER);
            let body = body.await.map_err(SidecarError::Answer)?;
            match status.is_success() {
                true => Ok(body),
                false => Err(SidecarError::Refused(status)),
            }
        };
        tokio::pin!(exchange, connection);
        // The connection does the reading and writing; its own end without an answer is an error.
        tokio::select! {
            done = &mut exchange => done,
            ended = &mut connection => {
                ended?;
                exchange.await
            }
        }
    }
}
