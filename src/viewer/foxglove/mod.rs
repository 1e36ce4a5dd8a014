//! Foxglove and Lichtblick, live: the views of recordings as channels of a WebSocket.
//!
//! ```text
//! Board ─▶ Painter (newest nets and forces) ─▶ pictures of the wanted views ─▶ subscriptions
//! ```
//! Each socket draws for itself, at most as often as recordings are drawn, and only what it subscribed
//! to. A socket without subscriptions does not count as watching, so that the bus makes nothing for it.
//! Viewers cannot write.
//!
//! The `foxglove` crate speaks the same protocol, with a server of its own on a port of its own and 60
//! more packages; here it is a route of the page's server, under the page's rules for `Host` and
//! `Origin`.

mod painter;
mod protocol;

use super::board::Board;
use super::frames::MOST_BYTES;
use super::socket::{Entered, PING, SILENCE};
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use painter::Painter;
use palpate_record::{LOG_VIEW, wall_ns};
use palpate_sim::scene::Scene;
use protocol::{PROTOCOLS, Request};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{Semaphore, mpsc};
use tokio::time::{Interval, MissedTickBehavior};

/// Viewers at once.
const MOST_VIEWERS: usize = 8;
/// Requests of a viewer that wait.
const REQUESTS: usize = 64;
/// Subscriptions of a viewer; more are refused.
const MOST_SUBSCRIPTIONS: usize = 1024;

/// What a viewer's socket needs.
#[derive(Clone)]
pub(super) struct Foxglove {
    board: Arc<Board>,
    /// The scene that runs.
    scene: Arc<Mutex<Arc<Scene>>>,
    instance: Arc<str>,
    /// Tells viewers that reconnect whether it is the same server.
    session: Arc<str>,
    room: Arc<Semaphore>,
}

impl Foxglove {
    pub(super) fn new(
        board: Arc<Board>,
        scene: Arc<Mutex<Arc<Scene>>>,
        instance: &str,
        session: &str,
    ) -> Self {
        Self {
            board,
            scene,
            instance: instance.into(),
            session: session.into(),
            room: Arc::new(Semaphore::new(MOST_VIEWERS)),
        }
    }

    fn scene(&self) -> Arc<Scene> {
        let scene = self.scene.lock().unwrap_or_else(PoisonError::into_inner);
        scene.clone()
    }
}

/// `GET /foxglove`.
pub(super) async fn open(State(foxglove): State<Foxglove>, upgrade: WebSocketUpgrade) -> Response {
    let upgrade = upgrade.protocols(PROTOCOLS);
    if upgrade.selected_protocol().is_none() {
        let words = format!("the subprotocol is one of {}\n", PROTOCOLS.join(", "));
        return (StatusCode::BAD_REQUEST, words).into_response();
    }
    let Ok(place) = foxglove.room.clone().try_acquire_owned() else {
        let words = format!("{MOST_VIEWERS} viewers are connected: close one first\n");
        return (StatusCode::SERVICE_UNAVAILABLE, words).into_response();
    };
    upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_upgrade(move |socket| async move {
            let _place = place;
            serve(socket, foxglove).await;
        })
}

async fn serve(socket: WebSocket, foxglove: Foxglove) {
    let (out, back) = socket.split();
    let (asking, asked) = mpsc::channel(REQUESTS);
    let viewer = Viewer {
        painter: Painter::new(foxglove.scene()),
        foxglove,
        first: 1,
        subscriptions: BTreeMap::new(),
        watching: None,
        seen: 0,
        outbox: Vec::new(),
    };
    tokio::select! {
        () = viewer.show(out, asked) => {}
        () = listen(back, asking) => {}
    }
}

/// Takes what a viewer asks for until it is gone.
async fn listen(mut back: SplitStream<WebSocket>, asking: mpsc::Sender<Result<Request, String>>) {
    loop {
        let request = match tokio::time::timeout(SILENCE, back.next()).await {
            Ok(Some(Ok(Message::Text(text)))) => {
                serde_json::from_str(&text).map_err(|error| format!("not a request: {error}"))
            }
            Ok(Some(Ok(Message::Binary(_)))) => Err("viewers cannot write here".to_owned()),
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => continue,
            Ok(Some(Ok(Message::Close(_)) | Err(_)) | None) | Err(_) => return,
        };
        if asking.send(request).await.is_err() {
            return;
        }
    }
}

/// The one at the other end.
struct Viewer {
    foxglove: Foxglove,
    painter: Painter,
    /// Id of the channel of view 0.
    first: u32,
    /// By the viewer's number: the view.
    subscriptions: BTreeMap<u32, usize>,
    /// While there are subscriptions.
    watching: Option<Entered>,
    /// What of the board was taken.
    seen: u64,
    outbox: Vec<Message>,
}

impl Viewer {
    /// Sends what is new until the viewer is gone. While it does not read, only this waits.
    async fn show(
        mut self,
        mut out: SplitSink<WebSocket, Message>,
        mut asked: mpsc::Receiver<Result<Request, String>>,
    ) {
        let Foxglove {
            instance, session, ..
        } = &self.foxglove;
        let info = protocol::server_info(instance, session);
        self.outbox.push(Message::text(info));
        self.advertise();
        let board = self.foxglove.board.clone();
        let mut changes = board.changes();
        let mut ping = tokio::time::interval(PING);
        let mut frames = self.frames();
        loop {
            if self.send(&mut out).await.is_err() {
                return;
            }
            tokio::select! {
                request = asked.recv() => match request {
                    Some(Ok(request)) => self.take(request),
                    Some(Err(why)) => self.outbox.push(Message::text(protocol::warning(&why))),
                    None => return,
                },
                changed = changes.changed(), if self.watching.is_some() => match changed {
                    Ok(()) => if self.absorb() {
                        frames = self.frames();
                    },
                    Err(_) => return,
                },
                _ = frames.tick(), if self.watching.is_some() => self.paint(),
                _ = ping.tick() => self.outbox.push(Message::Ping(Bytes::new())),
            }
        }
    }

    async fn send(&mut self, out: &mut SplitSink<WebSocket, Message>) -> Result<(), axum::Error> {
        if self.outbox.is_empty() {
            return Ok(());
        }
        for message in self.outbox.drain(..) {
            out.feed(message).await?;
        }
        out.flush().await
    }

    fn frames(&self) -> Interval {
        let period = Duration::from_secs_f64(1.0 / self.painter.rate_hz());
        let mut frames = tokio::time::interval(period);
        frames.set_missed_tick_behavior(MissedTickBehavior::Delay);
        frames
    }

    fn advertise(&mut self) {
        let channels = protocol::advertise(self.first, &self.painter.topics());
        self.outbox.push(Message::text(channels));
    }

    fn take(&mut self, request: Request) {
        let views = self.painter.topics().len();
        match request {
            Request::Subscribe { subscriptions } => {
                let mut log = false;
                for wanted in subscriptions {
                    let view = wanted.channel_id.checked_sub(self.first);
                    let view = view.map(|view| view as usize).filter(|view| *view < views);
                    let full = self.subscriptions.len() >= MOST_SUBSCRIPTIONS;
                    let Some(view) = view.filter(|_| !full) else {
                        let why = match full {
                            true => format!("there are {MOST_SUBSCRIPTIONS} subscriptions already"),
                            false => format!("there is no channel {}", wanted.channel_id),
                        };
                        self.outbox.push(Message::text(protocol::warning(&why)));
                        continue;
                    };
                    log |= view == LOG_VIEW;
                    self.subscriptions.insert(wanted.id, view);
                }
                if !self.subscriptions.is_empty() {
                    // All that is shown, anew.
                    self.painter.start_again(log);
                    self.seen = 0;
                    let board = &self.foxglove.board;
                    self.watching = Some(Entered::one_more(board));
                    self.absorb();
                }
            }
            Request::Unsubscribe { subscription_ids } => {
                for id in subscription_ids {
                    self.subscriptions.remove(&id);
                }
                if self.subscriptions.is_empty() {
                    self.watching = None;
                }
            }
            Request::Other => {
                let why = "this server shows channels and nothing else";
                self.outbox.push(Message::text(protocol::warning(why)));
            }
        }
    }

    /// Takes what is new on the board; true if the scene is another one now.
    fn absorb(&mut self) -> bool {
        let news = self.foxglove.board.news(&mut self.seen);
        let scene = self.foxglove.scene();
        let other = !self.painter.draws(&scene);
        if other {
            self.begin_scene(scene);
        }
        for frame in news {
            let Self {
                painter,
                subscriptions,
                outbox,
                ..
            } = self;
            painter.absorb(&frame, &mut |view, time_ns, payload| {
                post(subscriptions, outbox, view, time_ns, payload);
            });
        }
        other
    }

    /// Goes on with another scene. With other bodies there are other channels, and what was subscribed
    /// to is gone.
    fn begin_scene(&mut self, scene: Arc<Scene>) {
        let before = self.painter.topics();
        self.painter = self.painter.for_scene(scene);
        if self.painter.topics() == before {
            return;
        }
        let gone = self.first..self.first + before.len() as u32;
        self.first = gone.end;
        self.outbox.push(Message::text(protocol::unadvertise(gone)));
        self.subscriptions.clear();
        self.watching = None;
        self.advertise();
    }

    fn paint(&mut self) {
        let Self {
            painter,
            subscriptions,
            outbox,
            ..
        } = self;
        let wanted = |view| subscriptions.values().any(|of| *of == view);
        painter.paint(wall_ns(), wanted, &mut |view, time_ns, payload| {
            post(subscriptions, outbox, view, time_ns, payload);
        });
    }
}

fn post(
    subscriptions: &BTreeMap<u32, usize>,
    outbox: &mut Vec<Message>,
    view: usize,
    time_ns: u64,
    payload: &[u8],
) {
    for (id, _) in subscriptions.iter().filter(|(_, of)| **of == view) {
        let data = protocol::message_data(*id, time_ns, payload);
        outbox.push(Message::Binary(data.into()));
    }
}
