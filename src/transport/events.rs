//! What happened, for clients and for the recording.

use super::answers::{reply, reply_refused};
use super::history::History;
use super::post::{Asked, Post};
use palpate_client::publisher;
use palpate_drive::archive::Archive;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{EventKind, SimEvent};
use palpate_wire as wire;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};
use zenoh::pubsub::Publisher;

/// Events, numbered from 1: published, recorded, and the last of them kept for queries.
pub(super) struct Events {
    publisher: Arc<Publisher<'static>>,
    /// Events wait for clients that do not read; no one else does.
    post: Post,
    /// The keeper of recordings, if there is one: it takes events as they happen.
    archive: Option<Box<dyn Archive>>,
    history: History,
    count: u64,
    tick: u64,
}

impl Events {
    /// None yet.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        archive: Option<Box<dyn Archive>>,
        post: Post,
    ) -> zenoh::Result<Self> {
        Ok(Self {
            publisher: Arc::new(publisher::<SimEvent>(session, keys.event())?),
            post,
            archive,
            history: History::default(),
            count: 0,
            tick: 0,
        })
    }

    /// Events are of this tick from now on.
    pub(super) fn reached(&mut self, tick: u64) {
        self.tick = tick;
    }

    /// Publishes and records an event.
    pub(super) fn tell(&mut self, kind: EventKind) {
        self.count += 1;
        let event = SimEvent {
            tick: self.tick,
            seq: self.count,
            t_ns: server_ns(),
            kind,
        };
        self.post.put(&self.publisher, encode(&event));
        if let Some(archive) = &mut self.archive {
            let (kind, detail) = wire::event_words(&event.kind);
            archive.event(event.tick, kind, &detail);
        }
        self.history.push(event);
    }

    /// The events kept whose number is above `after`, each in an answer of its own, oldest first.
    pub(super) fn answer(&self, query: &Asked) {
        let after = match query.parameters().get("after").map(str::parse::<u64>) {
            None => 0,
            Some(Ok(after)) => after,
            Some(Err(_)) => {
                return reply_refused(query, "after is the number of an event: event?after=17");
            }
        };
        for event in self.history.after(after) {
            reply(query, event);
        }
    }

    /// Those that came after number `seq`, oldest first.
    pub(super) fn after(&self, seq: u64) -> impl Iterator<Item = &SimEvent> {
        self.history.after(seq)
    }

    /// How many there were.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// The keeper of recordings.
    pub(super) fn archive(&mut self) -> Option<&mut (dyn Archive + 'static)> {
        self.archive.as_deref_mut()
    }
}

/// This machine's clock, ns since the Unix epoch.
pub(super) fn server_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |t| t.as_nanos() as u64)
}
