//! Ordering, factorisation and packing, in double precision.

use super::{Below, BlockCholesky, BlockTriplets, COLUMNS, DIAGONAL_ROWS, PANEL, Panel};
use crate::math::cholesky::{CholeskyError, elimination_tree};
use crate::math::{Lane, Point3, Random, ordering};

/// A node joins the panel of the node before it while zeros are at most this share of its column.
const FILL: f64 = 0.3;
/// Rounds of the power method that finds what a factor misses most.
const ROUNDS: usize = 12;

/// Orders and factors; numbers below are in single precision. `None` where they would be more than
/// `most`.
pub(super) fn factor(
    matrix: &BlockTriplets,
    places: &[Point3],
    most: usize,
) -> Result<Option<BlockCholesky>, CholeskyError> {
    let n = matrix.n;
    let pairs = matrix.entries.iter().map(|&(i, j, _)| (i, j));
    let order = ordering::order(&ordering::adjacent(n, pairs), places)?;
    let mut place = vec![0u32; n];
    for (k, &node) in order.iter().enumerate() {
        place[node as usize] = k as u32;
    }
    let scales = scales(matrix, &place);
    let structure = Structure::new(matrix, &place);
    if structure.non_zeros() > most {
        return Ok(None);
    }
    let mut numeric = Numeric::new(matrix, &place, &scales, &structure);
    numeric.factor(&structure, &order)?;
    Ok(Some(numeric.packed(structure, order, scales)))
}

/// (places): one over the root of the diagonal block's mean; 1 where that is not positive, and the
/// factorisation will say so.
fn scales(matrix: &BlockTriplets, place: &[u32]) -> Vec<f32> {
    let mut diagonal = vec![0.0; matrix.n];
    for (i, j, block) in &matrix.entries {
        if i == j {
            diagonal[place[*i as usize] as usize] += block.trace() / 3.0;
        }
    }
    let scale = |mean: f64| (1.0 / mean.sqrt()) as f32;
    let usable = |scale: &f32| scale.is_finite() && *scale > 0.0;
    diagonal
        .into_iter()
        .map(|mean| Some(scale(mean)).filter(usable).unwrap_or(1.0))
        .collect()
}

/// The largest share of a motion that a solve with the matrix times it leaves out or adds, by the power
/// method on `x − S⁻¹ B̃⁻¹ B S x` from random motions, in scaled coordinates.
pub(super) fn worst_error(matrix: &BlockTriplets, factor: &BlockCholesky) -> f64 {
    let mut random = Random(3);
    let mut work = factor.work();
    let mut scale = vec![1.0; matrix.n];
    for (place, &node) in factor.order.iter().enumerate() {
        scale[node as usize] = f64::from(factor.scales[place]);
    }
    let mut x: Vec<Lane> = (0..matrix.n)
        .map(|_| {
            let v = random.vector();
            [v.x, v.y, v.z, 0.0]
        })
        .collect();
    let mut worst = 0.0;
    for _ in 0..ROUNDS {
        let size = norm(&x);
        if size == 0.0 {
            break;
        }
        let mut y = vec![[0.0; 4]; matrix.n];
        for (lane, s) in x.iter_mut().zip(&scale) {
            *lane = lane.map(|value| value * s / size);
        }
        for (i, j, block) in &matrix.entries {
            let (i, j) = (*i as usize, *j as usize);
            for r in 0..3 {
                for c in 0..3 {
                    y[i][r] += block[(r, c)] * x[j][c];
                    if i != j {
                        y[j][c] += block[(r, c)] * x[i][r];
                    }
                }
            }
        }
        factor.solve(&mut y, &mut work);
        for ((lane, solved), s) in x.iter_mut().zip(&y).zip(&scale) {
            for (value, solved) in lane.iter_mut().zip(solved) {
                *value = (*value - solved) / s;
            }
        }
        worst = norm(&x);
    }
    worst
}

fn norm(x: &[Lane]) -> f64 {
    x.iter().flatten().map(|v| v * v).sum::<f64>().sqrt()
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
    fn new(matrix: &BlockTriplets, place: &[u32], scales: &[f32], structure: &Structure) -> Self {
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
            let scale = f64::from(scales[row as usize]) * f64::from(scales[column]);
            let numbers = block.as_slice();
            for (to, value) in panels[p][at].iter_mut().zip(numbers) {
                *to += value * scale;
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

    fn packed(self, structure: Structure, order: Vec<u32>, scales: Vec<f32>) -> BlockCholesky {
        let (mut panels, mut rows) = (Vec::new(), Vec::new());
        let (mut diagonals, mut values) = (Vec::new(), Vec::new());
        let (mut most_rows, non_zeros) = (8, structure.non_zeros());
        for (p, blocks) in self.panels.iter().enumerate() {
            let (width, below) = (structure.width[p], &structure.below[p]);
            let columns = 3 * width;
            let at = |row: usize, column: usize| {
                blocks[(row / 3) * width + column / 3][3 * (column % 3) + row % 3]
            };
            let inverse = inverse_of_triangle(columns, at);
            let (diagonal_start, below_start) = (diagonals.len(), values.len());
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
                    diagonals.extend_from_slice(&padded);
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
            most_rows = most_rows.max(count.next_multiple_of(8));
            panels.push(Panel {
                first: structure.first[p] as u32,
                width: width as u32,
                rows_start: rows.len() as u32,
                rows_end: (rows.len() + below.len()) as u32,
                diagonal_start: diagonal_start as u32,
                below_start: below_start as u32,
            });
            rows.extend_from_slice(below);
        }
        BlockCholesky {
            n: order.len(),
            order,
            panels,
            rows,
            scales,
            diagonals,
            below: Below::Single(values),
            most_rows,
            non_zeros,
        }
    }
}

impl Structure {
    /// Numbers in the factor.
    fn non_zeros(&self) -> usize {
        let panels = self.width.iter().zip(&self.below);
        panels
            .map(|(width, below)| {
                let (columns, rows) = (3 * width, 3 * below.len());
                columns * (columns + 1) / 2 + columns * rows
            })
            .sum()
    }

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
