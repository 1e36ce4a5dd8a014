//! Nodes from coordinates: x = W q.
//!
//! A lattice's nodes are its coordinates. Where they are not (a lattice that rides on a coarser
//! net, a net that carries a finer grid of cells) every node is a sum of coordinates with weights
//! that add up to one, and forces go back by the transpose: power is the same on both sides.

use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, Point3, SymmetricTriplets, simd};
use std::collections::BTreeMap;

/// W, row by row.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeMap {
    /// x = q.
    Same,
    /// Compressed rows.
    Sparse(SparseRows),
}

/// A sparse matrix (rows × columns) by rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRows {
    /// (rows + 1).
    starts: Vec<u32>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl SparseRows {
    /// From rows of (column, weight); columns of a row are sorted, equal ones are added, zeros left
    /// out.
    pub fn new(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut out = Self {
            starts: vec![0],
            ..Self::default()
        };
        for mut row in rows {
            row.sort_by_key(|entry| entry.0);
            row.dedup_by(|later, earlier| {
                let same = later.0 == earlier.0;
                if same {
                    earlier.1 += later.1;
                }
                same
            });
            for (column, weight) in row.into_iter().filter(|entry| entry.1 != 0.0) {
                out.columns.push(column);
                out.weights.push(weight);
            }
            out.starts.push(out.columns.len() as u32);
        }
        out
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// True without entries.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Columns and weights of a row.
    #[inline]
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        debug_assert!(row < self.rows(), "no such row");
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        (&self.columns[range.clone()], &self.weights[range])
    }
}

impl NodeMap {
    /// A sparse map, or [`NodeMap::Same`] when it is the identity.
    pub fn from_rows(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let sparse = SparseRows::new(rows);
        let same = (0..sparse.rows()).all(|row| sparse.row(row) == (&[row as u32][..], &[1.0][..]));
        if same {
            Self::Same
        } else {
            Self::Sparse(sparse)
        }
    }

    /// Nodes of coordinates.
    pub fn nodes(&self, coordinates: &[Point3]) -> Vec<Point3> {
        match self {
            Self::Same => coordinates.to_vec(),
            Self::Sparse(map) => (0..map.rows())
                .map(|row| {
                    let (columns, weights) = map.row(row);
                    let sum = columns
                        .iter()
                        .zip(weights)
                        .map(|(&c, w)| coordinates[c as usize].coords * *w);
                    Point3::from(sum.sum::<palpate_geometry::math::Vector3>())
                })
                .collect(),
        }
    }

    /// The coordinates of a node, with their weights.
    pub fn each(&self, node: usize, mut f: impl FnMut(usize, f64)) {
        match self {
            Self::Same => f(node, 1.0),
            Self::Sparse(map) => {
                let (columns, weights) = map.row(node);
                for (&column, &weight) in columns.iter().zip(weights) {
                    f(column as usize, weight);
                }
            }
        }
    }

    /// How far a node moves at most where no coordinate moves by more than one.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Same => 1.0,
            Self::Sparse(map) => {
                let sum = |row: usize| map.row(row).1.iter().map(|w| w.abs()).sum::<f64>();
                (0..map.rows()).map(sum).fold(0.0, f64::max)
            }
        }
    }

    /// What nodes carry, handed to their coordinates: Wᵀ m.
    pub fn lumped(&self, of_nodes: &[f64], coordinates: usize) -> Vec<f64> {
        debug_assert!(of_nodes.iter().all(|m| *m >= 0.0), "a mass below none");
        match self {
            Self::Same => of_nodes.to_vec(),
            Self::Sparse(map) => {
                let mut lumped = vec![0.0; coordinates];
                for (row, value) in of_nodes.iter().enumerate() {
                    let (columns, weights) = map.row(row);
                    for (&c, w) in columns.iter().zip(weights) {
                        lumped[c as usize] += value * w;
                    }
                }
                lumped
            }
        }
    }

    /// Adds k (W_a − W_b)ᵀ (W_a − W_b) for every edge (a, b, k), where `unknown` gives a coordinate
    /// a row.
    pub fn add_edges(
        &self,
        edges: &[(u32, u32, f64)],
        unknown: impl Fn(u32) -> Option<usize>,
        to: &mut SymmetricTriplets,
    ) {
        match self {
            Self::Same => {
                for &(a, b, k) in edges {
                    let rows = [unknown(a), unknown(b)];
                    for row in rows.into_iter().flatten() {
                        to.add(row, row, k);
                    }
                    if let [Some(a), Some(b)] = rows {
                        to.add(a, b, -k);
                    }
                }
            }
            Self::Sparse(map) => {
                // Sums of many small outer products, gathered row by row.
                let mut sums: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); to.n];
                let mut difference: Vec<(u32, f64)> = Vec::new();
                for &(a, b, k) in edges {
                    difference.clear();
                    for (node, sign) in [(a, 1.0), (b, -1.0)] {
                        let (columns, weights) = map.row(node as usize);
                        difference.extend(columns.iter().zip(weights).map(|(&c, w)| (c, sign * w)));
                    }
                    difference.sort_by_key(|entry| entry.0);
                    difference.dedup_by(|later, earlier| {
                        let same = later.0 == earlier.0;
                        if same {
                            earlier.1 += later.1;
                        }
                        same
                    });
                    difference.retain(|entry| entry.1 != 0.0);
                    for (i, &(c, w)) in difference.iter().enumerate() {
                        let Some(row) = unknown(c) else { continue };
                        for &(d, v) in &difference[..=i] {
                            if let Some(column) = unknown(d) {
                                let (high, low) = (row.max(column), row.min(column));
                                *sums[high].entry(low).or_insert(0.0) += k * w * v;
                            }
                        }
                    }
                }
                for (row, sums) in sums.iter().enumerate() {
                    for (&column, &value) in sums {
                        to.add(row, column, value);
                    }
                }
            }
        }
    }
}

impl SparseRows {
    /// x = W q.
    pub(super) fn apply(&self, coordinates: &[Lane], nodes: &mut [Lane]) {
        debug_assert_eq!(nodes.len(), self.rows(), "a row a node");
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { apply_wide(self, coordinates, nodes) };
        }
        self.apply_in::<Baseline>(coordinates, nodes);
    }

    /// r_q += Wᵀ r.
    pub(super) fn add_transposed(&self, nodes: &[Lane], coordinates: &mut [Lane]) {
        debug_assert_eq!(nodes.len(), self.rows(), "a row a node");
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_transposed_wide(self, nodes, coordinates) };
        }
        self.add_transposed_in::<Baseline>(nodes, coordinates);
    }

    /// x = W q of some nodes.
    pub(super) fn apply_some(&self, some: &[u32], coordinates: &[Lane], nodes: &mut [Lane]) {
        debug_assert_eq!(nodes.len(), self.rows(), "a row a node");
        for &row in some {
            self.sum::<Baseline>(row as usize, coordinates)
                .store(&mut nodes[row as usize]);
        }
    }

    #[inline(always)]
    fn apply_in<L: Lanes>(&self, coordinates: &[Lane], nodes: &mut [Lane]) {
        for (row, node) in nodes.iter_mut().enumerate() {
            self.sum::<L>(row, coordinates).store(node);
        }
    }

    /// One row of W q.
    #[inline(always)]
    fn sum<L: Lanes>(&self, row: usize, coordinates: &[Lane]) -> L {
        let (columns, weights) = self.row(row);
        let mut sum = L::splat(0.0);
        for (&column, &weight) in columns.iter().zip(weights) {
            sum = sum + L::load(&coordinates[column as usize]) * L::splat(weight);
        }
        sum
    }

    #[inline(always)]
    fn add_transposed_in<L: Lanes>(&self, nodes: &[Lane], coordinates: &mut [Lane]) {
        for (row, force) in nodes.iter().enumerate() {
            let force = L::load(force);
            let (columns, weights) = self.row(row);
            for (&column, &weight) in columns.iter().zip(weights) {
                let q = &mut coordinates[column as usize];
                (L::load(q) + force * L::splat(weight)).store(q);
            }
        }
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn apply_wide(map: &SparseRows, coordinates: &[Lane], nodes: &mut [Lane]) {
    map.apply_in::<palpate_geometry::math::lanes::Wide>(coordinates, nodes);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_transposed_wide(map: &SparseRows, nodes: &[Lane], coordinates: &mut [Lane]) {
    map.add_transposed_in::<palpate_geometry::math::lanes::Wide>(nodes, coordinates);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_go_there_and_back_with_the_same_bits_on_every_processor() {
        let mut state = 9u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let (rows, columns) = (40, 13);
        let map = SparseRows::new((0..rows).map(|_| {
            (0..5)
                .map(|_| (((random() + 0.5) * 13.0) as u32, random()))
                .collect()
        }));
        let q: Vec<Lane> = (0..columns)
            .map(|_| [random(), random(), random(), 0.0])
            .collect();
        let f: Vec<Lane> = (0..rows)
            .map(|_| [random(), random(), random(), 0.0])
            .collect();
        let (mut slow, mut fast) = (vec![[0.0; 4]; rows], vec![[0.0; 4]; rows]);
        map.apply_in::<Baseline>(&q, &mut slow);
        map.apply(&q, &mut fast);
        assert_eq!(slow, fast);
        let (mut back, mut quick) = (vec![[0.0; 4]; columns], vec![[0.0; 4]; columns]);
        map.add_transposed_in::<Baseline>(&f, &mut back);
        map.add_transposed(&f, &mut quick);
        assert_eq!(back, quick);
        // f · (W q) = (Wᵀ f) · q.
        let dot = |a: &[Lane], b: &[Lane]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
                .sum::<f64>()
        };
        assert!((dot(&f, &fast) - dot(&quick, &q)).abs() < 1e-13);
    }

    #[test]
    fn equal_columns_are_one_entry_and_the_identity_is_no_map() {
        let rows = SparseRows::new([vec![(3, 0.25), (1, 0.5), (3, 0.25), (2, 0.0)]]);
        assert_eq!(rows.row(0), (&[1, 3][..], &[0.5, 0.5][..]));
        assert_eq!(
            NodeMap::from_rows([vec![(0, 1.0)], vec![(1, 1.0)]]),
            NodeMap::Same
        );
    }
}
