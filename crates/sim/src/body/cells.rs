//! Hexahedral cells, some of them collapsed to wedges, with their volumes.

pub use super::quality::CellQuality;
use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// Node indices, corner (a, b, c) at `4 a + 2 b + c`; equal indices collapse edges (wedges at a
/// curve or a pole).
pub type Cell = [u32; 8];

/// Nodes and cells of a solid, and which node each control point of its surface is.
#[derive(Clone, Debug)]
pub struct CellGrid {
    /// Rest positions, m.
    pub nodes: Vec<Point3>,
    /// All cells.
    pub cells: Vec<Cell>,
    /// (control points): node of each control point, u-major.
    pub node_of_control: Vec<u32>,
}

/// Gauss points on [0, 1].
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// The 12 edges of a cell, as corner pairs.
pub const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// The 6 faces of a cell, corners in order around.
pub const FACES: [[usize; 4]; 6] = [
    [0, 1, 3, 2],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 3, 7, 6],
    [0, 2, 6, 4],
    [1, 3, 7, 5],
];

impl CellGrid {
    /// Volume of a cell, m³, however its corners turn.
    pub fn volume(&self, cell: &Cell) -> f64 {
        self.signed_volume(cell).abs()
    }

    /// Volume of a cell, m³: positive when its axes a, b, c turn right-handed. The trilinear map's
    /// Jacobian is integrated exactly by 2 × 2 × 2 Gauss points, collapsed or not.
    pub fn signed_volume(&self, cell: &Cell) -> f64 {
        self.gauss_determinants(cell).iter().map(|d| d / 8.0).sum()
    }

    /// [`gauss_determinants`] of a cell.
    pub fn gauss_determinants(&self, cell: &Cell) -> [f64; 8] {
        gauss_determinants(&cell.map(|node| self.nodes[node as usize]))
    }

    /// The same cells, all turned over if together they are left-handed.
    pub fn right_handed(mut self) -> Self {
        if self
            .cells
            .iter()
            .map(|cell| self.signed_volume(cell))
            .sum::<f64>()
            < 0.0
        {
            for cell in &mut self.cells {
                for corner in [0, 2, 4, 6] {
                    cell.swap(corner, corner + 1);
                }
            }
        }
        self
    }
}

/// Determinant of the trilinear map's Jacobian at the 2 × 2 × 2 Gauss points, m³, of a cell with these corners; the cell is
/// one unit wide.
pub fn gauss_determinants(corners: &[Point3; 8]) -> [f64; 8] {
    let mut determinants = [0.0; 8];
    for (k, determinant) in determinants.iter_mut().enumerate() {
        let [a, b, c] = [GAUSS[k >> 2], GAUSS[(k >> 1) & 1], GAUSS[k & 1]];
        *determinant = jacobian(corners, a, b, c).determinant();
    }
    determinants
}

/// Determinant of the trilinear map's Jacobian in the middle, m³, of a cell with these corners.
pub fn middle_determinant(corners: &[Point3; 8]) -> f64 {
    jacobian(corners, 0.5, 0.5, 0.5).determinant()
}

/// Columns ∂x/∂a, ∂x/∂b, ∂x/∂c at (a, b, c) in [0, 1]³.
fn jacobian(corners: &[Point3; 8], a: f64, b: f64, c: f64) -> Matrix3 {
    let mut columns = [Vector3::zeros(); 3];
    for (corner, point) in corners.iter().enumerate() {
        let x = point.coords;
        let at = |bit: usize, t: f64| {
            if corner & bit != 0 {
                (t, 1.0)
            } else {
                (1.0 - t, -1.0)
            }
        };
        let ((fa, da), (fb, db), (fc, dc)) = (at(4, a), at(2, b), at(1, c));
        columns[0] += x * (da * fb * fc);
        columns[1] += x * (fa * db * fc);
        columns[2] += x * (fa * fb * dc);
    }
    Matrix3::from_columns(&columns)
}
