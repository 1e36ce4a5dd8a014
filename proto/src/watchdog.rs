//! When a force is too old to act: what every client does with the newest force it has, because a daemon
//! that dies, is stopped or is cut off cannot send zero. `docs/wire.md`, "The watchdog", has it in words.
//!
//! ```text
//! gain 1 ─────────────╮                       ╭──────    forces come
//!                      ╲                     ╱
//!      0                ╰───────────────────╯
//!         last force  +50 +60 ms     first  +100 ms
//! ```
//! It depends on when forces came and on nothing else: who looks rarely, or was stopped, gets what a
//! thousand looks a second would have led to. Clients in C, Python and TypeScript do the same arithmetic;
//! `golden/watchdog.json` holds all of them to it.

use crate::messages::{ToolForce, force_flags};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// A force older than this acts no longer.
pub const FRESH: Duration = Duration::from_millis(50);
/// The same where the daemon may leave forces out (a deadband): it sends one in 50 ms at least.
pub const FRESH_SPARSE: Duration = Duration::from_millis(100);
/// From full force to none.
pub const FADE_OUT: Duration = Duration::from_millis(10);
/// And back, when forces come again.
pub const FADE_IN: Duration = Duration::from_millis(100);

/// What a watchdog saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Silences {
    /// Times that forces stopped coming.
    pub count: u64,
    /// The longest time without one, s.
    pub longest_s: f64,
}

/// Scales forces by whether they still come: 1 while they do, 0 within 60 ms of the last one.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog {
    limit: Duration,
    /// The gain of the first force.
    first: f64,
    heard: Option<Heard>,
    silences: Silences,
}

#[derive(Clone, Copy, Debug)]
struct Heard {
    last: Instant,
    /// The gain when the last one came.
    gain: f64,
    /// When forces began to come, at first or again, and the gain then.
    since: Instant,
    from: f64,
}

/// How much of a fade passes in a time.
fn share(time: Duration, fade: Duration) -> f64 {
    time.as_nanos() as f64 / fade.as_nanos() as f64
}

impl Watchdog {
    /// Nothing has come yet. `sparse`: the daemon may leave forces out.
    pub fn new(sparse: bool) -> Self {
        Self {
            limit: if sparse { FRESH_SPARSE } else { FRESH },
            first: 1.0,
            heard: None,
            silences: Silences::default(),
        }
    }

    /// The first force fades in as well: for those who come to a force that acts already.
    pub fn from_nothing(self) -> Self {
        Self { first: 0.0, ..self }
    }

    /// From now on the daemon may leave forces out, or not.
    pub fn set_sparse(&mut self, sparse: bool) {
        self.limit = Self::new(sparse).limit;
    }

    /// A force came.
    pub fn heard(&mut self, now: Instant) {
        self.silences = self.silences(now);
        let begins = |gain: f64| Heard {
            last: now,
            gain,
            since: now,
            from: gain,
        };
        self.heard = Some(match self.heard {
            None => begins(self.first),
            Some(_) if self.is_silent(now) => begins(self.gain(now)),
            Some(before) => Heard {
                last: now.max(before.last),
                gain: self.gain(now),
                ..before
            },
        });
    }

    /// The share of the newest force that may act now; 0 before the first.
    pub fn gain(&self, now: Instant) -> f64 {
        let Some(heard) = self.heard else {
            return 0.0;
        };
        let age = now.saturating_duration_since(heard.last);
        // It rises for as long as forces have been coming: those that waited in a queue while this process
        // or the link stood still come all at once, and may be as old as that.
        let coming = heard.last.saturating_duration_since(heard.since);
        let most = (heard.from + share(coming, FADE_IN)).min(1.0);
        let risen = (heard.gain + share(age.min(self.limit), FADE_IN)).min(most);
        (risen - share(age.saturating_sub(self.limit), FADE_OUT)).max(0.0)
    }

    /// A force as it may act now: with [`force_flags::RAMPING`] where that is less than all of it.
    pub fn felt(&self, force: &ToolForce, now: Instant) -> ToolForce {
        let gain = self.gain(now);
        let mut felt = *force;
        // What is felt in full keeps every bit.
        if gain < 1.0 {
            felt.force = felt.force.map(|f| f * gain);
            felt.torque = felt.torque.map(|t| t * gain);
            felt.flags |= force_flags::RAMPING;
        }
        felt
    }

    /// How long ago the last force came; `None` before the first.
    pub fn silence(&self, now: Instant) -> Option<Duration> {
        let heard = self.heard?;
        Some(now.saturating_duration_since(heard.last))
    }

    fn is_silent(&self, now: Instant) -> bool {
        self.silence(now)
            .is_some_and(|silence| silence > self.limit)
    }

    /// Times without forces so far, with the one that lasts.
    pub fn silences(&self, now: Instant) -> Silences {
        let Some(silence) = self.silence(now).filter(|_| self.is_silent(now)) else {
            return self.silences;
        };
        Silences {
            count: self.silences.count + 1,
            longest_s: self.silences.longest_s.max(silence.as_secs_f64()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn coming(dog: &mut Watchdog, begun: Instant, ms: std::ops::Range<u32>) {
        ms.for_each(|k| dog.heard(begun + k * MS));
    }

    #[test]
    fn the_force_is_zero_within_60_ms_of_the_last_one_and_comes_back_without_a_step() {
        let begun = Instant::now();
        let mut dog = Watchdog::new(false);
        let at = |k: u32| begun + k * MS;
        for k in 0..100 {
            dog.heard(at(k));
            assert_eq!(dog.gain(at(k)), 1.0);
        }
        for k in 99..150 {
            assert_eq!(dog.gain(at(k)), 1.0, "{k}");
        }
        let mut last = 1.0;
        for k in 150..159 {
            let gain = dog.gain(at(k));
            assert!((last - gain - 0.1).abs() < 1e-9, "{k}");
            last = gain;
        }
        for k in 159..1_000 {
            assert_eq!(dog.gain(at(k)), 0.0);
        }
        let mut last = 0.0;
        for k in 1_000..=1_101 {
            dog.heard(at(k));
            let gain = dog.gain(at(k));
            assert!(gain - last < 0.011, "{k}");
            last = gain;
        }
        assert_eq!(last, 1.0);
        let silences = dog.silences(at(1_101));
        assert_eq!(silences.count, 1);
        assert!((silences.longest_s - 0.901).abs() < 1e-9, "{silences:?}");
    }

    // A process that was stopped, or a link that stood still, gets at once what had waited; nobody can say
    // how old that is. If nothing follows it, the daemon has been gone for as long.
    #[test]
    fn forces_that_waited_while_the_client_stood_still_are_not_felt() {
        let begun = Instant::now();
        let mut dog = Watchdog::new(false);
        coming(&mut dog, begun, 0..100);
        let back = begun + 3_000 * MS;
        assert_eq!(dog.gain(back), 0.0);
        for k in 0..200 {
            dog.heard(back + Duration::from_micros(10 * k));
        }
        let most = (0..200)
            .map(|k| dog.gain(back + k * MS))
            .fold(0.0, f64::max);
        assert!(most < 0.021, "{most}");
        assert_eq!(dog.gain(back + 62 * MS), 0.0);
    }

    #[test]
    fn a_silence_that_ends_while_the_force_fades_goes_on_from_there() {
        let begun = Instant::now();
        let mut dog = Watchdog::new(false);
        coming(&mut dog, begun, 0..1);
        coming(&mut dog, begun, 55..56);
        assert!((dog.gain(begun + 55 * MS) - 0.5).abs() < 1e-9);
        coming(&mut dog, begun, 56..107);
        assert!((dog.gain(begun + 80 * MS) - 1.0).abs() < 1e-9);
        assert_eq!(dog.gain(begun + 106 * MS), 1.0);
    }

    #[test]
    fn with_a_deadband_forces_50_ms_apart_are_felt_in_full_and_come_back_without_a_step() {
        let begun = Instant::now();
        let mut dog = Watchdog::new(true);
        for k in 0..20 {
            dog.heard(begun + 55 * k * MS);
            assert_eq!(dog.gain(begun + (55 * k + 54) * MS), 1.0, "{k}");
        }
        let begun = begun + 5_000 * MS;
        let mut last = 0.0;
        for k in 0..200 {
            if k % 50 == 0 {
                dog.heard(begun + k * MS);
            }
            let gain = dog.gain(begun + k * MS);
            assert!((0.0..0.011).contains(&(gain - last)), "{k}");
            last = gain;
        }
        assert_eq!(last, 1.0);
    }

    #[test]
    fn before_the_first_force_nothing_acts_and_nothing_is_missed() {
        let now = Instant::now();
        let dog = Watchdog::new(false);
        assert_eq!((dog.gain(now), dog.silence(now)), (0.0, None));
        assert_eq!(dog.silences(now).count, 0);
    }

    #[test]
    fn who_joins_a_force_that_acts_already_starts_from_nothing() {
        let begun = Instant::now();
        let mut dog = Watchdog::new(false).from_nothing();
        for k in 0..=100 {
            dog.heard(begun + k * MS);
            assert!((dog.gain(begun + k * MS) - f64::from(k) / 100.0).abs() < 0.011);
        }
    }

    #[test]
    fn a_force_felt_in_full_keeps_its_bits_and_one_that_is_not_says_so() {
        let begun = Instant::now();
        let force = ToolForce {
            tick: 7,
            pose_seq: 7,
            t_client_ns: 0,
            t_server_ns: 0,
            force: [0.1 + 0.2, -0.0, 1e-300],
            torque: [0.4, 0.0, 0.0],
            proxy_position: [0.0; 3],
            proxy_orientation: [0.0, 0.0, 0.0, 1.0],
            depth: 0.001,
            contact_count: 1,
            flags: 0,
        };
        let mut dog = Watchdog::new(false);
        dog.heard(begun);
        let felt = dog.felt(&force, begun + 50 * MS);
        assert_eq!(
            (felt, felt.force[1].to_bits()),
            (force, (-0.0f64).to_bits())
        );
        let half = dog.felt(&force, begun + 55 * MS);
        assert!((half.torque[0] - 0.2).abs() < 1e-12);
        assert_eq!(half.flags, force_flags::RAMPING);
        let none = dog.felt(&force, begun + 60 * MS);
        assert_eq!((none.force, none.torque), ([0.0; 3], [0.0; 3]));
    }
}
