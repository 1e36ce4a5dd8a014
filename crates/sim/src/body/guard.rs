//! How much a step strains a body, and a share of it that it can follow.
//!
//! The law is asked at x + s (z − x), s = 1 + d / dt (of springs, no farther than they can follow), and a step's matrix stands for where the body is: a motion that
//! strains a cell there by more than [`MOST_STRAIN`] within one tick is beyond it. The deformation of the tick about its
//! rigid motion, its pressures and its forces are then shortened by one share.

use super::elements::continuum::stretched;
use super::matter::{Matter, lanes_of};
use super::rigid_motion::Inertia;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3, Rotation, Vector3, rotation_by};

/// Most that a cell strains in a step where the law is asked.
const MOST_STRAIN: f64 = 0.35;

/// Cells side by side.
#[derive(Debug)]
pub(super) struct Guard {
    cells: Vec<Cells>,
    /// No node that moves by one metre strains anything by more, 1/m.
    steepest: f64,
}

#[derive(Debug)]
struct Cells {
    /// (corner, cell).
    nodes: [[u32; 4]; 8],
    /// (xx yy zz xy xz yz): J₀⁻¹ J₀⁻ᵀ at the centre, 1/m²; zero for missing cells.
    metric: [Four; 6],
}

impl Guard {
    /// Of the cells of a solid; a sheet has none.
    pub fn new(matter: &Matter) -> Self {
        let nodes = lanes_of(&matter.map.nodes(&matter.rest));
        let at = |node: u32| {
            let [x, y, z, _] = nodes[node as usize];
            Vector3::new(x, y, z)
        };
        let mut guard = Self {
            cells: Vec::new(),
            steepest: 0.0,
        };
        for four in matter.cells.chunks(4) {
            let mut cells = Cells {
                nodes: four[0].map(|node| [node; 4]),
                metric: [[0.0; 4]; 6],
            };
            for (k, cell) in four.iter().enumerate() {
                let mut map = Matrix3::zeros();
                for (corner, &node) in cell.iter().enumerate() {
                    cells.nodes[corner][k] = node;
                    let half = |bit: usize| if corner & bit != 0 { 0.125 } else { -0.125 };
                    map += at(node) * Vector3::new(half(4), half(2), half(1)).transpose();
                }
                // A cell without volume at its centre says nothing.
                let Some(inverse) = map.try_inverse() else {
                    continue;
                };
                let s = inverse * inverse.transpose();
                let rows = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| s[place]);
                for (row, value) in cells.metric.iter_mut().zip(rows) {
                    row[k] = value;
                }
                // The gradient's columns are no longer than the longest displacement.
                guard.steepest = guard.steepest.max((3.0 * s.trace()).sqrt());
            }
            guard.cells.push(cells);
        }
        guard
    }

    /// The share of a motion that strains nothing by too much: 1, or less. `moved` (coordinates) is the motion without
    /// its rigid part where the law is asked, m; `nodes` is a buffer.
    pub fn share(&self, matter: &Matter, moved: &[Lane], nodes: &mut [Lane]) -> f64 {
        let mut most = 0.0;
        for lane in moved {
            let square: f64 = lane[..3].iter().map(|x| x * x).sum();
            // What is not a number is too much.
            most = if square <= most { most } else { square };
        }
        if most.sqrt() * self.steepest <= MOST_STRAIN {
            return 1.0;
        }
        let of_nodes = matter.nodes_of(moved, nodes);
        let strain = self.strain(of_nodes);
        match strain <= MOST_STRAIN {
            true => 1.0,
            false if strain.is_finite() => MOST_STRAIN / strain,
            false => 0.0,
        }
    }

    /// The largest strain of displacements of the nodes.
    fn strain(&self, moved: &[Lane]) -> f64 {
        let mut most = 0.0_f64;
        let mut see = |square: f64| most = if square <= most { most } else { square };
        for cells in &self.cells {
            let mut squares = [0.0; 4];
            stretched::<Baseline>(&cells.nodes, &cells.metric, moved).store(&mut squares);
            squares.into_iter().for_each(&mut see);
        }
        most.sqrt()
    }
}

/// The rigid part of a body's motion in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidStep {
    centre: Point3,
    shift: Vector3,
    turn: Rotation,
}

impl RigidStep {
    /// The one with the momentum of the motion of a free body; none where that is not a number.
    pub fn of(matter: &Matter, inertia: &Inertia, from: &[Point3], to: &[Point3]) -> Option<Self> {
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        for ((x, z), m) in from.iter().zip(to).zip(&matter.masses) {
            let d = (z - x) * *m;
            linear += d;
            angular += (x - inertia.centre).cross(&d);
        }
        let angle = inertia.inverse * angular;
        let shift = linear / inertia.mass_kg;
        if !(shift.iter().chain(&angle)).all(|x| x.is_finite()) {
            return None;
        }
        Some(Self {
            centre: inertia.centre,
            shift,
            turn: rotation_by(&angle),
        })
    }

    /// Where it takes a point.
    pub fn at(&self, x: &Point3) -> Point3 {
        self.centre + self.shift + self.turn * (x - self.centre)
    }
}
