//! Springs of a lattice from its cells and Young's modulus: no stiffness is tuned by hand.
//!
//! On a cubic lattice of side h, edges and face diagonals with k = 0.4 E h, weighted by the share
//! of cells around them, make an isotropic solid with ν = 1/4. With h = V / l² the rule carries
//! over to distorted cells: every cell gives each of its edges 0.4 E V / l² / 4 and each of its
//! face diagonals twice that, / 2.
//!
//! On a square sheet of thickness t, edges with 3/4 E t and diagonals with 3/8 E t make an
//! isotropic membrane with ν = 1/3; with the area A of a cell, every cell gives each of its edges
//! 3/8 E t A / l² and each diagonal twice that.

use crate::body::cells::{CellGrid, EDGES, FACES};
use palpate_geometry::math::Point3;
use std::collections::BTreeMap;
use std::fmt::Debug;

/// A linear spring between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Smaller node index.
    pub a: u32,
    /// Larger node index.
    pub b: u32,
    /// k, N/m.
    pub stiffness_n_m: f64,
    /// L, m.
    pub rest_length_m: f64,
}

/// How the springs of a solid follow from its modulus, where that is not as [`MODULI`] has it.
pub trait SpringLaw: Debug + Sync {
    /// What scenes name it: `springs = "…"`.
    fn name(&self) -> &'static str;

    /// All springs of a solid, ordered by their nodes. `young_pa`: modulus of each cell.
    fn springs(&self, grid: &CellGrid, young_pa: &dyn Fn(usize) -> f64) -> Vec<Spring>;
}

/// What every cell gives its springs, as parts of E V / l².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellShares {
    /// Each of its edges.
    pub edge: f64,
    /// Each of its face diagonals.
    pub diagonal: f64,
}

/// An isotropic solid with the modulus asked for.
pub const MODULI: CellShares = CellShares {
    edge: 0.4 * 0.25,
    diagonal: 0.4,
};

/// Sums shares of springs, whose order is that of their nodes.
struct Shares<'a> {
    nodes: &'a [Point3],
    stiffness: BTreeMap<(u32, u32), f64>,
}

impl Shares<'_> {
    /// Adds `scaled / l²` between two nodes, if they are two.
    fn add(&mut self, a: u32, b: u32, scaled: f64) {
        if a != b {
            let length_squared = (self.nodes[a as usize] - self.nodes[b as usize]).norm_squared();
            if length_squared > 0.0 {
                *self.stiffness.entry((a.min(b), a.max(b))).or_insert(0.0) +=
                    scaled / length_squared;
            }
        }
    }

    fn springs(self) -> Vec<Spring> {
        let nodes = self.nodes;
        let spring = |((a, b), stiffness_n_m): ((u32, u32), f64)| {
            let rest_length_m = (nodes[a as usize] - nodes[b as usize]).norm();
            Spring {
                a,
                b,
                stiffness_n_m,
                rest_length_m,
            }
        };
        self.stiffness.into_iter().map(spring).collect()
    }
}

/// All springs of a solid, ordered by their nodes. `young_pa`: modulus of each cell.
pub fn springs_of_cells(
    grid: &CellGrid,
    young_pa: impl Fn(usize) -> f64,
    CellShares { edge, diagonal }: CellShares,
) -> Vec<Spring> {
    let mut shares = Shares {
        nodes: &grid.nodes,
        stiffness: BTreeMap::new(),
    };
    for (c, cell) in grid.cells.iter().enumerate() {
        let scale = young_pa(c) * grid.volume(cell);
        for [i, j] in EDGES {
            shares.add(cell[i], cell[j], edge * scale);
        }
        for face in FACES {
            if !collapsed(face.map(|i| cell[i])) {
                shares.add(cell[face[0]], cell[face[2]], diagonal * scale);
                shares.add(cell[face[1]], cell[face[3]], diagonal * scale);
            }
        }
    }
    shares.springs()
}

/// All springs of a sheet of quadrilaterals (corners in order around). `young_thickness`: E t, N/m.
pub fn from_quads(nodes: &[Point3], quads: &[[u32; 4]], young_thickness: f64) -> Vec<Spring> {
    let mut shares = Shares {
        nodes,
        stiffness: BTreeMap::new(),
    };
    for quad in quads {
        let scale = 0.375 * young_thickness * quad_area(nodes, quad);
        for k in 0..4 {
            shares.add(quad[k], quad[(k + 1) % 4], scale);
        }
        if !collapsed(*quad) {
            shares.add(quad[0], quad[2], 2.0 * scale);
            shares.add(quad[1], quad[3], 2.0 * scale);
        }
    }
    shares.springs()
}

/// Area of a quadrilateral by its diagonals, m².
pub fn quad_area(nodes: &[Point3], quad: &[u32; 4]) -> f64 {
    let [a, b, c, d] = quad.map(|k| nodes[k as usize]);
    0.5 * (c - a).cross(&(d - b)).norm()
}

/// A face with fewer than three distinct corners has no diagonal.
fn collapsed(mut corners: [u32; 4]) -> bool {
    corners.sort_unstable();
    let repeats = corners.windows(2).filter(|pair| pair[0] == pair[1]).count();
    repeats >= 2
}
