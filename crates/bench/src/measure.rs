//! Times of single calls.

use std::time::{Duration, Instant};

/// What repeated calls took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    pub median_s: f64,
    pub p99_s: f64,
    pub n: usize,
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
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    Times {
        median_s: at(0.5),
        p99_s: at(0.99),
        n: times.len(),
    }
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
        assert_eq!(time(10, Duration::ZERO, |_| Duration::from_secs(1)).n, 1);
    }
}
