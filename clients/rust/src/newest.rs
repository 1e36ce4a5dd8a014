//! The newest force of those that came.

use palpate_proto::messages::ToolForce;
use palpate_proto::watchdog::{Silences, Watchdog};
use std::time::{Duration, Instant};

/// Forces overtake each other by less than this.
const OVERTAKEN: Duration = Duration::from_millis(50);

/// What is known of a tool's forces.
#[derive(Clone, Copy, Debug)]
pub struct NewestForce {
    /// The newest, as it came. What may act of it is [`NewestForce::felt`].
    pub force: Option<ToolForce>,
    /// How many came, also those that were overtaken.
    pub received: u64,
    watchdog: Watchdog,
    /// In lockstep a force is never old: time stands still until the next.
    timeless: bool,
}

impl NewestForce {
    /// Nothing has come. `timeless`: no force is ever too old, as in lockstep; `sparse`: the daemon may leave
    /// forces out (a deadband).
    pub fn new(timeless: bool, sparse: bool) -> Self {
        Self {
            force: None,
            received: 0,
            watchdog: Watchdog::new(sparse),
            timeless,
        }
    }

    /// A force that came now.
    pub fn offer(&mut self, force: ToolForce, now: Instant) {
        self.received += 1;
        // A daemon that came back, or a recording wound back, counts from below: its clock tells, or,
        // where another machine's is behind, that nothing newer has come for a while.
        let newer = |old: ToolForce| {
            let silent = (self.silence(now)).is_none_or(|silence| silence > OVERTAKEN);
            silent || force.tick >= old.tick || force.t_server_ns > old.t_server_ns
        };
        // What was overtaken is no sign of life: forces of another daemon that are taken for that must not
        // keep the last force of the one before.
        if self.force.is_none_or(newer) {
            self.force = Some(force);
            self.watchdog.heard(now);
        }
    }

    /// The newest force as it may act now: fading when it is too old, marked
    /// [`palpate_proto::messages::force_flags::RAMPING`] then.
    pub fn felt(&self, now: Instant) -> Option<ToolForce> {
        match self.timeless {
            true => self.force,
            false => self.force.map(|force| self.watchdog.felt(&force, now)),
        }
    }

    /// The share of the newest force that may act now, 0 to 1.
    pub fn gain(&self, now: Instant) -> f64 {
        match self.timeless {
            true => 1.0,
            false => self.watchdog.gain(now),
        }
    }

    /// How long ago the newest force came; `None` before the first.
    pub fn silence(&self, now: Instant) -> Option<Duration> {
        self.watchdog.silence(now)
    }

    /// Times that no force came for longer than one may act.
    pub fn silences(&self, now: Instant) -> Silences {
        self.watchdog.silences(now)
    }

    /// From now on the daemon may leave forces out, or not.
    pub fn set_sparse(&mut self, sparse: bool) {
        self.watchdog.set_sparse(sparse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn force(tick: u64, t_server_ms: u64, x_n: f64) -> ToolForce {
        ToolForce {
            tick,
            pose_seq: 1,
            t_client_ns: 0,
            t_server_ns: t_server_ms * 1_000_000,
            force: [x_n, 0.0, 0.0],
            torque: [0.0; 3],
            proxy_position: [0.0; 3],
            proxy_orientation: [0.0, 0.0, 0.0, 1.0],
            depth: 0.0,
            contact_count: 1,
            flags: 0,
        }
    }

    // Every force of the second daemon looks like one that was overtaken: its ticks are lower, and so is the
    // clock of its machine. Each kept the last force of the first one fresh.
    #[test]
    fn another_daemon_with_an_earlier_clock_that_takes_over_at_once_is_felt_within_60_ms() {
        let begun = Instant::now();
        let mut newest = NewestForce::new(false, false);
        for k in 0..100 {
            newest.offer(
                force(50_000 + u64::from(k), 9_000 + u64::from(k), 1.4),
                begun + k * MS,
            );
        }
        for k in 100..300 {
            newest.offer(force(u64::from(k), u64::from(k), 0.2), begun + k * MS);
        }
        let felt = newest.felt(begun + 162 * MS).unwrap();
        assert_eq!(felt.force[0] / 0.2, newest.gain(begun + 162 * MS));
        assert_eq!(newest.felt(begun + 300 * MS).unwrap().force[0], 0.2);
    }

    #[test]
    fn a_force_that_was_overtaken_is_left() {
        let begun = Instant::now();
        let mut newest = NewestForce::new(false, false);
        newest.offer(force(7, 7, 1.0), begun);
        newest.offer(force(6, 6, 2.0), begun + MS);
        assert_eq!(newest.felt(begun + MS).unwrap().force[0], 1.0);
        assert_eq!(newest.received, 2);
    }

    #[test]
    fn in_lockstep_a_force_stays_and_its_age_is_told() {
        let begun = Instant::now();
        let mut newest = NewestForce::new(true, false);
        newest.offer(force(1, 1, 0.1 + 0.2), begun);
        let later = begun + 5_000 * MS;
        assert_eq!(newest.felt(later), newest.force);
        assert_eq!(newest.silence(later), Some(5_000 * MS));
    }
}
