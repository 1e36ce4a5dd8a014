//! For machines: `/metrics`, `/healthz`, `/readyz`.

use crate::transport::LoopMetrics;
use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use palpate_proto::messages::LoopState;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The newest figures, and when they came.
#[derive(Debug, Default)]
pub(super) struct Newest(pub(super) Mutex<Option<(Instant, LoopMetrics)>>);

/// LoopMetrics come ten times a second: after this long without, the bus stands still.
const SILENCE: Duration = Duration::from_secs(2);
const OPENMETRICS: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

impl Newest {
    fn get(&self) -> Option<(Instant, LoopMetrics)> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Why nobody should be sent here, if so.
    fn not_ready(&self) -> Option<&'static str> {
        match self.get() {
            None => Some("no status yet"),
            Some((at, _)) if at.elapsed() > SILENCE => Some("no status for two seconds"),
            Some((_, figures)) if figures.status.state == LoopState::Stopping => Some("stopping"),
            Some((_, figures)) if figures.rate_lost => {
                Some("the loop does not keep its rate: forces fade")
            }
            Some(_) => None,
        }
    }
}

pub(super) fn routes(newest: Arc<Newest>) -> Router {
    Router::new()
        .route("/metrics", get(metrics))
        .route("/healthz", get(|| async { "ok\n" }))
        .route("/readyz", get(ready))
        .with_state(newest)
}

async fn metrics(State(newest): State<Arc<Newest>>) -> Response {
    match newest.get() {
        Some((_, figures)) => {
            ([(header::CONTENT_TYPE, OPENMETRICS)], figures.text()).into_response()
        }
        None => (StatusCode::SERVICE_UNAVAILABLE, "no status yet\n").into_response(),
    }
}

async fn ready(State(newest): State<Arc<Newest>>) -> Response {
    match newest.not_ready() {
        None => "ready\n".into_response(),
        Some(reason) => (StatusCode::SERVICE_UNAVAILABLE, format!("{reason}\n")).into_response(),
    }
}
