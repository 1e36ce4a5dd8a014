//! Control nets of bodies: published as they change, answered as they stand.
//!
//! A net that no one takes is not made: neither the message nor its bytes.

use super::intake::{Intake, Question};
use super::post::{NetSlot, Post};
use super::view::View;
use palpate_client::publisher;
use palpate_drive::editor::Standing;
use palpate_drive::ports::{NetEnd, NetFrame};
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::Point3;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::ControlNet;
use palpate_sim::scene::Scene;
use palpate_wire as wire;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::matching::MatchingListener;

/// Nets that do not change are published this often.
const NET_REFRESH: Duration = Duration::from_secs(1);

/// The newest nets by body, and what is declared for them.
pub(super) struct Nets {
    newest: Vec<ControlNet>,
    /// By body: one that came after the newest and is not a message yet.
    frames: Vec<Option<Arc<NetFrame>>>,
    /// By body: the newest of all, for who looks inside.
    last: Vec<Option<Arc<NetFrame>>>,
    ends: Vec<NetEnd>,
    lines: Vec<Line>,
    queryables: Vec<zenoh::query::Queryable<()>>,
    intake: Intake,
    post: Post,
    last_refresh: Instant,
    /// The bodies are others than those that pages have.
    others: bool,
}

/// Where the nets of a body go.
struct Line {
    // Dropped in this order: a publisher that goes takes its listeners along.
    _listener: MatchingListener<()>,
    slot: Arc<NetSlot>,
    /// Someone subscribes.
    wanted: Arc<AtomicBool>,
}

impl Line {
    fn new(session: &zenoh::Session, key: String) -> zenoh::Result<Self> {
        let publisher = publisher::<ControlNet>(session, key)?;
        let wanted = Arc::new(AtomicBool::new(false));
        let found = wanted.clone();
        let listener = publisher
            .matching_listener()
            .callback(move |status| found.store(status.matching(), Ordering::Release))
            .wait()?;
        if publisher.matching_status().wait()?.matching() {
            wanted.store(true, Ordering::Release);
        }
        Ok(Self {
            _listener: listener,
            slot: NetSlot::new(publisher),
            wanted,
        })
    }
}

impl Nets {
    /// Declares the nets of a scene; queries for them come in through `intake`, nets go out through
    /// `post`.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        ends: Vec<NetEnd>,
        intake: Intake,
        post: Post,
    ) -> zenoh::Result<Self> {
        let mut nets = Self {
            newest: wire::all_nets(scene, &scene.initial_state()),
            frames: vec![None; ends.len()],
            last: vec![None; ends.len()],
            ends,
            lines: Vec::new(),
            queryables: Vec::new(),
            intake,
            post,
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
        self.frames = vec![None; ends.len()];
        self.last = vec![None; ends.len()];
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
        self.lines.clear();
        self.queryables.clear();
        let answers = self.intake.post();
        for body in 0..scene.body_count() {
            let id = scene.body_id(body).to_owned();
            let key = keys.body_net(&id);
            let line = Line::new(session, key.clone())?;
            let asked = self
                .intake
                .question(&answers, move || Question::Net(id.clone()));
            self.queryables
                .push(session.declare_queryable(key).callback(asked).wait()?);
            self.lines.push(line);
        }
        Ok(())
    }

    /// Publishes what changed, and all of them each second. Pages get what changed, and `all` of them
    /// when one has opened.
    pub(super) fn publish(&mut self, scene: &Scene, all: bool, view: &mut View) {
        let refresh = self.last_refresh.elapsed() >= NET_REFRESH;
        let watched = view.watched();
        let inside = view.wants_nodes();
        for body in 0..self.newest.len() {
            let fresh = self.ends[body].newest();
            let changed = fresh.is_some();
            if fresh.is_some() {
                self.last[body].clone_from(&fresh);
            }
            if let Some(all) = inside
                && (changed || all || self.others)
            {
                self.show_nodes(scene, body, view);
            }
            self.frames[body] = fresh.or(self.frames[body].take());
            // After a failed declaration there is no line.
            let line = self.lines.get(body);
            let wanted = line.is_some_and(|line| line.wanted.load(Ordering::Acquire));
            let published = wanted && (changed || refresh);
            let shown = watched && (changed || all || self.others);
            if !published && !shown {
                continue;
            }
            self.bring_up(scene, body);
            let net = &self.newest[body];
            let bytes = encode(net);
            if shown {
                view.bytes::<ControlNet>(&net.body, &bytes);
            }
            if let Some(line) = self.lines.get(body).filter(|_| published) {
                self.post.net(&line.slot, bytes);
            }
        }
        self.others = false;
        if refresh {
            self.last_refresh = Instant::now();
        }
    }

    /// Shows where the nodes inside a body are: pages only, nothing of it is on the bus.
    fn show_nodes(&self, scene: &Scene, body: usize, view: &mut View) {
        let Some(deformable) = scene.deformable(body).filter(|d| !d.cells().is_empty()) else {
            return;
        };
        let (tick, nodes) = match &self.last[body] {
            Some(frame) => (frame.tick, deformable.nodes(&frame.coordinates)),
            None => (0, deformable.nodes(deformable.rest())),
        };
        let payload = wire::nodes_payload(tick, &nodes);
        let key = wire::nodes_key(scene.body_id(body));
        view.tell(|sink| sink.message(&key, &payload));
    }

    /// Makes the newest net of a body a message.
    fn bring_up(&mut self, scene: &Scene, body: usize) {
        if let Some(frame) = self.frames[body].take() {
            let (tick, revision) = (frame.tick, frame.revision);
            self.newest[body] = wire::control_net(scene, body, tick, revision, &frame.points);
        }
    }

    /// How a body stands.
    pub(super) fn standing(&self, scene: &Scene, body: usize) -> Standing {
        if let Some(frame) = &self.last[body] {
            return Standing {
                points: frame.points.clone(),
                coordinates: frame.coordinates.clone(),
            };
        }
        // Nothing has moved it yet.
        let points = &self.newest[body].points;
        Standing {
            points: points.iter().map(|&point| point.into()).collect(),
            coordinates: (scene.deformable(body))
                .map_or_else(Vec::new, |deformable| deformable.rest().to_vec()),
        }
    }

    /// Control points of a body are on both sides of a plane.
    pub(super) fn is_crossed(&self, body: usize, plane: &CutPlane) -> bool {
        let mut sides = [false; 2];
        let mut see = |point: &Point3| sides[usize::from(plane.height(point) > 0.0)] = true;
        match &self.last[body] {
            Some(frame) => frame.points.iter().for_each(&mut see),
            None => (self.newest[body].points.iter()).for_each(|&point| see(&point.into())),
        }
        sides == [true; 2]
    }

    /// By body.
    pub(super) fn all(&mut self, scene: &Scene) -> &[ControlNet] {
        for body in 0..self.newest.len() {
            self.bring_up(scene, body);
        }
        &self.newest
    }
}
