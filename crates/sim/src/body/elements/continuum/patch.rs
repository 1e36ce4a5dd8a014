//! One pressure for several cells, for grids whose nodes are moved by fewer, smoother coordinates.
//!
//! Where there are more cells than coordinates, nearly incompressible cells lock if each keeps its own volume:
//! hardly any motion is left free. What λ is beyond [`OWN_LAME`] therefore acts on the volume of a patch of up to
//! eight neighbouring cells: Ψ = Σ Ψ_cell(μ, λ_own) + V₀ (λ − λ_own) / 2 (J̄ − 1)², J̄ the volume of the
//! patch over that at rest. It is the selective reduced integration of Malkus & Hughes 1978 with the mean
//! dilatation of Nagtegaal, Parks & Rice 1974 over patches. Below ν = 0.4 nothing is shared.

use super::block;
use super::centre::{self, Centres};
use super::elastic::Elastic;
use super::kernel::CellBlock;
use crate::body::cells::{Cell, CellGrid};
use palpate_geometry::math::lanes::{Four, Lanes};
use palpate_geometry::math::{Lane, Vector3};
use std::collections::BTreeMap;

/// λ / μ of which each cell keeps its own part.
const OWN_LAME: f64 = 4.0;
/// Most blocks of four cells in a patch.
const MOST_BLOCKS: usize = 2;
/// Cells of one patch have moduli within this factor: a pressure is not shared between unlike materials.
const ALIKE: f64 = 2.0;

/// Neighbouring cells with one pressure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    /// Its first block, and how many there are.
    pub first: usize,
    pub count: usize,
    /// λ beyond what cells have by themselves, Pa.
    pub lame_pa: f64,
    /// At rest, m³.
    pub volume_m3: f64,
    /// As [`CellBlock::reach`], of all its cells.
    pub reach: f64,
    /// 1 / λ' of the softest cell with what it shares, 1/Pa.
    pub per_bulk: f64,
}

/// λ in two parts, Pa: what acts on each cell by itself, and what acts on its patch.
fn parted(elastic: &Elastic) -> (f64, f64) {
    let (shear, lame) = elastic.lame_pa();
    let own = lame.min(OWN_LAME * shear);
    (own, lame - own)
}

/// A material with the same μ whose λ is only the part that acts on each cell by itself.
pub(super) fn own(elastic: &Elastic) -> Elastic {
    let (shear, _) = elastic.lame_pa();
    let (own, shared) = parted(elastic);
    match shared > 0.0 {
        true => Elastic {
            young_pa: shear * (3.0 * own + 2.0 * shear) / (own + shear),
            poisson: 0.5 * own / (own + shear),
        },
        false => *elastic,
    }
}

/// Cells of each patch, at most eight, with those of unlike materials apart; none where no cell shares anything.
pub(super) fn grouped(patch_of_cell: &[u32], elastic: &[Elastic]) -> Vec<Vec<usize>> {
    if elastic.iter().all(|elastic| parted(elastic).1 == 0.0) {
        return Vec::new();
    }
    let mut together: BTreeMap<u32, Vec<Vec<usize>>> = BTreeMap::new();
    let near = |a: f64, b: f64| a <= ALIKE * b && b <= ALIKE * a;
    let alike = |a: usize, b: usize| {
        let ([(mu, _), (nu, _)], [(_, one), (_, other)]) = (
            [a, b].map(|cell| elastic[cell].lame_pa()),
            [a, b].map(|cell| parted(&elastic[cell])),
        );
        near(mu, nu) && near(one, other)
    };
    for (cell, &patch) in patch_of_cell.iter().enumerate() {
        let groups = together.entry(patch).or_default();
        let full = 4 * MOST_BLOCKS;
        match groups
            .iter_mut()
            .find(|group| group.len() < full && alike(group[0], cell))
        {
            Some(group) => group.push(cell),
            None => groups.push(vec![cell]),
        }
    }
    together.into_values().flatten().collect()
}

/// The blocks of a patch's cells, which have their own part of λ alone, and the patch; `first` is the number
/// of its first block.
pub(super) fn blocks(
    grid: &CellGrid,
    cells: &[Cell],
    elastic: &[Elastic],
    first: usize,
) -> (Vec<CellBlock>, Patch) {
    debug_assert_eq!(cells.len(), elastic.len(), "a material a cell");
    let kept: Vec<Elastic> = elastic.iter().map(own).collect();
    let mut blocks = Vec::new();
    for (cells, kept) in cells.chunks(4).zip(kept.chunks(4)) {
        let mut block = block::block(&grid.nodes, cells, kept);
        centre::reduce(&mut block, &grid.nodes, cells, kept);
        // Cells that are not there have no volume.
        block.winding[cells.len()..].fill(0.0);
        blocks.push(block);
    }
    let of_cells = blocks
        .iter()
        .flat_map(|block| block.per_volume[..block.count].iter());
    let volumes: Vec<f64> = of_cells.map(|per_volume| 1.0 / per_volume.abs()).collect();
    let volume_m3: f64 = volumes.iter().sum();
    let shared = |(volume, elastic): (&f64, &Elastic)| volume * parted(elastic).1;
    let lame_pa = volumes.iter().zip(elastic).map(shared).sum::<f64>() / volume_m3;
    // As for a cell by itself, whose λ' is what it keeps and what it shares.
    let bulk_pa = |elastic: &Elastic| parted(elastic).0 + 5.0 / 6.0 * elastic.lame_pa().0 + lame_pa;
    let reach = |elastic: &Elastic| {
        let shear = elastic.lame_pa().0;
        (4.0 / 3.0 * elastic.bounding_pa() + 0.5 * shear) / bulk_pa(elastic)
    };
    let patch = Patch {
        first,
        count: blocks.len(),
        lame_pa,
        volume_m3,
        reach: elastic.iter().map(reach).fold(f64::INFINITY, f64::min),
        per_bulk: 1.0 / elastic.iter().map(bulk_pa).fold(f64::INFINITY, f64::min),
    };
    (blocks, patch)
}

impl Patch {
    /// Its blocks among all.
    pub(super) fn of<'a>(&self, blocks: &'a [CellBlock]) -> &'a [CellBlock] {
        debug_assert!(
            self.first + self.count.div_ceil(4) <= blocks.len(),
            "a patch of these blocks"
        );
        &blocks[self.first..self.first + self.count]
    }

    /// Adds −∂Ψ/∂x of a patch's cells; true where they were held back, as in
    /// [`kernel::pressure`](super::kernel::pressure).
    #[inline(always)]
    pub(super) fn add_forces<L: Lanes>(
        &self,
        blocks: &[CellBlock],
        metrics: &[Lane],
        places: &[Lane],
        residual: &mut [Lane],
        farther: f64,
    ) -> bool {
        debug_assert_eq!(places.len(), residual.len(), "one place and force a node");
        let of_patch = self.of(blocks);
        let Some(own) = block::metrics_of::<1>(&of_patch[0], metrics, self.first) else {
            return false;
        };
        // Filled again where there is a second block.
        let mut centres = [Centres::<L>::new(&of_patch[0], &own[0], places); MOST_BLOCKS];
        for (k, block) in of_patch.iter().enumerate().skip(1) {
            if let Some(own) = block::metrics_of::<1>(block, metrics, self.first + k) {
                centres[k] = Centres::new(block, &own[0], places);
            }
        }
        let (mut volume, mut grown, mut largest) = (0.0, 0.0_f64, 0.0_f64);
        for (block, centres) in of_patch.iter().zip(&centres) {
            let (mut of_cells, mut invariants): (Four, Four) = ([0.0; 4], [0.0; 4]);
            centres.volume.store(&mut of_cells);
            centres.largest.store(&mut invariants);
            for cell in 0..block.count {
                volume += of_cells[cell] * block.winding[cell];
                let by_itself = of_cells[cell] * block.per_volume[cell] - 1.0;
                grown = grown.max(block.bulk_pa[cell] * by_itself.abs());
                largest = largest.max(invariants[cell]);
            }
        }
        // What has overflowed is far out of reach, whatever it is.
        let number = |x: f64| match x.is_nan() {
            true => 1e90,
            false => x.clamp(-1e90, 1e90),
        };
        let whole = number(volume / self.volume_m3 - 1.0);
        let reach = self.reach * farther;
        let pressed = (number(grown) + self.lame_pa * whole.abs()) * self.per_bulk;
        let bend = pressed * (largest / 3.0).sqrt() * 2.0;
        let excess = largest * largest / 3.0 + bend;
        let followed = reach / excess.max(reach);
        let followed = followed * followed;
        let shared = L::splat(self.lame_pa * whole);
        for (block, centres) in of_patch.iter().zip(&centres) {
            let grown = centres.volume * L::load(&block.per_volume) - L::splat(1.0);
            let grown = grown.greatest(L::splat(-1e90)).least(L::splat(1e90));
            let pressure = L::load(&block.bulk_pa) * grown - L::load(&block.shear_pa) + shared;
            let pressure = pressure * L::splat(followed) * L::load(&block.winding);
            centres.push(block, pressure, residual);
        }
        excess > reach
    }

    /// Energy of what the cells share, J.
    pub(super) fn energy_j(&self, blocks: &[CellBlock], places: &[Lane]) -> f64 {
        let mut volume = 0.0;
        for block in self.of(blocks) {
            let of_cells = centre::volumes(block, places);
            for cell in 0..block.count {
                volume += of_cells[cell] * block.winding[cell];
            }
        }
        let grown = volume / self.volume_m3 - 1.0;
        0.5 * self.lame_pa * self.volume_m3 * grown * grown
    }

    /// ∂V/∂x at rest, m², by node, the nodes in order.
    pub(super) fn growth(
        &self,
        blocks: &[CellBlock],
        slopes: impl Fn(&Cell) -> [Vector3; 8],
    ) -> Vec<(u32, Vector3)> {
        let mut growth: BTreeMap<u32, Vector3> = BTreeMap::new();
        for block in self.of(blocks) {
            for k in 0..block.count {
                let cell: Cell = block.nodes.map(|four| four[k]);
                for (&node, slope) in cell.iter().zip(slopes(&cell)) {
                    *growth.entry(node).or_insert_with(Vector3::zeros) += slope;
                }
            }
        }
        growth.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, assert_forces_are_slopes};
    use super::super::{ContinuumLaw, add_forces};
    use super::*;
    use crate::body::CubeLattice;
    use palpate_geometry::math::lanes::Baseline;
    use palpate_geometry::math::{Matrix3, Point3};

    const NEARLY_INCOMPRESSIBLE: Elastic = Elastic {
        young_pa: 3e4,
        poisson: 0.495,
    };

    /// 3 × 4 × 3 distorted cells and their patches of 2 × 2 × 2 and less.
    fn cells() -> (CellGrid, Vec<u32>) {
        let [low, high] = [Point3::origin(), Point3::new(0.1, 0.12, 0.09)];
        let mut grid = CubeLattice::cuboid(&low, &high, [4, 5, 4]).unwrap().grid;
        let mut random = Random(53);
        grid.nodes
            .iter_mut()
            .for_each(|p| *p += random.vector() * 0.003);
        let middle = |cell: &Cell| -> Vector3 {
            let corners = cell.iter().map(|&node| grid.nodes[node as usize].coords);
            corners.sum::<Vector3>() / 8.0
        };
        let half = |x: f64, length: f64, count: f64| (x / length * count) as u32 / 2;
        let of_cell = |cell: &Cell| {
            let at = middle(cell);
            half(at.x, 0.1, 3.0) + 8 * half(at.y, 0.12, 4.0) + 64 * half(at.z, 0.09, 3.0)
        };
        let patches = grid.cells.iter().map(of_cell).collect();
        (grid, patches)
    }

    fn solid() -> ContinuumLaw {
        let (grid, patches) = cells();
        // Moduli that vary within patches.
        let of_cell = |k: usize| Elastic {
            young_pa: 3e4 * (1.0 + 0.01 * k as f64),
            ..NEARLY_INCOMPRESSIBLE
        };
        let elastic: Vec<Elastic> = (0..grid.cells.len()).map(of_cell).collect();
        ContinuumLaw::in_patches(&grid, &elastic, &patches).unwrap()
    }

    fn moved(solid: &ContinuumLaw, by: f64, random: &mut Random) -> Vec<Lane> {
        let lane = |p: &Point3, d: Vector3| [p.x + d.x * by, p.y + d.y * by, p.z + d.z * by, 0.0];
        let rest = solid.rest().iter();
        rest.map(|p| lane(p, random.vector())).collect()
    }

    #[test]
    fn cells_are_neighbours_of_like_matter() {
        let solid = solid();
        assert_eq!((solid.cell_count(), solid.patches.len()), (36, 8));
        for patch in &solid.patches {
            let cells = patch
                .of(&solid.blocks)
                .iter()
                .flat_map(|block| (0..block.count).map(|k| block.nodes.map(|four| four[k])));
            let cells: Vec<Cell> = cells.collect();
            let common = |node: &&u32| cells.iter().all(|cell| cell.contains(node));
            assert!(cells[0].iter().any(|node| common(&node)), "{cells:?}");
        }
        let (grid, patches) = cells();
        let unlike = |k: usize| Elastic {
            young_pa: if k.is_multiple_of(2) { 3e4 } else { 3e6 },
            ..NEARLY_INCOMPRESSIBLE
        };
        let elastic: Vec<Elastic> = (0..grid.cells.len()).map(unlike).collect();
        for group in grouped(&patches, &elastic) {
            assert!(group.iter().all(|cell| cell % 2 == group[0] % 2));
        }
    }

    #[test]
    fn compressible_cells_share_nothing_and_keep_their_bits() {
        let (grid, patches) = cells();
        let elastic = vec![
            Elastic {
                young_pa: 3e4,
                poisson: 0.39,
            };
            grid.cells.len()
        ];
        let solids = [
            ContinuumLaw::in_patches(&grid, &elastic, &patches).unwrap(),
            ContinuumLaw::at_centres(&grid, &elastic).unwrap(),
        ];
        let places = moved(&solids[0], 2e-3, &mut Random(57));
        let [a, b] = solids.map(|solid| solid.exact_forces(&places));
        assert_eq!(a, b);
    }

    #[test]
    fn forces_are_the_falling_slope_of_the_energy() {
        let (solid, mut random) = (solid(), Random(59));
        let at_rest = solid.energy_j(&moved(&solid, 0.0, &mut random));
        // λ V is 1 kJ here; strains are known to a few units in the last place.
        assert!(at_rest.abs() < 1e-12, "{at_rest} J at rest");
        for scale in [1e-3, 8e-3] {
            let places = moved(&solid, scale, &mut random);
            assert_forces_are_slopes(&solid, &places);
        }
    }

    // Every cell of an even strain has the volume of its patch.
    #[test]
    fn an_even_strain_meets_the_forces_of_cells_by_themselves() {
        let (grid, patches) = cells();
        let elastic = vec![NEARLY_INCOMPRESSIBLE; grid.cells.len()];
        let solids = [
            ContinuumLaw::in_patches(&grid, &elastic, &patches).unwrap(),
            ContinuumLaw::at_centres(&grid, &elastic).unwrap(),
        ];
        let strain = Matrix3::new(1.05, 0.02, 0.0, -0.03, 0.97, 0.04, 0.01, 0.0, 1.02);
        let place = |p: &Point3| {
            let q = strain * p;
            [q.x, q.y, q.z, 0.0]
        };
        let places: Vec<Lane> = grid.nodes.iter().map(place).collect();
        let [a, b] = solids.map(|solid| (solid.energy_j(&places), solid.exact_forces(&places)));
        assert!((a.0 / b.0 - 1.0).abs() < 1e-11, "{} J, {} J", a.0, b.0);
        let largest = b.1.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for (f, g) in a.1.iter().zip(&b.1) {
            assert!((f - g).norm() < 1e-10 * largest, "{f} {g}");
        }
    }

    // The step is stable while the law's own tangent is below 4/3 of it.
    #[test]
    fn the_tangent_of_the_step_is_above_that_of_the_forces_by_its_margins() {
        let (solid, mut random) = (solid(), Random(61));
        for _ in 0..20 {
            let ways: Vec<Vector3> = solid.rest().iter().map(|_| random.vector()).collect();
            let step = 1e-7;
            let at = |sign: f64| -> Vec<Vector3> {
                let lane = |(p, way): (&Point3, &Vector3)| {
                    let q = p + way * (sign * step);
                    [q.x, q.y, q.z, 0.0]
                };
                let places: Vec<Lane> = solid.rest().iter().zip(&ways).map(lane).collect();
                solid.exact_forces(&places)
            };
            let differences = at(-1.0).into_iter().zip(at(1.0));
            let own: f64 = (differences.zip(&ways))
                .map(|((below, above), way)| (below - above).dot(way) / (2.0 * step))
                .sum();
            let mut of_step = 0.0;
            solid.tangent_at_centres(0.0, &mut |a, b, block| {
                let product = ways[a as usize].dot(&(block * ways[b as usize]));
                of_step += if a == b { product } else { 2.0 * product };
            });
            solid.shared_at_rest(&mut |growth, stiffness| {
                let along: f64 = growth
                    .iter()
                    .map(|&(node, g)| g.dot(&ways[node as usize]))
                    .sum();
                of_step += stiffness * along * along;
            });
            let ratio = of_step / own;
            assert!((1.09..1.51).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn wide_registers_give_the_same_bits_and_all_are_finite() {
        let (solid, mut random) = (solid(), Random(67));
        for scale in [0.0, 1e-3, 0.1, 1e3, 1e100] {
            let places = moved(&solid, scale, &mut random);
            let (mut slow, mut fast) = (vec![[0.0; 4]; places.len()], vec![[0.0; 4]; places.len()]);
            let pass = add_forces::<Baseline>(&solid, &[], &places, &mut slow, 1.0);
            assert_eq!(pass, solid.add_forces(&places, &mut fast));
            assert_eq!(slow, fast);
            assert!(
                slow.as_flattened().iter().all(|x| x.is_finite()),
                "at {scale}"
            );
            assert_eq!(
                pass.limited > 0,
                scale > 0.05,
                "{} at {scale}",
                pass.limited
            );
        }
    }
}
