//! Springs of a lattice from its cells and Young's modulus: no stiffness is tuned by hand.
//!
//! On a cubic lattice of side h, edges and face diagonals with k = 0.4 E h, weighted by the share of cells around them,
//! make an isotropic solid with ν = 1/4. With h = V / l² the rule carries over to distorted cells: every cell gives each
//! of its edges 0.4 E V / l² / 4 and each of its face diagonals twice that, / 2.

use super::cells::{Cell, CellGrid, EDGES, FACES};
use std::collections::BTreeMap;

/// A linear spring between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Smaller node index.
    pub a: u32,
    /// Larger node index.
    pub b: u32,
    /// k, N/m.
    pub stiffness_n_m: f64,
    /// L, m.
    pub rest_length_m: f64,
}

/// All springs, ordered by their nodes.
pub fn from_cells(grid: &CellGrid, young_pa: f64) -> Vec<Spring> {
    let mut stiffness: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    for cell in &grid.cells {
        let volume = grid.volume(cell);
        let mut share = |i: usize, j: usize, weight: f64| {
            let (a, b) = (cell[i].min(cell[j]), cell[i].max(cell[j]));
            if a != b {
                let length_squared = (grid.nodes[a as usize] - grid.nodes[b as usize]).norm_squared();
                *stiffness.entry((a, b)).or_insert(0.0) += weight * 0.4 * young_pa * volume / length_squared;
            }
        };
        for [i, j] in EDGES {
            share(i, j, 0.25);
        }
        for face in FACES {
            if !collapsed(cell, &face) {
                share(face[0], face[2], 1.0);
                share(face[1], face[3], 1.0);
            }
        }
    }
    stiffness
        .into_iter()
        .map(|((a, b), stiffness_n_m)| {
            let rest_length_m = (grid.nodes[a as usize] - grid.nodes[b as usize]).norm();
            Spring { a, b, stiffness_n_m, rest_length_m }
        })
        .collect()
}

/// A face with fewer than three distinct corners has no diagonal.
fn collapsed(cell: &Cell, face: &[usize; 4]) -> bool {
    let mut corners = face.map(|i| cell[i]);
    corners.sort_unstable();
    let repeats = corners.windows(2).filter(|pair| pair[0] == pair[1]).count();
    repeats >= 2
}
