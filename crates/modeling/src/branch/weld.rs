//! One mesh of the distinct patches, corners of their borders welded: what of the tree is closed,
//! and what is folded.

use super::patches::{Patch, PatchTable};
use palpate_geometry::basis::{KnotVector, Side};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{Mesh, SAME_POINT, Surface};
use std::collections::BTreeMap;

/// A welded mesh and what its edges say.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// Triangles over shared corners; counter-clockwise seen from outside.
    pub mesh: Mesh,
    /// Corners − edges + triangles.
    pub euler: i64,
    /// Rings of edges with one triangle.
    pub loops: usize,
    /// Edges with more than two triangles.
    pub non_manifold: usize,
    /// Edges whose two triangles turn against each other.
    pub inconsistent: usize,
    /// Edges whose two triangles face away from each other, by more than 90°.
    pub folded: usize,
}

/// The mesh of the distinct patches with so many cells to a span in u and v.
pub(super) fn welded(surface: &Surface, table: &PatchTable, cells: usize) -> Welded {
    let mut corners = Corners::default();
    let mut cells_of: Vec<[usize; 4]> = Vec::new();
    for patch in table.distinct() {
        corners.add(surface, patch, cells, &mut cells_of);
    }
    let number = corners.welded(SAME_POINT * surface.size());
    let mut points = Vec::new();
    let mut compact = vec![u32::MAX; corners.points.len()];
    for (k, point) in corners.points.iter().enumerate() {
        if number[k] == k {
            compact[k] = points.len() as u32;
            points.push(*point);
        }
    }
    let triangles: Vec<[u32; 3]> = cells_of
        .iter()
        .flat_map(|cell| {
            halves(
                cell.map(|k| compact[number[k]]),
                &points,
                surface.flip_normal(),
            )
        })
        .collect();
    let mesh = Mesh::from_triangles(points, triangles).unwrap_or_default();
    count(mesh)
}

#[derive(Default)]
struct Corners {
    points: Vec<Point3>,
    /// Those on the border of a patch.
    border: Vec<usize>,
}

impl Corners {
    fn add(&mut self, surface: &Surface, patch: &Patch, cells: usize, out: &mut Vec<[usize; 4]>) {
        let us = stations(surface.knots_u(), patch.u, cells);
        let vs = stations(surface.knots_v(), patch.v, cells);
        let side = |k: usize, n: usize| if k + 1 == n { Side::Left } else { Side::Right };
        let start = self.points.len();
        for (i, &u) in us.iter().enumerate() {
            let wu = surface.knots_u().window_from(u, side(i, us.len()));
            for (j, &v) in vs.iter().enumerate() {
                if i == 0 || j == 0 || i + 1 == us.len() || j + 1 == vs.len() {
                    self.border.push(self.points.len());
                }
                let wv = surface.knots_v().window_from(v, side(j, vs.len()));
                self.points.push(surface.point_in(&wu, &wv));
            }
        }
        let at = |i: usize, j: usize| start + i * vs.len() + j;
        for i in 0..us.len() - 1 {
            out.extend(
                (0..vs.len() - 1).map(|j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]),
            );
        }
    }

    /// For each corner the first one at its place.
    fn welded(&self, tolerance: f64) -> Vec<usize> {
        let mut number: Vec<usize> = (0..self.points.len()).collect();
        let mut sorted = self.border.clone();
        // Along a direction in which few corners are level with each other.
        let along = Vector3::new(0.836_660_03, 0.447_213_6, 0.316_227_77);
        let height = |k: usize| self.points[k].coords.dot(&along);
        sorted.sort_by(|&a, &b| height(a).total_cmp(&height(b)).then(a.cmp(&b)));
        for (n, &k) in sorted.iter().enumerate() {
            let near = sorted[..n]
                .iter()
                .rev()
                .take_while(|&&other| height(k) - height(other) <= 2.0 * tolerance);
            for &other in
                near.filter(|&&other| (self.points[k] - self.points[other]).norm() <= tolerance)
            {
                let (a, b) = (root(&number, k), root(&number, other));
                number[a.max(b)] = a.min(b);
            }
        }
        (0..number.len()).map(|k| root(&number, k)).collect()
    }
}

fn root(to: &[usize], mut k: usize) -> usize {
    while to[k] != k {
        k = to[k];
    }
    k
}

/// Parameters of corners: each span of the range cut evenly.
fn stations(knots: &KnotVector, range: [f64; 2], cells: usize) -> Vec<f64> {
    let t = knots.knots();
    let mut stations = vec![range[0]];
    for i in knots
        .spans()
        .filter(|&i| t[i] >= range[0] && t[i + 1] <= range[1])
    {
        stations.extend((1..cells).map(|k| t[i] + (t[i + 1] - t[i]) * (k as f64 / cells as f64)));
        stations.push(t[i + 1]);
    }
    stations
}

/// Two triangles across the shorter diagonal, without those that welding closed.
fn halves([a, b, c, d]: [u32; 4], points: &[Point3], flip: bool) -> impl Iterator<Item = [u32; 3]> {
    let length = |x: u32, y: u32| (points[x as usize] - points[y as usize]).norm_squared();
    let halves = if length(a, c) <= length(b, d) {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    };
    let proper = |[x, y, z]: &[u32; 3]| x != y && y != z && z != x;
    halves
        .into_iter()
        .filter(proper)
        .map(move |[x, y, z]| if flip { [x, z, y] } else { [x, y, z] })
}

/// Triangles at an edge, and how many of them walk it upwards.
#[derive(Default)]
struct Around {
    upwards: usize,
    triangles: Vec<usize>,
}

fn count(mesh: Mesh) -> Welded {
    let mut edges: BTreeMap<[u32; 2], Around> = BTreeMap::new();
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let around = edges.entry([from.min(to), from.max(to)]).or_default();
            around.upwards += usize::from(from < to);
            around.triangles.push(t);
        }
    }
    let across = |t: usize| {
        let [a, b, c] = mesh.triangles[t].map(|k| mesh.points[k as usize]);
        (b - a).cross(&(c - a))
    };
    let folded =
        |around: &Around| across(around.triangles[0]).dot(&across(around.triangles[1])) < 0.0;
    let pairs = || edges.values().filter(|around| around.triangles.len() == 2);
    let mut used = vec![false; mesh.points.len()];
    mesh.triangles
        .iter()
        .flatten()
        .for_each(|&k| used[k as usize] = true);
    let corners = used.iter().filter(|used| **used).count();
    Welded {
        euler: corners as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
        loops: rings(&edges, mesh.points.len()),
        non_manifold: edges
            .values()
            .filter(|around| around.triangles.len() > 2)
            .count(),
        inconsistent: pairs().filter(|around| around.upwards != 1).count(),
        folded: pairs()
            .filter(|around| around.upwards == 1 && folded(around))
            .count(),
        mesh,
    }
}

/// Connected sets of border edges.
fn rings(edges: &BTreeMap<[u32; 2], Around>, corners: usize) -> usize {
    let mut to: Vec<usize> = (0..corners).collect();
    let mut touched = vec![false; corners];
    for (edge, _) in edges
        .iter()
        .filter(|(_, around)| around.triangles.len() == 1)
    {
        let [a, b] = edge.map(|k| k as usize);
        (touched[a], touched[b]) = (true, true);
        let (a, b) = (root(&to, a), root(&to, b));
        to[a.max(b)] = a.min(b);
    }
    (0..corners).filter(|&k| touched[k] && to[k] == k).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Welded {
        count(
            Mesh::from_triangles(
                points.iter().map(|&p| Point3::from(p)).collect(),
                triangles.to_vec(),
            )
            .unwrap(),
        )
    }

    const SQUARE: [[f64; 3]; 5] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.2, 0.3, 1.0],
    ];

    #[test]
    fn counts_of_small_meshes_are_those_by_hand() {
        let numbers = |w: &Welded| (w.euler, w.loops, w.non_manifold, w.inconsistent, w.folded);
        let flat = counted(&SQUARE, &[[0, 1, 2], [0, 2, 3]]);
        assert_eq!(numbers(&flat), (1, 1, 0, 0, 0));
        let turned = counted(&SQUARE, &[[0, 1, 2], [0, 3, 2]]);
        assert_eq!(numbers(&turned), (1, 1, 0, 1, 0));
        let third = counted(&SQUARE, &[[0, 1, 2], [0, 2, 3], [0, 2, 4]]);
        assert_eq!(numbers(&third), (1, 1, 1, 0, 0));
        // Both halves over the same side of the diagonal.
        let folded = counted(
            &[
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.9, 0.2, 0.1],
            ],
            &[[0, 1, 2], [0, 2, 3]],
        );
        assert_eq!(numbers(&folded), (1, 1, 0, 0, 1));
        let tetrahedron = counted(
            &[SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[4]],
            &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        );
        assert_eq!(
            (
                tetrahedron.euler,
                tetrahedron.loops,
                tetrahedron.inconsistent
            ),
            (2, 0, 0)
        );
    }

    // Corners a hair apart, some of them level with each other along the sweep.
    #[test]
    fn corners_within_the_tolerance_are_one() {
        let mut corners = Corners::default();
        for k in 0..50 {
            let at = Point3::new(f64::from(k % 7), f64::from(k / 7), 0.5);
            corners.points.extend([
                at,
                at + Vector3::new(3e-10, -2e-10, 0.0),
                at + Vector3::new(0.0, 0.0, 3e-9),
            ]);
        }
        corners.border = (0..150).rev().collect();
        let number = corners.welded(1e-9);
        for k in (0..150).step_by(3) {
            assert_eq!(number[k..k + 3], [k, k, k + 2]);
        }
    }
}
