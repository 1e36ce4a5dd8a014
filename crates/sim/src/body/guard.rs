//! How much a step strains a body, and a share of it that it can follow.
//!
//! The law is asked at x + s (z − x), s = 1 + d / dt (of springs, no farther than they can follow), and a step's matrix
//! stands for where the body is: a motion that strains a cell there by more than [`MOST_STRAIN`] within one tick, of the
//! lengths that it has then, is beyond it. A motion within turns no cell inside out. The deformation of the tick about
//! its rigid motion, its pressures and its forces are then shortened by one share.

use super::elements::continuum::{inverses, squares_at_centre, stretched};
use super::matter::{Matter, lanes_of};
use super::node_map::NodeMap;
use super::rigid_motion::Inertia;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Point3, Rotation, Vector3, rotation_by};

/// Most that a cell strains in a step where the law is asked.
const MOST_STRAIN: f64 = 0.6;
/// Of a length at rest: what a cell counts as long at least, in the square with what it is.
const LEAST_LENGTH: f64 = 0.5;

/// Cells side by side.
#[derive(Debug)]
pub(super) struct Guard {
    cells: Vec<Cells>,
    /// (coordinates): a coordinate that moves by one metre strains nothing by more, 1/m.
    steepest: Vec<f64>,
}

#[derive(Debug)]
struct Cells {
    /// (corner, cell).
    nodes: [[u32; 4]; 8],
    /// (xx yy zz xy xz yz): J₀ᵀ J₀ at the centre times the square of [`LEAST_LENGTH`], m²; zero for missing cells.
    least: [Four; 6],
    /// The inverse: wherever the body is, no motion strains them by more than this says, 1/m².
    most: [Four; 6],
}

impl Guard {
    /// Of the cells of a solid; a sheet has none.
    pub fn new(matter: &Matter) -> Self {
        let places = lanes_of(&matter.map.nodes(&matter.rest));
        let mut guard = Self {
            cells: Vec::new(),
            steepest: vec![0.0; matter.rest.len()],
        };
        for four in matter.cells.chunks(4) {
            let mut nodes = four[0].map(|node| [node; 4]);
            for (k, cell) in four.iter().enumerate() {
                for (of_corner, &node) in nodes.iter_mut().zip(cell) {
                    of_corner[k] = node;
                }
            }
            let square = LEAST_LENGTH * LEAST_LENGTH;
            let least = squares_at_centre(&nodes, &places).map(|row| row.map(|of| square * of));
            let most = inverses(&least);
            for (k, cell) in four.iter().enumerate() {
                // The gradient's columns are no longer than the longest displacement.
                let steep = (3.0 * (most[0][k] + most[1][k] + most[2][k])).sqrt();
                for &node in cell {
                    guard.steepen(&matter.map, node as usize, steep);
                }
            }
            guard.cells.push(Cells { nodes, least, most });
        }
        guard
    }

    fn steepen(&mut self, map: &NodeMap, node: usize, steep: f64) {
        let own = ([node as u32], [1.0]);
        let (columns, weights) = match map {
            NodeMap::Same => (&own.0[..], &own.1[..]),
            NodeMap::Sparse(map) => map.row(node),
        };
        let all: f64 = weights.iter().map(|weight| weight.abs()).sum();
        for &column in columns {
            let of_column = &mut self.steepest[column as usize];
            *of_column = of_column.max(all * steep);
        }
    }

    /// Room for [`Guard::share`].
    pub fn strains(&self) -> Vec<Four> {
        vec![[0.0; 4]; self.cells.len()]
    }

    /// The share of a motion that strains nothing by too much: 1, or less. `moved` (coordinates) is the motion without
    /// its rigid part where the law is asked, m, and `from` where the body was; the others are buffers.
    pub fn share(
        &self,
        matter: &Matter,
        [from, moved]: [&[Lane]; 2],
        [nodes, more_nodes]: [&mut [Lane]; 2],
        strains: &mut [Four],
    ) -> f64 {
        // What is not a number is too much.
        let larger = |most: f64, square: f64| if square <= most { most } else { square };
        let squares = moved.iter().zip(&self.steepest).map(|(lane, steep)| {
            let [x, y, z, _] = lane;
            (x * x + y * y + z * z) * (steep * steep)
        });
        let allowed = MOST_STRAIN * MOST_STRAIN;
        if squares.fold(0.0, larger) <= allowed {
            return 1.0;
        }
        let moved = matter.nodes_of(moved, nodes);
        self.bound(moved, strains);
        if strains.as_flattened().iter().copied().fold(0.0, larger) <= allowed {
            return 1.0;
        }
        let from = matter.nodes_of(from, more_nodes);
        let mut most = 0.0;
        for (cells, bound) in self.cells.iter().zip(strains) {
            if bound.iter().copied().fold(0.0, larger) <= allowed {
                continue;
            }
            let mut sum = squares_at_centre(&cells.nodes, from);
            let least = cells.least.as_flattened().iter();
            (sum.as_flattened_mut().iter_mut().zip(least)).for_each(|(sum, least)| *sum += least);
            let mut of_cells = [0.0; 4];
            stretched::<Baseline>(&cells.nodes, &inverses(&sum), moved).store(&mut of_cells);
            most = of_cells.into_iter().fold(most, larger);
        }
        match most <= allowed {
            true => 1.0,
            false if most.is_finite() => MOST_STRAIN / most.sqrt(),
            false => 0.0,
        }
    }

    /// No less than the squares of the strains of displacements of the nodes.
    fn bound(&self, moved: &[Lane], strains: &mut [Four]) {
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { bound_wide(self, moved, strains) };
        }
        self.bound_in::<Baseline>(moved, strains);
    }

    #[inline(always)]
    fn bound_in<L: Lanes>(&self, moved: &[Lane], strains: &mut [Four]) {
        for (cells, strains) in self.cells.iter().zip(strains) {
            stretched::<L>(&cells.nodes, &cells.most, moved).store(strains);
        }
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn bound_wide(guard: &Guard, moved: &[Lane], strains: &mut [Four]) {
    guard.bound_in::<palpate_geometry::math::lanes::Wide>(moved, strains);
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
