//! Whether the loop keeps its rate, by the clock.
//!
//! A coupling with 1 ms between poses and forces is stiffer than any hand can hold with 30 ms. Below half the
//! rate forces therefore fade here, on their way to devices; the simulation and its recording go on as they are.

use std::time::{Duration, Instant};

/// The rate is measured over so long.
const WINDOW: Duration = Duration::from_millis(250);
/// Below this share of the nominal rate forces fade.
const KEPT: f64 = 0.5;
/// From full force to none.
const FADE_OUT: Duration = Duration::from_millis(50);
/// And back.
const FADE_IN: Duration = Duration::from_millis(250);

/// A change that clients get an event for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RateNews {
    /// The loop is too slow: Hz.
    Lost(f64),
    /// It keeps its rate again.
    Kept,
}

/// Watches the rate of a loop in real time.
#[derive(Clone, Debug)]
pub struct RateWatch {
    nominal_hz: f64,
    /// Begin of the window, once something came.
    since: Option<Instant>,
    ticks: u32,
    /// In the last whole window.
    measured_hz: f64,
    lost: bool,
    gain: f64,
    looked: Option<Instant>,
}

impl RateWatch {
    /// Nothing has come.
    pub fn new(nominal_hz: f64) -> Self {
        Self {
            nominal_hz,
            since: None,
            ticks: 0,
            measured_hz: nominal_hz,
            lost: false,
            gain: 1.0,
            looked: None,
        }
    }

    /// Another tick is done.
    pub fn tick(&mut self, now: Instant) {
        if self.since.is_none() {
            self.since = Some(now);
        }
        self.ticks += 1;
    }

    /// Brings the share of forces up to date; what changed since the last look.
    pub fn look(&mut self, now: Instant) -> Option<RateNews> {
        let since = self.since?;
        let step = self
            .looked
            .replace(now)
            .map_or(Duration::ZERO, |at| now - at);
        let passed = now.saturating_duration_since(since);
        let mut news = None;
        if passed >= WINDOW {
            self.measured_hz = f64::from(self.ticks) / passed.as_secs_f64();
            (self.since, self.ticks) = (Some(now), 0);
            let lost = self.measured_hz < KEPT * self.nominal_hz;
            if lost != self.lost {
                news = Some(match lost {
                    true => RateNews::Lost(self.measured_hz),
                    false => RateNews::Kept,
                });
            }
            self.lost = lost;
        }
        let share = |of: Duration| step.as_secs_f64() / of.as_secs_f64();
        self.gain = match self.lost {
            true => (self.gain - share(FADE_OUT)).max(0.0),
            false => (self.gain + share(FADE_IN)).min(1.0),
        };
        news
    }

    /// The share of forces that devices get.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Ticks a second in the last window; the nominal rate before there was one.
    pub fn measured_hz(&self) -> f64 {
        self.measured_hz
    }

    /// The loop is too slow.
    pub fn is_lost(&self) -> bool {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks at a rate for a time; the bus looks every ms. Gives the news and the end.
    fn run(
        watch: &mut RateWatch,
        from: Instant,
        hz: f64,
        seconds: f64,
    ) -> (Vec<RateNews>, Instant) {
        let (mut news, mut due, mut now) = (Vec::new(), 0.0, from);
        for ms in 0..(seconds * 1e3) as u32 {
            now = from + Duration::from_millis(u64::from(ms));
            while due <= f64::from(ms) * 1e-3 {
                watch.tick(now);
                due += 1.0 / hz;
            }
            news.extend(watch.look(now));
        }
        (news, now)
    }

    #[test]
    fn a_loop_at_34_of_1000_hz_gives_no_force_and_one_that_is_a_little_late_all() {
        let mut watch = RateWatch::new(1_000.0);
        let (news, now) = run(&mut watch, Instant::now(), 900.0, 2.0);
        assert!(news.is_empty() && watch.gain() == 1.0);
        let (news, now) = run(&mut watch, now, 34.0, 1.0);
        assert!(
            matches!(news[..], [RateNews::Lost(hz)] if hz < 500.0),
            "{news:?}"
        );
        assert_eq!(watch.gain(), 0.0);
        assert!(
            (watch.measured_hz() - 34.0).abs() < 6.0,
            "{}",
            watch.measured_hz()
        );
        let (news, _) = run(&mut watch, now, 1_000.0, 1.0);
        assert_eq!(news, [RateNews::Kept]);
        assert_eq!(watch.gain(), 1.0);
    }

    #[test]
    fn a_loop_that_has_not_begun_is_not_slow() {
        let mut watch = RateWatch::new(1_000.0);
        let now = Instant::now();
        for s in 0..5 {
            assert_eq!(watch.look(now + Duration::from_secs(s)), None);
        }
        assert_eq!(watch.gain(), 1.0);
    }
}
