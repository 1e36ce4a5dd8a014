//! Sparse Cholesky factor of a symmetric positive definite matrix of 3 × 3 blocks, kept in single
//! precision for use as a preconditioner.
//!
//! A right-looking supernodal factorisation (Ng & Peyton 1993) in double precision at build: nodes
//! are ordered by approximate minimum degree, and neighbouring nodes with nearly the same rows below
//! them form panels of up to four nodes, twelve columns. What a tick reads is rounded to single
//! precision: half of the memory, which is what a solve waits for. `L̃ L̃ᵀ` is positive definite
//! whatever the rounding, so as a preconditioner it is always safe; as a solver it is good to about
//! 1e-7 times the condition of the matrix.

use super::cholesky::{CholeskyError, SymmetricTriplets, amd_order, elimination_tree};
use super::eight::{BaselineEight, Eight};
use super::{Lane, Matrix3};

/// Widest panel, in nodes.
const PANEL: usize = 4;
/// Columns of the widest panel.
const COLUMNS: usize = 3 * PANEL;
/// A node joins the panel of the node before it while zeros are at most this share of its column.
const FILL: f64 = 0.3;

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
    /// Of each panel: the inverse of its diagonal block (columns of 16 rows), the transposed
    /// inverse, then its rows below, eight scalar rows at a time, column after column.
    values: Vec<f32>,
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
    values_start: u32,
}

/// Scalar rows of a diagonal block, filled up to eights.
const DIAGONAL_ROWS: usize = 16;

/// Buffers of a solve.
#[derive(Clone, Debug, Default)]
pub struct BlockWork {
    /// (3 n + 8).
    x: Vec<f32>,
    /// Rows below a panel.
    below: Vec<f32>,
}

impl BlockCholesky {
    /// Orders and factors.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn new(matrix: &BlockTriplets) -> Result<Self, CholeskyError> {
        let n = matrix.n;
        let mut graph = SymmetricTriplets::new(n);
        for &(i, j, _) in &matrix.entries {
            graph.add(i as usize, j as usize, 1.0);
        }
        let order = amd_order(&graph)?;
        let mut place = vec![0u32; n];
        for (k, &node) in order.iter().enumerate() {
            place[node as usize] = k as u32;
        }
        let structure = Structure::new(matrix, &place);
        let mut numeric = Numeric::new(matrix, &place, &structure);
        numeric.factor(&structure, &order)?;
        Ok(numeric.packed(structure, order))
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
        BlockWork {
            x: vec![0.0; 3 * self.n + 8],
            below: vec![0.0; self.most_rows],
        }
    }

    /// Solves A x = b in place (n, fourth numbers become zero). `b` is scaled by its largest number
    /// first, so that single precision neither overflows nor loses small right-hand sides.
    pub fn solve(&self, b: &mut [Lane], work: &mut BlockWork) {
        debug_assert_eq!(b.len(), self.n, "right-hand side and factor disagree");
        let mut largest = 0.0_f64;
        for lane in b.iter() {
            for value in &lane[..3] {
                largest = if value.abs() > largest {
                    value.abs()
                } else {
                    largest
                };
            }
        }
        if largest == 0.0 {
            b.fill([0.0; 4]);
            return;
        }
        let scale = 1.0 / largest;
        for (place, &node) in self.order.iter().enumerate() {
            let lane = &b[node as usize];
            for c in 0..3 {
                work.x[3 * place + c] = (lane[c] * scale) as f32;
            }
        }
        self.solve_scaled(work);
        for (place, &node) in self.order.iter().enumerate() {
            let x = &work.x[3 * place..3 * place + 3];
            b[node as usize] = [
                f64::from(x[0]) * largest,
                f64::from(x[1]) * largest,
                f64::from(x[2]) * largest,
                0.0,
            ];
        }
    }

    fn solve_scaled(&self, work: &mut BlockWork) {
        #[cfg(target_arch = "x86_64")]
        if super::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { solve_wide(self, work) };
        }
        self.solve_in::<BaselineEight>(work);
    }

    #[inline(always)]
    fn solve_in<E: Eight>(&self, work: &mut BlockWork) {
        for panel in &self.panels {
            match panel.width {
                1 => self.forward::<3, E>(panel, work),
                2 => self.forward::<6, E>(panel, work),
                3 => self.forward::<9, E>(panel, work),
                _ => self.forward::<12, E>(panel, work),
            }
        }
        for panel in self.panels.iter().rev() {
            match panel.width {
                1 => self.backward::<3, E>(panel, work),
                2 => self.backward::<6, E>(panel, work),
                3 => self.backward::<9, E>(panel, work),
                _ => self.backward::<12, E>(panel, work),
            }
        }
    }

    /// The panel's nodes below and its numbers: inverse, transposed inverse, rows below.
    #[inline(always)]
    fn parts<const C: usize>(&self, panel: &Panel) -> (&[u32], &[f32], &[f32], &[f32]) {
        let rows = &self.rows[panel.rows_start as usize..panel.rows_end as usize];
        let groups = (3 * rows.len()).div_ceil(8);
        let values = &self.values[panel.values_start as usize..];
        let (inverse, rest) = values.split_at(C * DIAGONAL_ROWS);
        let (transposed, rest) = rest.split_at(C * DIAGONAL_ROWS);
        (rows, inverse, transposed, &rest[..groups * C * 8])
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
    fn forward<const C: usize, E: Eight>(&self, panel: &Panel, work: &mut BlockWork) {
        let (rows, inverse, _, values) = self.parts::<C>(panel);
        let first = 3 * panel.first as usize;
        let mut own = [0.0; COLUMNS];
        own[..C].copy_from_slice(&work.x[first..first + C]);
        let own = Self::triangle::<C, E>(inverse, &own);
        work.x[first..first + C].copy_from_slice(&own[..C]);
        let mut splats = [E::splat(0.0); C];
        for c in 0..C {
            splats[c] = E::splat(own[c]);
        }
        gather(rows, &work.x, &mut work.below);
        let (groups, _) = values.as_chunks::<8>();
        let (below, _) = work.below.as_chunks_mut::<8>();
        for (group, below) in groups.chunks_exact(C).zip(below) {
            let mut sum = E::load(below);
            for c in 0..C {
                sum = sum.minus(E::load(&group[c]).times(splats[c]));
            }
            sum.store(below);
        }
        for (&row, x) in rows.iter().zip(work.below.chunks_exact(3)) {
            work.x[3 * row as usize..3 * row as usize + 3].copy_from_slice(x);
        }
    }

    #[inline(always)]
    fn backward<const C: usize, E: Eight>(&self, panel: &Panel, work: &mut BlockWork) {
        let (rows, _, transposed, values) = self.parts::<C>(panel);
        let first = 3 * panel.first as usize;
        gather(rows, &work.x, &mut work.below);
        let mut sums = [E::splat(0.0); C];
        let (groups, _) = values.as_chunks::<8>();
        let (below, _) = work.below.as_chunks::<8>();
        for (group, below) in groups.chunks_exact(C).zip(below) {
            let x = E::load(below);
            for c in 0..C {
                sums[c] = sums[c].plus(E::load(&group[c]).times(x));
            }
        }
        let mut own = [0.0; COLUMNS];
        for c in (0..C).step_by(4) {
            let at = |k: usize| {
                if c + k < C {
                    sums[c + k]
                } else {
                    E::splat(0.0)
                }
            };
            let four = E::sums([at(0), at(1), at(2), at(3)]);
            for (k, sum) in four.into_iter().enumerate().take(C - c) {
                own[c + k] = work.x[first + c + k] - sum;
            }
        }
        let own = Self::triangle::<C, E>(transposed, &own);
        work.x[first..first + C].copy_from_slice(&own[..C]);
    }
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
#[target_feature(enable = "avx2")]
fn solve_wide(factor: &BlockCholesky, work: &mut BlockWork) {
    factor.solve_in::<super::eight::WideEight>(work);
}

/// Which nodes form panels, and the rows below each.
struct Structure {
    /// (panels): first node.
    first: Vec<usize>,
    width: Vec<usize>,
    /// (panels): nodes below, ascending.
    below: Vec<Vec<u32>>,
    /// (nodes): panel.
    panel_of: Vec<u32>,
}

impl Structure {
    fn new(matrix: &BlockTriplets, place: &[u32]) -> Self {
        let n = matrix.n;
        let mut upper: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
        for &(i, j, _) in &matrix.entries {
            let (a, b) = (place[i as usize], place[j as usize]);
            upper[a.max(b) as usize].push((a.min(b), 0.0));
        }
        for column in &mut upper {
            column.sort_unstable_by_key(|entry| entry.0);
            column.dedup_by_key(|entry| entry.0);
        }
        let parent = elimination_tree(n, &upper);
        // A node's rows are those of its children and its own, itself excepted.
        let mut below: Vec<Vec<u32>> = vec![Vec::new(); n];
        for (k, column) in upper.iter().enumerate() {
            for &(i, _) in column.iter().filter(|entry| (entry.0 as usize) < k) {
                below[i as usize].push(k as u32);
            }
        }
        for k in 0..n {
            let mut rows = std::mem::take(&mut below[k]);
            rows.sort_unstable();
            rows.dedup();
            if let Some(&first) = rows.first() {
                debug_assert_eq!(first, parent[k], "a node's first row below is its parent");
                let up: Vec<u32> = rows[1..].to_vec();
                below[first as usize].extend(up);
            }
            below[k] = rows;
        }
        let (mut first, mut width, mut panel_of) = (Vec::new(), Vec::new(), vec![0; n]);
        let mut k = 0;
        while k < n {
            let (mut w, mut zeros) = (1, 0);
            while w < PANEL && k + w < n && below[k + w - 1].first() == Some(&((k + w) as u32)) {
                // Each column of the panel takes the rows of the last.
                let more = below[k + w].len() + 1 - below[k + w - 1].len();
                zeros += more * w;
                if zeros as f64 > FILL * (below[k + w].len() + w) as f64 * w as f64 {
                    break;
                }
                w += 1;
            }
            panel_of[k..k + w].fill(first.len() as u32);
            first.push(k);
            width.push(w);
            k += w;
        }
        let last = first
            .iter()
            .zip(&width)
            .map(|(first, width)| first + width - 1);
        let below = last.map(|k| std::mem::take(&mut below[k])).collect();
        Self {
            first,
            width,
            below,
            panel_of,
        }
    }
}

/// A 3 × 3 block by columns.
type Block = [f64; 9];

/// Panels of blocks: for each, its own nodes and those below as rows, `width` blocks a row.
struct Numeric {
    panels: Vec<Vec<Block>>,
}

/// c −= a bᵀ.
#[inline(always)]
fn subtract_product(c: &mut Block, a: &Block, b: &Block) {
    for k in 0..3 {
        for j in 0..3 {
            let factor = b[3 * k + j];
            for i in 0..3 {
                c[3 * j + i] -= a[3 * k + i] * factor;
            }
        }
    }
}

impl Numeric {
    fn new(matrix: &BlockTriplets, place: &[u32], structure: &Structure) -> Self {
        let size = |p: usize| (structure.width[p] + structure.below[p].len()) * structure.width[p];
        let mut panels: Vec<Vec<Block>> = (0..structure.first.len())
            .map(|p| vec![[0.0; 9]; size(p)])
            .collect();
        for (i, j, block) in &matrix.entries {
            let (a, b) = (place[*i as usize], place[*j as usize]);
            let block = if a >= b { *block } else { block.transpose() };
            let (row, column) = (a.max(b), a.min(b) as usize);
            let p = structure.panel_of[column] as usize;
            let width = structure.width[p];
            let at = structure.row_in(p, row) * width + column - structure.first[p];
            let numbers = block.as_slice();
            for (to, value) in panels[p][at].iter_mut().zip(numbers) {
                *to += value;
            }
        }
        Self { panels }
    }

    fn factor(&mut self, structure: &Structure, order: &[u32]) -> Result<(), CholeskyError> {
        let mut local = vec![0u32; structure.panel_of.len()];
        for p in 0..self.panels.len() {
            let width = structure.width[p];
            self.factor_panel(p, width, structure, order)?;
            // What the rows below take from their own columns, panel by panel.
            let below = &structure.below[p];
            let (done, later) = self.panels.split_at_mut(p + 1);
            let own = &done[p][width * width..];
            let mut c = 0;
            while c < below.len() {
                let target = structure.panel_of[below[c] as usize] as usize;
                let (first, wide) = (structure.first[target], structure.width[target]);
                for k in 0..wide {
                    local[first + k] = k as u32;
                }
                for (k, &row) in structure.below[target].iter().enumerate() {
                    local[row as usize] = (wide + k) as u32;
                }
                let values = &mut later[target - p - 1];
                while c < below.len() && structure.panel_of[below[c] as usize] as usize == target {
                    let column = below[c] as usize - first;
                    let right = &own[c * width..(c + 1) * width];
                    for r in c..below.len() {
                        let left = &own[r * width..(r + 1) * width];
                        let to = &mut values[local[below[r] as usize] as usize * wide + column];
                        for (a, b) in left.iter().zip(right) {
                            subtract_product(to, a, b);
                        }
                    }
                    c += 1;
                }
            }
        }
        Ok(())
    }

    /// Factors the diagonal block of a panel and solves for its rows below.
    fn factor_panel(
        &mut self,
        p: usize,
        width: usize,
        structure: &Structure,
        order: &[u32],
    ) -> Result<(), CholeskyError> {
        let values = &mut self.panels[p];
        let rows = values.len() / width;
        for column in 0..width {
            for c in 0..3 {
                // Scalar column 3 column + c, by those before it.
                let get = |values: &[Block], row: usize, r: usize, k: usize, q: usize| {
                    values[row * width + k][3 * q + r]
                };
                let mut pivot = get(values, column, c, column, c);
                for k in 0..column {
                    for q in 0..3 {
                        pivot -= get(values, column, c, k, q).powi(2);
                    }
                }
                for q in 0..c {
                    pivot -= get(values, column, c, column, q).powi(2);
                }
                if !(pivot.is_finite() && pivot > 0.0) {
                    let row = order[structure.first[p] + column] as usize;
                    return Err(CholeskyError::Pivot { row, pivot });
                }
                let root = pivot.sqrt();
                let inverse = 1.0 / root;
                for row in column..rows {
                    for r in 0..3 {
                        if row == column && r <= c {
                            continue;
                        }
                        let mut value = get(values, row, r, column, c);
                        for k in 0..column {
                            for q in 0..3 {
                                value -= get(values, row, r, k, q) * get(values, column, c, k, q);
                            }
                        }
                        for q in 0..c {
                            value -=
                                get(values, row, r, column, q) * get(values, column, c, column, q);
                        }
                        values[row * width + column][3 * c + r] = value * inverse;
                    }
                }
                values[column * width + column][3 * c + c] = root;
                for r in 0..c {
                    values[column * width + column][3 * c + r] = 0.0;
                }
            }
        }
        Ok(())
    }

    fn packed(self, structure: Structure, order: Vec<u32>) -> BlockCholesky {
        let (mut panels, mut rows, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let (mut most_rows, mut non_zeros) = (8, 0);
        for (p, blocks) in self.panels.iter().enumerate() {
            let (width, below) = (structure.width[p], &structure.below[p]);
            let columns = 3 * width;
            let at = |row: usize, column: usize| {
                blocks[(row / 3) * width + column / 3][3 * (column % 3) + row % 3]
            };
            let inverse = inverse_of_triangle(columns, at);
            let start = values.len();
            for transposed in [false, true] {
                for column in 0..columns {
                    let mut padded = [0.0f32; DIAGONAL_ROWS];
                    for (row, value) in padded.iter_mut().enumerate().take(columns) {
                        let (r, c) = if transposed {
                            (column, row)
                        } else {
                            (row, column)
                        };
                        *value = inverse[r][c] as f32;
                    }
                    values.extend_from_slice(&padded);
                }
            }
            let count = 3 * below.len();
            for group in 0..count.div_ceil(8) {
                for column in 0..columns {
                    for r in 0..8 {
                        let row = 8 * group + r;
                        let value = if row < count {
                            at(columns + row, column)
                        } else {
                            0.0
                        };
                        values.push(value as f32);
                    }
                }
            }
            non_zeros += columns * (columns + 1) / 2 + columns * count;
            most_rows = most_rows.max(count.next_multiple_of(8));
            panels.push(Panel {
                first: structure.first[p] as u32,
                width: width as u32,
                rows_start: rows.len() as u32,
                rows_end: (rows.len() + below.len()) as u32,
                values_start: start as u32,
            });
            rows.extend_from_slice(below);
        }
        BlockCholesky {
            n: order.len(),
            order,
            panels,
            rows,
            values,
            most_rows,
            non_zeros,
        }
    }
}

impl Structure {
    /// Row of a panel's blocks in which a node is.
    fn row_in(&self, panel: usize, node: u32) -> usize {
        let (first, width) = (self.first[panel], self.width[panel]);
        match (node as usize).checked_sub(first) {
            Some(own) if own < width => own,
            _ => width + self.below[panel].partition_point(|&row| row < node),
        }
    }
}

/// Inverse of a lower triangle of up to twelve rows.
fn inverse_of_triangle(size: usize, at: impl Fn(usize, usize) -> f64) -> [[f64; COLUMNS]; COLUMNS] {
    let mut inverse = [[0.0; COLUMNS]; COLUMNS];
    for column in 0..size {
        for row in column..size {
            let mut value = if row == column { 1.0 } else { 0.0 };
            for k in column..row {
                value -= at(row, k) * inverse[k][column];
            }
            inverse[row][column] = value / at(row, row);
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Random, Vector3};
    use nalgebra::{DMatrix, DVector};

    /// Springs between neighbours of a box of nodes, diagonals too, and a little mass.
    fn lattice(side: usize, mass: f64) -> (BlockTriplets, DMatrix<f64>) {
        let n = side * side * side;
        let (mut sparse, mut dense) = (BlockTriplets::new(n), DMatrix::zeros(3 * n, 3 * n));
        let mut random = Random(7);
        let mut add = |i: usize, j: usize, block: Matrix3| {
            sparse.add(i, j, block);
            for r in 0..3 {
                for c in 0..3 {
                    dense[(3 * i + r, 3 * j + c)] += block[(r, c)];
                    if i != j {
                        dense[(3 * j + c, 3 * i + r)] += block[(r, c)];
                    }
                }
            }
        };
        let index = |x: usize, y: usize, z: usize| (x * side + y) * side + z;
        for x in 0..side {
            for y in 0..side {
                for z in 0..side {
                    let i = index(x, y, z);
                    add(i, i, Matrix3::identity() * mass);
                    let near = [
                        (1, 0, 0),
                        (0, 1, 0),
                        (0, 0, 1),
                        (1, 1, 0),
                        (0, 1, 1),
                        (1, 0, 1),
                    ];
                    for (dx, dy, dz) in near {
                        if x + dx < side && y + dy < side && z + dz < side {
                            let j = index(x + dx, y + dy, z + dz);
                            let way = Vector3::new(dx as f64, dy as f64, dz as f64)
                                + random.vector() * 0.1;
                            let block = way * way.transpose() * (1.0 + random.float(0.0, 1.0));
                            add(i, i, block);
                            add(j, j, block);
                            add(i, j, -block);
                        }
                    }
                }
            }
        }
        (sparse, dense)
    }

    #[test]
    fn blocks_are_solved_as_a_dense_matrix_is() {
        for (side, mass) in [(1, 1.0), (2, 0.3), (5, 0.3), (6, 3.0)] {
            let (sparse, dense) = lattice(side, mass);
            let factor = BlockCholesky::new(&sparse).unwrap();
            let oracle = dense.cholesky().unwrap();
            let mut random = Random(11);
            for scale in [1.0, 1e-30, 1e30] {
                let mut x: Vec<Lane> = (0..sparse.n)
                    .map(|_| {
                        let v = random.vector() * scale;
                        [v.x, v.y, v.z, 0.0]
                    })
                    .collect();
                let flat = x.iter().flat_map(|lane| lane[..3].to_vec());
                let expected = oracle.solve(&DVector::from_iterator(3 * sparse.n, flat));
                factor.solve(&mut x, &mut factor.work());
                let largest = expected.amax();
                for (i, lane) in x.iter().enumerate() {
                    for c in 0..3 {
                        // Single precision times a condition of about a hundred.
                        let off = (lane[c] - expected[3 * i + c]).abs() / largest;
                        assert!(off < 2e-5, "node {i} of {}: off by {off}", sparse.n);
                    }
                }
            }
        }
    }

    #[test]
    fn no_load_moves_nothing_and_an_indefinite_matrix_is_refused() {
        let (sparse, _) = lattice(3, 1.0);
        let factor = BlockCholesky::new(&sparse).unwrap();
        let mut x = vec![[0.0, 0.0, 0.0, 5.0]; sparse.n];
        factor.solve(&mut x, &mut factor.work());
        assert!(x.iter().all(|lane| *lane == [0.0; 4]));
        let mut worse = sparse.clone();
        worse.add(4, 4, Matrix3::identity() * -100.0);
        let error = BlockCholesky::new(&worse).unwrap_err();
        assert!(matches!(error, CholeskyError::Pivot { .. }), "{error}");
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn wide_registers_and_the_baseline_have_the_same_bits() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            eprintln!("skipped: this processor has no AVX2");
            return;
        }
        let (sparse, _) = lattice(6, 0.5);
        let factor = BlockCholesky::new(&sparse).unwrap();
        let mut wide = factor.work();
        for (k, x) in wide.x.iter_mut().enumerate() {
            *x = 1.0 / (1.0 + k as f32);
        }
        let mut plain = wide.clone();
        factor.solve_in::<BaselineEight>(&mut plain);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            solve_wide(&factor, &mut wide);
        }
        let bits = |work: &BlockWork| work.x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&plain), bits(&wide));
    }
}
