//! Contact forces with Coulomb friction and grips.
//!
//! A force f_j on row j moves row i by D_ij f_j, a block of 3 × 3. Wanted are forces whose displacements
//! u_i = b_i + Σ_j D_ij f_j keep each row's law:
//!
//! - push, normal n, coefficient μ, drag c: f = λ n + t with λ ≥ 0, u_n ≥ 0, λ u_n = 0 and |t| ≤ μ
//!   λ while u_t = 0; where the row slips, t = −(μ λ / |u_t| + c) u_t (Signorini, Coulomb and
//!   Stokes);
//! - grip: u = 0 while |f| is below the limit, f = −limit u / |u| beyond it.
//!
//! Solved row by row in a fixed number of sweeps, or until one changes nothing (nonsmooth contact dynamics: Jean
//! 1999, "The non-smooth contact dynamics method", §5). For its own block a row takes a bound: no more than a along
//! the normal and b across it, with a = D_nn + |D_nt| and b = |D_tt| + |D_nt| (Young's inequality). With two
//! numbers its own problem has the closed form used here, and every step still goes down. Grips and
//! frictionless rows are minima of a convex function, which every sweep lowers; sliding rows are
//! not, and jams at a high μ have more than one answer: the one nearest to the last tick's is
//! found.

use super::matrix::ContactMatrix;
use palpate_geometry::math::{Matrix3, Vector3};

/// A solve has settled when no force changes by more than this share of the largest.
const SETTLED: f64 = 1e-15;

/// Coulomb's law for a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Largest tangential over normal force while it sticks (> 0).
    pub mu: f64,
    /// The same while it slips, at most `mu`.
    pub mu_kinetic: f64,
    /// Drag of the whole contact against its slip, N·s/m.
    pub viscous_n_s_m: f64,
}

/// Where a row sticks: a place of the body, and how far from it the holder was. It lasts until the
/// row slips, so nothing that sweeps leave over, and no trembling of the hand, adds up to a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stick {
    /// On the body's surface.
    pub u: f64,
    /// On the body's surface.
    pub v: f64,
    /// From there to the tool's reference point, m; in the tool's frame unless it is a ball.
    /// Between bodies, which have no such point: what the row has crept.
    pub offset: Vector3,
}

/// What a row may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionLaw {
    /// It pushes, and resists slip by at most this multiple of its normal force.
    Push {
        /// μ (≥ 0).
        mu: f64,
        /// Drag for each metre it slips within the tick, N/m (≥ 0).
        drag_n_m: f64,
    },
    /// It holds in every direction.
    Grip {
        /// Greatest force, N.
        limit_n: f64,
    },
}

impl FrictionLaw {
    /// It pushes, and nothing else.
    pub const SMOOTH: Self = Self::Push {
        mu: 0.0,
        drag_n_m: 0.0,
    };

    /// It pushes, with Coulomb's friction.
    pub fn coulomb(mu: f64) -> Self {
        Self::Push { mu, drag_n_m: 0.0 }
    }
}

/// One row.
#[derive(Clone, Copy, Debug)]
struct Bound {
    normal: Vector3,
    /// b, m.
    free: Vector3,
    law: FrictionLaw,
    /// Against its own force along the normal and across it, no more than it has, N/m; within a solve.
    stiffness: [f64; 2],
    /// The last sweep met the edge of its cone.
    slips: bool,
}

/// Buffers for up to `capacity` rows.
#[derive(Clone, Debug, Default)]
pub struct FrictionProblem {
    rows: Vec<Bound>,
    /// f, N.
    forces: Vec<Vector3>,
    /// u, m.
    displaced: Vec<[f64; 3]>,
}

impl FrictionProblem {
    /// Room for `capacity` rows.
    pub fn new(capacity: usize) -> Self {
        Self {
            rows: Vec::with_capacity(capacity),
            forces: Vec::with_capacity(capacity),
            displaced: Vec::with_capacity(capacity),
        }
    }

    /// No rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.forces.clear();
        self.displaced.clear();
    }

    /// Adds a row: its unit normal, its displacement without contact forces (m), its law, and where
    /// its force starts (N).
    pub fn push(&mut self, normal: &Vector3, free_m: &Vector3, law: FrictionLaw, warm_n: &Vector3) {
        debug_assert!(
            self.rows.len() < self.rows.capacity(),
            "more rows than room"
        );
        self.rows.push(Bound {
            normal: *normal,
            free: *free_m,
            law,
            stiffness: [0.0; 2],
            slips: false,
        });
        self.forces.push(*warm_n);
        self.displaced.push([0.0; 3]);
    }

    /// Changes a row's displacement without contact forces (m); its force stays as it is.
    pub fn set_free(&mut self, i: usize, free_m: &Vector3) {
        self.rows[i].free = *free_m;
    }

    /// The problem of another, its rows off by so much (m), from its forces.
    pub fn set_off(&mut self, other: &Self, off_m: &[Vector3]) {
        self.rows.clone_from(&other.rows);
        self.forces.clone_from(&other.forces);
        self.displaced.clone_from(&other.displaced);
        for (row, off) in self.rows.iter_mut().zip(off_m) {
            row.free += off;
        }
    }

    /// Runs `sweeps` sweeps, or until one changes nothing.
    pub fn solve(&mut self, matrix: &ContactMatrix, sweeps: usize) {
        debug_assert!(sweeps > 0, "a solve of no sweeps");
        debug_assert_eq!(
            matrix.size(),
            3 * self.rows.len(),
            "matrix and rows disagree"
        );
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { solve_avx2(self, matrix, sweeps) };
        }
        self.sweep(matrix, sweeps);
    }

    #[inline(always)]
    fn sweep(&mut self, matrix: &ContactMatrix, sweeps: usize) {
        let Self {
            rows,
            forces,
            displaced,
        } = self;
        for (i, row) in rows.iter_mut().enumerate() {
            row.stiffness = row.bound(&matrix.block(i, i));
            displaced[i] = row.free.into();
        }
        for (i, force) in forces.iter().enumerate() {
            if *force != Vector3::zeros() {
                displace(displaced.as_flattened_mut(), matrix.columns(i), force);
            }
        }
        for _ in 0..sweeps {
            let (mut largest, mut most_changed) = (0.0f64, 0.0f64);
            for (i, row) in rows.iter_mut().enumerate() {
                let next = row.next(&forces[i], &displaced[i].into());
                let change = next - forces[i];
                if change != Vector3::zeros() {
                    forces[i] = next;
                    displace(displaced.as_flattened_mut(), matrix.columns(i), &change);
                }
                largest = largest.max(next.norm_squared());
                most_changed = most_changed.max(change.norm_squared());
            }
            if most_changed <= SETTLED * SETTLED * largest {
                break;
            }
        }
    }

    /// Force of a row along its normal, N.
    pub fn normal_n(&self, i: usize) -> f64 {
        self.forces[i].dot(&self.rows[i].normal)
    }

    /// The rest of it, N.
    pub fn tangent_n(&self, i: usize) -> Vector3 {
        self.forces[i] - self.rows[i].normal * self.normal_n(i)
    }

    /// Force of a row, N.
    pub fn force_n(&self, i: usize) -> Vector3 {
        self.forces[i]
    }

    /// Replaces the force of a row by an equivalent one.
    pub fn set_force(&mut self, i: usize, force_n: &Vector3) {
        self.forces[i] = *force_n;
    }

    /// Displacement of a row under all forces, m.
    pub fn displaced_m(&self, i: usize) -> Vector3 {
        self.displaced[i].into()
    }

    /// The row's normal.
    pub fn normal(&self, i: usize) -> Vector3 {
        self.rows[i].normal
    }

    /// The row is at the edge of what its law allows.
    pub fn slips(&self, i: usize) -> bool {
        self.rows[i].slips
    }

    /// The row's law.
    pub fn law(&self, i: usize) -> FrictionLaw {
        self.rows[i].law
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn solve_avx2(problem: &mut FrictionProblem, matrix: &ContactMatrix, sweeps: usize) {
    problem.sweep(matrix, sweeps);
}

/// u += D f, of one row's columns of D.
#[inline(always)]
fn displace(u: &mut [f64], columns: &[f64], force: &Vector3) {
    let (x, others) = columns.split_at(u.len());
    let (y, z) = others.split_at(u.len());
    for (((u, x), y), z) in u.iter_mut().zip(x).zip(y).zip(z) {
        *u += (force.x * x + force.y * y) + force.z * z;
    }
}

impl Bound {
    /// Stiffness along the normal and across it of a row with this block of its own; zeros where nothing can move
    /// it, or a number is none.
    fn bound(&self, block: &Matrix3) -> [f64; 2] {
        let [along, across] = match self.law {
            _ if *block == Matrix3::from_diagonal_element(block.m11) => [block.m11; 2],
            // Nothing acts across.
            FrictionLaw::SMOOTH => [self.normal.dot(&(block * self.normal)); 2],
            FrictionLaw::Push { .. } => self.along_and_across(block),
            FrictionLaw::Grip { .. } => {
                let [along, across] = self.along_and_across(block);
                [along.max(across); 2]
            }
        };
        let stiffness = [1.0 / along, 1.0 / across];
        match stiffness.iter().all(|k| *k > 0.0 && k.is_finite()) {
            true => stiffness,
            false => [0.0; 2],
        }
    }

    /// What a block is no more than, along the normal and across it.
    fn along_and_across(&self, block: &Matrix3) -> [f64; 2] {
        // Any direction across will do, well away from the normal.
        let axis = match self.normal.x.abs() < 0.6 {
            true => Vector3::x(),
            false => Vector3::y(),
        };
        let first = self.normal.cross(&axis).normalize();
        let second = self.normal.cross(&first);
        let pushed = block * self.normal;
        let along = self.normal.dot(&pushed);
        let coupled = (pushed - self.normal * along).norm();
        let (a, b) = (first.dot(&(block * first)), second.dot(&(block * second)));
        let c = first.dot(&(block * second));
        let across = 0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt();
        [along + coupled, across + coupled]
    }

    /// The force of a row after `force`, under which it is displaced by `u`.
    #[inline(always)]
    fn next(&mut self, force: &Vector3, u: &Vector3) -> Vector3 {
        let [along, across] = self.stiffness;
        if across == 0.0 {
            return Vector3::zeros();
        }
        if along == across {
            return self.allowed(&(force - u * across));
        }
        let depth = u.dot(&self.normal);
        let wish = force - self.normal * (depth * along) - (u - self.normal * depth) * across;
        self.allowed(&wish)
    }

    /// The force the row takes when `wish` would bring its displacement to zero.
    #[inline(always)]
    fn allowed(&mut self, wish: &Vector3) -> Vector3 {
        match self.law {
            FrictionLaw::Push { mu, drag_n_m } => {
                let along = wish.dot(&self.normal);
                let pushes = along > 0.0;
                if !pushes {
                    self.slips = false;
                    return Vector3::zeros();
                }
                let tangent = wish - self.normal * along;
                let (size, most) = (tangent.norm(), mu * along);
                self.slips = size > most;
                // Slip is (size − |t|) over the stiffness, against the way, and |t| = most + drag × slip.
                let drag = drag_n_m / self.stiffness[1];
                let scale = if self.slips {
                    (most + drag * size) / ((1.0 + drag) * size)
                } else {
                    1.0
                };
                self.normal * along + tangent * scale
            }
            FrictionLaw::Grip { limit_n } => {
                let size = wish.norm();
                self.slips = size > limit_n;
                wish * if self.slips { limit_n / size } else { 1.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests;
