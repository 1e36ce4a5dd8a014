//! What the bus and a player of recordings say to each other, without knowing each other.

use std::sync::mpsc::{Receiver, Sender, channel};

/// What a client may ask of a player.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlayRequest {
    /// Stand still.
    Pause,
    /// Go on.
    Resume,
    /// One or the other.
    Toggle,
    /// While standing still: play this many ticks.
    Step(u32),
    /// Go on from the state after this tick.
    Seek(u64),
    /// Simulated over real time.
    Rate(f64),
    /// So many times as fast as now.
    Scale(f64),
    /// Back to the last known state before this one.
    Back,
    /// Back to the start.
    Reset,
    /// End.
    Stop,
}

/// What a player has to tell.
#[derive(Clone, Debug, PartialEq)]
pub enum PlayNews {
    /// A request was carried out.
    Done {
        /// Number of the request.
        id: u64,
        /// Newest tick after it.
        tick: u64,
    },
    /// A request was refused.
    Refused {
        /// Number of the request.
        id: u64,
        /// Why.
        reason: String,
    },
    /// It stands still from now on (true), or goes on.
    Paused(bool),
    /// It is back at its start.
    Reset,
}

/// The bus's end: requests go out, news come in. Whoever drops the other end refuses all.
#[derive(Debug)]
pub struct PlayerEnd {
    /// Requests with their numbers.
    pub requests: Sender<(u64, PlayRequest)>,
    /// News.
    pub news: Receiver<PlayNews>,
}

/// The player's end.
#[derive(Debug)]
pub struct PlayPort {
    /// Requests with their numbers.
    pub requests: Receiver<(u64, PlayRequest)>,
    /// News.
    pub news: Sender<PlayNews>,
}

/// Both ends, and one more way in for requests that no one waits for (number 0).
pub fn playback() -> (PlayerEnd, PlayPort, Sender<(u64, PlayRequest)>) {
    let (request_in, request_out) = channel();
    let (news_in, news_out) = channel();
    let own = request_in.clone();
    (
        PlayerEnd {
            requests: request_in,
            news: news_out,
        },
        PlayPort {
            requests: request_out,
            news: news_in,
        },
        own,
    )
}
