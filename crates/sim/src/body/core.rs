//! One matrix of the step, factored, with what it needs of the law and what contact asks of it.

use super::elements::continuum::Growth;
use super::frame::Frame;
use super::grown::Cells;
use super::matter::Matter;
use super::scalar_factor::{ScalarFactor, ScalarWork};
use palpate_geometry::math::{BlockCholesky, BlockWork, Lane, Rows, Vector3};
use std::sync::Arc;

/// A matrix B of the step: A = R B⁻¹ Rᵀ says how loads move the body.
#[derive(Debug)]
pub(super) struct Core {
    pub factor: Factor,
    /// ∂V/∂x of the cells where it was made; none without pressures.
    pub growth: Vec<Growth>,
    /// Frames of the unknowns where it was made; none at rest.
    pub made_in: Vec<Frame>,
    pub surface: SurfaceBlocks,
    /// Cells where it was made; none where nothing follows it.
    pub cells: Cells,
}

/// A factor of 3 × 3 blocks, which turns with the body, or of numbers, which need not.
#[derive(Debug)]
pub(super) enum Factor {
    Blocks(BlockCholesky),
    Scalar(ScalarFactor),
}

/// Buffers of solves.
#[derive(Clone, Debug, Default)]
pub(super) struct FactorWork {
    blocks: BlockWork,
    scalar: ScalarWork,
    vectors: Vec<Vector3>,
}

impl Factor {
    /// Buffers for any of some factors of `n` unknowns.
    pub fn work<'a>(factors: impl Iterator<Item = &'a Self>, n: usize) -> FactorWork {
        let mut work = FactorWork::default();
        for factor in factors {
            match factor {
                Self::Blocks(factor) => work.blocks = factor.work(),
                Self::Scalar(factor) => {
                    work.scalar = factor.work(n);
                    work.vectors.resize(n, Vector3::zeros());
                }
            }
        }
        work
    }

    /// Solves in place (unknowns).
    pub fn solve(&self, rows: &mut [Lane], work: &mut FactorWork) {
        match self {
            Self::Blocks(factor) => factor.solve(rows, &mut work.blocks),
            Self::Scalar(factor) => {
                for (vector, row) in work.vectors.iter_mut().zip(rows.iter()) {
                    *vector = Vector3::new(row[0], row[1], row[2]);
                }
                factor.solve(&mut work.vectors, &mut work.scalar);
                for (row, v) in rows.iter_mut().zip(&work.vectors) {
                    *row = [v.x, v.y, v.z, 0.0];
                }
            }
        }
    }

    /// Numbers in the factor.
    pub fn non_zeros(&self) -> usize {
        match self {
            Self::Blocks(factor) => factor.non_zeros(),
            Self::Scalar(factor) => factor.non_zeros(),
        }
    }

    /// Bits of most of those numbers.
    pub fn bits(&self) -> u32 {
        match self {
            Self::Blocks(factor) => factor.bits(),
            Self::Scalar(ScalarFactor::Double(_)) => 64,
            Self::Scalar(ScalarFactor::Single(_)) => 32,
        }
    }
}

/// B⁻¹ between coordinates of the net, in 3 × 3 blocks, m/N.
#[derive(Debug, Default)]
pub(super) struct SurfaceBlocks {
    count: usize,
    /// (column, row): a block by columns.
    blocks: Vec<[f32; 9]>,
}

impl SurfaceBlocks {
    /// Of the coordinates in [`Matter::surface`], by a factor.
    pub fn new(matter: &Matter, factor: &Factor) -> Self {
        match factor {
            Factor::Blocks(factor) => Self::of_blocks(matter, factor),
            Factor::Scalar(factor) => Self::of_factor(matter, factor),
        }
    }

    /// Of no forces yet, with the unknowns of the coordinates.
    fn zeros(matter: &Matter) -> (Self, Vec<usize>) {
        let unknown = |&c: &u32| matter.unknown[c as usize] as usize;
        let places: Vec<usize> = matter.surface.iter().map(unknown).collect();
        let count = places.len();
        let blocks = vec![[0.0; 9]; count * count];
        (Self { count, blocks }, places)
    }

    fn of_blocks(matter: &Matter, factor: &BlockCholesky) -> Self {
        debug_assert_eq!(factor.n(), matter.unknown_count(), "another matrix");
        let (mut all, places) = Self::zeros(matter);
        let mut rows = [(); 3].map(|()| Rows::zeros(matter.unknown_count()));
        let mut work = factor.work_of();
        for (column, &place) in places.iter().enumerate() {
            for (axis, rows) in rows.iter_mut().enumerate() {
                rows.fill([0.0; 4]);
                rows[place][axis] = 1.0;
            }
            factor.solve_all(rows.each_mut().map(|rows| &mut **rows), &mut work);
            let blocks = &mut all.blocks[column * all.count..][..all.count];
            for (block, &place) in blocks.iter_mut().zip(&places) {
                for (to, rows) in block.chunks_exact_mut(3).zip(&rows) {
                    for (to, value) in to.iter_mut().zip(rows[place]) {
                        *to = value as f32;
                    }
                }
            }
        }
        all.make_symmetric();
        all
    }

    /// By a factor of numbers, which answers alike along all axes.
    fn of_factor(matter: &Matter, factor: &ScalarFactor) -> Self {
        let (mut all, places) = Self::zeros(matter);
        let mut rows = vec![Vector3::zeros(); matter.unknown_count()];
        let mut work = factor.work(matter.unknown_count());
        for (column, &place) in places.iter().enumerate() {
            rows.fill(Vector3::zeros());
            rows[place].x = 1.0;
            factor.solve(&mut rows, &mut work);
            let blocks = &mut all.blocks[column * all.count..][..all.count];
            for (block, &place) in blocks.iter_mut().zip(&places) {
                let value = rows[place].x as f32;
                (block[0], block[4], block[8]) = (value, value, value);
            }
        }
        all.make_symmetric();
        all
    }

    /// Of a body that answers alike in all directions, by `columns` (surface × unknowns), m/N.
    pub fn of_scalars(matter: &Matter, columns: &[f64]) -> Self {
        let count = matter.surface.len();
        let n = matter.unknown_count();
        let block = |column: usize, &row: &u32| {
            let value = columns[column * n + matter.unknown[row as usize] as usize] as f32;
            [value, 0.0, 0.0, 0.0, value, 0.0, 0.0, 0.0, value]
        };
        let rows = |column: usize| matter.surface.iter().map(move |row| block(column, row));
        let mut all = Self {
            count,
            blocks: (0..count).flat_map(rows).collect(),
        };
        all.make_symmetric();
        all
    }

    /// Rounding of the factor is not symmetric.
    fn make_symmetric(&mut self) {
        for a in 0..self.count {
            for b in 0..=a {
                let (there, back) = (a * self.count + b, b * self.count + a);
                for row in 0..3 {
                    for column in 0..3 {
                        let (i, j) = (3 * column + row, 3 * row + column);
                        let mean = 0.5 * (self.blocks[there][i] + self.blocks[back][j]);
                        (self.blocks[there][i], self.blocks[back][j]) = (mean, mean);
                    }
                }
            }
        }
    }

    /// How forces on one coordinate (by its place in [`Matter::surface`]) move all of them.
    #[inline]
    pub fn column(&self, column: usize) -> &[[f32; 9]] {
        &self.blocks[column * self.count..(column + 1) * self.count]
    }

    /// Bytes of the blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
    }
}

/// A matrix that was made beside the loop, to be taken over by a step.
#[derive(Clone, Debug)]
pub struct Made(pub(super) Arc<Core>);
