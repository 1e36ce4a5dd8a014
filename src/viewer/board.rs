//! What pages are shown: the newest frame of each key, and the last events.
//!
//! ```text
//! bus thread: Board::post ─▶ slots (newest wins) ─▶ each socket takes what is newer than it has
//! ```
//! A page that does not read gets no backlog: its socket takes the newest when there is room again.
//! The lock is held for as long as it takes to count references up, never while something is sent.

use super::frames::frame;
use axum::body::Bytes;
use palpate_wire::is_nodes_key;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Events kept for pages that open later, as many as the bus keeps.
const EVENTS_KEPT: usize = 256;

/// How long a frame is worth keeping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lasts {
    /// Until it changes: a page that opens later needs it.
    UntilChanged,
    /// While pages are open: without one no one brings it up to date.
    WhileWatched,
}

struct Slot {
    key: String,
    lasts: Lasts,
    version: u64,
    frame: Bytes,
}

#[derive(Default)]
struct State {
    /// Numbers every post.
    version: u64,
    /// Version that pages got last.
    reported: u64,
    /// In the order in which pages get them; the scene is first.
    slots: Vec<Slot>,
    events: VecDeque<(u64, Bytes)>,
}

/// Shared by the bus thread, which posts, and the sockets, which take.
pub(super) struct Board {
    state: Mutex<State>,
    changed: watch::Sender<u64>,
    open: AtomicUsize,
    newcomer: AtomicBool,
    /// Pages that look inside bodies, and whether one has just begun to.
    inside: AtomicUsize,
    inside_begun: AtomicBool,
}

impl Board {
    pub(super) fn new() -> Self {
        Self {
            state: Mutex::default(),
            changed: watch::channel(0).0,
            open: AtomicUsize::new(0),
            newcomer: AtomicBool::new(false),
            inside: AtomicUsize::new(0),
            inside_begun: AtomicBool::new(false),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts a message in the place of the one before it under this key.
    pub(super) fn post(&self, key: &str, lasts: Lasts, payload: &[u8]) {
        self.post_frame(key, lasts, frame(key, payload));
    }

    /// The same, for a frame that is made already.
    pub(super) fn post_frame(&self, key: &str, lasts: Lasts, frame: Bytes) {
        let mut state = self.lock();
        state.version += 1;
        let version = state.version;
        match state.slots.iter_mut().find(|slot| slot.key == key) {
            Some(slot) => (slot.version, slot.frame) = (version, frame),
            None => state.slots.push(Slot {
                key: key.to_owned(),
                lasts,
                version,
                frame,
            }),
        }
    }

    /// Begins a scene: what was shown of the one before is dropped, but not what concerns its tools.
    pub(super) fn begin_scene(&self, key: &str, payload: &[u8]) {
        let frame = frame(key, payload);
        let mut state = self.lock();
        state.version += 1;
        let version = state.version;
        state
            .slots
            .retain(|slot| slot.lasts == Lasts::UntilChanged && slot.key != key);
        let scene = Slot {
            key: key.to_owned(),
            lasts: Lasts::UntilChanged,
            version,
            frame,
        };
        state.slots.insert(0, scene);
    }

    /// Drops what is shown under a key.
    pub(super) fn forget(&self, key: &str) {
        self.lock().slots.retain(|slot| slot.key != key);
    }

    /// Adds an event.
    pub(super) fn event(&self, key: &str, payload: &[u8]) {
        let frame = frame(key, payload);
        let mut state = self.lock();
        state.version += 1;
        let version = state.version;
        if state.events.len() == EVENTS_KEPT {
            state.events.pop_front();
        }
        state.events.push_back((version, frame));
    }

    /// Wakes the sockets if anything was posted since the last time.
    pub(super) fn tell(&self) {
        let mut state = self.lock();
        if state.version != state.reported {
            state.reported = state.version;
            self.changed.send_replace(state.version);
        }
    }

    /// Resolves when something is posted.
    pub(super) fn changes(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// What was posted after version `seen`, which is moved on.
    pub(super) fn news(&self, seen: &mut u64) -> Vec<Bytes> {
        let state = self.lock();
        let since = std::mem::replace(seen, state.version);
        let slots = state.slots.iter().map(|slot| (slot.version, &slot.frame));
        let events = state
            .events
            .iter()
            .map(|(version, frame)| (*version, frame));
        (slots.chain(events))
            .filter(|(version, _)| *version > since)
            .map(|(_, frame)| frame.clone())
            .collect()
    }

    /// A page opened; false if there are `most` already.
    pub(super) fn enter(&self, most: usize) -> bool {
        let counted = |open: usize| (open < most).then_some(open + 1);
        let entered = (self.open)
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, counted)
            .is_ok();
        if entered {
            self.newcomer.store(true, Ordering::Release);
        }
        entered
    }

    /// A page closed.
    pub(super) fn leave(&self) {
        if self.open.fetch_sub(1, Ordering::AcqRel) == 1 {
            let mut state = self.lock();
            state.slots.retain(|slot| slot.lasts == Lasts::UntilChanged);
        }
    }

    /// A page looks inside bodies from now on, or no longer.
    pub(super) fn look_inside(&self, on: bool) {
        if on {
            self.inside.fetch_add(1, Ordering::AcqRel);
            self.inside_begun.store(true, Ordering::Release);
        } else if self.inside.fetch_sub(1, Ordering::AcqRel) == 1 {
            // No one brings them up to date any more.
            self.lock().slots.retain(|slot| !is_nodes_key(&slot.key));
        }
    }

    /// Whether a page looks inside bodies; true once after one began to: the nodes of all are due.
    pub(super) fn wants_nodes(&self) -> Option<bool> {
        (self.inside.load(Ordering::Acquire) > 0)
            .then(|| self.inside_begun.swap(false, Ordering::AcqRel))
    }

    /// Someone watches.
    pub(super) fn watched(&self) -> bool {
        self.open.load(Ordering::Acquire) > 0
    }

    /// True once after a page opened: it needs all that [`Lasts::WhileWatched`].
    pub(super) fn take_newcomer(&self) -> bool {
        // A load first: a swap on each turn of the bus would take the line from the sockets.
        self.newcomer.load(Ordering::Acquire) && self.newcomer.swap(false, Ordering::AcqRel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::frames::split;

    fn keys(frames: &[Bytes]) -> Vec<String> {
        let text = |frame: &Bytes| {
            let (key, payload) = split(frame).unwrap();
            format!("{key}={}", payload[0])
        };
        frames.iter().map(text).collect()
    }

    #[test]
    fn a_slow_page_gets_the_newest_of_each_key_and_every_event() {
        let board = Board::new();
        assert!(board.enter(1) && !board.enter(1), "pages are bounded");
        board.begin_scene("scene", &[1]);
        let mut seen = 0;
        assert_eq!(keys(&board.news(&mut seen)), ["scene=1"]);
        for k in 1..=100 {
            board.post("body/a/net", Lasts::WhileWatched, &[k]);
            if k % 50 == 0 {
                board.event("event", &[k]);
            }
        }
        let news = keys(&board.news(&mut seen));
        assert_eq!(news, ["body/a/net=100", "event=50", "event=100"]);
        assert!(board.news(&mut seen).is_empty());
    }

    #[test]
    fn another_scene_comes_before_its_nets_and_drops_those_before() {
        let board = Board::new();
        assert!(board.enter(4));
        board.begin_scene("scene", &[1]);
        board.post("holders", Lasts::UntilChanged, &[5]);
        board.post("body/a/net", Lasts::WhileWatched, &[2]);
        board.begin_scene("scene", &[3]);
        board.post("body/b/net", Lasts::WhileWatched, &[4]);
        let news = keys(&board.news(&mut 0));
        assert_eq!(news, ["scene=3", "holders=5", "body/b/net=4"]);
        board.leave();
        assert_eq!(keys(&board.news(&mut 0)), ["scene=3", "holders=5"]);
    }

    #[test]
    fn events_are_bounded() {
        let board = Board::new();
        for k in 0..1_000_u32 {
            board.event("event", &[(k % 200) as u8]);
        }
        assert_eq!(board.news(&mut 0).len(), EVENTS_KEPT);
    }

    #[test]
    fn sockets_are_woken_once_a_turn_and_only_by_news() {
        let board = Board::new();
        let mut changes = board.changes();
        board.tell();
        assert!(!changes.has_changed().unwrap());
        board.event("event", &[1]);
        board.post("status", Lasts::WhileWatched, &[1]);
        assert!(!changes.has_changed().unwrap());
        board.tell();
        assert!(changes.has_changed().unwrap());
        changes.mark_unchanged();
        board.tell();
        assert!(!changes.has_changed().unwrap());
    }
}
