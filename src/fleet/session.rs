//! Sessions of a lobby, and what is asked about them.

use std::time::Duration;
use tokio::sync::oneshot;

/// How far a session has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SessionState {
    /// Its daemon builds the scene.
    Starting,
    /// Clients can connect.
    Ready,
    /// Its daemon was asked to end.
    Ending,
}

/// A daemon as clients see it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Session {
    /// Under which it is ended; also the name of the instance.
    pub id: String,
    /// Name of the offer.
    pub scene: String,
    /// How far it has come.
    pub state: SessionState,
    /// Where devices connect; with this and `instance` a client has all that it needs.
    pub endpoint: Option<String>,
    /// Name of the instance.
    pub instance: String,
    /// Address of its page.
    pub page: Option<String>,
    /// Process id of the daemon.
    pub pid: u32,
    /// Since it was asked for, s.
    pub age_s: f64,
}

/// Why there is no new session.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Nothing of this name is offered.
    #[error("{name:?} is not a scene of this lobby; it has {}", scenes.join(", "))]
    Unknown {
        /// As asked for.
        name: String,
        /// Names on offer.
        scenes: Vec<String>,
    },
    /// All places are taken.
    #[error(
        "no place is free in this lobby (--max {max}): try again when a session has ended, or start it with a larger --max \
         if the machine has idle cores"
    )]
    Full {
        /// Sessions at most.
        max: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// The daemon ended before it was ready.
    #[error("the daemon did not start: {0}")]
    Failed(String),
    /// The daemon was not ready in time.
    #[error("the daemon was not ready within {} s, and was ended", .0.as_secs())]
    Slow(Duration),
    /// The lobby ends.
    #[error("the lobby is going down")]
    Closing,
}

/// What the keeper is asked and what is reported to it.
pub(super) enum Ask {
    Start {
        scene: String,
        reply: oneshot::Sender<Result<Session, Refusal>>,
    },
    List(oneshot::Sender<Vec<Session>>),
    End {
        id: String,
        /// True once it has ended; false if there is none of this id.
        reply: oneshot::Sender<bool>,
    },
    /// The first line of a daemon.
    Said {
        id: String,
        line: serde_json::Value,
    },
    /// A daemon says no more.
    Closed(String),
}
