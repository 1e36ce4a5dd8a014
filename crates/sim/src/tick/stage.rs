//! The stages of a tick: their order, their names and their times.
//!
//! ```text
//! Latch    newest pose of each tool taken                                     the driver
//! Render   poses admitted, contacts, forces: they are known at its end        admit gather balance iterate emit
//! Deform   bodies moved, their next free motion predicted                     motion
//! Hash     all state hashed                                                   step
//! Emit     results handed to bus and recorder                                 the driver
//! ```

use std::ops::{Index, IndexMut};

/// A stage of a tick, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(usize)]
pub enum Stage {
    /// The newest poses are taken.
    Latch,
    /// Poses admitted, contacts, coupling and force: the force is known at its end.
    Render,
    /// Bodies moved, their next free motion predicted.
    Deform,
    /// The state hashed.
    Hash,
    /// Results handed over.
    Emit,
}

impl Stage {
    /// Number of stages.
    pub const COUNT: usize = Self::ALL.len();
    /// All stages, in order.
    pub const ALL: [Self; 5] = [
        Self::Latch,
        Self::Render,
        Self::Deform,
        Self::Hash,
        Self::Emit,
    ];

    /// Its name in events, tables and metrics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Latch => "latch",
            Self::Render => "render",
            Self::Deform => "deform",
            Self::Hash => "hash",
            Self::Emit => "emit",
        }
    }
}

/// A value for each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PerStage<T>([T; Stage::COUNT]);

/// How long each stage of a tick took, ns.
pub type StageTimes = PerStage<u32>;

impl<T> PerStage<T> {
    /// The values, in the order of the stages.
    pub fn values(&self) -> &[T; Stage::COUNT] {
        &self.0
    }
}

impl PerStage<u32> {
    /// Sum over all stages.
    pub fn total(&self) -> u64 {
        self.0.iter().map(|&value| u64::from(value)).sum()
    }

    /// Stage of the largest value, the first of equal ones.
    pub fn largest(&self) -> Stage {
        Stage::ALL.into_iter().fold(Stage::Latch, |best, stage| {
            if self[stage] > self[best] {
                stage
            } else {
                best
            }
        })
    }

    /// Times as they are recorded: a list in the order of the stages. Recordings of versions that
    /// counted the hash as part of `deform` have four.
    pub fn from_recorded(times: &[u32]) -> Self {
        let stages: &[Stage] = match times.len() {
            4 => &[Stage::Latch, Stage::Render, Stage::Deform, Stage::Emit],
            _ => &Stage::ALL,
        };
        let mut out = Self::default();
        for (&stage, &ns) in stages.iter().zip(times) {
            out[stage] = ns;
        }
        out
    }
}

impl<T> From<[T; Stage::COUNT]> for PerStage<T> {
    fn from(values: [T; Stage::COUNT]) -> Self {
        Self(values)
    }
}

impl<T> Index<Stage> for PerStage<T> {
    type Output = T;
    fn index(&self, stage: Stage) -> &T {
        &self.0[stage as usize]
    }
}

impl<T> IndexMut<Stage> for PerStage<T> {
    fn index_mut(&mut self, stage: Stage) -> &mut T {
        &mut self.0[stage as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_listed_in_their_order() {
        assert!(Stage::ALL.is_sorted());
        for (k, stage) in Stage::ALL.into_iter().enumerate() {
            assert_eq!(stage as usize, k, "{}", stage.name());
        }
    }

    #[test]
    fn times_of_a_recording_come_back_also_where_the_hash_had_none() {
        let times = StageTimes::from([1, 2, 3, 4, 5]);
        assert_eq!(StageTimes::from_recorded(times.values()), times);
        let old = StageTimes::from_recorded(&[1, 2, 7, 5]);
        assert_eq!(old, StageTimes::from([1, 2, 7, 0, 5]));
        assert_eq!((old.total(), old.largest()), (15, Stage::Deform));
        assert_eq!(StageTimes::from_recorded(&[]), StageTimes::default());
    }
}
