//! From frames of the board to messages of views.

use super::super::frames::split;
use axum::body::Bytes;
use palpate_proto::codec::decode;
use palpate_proto::messages::{ControlNet, SceneSnapshot, SimEvent, ToolForce};
use palpate_record::{LOG_VIEW, Pictures, ViewTopic, log_view, stamp_of};
use palpate_sim::scene::Scene;
use palpate_wire::event_words;
use std::convert::Infallible;
use std::sync::Arc;

/// What one viewer is shown.
pub(super) struct Painter {
    scene: Arc<Scene>,
    pictures: Pictures,
    /// By tool: force, torque, position and orientation of its proxy.
    tools: Vec<Vec<f64>>,
    /// Something came since the last picture.
    fresh: bool,
    /// Events up to this number were sent.
    reported: u64,
}

impl Painter {
    /// Nothing came yet.
    pub(super) fn new(scene: Arc<Scene>) -> Self {
        Self {
            pictures: Pictures::of(&scene),
            tools: vec![Vec::new(); scene.tool_count()],
            scene,
            fresh: false,
            reported: 0,
        }
    }

    /// All views, by number.
    pub(super) fn topics(&self) -> Vec<ViewTopic> {
        self.pictures.topics()
    }

    /// Pictures a second.
    pub(super) fn rate_hz(&self) -> f64 {
        self.scene.spec.record.view_hz.clamp(1.0, 60.0)
    }

    /// Another view is wanted: the next picture shows all. `log`: so are the events.
    pub(super) fn start_again(&mut self, log: bool) {
        self.pictures.start_again();
        if log {
            self.reported = 0;
        }
    }

    /// The same for another scene.
    pub(super) fn for_scene(&self, scene: Arc<Scene>) -> Self {
        let reported = self.reported;
        Self {
            reported,
            ..Self::new(scene)
        }
    }

    /// This is the scene that is drawn.
    pub(super) fn draws(&self, scene: &Arc<Scene>) -> bool {
        Arc::ptr_eq(&self.scene, scene)
    }

    /// Takes a frame of the board; an event goes to `put` at once.
    pub(super) fn absorb(&mut self, frame: &Bytes, put: &mut impl FnMut(usize, u64, &[u8])) {
        let Some((key, payload)) = split(frame) else {
            return;
        };
        let mut parts = key.split('/');
        match (parts.next(), parts.next(), parts.next()) {
            (Some("scene"), None, None) => self.take_scene(payload),
            (Some("body"), Some(id), Some("net")) => self.take_net(id, payload),
            (Some("tool"), Some(id), Some("force")) => self.take_force(id, payload),
            (Some("event"), None, None) => self.tell(payload, put),
            _ => {}
        }
    }

    /// Where tools stand that no one has moved yet.
    fn take_scene(&mut self, payload: &[u8]) {
        let Ok(snapshot) = decode::<SceneSnapshot>(payload, "") else {
            return;
        };
        for (values, tool) in self.tools.iter_mut().zip(&snapshot.tools) {
            if values.is_empty() {
                values.extend([0.0; 6]);
                values.extend(tool.position);
                values.extend(tool.orientation);
            }
        }
        self.fresh = true;
    }

    fn take_net(&mut self, id: &str, payload: &[u8]) {
        let net = decode::<ControlNet>(payload, "").ok();
        if let Some((body, net)) = self.scene.body_index(id).zip(net) {
            self.pictures
                .net(body, net.points.into_iter().flatten().collect());
            self.fresh = true;
        }
    }

    fn take_force(&mut self, id: &str, payload: &[u8]) {
        let force = decode::<ToolForce>(payload, "").ok();
        if let Some((tool, force)) = self.scene.tool_index(id).zip(force) {
            let values = &mut self.tools[tool];
            values.clear();
            values.extend(force.force);
            values.extend(force.torque);
            values.extend(force.proxy_position);
            values.extend(force.proxy_orientation);
            self.fresh = true;
        }
    }

    fn tell(&mut self, payload: &[u8], put: &mut impl FnMut(usize, u64, &[u8])) {
        let event = decode::<SimEvent>(payload, "").ok();
        if let Some(event) = event.filter(|event| event.seq > self.reported) {
            self.reported = event.seq;
            let (kind, detail) = event_words(&event.kind);
            let line = log_view(stamp_of(event.t_ns), kind, &detail);
            put(LOG_VIEW, event.t_ns, &line);
        }
    }

    /// Draws what is new, if anything is.
    pub(super) fn paint(
        &mut self,
        time_ns: u64,
        wanted: impl Fn(usize) -> bool,
        put: &mut impl FnMut(usize, u64, &[u8]),
    ) {
        if !std::mem::take(&mut self.fresh) {
            return;
        }
        let tools = || self.tools.iter().map(Vec::as_slice);
        let mut put = |view: usize, payload: &[u8]| -> Result<(), Infallible> {
            put(view, time_ns, payload);
            Ok(())
        };
        let Ok(()) = self.pictures.wrenches(tools(), &wanted, &mut put);
        let Ok(()) = self.pictures.draw(stamp_of(time_ns), tools(), wanted, put);
    }
}
