//! Control nets of bodies: published as they change, answered as they stand.

use super::declared::Inbox;
use super::view::View;
use crate::drive::ports::NetEnd;
use crate::wire;
use palpate_client::publisher;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::ControlNet;
use palpate_sim::scene::Scene;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::pubsub::Publisher;

/// Nets that do not change are published this often.
const NET_REFRESH: Duration = Duration::from_secs(1);

/// The newest nets by body, and what is declared for them.
pub(super) struct Nets {
    newest: Vec<ControlNet>,
    ends: Vec<NetEnd>,
    publishers: Vec<Publisher<'static>>,
    queryables: Vec<zenoh::query::Queryable<()>>,
    inbox: SyncSender<Inbox>,
    last_refresh: Instant,
    /// The bodies are others than those that pages have.
    others: bool,
}

impl Nets {
    /// Declares the nets of a scene; queries for them come in through `inbox`.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        ends: Vec<NetEnd>,
        inbox: SyncSender<Inbox>,
    ) -> zenoh::Result<Self> {
        let mut nets = Self {
            newest: wire::all_nets(scene, &scene.initial_state()),
            ends,
            publishers: Vec::new(),
            queryables: Vec::new(),
            inbox,
            last_refresh: Instant::now(),
            others: false,
        };
        nets.declare(session, keys, scene)?;
        Ok(nets)
    }

    /// Goes on with the nets of another scene, all of which go out next.
    pub(super) fn change(
        &mut self,
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        ends: Vec<NetEnd>,
    ) {
        self.newest = wire::all_nets(scene, &scene.initial_state());
        self.ends = ends;
        self.others = true;
        if let Err(error) = self.declare(session, keys, scene) {
            tracing::error!(%error, "the bodies of the next scene");
        }
        self.last_refresh = self
            .last_refresh
            .checked_sub(NET_REFRESH)
            .unwrap_or(self.last_refresh);
    }

    fn declare(
        &mut self,
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
    ) -> zenoh::Result<()> {
        self.publishers.clear();
        self.queryables.clear();
        for body in 0..scene.body_count() {
            let id = scene.body_id(body).to_owned();
            let key = keys.body_net(&id);
            let publisher = publisher::<ControlNet>(session, key.clone())?;
            let inbox = self.inbox.clone();
            let asked = move |query| {
                let _ = inbox.try_send(Inbox::Net(id.clone(), query));
            };
            self.queryables
                .push(session.declare_queryable(key).callback(asked).wait()?);
            self.publishers.push(publisher);
        }
        Ok(())
    }

    /// Publishes what changed, and all of them each second. Pages get what changed, and `all` of them
    /// when one has opened.
    pub(super) fn publish(&mut self, scene: &Scene, all: bool, view: &mut View) {
        let refresh = self.last_refresh.elapsed() >= NET_REFRESH;
        let watched = view.watched();
        for (body, net) in self.newest.iter_mut().enumerate() {
            let fresh = self.ends[body].newest();
            let changed = fresh.is_some();
            if let Some(frame) = fresh {
                *net = wire::control_net(scene, body, frame.tick, frame.revision, &frame.points);
            }
            let published = changed || refresh;
            let shown = watched && (changed || all || self.others);
            if !published && !shown {
                continue;
            }
            let bytes = encode(net);
            if shown {
                view.bytes::<ControlNet>(&net.body, &bytes);
            }
            // After a failed declaration there is none.
            if let Some(publisher) = self.publishers.get(body).filter(|_| published) {
                let _ = publisher.put(bytes).wait();
            }
        }
        self.others = false;
        if refresh {
            self.last_refresh = Instant::now();
        }
    }

    /// By body.
    pub(super) fn all(&self) -> &[ControlNet] {
        &self.newest
    }
}
