//! What may have to wait for a client that does not read goes out on a thread of its own: answers,
//! nets and events. The bus thread, which sends forces, never waits for one.
//!
//! ```text
//! bus thread ─▶ Post ─▶ palpate-answers ─▶ answers, nets      (in this order)
//!                  └──▶ palpate-events  ─▶ events
//! ```
//! A client that does not read holds these up until Zenoh closes its transport, some seconds.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;
use zenoh::pubsub::Publisher;
use zenoh::query::Query;

/// Letters that may wait; beyond, queries are not taken any more and end without an answer.
const MOST_LETTERS: usize = 4096;
/// Bytes of answers that may wait.
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

enum Letter {
    Answer {
        query: Query,
        key: KeyExpr<'static>,
        payload: Vec<u8>,
        encoding: Encoding,
        refused: bool,
    },
    /// Everything was answered: the client may hear that.
    End(Query),
    Net(Arc<NetSlot>),
    Put(Arc<Publisher<'static>>, Vec<u8>),
}

#[derive(Default)]
struct Waiting {
    letters: AtomicUsize,
    bytes: AtomicUsize,
}

/// Where letters are dropped; never waits.
#[derive(Clone)]
pub(super) struct Post {
    letters: Sender<(Letter, usize)>,
    waiting: Arc<Waiting>,
}

/// The thread that sends them.
pub(super) struct PostThread(JoinHandle<()>);

impl Post {
    /// Starts a thread; it ends when every [`Post`] of it is gone.
    pub(super) fn start(name: &str) -> std::io::Result<(Self, PostThread)> {
        let (letters, inbox) = channel();
        let waiting = Arc::<Waiting>::default();
        let counted = waiting.clone();
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || send_all(&inbox, &counted))?;
        Ok((Self { letters, waiting }, PostThread(thread)))
    }

    /// Another query can be taken.
    pub(super) fn has_room(&self) -> bool {
        self.waiting.letters.load(Ordering::Relaxed) < MOST_LETTERS
    }

    fn put_in(&self, letter: Letter, bytes: usize) {
        self.waiting.letters.fetch_add(1, Ordering::Relaxed);
        self.waiting.bytes.fetch_add(bytes, Ordering::Relaxed);
        // The thread ends only when nobody can be here.
        let _ = self.letters.send((letter, bytes));
    }

    /// Publishes a net, unless a newer one replaces it first.
    pub(super) fn net(&self, slot: &Arc<NetSlot>, bytes: Vec<u8>) {
        if slot.replace(Some(bytes)).is_none() {
            self.put_in(Letter::Net(slot.clone()), 0);
        }
    }

    /// Publishes a message.
    pub(super) fn put(&self, publisher: &Arc<Publisher<'static>>, bytes: Vec<u8>) {
        let size = bytes.len();
        self.put_in(Letter::Put(publisher.clone(), bytes), size);
    }
}

impl PostThread {
    /// Waits until all is sent, but not for ever: a client may not read.
    pub(super) fn finish(self) {
        let until = Instant::now() + PATIENCE;
        while !self.0.is_finished() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

fn send_all(inbox: &Receiver<(Letter, usize)>, waiting: &Waiting) {
    while let Ok((letter, bytes)) = inbox.recv() {
        match letter {
            Letter::Answer {
                query,
                key,
                payload,
                encoding,
                refused,
            } => {
                let _ = match refused {
                    false => query.reply(key, payload).encoding(encoding).wait(),
                    true => query.reply_err(payload).encoding(encoding).wait(),
                };
            }
            Letter::End(query) => drop(query),
            Letter::Net(slot) => {
                if let Some(net) = slot.replace(None) {
                    let _ = slot.publisher.put(net).wait();
                }
            }
            Letter::Put(publisher, message) => drop(publisher.put(message).wait()),
        }
        waiting.letters.fetch_sub(1, Ordering::Relaxed);
        waiting.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }
}

/// A query and the way of its answers. Dropped, it has been answered.
pub(super) struct Asked {
    query: Query,
    post: Post,
}

impl Asked {
    pub(super) fn new(query: Query, post: &Post) -> Self {
        Self {
            query,
            post: post.clone(),
        }
    }

    /// Answers under a key.
    pub(super) fn answer(&self, key: KeyExpr<'static>, payload: Vec<u8>, encoding: Encoding) {
        let full = self.post.waiting.bytes.load(Ordering::Relaxed) + payload.len() > MOST_BYTES;
        match full {
            false => self.post_answer(key, payload, encoding, false),
            true => {
                let busy = r#"{"ok":false,"error":"too many answers are waiting; try again"}"#;
                self.refuse(busy.into());
            }
        }
    }

    /// Answers with an error: JSON like that of a refused command.
    pub(super) fn refuse(&self, json: String) {
        let key = self.query.key_expr().clone().into_owned();
        self.post_answer(key, json.into_bytes(), Encoding::APPLICATION_JSON, true);
    }

    fn post_answer(
        &self,
        key: KeyExpr<'static>,
        payload: Vec<u8>,
        encoding: Encoding,
        refused: bool,
    ) {
        let size = payload.len();
        let letter = Letter::Answer {
            query: self.query.clone(),
            key,
            payload,
            encoding,
            refused,
        };
        self.post.put_in(letter, size);
    }
}

impl std::ops::Deref for Asked {
    type Target = Query;

    fn deref(&self) -> &Query {
        &self.query
    }
}

impl Drop for Asked {
    /// The last trace of a query tells its client that all was said, which may wait too.
    fn drop(&mut self) {
        self.post.put_in(Letter::End(self.query.clone()), 0);
    }
}
