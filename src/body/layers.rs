//! Builder `layers`: the control points of a surface are the outermost nodes of its lattice.
//!
//! Closed surfaces: rings of control points shrink in equal steps towards a medial curve, so the cells beside the curve are
//! wedges. The curve follows the rings' centroids but ends short of the poles: were it to reach them, a flat end (a ring in
//! one plane with its pole) would have cells without volume. Open sheets: copies of the net at equal depths along the
//! inward normals. Either way the surface is exact: no node is fitted to it.

use super::cells::{Cell, CellGrid};
use crate::math::{Point3, Vector3};

/// What the rings of a closed surface do along the other direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingEnds {
    /// The axis closes on itself (a torus).
    pub axis_closed: bool,
    /// First ring is one point.
    pub first_pole: bool,
    /// Last ring is one point.
    pub last_pole: bool,
}

/// A closed surface as rings around an axis: `distinct` control points a ring, the rest repeat the first ones.
#[derive(Clone, Debug)]
pub struct Rings {
    /// Control points around, repeated seam points not counted.
    pub around: usize,
    /// Control points along, repeated seam points not counted.
    pub along: usize,
    /// Ends of the axis.
    pub ends: RingEnds,
}

/// Cells of a closed surface. `control(i, j)`: index of the control point i around, j along; `points`: all of them.
/// `layers` shells, the surface's included, then the medial curve.
pub fn rings(
    points: &[Point3],
    rings: &Rings,
    layers: usize,
    control: impl Fn(usize, usize) -> usize,
    ring_of_control: impl Fn(usize) -> (usize, usize),
) -> CellGrid {
    let Rings { around, along, .. } = *rings;
    let medial = medial_curve(points, rings, &control);
    let node = ring_nodes(rings, layers);
    let count = node.iter().max().map_or(0, |&last| last as usize + 1);
    let mut nodes = vec![Point3::origin(); count];
    for layer in 0..=layers {
        let shrink = 1.0 - layer as f64 / layers as f64;
        for j in 0..along {
            for i in (0..around).rev() {
                // Shared nodes stand where the first of their ring does.
                let place = medial[j] + (points[control(i, j)] - medial[j]) * shrink;
                nodes[node[(layer * along + j) * around + i] as usize] = place;
            }
        }
    }
    let cells = ring_cells(rings, layers);
    let node_of_control = (0..points.len())
        .map(|k| {
            let (i, j) = ring_of_control(k);
            node[j * around + i]
        })
        .collect();
    CellGrid { nodes, cells, node_of_control }
}

/// (layers + 1, along, around) → node; the medial curve and the poles of each shell repeat theirs.
pub fn ring_nodes(rings: &Rings, layers: usize) -> Vec<u32> {
    let Rings { around, along, ends } = *rings;
    let pole = |j: usize| (j == 0 && ends.first_pole) || (j + 1 == along && ends.last_pole);
    let at = |layer: usize, j: usize, i: usize| (layer * along + j) * around + i;
    let mut node = vec![0u32; (layers + 1) * along * around];
    let mut count = 0;
    for j in 0..along {
        for layer in 0..=layers {
            for i in 0..around {
                if i > 0 && (pole(j) || layer == layers) {
                    node[at(layer, j, i)] = node[at(layer, j, 0)];
                    continue;
                }
                node[at(layer, j, i)] = count;
                count += 1;
            }
        }
    }
    node
}

/// Cells between the nodes of [`ring_nodes`].
pub fn ring_cells(rings: &Rings, layers: usize) -> Vec<Cell> {
    let Rings { around, along, ends } = *rings;
    let node = ring_nodes(rings, layers);
    let steps_along = if ends.axis_closed { along } else { along - 1 };
    let mut cells = Vec::with_capacity(layers * steps_along * around);
    for layer in 0..layers {
        for j in 0..steps_along {
            for i in 0..around {
                cells.push(std::array::from_fn(|corner| {
                    let (dl, dj, di) = (corner >> 2, (corner >> 1) & 1, corner & 1);
                    node[((layer + dl) * along + (j + dj) % along) * around + (i + di) % around]
                }));
            }
        }
    }
    cells
}

/// One point a ring: along the polygon of ring centroids, drawn in at each pole by half the largest ring radius (or 0.4 of
/// the length, if that is less), evenly in arc length.
fn medial_curve(points: &[Point3], rings: &Rings, control: &impl Fn(usize, usize) -> usize) -> Vec<Point3> {
    let Rings { around, along, ends } = *rings;
    let ring = |j: usize| (0..around).map(move |i| points[control(i, j)]);
    let centroids: Vec<Point3> =
        (0..along).map(|j| Point3::from(ring(j).map(|p| p.coords).sum::<Vector3>() / around as f64)).collect();
    if ends.axis_closed || !(ends.first_pole || ends.last_pole) {
        return centroids;
    }
    let mut arc = vec![0.0; along];
    for j in 1..along {
        arc[j] = arc[j - 1] + (centroids[j] - centroids[j - 1]).norm();
    }
    let length = arc[along - 1];
    let radius = |j: usize| ring(j).map(|p| (p - centroids[j]).norm()).sum::<f64>() / around as f64;
    let inset = (0.5 * (0..along).map(radius).fold(0.0, f64::max)).min(0.4 * length);
    let first = if ends.first_pole { inset } else { 0.0 };
    let last = if ends.last_pole { inset } else { 0.0 };
    let place = |s: f64| {
        let k = arc.partition_point(|&a| a <= s).clamp(1, along - 1);
        let span = arc[k] - arc[k - 1];
        let t = if span > 0.0 { (s - arc[k - 1]) / span } else { 0.0 };
        centroids[k - 1] + (centroids[k] - centroids[k - 1]) * t
    };
    arc.iter().map(|&s| place(first + s * (length - first - last) / length)).collect()
}

/// Cells of an open sheet of `rows × columns` control points: `layers` ≥ 2 copies, the first is the net, the last lies
/// `thickness_m` below along the inward normals.
pub fn sheet(
    points: &[Point3],
    inward_normals: &[Vector3],
    rows: usize,
    columns: usize,
    layers: usize,
    thickness_m: f64,
) -> CellGrid {
    let mut nodes = Vec::with_capacity(points.len() * layers);
    for layer in 0..layers {
        let depth = thickness_m * layer as f64 / (layers - 1) as f64;
        nodes.extend(points.iter().zip(inward_normals).map(|(point, normal)| point + normal * depth));
    }
    let cells = sheet_cells(rows, columns, layers);
    CellGrid { nodes, cells, node_of_control: (0..points.len() as u32).collect() }
}

/// Cells between `layers` copies of rows × columns nodes.
pub fn sheet_cells(rows: usize, columns: usize, layers: usize) -> Vec<Cell> {
    let mut cells = Vec::new();
    for layer in 0..layers - 1 {
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                cells.push(std::array::from_fn(|corner| {
                    let (dl, dr, dc) = (corner >> 2, (corner >> 1) & 1, corner & 1);
                    (((layer + dl) * rows + row + dr) * columns + column + dc) as u32
                }));
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rings on a cylinder of revolution with both ends closed to poles: a double cone.
    fn double_cone(around: usize, along: usize) -> (Vec<Point3>, Rings) {
        let mut points = Vec::new();
        for i in 0..around {
            for j in 0..along {
                let angle = std::f64::consts::TAU * i as f64 / around as f64;
                let z = j as f64 / (along - 1) as f64;
                let radius = 0.5 * (1.0 - (2.0 * z - 1.0).abs());
                points.push(Point3::new(radius * angle.cos(), radius * angle.sin(), z));
            }
        }
        let ends = RingEnds { axis_closed: false, first_pole: true, last_pole: true };
        (points, Rings { around, along, ends })
    }

    #[test]
    fn layers_count_as_the_formula_says_and_fill_the_control_polyhedron() {
        for (around, along, layers) in [(12, 13, 4), (22, 23, 4), (6, 5, 1)] {
            let (points, shape) = double_cone(around, along);
            let grid = rings(&points, &shape, layers, |i, j| i * along + j, |k| (k / along, k % along));
            // Shells with two poles each, then the medial curve.
            assert_eq!(grid.nodes.len(), (around * (along - 2) + 2) * layers + along);
            for (k, point) in points.iter().enumerate() {
                let node = grid.nodes[grid.node_of_control[k] as usize];
                assert!((node - point).norm() < 1e-15, "control point {k} is not its node");
            }
            // A double cone over a regular polygon: 1/3 base × height, base = n/2 r² sin(2π/n).
            let n = around as f64;
            let base = 0.5 * n * 0.25 * (std::f64::consts::TAU / n).sin();
            let volume = grid.quality().volume_m3;
            assert!((volume - base / 3.0).abs() < 1e-12, "{volume} != {}", base / 3.0);
            assert!(grid.quality().least_volume_m3 > 0.0);
        }
    }
}
