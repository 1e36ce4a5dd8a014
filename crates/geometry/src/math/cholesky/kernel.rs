//! Registers of a solve with a factor: one, or four right-hand sides, in double or single precision.

use super::{Lane, SingleLane, Triangle};

/// How a row of right-hand sides is held in registers. Each kernel does the same operations in the
/// same order.
pub(super) trait Kernel {
    type Value: Copy;
    type Row;
    type Register: Copy;
    fn zero() -> Self::Register;
    fn load(row: &Self::Row) -> Self::Register;
    fn store(register: Self::Register, row: &mut Self::Row);
    fn times(a: Self::Register, factor: Self::Value) -> Self::Register;
    /// a − b × factor, rounded twice.
    fn minus(a: Self::Register, b: Self::Register, factor: Self::Value) -> Self::Register;
}

/// One right-hand side.
pub(super) struct One;

impl Kernel for One {
    type Value = f64;
    type Row = f64;
    type Register = f64;
    #[inline(always)]
    fn zero() -> f64 {
        0.0
    }
    #[inline(always)]
    fn load(row: &f64) -> f64 {
        *row
    }
    #[inline(always)]
    fn store(register: f64, row: &mut f64) {
        *row = register;
    }
    #[inline(always)]
    fn times(a: f64, factor: f64) -> f64 {
        a * factor
    }
    #[inline(always)]
    fn minus(a: f64, b: f64, factor: f64) -> f64 {
        a - b * factor
    }
}

/// Four right-hand sides, any processor.
pub(super) struct BaselineKernel;

impl Kernel for BaselineKernel {
    type Value = f64;
    type Row = Lane;
    type Register = Lane;
    #[inline(always)]
    fn zero() -> Lane {
        [0.0; 4]
    }
    #[inline(always)]
    fn load(row: &Lane) -> Lane {
        *row
    }
    #[inline(always)]
    fn store(register: Lane, row: &mut Lane) {
        *row = register;
    }
    #[inline(always)]
    fn times(a: Lane, factor: f64) -> Lane {
        a.map(|value| value * factor)
    }
    #[inline(always)]
    fn minus(a: Lane, b: Lane, factor: f64) -> Lane {
        [
            a[0] - b[0] * factor,
            a[1] - b[1] * factor,
            a[2] - b[2] * factor,
            a[3] - b[3] * factor,
        ]
    }
}

/// Four right-hand sides in single precision, any processor.
pub(super) struct SingleKernel;

impl Kernel for SingleKernel {
    type Value = f32;
    type Row = SingleLane;
    type Register = SingleLane;
    #[inline(always)]
    fn zero() -> SingleLane {
        [0.0; 4]
    }
    #[inline(always)]
    fn load(row: &SingleLane) -> SingleLane {
        *row
    }
    #[inline(always)]
    fn store(register: SingleLane, row: &mut SingleLane) {
        *row = register;
    }
    #[inline(always)]
    fn times(a: SingleLane, factor: f32) -> SingleLane {
        a.map(|value| value * factor)
    }
    #[inline(always)]
    fn minus(a: SingleLane, b: SingleLane, factor: f32) -> SingleLane {
        std::array::from_fn(|k| a[k] - b[k] * factor)
    }
}

/// Four right-hand sides in one 256-bit register; multiply and subtract stay apart, so the bits are
/// the baseline's. Written out because the compiler, left alone, shuffles the sums of a panel
/// between registers.
#[cfg(target_arch = "x86_64")]
pub(super) mod avx2 {
    #![allow(unsafe_code)]
    use super::{Kernel, Lane, SingleLane, Triangle};
    use std::arch::x86_64::{
        __m128, __m256d, _mm_mul_ps, _mm_set1_ps, _mm_setzero_ps, _mm_sub_ps, _mm256_mul_pd,
        _mm256_set1_pd, _mm256_setzero_pd, _mm256_sub_pd,
    };
    // Values, not pointers: loads through pointers are checked where debug assertions are on.
    use std::mem::transmute;

    struct Wide;

    // SAFETY of all blocks: only `solve` uses this kernel, and its caller has made sure of AVX2;
    // registers and arrays have the same bits.
    impl Kernel for Wide {
        type Value = f64;
        type Row = Lane;
        type Register = __m256d;
        #[inline(always)]
        fn zero() -> __m256d {
            unsafe { _mm256_setzero_pd() }
        }
        #[inline(always)]
        fn load(row: &Lane) -> __m256d {
            unsafe { transmute::<Lane, __m256d>(*row) }
        }
        #[inline(always)]
        fn store(register: __m256d, row: &mut Lane) {
            *row = unsafe { transmute::<__m256d, Lane>(register) };
        }
        #[inline(always)]
        fn times(a: __m256d, factor: f64) -> __m256d {
            unsafe { _mm256_mul_pd(a, _mm256_set1_pd(factor)) }
        }
        #[inline(always)]
        fn minus(a: __m256d, b: __m256d, factor: f64) -> __m256d {
            unsafe { _mm256_sub_pd(a, _mm256_mul_pd(b, _mm256_set1_pd(factor))) }
        }
    }

    /// In single precision half of that register is enough.
    struct WideSingle;

    impl Kernel for WideSingle {
        type Value = f32;
        type Row = SingleLane;
        type Register = __m128;
        #[inline(always)]
        fn zero() -> __m128 {
            unsafe { _mm_setzero_ps() }
        }
        #[inline(always)]
        fn load(row: &SingleLane) -> __m128 {
            unsafe { transmute::<SingleLane, __m128>(*row) }
        }
        #[inline(always)]
        fn store(register: __m128, row: &mut SingleLane) {
            *row = unsafe { transmute::<__m128, SingleLane>(register) };
        }
        #[inline(always)]
        fn times(a: __m128, factor: f32) -> __m128 {
            unsafe { _mm_mul_ps(a, _mm_set1_ps(factor)) }
        }
        #[inline(always)]
        fn minus(a: __m128, b: __m128, factor: f32) -> __m128 {
            unsafe { _mm_sub_ps(a, _mm_mul_ps(b, _mm_set1_ps(factor))) }
        }
    }

    #[target_feature(enable = "avx2")]
    pub(in crate::math) fn solve(triangle: &Triangle<f64>, x: &mut [Lane]) {
        triangle.solve_in_place::<Wide>(x);
    }

    #[target_feature(enable = "avx2")]
    pub(in crate::math) fn solve_single(triangle: &Triangle<f32>, x: &mut [SingleLane]) {
        triangle.solve_in_place::<WideSingle>(x);
    }
}
