//! From cells with depths to contacts: regions of cells that touch each other, and the local maxima
//! of depth in them.
//!
//! Neighbours are found on the finest grid, on which every leaf writes its number; walking goes on
//! across seams, and all cells round a pole are neighbours. Cells of equal depth are one plateau,
//! so a flat contact is one contact; a plateau is a maximum when no neighbour of any of its cells
//! is deeper.

use super::cover::{CellId, Cover};
use super::grid::GridAxis;
use palpate_geometry::contact::{MAX_CONTACTS, Rectangle};
use palpate_geometry::math::{Point3, Vector3};

/// A cell with its deepest point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub id: CellId,
    pub depth_m: f64,
    pub uv: [f64; 2],
    pub point: Point3,
    /// Outward normal, not necessarily unit: summed over a plateau.
    pub normal: Vector3,
}

/// Room to group the leaves of one surface.
#[derive(Clone, Debug)]
pub(super) struct Peaks {
    pub leaves: Vec<Leaf>,
    /// (finest u × finest v) number of the leaf, from 1; 0 where there is none.
    owner: Vec<u32>,
    region: Vec<u32>,
    plateau: Vec<u32>,
    /// (leaves) a neighbour is deeper.
    lower: Vec<bool>,
    rows: [Vec<bool>; 2],
}

impl Peaks {
    pub fn new(cover: &Cover) -> Self {
        let (u, v) = (cover.u.finest(), cover.v.finest());
        Self {
            leaves: Vec::with_capacity(u * v),
            owner: vec![0; u * v],
            region: Vec::with_capacity(u * v),
            plateau: Vec::with_capacity(u * v),
            lower: Vec::with_capacity(u * v),
            rows: [vec![false; u], vec![false; v]],
        }
    }

    /// Groups the leaves. Depths within `noise_m` are equal.
    pub fn group(&mut self, cover: &Cover, noise_m: f64) {
        self.region.clear();
        self.plateau.clear();
        self.lower.clear();
        for k in 0..self.leaves.len() {
            self.region.push(k as u32);
            self.plateau.push(k as u32);
            self.lower.push(false);
            self.mark(cover, k, k as u32 + 1);
        }
        for k in 0..self.leaves.len() {
            self.link(cover, k, noise_m);
        }
        self.link_poles(cover, noise_m);
        for k in 0..self.leaves.len() {
            self.mark(cover, k, 0);
            let root = find(&mut self.plateau, k as u32) as usize;
            self.lower[root] |= self.lower[k];
        }
        for k in 0..self.leaves.len() {
            let root = find(&mut self.plateau, k as u32) as usize;
            if root != k {
                let normal = self.leaves[k].normal;
                self.leaves[root].normal += normal;
            }
        }
    }

    fn mark(&mut self, cover: &Cover, leaf: usize, number: u32) {
        let (u, v) = cover.cells(self.leaves[leaf].id);
        let columns = cover.v.finest();
        for i in u.finest[0]..u.finest[1] {
            self.owner[i as usize * columns + v.finest[0] as usize..]
                [..(v.finest[1] - v.finest[0]) as usize]
                .fill(number);
        }
    }

    fn link(&mut self, cover: &Cover, k: usize, noise_m: f64) {
        let (u, v) = cover.cells(self.leaves[k].id);
        let ([i0, i1], [j0, j1]) = (u.finest.map(i64::from), v.finest.map(i64::from));
        // A smallest leaf looks forward only, because its neighbours behind do so too; a larger one looks
        // all round.
        if i1 - i0 == 1 && j1 - j0 == 1 {
            for (i, j) in [(i0, j1), (i1, j0 - 1), (i1, j0), (i1, j1)] {
                self.meet(cover, k, i, j, noise_m);
            }
            return;
        }
        for j in j0 - 1..=j1 {
            self.meet(cover, k, i1, j, noise_m);
            self.meet(cover, k, i0 - 1, j, noise_m);
        }
        for i in i0..i1 {
            self.meet(cover, k, i, j0 - 1, noise_m);
            self.meet(cover, k, i, j1, noise_m);
        }
    }

    #[inline(always)]
    fn meet(&mut self, cover: &Cover, k: usize, i: i64, j: i64, noise_m: f64) {
        let (Some(i), Some(j)) = (wrapped(&cover.u, i), wrapped(&cover.v, j)) else {
            return;
        };
        let other = self.owner[i * self.rows[1].len() + j] as usize;
        if other != 0 && other != k + 1 {
            self.compare(k, other - 1, noise_m);
        }
    }

    #[inline(always)]
    fn compare(&mut self, a: usize, b: usize, noise_m: f64) {
        join(&mut self.region, a as u32, b as u32);
        let more = self.leaves[a].depth_m - self.leaves[b].depth_m;
        if more > noise_m {
            self.lower[b] = true;
        } else if more < -noise_m {
            self.lower[a] = true;
        } else {
            join(&mut self.plateau, a as u32, b as u32);
        }
    }

    fn link_poles(&mut self, cover: &Cover, noise_m: f64) {
        for (d, axis) in [&cover.u, &cover.v].into_iter().enumerate() {
            for (e, row) in [0, axis.finest() as u32 - 1].into_iter().enumerate() {
                if !cover.poles[d][e] {
                    continue;
                }
                let at_pole = |leaf: &Leaf| {
                    let cells = cover.cells(leaf.id);
                    let [from, to] = if d == 0 {
                        cells.0.finest
                    } else {
                        cells.1.finest
                    };
                    (from..to).contains(&row)
                };
                let ring = |leaves: &[Leaf], from: usize| {
                    (from..leaves.len()).find(|&k| at_pole(&leaves[k]))
                };
                // All against the deepest: what is not within rounding of it is lower.
                let mut deepest = ring(&self.leaves, 0);
                let mut at = deepest;
                while let (Some(k), Some(best)) = (at, deepest) {
                    if self.leaves[k].depth_m > self.leaves[best].depth_m {
                        deepest = Some(k);
                    }
                    at = ring(&self.leaves, k + 1);
                }
                let mut at = ring(&self.leaves, 0);
                while let (Some(k), Some(best)) = (at, deepest) {
                    if k != best {
                        self.compare(best, k, noise_m);
                    }
                    at = ring(&self.leaves, k + 1);
                }
            }
        }
    }

    /// Calls with the deepest leaf of every maximum and the sum of its plateau's normals.
    pub fn maxima(&mut self, mut each: impl FnMut(&Leaf)) {
        // The deepest of a plateau, and of equals the first: kept in the root's place, in the order
        // of the grid.
        for k in 0..self.leaves.len() {
            let root = find(&mut self.plateau, k as u32) as usize;
            if self.lower[root] || k == root {
                continue;
            }
            if self.leaves[k].depth_m > self.leaves[root].depth_m {
                let Leaf {
                    depth_m, uv, point, ..
                } = self.leaves[k];
                let root = &mut self.leaves[root];
                (root.depth_m, root.uv, root.point) = (depth_m, uv, point);
            }
        }
        for k in 0..self.leaves.len() {
            if self.plateau[k] == k as u32 && !self.lower[k] {
                each(&self.leaves[k]);
            }
        }
    }

    /// The parameter rectangles of the regions, in the order of their first leaves; all beyond
    /// [`MAX_CONTACTS`] in one.
    pub fn rectangles(&mut self, cover: &Cover, mut each: impl FnMut(Rectangle)) {
        let mut done = 0;
        for first in 0..self.leaves.len() {
            if find(&mut self.region, first as u32) != first as u32 {
                continue;
            }
            let rest = done + 1 == MAX_CONTACTS;
            self.rows.iter_mut().for_each(|rows| rows.fill(false));
            for k in first..self.leaves.len() {
                let root = find(&mut self.region, k as u32);
                if root == first as u32 || (rest && root > first as u32) {
                    let (u, v) = cover.cells(self.leaves[k].id);
                    self.rows[0][u.finest[0] as usize..u.finest[1] as usize].fill(true);
                    self.rows[1][v.finest[0] as usize..v.finest[1] as usize].fill(true);
                }
            }
            each(Rectangle {
                u: interval(&cover.u, &self.rows[0]),
                v: interval(&cover.v, &self.rows[1]),
            });
            done += 1;
            if rest {
                return;
            }
        }
    }
}

/// A place on the finest grid, on across a seam; `None` beyond an edge.
#[inline(always)]
pub(super) fn wrapped(axis: &GridAxis, k: i64) -> Option<usize> {
    let count = axis.finest() as i64;
    if (0..count).contains(&k) {
        Some(k as usize)
    } else if axis.wraps {
        Some(k.rem_euclid(count) as usize)
    } else {
        None
    }
}

/// The parameters of all cells that are marked; round a period the shortest way.
pub(super) fn interval(axis: &GridAxis, marked: &[bool]) -> [f64; 2] {
    let cells = axis.level(usize::MAX);
    let at = |row: u32| axis.parameters[row as usize];
    let low = marked.iter().position(|m| *m).unwrap_or(0);
    let high = marked.iter().rposition(|m| *m).unwrap_or(0);
    let plain = [at(cells[low].rows[0]), at(cells[high].rows[1])];
    let Some(period) = axis.period else {
        return plain;
    };
    // The longest run of cells that are not marked: it may be outside, or between.
    let (mut longest, mut from, mut run) = (low + marked.len() - 1 - high, None, 0);
    for k in low..=high {
        run = if marked[k] { 0 } else { run + 1 };
        if run > longest {
            (longest, from) = (run, Some(k));
        }
    }
    match from {
        Some(end) => [
            at(cells[end + 1].rows[0]),
            at(cells[end - longest].rows[1]) + period,
        ],
        None => plain,
    }
}

#[inline(always)]
fn find(parents: &mut [u32], mut k: u32) -> u32 {
    while parents[k as usize] != k {
        // Halving the path.
        parents[k as usize] = parents[parents[k as usize] as usize];
        k = parents[k as usize];
    }
    k
}

/// The lesser root stays.
#[inline(always)]
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parents, a), find(parents, b));
    if a != b {
        parents[a.max(b) as usize] = a.min(b);
    }
}
