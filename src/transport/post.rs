//! What may have to wait for a client that does not read goes out on threads of its own. The bus thread,
//! which sends forces and obeys commands, never waits for one.
//!
//! ```text
//! bus thread ─▶ Post ─▶ palpate-nets     nets
//!            ─▶ Post ─▶ palpate-events   events
//!            ─▶ Post ─▶ palpate-answers  answers to the queries of one key, each key its own
//! ```
//! A thread that meets a client that does not read waits until Zenoh closes its transport
//! ([`patience`](super::budget::patience)). Whatever else waits for that client then fails at once.

use super::intake::Place;
use std::cell::RefCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::key_expr::KeyExpr;
use zenoh::pubsub::Publisher;
use zenoh::query::Query;

/// Bytes of answers that may wait on one post.
const MOST_BYTES: usize = 64 << 20;
/// At the end, for what still waits.
const PATIENCE: Duration = Duration::from_secs(2);

/// The newest net of a body on its way out; one that is not sent yet is replaced.
pub(super) struct NetSlot {
    pub(super) publisher: Publisher<'static>,
    newest: Mutex<Option<Vec<u8>>>,
}

impl NetSlot {
    /// Nothing is on its way.
    pub(super) fn new(publisher: Publisher<'static>) -> Arc<Self> {
        Arc::new(Self {
            publisher,
            newest: Mutex::default(),
        })
    }

    fn replace(&self, with: Option<Vec<u8>>) -> Option<Vec<u8>> {
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::replace(&mut newest, with)
    }
}

/// One reply to a query.
struct Reply {
    /// `None`: an error.
    key: Option<KeyExpr<'static>>,
    payload: ZBytes,
    encoding: Encoding,
}

enum Letter {
    /// All replies to a query. Its end, which may wait too, comes with dropping it.
    Answer {
        query: Query,
        replies: Vec<Reply>,
        bytes: usize,
        _place: Place,
    },
    Net(Arc<NetSlot>),
    Put(Arc<Publisher<'static>>, Vec<u8>),
}

/// Where letters are dropped; never waits. A thread sends them, in their order, from the first one on.
#[derive(Clone)]
pub(super) struct Post {
    letters: Sender<Letter>,
    /// Bytes of answers.
    waiting: Arc<AtomicUsize>,
    /// The thread's end, until it has one.
    inbox: Arc<Mutex<Option<Receiver<Letter>>>>,
    name: &'static str,
    threads: PostThreads,
}

/// The threads of all posts that were made with it.
#[derive(Clone, Default)]
pub(super) struct PostThreads(Arc<Mutex<Vec<JoinHandle<()>>>>);

impl Post {
    /// A post whose thread has this name; it ends when every clone of the post is gone.
    pub(super) fn new(name: &'static str, threads: &PostThreads) -> Self {
        let (letters, inbox) = channel();
        Self {
            letters,
            waiting: Arc::default(),
            inbox: Arc::new(Mutex::new(Some(inbox))),
            name,
            threads: threads.clone(),
        }
    }

    fn put_in(&self, letter: Letter) {
        // The thread ends only when no one can be here.
        let _ = self.letters.send(letter);
        let mut inbox = self.inbox.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(letters) = inbox.take() {
            let waiting = self.waiting.clone();
            let started = std::thread::Builder::new()
                .name(self.name.to_owned())
                .spawn(move || send_all(&letters, &waiting));
            match started {
                Ok(thread) => self.threads.lock().push(thread),
                Err(error) => tracing::error!(%error, "no thread could be made for answers"),
            }
        }
    }

    /// Publishes a net, unless a newer one replaces it first.
    pub(super) fn net(&self, slot: &Arc<NetSlot>, bytes: Vec<u8>) {
        if slot.replace(Some(bytes)).is_none() {
            self.put_in(Letter::Net(slot.clone()));
        }
    }

    /// Publishes a message.
    pub(super) fn put(&self, publisher: &Arc<Publisher<'static>>, bytes: Vec<u8>) {
        self.put_in(Letter::Put(publisher.clone(), bytes));
    }
}

impl PostThreads {
    fn lock(&self) -> MutexGuard<'_, Vec<JoinHandle<()>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until all is sent, but not for ever: a client may not read.
    pub(super) fn finish(self) {
        let until = Instant::now() + PATIENCE;
        while !self.lock().iter().all(JoinHandle::is_finished) && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

fn send_all(inbox: &Receiver<Letter>, waiting: &AtomicUsize) {
    while let Ok(letter) = inbox.recv() {
        match letter {
            Letter::Answer {
                query,
                replies,
                bytes,
                _place,
            } => {
                for reply in replies {
                    let (payload, encoding) = (reply.payload, reply.encoding);
                    let _ = match reply.key {
                        Some(key) => query.reply(key, payload).encoding(encoding).wait(),
                        None => query.reply_err(payload).encoding(encoding).wait(),
                    };
                }
                drop(query);
                waiting.fetch_sub(bytes, Ordering::Relaxed);
            }
            Letter::Net(slot) => {
                if let Some(net) = slot.replace(None) {
                    let _ = slot.publisher.put(net).wait();
                }
            }
            Letter::Put(publisher, message) => drop(publisher.put(message).wait()),
        }
    }
}

/// A query, its place in its queryable's share, and the replies made so far. Dropped, it has been
/// answered: the replies are sent.
pub(super) struct Asked {
    query: Query,
    post: Post,
    place: Option<Place>,
    replies: RefCell<Vec<Reply>>,
}

impl Asked {
    pub(super) fn new(query: Query, post: &Post, place: Place) -> Self {
        Self {
            query,
            post: post.clone(),
            place: Some(place),
            replies: RefCell::default(),
        }
    }

    /// Answers under a key.
    pub(super) fn answer(
        &self,
        key: KeyExpr<'static>,
        payload: impl Into<ZBytes>,
        encoding: Encoding,
    ) {
        let payload = payload.into();
        let bytes = payload.len();
        if self.post.waiting.load(Ordering::Relaxed) + bytes > MOST_BYTES {
            let busy = r#"{"ok":false,"error":"too many answers are waiting; try again"}"#;
            return self.refuse(busy.into());
        }
        self.post.waiting.fetch_add(bytes, Ordering::Relaxed);
        self.replies.borrow_mut().push(Reply {
            key: Some(key),
            payload,
            encoding,
        });
    }

    /// Answers with an error: JSON like that of a refused command.
    pub(super) fn refuse(&self, json: String) {
        self.replies.borrow_mut().push(Reply {
            key: None,
            payload: json.into(),
            encoding: Encoding::APPLICATION_JSON,
        });
    }
}

impl std::ops::Deref for Asked {
    type Target = Query;

    fn deref(&self) -> &Query {
        &self.query
    }
}

impl Drop for Asked {
    fn drop(&mut self) {
        let replies = self.replies.take();
        let answers = replies.iter().filter(|reply| reply.key.is_some());
        let bytes = answers.map(|reply| reply.payload.len()).sum();
        if let Some(place) = self.place.take() {
            self.post.put_in(Letter::Answer {
                query: self.query.clone(),
                replies,
                bytes,
                _place: place,
            });
        }
    }
}
