//! What identifies a contact row from one tick to the next.
//!
//! A solve starts from the forces of the last tick, and feet that carried stay rows: both need to
//! recognise a row. Samples of the body and of its owner have their index. A foot between four
//! samples is named after the first of them, so that it keeps its key while it rolls between them.
//! A foot that has no samples around it is numbered within its pair, and so is what a tool grabs.
//!
//! In a saved state a key is one 32-bit number:
//!
//! ```text
//! 0 …           Sample      the sample
//! 2³⁰ …         OfOwner     2³⁰ + the sample
//! 2³¹ … + 255   Anchor      2³¹ + the number
//!   … 2³² − 65  Foot        2³² − 65 − the sample, at most 2²⁸ − 64 of them
//!   … 2³² − 1   Loose       2³² − 1 − the number, below 64
//! ```

use std::cmp::Ordering;

/// A row within its pair. Ordered as rows are solved: samples, samples of the owner, feet, anchors,
/// loose feet; the first two by ascending index, the others by descending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKey {
    /// At a sample of the pair's body, by its index in the grid.
    Sample(u32),
    /// At a sample of the owner, which is another body, by its index in that grid.
    OfOwner(u32),
    /// At a contact between four samples of the body, by the index of the first.
    Foot(u32),
    /// At a contact without four samples around it, by a number below [`LOOSE_FEET`].
    Loose(u8),
    /// Where a tool holds on to the body, by the number of the anchor in its grip.
    Anchor(u8),
}

/// Most loose feet of a pair.
pub const LOOSE_FEET: u32 = 64;
/// Most samples of a grid that feet are named after.
const FOOT_SAMPLES: u32 = (1 << 28) - LOOSE_FEET;
const OF_OWNER: u32 = 1 << 30;
const ANCHORS: u32 = 1 << 31;
/// Feet and loose feet count down from here.
const FIRST_LOOSE: u32 = u32::MAX;
const FIRST_FOOT: u32 = FIRST_LOOSE - LOOSE_FEET;

impl RowKey {
    /// At a sample of the pair's body.
    pub fn sample(index: usize) -> Self {
        debug_assert!(index < OF_OWNER as usize, "sample {index} has no key");
        Self::Sample(index as u32)
    }

    /// At a sample of the owner.
    pub fn of_owner(index: usize) -> Self {
        debug_assert!(index < OF_OWNER as usize, "sample {index} has no key");
        Self::OfOwner(index as u32)
    }

    /// At the `k`-th contact of a pair, which lies between the samples `around`, if there are any.
    /// From the 64th on, loose feet share the last number.
    pub fn foot(k: usize, around: Option<[usize; 4]>) -> Self {
        match around {
            Some([first, ..]) => {
                debug_assert!(first < FOOT_SAMPLES as usize, "foot {first} has no key");
                Self::Foot(first as u32)
            }
            None => Self::loose(k),
        }
    }

    /// The `k`-th contact of a pair without samples around it; from the 64th on they share the last
    /// number.
    pub fn loose(k: usize) -> Self {
        Self::Loose(k.min(LOOSE_FEET as usize - 1) as u8)
    }

    /// At a contact point, not at a sample nor where a tool holds on: only such a row must remember
    /// where on the body it was.
    pub fn is_foot(self) -> bool {
        matches!(self, Self::Foot(_) | Self::Loose(_))
    }

    /// The number of this key in a saved state.
    pub fn to_bits(self) -> u32 {
        match self {
            Self::Sample(index) => index,
            Self::OfOwner(index) => OF_OWNER + index,
            Self::Anchor(number) => ANCHORS + u32::from(number),
            Self::Foot(index) => FIRST_FOOT - index,
            Self::Loose(number) => FIRST_LOOSE - u32::from(number),
        }
    }

    /// The key with that number, if there is one.
    pub fn from_bits(bits: u32) -> Option<Self> {
        match bits {
            ..OF_OWNER => Some(Self::Sample(bits)),
            OF_OWNER..ANCHORS => Some(Self::OfOwner(bits - OF_OWNER)),
            ANCHORS.. => {
                if let Ok(number) = u8::try_from(bits - ANCHORS) {
                    Some(Self::Anchor(number))
                } else if bits > FIRST_FOOT {
                    Some(Self::Loose((FIRST_LOOSE - bits) as u8))
                } else {
                    let first = FIRST_FOOT - bits;
                    (first < FOOT_SAMPLES).then_some(Self::Foot(first))
                }
            }
        }
    }

    /// Where the kind comes in the order, and where the key comes within it.
    fn rank(self) -> (u8, u32) {
        match self {
            Self::Sample(index) => (0, index),
            Self::OfOwner(index) => (1, index),
            Self::Foot(index) => (2, !index),
            Self::Anchor(number) => (3, !u32::from(number)),
            Self::Loose(number) => (4, !u32::from(number)),
        }
    }
}

impl Ord for RowKey {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank().cmp(&other.rank())
    }
}

impl PartialOrd for RowKey {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A row among all rows of a tick; rows are ordered by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RowId {
    /// Pair of the plan.
    pub pair: u32,
    /// Which of its rows.
    pub key: RowKey,
}

impl Default for RowId {
    fn default() -> Self {
        Self {
            pair: 0,
            key: RowKey::Sample(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [RowKey; 15] = [
        RowKey::Sample(0),
        RowKey::Sample(1),
        RowKey::Sample(OF_OWNER - 1),
        RowKey::OfOwner(0),
        RowKey::OfOwner(OF_OWNER - 1),
        RowKey::Foot(FOOT_SAMPLES - 1),
        RowKey::Foot(16),
        RowKey::Foot(15),
        RowKey::Foot(0),
        RowKey::Anchor(255),
        RowKey::Anchor(15),
        RowKey::Anchor(0),
        RowKey::Loose(63),
        RowKey::Loose(1),
        RowKey::Loose(0),
    ];

    #[test]
    fn every_key_has_a_number_of_its_own_and_comes_back_from_it() {
        for (i, key) in KEYS.into_iter().enumerate() {
            assert_eq!(
                RowKey::from_bits(key.to_bits()),
                Some(key),
                "{:#x}",
                key.to_bits()
            );
            for other in &KEYS[..i] {
                assert_ne!(key.to_bits(), other.to_bits(), "{key:?} and {other:?}");
            }
        }
        for bits in [ANCHORS + 256, FIRST_FOOT - FOOT_SAMPLES] {
            assert_eq!(RowKey::from_bits(bits), None, "{bits:#x}");
        }
    }

    #[test]
    fn rows_come_by_kind_samples_ascending_and_feet_descending() {
        assert!(KEYS.is_sorted());
        let id = |pair, key| RowId { pair, key };
        assert!(id(1, RowKey::Sample(0)) > id(0, RowKey::Loose(0)));
    }
}
