//! What identifies a contact row from one tick to the next.
//!
//! A solve starts from the forces of the last tick, and feet that carried stay rows: both need to
//! recognise a row. Samples of the body and of its owner have their index. A foot, the contact point
//! of a query, is numbered within its pair and keeps its number as it goes along with the tool; so
//! is what a tool grabs.
//!
//! In a saved state a key is one 32-bit number:
//!
//! ```text
//! 0 …           Sample      the sample
//! 2³⁰ …         OfOwner     2³⁰ + the sample
//! 2³¹ … + 255   Anchor      2³¹ + the number
//!   … 2³² − 1   Foot        2³² − 1 − the number, below 64
//! ```

use palpate_geometry::math::Coded;
use std::cmp::Ordering;

/// A row within its pair. Ordered as rows are solved: samples, samples of the owner, feet, anchors,
/// feet; the first two by ascending index, the others by descending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKey {
    /// At a sample of the pair's body, by its index in the grid.
    Sample(u32),
    /// At a sample of the owner, which is another body, by its index in that grid.
    OfOwner(u32),
    /// At a contact without four samples around it, by a number below [`FEET_OF_PAIR`].
    Foot(u8),
    /// Where a tool holds on to the body, by the number of the anchor in its grip.
    Anchor(u8),
}

/// Most feet of a pair.
pub const FEET_OF_PAIR: u32 = 64;
const OF_OWNER: u32 = 1 << 30;
const ANCHORS: u32 = 1 << 31;
/// Feet and feet count down from here.
const FIRST_FOOT: u32 = u32::MAX;

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

    /// The `k`-th contact of a pair; from the 64th on they share the last number.
    pub fn foot(k: usize) -> Self {
        Self::Foot(k.min(FEET_OF_PAIR as usize - 1) as u8)
    }

    /// At a contact point, not at a sample nor where a tool holds on: only such a row must remember
    /// where on the body it was.
    pub fn is_foot(self) -> bool {
        matches!(self, Self::Foot(_))
    }

    /// Where a tool holds on to the body.
    pub fn is_anchor(self) -> bool {
        matches!(self, Self::Anchor(_))
    }

    /// The number of this key in a saved state.
    pub fn to_bits(self) -> u32 {
        match self {
            Self::Sample(index) => index,
            Self::OfOwner(index) => OF_OWNER + index,
            Self::Anchor(number) => ANCHORS + u32::from(number),
            Self::Foot(number) => FIRST_FOOT - u32::from(number),
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
                } else {
                    (bits > FIRST_FOOT - FEET_OF_PAIR)
                        .then_some(Self::Foot((FIRST_FOOT - bits) as u8))
                }
            }
        }
    }

    /// Where the kind comes in the order, and where the key comes within it.
    fn rank(self) -> (u8, u32) {
        match self {
            Self::Sample(index) => (0, index),
            Self::OfOwner(index) => (1, index),
            Self::Anchor(number) => (2, !u32::from(number)),
            Self::Foot(number) => (3, !u32::from(number)),
        }
    }
}

impl Coded for RowKey {
    fn code(&self) -> u64 {
        u64::from(self.to_bits())
    }

    fn set_code(&mut self, code: u64) -> bool {
        let key = u32::try_from(code).ok().and_then(Self::from_bits);
        key.map(|key| *self = key).is_some()
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

    const KEYS: [RowKey; 11] = [
        RowKey::Sample(0),
        RowKey::Sample(1),
        RowKey::Sample(OF_OWNER - 1),
        RowKey::OfOwner(0),
        RowKey::OfOwner(OF_OWNER - 1),
        RowKey::Anchor(255),
        RowKey::Anchor(15),
        RowKey::Anchor(0),
        RowKey::Foot(63),
        RowKey::Foot(1),
        RowKey::Foot(0),
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
        for bits in [ANCHORS + 256, FIRST_FOOT - FEET_OF_PAIR] {
            assert_eq!(RowKey::from_bits(bits), None, "{bits:#x}");
        }
    }

    #[test]
    fn rows_come_by_kind_samples_ascending_and_feet_descending() {
        assert!(KEYS.is_sorted());
        let id = |pair, key| RowId { pair, key };
        assert!(id(1, RowKey::Sample(0)) > id(0, RowKey::Foot(0)));
    }
}
