//! The page's WebSocket: what is new on the board out, orders in.

use super::board::Board;
use super::frames::{MOST_BYTES, refused_frame, split, take_text, take_varint};
use super::hands::{FromPage, Order};
use super::holders::Socket;
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError};
use std::time::Duration;
use tokio::sync::mpsc;

/// Pages at once.
const MOST_PAGES: usize = 16;
/// Answers and refusals that wait for a page; more are dropped.
const MAIL: usize = 64;
/// A page that says nothing is asked this often whether it is there.
pub(super) const PING: Duration = Duration::from_secs(20);
/// And is given up after this long without a word: it may hold a tool.
pub(super) const SILENCE: Duration = Duration::from_secs(60);
/// Between two looks for room in the queue of orders.
const NAP: Duration = Duration::from_millis(1);

/// What a socket needs.
#[derive(Clone)]
pub(super) struct Live {
    pub(super) board: Arc<Board>,
    pub(super) orders: SyncSender<FromPage>,
    /// What a page sends before it may write; `None`: none may.
    pub(super) token: Option<Arc<str>>,
    pub(super) next: Arc<AtomicU64>,
}

/// `GET /live`.
pub(super) async fn open(State(live): State<Live>, upgrade: WebSocketUpgrade) -> Response {
    if !live.board.enter(MOST_PAGES) {
        let words = format!("{MOST_PAGES} pages are open: close one first\n");
        return (StatusCode::SERVICE_UNAVAILABLE, words).into_response();
    }
    let entered = Entered(live.board.clone());
    upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_upgrade(move |socket| async move {
            let _entered = entered;
            serve(socket, live).await;
        })
}

/// Counted among those who watch.
pub(super) struct Entered(Arc<Board>);

impl Entered {
    /// Counts one more, who is not a page.
    pub(super) fn one_more(board: &Arc<Board>) -> Self {
        board.enter(usize::MAX);
        Self(board.clone())
    }
}

impl Drop for Entered {
    fn drop(&mut self) {
        self.0.leave();
    }
}

async fn serve(socket: WebSocket, live: Live) {
    let number = live.next.fetch_add(1, Ordering::Relaxed);
    let (out, back) = socket.split();
    let (outbox, mail) = mpsc::channel(MAIL);
    let page = Page {
        number,
        board: live.board.clone(),
        inside: false,
        orders: live.orders.clone(),
        outbox: outbox.clone(),
        token: live.token,
        may_write: false,
    };
    tokio::select! {
        () = show(out, mail, &live.board) => {}
        () = listen(back, page) => {}
    }
    let gone = FromPage {
        socket: number,
        order: Order::Gone,
        outbox,
    };
    pass_on(&live.orders, gone).await;
}

/// Sends what is new until the page is gone. While the page does not read, only this waits.
async fn show(
    mut out: SplitSink<WebSocket, Message>,
    mut mail: mpsc::Receiver<Bytes>,
    board: &Board,
) {
    let mut changes = board.changes();
    let mut seen = 0;
    let mut ping = tokio::time::interval(PING);
    loop {
        let last = tokio::select! {
            changed = changes.changed() => match changed {
                Ok(()) => None,
                Err(_) => return,
            },
            letter = mail.recv() => match letter {
                Some(frame) => Some(Message::Binary(frame)),
                None => return,
            },
            _ = ping.tick() => Some(Message::Ping(Bytes::new())),
        };
        // What an answer speaks of was posted before it, and comes before it.
        let news = board.news(&mut seen).into_iter().map(Message::Binary);
        for message in news.chain(last) {
            if out.feed(message).await.is_err() {
                return;
            }
        }
        // Once for all: sixty-four tools have two messages each.
        if out.flush().await.is_err() {
            return;
        }
    }
}

/// Takes what the page says until it is gone, or says what no page says.
async fn listen(mut back: SplitStream<WebSocket>, mut page: Page) {
    loop {
        match tokio::time::timeout(SILENCE, back.next()).await {
            Ok(Some(Ok(Message::Binary(frame)))) => {
                if !page.take(&frame).await {
                    return;
                }
            }
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => {}
            // Also a frame that is too long.
            Ok(Some(Ok(Message::Text(_) | Message::Close(_)) | Err(_)) | None) | Err(_) => return,
        }
    }
}

/// The one at the other end.
struct Page {
    number: Socket,
    board: Arc<Board>,
    /// It looks inside bodies.
    inside: bool,
    orders: SyncSender<FromPage>,
    outbox: mpsc::Sender<Bytes>,
    token: Option<Arc<str>>,
    may_write: bool,
}

impl Page {
    /// Takes a frame; false if it is not one.
    async fn take(&mut self, frame: &[u8]) -> bool {
        let Some((key, payload)) = split(frame) else {
            return false;
        };
        if key == "token" {
            let given = take_text(payload).map(|(token, _)| token);
            self.may_write = given.is_some() && given == self.token.as_deref();
            if !self.may_write {
                self.refuse(key, self.why_not());
            }
            return true;
        }
        if key == "inside" {
            // Looking is not writing.
            self.look_inside(payload == [1]);
            return true;
        }
        if !self.may_write {
            self.refuse(key, self.why_not());
            return true;
        }
        match order(key, payload) {
            Ok(order) => {
                let from_page = FromPage {
                    socket: self.number,
                    order,
                    outbox: self.outbox.clone(),
                };
                pass_on(&self.orders, from_page).await
            }
            Err(reason) => {
                self.refuse(key, reason);
                true
            }
        }
    }

    fn look_inside(&mut self, on: bool) {
        if std::mem::replace(&mut self.inside, on) != on {
            self.board.look_inside(on);
        }
    }

    fn why_not(&self) -> &'static str {
        match self.token {
            None => "this page is for viewing only (--http-view-only)",
            Some(_) => "the page must send the token of /session.json first",
        }
    }

    fn refuse(&self, key: &str, reason: &str) {
        let _ = self.outbox.try_send(refused_frame(key, reason));
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.look_inside(false);
    }
}

/// The order that a frame is.
fn order(key: &str, payload: &[u8]) -> Result<Order, &'static str> {
    if let Some(method) = key.strip_prefix("rpc/") {
        let (id, rest) = take_varint(payload).ok_or("a command begins with its number")?;
        let (arguments, _) = take_text(rest).ok_or("a command's arguments are a string of JSON")?;
        return Ok(Order::Call {
            method: method.to_owned(),
            id,
            arguments: arguments.as_bytes().to_vec(),
        });
    }
    if key == "speed" {
        let bytes = payload.try_into().map_err(|_| "a speed is an f64")?;
        return Ok(Order::Speed {
            speed: f64::from_le_bytes(bytes),
        });
    }
    let (tool, what) = (key.strip_prefix("tool/"))
        .and_then(|rest| rest.split_once('/'))
        .ok_or("pages do not write this key")?;
    let (tool, payload) = (tool.to_owned(), payload.to_vec());
    match what {
        "device" => Ok(Order::Claim {
            tool,
            device: payload,
        }),
        "pose" => Ok(Order::Pose {
            tool,
            pose: payload,
        }),
        "release" => Ok(Order::Release { tool }),
        _ => Err("pages do not write this key"),
    }
}

/// Hands an order over, when there is room; false if no one takes orders any more.
async fn pass_on(orders: &SyncSender<FromPage>, mut order: FromPage) -> bool {
    loop {
        match orders.try_send(order) {
            Ok(()) => return true,
            Err(TrySendError::Disconnected(_)) => return false,
            Err(TrySendError::Full(again)) => order = again,
        }
        tokio::time::sleep(NAP).await;
    }
}
