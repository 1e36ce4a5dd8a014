//! Poses of a page on their way to the bus: numbered anew, and sent again while the page is silent.
//!
//! ```text
//! in lockstep    one pose a tick, the newest, for as long as the page holds its tool
//! in real time   each pose as it comes; while none comes the last one again, for half a second
//! ```
//! A page whose frames take 60 ms speaks every 60 ms, and a pose of 50 ms ago is a lost hand. Its hand is
//! still there, and nothing pushes it: so its pose goes on, at rest.

use palpate_proto::messages::ToolPose;
use std::time::{Duration, Instant};

/// A page that has been silent for longer has lost its hand: its pose grows old as any other.
const SILENCE: Duration = Duration::from_millis(500);
/// A page in good health speaks every 8 ms. After twice that its hand is taken to rest: a velocity that
/// goes on where the position does not would make energy.
const MOVES: Duration = Duration::from_millis(16);
/// A bus that was held up for longer is not caught up with.
const CATCH_UP: Duration = Duration::from_millis(100);

/// When poses leave.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pace {
    /// Ticks wait for poses: one each so often.
    Lockstep { every: Duration },
    /// By the clock.
    Realtime {
        /// Between two poses while the page is silent.
        every: Duration,
        /// A pose waits no longer than this.
        most: Duration,
        /// The loop takes what is faster for a jump, m/s.
        fastest_m_s: f64,
    },
}

impl Pace {
    /// In real time, for a tool whose pose is stale after `stale_s`.
    pub(super) fn realtime(stale_s: f64, fastest_m_s: f64) -> Self {
        let share = |n: f64| Duration::try_from_secs_f64(stale_s / n).unwrap_or(SILENCE);
        Self::Realtime {
            // Four of five may be late on a computer that also draws.
            every: share(5.0),
            most: share(2.0),
            fastest_m_s,
        }
    }
}

/// The poses of one tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steady {
    /// The page's newest, with the number under which it was sent last.
    newest: ToolPose,
    heard: Instant,
    /// When and from where the last one left.
    left: (Instant, [f64; 3]),
    due: Instant,
}

impl Steady {
    /// The first pose, which may leave at once.
    pub(super) fn new(pose: &ToolPose, now: Instant) -> Self {
        Self {
            newest: ToolPose { seq: 0, ..*pose },
            heard: now,
            left: (now, pose.position),
            due: now,
        }
    }

    /// The page says where its hand is.
    pub(super) fn take(&mut self, pose: &ToolPose, now: Instant, pace: Pace) {
        let seq = self.newest.seq;
        (self.newest, self.heard) = (ToolPose { seq, ..*pose }, now);
        if let Pace::Realtime {
            most, fastest_m_s, ..
        } = pace
        {
            // The loop measures the way from the pose before, which may have left just now: then this
            // one waits until half the greatest speed covers it.
            let (at, from) = self.left;
            let way = (0..3)
                .map(|c| (pose.position[c] - from[c]).powi(2))
                .sum::<f64>();
            let needed = Duration::try_from_secs_f64(2.0 * way.sqrt() / fastest_m_s);
            self.due = now.max(at + needed.map_or(most, |needed| needed.min(most)));
        }
    }

    /// When the next pose leaves; `None` while the page has been silent for too long.
    pub(super) fn due(&self, pace: Pace) -> Option<Instant> {
        match pace {
            Pace::Lockstep { .. } => Some(self.due),
            Pace::Realtime { .. } => (self.due < self.heard + SILENCE).then_some(self.due),
        }
    }

    /// The pose that leaves now.
    pub(super) fn send(&mut self, now: Instant, pace: Pace) -> ToolPose {
        self.newest.seq += 1;
        self.left = (now, self.newest.position);
        self.due = match pace {
            Pace::Lockstep { every } => {
                let behind = now.checked_sub(CATCH_UP);
                behind.map_or(self.due, |behind| self.due.max(behind)) + every
            }
            Pace::Realtime { every, .. } => now + every,
        };
        let mut pose = self.newest;
        if now.saturating_duration_since(self.heard) >= MOVES {
            (pose.linear_velocity, pose.angular_velocity) = ([0.0; 3], [0.0; 3]);
        }
        pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_client::pose_at;

    const MS: Duration = Duration::from_millis(1);
    const PACE: Pace = Pace::Realtime {
        every: Duration::from_millis(10),
        most: Duration::from_millis(25),
        fastest_m_s: 10.0,
    };

    fn at(x: f64) -> ToolPose {
        ToolPose {
            linear_velocity: [0.25, 0.0, 0.0],
            angular_velocity: [0.0, 1.0, 0.0],
            ..pose_at([x, 0.0, 0.0])
        }
    }

    /// What leaves in `count` ms after `from`, looked at every ms, with the time of each, ms.
    fn run(steady: &mut Steady, from: Instant, count: u32, pace: Pace) -> Vec<(u32, ToolPose)> {
        let mut sent = Vec::new();
        for ms in 0..count {
            let now = from + ms * MS;
            while steady.due(pace).is_some_and(|due| due <= now) {
                sent.push((ms, steady.send(now, pace)));
            }
        }
        sent
    }

    #[test]
    fn a_silent_page_s_pose_goes_on_at_rest_for_half_a_second_under_numbers_that_grow() {
        let start = Instant::now();
        let mut steady = Steady::new(&at(0.1), start);
        let sent = run(&mut steady, start, 2_000, PACE);
        let times: Vec<u32> = sent.iter().map(|(ms, _)| *ms).collect();
        assert_eq!(times[..3], [0, 10, 20]);
        assert!((480..=500).contains(times.last().unwrap()), "{times:?}");
        for (k, (_, pose)) in sent.iter().enumerate() {
            assert_eq!((pose.seq, pose.position), (k as u64 + 1, [0.1, 0.0, 0.0]));
            let moves = pose.linear_velocity != [0.0; 3] || pose.angular_velocity != [0.0; 3];
            // The first repeated one comes before a page in good health would have spoken twice.
            assert_eq!(moves, k < 2, "pose {k}");
        }
        // It speaks again: whatever it counted itself, nothing is out of order.
        let again = start + 2_000 * MS;
        steady.take(&ToolPose { seq: 2, ..at(0.1) }, again, PACE);
        let (ms, pose) = run(&mut steady, again, 10, PACE)[0];
        assert_eq!((ms, pose.seq), (0, sent.len() as u64 + 1));
        assert_eq!(pose.linear_velocity, [0.25, 0.0, 0.0]);
    }

    #[test]
    fn a_page_in_good_health_is_passed_on_as_it_comes() {
        let start = Instant::now();
        let mut steady = Steady::new(&at(0.0), start);
        let mut sent = run(&mut steady, start, 8, PACE);
        for k in 1..100 {
            let now = start + 8 * k * MS;
            // Three metres a second, the fastest of a page.
            steady.take(&at(0.024 * f64::from(k)), now, PACE);
            sent.extend(run(&mut steady, now, 8, PACE));
        }
        assert_eq!(sent.len(), 100);
        assert!(
            sent.iter()
                .all(|(ms, pose)| *ms == 0 && pose.linear_velocity[0] == 0.25)
        );
    }

    // The loop counts ticks from the last pose that it had. After a repeated one that is a millisecond, in
    // which no hand comes as far as one that was not heard for sixty.
    #[test]
    fn a_pose_that_comes_just_after_a_repeated_one_is_no_jump() {
        for gap in 1..=120 {
            let start = Instant::now();
            let mut steady = Steady::new(&at(0.0), start);
            let mut sent = run(&mut steady, start, gap, PACE);
            for k in 1..=4 {
                steady.take(&at(0.02 * f64::from(k)), start + (gap + k) * MS, PACE);
                let more = run(&mut steady, start + (gap + k) * MS, 1, PACE);
                sent.extend(more.into_iter().map(|(ms, pose)| (ms + gap + k, pose)));
            }
            let more = run(&mut steady, start + (gap + 5) * MS, 30, PACE);
            sent.extend(more.into_iter().map(|(ms, pose)| (ms + gap + 5, pose)));
            for pair in sent.windows(2) {
                let ms = f64::from(pair[1].0 - pair[0].0);
                let way = pair[1].1.position[0] - pair[0].1.position[0];
                assert!(way <= 0.010 * ms, "silent for {gap} ms: {way} m in {ms} ms");
            }
            assert_eq!(sent.last().unwrap().1.position[0], 0.08);
        }
    }

    #[test]
    fn in_lockstep_each_tick_has_a_pose_until_the_tool_is_given_back() {
        let start = Instant::now();
        let mut steady = Steady::new(&at(0.1), start);
        let pace = Pace::Lockstep { every: 2 * MS };
        let sent = run(&mut steady, start, 4_000, pace);
        assert_eq!(sent.len(), 2_000);
        let moving = sent
            .iter()
            .filter(|(_, pose)| pose.linear_velocity != [0.0; 3])
            .count();
        assert_eq!(moving, 8, "a hand that is not heard of rests");
        // Held up for ten seconds, it makes up for a tenth of one.
        let late = start + 14_000 * MS;
        let burst = run(&mut steady, late, 1, pace).len();
        assert!((45..=55).contains(&burst), "{burst}");
    }
}
