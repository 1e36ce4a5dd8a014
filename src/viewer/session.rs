//! `/session.json`: what a page gets before it opens the socket.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

/// A recording that the page may read.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ListedRecording {
    pub(super) name: String,
    pub(super) url: String,
    pub(super) bytes: u64,
    /// The shapes of its tools.
    pub(super) tools_url: String,
    /// The cells of its bodies.
    pub(super) inside_url: String,
    /// Its scene before the first tick, as `SceneSnapshot`.
    pub(super) scene_url: String,
    /// It is shown beside the one before it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(super) against: bool,
}

/// What is served here.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SessionInfo {
    /// `live` or `view`.
    pub(super) mode: &'static str,
    pub(super) instance: String,
    pub(super) version: &'static str,
    /// Lets a page write.
    pub(super) token: Option<String>,
    pub(super) recordings: Vec<ListedRecording>,
    /// On the bus, by name.
    pub(super) instances: Vec<String>,
    /// Pages of other instances, by name.
    pub(super) pages: std::collections::BTreeMap<String, String>,
    /// A recording is played: its tools cannot be held.
    pub(super) played: bool,
    /// Ticks wait for poses.
    pub(super) lockstep: bool,
    /// Where others than this machine and holders of identities may come in.
    pub(super) open: Vec<String>,
}

/// JSON that no one keeps.
pub(super) fn json(value: &impl Serialize) -> Response {
    let text = serde_json::to_string(value).unwrap_or_default();
    let headers = [
        (header::CONTENT_TYPE, "application/json"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    (headers, text).into_response()
}
