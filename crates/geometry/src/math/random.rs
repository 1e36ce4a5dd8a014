//! Pseudo-random numbers with a fixed sequence, for tests, benches and sampling.

use super::{Rotation, Vector3, rotation_by};

/// SplitMix64 (Steele, Lea & Flood, 2014): one word of state, the same sequence on every machine.
/// The field is the seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In [low, high).
    pub fn float(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In [−1, 1).
    pub fn signed(&mut self) -> f64 {
        self.float(-1.0, 1.0)
    }

    /// In 0 .. count; 0 when `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.word() % count.max(1) as u64) as usize
    }

    /// Each component in [−1, 1).
    pub fn vector(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| self.signed())
    }

    /// A rotation about any axis, by up to 5.2 rad.
    pub fn rotation(&mut self) -> Rotation {
        rotation_by(&(self.vector() * 3.0))
    }

    /// In low ..= high.
    pub fn integer(&mut self, low: usize, high: usize) -> usize {
        low + (self.word() % (high - low + 1) as u64) as usize
    }
}
