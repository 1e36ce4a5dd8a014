//! A barrier against crushed cells, for lattices: springs have equilibria in which they are turned
//! over, and a cell that has lost half of its volume would fall into one.
//!
//! Ψ = V₀ k / 2 (J₁ − J)² while the volume V = J V₀ of a cell is below J₁ V₀, else nothing: lattices
//! that are not crushed have the forces of their springs alone, to the bit.

use super::ContinuumLaw;
use super::elastic::Elastic;
use super::kernel::{self, times};
use super::rest::RestCell;
use crate::body::cells::Cell;
use crate::body::elements::law::{Edge, ForceLaw, Place};
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3};

/// J₁, and k over Young's modulus. Chosen between 0.75 and 1, with which a slab of 30 mm that a ball of
/// 20 mm presses 6 mm deep gives way under it (0.1 N of 4 N), and 0.95, which stiffens small strains.
const THRESHOLD: f64 = 0.9;
const STIFFNESS: f64 = 1.2;
/// Share of the modulus in the support that the tangent of the step gets.
const SUPPORT: f64 = 0.5;

/// Four cells side by side; missing ones have no stiffness.
#[derive(Clone, Debug)]
struct Block {
    nodes: [[u32; 4]; 8],
    /// 1 / V₀, with the sign of the winding, 1/m³.
    per_volume: Four,
    /// k times the winding, Pa.
    stiffness_pa: Four,
}

/// The barriers of a grid of cells.
#[derive(Clone, Debug)]
pub struct VolumeBarrier {
    blocks: Vec<Block>,
    /// What the tangent of the step gets.
    support: ContinuumLaw,
}

impl VolumeBarrier {
    /// Of cells with these moduli E, Pa.
    pub fn new(nodes: &[Point3], cells: &[Cell], young_pa: impl Fn(usize) -> f64) -> Self {
        let mut blocks = Vec::with_capacity(cells.len().div_ceil(4));
        for (b, four) in cells.chunks(4).enumerate() {
            let mut block = Block {
                nodes: four[0].map(|node| [node; 4]),
                per_volume: [1.0; 4],
                stiffness_pa: [0.0; 4],
            };
            for (k, cell) in four.iter().enumerate() {
                let volume = RestCell::new(nodes, cell).volume;
                if volume == 0.0 {
                    continue;
                }
                for corner in 0..8 {
                    block.nodes[corner][k] = cell[corner];
                }
                block.per_volume[k] = 1.0 / volume;
                block.stiffness_pa[k] = STIFFNESS * young_pa(4 * b + k) * volume.signum();
            }
            blocks.push(block);
        }
        let support = |cell| Elastic {
            young_pa: SUPPORT * young_pa(cell),
            poisson: 0.25,
        };
        let support: Vec<Elastic> = (0..cells.len()).map(support).collect();
        Self {
            blocks,
            support: ContinuumLaw::unchecked(nodes, cells, &support),
        }
    }

    /// Adds −∂Ψ/∂x (N) at `places`.
    pub fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        debug_assert_eq!(places.len(), residual.len(), "one place and force a node");
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_forces_wide(&self.blocks, places, residual) };
        }
        add_forces::<Baseline>(&self.blocks, places, residual);
    }

    /// Ψ, J.
    pub fn energy_j(&self, places: &[Lane]) -> f64 {
        let mut energy = 0.0;
        for block in &self.blocks {
            let c = kernel::modes::<Baseline>(&block.nodes, places);
            let mut volume = [0.0; 4];
            kernel::volume(&c).1.store(&mut volume);
            for k in 0..4 {
                let lost = (THRESHOLD - volume[k] * block.per_volume[k]).max(0.0);
                energy += 0.5 * block.stiffness_pa[k] / block.per_volume[k] * lost * lost;
            }
        }
        energy
    }
}

impl ForceLaw for VolumeBarrier {
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        self.add_forces(places, residual);
    }

    fn energy_j(&self, places: &[Lane]) -> f64 {
        self.energy_j(places)
    }

    fn parts(&self) -> Vec<Vec<u32>> {
        let nodes = |block: &Block| block.nodes.as_flattened().to_vec();
        self.blocks.iter().map(nodes).collect()
    }

    fn part_count(&self) -> usize {
        self.blocks.len()
    }

    fn add_forces_of_parts(
        &self,
        (parts, first): (&[u32], u32),
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        for part in parts {
            let block = &self.blocks[(part - first) as usize];
            add_forces::<Baseline>(std::slice::from_ref(block), places, residual);
        }
    }

    fn edges(&self) -> Vec<Edge> {
        Vec::new()
    }

    /// Of a solid of part of the modulus: what springs of long thin cells lack, which give way sideways at rest and
    /// are held by their tension once they are drawn, and what the barrier adds.
    fn tangent_at(&self, at: &Place<'_>, out: &mut dyn FnMut(u32, u32, Matrix3)) {
        let own = Place {
            metrics: &[],
            pressures: &[],
            ..*at
        };
        self.support.tangent_at(&own, out);
    }

    fn is_safeguard(&self) -> bool {
        true
    }
}

#[inline(always)]
fn add_forces<L: Lanes>(blocks: &[Block], places: &[Lane], residual: &mut [Lane]) {
    for block in blocks {
        let c = kernel::modes::<L>(&block.nodes, places);
        let (growth, volume) = kernel::volume(&c);
        let threshold = L::splat(THRESHOLD);
        let share = volume * L::load(&block.per_volume);
        if threshold.above(share) == 0 {
            continue;
        }
        // Far out the bound only turns what has overflowed into numbers.
        let lost = (threshold - share)
            .greatest(L::splat(0.0))
            .least(L::splat(1e90));
        let pressure = L::load(&block.stiffness_pa) * lost;
        // A closure of `map` would not be compiled for wide registers.
        let mut force = growth;
        for force in &mut force {
            *force = times(*force, pressure);
        }
        kernel::scatter(&block.nodes, force, residual);
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_wide(blocks: &[Block], places: &[Lane], residual: &mut [Lane]) {
    add_forces::<palpate_geometry::math::lanes::Wide>(blocks, places, residual);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::CellGrid;
    use palpate_geometry::math::Random;

    fn moved(nodes: &[Point3], squeeze: f64, by: f64) -> Vec<Lane> {
        let mut random = Random(19);
        let lane = |p: &Point3| {
            let d = random.vector() * by;
            [p.x + d.x, p.y + d.y, squeeze * p.z + d.z, 0.0]
        };
        nodes.iter().map(lane).collect()
    }

    #[test]
    fn forces_are_the_falling_slope_of_the_energy_and_begin_at_nine_tenths_of_the_volume() {
        let high = Point3::new(0.1, 0.12, 0.09);
        let cube = CellGrid::cuboid(&Point3::origin(), &high, [3, 4, 3]);
        let (nodes, cells) = (&cube.nodes, &cube.cells);
        let barrier = VolumeBarrier::new(nodes, cells, |cell| 1e4 + cell as f64);
        let at_rest = moved(nodes, 0.91, 0.0);
        let mut forces = vec![[0.0; 4]; nodes.len()];
        barrier.add_forces(&at_rest, &mut forces);
        assert!(forces.iter().all(|f| *f == [0.0; 4]));
        for squeeze in [0.4, 0.0, -0.5] {
            let places = moved(nodes, squeeze, 2e-3);
            let mut forces = vec![[0.0; 4]; nodes.len()];
            // Squeezed cells are within reach.
            barrier.add_forces(&places, &mut forces);
            assert!(forces.iter().any(|f| *f != [0.0; 4]));
            let mut plain = vec![[0.0; 4]; nodes.len()];
            add_forces::<Baseline>(&barrier.blocks, &places, &mut plain);
            assert_eq!(plain, forces);
            // Squeezed cells are within reach: their forces are the energy's.
            let largest = forces
                .iter()
                .flatten()
                .fold(0.0, |a: f64, b| a.max(b.abs()));
            for node in 0..nodes.len() {
                for c in 0..3 {
                    let (mut above, mut below) = (places.clone(), places.clone());
                    above[node][c] += 1e-7;
                    below[node][c] -= 1e-7;
                    let slope = (barrier.energy_j(&above) - barrier.energy_j(&below)) / 2e-7;
                    // Central differences of energies of about a joule.
                    assert!((forces[node][c] + slope).abs() < 1e-4 * largest);
                }
            }
        }
    }
}
