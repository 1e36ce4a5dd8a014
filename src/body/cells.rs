//! Hexahedral cells, some of them collapsed to wedges, with their volumes and quality.

use crate::math::{Matrix3, Point3, Vector3};

/// Node indices, corner (a, b, c) at `4 a + 2 b + c`; equal indices collapse edges (wedges at a curve or a pole).
pub type Cell = [u32; 8];

/// Nodes and cells of a solid, and which node each control point of its surface is.
#[derive(Clone, Debug)]
pub struct CellGrid {
    /// Rest positions, m.
    pub nodes: Vec<Point3>,
    /// Cells.
    pub cells: Vec<Cell>,
    /// (control points): node of each control point, u-major.
    pub node_of_control: Vec<u32>,
}

/// How good the cells are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellQuality {
    /// Sum of the cells' volumes, m³.
    pub volume_m3: f64,
    /// Smallest cell volume, m³.
    pub least_volume_m3: f64,
    /// Shortest and longest edge, m.
    pub edge_m: [f64; 2],
}

/// The 12 edges of a cell, as corner pairs.
pub const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The 6 faces of a cell, corners in order around.
pub const FACES: [[usize; 4]; 6] = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

impl CellGrid {
    /// Volume of a cell: the trilinear map's Jacobian is integrated exactly by 2 × 2 × 2 Gauss points, collapsed or not.
    pub fn volume(&self, cell: &Cell) -> f64 {
        const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
        let mut volume = 0.0;
        for a in GAUSS {
            for b in GAUSS {
                for c in GAUSS {
                    volume += self.jacobian(cell, a, b, c).determinant() / 8.0;
                }
            }
        }
        volume.abs()
    }

    fn jacobian(&self, cell: &Cell, a: f64, b: f64, c: f64) -> Matrix3 {
        let mut columns = [Vector3::zeros(); 3];
        for (corner, &node) in cell.iter().enumerate() {
            let x = self.nodes[node as usize].coords;
            let at = |bit: usize, t: f64| if corner & bit != 0 { (t, 1.0) } else { (1.0 - t, -1.0) };
            let ((fa, da), (fb, db), (fc, dc)) = (at(4, a), at(2, b), at(1, c));
            columns[0] += x * (da * fb * fc);
            columns[1] += x * (fa * db * fc);
            columns[2] += x * (fa * fb * dc);
        }
        Matrix3::from_columns(&columns)
    }

    /// Figures for `palpate plan` and for tests.
    pub fn quality(&self) -> CellQuality {
        let mut quality = CellQuality { volume_m3: 0.0, least_volume_m3: f64::INFINITY, edge_m: [f64::INFINITY, 0.0] };
        for cell in &self.cells {
            let volume = self.volume(cell);
            quality.volume_m3 += volume;
            quality.least_volume_m3 = quality.least_volume_m3.min(volume);
            for [a, b] in EDGES {
                if cell[a] != cell[b] {
                    let length = (self.nodes[cell[a] as usize] - self.nodes[cell[b] as usize]).norm();
                    quality.edge_m = [quality.edge_m[0].min(length), quality.edge_m[1].max(length)];
                }
            }
        }
        quality
    }
}
