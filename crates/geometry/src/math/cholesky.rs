//! Sparse Cholesky factor of a constant symmetric positive definite matrix, solved for three
//! right-hand sides at once.
//!
//! Davis, *Direct Methods for Sparse Linear Systems*, ch. 4: ordering, elimination tree,
//! up-looking factorisation. The numeric part is ours, scalar and in fixed order, because a factor
//! must have the same bits on every machine; libraries that pick vector widths at run time do not
//! promise that. Factored at build; a tick only solves.

mod kernel;

use super::ordering::{self, NONE};
use super::{Point3, Vector3};
#[cfg(target_arch = "x86_64")]
use kernel::avx2;
use kernel::{BaselineKernel, Kernel, One, SingleKernel};

/// Why a matrix has no factor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CholeskyError {
    /// A pivot that is not a positive number.
    #[error("pivot {row} is {pivot}: the matrix is not positive definite")]
    Pivot {
        /// Row of the matrix as given.
        row: usize,
        /// The pivot.
        pivot: f64,
    },
    /// The ordering refused the pattern.
    #[error("the ordering of the matrix failed")]
    Ordering,
}

/// A symmetric matrix by its lower triangle; entries given twice are added.
#[derive(Clone, Debug, Default)]
pub struct SymmetricTriplets {
    /// Order of the matrix.
    pub n: usize,
    /// (row, column, value) with row >= column.
    pub entries: Vec<(u32, u32, f64)>,
}

impl SymmetricTriplets {
    /// An empty matrix of order `n`.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            entries: Vec::new(),
        }
    }

    /// Adds to entry (i, j) and its mirror.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries.push((i.max(j) as u32, i.min(j) as u32, value));
    }
}

/// P A Pᵀ = L Lᵀ.
#[derive(Clone, Debug)]
pub struct Cholesky {
    n: usize,
    /// `order[k]`: row of the given matrix at place k of the factor.
    order: Vec<u32>,
    triangle: Triangle<f64>,
    non_zeros: usize,
}

/// A factor rounded to single precision, for use as a preconditioner: a solve with a large factor takes
/// as long as reading it from memory. `L̃ L̃ᵀ` is positive definite whatever the rounding.
#[derive(Clone, Debug)]
pub struct SingleCholesky {
    order: Vec<u32>,
    triangle: Triangle<f32>,
    non_zeros: usize,
}

/// L.
#[derive(Clone, Debug)]
struct Triangle<V> {
    panels: Vec<Panel<V>>,
    /// Rows below each panel, panel after panel.
    rows: Vec<u32>,
    /// For each of those rows, its `width` values side by side.
    values: Vec<V>,
}

/// Up to [`PANEL`] neighbouring columns that share their rows below: loads and stores of the
/// right-hand side are shared too.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Panel<V> {
    first: u32,
    width: u32,
    rows_start: u32,
    rows_end: u32,
    values_start: u32,
    /// `inner[i][j]`, j < i: L within the panel; `inner[i][i]`: 1 / L_ii.
    inner: [[V; PANEL]; PANEL],
}

/// Widest panel: four sums of four lanes stay in registers.
const PANEL: usize = 4;

/// Three right-hand sides of one row and a zero, so that a row fills two or one vector registers.
pub type Lane = [f64; 4];
/// A [`Lane`] in single precision.
pub type SingleLane = [f32; 4];

impl Cholesky {
    /// Orders by approximate minimum degree and factors.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn new(matrix: &SymmetricTriplets) -> Result<Self, CholeskyError> {
        Self::placed(matrix, &[])
    }

    /// Orders a large matrix by nested dissection, where that makes the factor smaller, and factors;
    /// `places` (n, or none) are where its rows are, m.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn placed(matrix: &SymmetricTriplets, places: &[Point3]) -> Result<Self, CholeskyError> {
        let n = matrix.n;
        let pairs = matrix.entries.iter().map(|&(i, j, _)| (i, j));
        let order = ordering::order(&ordering::adjacent(n, pairs), places)
            .ok_or(CholeskyError::Ordering)?;
        let mut place = vec![0u32; n];
        for (k, &row) in order.iter().enumerate() {
            place[row as usize] = k as u32;
        }
        let upper = permuted_upper(matrix, &place);
        let parent = elimination_tree(n, &upper);
        factor(n, order, &upper, &parent)
    }

    /// Rounded to single precision.
    pub fn single(&self) -> SingleCholesky {
        let Triangle {
            panels,
            rows,
            values,
        } = &self.triangle;
        let panel = |panel: &Panel<f64>| Panel {
            first: panel.first,
            width: panel.width,
            rows_start: panel.rows_start,
            rows_end: panel.rows_end,
            values_start: panel.values_start,
            inner: panel.inner.map(|row| row.map(|value| value as f32)),
        };
        SingleCholesky {
            order: self.order.clone(),
            triangle: Triangle {
                panels: panels.iter().map(panel).collect(),
                rows: rows.clone(),
                values: values.iter().map(|&value| value as f32).collect(),
            },
            non_zeros: self.non_zeros,
        }
    }

    /// Order of the matrix.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Non-zeros of L, diagonal included.
    pub fn non_zeros(&self) -> usize {
        self.non_zeros
    }

    /// Solves A x = b for three right-hand sides in place: `b` (n) becomes x. `work` has n lanes.
    pub fn solve(&self, b: &mut [Vector3], work: &mut [Lane]) {
        debug_assert_eq!(b.len(), self.n, "right-hand side and factor disagree");
        for (lane, &row) in work.iter_mut().zip(&self.order) {
            let v = &b[row as usize];
            *lane = [v.x, v.y, v.z, 0.0];
        }
        self.solve_lanes(work);
        for (lane, &row) in work.iter().zip(&self.order) {
            b[row as usize] = Vector3::new(lane[0], lane[1], lane[2]);
        }
    }

    fn solve_lanes(&self, x: &mut [Lane]) {
        #[cfg(target_arch = "x86_64")]
        if super::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { avx2::solve(&self.triangle, x) };
        }
        self.triangle.solve_in_place::<BaselineKernel>(x);
    }

    /// Solves A x = b for one right-hand side in place (n).
    pub fn solve_one(&self, b: &mut [f64]) {
        let mut x: Vec<f64> = self.order.iter().map(|&row| b[row as usize]).collect();
        self.triangle.solve_in_place::<One>(&mut x);
        for (value, &row) in x.iter().zip(&self.order) {
            b[row as usize] = *value;
        }
    }
}

impl SingleCholesky {
    /// Non-zeros of L, diagonal included.
    pub fn non_zeros(&self) -> usize {
        self.non_zeros
    }

    /// Solves A x = b for three right-hand sides in place: `b` (n) becomes x. `work` has n lanes. `b` is
    /// scaled by its largest number first, so that nothing overflows and small ones are not lost.
    pub fn solve(&self, b: &mut [Vector3], work: &mut [SingleLane]) {
        debug_assert_eq!(b.len(), self.order.len(), "right-hand side and factor");
        let sizes = b.iter().flat_map(|v| v.iter()).map(|x| x.abs());
        let largest = sizes.fold(0.0, |most, x| if x > most { x } else { most });
        if largest < f64::MIN_POSITIVE {
            b.fill(Vector3::zeros());
            return;
        }
        let scale = 1.0 / largest;
        for (lane, &row) in work.iter_mut().zip(&self.order) {
            let v = b[row as usize] * scale;
            *lane = [v.x as f32, v.y as f32, v.z as f32, 0.0];
        }
        self.solve_lanes(work);
        for (lane, &row) in work.iter().zip(&self.order) {
            let [x, y, z, _] = lane.map(|x| f64::from(x) * largest);
            b[row as usize] = Vector3::new(x, y, z);
        }
    }

    fn solve_lanes(&self, x: &mut [SingleLane]) {
        #[cfg(target_arch = "x86_64")]
        if super::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { avx2::solve_single(&self.triangle, x) };
        }
        self.triangle.solve_in_place::<SingleKernel>(x);
    }
}

impl<V: Copy> Triangle<V> {
    #[inline(always)]
    fn solve_in_place<K: Kernel<Value = V>>(&self, x: &mut [K::Row]) {
        for panel in &self.panels {
            match panel.width {
                1 => self.forward::<1, K>(panel, x),
                2 => self.forward::<2, K>(panel, x),
                3 => self.forward::<3, K>(panel, x),
                _ => self.forward::<4, K>(panel, x),
            }
        }
        for panel in self.panels.iter().rev() {
            match panel.width {
                1 => self.backward::<1, K>(panel, x),
                2 => self.backward::<2, K>(panel, x),
                3 => self.backward::<3, K>(panel, x),
                _ => self.backward::<4, K>(panel, x),
            }
        }
    }

    #[inline(always)]
    fn forward<const W: usize, K: Kernel<Value = V>>(&self, panel: &Panel<V>, x: &mut [K::Row]) {
        let first = panel.first as usize;
        let mut own = [K::zero(); W];
        for i in 0..W {
            let mut lane = K::load(&x[first + i]);
            for j in 0..i {
                lane = K::minus(lane, own[j], panel.inner[i][j]);
            }
            own[i] = K::times(lane, panel.inner[i][i]);
            K::store(own[i], &mut x[first + i]);
        }
        let (rows, values) = self.below::<W>(panel);
        for (&row, l) in rows.iter().zip(values) {
            let target = &mut x[row as usize];
            let mut lane = K::load(target);
            for i in 0..W {
                lane = K::minus(lane, own[i], l[i]);
            }
            K::store(lane, target);
        }
    }

    #[inline(always)]
    fn backward<const W: usize, K: Kernel<Value = V>>(&self, panel: &Panel<V>, x: &mut [K::Row]) {
        let first = panel.first as usize;
        let mut own = [K::zero(); W];
        for i in 0..W {
            own[i] = K::load(&x[first + i]);
        }
        let (rows, values) = self.below::<W>(panel);
        for (&row, l) in rows.iter().zip(values) {
            let lane = K::load(&x[row as usize]);
            for i in 0..W {
                own[i] = K::minus(own[i], lane, l[i]);
            }
        }
        for i in (0..W).rev() {
            for j in i + 1..W {
                own[i] = K::minus(own[i], own[j], panel.inner[j][i]);
            }
            own[i] = K::times(own[i], panel.inner[i][i]);
            K::store(own[i], &mut x[first + i]);
        }
    }

    #[inline(always)]
    fn below<const W: usize>(&self, panel: &Panel<V>) -> (&[u32], &[[V; W]]) {
        let rows = &self.rows[panel.rows_start as usize..panel.rows_end as usize];
        let start = panel.values_start as usize;
        let (values, _) = self.values[start..start + rows.len() * W].as_chunks::<W>();
        (rows, values)
    }
}

/// Upper triangle of P A Pᵀ by columns: for each column k, (row i <= k, value), rows ascending.
pub(super) type UpperColumns = Vec<Vec<(u32, f64)>>;

fn permuted_upper(matrix: &SymmetricTriplets, place: &[u32]) -> UpperColumns {
    let mut upper: UpperColumns = vec![Vec::new(); matrix.n];
    for &(i, j, value) in &matrix.entries {
        let (a, b) = (place[i as usize], place[j as usize]);
        upper[a.max(b) as usize].push((a.min(b), value));
    }
    for column in &mut upper {
        column.sort_by_key(|entry| entry.0);
        column.dedup_by(|later, earlier| {
            let same = later.0 == earlier.0;
            if same {
                earlier.1 += later.1;
            }
            same
        });
    }
    upper
}

pub(super) fn elimination_tree(n: usize, upper: &UpperColumns) -> Vec<u32> {
    let mut parent = vec![NONE; n];
    let mut ancestor = vec![NONE; n];
    for k in 0..n {
        for &(i, _) in &upper[k] {
            let mut i = i;
            while i != NONE && (i as usize) < k {
                let next = ancestor[i as usize];
                ancestor[i as usize] = k as u32;
                if next == NONE {
                    parent[i as usize] = k as u32;
                }
                i = next;
            }
        }
    }
    parent
}

/// Columns i < k with L_ki ≠ 0, in topological order.
fn row_pattern(
    k: usize,
    upper: &UpperColumns,
    parent: &[u32],
    mark: &mut [u32],
    pattern: &mut Vec<u32>,
) {
    pattern.clear();
    mark[k] = k as u32;
    for &(i, _) in &upper[k] {
        let mut i = i as usize;
        while mark[i] != k as u32 {
            mark[i] = k as u32;
            pattern.push(i as u32);
            i = parent[i] as usize;
        }
    }
    // A column's parent is larger than itself, so ascending order is topological.
    pattern.sort_unstable();
}

fn factor(
    n: usize,
    order: Vec<u32>,
    upper: &UpperColumns,
    parent: &[u32],
) -> Result<Cholesky, CholeskyError> {
    let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
    let mut diagonal = vec![0.0; n];
    let mut mark = vec![NONE; n];
    let mut pattern = Vec::new();
    let mut x = vec![0.0; n];
    for k in 0..n {
        row_pattern(k, upper, parent, &mut mark, &mut pattern);
        for &(i, value) in &upper[k] {
            x[i as usize] += value;
        }
        let mut pivot = x[k];
        x[k] = 0.0;
        for &i in &pattern {
            let l = x[i as usize] / diagonal[i as usize];
            x[i as usize] = 0.0;
            for &(row, value) in &columns[i as usize] {
                x[row as usize] -= value * l;
            }
            // Column i holds rows up to k - 1 only, so x[k] is untouched: the pivot loses l².
            pivot -= l * l;
            columns[i as usize].push((k as u32, l));
        }
        if !(pivot.is_finite() && pivot > 0.0) {
            return Err(CholeskyError::Pivot {
                row: order[k] as usize,
                pivot,
            });
        }
        diagonal[k] = pivot.sqrt();
    }
    Ok(packed(order, &columns, &diagonal))
}

/// Gathers neighbouring columns with the same rows into panels.
fn packed(order: Vec<u32>, columns: &[Vec<(u32, f64)>], diagonal: &[f64]) -> Cholesky {
    let n = columns.len();
    let follows = |k: usize| {
        let (a, b) = (&columns[k - 1], &columns[k]);
        a.len() == b.len() + 1
            && a[0].0 as usize == k
            && a[1..].iter().zip(b).all(|(x, y)| x.0 == y.0)
    };
    let (mut panels, mut rows, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut first = 0;
    while first < n {
        let mut width = 1;
        while width < PANEL && first + width < n && follows(first + width) {
            width += 1;
        }
        let mut inner = [[0.0; PANEL]; PANEL];
        for i in 0..width {
            inner[i][i] = 1.0 / diagonal[first + i];
            for j in 0..i {
                inner[i][j] = columns[first + j][i - j - 1].1;
            }
        }
        let (rows_start, values_start) = (rows.len() as u32, values.len() as u32);
        let last = &columns[first + width - 1];
        for (r, &(row, _)) in last.iter().enumerate() {
            rows.push(row);
            values.extend((0..width).map(|i| columns[first + i][width - 1 - i + r].1));
        }
        let (first_column, rows_end) = (first as u32, rows.len() as u32);
        panels.push(Panel {
            first: first_column,
            width: width as u32,
            rows_start,
            rows_end,
            values_start,
            inner,
        });
        first += width;
    }
    let non_zeros = n + columns.iter().map(Vec::len).sum::<usize>();
    Cholesky {
        n,
        order,
        triangle: Triangle {
            panels,
            rows,
            values,
        },
        non_zeros,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Graph Laplacian of a box of nodes plus a little mass: the pattern of a lattice.
    fn lattice(side: usize) -> (SymmetricTriplets, DMatrix<f64>) {
        let n = side * side * side;
        let mut sparse = SymmetricTriplets::new(n);
        let mut dense = DMatrix::zeros(n, n);
        let mut add = |i: usize, j: usize, value: f64| {
            sparse.add(i, j, value);
            dense[(i, j)] += value;
            if i != j {
                dense[(j, i)] += value;
            }
        };
        let index = |x: usize, y: usize, z: usize| (x * side + y) * side + z;
        for x in 0..side {
            for y in 0..side {
                for z in 0..side {
                    let i = index(x, y, z);
                    add(i, i, 0.1 + 0.01 * i as f64);
                    for (dx, dy, dz) in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1)] {
                        if x + dx < side && y + dy < side && z + dz < side {
                            let j = index(x + dx, y + dy, z + dz);
                            let k = 1.0 + 0.3 * ((i * 7 + j * 3) % 5) as f64;
                            add(i, i, k);
                            add(j, j, k);
                            add(i, j, -k);
                        }
                    }
                }
            }
        }
        (sparse, dense)
    }

    #[test]
    fn sparse_and_dense_factors_solve_alike() {
        let (sparse, dense) = lattice(5);
        let factor = Cholesky::new(&sparse).unwrap();
        let oracle = dense.clone().cholesky().unwrap();
        let b: Vec<Vector3> = (0..sparse.n)
            .map(|i| {
                Vector3::new(
                    i as f64 % 3.0 - 1.0,
                    (i * i) as f64 % 7.0,
                    1.0 / (1.0 + i as f64),
                )
            })
            .collect();
        let mut x = b.clone();
        factor.solve(&mut x, &mut vec![[0.0; 4]; sparse.n]);
        for c in 0..3 {
            let expected = oracle.solve(&DVector::from_iterator(sparse.n, b.iter().map(|v| v[c])));
            let mut one: Vec<f64> = b.iter().map(|v| v[c]).collect();
            factor.solve_one(&mut one);
            for i in 0..sparse.n {
                // Condition about 1e3: residuals of 1e-16 become 1e-13.
                assert!(
                    (x[i][c] - expected[i]).abs() < 1e-12,
                    "row {i}: {} != {}",
                    x[i][c],
                    expected[i]
                );
                assert!(
                    (one[i] - expected[i]).abs() < 1e-12,
                    "row {i}: {} != {}",
                    one[i],
                    expected[i]
                );
            }
        }
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn wide_registers_and_the_baseline_have_the_same_bits() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            eprintln!("skipped: this processor has no AVX2");
            return;
        }
        let (sparse, _) = lattice(7);
        let factor = Cholesky::new(&sparse).unwrap();
        let mut wide: Vec<Lane> = (0..sparse.n)
            .map(|i| [i as f64, 1.0 / (i + 1) as f64, -3.3, 0.0])
            .collect();
        let mut plain = wide.clone();
        factor.triangle.solve_in_place::<BaselineKernel>(&mut plain);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            avx2::solve(&factor.triangle, &mut wide);
        }
        let bits = |lanes: &[Lane]| {
            lanes
                .iter()
                .flatten()
                .map(|x| x.to_bits())
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(&wide), bits(&plain));
        let single = factor.single();
        let narrow = |lane: &Lane| lane.map(|x| x as f32);
        let mut wide: Vec<SingleLane> = plain.iter().map(narrow).collect();
        let mut plain = wide.clone();
        single.triangle.solve_in_place::<SingleKernel>(&mut plain);
        single.solve_lanes(&mut wide);
        assert_eq!(wide, plain);
    }

    #[test]
    fn a_factor_in_single_precision_solves_to_its_rounding_at_any_scale() {
        let (sparse, _) = lattice(7);
        let factor = Cholesky::new(&sparse).unwrap();
        let single = factor.single();
        for scale in [1.0, 1e-300, 1e200] {
            let b: Vec<Vector3> = (0..sparse.n)
                .map(|i| Vector3::new(1.0, (i % 5) as f64 - 2.0, 1.0 / (i + 1) as f64) * scale)
                .collect();
            let (mut exact, mut rounded) = (b.clone(), b.clone());
            factor.solve(&mut exact, &mut vec![[0.0; 4]; sparse.n]);
            single.solve(&mut rounded, &mut vec![[0.0; 4]; sparse.n]);
            let largest = exact.iter().map(|v| v.amax()).fold(0.0, f64::max);
            for (a, b) in exact.iter().zip(&rounded) {
                assert!((a - b).amax() < 1e-4 * largest, "{a} and {b} at {scale}");
            }
            rounded.fill(Vector3::zeros());
            single.solve(&mut rounded, &mut vec![[0.0; 4]; sparse.n]);
            assert!(rounded.iter().all(|v| *v == Vector3::zeros()));
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused_with_its_row() {
        let mut matrix = SymmetricTriplets::new(2);
        matrix.add(0, 0, 1.0);
        matrix.add(1, 1, -1.0);
        assert!(matches!(
            Cholesky::new(&matrix),
            Err(CholeskyError::Pivot { row: 1, .. })
        ));
    }
}
