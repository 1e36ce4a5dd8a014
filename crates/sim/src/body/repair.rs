//! Repairs cells in layers that a continuum refuses, by moving nodes inside the surface.
//!
//! A node of a bad cell tries the mean of its neighbours and steps along the axes ([`trials`]), and takes the place where
//! its cells miss least. Nodes of the surface stay: they are control points.

use super::cells::{CellGrid, EDGES};
use super::elements::continuum::worth;
use super::trials::{take_best, trials};
use palpate_geometry::math::{Point3, Vector3};

/// Sweeps over the nodes of bad cells at most.
const MOST_SWEEPS: usize = 40;
/// Trial steps, in mean lengths of the node's edges.
const STEPS: [f64; 4] = [0.5, 0.2, 0.07, 0.02];
/// A cell is good at this many times the least quality that a continuum takes, which leaves room for rounding; and from so many
/// on nothing is gained.
const ENOUGH: f64 = 1.1;
const GOOD: f64 = 1.3;

/// Moves inner nodes until every cell is good enough for a continuum, or no move makes the worst better.
pub(super) fn repair(grid: &mut CellGrid) {
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); grid.nodes.len()];
    let mut beside: Vec<Vec<u32>> = vec![Vec::new(); grid.nodes.len()];
    for (k, cell) in grid.cells.iter().enumerate() {
        for &node in cell {
            around[node as usize].push(k as u32);
        }
        for [a, b] in EDGES.map(|edge| edge.map(|corner| cell[corner])) {
            if a != b {
                beside[a as usize].push(b);
                beside[b as usize].push(a);
            }
        }
    }
    for list in around.iter_mut().chain(&mut beside) {
        list.sort_unstable();
        list.dedup();
    }
    let mut outer = vec![false; grid.nodes.len()];
    for &node in &grid.node_of_control {
        outer[node as usize] = true;
    }
    let mut values: Vec<f64> = (grid.cells.iter()).map(|cell| worth(grid, cell)).collect();
    for _ in 0..MOST_SWEEPS {
        let mut touched: Vec<u32> = (grid.cells.iter().zip(&values))
            .filter(|(_, value)| **value < ENOUGH)
            .flat_map(|(cell, _)| *cell)
            .filter(|&node| !outer[node as usize])
            .collect();
        touched.sort_unstable();
        touched.dedup();
        let mut moved = false;
        for node in touched {
            let node = node as usize;
            if shift(grid, node, &around[node], &beside[node]) {
                moved = true;
                for &cell in &around[node] {
                    values[cell as usize] = worth(grid, &grid.cells[cell as usize]);
                }
            }
        }
        if !moved {
            return;
        }
    }
}

/// Tries places for a node; true when it found a better one.
fn shift(grid: &mut CellGrid, node: usize, around: &[u32], beside: &[u32]) -> bool {
    let start = grid.nodes[node];
    let count = beside.len() as f64;
    let at = |other: &u32| grid.nodes[*other as usize];
    let mean = Point3::from(beside.iter().map(|other| at(other).coords).sum::<Vector3>() / count);
    let length = beside
        .iter()
        .map(|other| (at(other) - start).norm())
        .sum::<f64>()
        / count;
    // The sum, not the worst: a cell that cannot be saved must not pull its neighbours with it.
    let missing = |grid: &CellGrid| {
        let cells = around.iter();
        let worths = cells.map(|&cell| worth(grid, &grid.cells[cell as usize]));
        worths
            .map(|worth| (GOOD - worth).max(0.0).powi(2))
            .sum::<f64>()
    };
    let places = trials(start, mean, STEPS.map(|step| step * length));
    take_best(
        grid,
        |grid| &mut grid.nodes[node],
        places,
        |grid| -missing(grid),
    )
}
