//! Cells integrated at their centres, for grids whose nodes are moved by fewer, smoother
//! coordinates.
//!
//! At the centre G = [c_ξ, c_η, c_ζ] and V / 8 = [c_ξ, c_η, c_ζ]; the other modes do no work.
//! Fields of [`CellBlock`] that belong to a Gauss point are those of the centre, in the first place.

use super::elastic::Elastic;
use super::kernel::{
    CellBlock, Triple, cross, dot, minus, modes, pressure, rows_of, stretch, times,
};
use crate::body::cells::Cell;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

/// Fills in what holds at the centres.
pub(super) fn reduce(
    block: &mut CellBlock,
    nodes: &[Point3],
    cells: &[Cell],
    materials: &[Elastic],
) {
    for (k, (cell, elastic)) in cells.iter().zip(materials).enumerate() {
        let mut map = Matrix3::zeros();
        for (corner, &node) in cell.iter().enumerate() {
            let half = |bit: usize| if corner & bit != 0 { 0.125 } else { -0.125 };
            map +=
                nodes[node as usize].coords * Vector3::new(half(4), half(2), half(1)).transpose();
        }
        let volume = 8.0 * map.determinant();
        // A cell without volume at its centre has been refused; should one come, it has no energy.
        let inverse = map.try_inverse().unwrap_or_else(Matrix3::zeros);
        let s = inverse * inverse.transpose();
        for (row, value) in rows_of(&s).into_iter().enumerate() {
            block.metric[0][row][k] = value;
        }
        block.stiffness_j[0][k] = 4.0 / 3.0 * elastic.lame_pa().0 * volume.abs();
        block.per_volume[k] = 1.0 / volume;
        block.winding[k] = volume.signum();
    }
}

/// What cells are like at their centres.
#[derive(Clone, Copy)]
pub(super) struct Centres<L: Lanes> {
    /// Pull of the change of shape along each column of G.
    pull: [Triple<L>; 3],
    /// ∂(V / 8)/∂G, column by column.
    growth: [Triple<L>; 3],
    /// V, m³.
    pub volume: L,
}

impl<L: Lanes> Centres<L> {
    #[inline(always)]
    pub(super) fn new(block: &CellBlock, metrics: &[Four; 6], places: &[Lane]) -> Self {
        let one = L::splat(1.0);
        let c = modes::<L>(&block.nodes, places);
        let (x, y, z) = (c[4], c[2], c[1]);
        let (t, invariant) = stretch(metrics, [x, y, z]);
        let factor = L::load(&block.stiffness_j[0]) * (one - one / (invariant + one));
        let growth = [cross(y, z), cross(z, x), cross(x, y)];
        let share = factor * L::splat(-0.125);
        Self {
            pull: [times(t[0], share), times(t[1], share), times(t[2], share)],
            growth,
            volume: dot(x, growth[0]) * L::splat(8.0),
        }
    }

    /// Adds the forces under a pressure to the corners' nodes.
    #[inline(always)]
    pub(super) fn push(&self, block: &CellBlock, pressure: L, residual: &mut [Lane]) {
        let zero = L::splat(0.0);
        // Closures of `map` would not be compiled for wide registers.
        let (pull, growth) = (&self.pull, &self.growth);
        let fx = minus(pull[0], times(growth[0], pressure));
        let fy = minus(pull[1], times(growth[1], pressure));
        let fz = minus(pull[2], times(growth[2], pressure));
        for corner in 0..8 {
            let mut rows = [zero; 4];
            for axis in 0..3 {
                let a = if corner & 4 != 0 {
                    fx[axis]
                } else {
                    zero - fx[axis]
                };
                let b = if corner & 2 != 0 {
                    a + fy[axis]
                } else {
                    a - fy[axis]
                };
                rows[axis] = if corner & 1 != 0 {
                    b + fz[axis]
                } else {
                    b - fz[axis]
                };
            }
            let rows = L::transposed(rows);
            for cell in 0..4 {
                let lane = &mut residual[block.nodes[corner][cell] as usize];
                (L::load(lane) + rows[cell]).store(lane);
            }
        }
    }
}

/// Adds the forces of a block's cells, as [`kernel::add_forces`](super::kernel::add_forces).
#[inline(always)]
pub(super) fn add_forces<L: Lanes>(
    block: &CellBlock,
    metrics: &[[Four; 6]; 1],
    given_pa: Option<&Four>,
    places: &[Lane],
    residual: &mut [Lane],
) -> L {
    let centres = Centres::<L>::new(block, &metrics[0], places);
    let (pressure, gap) = pressure(block, centres.volume, given_pa);
    centres.push(block, pressure, residual);
    gap
}

/// V, m³, by cell.
pub(super) fn volumes(block: &CellBlock, places: &[Lane]) -> Four {
    let c = modes::<Baseline>(&block.nodes, places);
    let mut volumes = [0.0; 4];
    (dot(c[4], cross(c[2], c[1])) * Baseline::splat(8.0)).store(&mut volumes);
    volumes
}

/// J, by cell.
pub(super) fn energy(block: &CellBlock, metrics: &[[Four; 6]; 1], places: &[Lane]) -> Four {
    let c = modes::<Baseline>(&block.nodes, places);
    let (_, lanes) = stretch(&metrics[0], [c[4], c[2], c[1]]);
    let (mut invariant, mut volume) = ([0.0; 4], [0.0; 4]);
    lanes.store(&mut invariant);
    (dot(c[4], cross(c[2], c[1])) * Baseline::splat(8.0)).store(&mut volume);
    std::array::from_fn(|cell| {
        let strain = invariant[cell] - 3.0;
        let shape = 0.5 * block.stiffness_j[0][cell] * (strain - libm::log1p(0.25 * strain));
        let grown = volume[cell] * block.per_volume[cell] - 1.0;
        let at_rest = block.winding[cell] / block.per_volume[cell];
        shape + at_rest * (0.5 * block.bulk_pa[cell] * grown - block.shear_pa[cell]) * grown
    })
}

#[cfg(test)]
mod tests {
    use super::super::ContinuumLaw;
    use super::super::tests::{Random, assert_forces_are_slopes};
    use super::*;
    use crate::body::CellGrid;

    fn cells() -> ContinuumLaw {
        let high = Point3::new(0.1, 0.12, 0.09);
        let mut grid = CellGrid::cuboid(&Point3::origin(), &high, [3, 4, 3]);
        let mut random = Random(41);
        grid.nodes
            .iter_mut()
            .for_each(|p| *p += random.vector() * 0.005);
        let elastic = vec![
            Elastic {
                young_pa: 3e4,
                poisson: 0.35
            };
            grid.cells.len()
        ];
        ContinuumLaw::at_centres(&grid, &elastic).unwrap()
    }

    fn moved(solid: &ContinuumLaw, by: f64, random: &mut Random) -> Vec<Lane> {
        let lane = |p: &Point3, d: Vector3| [p.x + d.x * by, p.y + d.y * by, p.z + d.z * by, 0.0];
        solid
            .rest()
            .iter()
            .map(|p| lane(p, random.vector()))
            .collect()
    }

    #[test]
    fn forces_at_centres_are_the_falling_slope_of_their_energy() {
        let (solid, mut random) = (cells(), Random(43));
        let at_rest = moved(&solid, 0.0, &mut random);
        // Strains of a few units in the last place, times modulus and volume: E V is 32 J here.
        let rounding_j = 8.0 * f64::EPSILON * 3e4 * 0.1 * 0.12 * 0.09;
        let at_rest_j = solid.energy_j(&at_rest);
        assert!(
            at_rest_j.abs() < rounding_j,
            "{at_rest_j} J at rest, rounding gives {rounding_j} J"
        );
        for scale in [1e-3, 2e-2] {
            let places = moved(&solid, scale, &mut random);
            assert_forces_are_slopes(&solid, &places);
        }
    }

    #[test]
    fn centres_and_gauss_points_agree_on_an_even_strain() {
        let high = Point3::new(0.1, 0.1, 0.1);
        let cube = CellGrid::cuboid(&Point3::origin(), &high, [3; 3]);
        let elastic = vec![
            Elastic {
                young_pa: 3e4,
                poisson: 0.3
            };
            cube.cells.len()
        ];
        let solids = [
            ContinuumLaw::new(&cube, &elastic).unwrap(),
            ContinuumLaw::at_centres(&cube, &elastic).unwrap(),
        ];
        let places: Vec<Lane> = cube
            .nodes
            .iter()
            .map(|p| [1.2 * p.x + 0.1 * p.y, 0.9 * p.y, p.z - 0.2 * p.x, 0.0])
            .collect();
        let [a, b] = solids.map(|solid| (solid.energy_j(&places), solid.forces(&places)));
        assert!((a.0 / b.0 - 1.0).abs() < 1e-12);
        for (f, g) in a.1.iter().zip(&b.1) {
            assert!((f - g).norm() < 1e-12 * f.norm().max(1.0));
        }
    }

    #[test]
    fn wide_registers_give_the_same_bits() {
        let (solid, mut random) = (cells(), Random(47));
        for scale in [0.0, 1e-3, 0.1, 1e3] {
            let places = moved(&solid, scale, &mut random);
            let (mut slow, mut fast) = (vec![[0.0; 4]; places.len()], vec![[0.0; 4]; places.len()]);
            super::super::add_forces::<Baseline>(&solid, &[], None, &places, &mut slow);
            solid.add_forces(&places, &mut fast);
            assert_eq!(slow, fast);
        }
    }
}
