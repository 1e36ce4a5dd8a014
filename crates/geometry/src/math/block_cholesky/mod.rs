//! Sparse Cholesky factor of a symmetric positive definite matrix of 3 × 3 blocks, kept in single
//! precision for use as a preconditioner.
//!
//! A right-looking supernodal factorisation (Ng & Peyton 1993) in double precision at build: nodes
//! are ordered by approximate minimum degree or nested dissection, and neighbouring nodes with nearly the same rows below
//! them form panels of up to four nodes, twelve columns. A solve waits for memory, so what it reads is
//! rounded: to half precision (11 bits) where a factor so rounded still inverts the matrix within
//! [`HALF_ERROR`], measured at build, and else to single precision. Rows are scaled to a diagonal near
//! one first, so that half precision has the range. `L̃ L̃ᵀ` is positive definite whatever the
//! rounding, so as a preconditioner it is always safe; as a solver it is as good as its rounding times
//! the square root of the condition (half) or the condition (single precision) of the matrix.

mod build;
mod half;

use super::cholesky::CholeskyError;
use super::eight::{BaselineEight, Eight};
use super::{Lane, Matrix3, Point3};
use half::Stored;

/// Widest panel, in nodes.
const PANEL: usize = 4;
/// Columns of the widest panel.
const COLUMNS: usize = 3 * PANEL;
/// Largest share by which a factor in half precision may miss any motion; a larger one is kept in
/// single precision.
const HALF_ERROR: f64 = 0.01;

/// A symmetric matrix of 3 × 3 blocks by its lower triangle; blocks given twice are added.
#[derive(Clone, Debug, Default)]
pub struct BlockTriplets {
    /// Number of nodes: a third of the order of the matrix.
    pub n: usize,
    /// (row, column, block) with row >= column.
    pub entries: Vec<(u32, u32, Matrix3)>,
}

impl BlockTriplets {
    /// An empty matrix of `n` nodes.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            entries: Vec::new(),
        }
    }

    /// Adds to block (i, j) and the transposed one to its mirror; on the diagonal to (i, i) alone.
    pub fn add(&mut self, i: usize, j: usize, block: Matrix3) {
        if i >= j {
            self.entries.push((i as u32, j as u32, block));
        } else {
            self.entries.push((j as u32, i as u32, block.transpose()));
        }
    }
}

/// P A Pᵀ = L Lᵀ, in blocks.
#[derive(Clone, Debug)]
pub struct BlockCholesky {
    n: usize,
    /// `order[k]`: node of the given matrix at place k of the factor.
    order: Vec<u32>,
    panels: Vec<Panel>,
    /// Nodes below each panel, panel after panel.
    rows: Vec<u32>,
    /// (places): the rows of the matrix are multiplied by this before it is factored, and so are
    /// its columns.
    scales: Vec<f32>,
    /// Of each panel: the inverse of its diagonal block (columns of 16 rows), then the transposed
    /// inverse.
    diagonals: Vec<f32>,
    /// Of each panel: its rows below, eight scalar rows at a time, column after column.
    below: Below,
    /// Most scalar rows below a panel, filled up to eights.
    most_rows: usize,
    non_zeros: usize,
}

#[derive(Clone, Copy, Debug)]
struct Panel {
    first: u32,
    width: u32,
    rows_start: u32,
    rows_end: u32,
    diagonal_start: u32,
    below_start: u32,
}

/// Numbers below the panels.
#[derive(Clone, Debug)]
enum Below {
    Single(Vec<f32>),
    /// IEEE 754 binary16.
    Half(Vec<u16>),
}

/// Scalar rows of a diagonal block, filled up to eights.
const DIAGONAL_ROWS: usize = 16;

/// Buffers of a solve of `M` right-hand sides.
#[derive(Clone, Debug)]
pub struct BlockWork<const M: usize = 1> {
    /// (3 n + 8) each.
    x: [Vec<f32>; M],
    /// Rows below a panel.
    below: [Vec<f32>; M],
    /// Their largest numbers.
    largest: [f64; M],
}

impl<const M: usize> Default for BlockWork<M> {
    fn default() -> Self {
        Self {
            x: [const { Vec::new() }; M],
            below: [const { Vec::new() }; M],
            largest: [0.0; M],
        }
    }
}

impl BlockCholesky {
    /// Orders and factors.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn new(matrix: &BlockTriplets) -> Result<Self, CholeskyError> {
        let factor = Self::placed(matrix, &[], usize::MAX)?;
        factor.ok_or(CholeskyError::Ordering)
    }

    /// Orders a large matrix by nested dissection, where that makes the factor smaller, and factors;
    /// `places` (n, or none) are where its nodes are, m. `None`, before any factorisation, where the factor
    /// would have more numbers than `most`.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn placed(
        matrix: &BlockTriplets,
        places: &[Point3],
        most: usize,
    ) -> Result<Option<Self>, CholeskyError> {
        let Some(mut factor) = build::factor(matrix, places, most)? else {
            return Ok(None);
        };
        let Below::Single(single) = &factor.below else {
            return Ok(Some(factor));
        };
        let halved = half::halved(single);
        let single = std::mem::replace(&mut factor.below, Below::Half(halved));
        if build::worst_error(matrix, &factor) > HALF_ERROR {
            factor.below = single;
        }
        Ok(Some(factor))
    }

    /// Bits of the numbers that a solve reads most of: 16 or 32.
    pub fn bits(&self) -> u32 {
        match self.below {
            Below::Half(_) => 16,
            Below::Single(_) => 32,
        }
    }

    /// Number of nodes.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Numbers kept in the factor.
    pub fn non_zeros(&self) -> usize {
        self.non_zeros
    }

    /// Buffers for [`BlockCholesky::solve`].
    pub fn work(&self) -> BlockWork {
        self.work_of()
    }

    /// Buffers for [`BlockCholesky::solve_all`].
    pub fn work_of<const M: usize>(&self) -> BlockWork<M> {
        BlockWork {
            x: std::array::from_fn(|_| vec![0.0; 3 * self.n + 8]),
            below: std::array::from_fn(|_| vec![0.0; self.most_rows]),
            largest: [0.0; M],
        }
    }

    /// Solves A x = b in place (n, fourth numbers become zero). `b` is scaled by its largest number
    /// first, so that single precision neither overflows nor loses small right-hand sides.
    pub fn solve(&self, b: &mut [Lane], work: &mut BlockWork) {
        self.solve_all([b], work);
    }

    /// [`BlockCholesky::solve`] for several right-hand sides, which share the reading of the factor.
    pub fn solve_all<const M: usize>(&self, mut b: [&mut [Lane]; M], work: &mut BlockWork<M>) {
        for ((b, x), largest) in b.iter().zip(&mut work.x).zip(&mut work.largest) {
            *largest = largest_of(b);
            self.enter(b, *largest, x);
        }
        match &self.below {
            Below::Single(below) => self.solve_stored(below, work),
            Below::Half(below) => self.solve_stored(below, work),
        }
        for ((b, x), largest) in b.iter_mut().zip(&work.x).zip(&work.largest) {
            self.leave(x, *largest, b);
        }
    }

    /// A right-hand side in the order of the factor, scaled.
    fn enter(&self, b: &[Lane], largest: f64, x: &mut [f32]) {
        debug_assert_eq!(b.len(), self.n, "right-hand side and factor disagree");
        if largest == 0.0 {
            x.fill(0.0);
            return;
        }
        let scale = 1.0 / largest;
        for (place, &node) in self.order.iter().enumerate() {
            let lane = &b[node as usize];
            for c in 0..3 {
                x[3 * place + c] = (lane[c] * scale) as f32 * self.scales[place];
            }
        }
    }

    /// The solution as the right-hand side was.
    fn leave(&self, x: &[f32], largest: f64, b: &mut [Lane]) {
        for (place, &node) in self.order.iter().enumerate() {
            let x = &x[3 * place..3 * place + 3];
            let scale = f64::from(self.scales[place]) * largest;
            b[node as usize] = [
                f64::from(x[0]) * scale,
                f64::from(x[1]) * scale,
                f64::from(x[2]) * scale,
                0.0,
            ];
        }
    }

    fn solve_stored<S: Stored, const M: usize>(&self, below: &[S], work: &mut BlockWork<M>) {
        #[cfg(target_arch = "x86_64")]
        if super::simd::has_avx2() {
            // SAFETY: the processor has AVX2 and F16C, asked just above.
            #[allow(unsafe_code)]
            return unsafe { solve_wide(self, below, work) };
        }
        self.solve_in::<S, BaselineEight, M>(below, work);
    }

    #[inline(always)]
    fn solve_in<S: Stored, E: Eight, const M: usize>(&self, below: &[S], work: &mut BlockWork<M>) {
        for panel in &self.panels {
            match panel.width {
                1 => self.forward::<3, M, S, E>(panel, below, work),
                2 => self.forward::<6, M, S, E>(panel, below, work),
                3 => self.forward::<9, M, S, E>(panel, below, work),
                _ => self.forward::<12, M, S, E>(panel, below, work),
            }
        }
        for panel in self.panels.iter().rev() {
            // Sums of one right-hand side stay in registers for all columns, those of several for three.
            match (panel.width, M) {
                (1, _) => self.backward::<3, 3, M, S, E>(panel, below, work),
                (2, 1) => self.backward::<6, 6, M, S, E>(panel, below, work),
                (3, 1) => self.backward::<9, 9, M, S, E>(panel, below, work),
                (_, 1) => self.backward::<12, 12, M, S, E>(panel, below, work),
                (2, _) => self.backward::<6, 3, M, S, E>(panel, below, work),
                (3, _) => self.backward::<9, 3, M, S, E>(panel, below, work),
                _ => self.backward::<12, 3, M, S, E>(panel, below, work),
            }
        }
    }

    /// The panel's nodes below, the inverse of its diagonal block and the transposed inverse.
    #[inline(always)]
    fn parts<const C: usize>(&self, panel: &Panel) -> (&[u32], &[f32], &[f32]) {
        let rows = &self.rows[panel.rows_start as usize..panel.rows_end as usize];
        let diagonal = &self.diagonals[panel.diagonal_start as usize..];
        let (inverse, rest) = diagonal.split_at(C * DIAGONAL_ROWS);
        (rows, inverse, &rest[..C * DIAGONAL_ROWS])
    }

    /// The panel's numbers below, in eights.
    #[inline(always)]
    fn groups<'a, const C: usize, S: Stored>(
        panel: &Panel,
        rows: &[u32],
        below: &'a [S],
    ) -> &'a [[S; 8]] {
        let count = (3 * rows.len()).div_ceil(8) * C;
        let (groups, _) = below[panel.below_start as usize..].as_chunks::<8>();
        &groups[..count]
    }

    /// y = T x of a triangle kept in columns of sixteen rows.
    #[inline(always)]
    fn triangle<const C: usize, E: Eight>(
        columns: &[f32],
        x: &[f32; COLUMNS],
    ) -> [f32; DIAGONAL_ROWS] {
        let (columns, _) = columns.as_chunks::<8>();
        let (mut low, mut high) = (E::splat(0.0), E::splat(0.0));
        for c in 0..C {
            let value = E::splat(x[c]);
            low = low.plus(E::load(&columns[2 * c]).times(value));
            if C > 6 {
                high = high.plus(E::load(&columns[2 * c + 1]).times(value));
            }
        }
        let mut out = [0.0; DIAGONAL_ROWS];
        let (first, second) = out.split_at_mut(8);
        low.store(
            first
                .as_chunks_mut::<8>()
                .0
                .first_mut()
                .unwrap_or(&mut [0.0; 8]),
        );
        high.store(
            second
                .as_chunks_mut::<8>()
                .0
                .first_mut()
                .unwrap_or(&mut [0.0; 8]),
        );
        out
    }

    #[inline(always)]
    fn forward<const C: usize, const M: usize, S: Stored, E: Eight>(
        &self,
        panel: &Panel,
        values: &[S],
        work: &mut BlockWork<M>,
    ) {
        let (rows, inverse, _) = self.parts::<C>(panel);
        let groups = Self::groups::<C, S>(panel, rows, values);
        let first = 3 * panel.first as usize;
        let mut own = [[0.0; COLUMNS]; M];
        for (own, x) in own.iter_mut().zip(&work.x) {
            own[..C].copy_from_slice(&x[first..first + C]);
        }
        if own.as_flattened().iter().all(|&x| x == 0.0) {
            // Loads on a few nodes reach few panels on the way down.
            return;
        }
        let mut splats = [[E::splat(0.0); C]; M];
        for m in 0..M {
            let own = Self::triangle::<C, E>(inverse, &own[m]);
            work.x[m][first..first + C].copy_from_slice(&own[..C]);
            for c in 0..C {
                splats[m][c] = E::splat(own[c]);
            }
            gather(rows, &work.x[m], &mut work.below[m]);
        }
        for (g, group) in groups.chunks_exact(C).enumerate() {
            let mut sums = [E::splat(0.0); M];
            for m in 0..M {
                sums[m] = eight_of(&work.below[m], g);
            }
            for c in 0..C {
                let value = S::eight::<E>(&group[c]);
                for m in 0..M {
                    sums[m] = sums[m].minus(value.times(splats[m][c]));
                }
            }
            for m in 0..M {
                let (below, _) = work.below[m].as_chunks_mut::<8>();
                sums[m].store(&mut below[g]);
            }
        }
        for (x, below) in work.x.iter_mut().zip(&work.below) {
            for (&row, from) in rows.iter().zip(below.chunks_exact(3)) {
                x[3 * row as usize..3 * row as usize + 3].copy_from_slice(from);
            }
        }
    }

    /// `W` columns at a time.
    #[inline(always)]
    fn backward<const C: usize, const W: usize, const M: usize, S: Stored, E: Eight>(
        &self,
        panel: &Panel,
        values: &[S],
        work: &mut BlockWork<M>,
    ) {
        let (rows, _, transposed) = self.parts::<C>(panel);
        let groups = Self::groups::<C, S>(panel, rows, values);
        let first = 3 * panel.first as usize;
        for (x, below) in work.x.iter().zip(&mut work.below) {
            gather(rows, x, below);
        }
        let mut own = [[0.0; COLUMNS]; M];
        for start in (0..C).step_by(W) {
            let mut sums = [[E::splat(0.0); W]; M];
            for (g, group) in groups.chunks_exact(C).enumerate() {
                let mut x = [E::splat(0.0); M];
                for m in 0..M {
                    x[m] = eight_of(&work.below[m], g);
                }
                for w in 0..W {
                    let value = S::eight::<E>(&group[start + w]);
                    for m in 0..M {
                        sums[m][w] = sums[m][w].plus(value.times(x[m]));
                    }
                }
            }
            for m in 0..M {
                for w in (0..W).step_by(4) {
                    let at = |k: usize| match sums[m].get(w + k) {
                        Some(sum) => *sum,
                        None => E::splat(0.0),
                    };
                    let four = E::sums([at(0), at(1), at(2), at(3)]);
                    for (k, sum) in four.into_iter().enumerate().take(W - w) {
                        let c = start + w + k;
                        own[m][c] = work.x[m][first + c] - sum;
                    }
                }
            }
        }
        for (own, x) in own.iter().zip(&mut work.x) {
            let own = Self::triangle::<C, E>(transposed, own);
            x[first..first + C].copy_from_slice(&own[..C]);
        }
    }
}

/// The largest size of a number of a right-hand side.
fn largest_of(b: &[Lane]) -> f64 {
    let mut largest = 0.0_f64;
    for lane in b {
        for value in &lane[..3] {
            largest = if value.abs() > largest {
                value.abs()
            } else {
                largest
            };
        }
    }
    largest
}

/// Eight numbers, the first of which is number 8 `group`.
#[inline(always)]
fn eight_of<E: Eight>(numbers: &[f32], group: usize) -> E {
    let (eights, _) = numbers.as_chunks::<8>();
    E::load(&eights[group])
}

/// Rows of the nodes, one after another; zeros up to the next eight.
#[inline(always)]
fn gather(rows: &[u32], x: &[f32], below: &mut [f32]) {
    for (&row, to) in rows.iter().zip(below.chunks_exact_mut(3)) {
        to.copy_from_slice(&x[3 * row as usize..3 * row as usize + 3]);
    }
    let filled = 3 * rows.len();
    below[filled..filled.next_multiple_of(8)].fill(0.0);
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,f16c")]
fn solve_wide<S: Stored, const M: usize>(
    factor: &BlockCholesky,
    below: &[S],
    work: &mut BlockWork<M>,
) {
    factor.solve_in::<S, super::eight::WideEight, M>(below, work);
}

#[cfg(test)]
mod tests;
