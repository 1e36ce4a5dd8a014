//! What the tests of the continuum share.

mod accuracy;
mod beams;
mod energy;
mod flow;
mod frequency;
mod order;
mod stability;
mod statics;

use super::*;
use crate::body::layers::{RingEnds, Rings, rings};
use crate::body::{
    Deformable, DeformableScratch, DeformableState, Inside, Integrator, Material, Solid,
    StepMatrix, StepSettings,
};
pub(in crate::body) use palpate_geometry::math::Random;
use palpate_geometry::math::Vector3;

/// A box of equal cells; node (i, j, k) at `(i (ny + 1) + j) (nz + 1) + k`.
pub(in crate::body) fn cuboid(counts: [usize; 3], sides_m: [f64; 3]) -> CellGrid {
    let [nx, ny, nz] = counts;
    let node = |i: usize, j: usize, k: usize| ((i * (ny + 1) + j) * (nz + 1) + k) as u32;
    let mut grid = CellGrid {
        nodes: Vec::new(),
        cells: Vec::new(),
        node_of_control: Vec::new(),
    };
    for i in 0..=nx {
        for j in 0..=ny {
            for k in 0..=nz {
                let at =
                    |index: usize, count: usize, side: f64| side * (index as f64 / count as f64);
                grid.nodes.push(Point3::new(
                    at(i, nx, sides_m[0]),
                    at(j, ny, sides_m[1]),
                    at(k, nz, sides_m[2]),
                ));
                if i < nx && j < ny && k < nz {
                    grid.cells.push(std::array::from_fn(|c| {
                        node(i + (c >> 2), j + ((c >> 1) & 1), k + (c & 1))
                    }));
                }
            }
        }
    }
    grid
}

/// Moves every node inside the box by up to `amount_m` along each axis.
pub(in crate::body) fn distorted(mut grid: CellGrid, amount_m: f64, seed: u64) -> CellGrid {
    let mut random = Random(seed);
    let far = grid.nodes.iter().fold([0.0f64; 3], |far, p| {
        std::array::from_fn(|c| far[c].max(p[c]))
    });
    for p in &mut grid.nodes {
        let moved = random.vector() * amount_m;
        if (0..3).all(|c| p[c] > 1e-9 && p[c] < far[c] - 1e-9) {
            *p += moved;
        }
    }
    grid
}

/// A spindle of wedges, pyramids and hexahedra with two poles, 6 around.
pub(in crate::body) fn spindle() -> CellGrid {
    let (around, along) = (6, 7);
    let mut points = Vec::new();
    for i in 0..around {
        for j in 0..along {
            let angle = std::f64::consts::TAU * i as f64 / around as f64;
            let turn = std::f64::consts::PI * j as f64 / (along - 1) as f64;
            let radius = if j == 0 || j + 1 == along {
                0.0
            } else {
                0.03 * turn.sin()
            };
            points.push(Point3::new(
                radius * angle.cos(),
                radius * angle.sin(),
                -0.04 * turn.cos(),
            ));
        }
    }
    let ends = RingEnds {
        axis_closed: false,
        first_pole: true,
        last_pole: true,
    };
    let shape = Rings::seamless(around, along, ends);
    rings(&points, &shape, 2)
}

pub(in crate::body) fn lanes(points: &[Point3]) -> Vec<Lane> {
    points.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect()
}

pub(in crate::body) fn uniform(grid: &CellGrid, young_pa: f64, poisson: f64) -> ContinuumLaw {
    ContinuumLaw::new(grid, &vec![Elastic { young_pa, poisson }; grid.cells.len()]).unwrap()
}

/// Forces are the falling slope of the energy: central differences of a tenth of a micrometre, whose
/// error is far below 1e-5 of the largest force.
pub(in crate::body) fn assert_forces_are_slopes(solid: &ContinuumLaw, places: &[Lane]) {
    const STEP_M: f64 = 1e-7;
    let forces = solid.forces(places);
    let largest = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for (node, force) in forces.iter().enumerate() {
        for c in 0..3 {
            let at = |step: f64| {
                let mut moved = places.to_vec();
                moved[node][c] += step;
                solid.energy_j(&moved)
            };
            let slope = (at(STEP_M) - at(-STEP_M)) / (2.0 * STEP_M);
            let off = (force[c] + slope).abs();
            assert!(off < 1e-5 * largest, "{} is not {}", force[c], -slope);
        }
    }
}

/// Grids with each kind of cell, with a length of their cells, m.
fn samples() -> Vec<(&'static str, CellGrid, f64)> {
    let mut mirrored = distorted(cuboid([3, 2, 2], [0.03, 0.02, 0.02]), 0.002, 5);
    for p in &mut mirrored.nodes {
        p.x = -p.x;
    }
    vec![
        ("cubes", cuboid([3, 2, 2], [0.03, 0.02, 0.02]), 0.01),
        (
            "distorted",
            distorted(cuboid([3, 3, 3], [0.03, 0.03, 0.03]), 0.002, 1),
            0.01,
        ),
        ("mirrored", mirrored, 0.01),
        ("spindle", spindle(), 0.01),
    ]
}

/// A body and its step, one iteration of 1 ms.
struct World {
    body: Deformable,
    state: DeformableState,
    scratch: DeformableScratch,
}

impl World {
    /// Without damping.
    fn new(grid: &CellGrid, elastic: &[Elastic], fixed: impl Fn(&Point3) -> bool) -> Self {
        Self::damped(grid, elastic, fixed, 0.0)
    }

    fn damped(
        grid: &CellGrid,
        elastic: &[Elastic],
        fixed: impl Fn(&Point3) -> bool,
        damping_s: f64,
    ) -> Self {
        let material = |cell: usize| Material {
            young_pa: elastic[cell].young_pa,
            poisson: elastic[cell].poisson,
            density_kg_m3: 1000.0,
            damping_s,
            plastic: None,
            stiffening: None,
        };
        let fixed: Vec<bool> = grid.nodes.iter().map(fixed).collect();
        let volume = grid.cells.iter().map(|cell| grid.volume(cell)).sum();
        let solid = Solid::whole(grid, &fixed, volume, Inside::Continuum, material);
        let settings = StepSettings {
            dt_s: 1e-3,
            integrator: Integrator::Implicit {
                iterations: 1,
                matrix: StepMatrix::Auto,
            },
            sleep_m_s: 0.0,
        };
        let body = solid.build(&material(0), settings).unwrap();
        Self {
            state: body.rest_state(),
            scratch: body.scratch(),
            body,
        }
    }

    /// One tick.
    fn step(&mut self) {
        self.body.predict(&self.state, &mut self.scratch);
        self.body.advance(&mut self.state, &mut self.scratch);
        self.body
            .take_over(&mut self.state, &mut self.scratch, None);
    }

    fn energy_j(&self) -> f64 {
        self.body.energy_j(&self.state)
    }

    /// Fastest node, m/s.
    fn speed_m_s(&self) -> f64 {
        let speeds = self.state.velocities.iter().map(|v| v.norm());
        speeds.fold(0.0, f64::max)
    }

    /// Farthest node from rest, m.
    fn farthest_m(&self) -> f64 {
        let places = self.state.positions.iter().zip(self.body.rest());
        places
            .map(|(p, rest)| (p - rest).norm())
            .fold(0.0, f64::max)
    }
}
