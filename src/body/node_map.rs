//! Nodes from coordinates: x = W q.
//!
//! A lattice's nodes are its coordinates. Where they are not (a lattice that rides on a coarser net, a net that carries a
//! finer grid of cells) every node is a sum of coordinates with weights that add up to one, and forces go back by the
//! transpose: power is the same on both sides.

use crate::math::{Lane, Point3, SymmetricTriplets};
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
    /// From rows of (column, weight); columns of a row are sorted, equal ones are added, zeros left out.
    pub fn new(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut out = Self { starts: vec![0], ..Self::default() };
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

    /// Rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Entries.
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
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        (&self.columns[range.clone()], &self.weights[range])
    }
}

impl NodeMap {
    /// A sparse map, or [`NodeMap::Same`] when it is the identity.
    pub fn from_rows(rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let sparse = SparseRows::new(rows);
        let same = (0..sparse.rows()).all(|row| sparse.row(row) == (&[row as u32][..], &[1.0][..]));
        if same { Self::Same } else { Self::Sparse(sparse) }
    }

    /// Nodes of coordinates.
    pub fn nodes(&self, coordinates: &[Point3]) -> Vec<Point3> {
        match self {
            Self::Same => coordinates.to_vec(),
            Self::Sparse(map) => (0..map.rows())
                .map(|row| {
                    let (columns, weights) = map.row(row);
                    let sum = columns.iter().zip(weights).map(|(&c, w)| coordinates[c as usize].coords * *w);
                    Point3::from(sum.sum::<crate::math::Vector3>())
                })
                .collect(),
        }
    }

    /// What nodes carry, handed to their coordinates: Wᵀ m.
    pub fn lumped(&self, of_nodes: &[f64], coordinates: usize) -> Vec<f64> {
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

    /// Adds k (W_a − W_b)ᵀ (W_a − W_b) for every edge (a, b, k), where `unknown` gives a coordinate a row.
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
    #[inline]
    pub(super) fn apply(&self, coordinates: &[Lane], nodes: &mut [Lane]) {
        for (row, node) in nodes.iter_mut().enumerate() {
            let (columns, weights) = self.row(row);
            let mut sum = [0.0; 4];
            for (&column, weight) in columns.iter().zip(weights) {
                let q = &coordinates[column as usize];
                for c in 0..4 {
                    sum[c] += q[c] * weight;
                }
            }
            *node = sum;
        }
    }

    /// r_q += Wᵀ r.
    #[inline]
    pub(super) fn add_transposed(&self, nodes: &[Lane], coordinates: &mut [Lane]) {
        for (row, force) in nodes.iter().enumerate() {
            let (columns, weights) = self.row(row);
            for (&column, weight) in columns.iter().zip(weights) {
                let q = &mut coordinates[column as usize];
                for c in 0..4 {
                    q[c] += force[c] * weight;
                }
            }
        }
    }
}
