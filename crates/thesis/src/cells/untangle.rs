//! Repairs folded cells and flat corners of a cube lattice by moving their nodes.
//!
//! A node of a bad cell tries a few places: the mean of its neighbours and steps along the axes,
//! or, when it rides on the surface, steps along the surface. It takes the one where the worst of
//! its cells is best (Freitag & Ollivier-Gooch 1997, with fixed trial steps). Sweeps go on until no
//! cell is bad, or no node moves.

use super::cube::{CubeLattice, node_at, place_of};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};
use palpate_sim::body::{Cell, CellGrid, take_best, trials};

/// Sweeps over the nodes of bad cells at most. A bent teardrop needs about five.
const MOST_SWEEPS: usize = 60;

/// A cell is bad when its least Jacobian at a Gauss point is below this part of its greatest.
const BAD: f64 = 0.02;

/// Trial steps, in mean lengths of the node's edges.
const STEPS: [f64; 3] = [0.4, 0.15, 0.04];

/// What a move should make greater, m³: below 0 the cell is inside out.
fn measure(grid: &CellGrid, cell: &Cell) -> f64 {
    let determinants = grid.gauss_determinants(cell);
    determinants.iter().copied().fold(f64::INFINITY, f64::min)
}

fn is_bad(grid: &CellGrid, cell: &Cell) -> bool {
    let determinants = grid.gauss_determinants(cell);
    let greatest = determinants.iter().map(|d| d.abs()).fold(0.0, f64::max);
    measure(grid, cell) <= BAD * greatest
}

/// Moves nodes until no cell is bad, if it can.
pub(super) fn untangle(lattice: &mut CubeLattice, surface: &Surface) {
    let mut place_on_surface: Option<Sliding<'_>> = None;
    for _ in 0..MOST_SWEEPS {
        let mut touched = vec![false; lattice.grid.nodes.len()];
        let mut any = false;
        for cell in &lattice.grid.cells {
            if is_bad(&lattice.grid, cell) {
                any = true;
                cell.iter().for_each(|&node| touched[node as usize] = true);
            }
        }
        if !any {
            return;
        }
        let sliding = place_on_surface.get_or_insert_with(|| Sliding::new(lattice, surface));
        let mut moved = false;
        for node in (0..touched.len()).filter(|&node| touched[node]) {
            moved |= match sliding.exterior_of[node] {
                Some(entry) => sliding.slide(lattice, entry as usize),
                None => shift(lattice, node),
            };
        }
        if !moved {
            return;
        }
    }
}

/// The worst measure of the cells around a node.
fn worst_around(lattice: &CubeLattice, node: usize) -> f64 {
    let place = place_of(lattice.counts, node);
    let steps = lattice.counts.map(|n| n - 1);
    let mut worst = f64::INFINITY;
    for corner in 0..8 {
        let back = [corner >> 2, corner >> 1 & 1, corner & 1];
        if (0..3).all(|axis| place[axis] >= back[axis] && place[axis] - back[axis] < steps[axis]) {
            let [i, j, k] = std::array::from_fn(|axis| place[axis] - back[axis]);
            let cell = &lattice.grid.cells[(i * steps[1] + j) * steps[2] + k];
            worst = worst.min(measure(&lattice.grid, cell));
        }
    }
    worst
}

/// Mean of the nodes beside it along the lattice's axes, and the mean distance to them, m.
fn neighbours(lattice: &CubeLattice, node: usize) -> (Point3, f64) {
    let place = place_of(lattice.counts, node);
    let x = lattice.grid.nodes[node];
    let (mut sum, mut length, mut count) = (Vector3::zeros(), 0.0, 0.0);
    for axis in 0..3 {
        for side in [-1, 1] {
            let mut beside = place;
            beside[axis] = beside[axis].wrapping_add_signed(side);
            if beside[axis] < lattice.counts[axis] {
                let at = lattice.grid.nodes[node_at(lattice.counts, beside)];
                sum += at.coords;
                length += (at - x).norm();
                count += 1.0;
            }
        }
    }
    (Point3::from(sum / count), length / count)
}

/// Tries places for a free node; true when it found a better one.
fn shift(lattice: &mut CubeLattice, node: usize) -> bool {
    let start = lattice.grid.nodes[node];
    let (mean, length) = neighbours(lattice, node);
    let places = trials(start, mean, STEPS.map(|step| step * length));
    let worst = |lattice: &CubeLattice| worst_around(lattice, node);
    take_best(
        lattice,
        |lattice| &mut lattice.grid.nodes[node],
        places,
        worst,
    )
}

/// Moves along the surface.
struct Sliding<'a> {
    surface: &'a Surface,
    solver: ClosestSolver,
    /// Entry of `exterior` for each node.
    exterior_of: Vec<Option<u32>>,
}

impl<'a> Sliding<'a> {
    fn new(lattice: &CubeLattice, surface: &'a Surface) -> Self {
        let mut exterior_of = vec![None; lattice.grid.nodes.len()];
        for (entry, (node, _)) in lattice.exterior.iter().enumerate() {
            exterior_of[*node as usize] = Some(entry as u32);
        }
        Self {
            surface,
            solver: ClosestSolver::new(surface),
            exterior_of,
        }
    }

    /// Tries places on the surface for an exterior node; true when it found a better one.
    fn slide(&self, lattice: &mut CubeLattice, entry: usize) -> bool {
        let (node, [u, v]) = lattice.exterior[entry];
        let node = node as usize;
        let start = lattice.grid.nodes[node];
        let (mean, length) = neighbours(lattice, node);
        let normal = self.surface.normal(u, v);
        // Any direction across the normal, and the one across both.
        let least = normal.iamin();
        let first = normal.cross(&Vector3::ith(least, 1.0));
        let second = normal.cross(&first);
        let mut best = (worst_around(lattice, node), start, [u, v]);
        let around = STEPS.iter().flat_map(|step| (0..8).map(move |k| (step, k)));
        let trials = around.map(|(step, k)| {
            let [a, b] = [
                [1.0, 0.0],
                [0.7, 0.7],
                [0.0, 1.0],
                [-0.7, 0.7],
                [-1.0, 0.0],
                [-0.7, -0.7],
                [0.0, -1.0],
                [0.7, -0.7],
            ][k];
            start + (first * a + second * b) * (step * length)
        });
        for trial in std::iter::once(mean).chain(trials) {
            let Some(foot) = self.solver.local(self.surface, &trial, u, v) else {
                continue;
            };
            let point = self.surface.point(foot.u, foot.v);
            lattice.grid.nodes[node] = point;
            let worst = worst_around(lattice, node);
            if worst > best.0 {
                best = (worst, point, [foot.u, foot.v]);
            }
        }
        lattice.grid.nodes[node] = best.1;
        lattice.exterior[entry].1 = best.2;
        best.1 != start
    }
}
