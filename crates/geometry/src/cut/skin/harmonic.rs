//! Functions on a section that are as even as what they are on its rims allows.
//!
//! Every inner corner has a mean of its neighbours, with weights above 0. So longitude and level together do not fold over
//! (Gortler, Gotsman & Thurston, *Discrete one-forms on meshes*, 2006), whatever the section's shape.

use super::fine::Fine;
use super::sections::Net;
use crate::math::{Cholesky, SymmetricTriplets};

/// The least weight of an edge: cotangents of obtuse angles would fold.
const LEAST: f64 = 0.03;
/// Cotangents beyond this are of slivers.
const MOST: f64 = 20.0;

/// The equations of a section.
pub(super) struct Harmonic {
    /// Edges within the section, with their weights.
    pub edges: Vec<(u32, f64)>,
    /// (corners of the piece) Number of the unknown; `FIXED` on rims, `ABSENT` elsewhere.
    pub unknown: Vec<u32>,
    pub count: usize,
    factor: Cholesky,
}

pub(super) const ABSENT: u32 = u32::MAX;
pub(super) const FIXED: u32 = u32::MAX - 1;

impl Harmonic {
    /// On some triangles, fixed at the corners of their rims. `None` without a corner between them.
    pub fn new(fine: &Fine, net: &Net, triangles: &[u32], rims: &[&[u32]]) -> Option<Self> {
        let mut unknown = vec![ABSENT; fine.corners.len()];
        for &corner in rims.iter().copied().flatten() {
            unknown[corner as usize] = FIXED;
        }
        let mut count = 0;
        let mut weights: Vec<(u32, f64)> = Vec::with_capacity(3 * triangles.len());
        for &t in triangles {
            let corners = fine.triangles[t as usize];
            let points = fine.rest(t as usize);
            for k in 0..3 {
                let (a, b, c) = (points[k], points[(k + 1) % 3], points[(k + 2) % 3]);
                let (x, y) = (a - c, b - c);
                let cotangent = x.dot(&y) / x.cross(&y).norm().max(1e-300);
                let weight = 0.5 * cotangent.clamp(-MOST, MOST);
                weights.push((net.of[t as usize][k], weight));
                let number = &mut unknown[corners[k] as usize];
                if *number == ABSENT {
                    *number = count;
                    count += 1;
                }
            }
        }
        weights.sort_by_key(|w| w.0);
        let edges: Vec<(u32, f64)> = weights
            .chunk_by(|a, b| a.0 == b.0)
            .map(|group| {
                (
                    group[0].0,
                    group.iter().map(|w| w.1).sum::<f64>().max(LEAST),
                )
            })
            .collect();
        Self::of(net, edges, unknown, count as usize)
    }

    /// A harmonic map with other weights: that of each edge times its factor; `factors`: (edges of the net).
    pub fn reweighted(&self, net: &Net, factors: &[f64]) -> Option<Self> {
        let edges = self.edges.iter();
        let edges = edges.map(|&(e, weight)| (e, weight * factors[e as usize]));
        Self::of(net, edges.collect(), self.unknown.clone(), self.count)
    }

    fn of(net: &Net, edges: Vec<(u32, f64)>, unknown: Vec<u32>, count: usize) -> Option<Self> {
        let mut matrix = SymmetricTriplets::new(count);
        for &(e, weight) in &edges {
            let [a, b] = net.edges[e as usize].ends.map(|k| unknown[k as usize]);
            for k in [a, b] {
                if k < FIXED {
                    matrix.add(k as usize, k as usize, weight);
                }
            }
            if a < FIXED && b < FIXED {
                matrix.add(a as usize, b as usize, -weight);
            }
        }
        Some(Self {
            edges,
            unknown,
            count,
            factor: (count > 0).then(|| Cholesky::new(&matrix).ok())??,
        })
    }

    /// Fills in `values` (corners of the piece): given on rims, with what comes in at unknowns, and steps along edges
    /// (from the end of the smaller number) that are not counted.
    pub fn solve(&self, net: &Net, values: &mut [f64], source: &[f64], steps: &[f64]) {
        let mut right = source.to_vec();
        for &(e, weight) in &self.edges {
            let ends = net.edges[e as usize].ends;
            let step = steps.get(e as usize).copied().unwrap_or(0.0);
            for (k, sign) in [(0, 1.0), (1, -1.0)] {
                let (own, other) = (ends[k] as usize, ends[1 - k] as usize);
                let row = self.unknown[own];
                if row < FIXED {
                    let given = match self.unknown[other] == FIXED {
                        true => values[other],
                        false => 0.0,
                    };
                    right[row as usize] += weight * (given + sign * step);
                }
            }
        }
        self.factor.solve_one(&mut right);
        for (value, &row) in values.iter_mut().zip(&self.unknown) {
            if row < FIXED {
                *value = right[row as usize];
            }
        }
    }
}
