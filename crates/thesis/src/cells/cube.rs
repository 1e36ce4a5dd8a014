//! Cube lattices: `a × b × c` nodes in rows, their outermost ones riding on a surface.
//!
//! ```text
//! transfinite: cubed sphere ─▶ (u, v) of each exterior node ─▶ harmonic interior ─▶ untangle
//! som:         cube ─▶ learning cycles ─▶ exterior nodes to the surface ─▶ harmonic interior ─▶ untangle
//! ```
//! A cube mapped on a smooth body is flat along its twelve edges: the two faces of a cell that meet
//! there both lie on the surface, so the corner between them tends to 180°, and its scaled Jacobian
//! to 0, as the lattice gets finer. The cells' volumes stay positive. Springs live with this; a
//! model that needs good corners takes [`layers`](palpate_sim::body::layers).

use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;
use palpate_sim::body::{CellGrid, CellQuality, MOST_NODES_A_SIDE, NodeMap, weights_at};

/// A lattice of `a × b × c` nodes, node (i, j, k) at `(i b + j) c + k`.
#[derive(Clone, Debug)]
pub struct CubeLattice {
    /// Nodes along each axis, each at least 2.
    pub counts: [usize; 3],
    /// Nodes and right-handed cells; no node is a control point.
    pub grid: CellGrid,
    /// Nodes that ride on the surface, in rising order, with their parameters: x = S(u, v) at rest.
    pub exterior: Vec<(u32, [f64; 2])>,
    /// All others, in rising order.
    pub interior: Vec<u32>,
}

/// Why a cube lattice could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CubeError {
    /// Too few or too many nodes.
    #[error("{counts:?} nodes; each axis takes 2 to {MOST_NODES_A_SIDE}")]
    Counts {
        /// What was asked for.
        counts: [usize; 3],
    },
    /// A coordinate that is not finite.
    #[error("control point {control} is not finite")]
    NotFinite {
        /// Index into the net.
        control: usize,
    },
    /// A surface on which a cube does not fit.
    #[error("a cube lattice needs {needed}; take layers for others")]
    Topology {
        /// What would fit.
        needed: &'static str,
    },
    /// A closed surface with nothing inside.
    #[error("the surface of size {size_m} m encloses {volume_m3} m³: there is no room for cells")]
    Flat {
        /// Enclosed volume, m³.
        volume_m3: f64,
        /// Diagonal of the net's box, m.
        size_m: f64,
    },
    /// A length that must be positive.
    #[error("{what} is {value_m} m; it must be finite and above 0")]
    Length {
        /// Name of the quantity.
        what: &'static str,
        /// Its value, m.
        value_m: f64,
    },
    /// Cells stayed inside out.
    #[error(
        "{folded} of {cells} cells are turned inside out; the surface may cross itself or bend sharply: try another number of nodes, or layers"
    )]
    Folded {
        /// How many.
        folded: usize,
        /// Of how many.
        cells: usize,
    },
}

impl CubeLattice {
    /// Its nodes as sums of coordinates: the control points of the surface on which it rides (as
    /// `coordinate_of_control` numbers them), then its interior nodes. Rows of the map, and the
    /// coordinates at rest.
    pub fn riding(
        &self,
        surface: &Surface,
        coordinate_of_control: &[u32],
    ) -> (NodeMap, Vec<Point3>) {
        let controls = coordinate_of_control
            .iter()
            .max()
            .map_or(0, |&last| last as usize + 1);
        let mut coordinates = vec![Point3::origin(); controls];
        for (point, &coordinate) in surface.net().points().iter().zip(coordinate_of_control) {
            coordinates[coordinate as usize] = *point;
        }
        coordinates.extend(
            self.interior
                .iter()
                .map(|&node| self.grid.nodes[node as usize]),
        );
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.grid.nodes.len()];
        for &(node, uv) in &self.exterior {
            let weights = weights_at(surface, uv);
            rows[node as usize] = weights
                .into_iter()
                .map(|(k, weight)| (coordinate_of_control[k], weight))
                .collect();
        }
        for (k, &node) in self.interior.iter().enumerate() {
            rows[node as usize] = vec![((controls + k) as u32, 1.0)];
        }
        (NodeMap::from_rows(rows), coordinates)
    }

    /// Figures of its cells.
    pub fn quality(&self) -> CellQuality {
        self.grid.quality()
    }

    /// A box between two corners, evenly divided; no node rides on a surface.
    ///
    /// # Errors
    /// Counts, or sides that are not positive.
    pub fn cuboid(low: &Point3, high: &Point3, counts: [usize; 3]) -> Result<Self, CubeError> {
        let sides = high - low;
        if let Some(&value_m) = sides
            .iter()
            .find(|side| !(side.is_finite() && **side > 0.0))
        {
            return Err(CubeError::Length {
                what: "a side of the box",
                value_m,
            });
        }
        let share = |t: usize, n: usize| t as f64 / (n - 1) as f64;
        Self::new(counts, |[i, j, k]| {
            let [a, b, c] = [
                share(i, counts[0]),
                share(j, counts[1]),
                share(k, counts[2]),
            ];
            (
                Point3::new(
                    low.x + sides.x * a,
                    low.y + sides.y * b,
                    low.z + sides.z * c,
                ),
                None,
            )
        })
    }

    /// Places every node; those with parameters ride on the surface.
    pub(super) fn new(
        counts: [usize; 3],
        mut place: impl FnMut([usize; 3]) -> (Point3, Option<[f64; 2]>),
    ) -> Result<Self, CubeError> {
        if !counts.iter().all(|n| (2..=MOST_NODES_A_SIDE).contains(n)) {
            return Err(CubeError::Counts { counts });
        }
        let total: usize = counts.iter().product();
        let (mut nodes, mut exterior, mut interior) =
            (Vec::with_capacity(total), Vec::new(), Vec::new());
        for node in 0..total {
            let (point, parameters) = place(place_of(counts, node));
            nodes.push(point);
            match parameters {
                Some(uv) => exterior.push((node as u32, uv)),
                None => interior.push(node as u32),
            }
        }
        let grid = CellGrid::in_rows(counts, nodes);
        Ok(Self {
            counts,
            grid,
            exterior,
            interior,
        })
    }

    /// Refuses cells that are not positive at every Gauss point.
    pub(super) fn unfolded(self) -> Result<Self, CubeError> {
        match self.grid.quality().folded_cells {
            0 => Ok(self),
            folded => Err(CubeError::Folded {
                folded,
                cells: self.grid.cells.len(),
            }),
        }
    }
}

/// (i, j, k) of a node.
pub(super) fn place_of(counts: [usize; 3], node: usize) -> [usize; 3] {
    [
        node / (counts[1] * counts[2]),
        node / counts[2] % counts[1],
        node % counts[2],
    ]
}

/// Node (i, j, k).
pub(super) fn node_at(counts: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    (i * counts[1] + j) * counts[2] + k
}

/// True for the nodes of the six faces.
pub(super) fn is_outermost(counts: [usize; 3], place: [usize; 3]) -> bool {
    (0..3).any(|axis| place[axis] == 0 || place[axis] + 1 == counts[axis])
}

/// The door of the builders that fill a closed surface: finite, sphere-like, with room inside.
/// Returns the enclosed volume, m³, positive where S_u × S_v points outwards.
pub(super) fn check_closed(surface: &Surface) -> Result<f64, CubeError> {
    check_finite(surface)?;
    let topology = surface.topology();
    let round = |direction: usize| topology.wraps(direction);
    if !topology.is_closed() || (round(0) && round(1)) {
        return Err(CubeError::Topology {
            needed: "a closed surface with two poles",
        });
    }
    let volume = surface.volume();
    let size_m = surface.size();
    // A disc of that diameter has this volume when it is a millionth as thick as wide.
    if volume.is_nan() || volume.abs() <= 1e-6 * size_m * size_m * size_m {
        return Err(CubeError::Flat {
            volume_m3: volume,
            size_m,
        });
    }
    Ok(if surface.flip_normal() {
        -volume
    } else {
        volume
    })
}

/// Refuses nets with coordinates that are not finite: a net can be moved after it was checked.
pub(super) fn check_finite(surface: &Surface) -> Result<(), CubeError> {
    match surface
        .net()
        .points()
        .iter()
        .position(|point| !point.iter().all(|x| x.is_finite()))
    {
        Some(control) => Err(CubeError::NotFinite { control }),
        None => Ok(()),
    }
}
