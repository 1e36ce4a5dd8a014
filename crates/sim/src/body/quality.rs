//! How good the cells of a solid are.
//!
//! The scaled Jacobian at a corner is the determinant of its three edges over the product of their
//! lengths: 1 for a box, 0 when the edges lie in a plane, below 0 when the corner is turned inside
//! out (Knupp 2001). At the sharp edge of a wedge one of the three edges has no length, and the
//! Jacobian vanishes. What is judged there is its limit from inside the cell, which is the
//! determinant of the three distinct edges that leave the node. A node with only two edges in its
//! cell, as where a wedge beside a pole meets the medial curve, lies on an edge of a tetrahedron
//! and is not a corner: it is left to the Gauss points.

use super::cells::{Cell, CellGrid, EDGES, volume_of};
use palpate_geometry::math::{Matrix3, Vector3};

/// How good the cells are. Signs are relative to the cells' common sense of turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellQuality {
    /// Sum of the cells' volumes, m³.
    pub volume_m3: f64,
    /// Smallest cell volume, m³; below 0 when a cell is turned inside out.
    pub least_volume_m3: f64,
    /// Shortest and longest edge, m.
    pub edge_m: [f64; 2],
    /// Standard deviation of the lengths of edges over their mean; an edge counts once for each
    /// cell around it.
    pub edge_spread: f64,
    /// Least scaled Jacobian at a corner of any cell, in [−1, 1].
    pub least_scaled_jacobian: f64,
    /// The same over the cells that have eight distinct nodes; 1 when there are none.
    pub least_scaled_jacobian_hexahedra: f64,
    /// Cells whose Jacobian is not positive at one of the 2 × 2 × 2 Gauss points. No model can use
    /// such a cell.
    pub folded_cells: usize,
    /// Cells whose Jacobian is not positive at a corner. Springs and one-point energies live with
    /// these.
    pub folded_corner_cells: usize,
}

impl CellQuality {
    /// Volume of the cells over the volume that the surface encloses, less 1.
    pub fn volume_error(&self, enclosed_m3: f64) -> f64 {
        self.volume_m3 / enclosed_m3.abs() - 1.0
    }
}

impl CellGrid {
    /// Figures for `palpate plan`, for builders and for tests. No cells: a volume of 0 and nothing
    /// folded.
    pub fn quality(&self) -> CellQuality {
        let (determinants, sense) = self.turning();
        let mut quality = CellQuality {
            volume_m3: 0.0,
            least_volume_m3: f64::INFINITY,
            edge_m: [f64::INFINITY, 0.0],
            edge_spread: 0.0,
            least_scaled_jacobian: 1.0,
            least_scaled_jacobian_hexahedra: 1.0,
            folded_cells: 0,
            folded_corner_cells: 0,
        };
        let (mut edges, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for (cell, determinants) in self.cells.iter().zip(&determinants) {
            let volume = volume_of(determinants);
            quality.volume_m3 += volume.abs();
            quality.least_volume_m3 = quality.least_volume_m3.min(sense * volume);
            for [a, b] in EDGES {
                if cell[a] != cell[b] {
                    let length =
                        (self.nodes[cell[a] as usize] - self.nodes[cell[b] as usize]).norm();
                    quality.edge_m = [quality.edge_m[0].min(length), quality.edge_m[1].max(length)];
                    (edges, sum, squares) = (edges + 1.0, sum + length, squares + length * length);
                }
            }
            quality.folded_cells += usize::from(is_folded(determinants, sense));
            let least = self.least_scaled_jacobian(cell, sense);
            quality.folded_corner_cells += usize::from(least <= 0.0);
            quality.least_scaled_jacobian = quality.least_scaled_jacobian.min(least);
            if distinct(cell) == 8 {
                quality.least_scaled_jacobian_hexahedra =
                    quality.least_scaled_jacobian_hexahedra.min(least);
            }
        }
        if sum > 0.0 {
            let mean = sum / edges;
            quality.edge_spread = (squares / edges - mean * mean).max(0.0).sqrt() / mean;
        }
        quality
    }

    /// [`CellQuality::folded_cells`], and the sense in which the cells turn together.
    pub(super) fn folded_cells(&self) -> (usize, f64) {
        let (determinants, sense) = self.turning();
        let folded = |of_cell: &&[f64; 8]| is_folded(of_cell, sense);
        (determinants.iter().filter(folded).count(), sense)
    }

    /// [`CellQuality::folded_corner_cells`] and [`CellQuality::least_scaled_jacobian_hexahedra`].
    pub(super) fn corners(&self, sense: f64) -> (usize, f64) {
        let (mut folded, mut least_of_all) = (0, 1.0_f64);
        for cell in &self.cells {
            let least = self.least_scaled_jacobian(cell, sense);
            folded += usize::from(least <= 0.0);
            if distinct(cell) == 8 {
                least_of_all = least_of_all.min(least);
            }
        }
        (folded, least_of_all)
    }

    /// [`CellGrid::gauss_determinants`] of all cells, and the sense in which they turn together.
    fn turning(&self) -> (Vec<[f64; 8]>, f64) {
        let cells = self.cells.iter();
        let determinants: Vec<[f64; 8]> = cells.map(|cell| self.gauss_determinants(cell)).collect();
        let total: f64 = determinants.iter().map(volume_of).sum();
        (determinants, if total < 0.0 { -1.0 } else { 1.0 })
    }

    /// Over the corners of a cell, at most 1.
    fn least_scaled_jacobian(&self, cell: &Cell, sense: f64) -> f64 {
        let corners = (0..8).filter_map(|corner| self.scaled_jacobian(cell, corner));
        corners.map(|value| sense * value).fold(1.0, f64::min)
    }

    /// Scaled Jacobian at a corner (0 to 7) of a cell, positive when it turns right-handed; see the
    /// module for collapsed ones. `None` where the cell has fewer than three edges, 0 where it has
    /// no extent.
    pub fn scaled_jacobian(&self, cell: &Cell, corner: usize) -> Option<f64> {
        let at = |corner: usize| self.nodes[cell[corner] as usize];
        // The edge of an axis (bit 4, 2 or 1) at the corner `near`, towards rising a, b or c.
        let edge = |near: usize, axis: usize| at(near | axis) - at(near & !axis);
        let collapsed = |near: usize, axis: usize| cell[near | axis] == cell[near & !axis];
        let mut columns = [Vector3::zeros(); 3];
        let mut scale = 1.0;
        let here = [4, 2, 1]
            .into_iter()
            .filter(|&axis| collapsed(corner, axis))
            .count();
        if here > 1 {
            return None;
        }
        for (column, axis) in columns.iter_mut().zip([4, 2, 1]) {
            if !collapsed(corner, axis) {
                *column = edge(corner, axis);
                scale *= column.norm();
                continue;
            }
            // The node's other corner in this cell has the third edge; across its foot the
            // collapsed one has a length.
            let near = [4, 2, 1]
                .map(|other| corner ^ other)
                .into_iter()
                .find(|&near| !collapsed(near, axis))?;
            *column = edge(near, axis);
            scale *= (at(near ^ axis) - at(corner)).norm();
        }
        Some(if scale > 0.0 {
            Matrix3::from_columns(&columns).determinant() / scale
        } else {
            0.0
        })
    }
}

fn is_folded(determinants: &[f64; 8], sense: f64) -> bool {
    determinants.iter().any(|d| d.is_nan() || sense * d <= 0.0)
}

/// Number of distinct nodes of a cell.
pub(super) fn distinct(cell: &Cell) -> usize {
    let mut nodes = *cell;
    nodes.sort_unstable();
    1 + nodes.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::{Point3, Rotation};

    fn close(a: f64, b: f64, what: &str) {
        assert!((a - b).abs() < 1e-14, "{what}: {a} is not {b}");
    }

    /// A unit cube of one cell, its corners moved by `map`.
    fn cube(map: impl Fn(Point3) -> Point3) -> CellGrid {
        let corner = |k: usize| Point3::new((k >> 2) as f64, (k >> 1 & 1) as f64, (k & 1) as f64);
        CellGrid {
            nodes: (0..8).map(|k| map(corner(k))).collect(),
            cells: vec![[0, 1, 2, 3, 4, 5, 6, 7]],
            node_of_control: vec![],
        }
    }

    #[test]
    fn a_box_has_scaled_jacobian_one_and_a_sheared_one_the_sine_of_its_angle() {
        let turn = Rotation::from_euler_angles(0.4, -0.7, 1.9);
        for shear in [0.0, 0.3, -2.0] {
            let grid = cube(|p| turn * Point3::new(p.x * 3.0 + shear * p.y, p.y, p.z * 0.2));
            let quality = grid.quality();
            close(
                quality.least_scaled_jacobian,
                1.0 / (1.0_f64 + shear * shear).sqrt(),
                "sine",
            );
            close(
                quality.least_scaled_jacobian_hexahedra,
                quality.least_scaled_jacobian,
                "one hexahedron",
            );
            close(quality.volume_m3, 0.6, "volume");
            assert_eq!((quality.folded_cells, quality.folded_corner_cells), (0, 0));
        }
        // Lengths 3, 1, 0.2: mean 1.4, mean square 10.04 / 3.
        let spread = cube(|p| Point3::new(p.x * 3.0, p.y, p.z * 0.2))
            .quality()
            .edge_spread;
        close(spread, (10.04 / 3.0 - 1.4_f64 * 1.4).sqrt() / 1.4, "spread");
    }

    #[test]
    fn a_corner_pushed_through_its_opposite_face_is_folded_and_the_sense_of_turning_does_not_matter()
     {
        for mirror in [1.0, -1.0] {
            let pushed = |depth: f64| {
                cube(|p| {
                    if p.coords == Vector3::repeat(1.0) {
                        Point3::new(mirror * depth, depth, depth)
                    } else {
                        Point3::new(mirror * p.x, p.y, p.z)
                    }
                })
            };
            // With three neighbours in the plane x + y + z = 2, the corner is flat at depth 2/3.
            let just_above = pushed(2.0 / 3.0 + 1e-9).quality();
            assert!(just_above.least_scaled_jacobian > 0.0 && just_above.folded_corner_cells == 0);
            let just_below = pushed(2.0 / 3.0 - 1e-9).quality();
            assert!(
                just_below.least_scaled_jacobian < 0.0 && just_below.folded_corner_cells == 1,
                "{just_below:?}"
            );
            assert_eq!(just_below.folded_cells, 0);
            assert_eq!(pushed(-0.5).quality().folded_cells, 1);
        }
    }

    // Corner c of the cube collapsed onto its neighbour makes a wedge: apex angle α between the two
    // long sides.
    #[test]
    fn a_wedge_is_judged_by_its_angles_as_a_prism_would_be() {
        for angle in [0.2, 1.0, 1.5, 2.5_f64] {
            let (s, c) = (angle.sin(), angle.cos());
            // a = 1 is the apex line (z along b), c picks the side.
            let nodes = vec![
                Point3::new(1.0, 0.0, 0.0),
                Point3::new(c, s, 0.0),
                Point3::new(1.0, 0.0, 2.0),
                Point3::new(c, s, 2.0),
                Point3::origin(),
                Point3::new(0.0, 0.0, 2.0),
            ];
            let grid = CellGrid {
                nodes,
                cells: vec![[0, 1, 2, 3, 4, 4, 5, 5]],
                node_of_control: vec![],
            }
            .right_handed();
            let quality = grid.quality();
            // At the apex sin α, at the base sin of (π − α) / 2.
            close(
                quality.least_scaled_jacobian,
                s.min((angle / 2.0).cos()),
                "least sine",
            );
            close(quality.volume_m3, s, "volume");
            assert_eq!(
                quality.least_scaled_jacobian_hexahedra, 1.0,
                "there is no hexahedron"
            );
            assert_eq!(quality.folded_cells, 0);
            for corner in 0..8 {
                let node = grid.cells[0][corner];
                close(
                    grid.scaled_jacobian(&grid.cells[0], corner).unwrap(),
                    if node >= 4 { s } else { (angle / 2.0).cos() },
                    "corner",
                );
            }
        }
    }

    #[test]
    fn cells_without_extent_or_numbers_are_folded_and_nothing_panics() {
        assert_eq!(cube(|_| Point3::origin()).quality().folded_cells, 1);
        assert_eq!(
            cube(|p| Point3::new(p.x, p.y, 0.0)).quality().folded_cells,
            1
        );
        assert_eq!(
            cube(|_| Point3::new(f64::NAN, 0.0, 0.0))
                .quality()
                .folded_cells,
            1
        );
        let nothing = CellGrid {
            nodes: vec![],
            cells: vec![],
            node_of_control: vec![],
        }
        .quality();
        assert_eq!((nothing.volume_m3, nothing.folded_cells), (0.0, 0));
    }
}
