//! Contact forces: what rows without friction, with it and grips ask for, all at once.
//!
//! A force f_j on row j moves row i by D_ij f_j. Wanted are forces whose displacements u_i = b_i + Σ_j D_ij f_j keep each
//! row's law:
//!
//! - push, normal n, coefficient μ, drag c: f = λ n + t with λ ≥ 0, u_n ≥ 0, λ u_n = 0 and |t| ≤ μ
//!   λ while u_t = 0; where the row slips, t = −(μ λ / |u_t| + c) u_t (Signorini, Coulomb and
//!   Stokes);
//! - grip: u = 0 while |f| is below the limit, f = −limit u / |u| beyond it.
//!
//! Where nothing acts across a row, λ and u_n are all there is of it. Solved row by row in a fixed number of sweeps from a
//! warm start, or until one changes nothing (projected Gauss–Seidel; with friction, nonsmooth contact dynamics: Jean
//! 1999, "The non-smooth contact dynamics method", §5). Displacements are kept up to date with every change of a force, so
//! that rows that stay free cost nothing. The sum of forces settles long before their distribution over close rows does.
//!
//! For its own 3 × 3 block a row takes a bound: no more than a along
//! the normal and b across it, with a = D_nn + |D_nt| and b = |D_tt| + |D_nt| (Young's inequality). With two
//! numbers its own problem has the closed form used here, and every step still goes down. Grips and
//! frictionless rows are minima of a convex function, which every sweep lowers; sliding rows are
//! not, and jams at a high μ have more than one answer: the one nearest to the last tick's is
//! found.

use super::friction::FrictionLaw;
use super::matrix::ContactMatrix;
use palpate_geometry::math::{Matrix3, Vector3};
use std::ops::Range;

/// A solve has settled when no force of three directions changes by more than this share of the largest, and no
/// other changes.
const SETTLED: f64 = 1e-15;

/// One row.
#[derive(Clone, Debug)]
struct Bound {
    normal: Vector3,
    law: FrictionLaw,
    /// Its directions among those of all.
    span: Range<usize>,
    /// The last sweep met the edge of its cone.
    slips: bool,
}

/// Buffers for up to a number of rows.
#[derive(Clone, Debug)]
pub struct ContactProblem {
    rows: Vec<Bound>,
    /// By row: against its own force along the normal and across it, no more than it has, N/m; within a solve.
    stiffness: Vec<[f64; 2]>,
    /// By direction: b, m.
    free: Vec<f64>,
    /// By direction: f, N.
    forces: Vec<f64>,
    /// By direction: u, m.
    displaced: Vec<f64>,
}

impl ContactProblem {
    /// Room for `rows` rows whose forces have so many directions together.
    pub fn new(rows: usize, directions: usize) -> Self {
        Self {
            rows: Vec::with_capacity(rows),
            stiffness: Vec::with_capacity(rows),
            free: Vec::with_capacity(directions),
            forces: Vec::with_capacity(directions),
            displaced: Vec::with_capacity(directions),
        }
    }

    /// No rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.stiffness.clear();
        self.free.clear();
        self.forces.clear();
        self.displaced.clear();
    }

    /// Adds a row: its unit normal, whether its force has all directions, its law, and where its force starts, along the
    /// normal and across it (N). It moves nowhere until [`ContactProblem::set_free`] says so.
    pub fn push(
        &mut self,
        normal: &Vector3,
        whole: bool,
        law: FrictionLaw,
        (normal_n, tangent_n): (f64, Vector3),
    ) {
        debug_assert!(
            self.rows.len() < self.rows.capacity(),
            "more rows than room"
        );
        debug_assert!(whole || law == FrictionLaw::SMOOTH, "nothing acts across");
        let start = self.forces.len();
        match whole {
            true => (self.forces).extend(&(normal * normal_n + tangent_n)),
            false => self.forces.push(normal_n),
        }
        self.free.resize(self.forces.len(), 0.0);
        self.displaced.resize(self.forces.len(), 0.0);
        self.stiffness.push([0.0; 2]);
        self.rows.push(Bound {
            normal: *normal,
            law,
            span: start..self.forces.len(),
            slips: false,
        });
    }

    /// Says where a row goes without contact forces, m: its gap, and what it slips across; a grip goes by `slip_m`. Its
    /// force stays as it is.
    pub fn set_free(&mut self, i: usize, gap_m: f64, slip_m: &Vector3) {
        let Bound {
            normal, law, span, ..
        } = &self.rows[i];
        let to = &mut self.free[span.clone()];
        match law {
            _ if to.len() == 1 => to[0] = gap_m,
            FrictionLaw::Push { .. } => {
                let free = slip_m + normal * (gap_m - slip_m.dot(normal));
                to.copy_from_slice(free.as_slice());
            }
            FrictionLaw::Grip { .. } => to.copy_from_slice(slip_m.as_slice()),
        }
    }

    /// The problem of another, its rows off by so much (m), from its forces.
    pub fn set_off(&mut self, other: &Self, off_m: &[Vector3]) {
        debug_assert_eq!(other.rows.len(), off_m.len(), "a row without an offset");
        self.rows.clone_from(&other.rows);
        self.stiffness.clone_from(&other.stiffness);
        self.free.clone_from(&other.free);
        self.forces.clone_from(&other.forces);
        self.displaced.clone_from(&other.displaced);
        for (row, off) in self.rows.iter().zip(off_m) {
            match &mut self.free[row.span.clone()] {
                [gap_m] => *gap_m += off.dot(&row.normal),
                free => free
                    .iter_mut()
                    .zip(off)
                    .for_each(|(free, off)| *free += off),
            }
        }
    }

    /// Runs `sweeps` sweeps, or until one changes nothing.
    pub fn solve(&mut self, matrix: &ContactMatrix, sweeps: usize) {
        debug_assert!(sweeps > 0, "a solve of no sweeps");
        debug_assert!(
            matrix.rows() == self.rows.len() && matrix.size() == self.forces.len(),
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
            stiffness,
            free,
            forces,
            displaced,
        } = self;
        displaced.copy_from_slice(free);
        for (i, row) in rows.iter().enumerate() {
            stiffness[i] = row.bound(matrix, i);
            let force = &forces[row.span.clone()];
            if force.iter().any(|n| *n != 0.0) {
                displace(displaced, matrix.columns(i), force);
            }
        }
        for _ in 0..sweeps {
            let (mut largest, mut most_changed) = (0.0f64, 0.0f64);
            for (i, stiffness) in stiffness.iter().enumerate() {
                let Range { start, end } = matrix.span(i);
                if end - start == 1 {
                    let column = matrix.columns(i);
                    let (force, own) = (forces[start], column[start]);
                    let wish = force - displaced[start] / own;
                    let next = if own > 0.0 && wish > 0.0 { wish } else { 0.0 };
                    let change = next - force;
                    if change != 0.0 {
                        forces[start] = next;
                        displace(displaced, column, &[change]);
                        // These come to rest to the last bit.
                        most_changed = f64::INFINITY;
                    }
                } else {
                    let force = vector(&forces[start..end]);
                    let next = rows[i].next(&force, &vector(&displaced[start..end]), stiffness);
                    let change = next - force;
                    if change != Vector3::zeros() {
                        forces[start..end].copy_from_slice(next.as_slice());
                        displace(displaced, matrix.columns(i), change.as_slice());
                        most_changed = most_changed.max(change.norm_squared());
                    }
                    largest = largest.max(next.norm_squared());
                }
            }
            if most_changed <= SETTLED * SETTLED * largest {
                break;
            }
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// A row's normal.
    pub fn normal(&self, i: usize) -> &Vector3 {
        &self.rows[i].normal
    }

    /// A row's force has all directions.
    pub fn is_whole(&self, i: usize) -> bool {
        self.rows[i].span.len() == 3
    }

    /// By direction, N.
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// Forces that were there before; displacements follow.
    pub fn restore(&mut self, matrix: &ContactMatrix, forces_n: &[f64]) {
        self.forces.copy_from_slice(forces_n);
        self.displaced.copy_from_slice(&self.free);
        for (i, row) in self.rows.iter().enumerate() {
            let force = &self.forces[row.span.clone()];
            if force.iter().any(|n| *n != 0.0) {
                displace(&mut self.displaced, matrix.columns(i), force);
            }
        }
    }

    /// Force that would bring a row to rest by itself, after a solve, N.
    pub fn wish(&self, i: usize) -> Vector3 {
        let row = &self.rows[i];
        row.wish(&self.force_n(i), &self.displaced_m(i), &self.stiffness[i])
    }

    /// Against a row's own displacement, no more than it has, N/m.
    pub fn stiffness(&self, i: usize) -> Matrix3 {
        let ([along, across], normal) = (self.stiffness[i], &self.rows[i].normal);
        let out = normal * normal.transpose();
        out * along + (Matrix3::identity() - out) * across
    }

    /// The most that the law of a row would change its force by, relative to the largest force there is.
    pub fn missed(&self) -> f64 {
        let (mut largest, mut most) = (0.0f64, 0.0f64);
        for i in 0..self.rows.len() {
            let force = self.force_n(i);
            let mut row = self.rows[i].clone();
            let next = row.next(&force, &self.displaced_m(i), &self.stiffness[i]);
            // A number that is none stays.
            most += 0.0 * (next - force).norm_squared();
            most = most.max((next - force).norm_squared());
            largest = largest.max(next.norm_squared());
        }
        match (largest > 0.0, (most + largest).is_finite()) {
            (_, false) => f64::INFINITY,
            (true, true) => (most / largest).sqrt(),
            (false, true) => 0.0,
        }
    }

    /// Force of a row along its normal, N.
    pub fn normal_n(&self, i: usize) -> f64 {
        match &self.forces[self.rows[i].span.clone()] {
            [normal_n] => *normal_n,
            force => self.rows[i].normal.dot(&vector(force)),
        }
    }

    /// The rest of it, N.
    pub fn tangent_n(&self, i: usize) -> Vector3 {
        match self.rows[i].span.len() {
            1 => Vector3::zeros(),
            _ => self.force_n(i) - self.rows[i].normal * self.normal_n(i),
        }
    }

    /// Force of a row, N.
    pub fn force_n(&self, i: usize) -> Vector3 {
        self.rows[i].whole(&self.forces)
    }

    /// True when a row carries a force that is a number.
    pub fn carries(&self, i: usize) -> bool {
        let force = &self.forces[self.rows[i].span.clone()];
        force.iter().any(|n| *n != 0.0) && force.iter().all(|n| n.is_finite())
    }

    /// Replaces the force of a row, after a solve; displacements follow.
    pub fn set_force(&mut self, matrix: &ContactMatrix, i: usize, force_n: &Vector3) {
        let row = &self.rows[i];
        let (along, whole) = ([force_n.dot(&row.normal)], force_n.as_slice());
        let next = if row.span.len() == 1 {
            &along[..]
        } else {
            whole
        };
        let force = &mut self.forces[row.span.clone()];
        let mut change = [0.0; 3];
        for ((change, force), next) in change.iter_mut().zip(force).zip(next) {
            *change = next - *force;
            *force = *next;
        }
        displace(
            &mut self.displaced,
            matrix.columns(i),
            &change[..row.span.len()],
        );
    }

    /// Adds to the force of a row among those of all, N.
    pub fn add_to(&self, forces_n: &mut [f64], i: usize, change_n: &Vector3) {
        let row = &self.rows[i];
        match &mut forces_n[row.span.clone()] {
            [along] => *along += change_n.dot(&row.normal),
            whole => whole
                .iter_mut()
                .zip(change_n)
                .for_each(|(to, by)| *to += by),
        }
    }

    /// Displacement of a row under all forces after a solve, m; of one without friction, along its normal.
    pub fn displaced_m(&self, i: usize) -> Vector3 {
        self.rows[i].whole(&self.displaced)
    }

    /// Gap of a row under all forces after a solve, m.
    pub fn gap_after(&self, i: usize) -> f64 {
        match &self.displaced[self.rows[i].span.clone()] {
            [gap_m] => *gap_m,
            u => self.rows[i].normal.dot(&vector(u)),
        }
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
fn solve_avx2(problem: &mut ContactProblem, matrix: &ContactMatrix, sweeps: usize) {
    problem.sweep(matrix, sweeps);
}

#[inline(always)]
fn vector(values: &[f64]) -> Vector3 {
    Vector3::new(values[0], values[1], values[2])
}

/// u += D f, of one row's columns of D.
#[inline(always)]
fn displace(u: &mut [f64], columns: &[f64], force: &[f64]) {
    debug_assert_eq!(columns.len(), u.len() * force.len(), "a column a direction");
    if let [x, y, z] = force {
        let (of_x, others) = columns.split_at(u.len());
        let (of_y, of_z) = others.split_at(u.len());
        for (((u, a), b), c) in u.iter_mut().zip(of_x).zip(of_y).zip(of_z) {
            *u += (x * a + y * b) + z * c;
        }
    } else {
        for (u, column) in u.iter_mut().zip(columns) {
            *u += force[0] * column;
        }
    }
}

impl Bound {
    /// Its part of numbers by direction, in the world.
    fn whole(&self, values: &[f64]) -> Vector3 {
        match &values[self.span.clone()] {
            [along] => self.normal * *along,
            whole => vector(whole),
        }
    }

    /// Stiffness along the normal and across it, as row `i` of a matrix; zeros where nothing can move
    /// it, or a number is none.
    fn bound(&self, matrix: &ContactMatrix, i: usize) -> [f64; 2] {
        let [along, across] = match self.law {
            // Nothing acts across.
            FrictionLaw::SMOOTH => [matrix.along(i); 2],
            FrictionLaw::Push { .. } => self.along_and_across(&matrix.block(i, i)),
            FrictionLaw::Grip { .. } => {
                let [along, across] = self.along_and_across(&matrix.block(i, i));
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
        if *block == Matrix3::from_diagonal_element(block.m11) {
            return [block.m11; 2];
        }
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
    fn next(&mut self, force: &Vector3, u: &Vector3, stiffness: &[f64; 2]) -> Vector3 {
        let across = stiffness[1];
        if across == 0.0 {
            return Vector3::zeros();
        }
        self.allowed(&self.wish(force, u, stiffness), across)
    }

    /// The force that would bring its displacement to zero, if it alone changed.
    #[inline(always)]
    fn wish(&self, force: &Vector3, u: &Vector3, stiffness: &[f64; 2]) -> Vector3 {
        let [along, across] = *stiffness;
        if along == across {
            return force - u * across;
        }
        let depth = u.dot(&self.normal);
        force - self.normal * (depth * along) - (u - self.normal * depth) * across
    }

    /// The force the row takes when `wish` would bring its displacement to zero; `across`: its stiffness there, N/m.
    #[inline(always)]
    fn allowed(&mut self, wish: &Vector3, across: f64) -> Vector3 {
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
                let drag = drag_n_m / across;
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
