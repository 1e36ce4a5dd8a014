//! Four numbers at a time, with the same bits on every processor.
//!
//! Kernels are written once over [`Lanes`] and compiled twice: for [`Baseline`], which is plain
//! arrays, and, behind [`has_avx2`](super::simd::has_avx2), for `Wide`, which is one register. Each
//! operation rounds once in both, and nothing is fused, so the answers agree to the last bit. Four
//! lanes only: wider ones would be another layout of the data.

use std::ops::{Add, Div, Mul, Sub};

/// Four numbers in memory.
pub type Four = [f64; 4];

/// Four numbers, wherever they are held.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn splat(x: f64) -> Self;
    fn load(from: &Four) -> Self;
    fn store(self, to: &mut Four);
    fn sqrt(self) -> Self;
    /// The lesser in each lane; that of `other` where they do not compare.
    fn least(self, other: Self) -> Self;
    /// The greater in each lane; that of `other` where they do not compare.
    fn greatest(self, other: Self) -> Self;
    /// Bit k is set where lane k is above that of `other`.
    fn above(self, other: Self) -> u8;
    /// Rows to columns: lane j of answer i is lane i of `rows[j]`.
    fn transposed(rows: [Self; 4]) -> [Self; 4];
    /// x0 y0 z0 x1 y1 z1 …
    fn interleave(x: Self, y: Self, z: Self, to: &mut [f64; 12]);
}

/// Four numbers of a slice, from one on; zeros where it has no four more.
#[inline(always)]
pub fn load<L: Lanes>(from: &[f64], at: usize) -> L {
    match from[at..].first_chunk() {
        Some(four) => L::load(four),
        None => L::splat(0.0),
    }
}

/// Writes four numbers of a slice, from one on; nothing where it has no four more.
#[inline(always)]
pub fn store<L: Lanes>(lanes: L, to: &mut [f64], at: usize) {
    if let Some(four) = to[at..].first_chunk_mut() {
        lanes.store(four);
    }
}

/// Three numbers side by side.
pub(crate) trait Triple: From<[f64; 3]> {
    /// Four of them as the numbers they are.
    fn flat(four: &mut [Self; 4]) -> &mut [f64; 12];
}

macro_rules! triple {
    ($type:ty) => {
        impl Triple for $type {
            #[inline(always)]
            #[allow(unsafe_code)]
            fn flat(four: &mut [Self; 4]) -> &mut [f64; 12] {
                const { assert!(size_of::<$type>() == 24 && align_of::<$type>() == align_of::<f64>()) };
                // SAFETY: nalgebra lays vectors and points out in C's way around an array of three
                // floats; their size, checked above, leaves no room for anything else, and any
                // floats are valid.
                unsafe { &mut *std::ptr::from_mut(four).cast() }
            }
        }
    };
}
triple!(super::Vector3);
triple!(super::Point3);

/// Any processor.
#[derive(Clone, Copy)]
pub struct Baseline(Four);

macro_rules! baseline_operator {
    ($name:ident, $method:ident, $operator:tt) => {
        impl $name for Baseline {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(std::array::from_fn(|k| self.0[k] $operator other.0[k]))
            }
        }
    };
}
baseline_operator!(Add, add, +);
baseline_operator!(Sub, sub, -);
baseline_operator!(Mul, mul, *);
baseline_operator!(Div, div, /);

impl Lanes for Baseline {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; 4])
    }
    #[inline(always)]
    fn load(from: &Four) -> Self {
        Self(*from)
    }
    #[inline(always)]
    fn store(self, to: &mut Four) {
        *to = self.0;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| {
            if self.0[k] < other.0[k] {
                self.0[k]
            } else {
                other.0[k]
            }
        }))
    }
    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| {
            if self.0[k] > other.0[k] {
                self.0[k]
            } else {
                other.0[k]
            }
        }))
    }
    #[inline(always)]
    fn above(self, other: Self) -> u8 {
        (0..4).fold(0, |mask, k| mask | u8::from(self.0[k] > other.0[k]) << k)
    }
    #[inline(always)]
    fn transposed(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|i| Self(std::array::from_fn(|j| rows[j].0[i])))
    }
    #[inline(always)]
    fn interleave(x: Self, y: Self, z: Self, to: &mut [f64; 12]) {
        for k in 0..4 {
            (to[3 * k], to[3 * k + 1], to[3 * k + 2]) = (x.0[k], y.0[k], z.0[k]);
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub use avx2::Wide;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![allow(unsafe_code)]
    use super::{Add, Div, Four, Lanes, Mul, Sub};
    use std::arch::x86_64::*;
    // Values, not pointers: loads through pointers are checked where debug assertions are on.
    use std::mem::transmute;

    /// One AVX register. To be used only inside functions compiled for AVX2, called after
    /// [`has_avx2`](crate::math::simd::has_avx2).
    #[derive(Clone, Copy)]
    pub struct Wide(__m256d);

    macro_rules! wide_operator {
        ($name:ident, $method:ident, $intrinsic:ident) => {
            impl $name for Wide {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: as for all of this module, users have asked for AVX2.
                    Self(unsafe { $intrinsic(self.0, other.0) })
                }
            }
        };
    }
    wide_operator!(Add, add, _mm256_add_pd);
    wide_operator!(Sub, sub, _mm256_sub_pd);
    wide_operator!(Mul, mul, _mm256_mul_pd);
    wide_operator!(Div, div, _mm256_div_pd);

    // SAFETY of all blocks: users have asked for AVX2; registers and arrays have the same bits.
    impl Lanes for Wide {
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(x) })
        }
        #[inline(always)]
        fn load(from: &Four) -> Self {
            Self(unsafe { transmute::<Four, __m256d>(*from) })
        }
        #[inline(always)]
        fn store(self, to: &mut Four) {
            *to = unsafe { transmute::<__m256d, Four>(self.0) };
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn least(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn greatest(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn above(self, other: Self) -> u8 {
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0)) as u8 }
        }
        #[inline(always)]
        fn transposed([a, b, c, d]: [Self; 4]) -> [Self; 4] {
            unsafe {
                let (ab_even, ab_odd) =
                    (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (cd_even, cd_odd) =
                    (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
                ]
            }
        }
        #[inline(always)]
        fn interleave(x: Self, y: Self, z: Self, to: &mut [f64; 12]) {
            unsafe {
                // x0 y0 x2 y2, y1 z1 y3 z3, z0 x1 z2 x3.
                let xy = _mm256_unpacklo_pd(x.0, y.0);
                let yz = _mm256_unpackhi_pd(y.0, z.0);
                let zx = _mm256_shuffle_pd::<0b1010>(z.0, x.0);
                let rows = [
                    _mm256_permute2f128_pd::<0x20>(xy, zx),
                    _mm256_blend_pd::<0b1100>(yz, xy),
                    _mm256_permute2f128_pd::<0x31>(zx, yz),
                ];
                *to = transmute::<[__m256d; 3], [f64; 12]>(rows);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything the trait can do, in a row of numbers.
    fn all<L: Lanes>(a: &Four, b: &Four) -> Vec<f64> {
        let (x, y) = (L::load(a), L::load(b));
        let mut out = Vec::new();
        let mut keep = |lanes: L| {
            let mut four = [0.0; 4];
            lanes.store(&mut four);
            out.extend(four);
        };
        [
            x + y,
            x - y,
            x * y,
            x / y,
            x.sqrt(),
            x.least(y),
            x.greatest(y),
            L::splat(a[2]),
        ]
        .into_iter()
        .for_each(&mut keep);
        L::transposed([x, y, x + y, x - y])
            .into_iter()
            .for_each(&mut keep);
        out.push(f64::from(x.above(y)));
        let mut flat = [0.0; 12];
        L::interleave(x, y, x + y, &mut flat);
        out.extend(flat);
        out
    }

    #[test]
    fn baseline_lanes_do_what_their_names_say() {
        let (a, b) = ([1.0, 4.0, 9.0, 16.0], [2.0, 1.0, 9.0, -3.0]);
        let got = all::<Baseline>(&a, &b);
        assert_eq!(got[16..20], [1.0, 2.0, 3.0, 4.0], "roots");
        assert_eq!(got[20..24], [1.0, 1.0, 9.0, -3.0], "least");
        assert_eq!(got[24..28], [2.0, 4.0, 9.0, 16.0], "greatest");
        assert_eq!(got[32..36], [1.0, 2.0, 3.0, -1.0], "first column");
        assert_eq!(got[48], 10.0, "above: lanes 1 and 3");
        assert_eq!(got[49..55], [1.0, 2.0, 3.0, 4.0, 1.0, 5.0], "interleaved");
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn wide_lanes_have_the_bits_of_the_baseline() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        let odd = [
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            -1.5,
            1e-310,
            3e200,
            1.0 / 3.0,
        ];
        for k in 0..odd.len() * odd.len() {
            let at = |shift: usize| odd[(k / odd.len() + shift) % odd.len()];
            let of = |shift: usize| odd[(k + shift) % odd.len()];
            let (a, b) = (std::array::from_fn(at), std::array::from_fn(of));
            let (slow, fast) = (all::<Baseline>(&a, &b), all::<Wide>(&a, &b));
            for (x, y) in slow.iter().zip(&fast) {
                // The sign and load of a NaN are not part of an answer.
                assert!(
                    x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()),
                    "{a:?} {b:?}: {x} is not {y}"
                );
            }
        }
    }
}
