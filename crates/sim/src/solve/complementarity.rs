//! Contact forces as a linear complementarity problem: λ ≥ 0, D λ + gap ≥ 0, λᵀ(D λ + gap) = 0.
//!
//! Projected Gauss–Seidel with a fixed number of sweeps and a warm start. D, the Delassus matrix of forces
//! along the normals, is positive semidefinite, so the gap after any
//! number of sweeps shrinks towards feasible and the sum of forces settles long before their
//! distribution over close rows does. Gaps are kept up to date with every change of a force, so
//! that rows that stay free cost nothing.

use super::matrix::ContactMatrix;
use palpate_geometry::math::simd;

/// Buffers for up to `capacity` rows.
#[derive(Clone, Debug)]
pub struct Complementarity {
    len: usize,
    /// (len), m.
    gap: Vec<f64>,
    /// (len), N.
    force: Vec<f64>,
    /// (len), m: gaps under the present forces, within a solve.
    under: Vec<f64>,
}

impl Complementarity {
    /// Room for `capacity` rows.
    pub fn new(capacity: usize) -> Self {
        Self {
            len: 0,
            gap: vec![0.0; capacity],
            force: vec![0.0; capacity],
            under: vec![0.0; capacity],
        }
    }

    /// Starts a problem of `len` rows without forces.
    pub fn begin(&mut self, len: usize) {
        debug_assert!(len <= self.force.len(), "more rows than room");
        self.len = len;
        self.force[..len].fill(0.0);
    }

    /// Sets the gap of a row and where its force starts from.
    pub fn set(&mut self, i: usize, gap_m: f64, warm_n: f64) {
        debug_assert!(i < self.len, "no such row");
        self.gap[i] = gap_m;
        self.force[i] = warm_n;
    }

    /// The problem of another, its gaps off by so much (m), from its forces.
    pub fn set_off(&mut self, other: &Self, off_m: impl Iterator<Item = f64>) {
        self.len = other.len;
        self.force[..self.len].copy_from_slice(other.forces());
        let gaps = other.gap[..self.len].iter().zip(off_m);
        for (to, (gap, off)) in self.gap.iter_mut().zip(gaps) {
            *to = gap + off;
        }
    }

    /// Runs `sweeps` sweeps, or until one changes nothing; forces are then in
    /// [`Complementarity::forces`].
    pub fn solve(&mut self, matrix: &ContactMatrix, sweeps: usize) {
        debug_assert!(sweeps > 0, "a solve of no sweeps");
        debug_assert_eq!(matrix.size(), self.len, "matrix and rows disagree");
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { solve_wide(self, matrix, sweeps) };
        }
        self.sweep(matrix, sweeps);
    }

    #[inline(always)]
    fn sweep(&mut self, matrix: &ContactMatrix, sweeps: usize) {
        let n = self.len;
        let Self {
            gap, force, under, ..
        } = self;
        let (force, under) = (&mut force[..n], &mut under[..n]);
        under.copy_from_slice(&gap[..n]);
        for (i, &force) in force.iter().enumerate() {
            if force != 0.0 {
                add_scaled(under, matrix.columns(i), force);
            }
        }
        for _ in 0..sweeps {
            let mut changed = false;
            for i in 0..n {
                let row = matrix.columns(i);
                let wish = force[i] - under[i] / row[i];
                let next = if row[i] > 0.0 && wish > 0.0 {
                    wish
                } else {
                    0.0
                };
                let change = next - force[i];
                if change != 0.0 {
                    (force[i], changed) = (next, true);
                    add_scaled(under, row, change);
                }
            }
            if !changed {
                break;
            }
        }
    }

    /// λ, N (len).
    pub fn forces(&self) -> &[f64] {
        &self.force[..self.len]
    }

    /// Replaces the force of a row by an equivalent one.
    pub fn set_force(&mut self, i: usize, force_n: f64) {
        debug_assert!(i < self.len, "no such row");
        self.force[i] = force_n;
    }

    /// Gap of row i under the present forces, m.
    pub fn gap_after(&self, matrix: &ContactMatrix, i: usize) -> f64 {
        self.gap[i]
            + (matrix.columns(i).iter())
                .zip(self.forces())
                .map(|(d, force)| d * force)
                .sum::<f64>()
    }
}

/// y += w x.
#[inline(always)]
fn add_scaled(to: &mut [f64], x: &[f64], weight: f64) {
    for (to, x) in to.iter_mut().zip(x) {
        *to += weight * x;
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn solve_wide(problem: &mut Complementarity, matrix: &ContactMatrix, sweeps: usize) {
    problem.sweep(matrix, sweeps);
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Vector3;

    fn matrix(n: usize, entry: impl Fn(usize, usize) -> f64) -> ContactMatrix {
        let mut matrix = ContactMatrix::new(n, 0);
        matrix.begin((0..n).map(|_| Vector3::z()), false);
        for i in 0..n {
            for j in 0..=i {
                matrix.add_along(i, j, entry(i, j));
            }
        }
        matrix
    }

    #[test]
    fn one_spring_gives_stiffness_times_depth() {
        let mut problem = Complementarity::new(4);
        problem.begin(1);
        problem.set(0, -0.002, 0.0);
        problem.solve(&matrix(1, |_, _| 1.0 / 500.0), 1);
        assert_eq!(problem.forces(), [1.0]);
    }

    #[test]
    fn solution_is_complementary_on_a_random_positive_definite_matrix() {
        let n = 12;
        let mut state = 7u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let factor: Vec<f64> = (0..n * n).map(|_| random()).collect();
        let mut problem = Complementarity::new(n);
        problem.begin(n);
        let matrix = matrix(n, |i, j| {
            let dot: f64 = (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
            dot + if i == j { 0.3 } else { 0.0 }
        });
        for i in 0..n {
            problem.set(i, random(), 0.0);
        }
        problem.solve(&matrix, 2_000);
        for i in 0..n {
            let (gap, force) = (problem.gap_after(&matrix, i), problem.forces()[i]);
            assert!(gap > -1e-12, "row {i} is violated by {gap}");
            assert!(
                force >= 0.0 && (force * gap).abs() < 1e-12,
                "row {i}: force {force} with gap {gap}"
            );
        }
    }

    #[test]
    fn what_nothing_can_move_bears_nothing_and_a_solution_stays() {
        let mut problem = Complementarity::new(3);
        problem.begin(3);
        let entries = [[2.0, 0.0, 0.5], [0.0, 0.0, 0.0], [0.5, 0.0, 1.0]];
        let matrix = matrix(3, |i, j| entries[i][j]);
        for (i, gap) in [-1.0, -1.0, 0.3].into_iter().enumerate() {
            problem.set(i, gap, 5.0);
        }
        problem.solve(&matrix, 100);
        let forces = problem.forces().to_vec();
        assert!(
            (forces[0] - 0.5).abs() < 1e-15 && forces[1..] == [0.0, 0.0],
            "{forces:?}"
        );
        for (i, gap) in [-1.0, -1.0, 0.3].into_iter().enumerate() {
            problem.set(i, gap, forces[i]);
        }
        problem.solve(&matrix, 1);
        assert_eq!(problem.forces(), forces);
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn wide_registers_give_the_same_bits() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        let n = 11;
        let mut slow = Complementarity::new(n);
        slow.begin(n);
        let matrix = matrix(n, |i, j| {
            1.0 / (1.0 + (i as f64 - j as f64).abs()) + if i == j { 0.5 } else { 0.0 }
        });
        for i in 0..n {
            slow.set(i, libm::sin(3.0 * i as f64) - 0.4, 0.1);
        }
        let mut fast = slow.clone();
        slow.sweep(&matrix, 7);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            solve_wide(&mut fast, &matrix, 7);
        }
        assert_eq!(slow.forces(), fast.forces());
    }
}
