//! Histograms of durations: fixed memory, one addition a value.

use palpate_sim::tick::stage::{PerStage, Stage, StageTimes};

/// A tick that starts later than this after its deadline counts as late, ns.
pub const LATE_NS: u64 = 100_000;

/// Eight buckets an octave from 1 ns to 2^40 ns: a quantile is right within 1/8.
const PER_OCTAVE: usize = 8;
const OCTAVES: usize = 41;

/// Counts of durations by logarithmic bucket.
#[derive(Clone, Debug)]
pub struct Histogram {
    buckets: [u64; PER_OCTAVE * OCTAVES],
    count: u64,
    max: u64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            buckets: [0; PER_OCTAVE * OCTAVES],
            count: 0,
            max: 0,
        }
    }
}

impl Histogram {
    /// Adds a duration, ns.
    pub fn add(&mut self, ns: u64) {
        let value = ns.clamp(PER_OCTAVE as u64, (1 << (OCTAVES - 1)) - 1);
        let octave = value.ilog2() as usize;
        let step = (value >> (octave - 3)) as usize - PER_OCTAVE;
        self.buckets[octave * PER_OCTAVE + step] += 1;
        self.count += 1;
        self.max = self.max.max(ns);
    }

    /// How many.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The largest, ns.
    pub fn max(&self) -> u64 {
        self.max
    }

    /// Upper end of the bucket in which the quantile `q` (0 ..= 1) lies, at most the maximum, ns; 0
    /// without values.
    pub fn quantile(&self, q: f64) -> u64 {
        let rank = ((q * self.count as f64).ceil() as u64).max(1);
        let mut seen = 0;
        for (k, &bucket) in self.buckets.iter().enumerate() {
            seen += bucket;
            if seen >= rank {
                let (octave, step) = (k / PER_OCTAVE, k % PER_OCTAVE);
                let upper = ((PER_OCTAVE + step + 1) as u64) << (octave - 3);
                return upper.min(self.max);
            }
        }
        self.max
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Durations of the stages of many ticks, and of whole ticks.
#[derive(Clone, Debug, Default)]
pub struct StageHistograms {
    /// By stage, ns.
    pub stages: PerStage<Histogram>,
    /// All stages of a tick together, ns.
    pub whole: Histogram,
}

impl StageHistograms {
    /// Adds a tick.
    pub fn add(&mut self, times: &StageTimes) {
        for stage in Stage::ALL {
            self.stages[stage].add(u64::from(times[stage]));
        }
        self.whole.add(times.total());
    }

    /// Names with histograms: the stages in their order, then `tick` for the whole.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &Histogram)> {
        let stages = Stage::ALL.map(|stage| (stage.name(), &self.stages[stage]));
        stages.into_iter().chain([("tick", &self.whole)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_right_within_an_eighth() {
        let mut histogram = Histogram::default();
        for ns in 1..=100_000u64 {
            histogram.add(ns * 10);
        }
        for q in [0.01, 0.5, 0.9, 0.99, 1.0] {
            let exact = q * 1e6;
            let got = histogram.quantile(q) as f64;
            assert!(
                got >= exact * 0.999 && got <= exact * 1.126,
                "quantile {q}: {got} for {exact}"
            );
        }
        assert_eq!(histogram.max(), 1_000_000);
    }
}
