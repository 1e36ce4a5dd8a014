//! The newest force of those that came.

use palpate_proto::messages::ToolForce;
use std::time::{Duration, Instant};

/// Forces overtake each other by less than this.
const OVERTAKEN: Duration = Duration::from_millis(50);

/// What is known of a tool's forces.
#[derive(Clone, Copy, Debug, Default)]
pub struct NewestForce {
    /// The newest.
    pub force: Option<ToolForce>,
    /// How many came, also those that were overtaken.
    pub received: u64,
    /// When the last one came.
    pub at: Option<Instant>,
}

impl NewestForce {
    /// A force that came now.
    pub fn offer(&mut self, force: ToolForce, now: Instant) {
        // A daemon that came back, or a recording wound back, counts from below: its clock tells, or,
        // where another machine's is behind, that the one before is silent.
        let silent = (self.at).is_none_or(|at| now.saturating_duration_since(at) > OVERTAKEN);
        let newer = |old: ToolForce| {
            silent || force.tick >= old.tick || force.t_server_ns > old.t_server_ns
        };
        if self.force.is_none_or(newer) {
            self.force = Some(force);
        }
        self.at = Some(now);
        self.received += 1;
    }
}
