//! What the tests of the continuum share.

mod accuracy;
mod beams;
mod energy;
mod flow;
mod frequency;
mod stability;
mod statics;

use super::*;
use crate::body::elements::Weight;
use crate::body::layers::{RingEnds, Rings, rings};
pub(in crate::body) use palpate_geometry::math::Random;
use palpate_geometry::math::{Cholesky, SymmetricTriplets, Vector3};

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

fn forces(solid: &ContinuumLaw, places: &[Lane]) -> (Vec<Vector3>, Pass) {
    let mut residual = vec![[0.0; 4]; places.len()];
    let pass = solid.add_forces(places, &mut residual);
    (
        residual
            .iter()
            .map(|r| Vector3::new(r[0], r[1], r[2]))
            .collect(),
        pass,
    )
}

/// Forces are the falling slope of the energy: central differences of a tenth of a micrometre, whose
/// error is far below 1e-5 of the largest force.
pub(in crate::body) fn assert_forces_are_slopes(solid: &ContinuumLaw, places: &[Lane]) {
    const STEP_M: f64 = 1e-7;
    let forces = solid.exact_forces(places);
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

/// The implicit step as a body does it that takes the bounding matrix A, one iteration: from the
/// inertial prediction y = x + dt v to x' = y + A⁻¹ (f(y) + F). A free mode of θ = K / A swings, with
/// amplitudes that fall by √(1 − θ) a tick.
struct ReferenceWorld {
    solid: ContinuumLaw,
    masses: Vec<f64>,
    dt_s: f64,
    unknown: Vec<Option<usize>>,
    factor: Cholesky,
    places: Vec<Lane>,
    velocities: Vec<Vector3>,
    limited: u64,
    held: bool,
}

impl ReferenceWorld {
    fn new(
        grid: &CellGrid,
        elastic: &[Elastic],
        density_kg_m3: f64,
        dt_s: f64,
        fixed: impl Fn(&Point3) -> bool,
    ) -> Self {
        let solid = ContinuumLaw::new(grid, elastic).unwrap();
        let mut masses = vec![0.0; grid.nodes.len()];
        for cell in &grid.cells {
            for &node in cell {
                masses[node as usize] += density_kg_m3 * grid.volume(cell) / 8.0;
            }
        }
        let mut count = 0;
        let unknown: Vec<Option<usize>> = grid
            .nodes
            .iter()
            .map(|p| {
                let row = (!fixed(p)).then_some(count);
                count += usize::from(row.is_some());
                row
            })
            .collect();
        let mut matrix = SymmetricTriplets::new(count);
        for (node, row) in unknown.iter().enumerate() {
            if let &Some(row) = row {
                matrix.add(row, row, masses[node] / (dt_s * dt_s));
            }
        }
        for (a, b, k) in solid.laplacian(Weight::Bounding) {
            let (a, b) = (unknown[a as usize], unknown[b as usize]);
            a.into_iter()
                .chain(b)
                .for_each(|row| matrix.add(row, row, k));
            if let (Some(a), Some(b)) = (a, b) {
                matrix.add(a, b, -k);
            }
        }
        let factor = Cholesky::new(&matrix).unwrap();
        let velocities = vec![Vector3::zeros(); grid.nodes.len()];
        Self {
            solid,
            masses,
            dt_s,
            unknown,
            factor,
            places: lanes(&grid.nodes),
            velocities,
            limited: 0,
            held: false,
        }
    }

    /// One tick under a load (N a node).
    fn step(&mut self, load: impl Fn(usize) -> Vector3) {
        let n = self.factor.n();
        let before = self.places.clone();
        let held = self.held;
        for (place, v) in self.places.iter_mut().zip(&self.velocities) {
            for c in 0..3 {
                place[c] += if held { 0.0 } else { self.dt_s * v[c] };
            }
        }
        let mut residual = vec![[0.0; 4]; self.places.len()];
        let limited = self.solid.add_forces(&self.places, &mut residual).limited;
        self.limited += u64::from(limited);
        self.held = limited > 0;
        let mut rhs = vec![Vector3::zeros(); n];
        for (node, row) in self.unknown.iter().enumerate() {
            if let &Some(row) = row {
                let [x, y, z, _] = residual[node];
                rhs[row] = Vector3::new(x, y, z)
                    + load(node)
                    + self.velocities[node]
                        * if held {
                            self.masses[node] / self.dt_s
                        } else {
                            0.0
                        };
            }
        }
        self.factor.solve(&mut rhs, &mut vec![[0.0; 4]; n]);
        for (node, row) in self.unknown.iter().enumerate() {
            if let &Some(row) = row {
                for c in 0..3 {
                    self.places[node][c] += rhs[row][c];
                    self.velocities[node][c] = (self.places[node][c] - before[node][c]) / self.dt_s;
                }
            }
        }
    }

    fn energy_j(&self) -> f64 {
        let kinetic = self
            .masses
            .iter()
            .zip(&self.velocities)
            .map(|(m, v)| 0.5 * m * v.norm_squared())
            .sum::<f64>();
        kinetic + self.solid.energy_j(&self.places)
    }

    /// Farthest node from rest, m.
    fn farthest_m(&self) -> f64 {
        let far = |(p, rest): (&Lane, &Point3)| (Point3::new(p[0], p[1], p[2]) - rest).norm();
        self.places
            .iter()
            .zip(self.solid.rest())
            .map(far)
            .fold(0.0, f64::max)
    }
}
