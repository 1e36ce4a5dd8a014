//! What a loop does that cannot keep its rate: less work a tick, in a declared order, and back
//! again.
//!
//! ```text
//! level 0  everything
//! level 1  bodies iterate once a step
//! level 2  also a quarter of the sweeps over contacts
//! level 3  also nets published ten times rarer
//! ```
//! Only decisions are here, no clock: durations come in, levels go out. One level down when a tenth
//! of a window of ticks overran; one level up after a quiet while, which doubles each time it
//! proves too short.

use palpate_sim::tick::quality;
use palpate_sim::tick::stage::{PerStage, Stage, StageTimes};

/// What an overrun is put down to: the stages, then the system that woke a tick a whole period
/// late.
pub const CAUSES: [&str; Stage::COUNT + 1] = {
    let mut causes = ["wake"; Stage::COUNT + 1];
    let mut k = 0;
    while k < Stage::COUNT {
        causes[k] = Stage::ALL[k].name();
        k += 1;
    }
    causes
};
/// Index of the system in [`CAUSES`].
pub const WAKE: usize = Stage::COUNT;
/// No cause: quality came back.
pub const QUIET: usize = usize::MAX;

/// Ticks are judged together over this long, ns.
const WINDOW_NS: u64 = 100_000_000;
/// And over no fewer than this many.
const WINDOW_TICKS: u32 = 20;
/// Part of a window that may overrun: one in so many.
const OVERRUN_SHARE: u32 = 10;
/// A tick that takes more than this part of its period leaves no room for more work.
const BUSY: f64 = 0.7;
/// Part of a quiet window that may be busy: one in so many.
const BUSY_SHARE: u32 = 100;
/// Quiet before quality comes back by a level, in windows: 2 s.
const PATIENCE: u32 = 20;
/// Longest quiet asked for: 64 s.
const MOST_PATIENCE: u32 = 640;

/// A tick that took longer than its period, or was woken as late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun {
    /// Index in [`CAUSES`].
    pub cause: usize,
    /// How long the tick took; of a late wake-up, how late it was, ns.
    pub ns: u64,
}

/// Another level of quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QualityChange {
    /// From now on.
    pub level: u8,
    /// Stage in which most overruns were, as index in [`CAUSES`]; [`QUIET`] when quality comes
    /// back.
    pub cause: usize,
}

/// What a tick's durations mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// It overran.
    pub overrun: Option<Overrun>,
    /// The next tick is to be of another quality.
    pub change: Option<QualityChange>,
}

/// Watches the durations of ticks.
#[derive(Clone, Debug)]
pub struct Overload {
    period_ns: u64,
    window_ticks: u32,
    level: u8,
    /// Of the window: ticks so far, busy ones, overruns by stage.
    ticks: u32,
    busy: u32,
    overruns: PerStage<u32>,
    /// The tick before overran: deadlines that it dropped are its own.
    overran: bool,
    /// Quiet windows in a row.
    quiet: u32,
    /// How many of them bring a level back.
    patience: u32,
    /// Windows since a level came back.
    since_back: u32,
}

impl Overload {
    /// Full quality, at a period.
    pub fn new(period_ns: u64) -> Self {
        let window_ticks =
            (WINDOW_NS / period_ns.max(1)).clamp(u64::from(WINDOW_TICKS), 1_000_000) as u32;
        Self {
            period_ns,
            window_ticks,
            level: 0,
            ticks: 0,
            busy: 0,
            overruns: PerStage::default(),
            overran: false,
            quiet: 0,
            patience: PATIENCE,
            since_back: u32::MAX,
        }
    }

    /// The level now.
    pub fn level(&self) -> u8 {
        self.level
    }

    /// Takes a tick: how late it was woken, how many deadlines were dropped before it, and its
    /// stages' durations.
    pub fn tick(&mut self, late_ns: u64, skipped: u32, stage_ns: &StageTimes) -> Verdict {
        let whole_ns = stage_ns.total();
        let mut verdict = Verdict::default();
        let dropped_by_others = skipped > 0 && !self.overran;
        self.overran = whole_ns > self.period_ns;
        self.ticks += 1;
        self.busy += u32::from(whole_ns as f64 > BUSY * self.period_ns as f64);
        if self.overran {
            let stage = stage_ns.largest();
            self.overruns[stage] += 1;
            verdict.overrun = Some(Overrun {
                cause: stage as usize,
                ns: whole_ns,
            });
        } else if dropped_by_others {
            // Less work would not wake us sooner: counted, but no reason to do less.
            verdict.overrun = Some(Overrun {
                cause: WAKE,
                ns: late_ns,
            });
        }
        let overruns = self.overruns.total();
        if overruns * u64::from(OVERRUN_SHARE) >= u64::from(self.window_ticks) {
            verdict.change = self.worse();
            self.next_window();
        } else if self.ticks >= self.window_ticks {
            let quiet = overruns == 0 && self.busy * BUSY_SHARE <= self.window_ticks;
            self.quiet = if quiet { self.quiet + 1 } else { 0 };
            self.since_back = self.since_back.saturating_add(1);
            verdict.change = self.better();
            self.next_window();
        }
        verdict
    }

    fn worse(&mut self) -> Option<QualityChange> {
        let cause = self.overruns.largest() as usize;
        self.quiet = 0;
        if self.level >= quality::LOWEST {
            return None;
        }
        // Back too soon: wait longer the next time.
        let too_soon = self.since_back < self.patience;
        self.patience = if too_soon {
            (2 * self.patience).min(MOST_PATIENCE)
        } else {
            PATIENCE
        };
        // Further levels down belong to the same overload.
        self.since_back = u32::MAX;
        self.level += 1;
        Some(QualityChange {
            level: self.level,
            cause,
        })
    }

    fn better(&mut self) -> Option<QualityChange> {
        if self.level == 0 || self.quiet < self.patience {
            return None;
        }
        self.level -= 1;
        (self.quiet, self.since_back) = (0, 0);
        Some(QualityChange {
            level: self.level,
            cause: QUIET,
        })
    }

    fn next_window(&mut self) {
        (self.ticks, self.busy, self.overruns) = (0, 0, PerStage::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    /// Runs ticks whose deform stage takes `deform_us` at each level; the changes with the tick at
    /// which they came.
    fn run(
        overload: &mut Overload,
        ticks: u64,
        deform_us: impl Fn(u64, u8) -> u32,
    ) -> Vec<(u64, u8)> {
        let mut changes = Vec::new();
        for tick in 0..ticks {
            let stage_ns = [
                1_000,
                50_000,
                deform_us(tick, overload.level()) * 1_000,
                0,
                9_000,
            ];
            if let Some(change) = overload.tick(0, 0, &stage_ns.into()).change {
                changes.push((tick, change.level));
            }
        }
        changes
    }

    #[test]
    fn an_overrun_is_named_by_the_longest_stage_and_a_late_wake_by_the_system() {
        let mut overload = Overload::new(MS);
        let calm = StageTimes::from([1_000, 100_000, 150_000, 50_000, 5_000]);
        assert_eq!(overload.tick(0, 0, &calm), Verdict::default());
        let long = StageTimes::from([1_000, 900_000, 150_000, 50_000, 5_000]);
        let verdict = overload.tick(0, 0, &long);
        assert_eq!(
            verdict.overrun,
            Some(Overrun {
                cause: 1,
                ns: 1_106_000
            })
        );
        // The deadline that this one dropped is not counted again.
        assert_eq!(overload.tick(106_000, 1, &calm), Verdict::default());
        let woken = overload.tick(3 * MS, 3, &calm);
        assert_eq!(
            woken.overrun,
            Some(Overrun {
                cause: WAKE,
                ns: 3 * MS
            })
        );
        assert_eq!(CAUSES[WAKE], "wake");
        // A tick of exactly a period is none.
        assert_eq!(
            overload.tick(0, 0, &[0, MS as u32, 0, 0, 0].into()).overrun,
            None
        );
    }

    #[test]
    fn a_few_overruns_or_a_slow_system_change_nothing() {
        let mut overload = Overload::new(MS);
        // Nine in a hundred.
        let changes = run(&mut overload, 10_000, |tick, _| {
            if tick % 100 < 9 { 1_500 } else { 300 }
        });
        assert_eq!(changes, []);
        for _ in 0..10_000 {
            assert_eq!(
                overload
                    .tick(2 * MS, 2, &[1_000; Stage::COUNT].into())
                    .change,
                None
            );
        }
        assert_eq!(overload.level(), 0);
    }

    #[test]
    fn quality_falls_level_by_level_to_the_lowest_and_stays_there() {
        let mut overload = Overload::new(MS);
        let changes = run(&mut overload, 1_000, |_, _| 1_500);
        assert_eq!(
            changes,
            [(9, 1), (19, 2), (29, 3)],
            "each after a tenth of a window"
        );
        let mut again = Overload::new(MS);
        let verdicts: Vec<_> = (0..10)
            .map(|_| again.tick(0, 0, &[0, 0, 1_500_000, 0, 0].into()))
            .collect();
        assert_eq!(
            verdicts[9].change,
            Some(QualityChange { level: 1, cause: 2 }),
            "deform is to blame"
        );
    }

    #[test]
    fn quality_comes_back_level_by_level_when_load_goes_and_not_while_ticks_are_nearly_full() {
        let mut overload = Overload::new(MS);
        run(&mut overload, 30, |_, _| 1_500);
        assert_eq!(overload.level(), 3);
        assert_eq!(
            run(&mut overload, 20_000, |_, _| 800),
            [],
            "86 % of the period: no room"
        );
        let changes = run(&mut overload, 10_000, |_, _| 300);
        assert_eq!(
            changes.iter().map(|&(_, level)| level).collect::<Vec<_>>(),
            [2, 1, 0]
        );
        assert_eq!(changes[0].0 + 1, u64::from(PATIENCE) * 100, "two seconds");
        assert_eq!(changes[1].0 - changes[0].0, u64::from(PATIENCE) * 100);
    }

    // Full quality never fits, the first level always does: each try comes after twice the time of
    // the one before.
    #[test]
    fn a_load_between_two_levels_is_tried_ever_more_rarely() {
        let mut overload = Overload::new(MS);
        let load = |_, level| if level == 0 { 1_500 } else { 300 };
        let changes = run(&mut overload, 600_000, load);
        let tries: Vec<u64> = changes
            .iter()
            .filter(|(_, level)| *level == 0)
            .map(|(tick, _)| *tick)
            .collect();
        assert!(
            tries.len() < 16,
            "{} tries in ten minutes: {tries:?}",
            tries.len()
        );
        let gaps: Vec<u64> = tries
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / 1_000)
            .collect();
        assert_eq!(gaps[..5], [4, 8, 16, 32, 64], "{tries:?}");
        assert!(gaps[5..].iter().all(|&gap| gap == 64), "{gaps:?}");
        // Once it has held for long, a new overload is met with the patience of the first.
        run(&mut overload, 200_000, |_, _| 300);
        assert_eq!(overload.level(), 0);
        let changes = run(
            &mut overload,
            3_000,
            |tick, _| if tick < 10 { 1_500 } else { 300 },
        );
        assert_eq!(changes, [(9, 1), (2_009, 0)]);
    }

    #[test]
    fn a_slow_loop_is_judged_over_enough_ticks_and_no_period_breaks_it() {
        let mut slow = Overload::new(50 * MS);
        let changes = run(
            &mut slow,
            40,
            |tick, _| if tick % 10 == 0 { 60_000 } else { 100 },
        );
        assert_eq!(changes.first(), Some(&(10, 1)), "two of twenty");
        for period in [0, 1, u64::MAX] {
            let mut odd = Overload::new(period);
            for _ in 0..100 {
                odd.tick(u64::MAX, u32::MAX, &[u32::MAX; Stage::COUNT].into());
            }
            assert!(odd.level() <= quality::LOWEST);
        }
    }
}
