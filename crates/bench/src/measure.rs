//! Times of single calls.

use std::time::{Duration, Instant};

/// What repeated calls took.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Times {
    /// Median, s.
    pub median_s: f64,
    /// 99th percentile, s.
    pub p99_s: f64,
    /// How many.
    pub n: usize,
}

impl Times {
    /// `None` if there are none.
    pub(super) fn of(mut times_s: Vec<f64>) -> Option<Self> {
        times_s.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = times_s.len().checked_sub(1)?;
            times_s.get((last as f64 * share) as usize).copied()
        };
        Some(Self {
            median_s: at(0.5)?,
            p99_s: at(0.99)?,
            n: times_s.len(),
        })
    }
}

/// Times each of at most `n` calls, which are numbered; stops early when `patience` is over, for
/// peers that take long.
pub(super) fn time(n: usize, patience: Duration, mut call: impl FnMut(usize) -> Duration) -> Times {
    let start = Instant::now();
    let mut times = Vec::with_capacity(n);
    for k in 0..n {
        times.push(call(k).as_secs_f64());
        if start.elapsed() > patience {
            break;
        }
    }
    Times::of(times).expect("at least one call is asked for")
}

/// The time that `work` takes, and its answer.
pub(super) fn clocked<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let answer = std::hint::black_box(work());
    (start.elapsed(), answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_given_times() {
        let times = time(101, Duration::MAX, |k| {
            Duration::from_millis(100 - k as u64)
        });
        assert_eq!((times.median_s, times.p99_s, times.n), (0.05, 0.099, 101));
    }

    #[test]
    fn a_call_without_patience_is_still_timed_once() {
        let times = time(10, Duration::ZERO, |_| Duration::from_secs(1));
        assert_eq!(times.n, 1);
        assert_eq!(Times::of(Vec::new()), None);
    }
}
