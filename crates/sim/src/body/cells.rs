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

/// Most nodes along one axis of cells in rows.
pub const MOST_NODES_A_SIDE: usize = 128;

/// Gauss points on [0, 1].
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// (Gauss point, corner): slopes of the corner's shape function along a, b and c.
const SLOPES: [[[f64; 3]; 8]; 8] = shape_slopes(
    [[1.0 - GAUSS[0], GAUSS[0]], [1.0 - GAUSS[1], GAUSS[1]]],
    1.0,
);

/// (corner): those in the middle of a cell.
const MIDDLE: [[f64; 3]; 8] = corner_slopes([[0.5; 2]; 3], 1.0);

/// (Gauss point, corner): slopes of trilinear shape functions along a, b and c; on each axis a corner's function is
/// `shares[point][corner]` at a Gauss point and grows with `slope` or falls with it.
pub(super) const fn shape_slopes(shares: [[f64; 2]; 2], slope: f64) -> [[[f64; 3]; 8]; 8] {
    let mut slopes = [[[0.0; 3]; 8]; 8];
    let mut gauss = 0;
    while gauss < 8 {
        let [a, b, c] = [gauss >> 2, gauss >> 1 & 1, gauss & 1];
        slopes[gauss] = corner_slopes([shares[a], shares[b], shares[c]], slope);
        gauss += 1;
    }
    slopes
}

/// [`shape_slopes`] at one place; `shares`: (axis, corner).
const fn corner_slopes(shares: [[f64; 2]; 3], slope: f64) -> [[f64; 3]; 8] {
    let mut slopes = [[0.0; 3]; 8];
    let mut corner = 0;
    while corner < 8 {
        let [a, b, c] = [corner >> 2, corner >> 1 & 1, corner & 1];
        let share = [shares[0][a], shares[1][b], shares[2][c]];
        let signs = [-slope, slope];
        slopes[corner] = [
            signs[a] * share[1] * share[2],
            share[0] * signs[b] * share[2],
            share[0] * share[1] * signs[c],
        ];
        corner += 1;
    }
    slopes
}

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
    /// Right-handed cells between `a × b × c` nodes in rows, node (i, j, k) at `(i b + j) c + k`; no node is a control point.
    pub fn in_rows(counts: [usize; 3], nodes: Vec<Point3>) -> Self {
        debug_assert_eq!(nodes.len(), counts.iter().product::<usize>(), "all nodes");
        let steps = counts.map(|n| n.saturating_sub(1));
        let mut cells = Vec::with_capacity(steps.iter().product());
        for i in 0..steps[0] {
            for j in 0..steps[1] {
                for k in 0..steps[2] {
                    let corner = |c: usize| {
                        let [i, j, k] = [i + (c >> 2), j + (c >> 1 & 1), k + (c & 1)];
                        ((i * counts[1] + j) * counts[2] + k) as u32
                    };
                    cells.push(std::array::from_fn(corner));
                }
            }
        }
        Self {
            nodes,
            cells,
            node_of_control: Vec::new(),
        }
    }

    /// A box between two corners, evenly divided by rows of nodes, two or more along each axis.
    pub fn cuboid(low: &Point3, high: &Point3, counts: [usize; 3]) -> Self {
        let sides = high - low;
        let [a, b, c] = counts;
        let place = |node: usize| {
            let [i, j, k] = [node / (b * c), node / c % b, node % c];
            let share = |t: usize, n: usize| t as f64 / (n - 1) as f64;
            Point3::new(
                low.x + sides.x * share(i, a),
                low.y + sides.y * share(j, b),
                low.z + sides.z * share(k, c),
            )
        };
        Self::in_rows(counts, (0..a * b * c).map(place).collect())
    }

    /// Volume of a cell, m³, however its corners turn.
    pub fn volume(&self, cell: &Cell) -> f64 {
        self.signed_volume(cell).abs()
    }

    /// Volume of a cell, m³: positive when its axes a, b, c turn right-handed. The trilinear map's
    /// Jacobian is integrated exactly by 2 × 2 × 2 Gauss points, collapsed or not.
    pub fn signed_volume(&self, cell: &Cell) -> f64 {
        volume_of(&self.gauss_determinants(cell))
    }

    /// Determinant of the trilinear map's Jacobian at the 2 × 2 × 2 Gauss points of a cell, m³; it is one unit wide.
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

/// Signed volume of a cell from its [`CellGrid::gauss_determinants`], m³.
pub(super) fn volume_of(determinants: &[f64; 8]) -> f64 {
    determinants.iter().map(|d| d / 8.0).sum()
}

/// Determinant of the trilinear map's Jacobian at the 2 × 2 × 2 Gauss points, m³, of a cell with these corners; the cell is
/// one unit wide.
pub fn gauss_determinants(corners: &[Point3; 8]) -> [f64; 8] {
    SLOPES.each_ref().map(|slopes| determinant(corners, slopes))
}

/// Determinant of the trilinear map's Jacobian in the middle, m³, of a cell with these corners.
pub fn middle_determinant(corners: &[Point3; 8]) -> f64 {
    determinant(corners, &MIDDLE)
}

/// Of the columns ∂x/∂a, ∂x/∂b, ∂x/∂c.
fn determinant(corners: &[Point3; 8], slopes: &[[f64; 3]; 8]) -> f64 {
    let mut columns = [Vector3::zeros(); 3];
    for (x, slopes) in corners.iter().zip(slopes) {
        for (column, slope) in columns.iter_mut().zip(slopes) {
            *column += x.coords * *slope;
        }
    }
    Matrix3::from_columns(&columns).determinant()
}
