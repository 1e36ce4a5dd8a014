//! Numbers kept in half precision, and how eight of them are read.

use crate::math::eight::Eight;

/// A number of a factor as it lies in memory.
pub(super) trait Stored: Copy {
    fn eight<E: Eight>(from: &[Self; 8]) -> E;
}

impl Stored for f32 {
    #[inline(always)]
    fn eight<E: Eight>(from: &[Self; 8]) -> E {
        E::load(from)
    }
}

impl Stored for u16 {
    #[inline(always)]
    fn eight<E: Eight>(from: &[Self; 8]) -> E {
        E::widen(from)
    }
}

/// Each number to the nearest of half precision, to even at a tie. Numbers beyond its range keep their
/// sign and become the largest, those below its smallest become zero.
pub(super) fn halved(numbers: &[f32]) -> Vec<u16> {
    numbers.iter().map(|&x| half_of(x)).collect()
}

/// Largest finite number of half precision.
const LARGEST: f32 = 65504.0;
/// Smallest normal number of half precision.
const SMALLEST_NORMAL: f32 = 1.0 / 16384.0;

fn half_of(x: f32) -> u16 {
    let sign = ((x.to_bits() >> 16) & 0x8000) as u16;
    let size = x.abs().min(LARGEST);
    let bits = if size < SMALLEST_NORMAL {
        // Multiples of 2^-24; the sum rounds to one of them.
        let aligned = size + 0.5;
        (aligned.to_bits() - 0.5f32.to_bits()) as u16
    } else {
        // The exponent is biased by 15 instead of 127; half of the last kept place rounds.
        let bits = size.to_bits();
        let odd = (bits >> 13) & 1;
        ((bits + 0xfff + odd - (112 << 23)) >> 13) as u16
    };
    sign | bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::eight::BaselineEight;

    fn single_of(half: u16) -> f32 {
        let mut out = [0.0; 8];
        BaselineEight::widen(&[half; 8]).store(&mut out);
        out[0]
    }

    /// By the definition of binary16.
    fn defined(half: u16) -> f64 {
        let sign = if half >> 15 == 0 { 1.0 } else { -1.0 };
        let exponent = i32::from((half >> 10) & 31);
        let fraction = f64::from(half & 1023) / 1024.0;
        sign * match exponent {
            0 => fraction * 2f64.powi(-14),
            _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
        }
    }

    #[test]
    fn every_half_is_read_as_defined_and_written_back() {
        for half in (0..=u16::MAX).filter(|half| (half >> 10) & 31 != 31) {
            let single = single_of(half);
            assert_eq!(f64::from(single), defined(half), "{half:#06x}");
            assert_eq!(single.is_sign_negative(), half >> 15 == 1, "{half:#06x}");
            assert_eq!(half_of(single), half, "{half:#06x}");
        }
    }

    #[test]
    fn numbers_between_halves_go_to_the_nearer_one_and_to_even_at_a_tie() {
        for half in 0..0x7bffu16 {
            let (low, high) = (defined(half), defined(half + 1));
            let middle = 0.5 * (low + high);
            let even = half + (half & 1);
            assert_eq!(half_of(middle as f32), even, "{half:#06x}");
            let near = |share: f64| half_of((low + share * (high - low)) as f32);
            assert_eq!((near(0.49), near(0.51)), (half, half + 1), "{half:#06x}");
        }
        assert_eq!(half_of(1e9), 0x7bff);
        assert_eq!(half_of(-1e9), 0xfbff);
        assert_eq!(half_of(1e-12), 0);
    }
}
