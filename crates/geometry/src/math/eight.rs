//! Eight single-precision numbers at a time, with the same bits on every processor: as
//! [`lanes`](super::lanes), each operation rounds once and nothing is fused.

/// Eight numbers, wherever they are held.
pub(super) trait Eight: Copy {
    fn splat(x: f32) -> Self;
    fn load(from: &[f32; 8]) -> Self;
    /// Of finite numbers in half precision (IEEE 754 binary16): exact.
    fn widen(from: &[u16; 8]) -> Self;
    fn store(self, to: &mut [f32; 8]);
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// Of each of four: ((x0 + x1) + (x2 + x3)) + ((x4 + x5) + (x6 + x7)).
    fn sums(of: [Self; 4]) -> [f32; 4];
}

/// Any processor.
#[derive(Clone, Copy)]
pub(super) struct BaselineEight([f32; 8]);

impl Eight for BaselineEight {
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn load(from: &[f32; 8]) -> Self {
        Self(*from)
    }
    #[inline(always)]
    fn widen(from: &[u16; 8]) -> Self {
        // In single precision all of them are normal: nothing here makes a subnormal number, which
        // processors multiply a hundred times slower.
        let unit = f32::from_bits((127 - 24) << 23);
        Self(from.map(|half| {
            let size = i32::from(half & 0x7fff);
            let normal = ((size << 13) + (112 << 23)) as u32;
            let subnormal = (size as f32 * unit).to_bits();
            let size = if size < 0x400 { subnormal } else { normal };
            f32::from_bits(size | u32::from(half & 0x8000) << 16)
        }))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; 8]) {
        *to = self.0;
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] * other.0[k]))
    }
    #[inline(always)]
    fn sums(of: [Self; 4]) -> [f32; 4] {
        of.map(|Self([a, b, c, d, e, f, g, h])| ((a + b) + (c + d)) + ((e + f) + (g + h)))
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::WideEight;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![allow(unsafe_code)]
    use super::Eight;
    use std::arch::x86_64::*;
    // Values, not pointers: loads through pointers are checked where debug assertions are on.
    use std::mem::transmute;

    /// One AVX register. To be used only inside functions compiled for AVX2 and F16C, called after
    /// [`has_avx2`](crate::math::simd::has_avx2).
    #[derive(Clone, Copy)]
    pub(in crate::math) struct WideEight(__m256);

    // SAFETY of all blocks: users have asked for AVX2 and F16C; registers and arrays have the same bits.
    impl Eight for WideEight {
        #[inline(always)]
        fn splat(x: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(x) })
        }
        #[inline(always)]
        fn load(from: &[f32; 8]) -> Self {
            Self(unsafe { transmute::<[f32; 8], __m256>(*from) })
        }
        #[inline(always)]
        fn widen(from: &[u16; 8]) -> Self {
            Self(unsafe { _mm256_cvtph_ps(transmute::<[u16; 8], __m128i>(*from)) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f32; 8]) {
            *to = unsafe { transmute::<__m256, [f32; 8]>(self.0) };
        }
        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn minus(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn times(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn sums(of: [Self; 4]) -> [f32; 4] {
            let [a, b, c, d] = of;
            unsafe {
                let pairs = _mm256_hadd_ps(_mm256_hadd_ps(a.0, b.0), _mm256_hadd_ps(c.0, d.0));
                let sum = _mm_add_ps(
                    _mm256_castps256_ps128(pairs),
                    _mm256_extractf128_ps::<1>(pairs),
                );
                transmute::<__m128, [f32; 4]>(sum)
            }
        }
    }
}
