//! When ticks are due.

/// Deadlines at a period, which can be moved. A late tick keeps the next deadline; deadlines that have
/// passed whole are dropped, never caught up in a burst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    period_ns: u64,
    next_ns: u64,
    /// How far deadlines have moved.
    shift_ns: i64,
}

/// What a wake-up found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wake {
    /// How long after its deadline, ns.
    pub late_ns: u64,
    /// Deadlines dropped.
    pub skipped: u32,
    /// How much later it was due than on the grid of the first deadline, ns; a tick that begins before its
    /// deadline is due when it begins.
    pub shift_ns: i64,
}

impl Schedule {
    /// First deadline one period after `now_ns`.
    pub fn new(period_ns: u64, now_ns: u64) -> Self {
        Self {
            period_ns,
            next_ns: now_ns + period_ns,
            shift_ns: 0,
        }
    }

    /// Next deadline, ns.
    pub fn next_ns(&self) -> u64 {
        self.next_ns
    }

    /// Moves the next deadline, and with it all that follow.
    pub fn shift(&mut self, by_ns: i64) {
        self.next_ns = self.next_ns.saturating_add_signed(by_ns);
        self.shift_ns += by_ns;
    }

    /// A tick begins at `now_ns`.
    pub fn wake(&mut self, now_ns: u64) -> Wake {
        let late_ns = now_ns.saturating_sub(self.next_ns);
        let early_ns = self.next_ns.saturating_sub(now_ns);
        let skipped = late_ns / self.period_ns;
        self.next_ns += (skipped + 1) * self.period_ns;
        Wake {
            late_ns,
            skipped: skipped.min(u64::from(u32::MAX)) as u32,
            shift_ns: self.shift_ns - early_ns as i64,
        }
    }
}

/// Monotonic clock, ns.
#[allow(unsafe_code)]
pub fn now_ns() -> u64 {
    let mut t = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `t` is a valid timespec; CLOCK_MONOTONIC always exists on Linux.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut t) };
    t.tv_sec as u64 * 1_000_000_000 + t.tv_nsec as u64
}

/// Sleeps until an absolute time of [`now_ns`]; signals do not cut it short.
#[allow(unsafe_code)]
pub fn sleep_until(deadline_ns: u64) {
    let t = libc::timespec {
        tv_sec: (deadline_ns / 1_000_000_000) as libc::time_t,
        tv_nsec: (deadline_ns % 1_000_000_000) as libc::c_long,
    };
    // SAFETY: `t` is a valid timespec and the remainder pointer may be null with TIMER_ABSTIME.
    while unsafe {
        libc::clock_nanosleep(
            libc::CLOCK_MONOTONIC,
            libc::TIMER_ABSTIME,
            &t,
            std::ptr::null_mut(),
        )
    } == libc::EINTR
    {}
}

/// What the operating system granted the calling thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Privileges {
    /// SCHED_FIFO.
    pub fifo: bool,
    /// Memory locked.
    pub locked: bool,
    /// Timer slack of 1 ns.
    pub slack: bool,
}

/// Asks for what a tick thread wants: FIFO scheduling, locked memory, exact timers. A refusal is no
/// error.
#[allow(unsafe_code)]
pub fn ask_privileges() -> Privileges {
    let param = libc::sched_param { sched_priority: 60 };
    // SAFETY: plain system calls with valid arguments, acting on the calling thread (slack,
    // scheduler) or process (lock).
    unsafe {
        Privileges {
            fifo: libc::sched_setscheduler(0, libc::SCHED_FIFO, &param) == 0,
            locked: libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) == 0,
            slack: libc::prctl(libc::PR_SET_TIMERSLACK, 1, 0, 0, 0) == 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_tick_keeps_the_next_deadline() {
        let mut schedule = Schedule::new(1_000, 0);
        assert_eq!(
            schedule.wake(1_400),
            Wake {
                late_ns: 400,
                ..Wake::default()
            }
        );
        assert_eq!(schedule.next_ns(), 2_000);
    }

    #[test]
    fn passed_deadlines_are_dropped_and_never_caught_up() {
        let mut schedule = Schedule::new(1_000, 0);
        assert_eq!(
            schedule.wake(4_700),
            Wake {
                late_ns: 3_700,
                skipped: 3,
                shift_ns: 0
            }
        );
        assert_eq!(
            schedule.next_ns(),
            5_000,
            "the next deadline is on the grid and ahead"
        );
        assert_eq!(schedule.wake(5_000), Wake::default());
    }

    #[test]
    fn moved_deadlines_and_early_ticks_say_how_far_they_are_from_the_grid() {
        let mut schedule = Schedule::new(1_000, 0);
        schedule.shift(-20);
        let late = Wake {
            late_ns: 30,
            skipped: 0,
            shift_ns: -20,
        };
        assert_eq!(schedule.wake(1_010), late);
        schedule.shift(5);
        let early = Wake {
            shift_ns: -115,
            ..Wake::default()
        };
        assert_eq!(schedule.wake(1_885), early);
        assert_eq!(schedule.next_ns(), 2_985);
    }

    #[test]
    fn sleeping_ends_at_or_after_the_deadline() {
        let deadline = now_ns() + 2_000_000;
        sleep_until(deadline);
        assert!(now_ns() >= deadline);
    }
}
