//! How much a step strains a body, and a share of it that it can follow.
//!
//! The law is asked at x + s (z − x), s = 1 + d / dt (of springs, no farther than they can follow), and a step's matrix
//! stands for where the body is: a motion that strains a cell by too much within one tick is beyond it. The deformation
//! of the tick about its rigid motion and its pressures are then shortened by one share: that of the body by itself
//! before contact is solved, and once it is, with its forces.

use super::cells::Cell;
use super::elements::continuum::{inverses, squares_at_centre, stretched};
use super::matter::{Matter, lanes_of};
use super::rigid_motion::Inertia;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Point3, Rotation, Vector3, rotation_by};

/// How much a motion may strain a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    /// The motion is looked at times this.
    pub times: f64,
    /// Largest strain.
    pub most: f64,
}

impl Limit {
    /// Those of a body of springs, which see to how far ahead they are asked themselves.
    pub const OF_SPRINGS: [Self; 2] = [Self {
        times: 1.0,
        most: 0.35,
    }; 2];

    /// A continuum by itself, where the law is asked, `ahead` times as far; and once contact has moved it, where it comes
    /// to, since one that is damped much could not get out of the way where the law is asked. `poisson`: the largest ν of
    /// its cells.
    pub fn of_continuum(ahead: f64, poisson: f64) -> [Self; 2] {
        let [by_itself, with_contact] = match poisson > NEARLY_INCOMPRESSIBLE {
            true => FIRM,
            false => SOFT,
        };
        [
            Self {
                times: ahead,
                most: by_itself,
            },
            Self {
                times: 1.0,
                most: with_contact,
            },
        ]
    }
}

/// Above it λ is more than 49 μ: what a step misses of a cell's volume, by the square of its strain, presses with that.
const NEARLY_INCOMPRESSIBLE: f64 = 0.49;
/// Of bodies up to there, by themselves and with contact: with 0.25 and 0.15 a ball that is dropped comes back 12 % lower
/// than by the exact step (`palpate-bench deformation --only motion/bounce`), with these 4 % lower.
const SOFT: [f64; 2] = [0.35, 0.2];
/// Of those beyond: with 0.35 and 0.2, and with 0.25 and 0.2, cells of a body of ν = 0.499 that was poked at random stayed
/// inside out.
const FIRM: [f64; 2] = [0.25, 0.15];

/// Cells of a solid, four side by side, the smallest first.
#[derive(Debug)]
pub(super) struct Guard {
    cells: Vec<Cells>,
    /// Nodes of the cells, as they first appear.
    nodes: Vec<u32>,
    /// No node moves farther than the farthest coordinate times this.
    reach: f64,
}

#[derive(Debug)]
struct Cells {
    /// (corner, cell).
    nodes: [[u32; 4]; 8],
    /// (xx yy zz xy xz yz): (J₀ᵀ J₀)⁻¹ at the centre, 1/m²; zero for missing cells.
    metric: [Four; 6],
    /// Nodes that move by one metre strain neither these cells nor those that follow by more, 1/m.
    steepest: f64,
    /// How many of the guard's nodes these cells and those before have.
    node_count: usize,
}

impl Guard {
    /// Of the cells of a solid; a sheet has none.
    pub fn new(matter: &Matter) -> Self {
        let places = lanes_of(&matter.map.nodes(&matter.rest));
        let steepness = |cell: &Cell| {
            let nodes = cell.map(|node| [node; 4]);
            let metric = inverses(&squares_at_centre(&nodes, &places));
            // The gradient's columns are no longer than the longest displacement.
            (3.0 * (metric[0][0] + metric[1][0] + metric[2][0])).sqrt()
        };
        let mut sorted: Vec<(f64, &Cell)> = (matter.cells.iter())
            .map(|cell| (steepness(cell), cell))
            .collect();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut guard = Self {
            cells: Vec::new(),
            nodes: Vec::new(),
            reach: matter.map.reach(),
        };
        let mut seen = vec![false; places.len()];
        for four in sorted.chunks(4) {
            let mut nodes = four[0].1.map(|node| [node; 4]);
            for (k, (_, cell)) in four.iter().enumerate() {
                for (of_corner, &node) in nodes.iter_mut().zip(cell.iter()) {
                    of_corner[k] = node;
                    if !std::mem::replace(&mut seen[node as usize], true) {
                        guard.nodes.push(node);
                    }
                }
            }
            let mut metric = inverses(&squares_at_centre(&nodes, &places));
            for row in &mut metric {
                row[four.len()..].fill(0.0);
            }
            guard.cells.push(Cells {
                nodes,
                metric,
                steepest: four[0].0,
                node_count: guard.nodes.len(),
            });
        }
        guard
    }

    /// The share of a motion that strains nothing by too much: 1, or less. `moved` (coordinates) is the motion without
    /// its rigid part, m; `nodes` is a buffer.
    pub fn share(&self, matter: &Matter, moved: &[Lane], nodes: &mut [Lane], limit: Limit) -> f64 {
        let squares = (moved.iter()).map(|[x, y, z, _]| x * x + y * y + z * z);
        let farthest = squares.fold(0.0, larger).sqrt() * self.reach * limit.times;
        let strained = |cells: &Cells| {
            let within = cells.steepest * farthest <= limit.most;
            !within
        };
        let strained = &self.cells[..self.cells.partition_point(strained)];
        let Some(last) = strained.last() else {
            return 1.0;
        };
        let moved = matter.some_nodes_of(&self.nodes[..last.node_count], moved, nodes);
        let strain = strain_squared(strained, moved).sqrt() * limit.times;
        match strain <= limit.most {
            true => 1.0,
            false if strain.is_finite() => limit.most / strain,
            false => 0.0,
        }
    }
}

/// The square of the largest strain of displacements of the nodes, or a little more.
fn strain_squared(cells: &[Cells], moved: &[Lane]) -> f64 {
    #[cfg(target_arch = "x86_64")]
    if palpate_geometry::math::simd::has_avx2() {
        // SAFETY: the processor has AVX2, asked just above.
        #[allow(unsafe_code)]
        return unsafe { strain_squared_wide(cells, moved) };
    }
    strain_squared_in::<Baseline>(cells, moved)
}

#[inline(always)]
fn strain_squared_in<L: Lanes>(cells: &[Cells], moved: &[Lane]) -> f64 {
    let mut most = 0.0;
    for cells in cells {
        let mut squares = [0.0; 4];
        stretched::<L>(&cells.nodes, &cells.metric, moved).store(&mut squares);
        most = squares.into_iter().fold(most, larger);
    }
    most
}

/// The larger of two; what is not a number is larger than any.
fn larger(most: f64, square: f64) -> f64 {
    if square <= most { most } else { square }
}

/// [`strain_squared_in`] compiled for 256-bit registers, without fused multiply-add: its bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn strain_squared_wide(cells: &[Cells], moved: &[Lane]) -> f64 {
    strain_squared_in::<palpate_geometry::math::lanes::Wide>(cells, moved)
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
