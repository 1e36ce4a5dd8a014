//! Triangles around a solid f ≤ 0, for pictures.
//!
//! Ranges of f over ever smaller boxes find the part of space where the boundary is; that part is
//! cut into cells and each cell into six tetrahedra (Doi & Koide 1991), whose crossed edges give the
//! corners. Cells share their diagonals, so the triangles are closed. Edges and tips of the solid
//! are cut off by up to a cell, and what is thinner than a cell may be missing.

use super::shape::ImplicitTool;
use crate::math::{Point3, Vector3};
use crate::surface::Mesh;
use std::collections::BTreeMap;

/// Halvings of the box in search of the boundary.
const HALVINGS: usize = 5;
/// Cells along the longest side at first; fewer where they give too many triangles.
const CELLS: usize = 40;
/// Bisections of a crossed edge.
const BISECTIONS: usize = 30;

/// Corners of the six tetrahedra of a cell, bit k of a corner for axis k. All share the diagonal
/// from 0 to 7, and opposite faces of the cell are cut alike.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

impl ImplicitTool {
    /// Closed triangles on the boundary of the solid within `reach_m` of the origin in x, y and z,
    /// counter-clockwise seen from outside, at most `most` of them. A solid that extends beyond
    /// `reach_m` is cut off and closed there. Empty if no boundary lies within it.
    pub fn outline(&self, reach_m: f64, most: usize) -> Mesh {
        let empty = || Mesh {
            points: Vec::new(),
            normals: Vec::new(),
            triangles: Vec::new(),
        };
        let Some((low, high)) = self.where_boundary_is(reach_m) else {
            return empty();
        };
        let mut cells = CELLS;
        loop {
            let (points, triangles) = Grid::over(low, high, cells).triangles(self, reach_m);
            if triangles.len() <= most || cells <= 4 {
                return Mesh::from_triangles(points, triangles).unwrap_or_else(empty);
            }
            // Their number goes with the square of the cells.
            let share = (most as f64 / triangles.len() as f64).sqrt();
            cells = ((cells as f64 * share) as usize).clamp(4, cells - 1);
        }
    }

    /// Value at a point; above 0 beyond the reach and where the function means nothing.
    fn bounded_value(&self, p: &Point3, reach_m: f64) -> f64 {
        let value = self.tape().value(p);
        let beyond = p.coords.amax() - reach_m;
        if value.is_nan() {
            f64::INFINITY
        } else {
            value.max(beyond)
        }
    }

    /// A box that holds the boundary within the reach.
    fn where_boundary_is(&self, reach_m: f64) -> Option<(Point3, Point3)> {
        let whole = Vector3::repeat(reach_m);
        let mut boxes = vec![(Point3::origin(), whole)];
        for _ in 0..HALVINGS {
            let halves = boxes.iter().flat_map(|(centre, half)| {
                let half = half * 0.5;
                (0..8).map(move |k| {
                    let side = |axis: usize| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
                    let to = Vector3::new(side(0), side(1), side(2)).component_mul(&half);
                    (centre + to, half)
                })
            });
            // The whole solid, not only its boundary: what the reach cuts off is closed there.
            boxes = halves
                .filter(|(centre, half)| self.range_around(centre, half).low <= 0.0)
                .collect();
        }
        let first = boxes.first()?;
        let ends = |(centre, half): &(Point3, Vector3)| (centre - half, centre + half);
        Some(
            boxes
                .iter()
                .map(ends)
                .fold(ends(first), |(l, h), (a, b)| (l.inf(&a), h.sup(&b))),
        )
    }
}

/// Cells of nearly equal sides over a box, and one layer around it.
struct Grid {
    origin: Point3,
    step: Vector3,
    /// Corners along x, y, z.
    counts: [usize; 3],
}

impl Grid {
    fn over(low: Point3, high: Point3, cells: usize) -> Self {
        let size = high - low;
        let side = size.amax() / cells as f64;
        let inner = [0, 1, 2].map(|axis| ((size[axis] / side).ceil() as usize).max(4));
        let step = Vector3::from_fn(|axis, _| size[axis] / inner[axis] as f64);
        Self {
            // A hair off the lattice of the box: faces at round coordinates do not fall on corners.
            origin: low - step * 1.000_123,
            step: step * 1.000_05,
            counts: inner.map(|cells| cells + 3),
        }
    }

    fn place(&self, index: usize) -> Point3 {
        let [nx, ny, _] = self.counts;
        let at = [index % nx, index / nx % ny, index / (nx * ny)];
        self.origin + Vector3::from_fn(|axis, _| self.step[axis] * at[axis] as f64)
    }

    fn triangles(&self, tool: &ImplicitTool, reach_m: f64) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let [nx, ny, nz] = self.counts;
        let value = |p: &Point3| tool.bounded_value(p, reach_m);
        let inside: Vec<bool> = (0..nx * ny * nz)
            .map(|index| value(&self.place(index)) <= 0.0)
            .collect();
        // Corner on a crossed edge, by the ends of the edge, the inner one first.
        let mut corners: BTreeMap<(usize, usize), u32> = BTreeMap::new();
        let mut points: Vec<Point3> = Vec::new();
        let mut crossing = |within: usize, beyond: usize| {
            *corners.entry((within, beyond)).or_insert_with(|| {
                let (mut a, mut b) = (self.place(within), self.place(beyond));
                for _ in 0..BISECTIONS {
                    let middle = nalgebra::center(&a, &b);
                    if value(&middle) <= 0.0 {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
                points.push(a);
                points.len() as u32 - 1
            })
        };
        let mut triangles = Vec::new();
        for cell in 0..nx * ny * nz {
            let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
            if (0..3).any(|axis| at[axis] + 1 == self.counts[axis]) {
                continue;
            }
            let corner = |k: usize| cell + (k & 1) + (k >> 1 & 1) * nx + (k >> 2 & 1) * nx * ny;
            for tetrahedron in TETRAHEDRA {
                let t = tetrahedron.map(corner);
                let [within, beyond]: [Vec<usize>; 2] =
                    [true, false].map(|side| (0..4).filter(|&k| inside[t[k]] == side).collect());
                let mut cross = |i: usize, j: usize| crossing(t[i], t[j]);
                let faces = match (&within[..], &beyond[..]) {
                    (&[a], &[b, c, d]) => vec![[cross(a, b), cross(a, c), cross(a, d)]],
                    (&[a, b, c], &[d]) => vec![[cross(a, d), cross(b, d), cross(c, d)]],
                    (&[a, b], &[c, d]) => {
                        let [p, q, r, s] = [cross(a, c), cross(a, d), cross(b, d), cross(b, c)];
                        vec![[p, q, r], [p, r, s]]
                    }
                    _ => continue,
                };
                // Which way round follows from the order of the corners, which are right-handed.
                let turned = is_odd(&within, &beyond);
                for [a, b, c] in faces {
                    triangles.push(if turned { [a, c, b] } else { [a, b, c] });
                }
            }
        }
        (points, triangles)
    }
}

/// Whether triangles from the inner corners to the outer ones face inwards, for a tetrahedron whose
/// corners 1, 2, 3 go clockwise seen from corner 0.
fn is_odd(within: &[usize], beyond: &[usize]) -> bool {
    let order: Vec<usize> = within.iter().chain(beyond).copied().collect();
    let inversions = (0..4)
        .flat_map(|i| (i + 1..4).map(move |j| (i, j)))
        .filter(|&(i, j)| order[i] > order[j])
        .count();
    inversions % 2 == 1
}
