//! Rows of four numbers, each within one line of the cache.
//!
//! A plain `Vec<[f64; 4]>` may start in the middle of a row: every second load or store then
//! touches two lines.

use super::Lane;
use std::ops::{Deref, DerefMut};

/// Rows (x, y, z, …), aligned to 32 bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows(Vec<Row>);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
struct Row(Lane);

impl Rows {
    /// A vector of zeros.
    pub fn zeros(count: usize) -> Self {
        Self(vec![Row::default(); count])
    }
}

impl FromIterator<Lane> for Rows {
    fn from_iter<I: IntoIterator<Item = Lane>>(rows: I) -> Self {
        Self(rows.into_iter().map(Row).collect())
    }
}

impl Deref for Rows {
    type Target = [Lane];
    #[inline]
    #[allow(unsafe_code)]
    fn deref(&self) -> &[Lane] {
        const { assert!(size_of::<Row>() == size_of::<Lane>()) };
        // SAFETY: a row is one lane, in C's layout and without padding, checked above.
        unsafe { std::slice::from_raw_parts(self.0.as_ptr().cast(), self.0.len()) }
    }
}

impl DerefMut for Rows {
    #[inline]
    #[allow(unsafe_code)]
    fn deref_mut(&mut self) -> &mut [Lane] {
        // SAFETY: as above; any numbers make a row.
        unsafe { std::slice::from_raw_parts_mut(self.0.as_mut_ptr().cast(), self.0.len()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_lanes_that_start_at_multiples_of_32_bytes() {
        for count in [0, 1, 7, 100] {
            let mut rows: Rows = (0..count).map(|k| [f64::from(k), 0.5, -1.0, 0.0]).collect();
            assert_eq!(rows.as_ptr() as usize % 32, 0);
            assert_eq!(rows.len(), count as usize);
            for row in rows.iter_mut() {
                row[3] = 2.0 * row[0];
            }
            let copy = rows.clone();
            for (k, row) in (0..count).zip(copy.iter()) {
                assert_eq!(*row, [f64::from(k), 0.5, -1.0, f64::from(2 * k)]);
            }
        }
        assert_eq!(&Rows::zeros(2)[..], &[[0.0; 4]; 2]);
    }
}
