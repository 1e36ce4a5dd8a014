//! Sums of compliance columns, four at a time, so that the displacements are loaded and stored once
//! for four forces.

use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, simd};

/// moved_i += Σ_k columns[k]_i forces[k] over the first `count` of the columns.
pub(super) fn add(columns: [&[f64]; 4], count: usize, forces: &[Lane; 4], moved: &mut [Lane]) {
    #[cfg(target_arch = "x86_64")]
    if simd::has_avx2() {
        // SAFETY: the processor has AVX2, asked just above.
        #[allow(unsafe_code)]
        return unsafe { add_wide(columns, count, forces, moved) };
    }
    add_in::<Baseline>(columns, count, forces, moved);
}

#[inline(always)]
fn add_in<L: Lanes>(columns: [&[f64]; 4], count: usize, forces: &[Lane; 4], moved: &mut [Lane]) {
    let [a, b, c, d] = columns;
    let [fa, fb, fc, fd] = [
        L::load(&forces[0]),
        L::load(&forces[1]),
        L::load(&forces[2]),
        L::load(&forces[3]),
    ];
    let n = moved.len();
    if count == 4 {
        let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
        for i in 0..n {
            let first = fa * L::splat(a[i]) + fb * L::splat(b[i]);
            let second = fc * L::splat(c[i]) + fd * L::splat(d[i]);
            (L::load(&moved[i]) + (first + second)).store(&mut moved[i]);
        }
        return;
    }
    for (column, force) in [(a, fa), (b, fb), (c, fc)].into_iter().take(count) {
        let column = &column[..n];
        for i in 0..n {
            (L::load(&moved[i]) + force * L::splat(column[i])).store(&mut moved[i]);
        }
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_wide(columns: [&[f64]; 4], count: usize, forces: &[Lane; 4], moved: &mut [Lane]) {
    add_in::<palpate_geometry::math::lanes::Wide>(columns, count, forces, moved);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_summed_with_the_same_bits_on_every_processor() {
        let column =
            |k: usize| -> Vec<f64> { (0..9).map(|i| libm::sin((9 * k + i) as f64)).collect() };
        let columns: Vec<Vec<f64>> = (0..4).map(column).collect();
        let forces: [Lane; 4] =
            std::array::from_fn(|k| [k as f64 + 0.5, -1.0, libm::cos(k as f64), 0.0]);
        for count in 1..=4 {
            let all = std::array::from_fn(|k| columns[k].as_slice());
            let (mut slow, mut fast) = (vec![[0.1; 4]; 9], vec![[0.1; 4]; 9]);
            add_in::<Baseline>(all, count, &forces, &mut slow);
            add(all, count, &forces, &mut fast);
            assert_eq!(slow, fast);
            for (i, moved) in fast.iter().enumerate() {
                let exact: f64 = (0..count).map(|k| columns[k][i] * forces[k][2]).sum();
                assert!((moved[2] - 0.1 - exact).abs() < 1e-14);
            }
        }
    }
}
