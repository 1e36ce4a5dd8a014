//! Model `net`: the nodes of a fine grid of cells as sums of few coordinates, the published control
//! points among them.
//!
//! The coordinates are the control points of a volume: the surface's own net outside, and shells
//! inside it, blended by a quadratic B-spline in depth. Cells lie between the control points of the
//! same volume over finer knots, so a node is a sum of coordinates with the weights of knot
//! insertion: the surface of the fine grid is the surface. Forces at nodes go to coordinates by the
//! transpose (Galerkin), and the step's matrix is small.

use super::cells::CellGrid;
use super::layers::{self, Rings};
use super::node_map::NodeMap;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};

/// One direction of the volume: a row of weights on coordinates for every fine place.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    coarse: usize,
    rows: Vec<Vec<(u32, f64)>>,
}

impl Axis {
    /// Knot insertion from `coarse` to `fine`, which holds all its knots; `seam`: the last control
    /// point repeats the first, before and after.
    pub fn insertion(coarse: &KnotVector, fine: &KnotVector, seam: bool) -> Self {
        let repeated = usize::from(seam);
        let count = coarse.count() - repeated;
        let change = coarse.refinement(fine);
        let rows = (0..fine.count() - repeated)
            .map(|row| {
                change
                    .entries(row)
                    .map(|(column, weight)| ((column % count) as u32, weight))
                    .collect()
            })
            .collect();
        Self {
            coarse: count,
            rows,
        }
    }

    /// Depth: `coarse` coordinates of a quadratic (or, for two, linear) B-spline, seen at `fine`
    /// even places.
    pub fn depth(coarse: usize, fine: usize) -> Self {
        let degree = (coarse - 1).clamp(1, 2);
        let Ok(knots) = KnotVector::clamped_uniform(degree, coarse) else {
            return Self {
                coarse,
                rows: vec![vec![(0, 1.0)]; fine],
            };
        };
        let (start, end) = knots.domain();
        let row = |k: usize| {
            let window = knots.window(start + (end - start) * k as f64 / (fine - 1).max(1) as f64);
            let values = window.values().iter().enumerate();
            values
                .map(|(i, &value)| ((window.first + i) as u32, value))
                .filter(|entry| entry.1 != 0.0)
                .collect()
        };
        Self {
            coarse,
            rows: (0..fine).map(row).collect(),
        }
    }

    /// Where a coordinate of [`Axis::depth`] stands when the volume is straight in depth: its
    /// Greville abscissa in 0 … 1.
    fn place(&self, coordinate: usize) -> f64 {
        let degree = (self.coarse - 1).clamp(1, 2);
        KnotVector::clamped_uniform(degree, self.coarse).map_or(0.0, |knots| {
            let (start, end) = knots.domain();
            (knots.greville()[coordinate] - start) / (end - start)
        })
    }
}

/// A grid of cells, and the coordinates that move it: fewer, or the nodes themselves.
#[derive(Debug)]
pub struct Reduced {
    /// Cells between nodes; its `node_of_control` is not asked for.
    pub grid: CellGrid,
    /// Nodes from coordinates.
    pub map: NodeMap,
    /// At rest, m.
    pub coordinates: Vec<Point3>,
    /// (control points).
    pub coordinate_of_control: Vec<u32>,
    /// (cells): number of the patch of neighbours with which a nearly incompressible cell shares its pressure;
    /// empty where each cell has its own.
    pub patch_of_cell: Vec<u32>,
}

/// A row of weights on coordinates that sum to one. Points of a rational surface are such sums too:
/// what knot insertion gives for them, times the weights of the control points.
fn summing_to_one(mut row: Vec<(u32, f64)>, rational: bool) -> Vec<(u32, f64)> {
    if rational {
        let total: f64 = row.iter().map(|entry| entry.1).sum();
        row.iter_mut().for_each(|entry| entry.1 /= total);
    }
    row
}

/// A closed body: rings of control points, with `weights` if they are those of a rational surface,
/// `depth` from the surface to the medial curve.
pub fn rings(
    points: &[Point3],
    weights: Option<&[f64]>,
    shape: &Rings,
    around: &Axis,
    along: &Axis,
    depth: &Axis,
) -> Reduced {
    let shells = depth.coarse - 1;
    let coarse_index = layers::ring_nodes(shape, shells);
    // Shells stand where a straight volume has them.
    let stand = |medial: &[Point3]| {
        let coarse = layers::rings_about(medial, points, shape, shells);
        let mut coordinates = coarse.nodes;
        for j in 0..shape.along {
            for i in 0..shape.around {
                let at = |shell: usize| {
                    coarse_index[(shell * shape.along + j) * shape.around + i] as usize
                };
                let (outside, inside) = (coordinates[at(0)], coordinates[at(shells)]);
                for shell in 1..shells {
                    coordinates[at(shell)] = outside + (inside - outside) * depth.place(shell);
                }
            }
        }
        (coordinates, coarse.node_of_control)
    };
    let mut fine = Rings::seamless(around.rows.len(), along.rows.len(), shape.ends);
    fine.medial = shape.medial;
    let fine_layers = depth.rows.len() - 1;
    let fine_index = layers::ring_nodes(&fine, fine_layers);
    let count = fine_index.iter().max().map_or(0, |&last| last as usize + 1);
    let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); count];
    for (layer, in_depth) in depth.rows.iter().enumerate() {
        for (j, in_along) in along.rows.iter().enumerate() {
            for (i, in_around) in around.rows.iter().enumerate() {
                let row =
                    &mut rows[fine_index[(layer * fine.along + j) * fine.around + i] as usize];
                if !row.is_empty() {
                    continue;
                }
                for &(shell, a) in in_depth {
                    for &(b_index, b) in in_along {
                        for &(c_index, c) in in_around {
                            let at = (shell as usize * shape.along + b_index as usize)
                                * shape.around
                                + c_index as usize;
                            let of_control = weights.map_or(1.0, |weights| {
                                weights[shape.control(c_index as usize, b_index as usize)]
                            });
                            row.push((coarse_index[at], a * b * c * of_control));
                        }
                    }
                }
                *row = summing_to_one(std::mem::take(row), weights.is_some());
            }
        }
    }
    let map = NodeMap::from_rows(rows);
    let cells = layers::ring_cells(&fine, fine_layers);
    let patch_of_cell = layers::ring_patches(&fine, fine_layers);
    let build = |medial: &[Point3]| {
        let grid = CellGrid {
            nodes: map.nodes(&stand(medial).0),
            cells: cells.clone(),
            node_of_control: Vec::new(),
        };
        grid.right_handed()
    };
    let medial = layers::best_medial(points, shape, build);
    let (coordinates, coordinate_of_control) = stand(&medial);
    let grid = build(&medial);
    Reduced {
        grid,
        map,
        coordinates,
        coordinate_of_control,
        patch_of_cell,
    }
}

/// A sheet of a thickness (m): `depth` from the net down along the inward normals at its control
/// points, with `weights` if they are those of a rational surface.
pub fn sheet(
    points: &[Point3],
    weights: Option<&[f64]>,
    inward_normals: &[Vector3],
    along_rows: &Axis,
    along_columns: &Axis,
    depth: &Axis,
    thickness_m: f64,
) -> Reduced {
    let (rows, columns) = (along_rows.coarse, along_columns.coarse);
    let mut coordinates = Vec::with_capacity(points.len() * depth.coarse);
    for shell in 0..depth.coarse {
        let down = thickness_m * depth.place(shell);
        coordinates.extend(
            points
                .iter()
                .zip(inward_normals)
                .map(|(point, normal)| point + normal * down),
        );
    }
    let mut of_nodes = Vec::new();
    for in_depth in &depth.rows {
        for in_row in &along_rows.rows {
            for in_column in &along_columns.rows {
                let mut row = Vec::new();
                for &(shell, a) in in_depth {
                    for &(r, b) in in_row {
                        for &(c, d) in in_column {
                            let control = r as usize * columns + c as usize;
                            let of_control = weights.map_or(1.0, |weights| weights[control]);
                            let coordinate = shell as usize * rows * columns + control;
                            row.push((coordinate as u32, a * b * d * of_control));
                        }
                    }
                }
                of_nodes.push(summing_to_one(row, weights.is_some()));
            }
        }
    }
    let map = NodeMap::from_rows(of_nodes);
    let nodes = map.nodes(&coordinates);
    let cells = layers::sheet_cells(
        along_rows.rows.len(),
        along_columns.rows.len(),
        depth.rows.len(),
    );
    let grid = CellGrid {
        nodes,
        cells,
        node_of_control: Vec::new(),
    }
    .right_handed();
    Reduced {
        grid,
        map,
        coordinates,
        coordinate_of_control: (0..points.len() as u32).collect(),
        patch_of_cell: layers::sheet_patches(
            along_rows.rows.len(),
            along_columns.rows.len(),
            depth.rows.len(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::layers::RingEnds;
    use palpate_geometry::surface::{Direction, builtin};

    // Without the weights of its control points, the fine points of a sphere are off by 3 % of its
    // radius.
    #[test]
    fn the_outer_nodes_of_a_rational_surface_are_those_of_the_same_surface_refined() {
        let sphere = builtin("sphere", None, Some(1.0)).unwrap();
        let inner: Vec<f64> = (0..8).map(|k| 0.0625 + 0.125 * k as f64).collect();
        let finer = |direction| sphere.insert_knots(direction, &inner).unwrap();
        let (finer_u, finer_v) = (finer(Direction::U), finer(Direction::V));
        let around = Axis::insertion(sphere.knots_u(), finer_u.knots_u(), true);
        let along = Axis::insertion(sphere.knots_v(), finer_v.knots_v(), false);
        let shape = Rings {
            around: 8,
            along: 5,
            ends: RingEnds {
                axis_closed: false,
                first_pole: true,
                last_pole: true,
            },
            u_around: true,
            columns: 5,
            medial: Default::default(),
        };
        let depth = Axis::depth(3, 5);
        let points = sphere.net().points();
        let reduced = rings(points, sphere.weights(), &shape, &around, &along, &depth);
        let exact = finer_u.insert_knots(Direction::V, &inner).unwrap();
        let fine = Rings {
            around: 16,
            along: 13,
            columns: 13,
            ..shape
        };
        let index = layers::ring_nodes(&fine, 4);
        for j in 0..13 {
            for i in 0..16 {
                let node = reduced.grid.nodes[index[j * 16 + i] as usize];
                let off = (node - exact.net().at(i, j)).norm();
                assert!(off < 1e-14, "node {i}, {j} is off by {off}");
            }
        }
        // Patches of cells that meet at a node, eight of them but for odd counts.
        let cells = &reduced.grid.cells;
        assert_eq!(reduced.patch_of_cell.len(), cells.len());
        for patch in 0..=*reduced.patch_of_cell.iter().max().unwrap() {
            let of_patch = reduced.patch_of_cell.iter().zip(cells);
            let of_patch = of_patch.filter(|(number, _)| **number == patch);
            let of_patch: Vec<_> = of_patch.map(|(_, cell)| cell).collect();
            let common = |node: &u32| of_patch.iter().all(|cell| cell.contains(node));
            assert!((1..=8).contains(&of_patch.len()) && of_patch[0].iter().any(common));
        }
    }
}
