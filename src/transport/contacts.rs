//! Contacts of all tools and bodies, as often as people can follow them.

use super::view::View;
use palpate_client::publisher;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::ContactSet;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickOutput;
use palpate_wire as wire;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::pubsub::Publisher;

const CONTACTS_EVERY: Duration = Duration::from_micros(16_667);

/// Publishes contacts some sixty times a second while there are any, and when they begin and end.
pub(super) struct Contacts {
    publisher: Publisher<'static>,
    last: Instant,
    /// By tool: it touched something in the last tick seen.
    touching: Vec<bool>,
    /// Anything touched in the last tick seen.
    any: bool,
}

impl Contacts {
    /// Nothing touches yet.
    pub(super) fn new(session: &zenoh::Session, keys: &Keys, tools: usize) -> zenoh::Result<Self> {
        Ok(Self {
            publisher: publisher::<ContactSet>(session, keys.contact())?,
            last: Instant::now(),
            touching: vec![false; tools],
            any: false,
        })
    }

    /// Publishes the contacts of a tick if they are due.
    pub(super) fn publish(&mut self, scene: &Scene, output: &TickOutput, view: &mut View) {
        let mut changed = false;
        let outputs = output.tools.first(self.touching.len());
        for (touching, out) in self.touching.iter_mut().zip(outputs) {
            changed |= *touching != out.contact.is_some();
            *touching = out.contact.is_some();
        }
        // Bodies may touch without a tool.
        let any = !output.contacts.list().is_empty();
        changed |= self.any != any;
        self.any = any;
        let due = self.last.elapsed() >= CONTACTS_EVERY && any;
        if changed || due {
            self.last = Instant::now();
            let set = wire::contact_set(scene, output);
            let bytes = encode(&set);
            if view.watched() {
                view.bytes::<ContactSet>("", &bytes);
            }
            let _ = self.publisher.put(bytes).wait();
        }
    }
}
