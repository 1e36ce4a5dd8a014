//! Ordering, factorisation and packing, in double precision.

use super::{Below, BlockCholesky, BlockTriplets, COLUMNS, DIAGONAL_ROWS, PANEL, Panel};
use crate::math::cholesky::{CholeskyError, elimination_tree};
#[cfg(target_arch = "x86_64")]
use crate::math::lanes::Wide;
use crate::math::lanes::{Baseline, Lanes, load, store};
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
    let order =
        ordering::order(&ordering::adjacent(n, pairs), places).ok_or(CholeskyError::Ordering)?;
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

/// Panels in numbers: for each, its columns one after another, in each the rows of its own nodes, then of those below.
struct Numeric {
    panels: Vec<Dense>,
}

/// Rows that a kernel takes at once.
const ROWS: usize = 8;

/// A panel of numbers by columns.
struct Dense {
    columns: usize,
    /// Numbers from one column to the next: the rows, filled up by a kernel's width.
    stride: usize,
    values: Vec<f64>,
}

impl Dense {
    fn zeros(columns: usize, rows: usize) -> Self {
        let stride = rows.next_multiple_of(ROWS) + ROWS;
        Self {
            columns,
            stride,
            values: vec![0.0; columns * stride],
        }
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.stride + row]
    }

    fn at_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.values[column * self.stride + row]
    }

    /// Factors the columns over all `rows`; the number of a column whose pivot is not positive, and the pivot.
    #[inline(always)]
    fn factor<L: Lanes>(&mut self, rows: usize) -> Result<(), (usize, f64)> {
        for column in 0..self.columns {
            let (before, own) = self.values.split_at_mut(column * self.stride);
            let before = before.chunks_exact(self.stride);
            let mut pivot = own[column];
            for left in before.clone() {
                pivot -= left[column] * left[column];
            }
            if !(pivot.is_finite() && pivot > 0.0) {
                return Err((column, pivot));
            }
            let root = pivot.sqrt();
            let inverse = L::splat(1.0 / root);
            for row in (column / 4 * 4..rows).step_by(4) {
                let mut sum = load::<L>(own, row);
                for left in before.clone() {
                    sum = sum - load::<L>(left, row) * L::splat(left[column]);
                }
                store(sum * inverse, own, row);
            }
            own[..column].fill(0.0);
            own[column] = root;
        }
        Ok(())
    }
}

/// c −= a bᵀ for the three columns of a node: `source` are its panel's numbers from row `first` on, which is also where b is;
/// the three rows of each node of c begin where `nodes` say, and `target` begins with its first column.
#[inline(always)]
fn subtract<L: Lanes>(
    source: &Dense,
    first: usize,
    target: &mut [f64],
    stride: usize,
    nodes: &[usize],
    lanes: &mut [Vec<f64>; 3],
) {
    for (c, lane) in lanes.iter_mut().enumerate() {
        let column = &target[c * stride..][..stride];
        for (&at, to) in nodes.iter().zip(lane.chunks_exact_mut(3)) {
            to.copy_from_slice(&column[at..at + 3]);
        }
    }
    let columns = source.values.chunks_exact(source.stride);
    let [x, y, z] = &mut *lanes;
    for row in (0..3 * nodes.len()).step_by(ROWS) {
        let four = |at: usize| [load::<L>(x, at), load::<L>(y, at), load::<L>(z, at)];
        let (mut sums, mut more) = (four(row), four(row + 4));
        for column in columns.clone() {
            let column = &column[first..];
            let (a, b) = (load::<L>(column, row), load::<L>(column, row + 4));
            for c in 0..3 {
                let factor = L::splat(column[c]);
                sums[c] = sums[c] - a * factor;
                more[c] = more[c] - b * factor;
            }
        }
        for (c, lane) in [&mut *x, &mut *y, &mut *z].into_iter().enumerate() {
            store(sums[c], lane, row);
            store(more[c], lane, row + 4);
        }
    }
    for (c, lane) in lanes.iter().enumerate() {
        let column = &mut target[c * stride..][..stride];
        for (&at, from) in nodes.iter().zip(lane.chunks_exact(3)) {
            column[at..at + 3].copy_from_slice(from);
        }
    }
}

impl Numeric {
    fn new(matrix: &BlockTriplets, place: &[u32], scales: &[f32], structure: &Structure) -> Self {
        let dense = |(&width, below): (&usize, &Vec<u32>)| {
            Dense::zeros(3 * width, 3 * (width + below.len()))
        };
        let mut panels: Vec<Dense> = (structure.width.iter().zip(&structure.below))
            .map(dense)
            .collect();
        for (i, j, block) in &matrix.entries {
            let (a, b) = (place[*i as usize], place[*j as usize]);
            let block = if a >= b { *block } else { block.transpose() };
            let (row, column) = (a.max(b), a.min(b) as usize);
            let p = structure.panel_of[column] as usize;
            let first = 3 * structure.row_in(p, row);
            let scale = f64::from(scales[row as usize]) * f64::from(scales[column]);
            for c in 0..3 {
                for r in 0..3 {
                    let column = 3 * (column - structure.first[p]) + c;
                    *panels[p].at_mut(first + r, column) += block[(r, c)] * scale;
                }
            }
        }
        Self { panels }
    }

    fn factor(&mut self, structure: &Structure, order: &[u32]) -> Result<(), CholeskyError> {
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { factor_wide(self, structure, order) };
        }
        self.factor_in::<Baseline>(structure, order)
    }

    #[inline(always)]
    fn factor_in<L: Lanes>(
        &mut self,
        structure: &Structure,
        order: &[u32],
    ) -> Result<(), CholeskyError> {
        let mut local = vec![0u32; structure.panel_of.len()];
        let most = self.panels.iter().map(|panel| panel.stride).max();
        let mut lanes = [(); 3].map(|()| vec![0.0; most.unwrap_or(0)]);
        let mut nodes = Vec::new();
        for p in 0..self.panels.len() {
            let (width, below) = (structure.width[p], &structure.below[p]);
            (self.panels[p].factor::<L>(3 * (width + below.len()))).map_err(
                |(column, pivot)| CholeskyError::Pivot {
                    row: order[structure.first[p] + column / 3] as usize,
                    pivot,
                },
            )?;
            // What the rows below take from their own columns, panel by panel.
            let (done, later) = self.panels.split_at_mut(p + 1);
            let own = &done[p];
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
                let Dense { stride, values, .. } = &mut later[target - p - 1];
                while c < below.len() && structure.panel_of[below[c] as usize] as usize == target {
                    nodes.clear();
                    let rows = below[c..].iter();
                    nodes.extend(rows.map(|&row| 3 * local[row as usize] as usize));
                    let column = 3 * (below[c] as usize - first);
                    let values = &mut values[column * *stride..];
                    subtract::<L>(own, 3 * (width + c), values, *stride, &nodes, &mut lanes);
                    c += 1;
                }
            }
        }
        Ok(())
    }

    fn packed(self, structure: Structure, order: Vec<u32>, scales: Vec<f32>) -> BlockCholesky {
        let (mut panels, mut rows) = (Vec::new(), Vec::new());
        let (mut diagonals, mut values) = (Vec::new(), Vec::new());
        let (mut most_rows, non_zeros) = (8, structure.non_zeros());
        for (p, panel) in self.panels.iter().enumerate() {
            let (width, below) = (structure.width[p], &structure.below[p]);
            let columns = 3 * width;
            let at = |row: usize, column: usize| panel.at(row, column);
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

/// [`Numeric::factor_in`] with 256-bit registers and without fused multiply-add: it gives the bits of the baseline.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn factor_wide(
    numeric: &mut Numeric,
    structure: &Structure,
    order: &[u32],
) -> Result<(), CholeskyError> {
    numeric.factor_in::<Wide>(structure, order)
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
    use crate::math::Matrix3;

    /// A matrix of nodes in a box, each tied to its neighbours by blocks that are not diagonal, and where they are.
    fn tied(counts: [usize; 3], random: &mut Random) -> (BlockTriplets, Vec<Point3>) {
        let n = counts.iter().product();
        let place = |k: usize| {
            let [_, b, c] = counts;
            Point3::new((k / (b * c)) as f64, (k / c % b) as f64, (k % c) as f64)
        };
        let mut matrix = BlockTriplets::new(n);
        for i in 0..n {
            matrix.add(i, i, Matrix3::identity());
            for j in 0..i {
                if (place(i) - place(j)).norm() < 1.5 {
                    let a = random.vector();
                    let block = a * a.transpose();
                    matrix.add(i, i, block);
                    matrix.add(j, j, block);
                    matrix.add(i, j, -block);
                }
            }
        }
        (matrix, (0..n).map(place).collect())
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn wide_registers_factor_to_the_bits_of_the_baseline() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            eprintln!("skipped: this processor has no AVX2");
            return;
        }
        let mut random = Random(11);
        for counts in [[1, 1, 1], [1, 1, 5], [2, 3, 4], [7, 6, 5], [3, 20, 4]] {
            let (matrix, _) = tied(counts, &mut random);
            let place: Vec<u32> = (0..matrix.n as u32).collect();
            let structure = Structure::new(&matrix, &place);
            let scales = scales(&matrix, &place);
            let make = || Numeric::new(&matrix, &place, &scales, &structure);
            let (mut plain, mut wide) = (make(), make());
            plain.factor_in::<Baseline>(&structure, &place).unwrap();
            // SAFETY: asked just above.
            #[allow(unsafe_code)]
            unsafe {
                factor_wide(&mut wide, &structure, &place).unwrap();
            }
            let bits = |numeric: &Numeric| -> Vec<u64> {
                let panels = numeric.panels.iter();
                panels
                    .flat_map(|panel| panel.values.iter().map(|x| x.to_bits()))
                    .collect()
            };
            assert_eq!(bits(&plain), bits(&wide), "{counts:?}");
        }
    }

    #[test]
    fn the_factor_times_its_transposed_is_the_matrix() {
        let mut random = Random(5);
        for counts in [[1, 1, 2], [4, 4, 4], [2, 11, 3]] {
            let (matrix, places) = tied(counts, &mut random);
            let factor = factor(&matrix, &places, usize::MAX).unwrap().unwrap();
            // Single precision of a well conditioned matrix.
            assert!(worst_error(&matrix, &factor) < 1e-4, "{counts:?}");
        }
    }
}
