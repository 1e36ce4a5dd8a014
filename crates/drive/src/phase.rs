//! Where in a period poses arrive, and where deadlines have to lie for ticks to take them fresh.
//!
//! ```text
//!            poses of a tool, period by period              deadline
//! ───┬──────────────·:·:::::·:··──────────────────────────────┬─────▶ one period
//!    │              ╰── arc ───╯◀─ margin ─▶┊ target  ◀── 20 µs a tick
//!                   ╰── early: a tick begins here as soon as all poses are there
//! ```
//! A device sends at a rate of its own, and half a period passes on average between its pose and the
//! next tick of a clock that knows nothing of it. Here deadlines move, a little each tick, until they
//! lie just after the poses. A tick stays as long for the simulation as it was: what changes is when it
//! is computed, so recordings and replays know nothing of it.

/// Arrivals by which a tool is judged.
const SEEN: usize = 128;
/// New ones after which it is judged again.
const RENEWED: u32 = 32;
/// Part of the arrivals that may come after the deadline: one in so many.
const OUTLIERS: usize = 100;
/// From the last arrivals to the deadline, at most, ns; a fifth of a period where that is less.
const MARGIN_NS: u64 = 50_000;
/// Farthest that a deadline moves in a tick, ns; a fiftieth of a period where that is less.
const MOST_A_TICK_NS: u64 = 20_000;
/// A deadline that is nearer to its target than this stays, ns.
const NEAR_NS: i64 = 10_000;
/// In the long run deadlines move by one part in so many of the time: clocks of devices differ by less,
/// and a client that answers forces is not chased.
const LONG_RUN: u64 = 1_000;
/// A tool without a pose for so many periods is not waited for.
const SILENT_PERIODS: u64 = 100;

/// Part of a period in which nearly all poses of a tool arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cluster {
    /// Place in the period at which it ends, ns.
    end_ns: u64,
    length_ns: u64,
}

/// A tool's arrivals, as places in the period.
#[derive(Clone, Debug)]
struct Arrivals {
    /// The newest, ns, in no order.
    places_ns: [u32; SEEN],
    count: usize,
    /// Since the arc was found.
    fresh: u32,
    last_ns: u64,
    /// None where poses come at any time of the period, or too few have come.
    arc: Option<Cluster>,
}

impl Arrivals {
    const NONE: Self = Self {
        places_ns: [0; SEEN],
        count: 0,
        fresh: 0,
        last_ns: 0,
        arc: None,
    };

    /// True when it was judged anew.
    fn add(&mut self, at_ns: u64, place_ns: u32, period_ns: u64) -> bool {
        self.places_ns[self.count % SEEN] = place_ns;
        self.count += 1;
        self.fresh += 1;
        self.last_ns = at_ns;
        if self.fresh < RENEWED {
            return false;
        }
        self.fresh = 0;
        let seen = self.count.min(SEEN);
        self.arc = shortest_arc(&self.places_ns[..seen], period_ns)
            .filter(|arc| arc.length_ns <= period_ns / 2);
        true
    }
}

/// The shortest arc of a circle that holds all places but one in [`OUTLIERS`].
fn shortest_arc(places_ns: &[u32], period_ns: u64) -> Option<Cluster> {
    let mut sorted = [0; SEEN];
    let sorted = &mut sorted[..places_ns.len()];
    sorted.copy_from_slice(places_ns);
    sorted.sort_unstable();
    let inside = sorted.len() - sorted.len() / OUTLIERS;
    let arc = |first: usize| {
        let end_ns = u64::from(sorted[(first + inside - 1) % sorted.len()]);
        let length_ns = (end_ns + period_ns - u64::from(sorted[first])) % period_ns;
        Cluster { end_ns, length_ns }
    };
    (0..sorted.len()).map(arc).min_by_key(|arc| arc.length_ns)
}

/// Where deadlines are to lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Target {
    /// The tool behind whose poses they lie.
    tool: usize,
    /// Place in the period, ns.
    place_ns: u64,
    /// How long before a deadline its tick may begin, ns.
    early_ns: u64,
}

/// Moves deadlines to where poses come. Allocates nothing after the start.
#[derive(Clone, Debug)]
pub struct Follower {
    period_ns: u64,
    tools: Vec<Arrivals>,
    target: Option<Target>,
    /// How far deadlines may still move, ns.
    allowance_ns: u64,
}

impl Follower {
    /// Of so many tools; follows none before it has seen some of its poses.
    pub fn new(period_ns: u64, tool_count: usize) -> Self {
        Self {
            period_ns,
            tools: vec![Arrivals::NONE; tool_count],
            target: None,
            allowance_ns: period_ns,
        }
    }

    /// A tick took a pose of this tool that had arrived then, ns of the monotonic clock.
    pub fn saw(&mut self, tool: usize, arrived_ns: u64) {
        let place_ns = (arrived_ns % self.period_ns) as u32;
        if self.tools[tool].add(arrived_ns, place_ns, self.period_ns) {
            self.aim();
        }
    }

    /// The tool whose poses deadlines follow.
    pub fn followed(&self) -> Option<usize> {
        self.target.map(|target| target.tool)
    }

    /// Poses of this tool come shortly before deadlines: ticks wait for them.
    pub fn waits_for(&self, tool: usize) -> bool {
        let ends = self.target.zip(self.tools[tool].arc);
        ends.is_some_and(|(target, arc)| {
            (target.place_ns + self.period_ns - arc.end_ns) % self.period_ns <= target.early_ns
        })
    }

    /// How long before a deadline its tick may begin: when all poses that it waits for have come since, ns.
    pub fn early_ns(&self) -> u64 {
        self.target.map_or(0, |target| target.early_ns)
    }

    /// How far the deadline `next_ns` is to move now, ns.
    pub fn step(&mut self, next_ns: u64) -> i64 {
        self.allowance_ns = (self.allowance_ns + self.period_ns / LONG_RUN).min(self.period_ns);
        self.forget_silent(next_ns);
        let Some(target) = self.target else {
            return 0;
        };
        let period_ns = self.period_ns as i64;
        let ahead_ns =
            (target.place_ns as i64 - (next_ns % self.period_ns) as i64).rem_euclid(period_ns);
        let off_ns = if ahead_ns > period_ns / 2 {
            ahead_ns - period_ns
        } else {
            ahead_ns
        };
        if off_ns.abs() < NEAR_NS {
            return 0;
        }
        let most_ns = MOST_A_TICK_NS
            .min(self.period_ns / 50)
            .min(self.allowance_ns) as i64;
        let step_ns = off_ns.clamp(-most_ns, most_ns);
        self.allowance_ns -= step_ns.unsigned_abs();
        step_ns
    }

    fn forget_silent(&mut self, next_ns: u64) {
        let silent_ns = SILENT_PERIODS * self.period_ns;
        let mut gone = false;
        for tool in &mut self.tools {
            if tool.count > 0 && next_ns.saturating_sub(tool.last_ns) > silent_ns {
                gone |= tool.arc.is_some();
                *tool = Arrivals::NONE;
            }
        }
        if gone {
            self.aim();
        }
    }

    /// Chooses the tool behind whose poses all tools together wait least. One that is followed stays so
    /// unless another is better by a twentieth of a period.
    fn aim(&mut self) {
        let margin_ns = MARGIN_NS.min(self.period_ns / 5);
        let waits_ns = |place_ns: u64| -> u64 {
            let arcs = self.tools.iter().filter_map(|tool| tool.arc);
            arcs.map(|arc| (place_ns + self.period_ns - arc.end_ns) % self.period_ns)
                .sum()
        };
        let mut best: Option<(u64, Target)> = None;
        for (tool, arrivals) in self.tools.iter().enumerate() {
            let Some(arc) = arrivals.arc else { continue };
            let place_ns = (arc.end_ns + margin_ns) % self.period_ns;
            let favour_ns = if self.followed() == Some(tool) {
                self.period_ns / 20
            } else {
                0
            };
            let cost_ns = waits_ns(place_ns).saturating_sub(favour_ns);
            if best.is_none_or(|(least_ns, _)| cost_ns < least_ns) {
                let early_ns = arc.length_ns + margin_ns + margin_ns / 2;
                let target = Target {
                    tool,
                    place_ns,
                    early_ns,
                };
                best = Some((cost_ns, target));
            }
        }
        self.target = best.map(|(_, target)| target);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    const PERIOD_NS: u64 = 1_000_000;

    /// Devices that send on clocks of their own, and the loop that follows them.
    struct Run {
        follower: Follower,
        next_ns: u64,
        /// Of each tool: period and the next pose's place without and with its jitter, ns.
        devices: Vec<(u64, u64)>,
        jitter_ns: u64,
        random: Random,
        pending: Vec<Vec<u64>>,
    }

    impl Run {
        fn new(devices: &[(u64, u64)], jitter_ns: u64) -> Self {
            Self {
                follower: Follower::new(PERIOD_NS, devices.len()),
                next_ns: 5 * PERIOD_NS,
                devices: devices.to_vec(),
                jitter_ns,
                random: Random(7),
                pending: vec![Vec::new(); devices.len()],
            }
        }

        /// One tick: by tool how long its newest pose waited, ns, and how far the deadline moved.
        fn tick(&mut self) -> (Vec<Option<u64>>, i64) {
            let deadline = self.next_ns;
            for (t, (period, next)) in self.devices.iter_mut().enumerate() {
                while *next <= deadline {
                    let late = (self.random.unit() * self.jitter_ns as f64) as u64;
                    self.pending[t].push(*next + late);
                    *next += *period;
                }
            }
            let waits_for: Vec<bool> = (0..self.pending.len())
                .map(|t| self.follower.waits_for(t))
                .collect();
            let opens = deadline - self.follower.early_ns();
            let since = |poses: &Vec<u64>| {
                let mut since = poses
                    .iter()
                    .copied()
                    .filter(|at| (opens..deadline).contains(at));
                since.next().unwrap_or(deadline)
            };
            let latest = (self.pending.iter().zip(&waits_for))
                .filter(|(_, wanted)| **wanted)
                .map(|(poses, _)| since(poses))
                .max();
            let begins = latest.unwrap_or(deadline);
            let mut waits = Vec::new();
            for t in 0..self.pending.len() {
                let (here, later): (Vec<u64>, Vec<u64>) =
                    self.pending[t].iter().partition(|at| **at <= begins);
                self.pending[t] = later;
                waits.push(here.last().map(|at| begins - at));
                if let Some(at) = here.last() {
                    self.follower.saw(t, *at);
                }
            }
            let step = self.follower.step(self.next_ns + PERIOD_NS);
            self.next_ns = (self.next_ns + PERIOD_NS).saturating_add_signed(step);
            (waits, step)
        }

        /// Waits of a tool in so many ticks, sorted.
        fn waits(&mut self, tool: usize, ticks: usize) -> Vec<u64> {
            let mut waits: Vec<u64> = (0..ticks).filter_map(|_| self.tick().0[tool]).collect();
            waits.sort_unstable();
            waits
        }
    }

    #[test]
    fn ticks_come_just_after_the_poses_of_a_device_wherever_it_began() {
        for (start, jitter) in [
            (0, 0),
            (130_000, 80_000),
            (500_000, 200_000),
            (999_000, 40_000),
        ] {
            for period in [
                PERIOD_NS,
                PERIOD_NS + 50,
                PERIOD_NS - 300,
                2 * PERIOD_NS,
                PERIOD_NS / 4,
            ] {
                let mut run = Run::new(&[(period, start)], jitter);
                run.waits(0, 2_000);
                let waits = run.waits(0, 4_000);
                let (median, p99) = (waits[waits.len() / 2], waits[waits.len() * 98 / 100]);
                assert!(
                    median <= 60_000 + jitter / 4 && p99 <= 100_000 + jitter,
                    "from {start}, every {period}, ± {jitter}: waits {median} and {p99} ns"
                );
            }
        }
    }

    #[test]
    fn deadlines_move_by_20_us_a_tick_at_most_and_by_a_thousandth_in_the_long_run() {
        // A client that sends 300 µs after each tick runs away from any deadline.
        let mut run = Run::new(&[], 0);
        run.follower = Follower::new(PERIOD_NS, 1);
        let begun = run.next_ns;
        let mut moved = 0;
        for _ in 0..20_000 {
            run.follower.saw(0, run.next_ns - 700_000);
            let step = run.follower.step(run.next_ns + PERIOD_NS);
            assert!(step.unsigned_abs() <= 20_000);
            moved += step.unsigned_abs();
            run.next_ns = (run.next_ns + PERIOD_NS).saturating_add_signed(step);
        }
        let elapsed = run.next_ns - begun;
        assert!(
            moved <= elapsed / LONG_RUN + 2 * PERIOD_NS,
            "{moved} of {elapsed} ns"
        );
    }

    #[test]
    fn poses_that_come_at_any_time_are_not_followed() {
        let mut run = Run::new(&[(1_370_000, 0)], 0);
        for _ in 0..5_000 {
            assert_eq!(run.tick().1, 0);
        }
        assert_eq!(
            (run.follower.followed(), run.follower.early_ns()),
            (None, 0)
        );
    }

    #[test]
    fn of_several_tools_the_last_of_a_cluster_is_followed_and_a_silent_one_forgotten() {
        // Two poses 150 µs apart, and one that comes at any time.
        let mut run = Run::new(
            &[(PERIOD_NS, 200_000), (PERIOD_NS, 350_000), (1_370_000, 0)],
            20_000,
        );
        run.waits(0, 3_000);
        assert_eq!(run.follower.followed(), Some(1));
        assert!(run.waits(0, 1_000)[500] < 250_000 && run.waits(1, 1_000)[500] < 60_000);
        run.devices[1] = (PERIOD_NS, u64::MAX);
        run.waits(0, 3_000);
        assert_eq!(run.follower.followed(), Some(0));
        assert!(run.waits(0, 1_000)[500] < 60_000);
    }
}
