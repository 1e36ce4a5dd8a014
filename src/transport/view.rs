//! What pages are shown.

use super::metrics::LoopMetrics;
use palpate_proto::codec::encode;
use palpate_proto::messages::Message;
use palpate_sim::scene::Scene;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Takes what pages are shown. Called by the bus thread; must not wait. Payloads are those of the
/// bus, and keys are relative to `palpate/{inst}/`.
pub trait ViewSink: Send {
    /// A page is open. While none is, [`ViewSink::message`] is not called.
    fn watched(&self) -> bool;
    /// Someone looks inside bodies; true once after that began: the nodes of all are due.
    fn wants_nodes(&mut self) -> Option<bool>;
    /// True once after a page opened: all messages are due.
    fn take_newcomer(&mut self) -> bool;
    /// The scene at the start and after each change, with its snapshot; nets follow.
    fn scene(&mut self, scene: &Arc<Scene>, snapshot: &[u8]);
    /// The newest message of a key.
    fn message(&mut self, key: &str, payload: &[u8]);
    /// An event. All come, also while no page is open.
    fn event(&mut self, payload: &[u8]);
    /// What the device of a tool reported, and its name.
    fn device(&mut self, tool: &str, name: &str, payload: &[u8]);
    /// A tool's liveliness token appeared, or disappeared.
    fn token(&mut self, tool: &str, present: bool);
    /// Everything that is counted, ten times a second.
    fn figures(&mut self, figures: &LoopMetrics);
    /// All of a turn was shown.
    fn turn_over(&mut self);
}

/// Forces a second for pages.
const FORCES_EVERY: Duration = Duration::from_micros(16_000);

/// The viewer, if there is one.
pub(super) struct View {
    sink: Option<Box<dyn ViewSink>>,
    last_forces: Instant,
}

impl View {
    pub(super) fn new(sink: Option<Box<dyn ViewSink>>) -> Self {
        Self {
            sink,
            last_forces: Instant::now(),
        }
    }

    /// Calls `show` if there is a viewer.
    pub(super) fn tell(&mut self, show: impl FnOnce(&mut dyn ViewSink)) {
        if let Some(sink) = &mut self.sink {
            show(sink.as_mut());
        }
    }

    /// A page is open.
    pub(super) fn watched(&self) -> bool {
        self.sink.as_ref().is_some_and(|sink| sink.watched())
    }

    /// Someone looks inside bodies; true where the nodes of all are due.
    pub(super) fn wants_nodes(&mut self) -> Option<bool> {
        self.sink.as_mut().and_then(|sink| sink.wants_nodes())
    }

    /// There is a viewer, if without pages.
    pub(super) fn is_there(&self) -> bool {
        self.sink.is_some()
    }

    /// True once after a page opened.
    pub(super) fn take_newcomer(&mut self) -> bool {
        (self.sink.as_mut()).is_some_and(|sink| sink.take_newcomer())
    }

    /// Forces are due: true some sixty times a second while a page is open.
    pub(super) fn forces_due(&mut self) -> bool {
        let due = self.watched() && self.last_forces.elapsed() >= FORCES_EVERY;
        if due {
            self.last_forces = Instant::now();
        }
        due
    }

    /// Shows a message that is encoded already.
    pub(super) fn bytes<M: Message>(&mut self, id: &str, payload: &[u8]) {
        let key = M::KEY.replace("{tool}", id).replace("{body}", id);
        self.tell(|sink| sink.message(&key, payload));
    }

    /// Shows a message.
    pub(super) fn message<M: Message>(&mut self, id: &str, message: &M) {
        self.bytes::<M>(id, &encode(message));
    }
}
