//! When the ticks of a played recording are due.

/// Deadlines at a fixed period that are caught up: after a stall a player is quicker for a moment,
/// so that its rate holds. One that cannot keep up plays as fast as it can, and owes no more than a
/// tenth of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Deadlines {
    period_ns: u64,
    next_ns: u64,
}

/// What is later than this is not caught up, ns.
const MOST_OWED_NS: u64 = 100_000_000;

impl Deadlines {
    /// First deadline one period after `now_ns`.
    pub fn new(period_ns: u64, now_ns: u64) -> Self {
        Self {
            period_ns,
            next_ns: now_ns + period_ns,
        }
    }

    /// Next deadline, ns.
    pub fn next_ns(&self) -> u64 {
        self.next_ns
    }

    /// The deadline has passed at `now_ns`: gives how long ago, and goes to the next.
    pub fn pass(&mut self, now_ns: u64) -> u64 {
        let late_ns = now_ns.saturating_sub(self.next_ns);
        self.next_ns = (self.next_ns + self.period_ns).max(now_ns.saturating_sub(MOST_OWED_NS));
        late_ns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_stall_is_caught_up_and_a_long_one_is_not() {
        let mut deadlines = Deadlines::new(1_000_000, 0);
        assert_eq!(deadlines.pass(1_000_000), 0);
        assert_eq!(deadlines.pass(30_000_000), 28_000_000);
        // Twenty-eight more are due at once.
        let burst = (0..).take_while(|_| {
            deadlines.next_ns() <= 30_000_000 && deadlines.pass(30_000_000) < u64::MAX
        });
        assert_eq!(burst.count(), 28);
        assert_eq!(deadlines.next_ns(), 31_000_000);
        deadlines.pass(5_000_000_000);
        assert_eq!(deadlines.next_ns(), 4_900_000_000);
    }
}
