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
use super::kernel::{self, CellBlock};
use crate::body::cells::{Cell, CellGrid};
use palpate_geometry::math::Lane;
use palpate_geometry::math::lanes::{Four, Lanes};
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
    let patch = Patch {
        first,
        count: blocks.len(),
        lame_pa,
        volume_m3,
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

    /// Adds the forces of a patch's cells. `given`: where pressures are unknowns, that of each cell by block and what the
    /// patch shares; `gaps`: of the cells, by block. Answers with the gap of the patch.
    #[inline(always)]
    pub(super) fn add_forces<L: Lanes>(
        &self,
        blocks: &[CellBlock],
        metrics: &[Lane],
        given: Option<(&[Lane], f64)>,
        places: &[Lane],
        residual: &mut [Lane],
        gaps: &mut [Lane],
    ) -> f64 {
        debug_assert_eq!(places.len(), residual.len(), "one place and force a node");
        let of_patch = self.of(blocks);
        let Some(own) = block::metrics_of::<1>(&of_patch[0], metrics, self.first) else {
            return 0.0;
        };
        // Filled again where there is a second block.
        let mut centres = [Centres::<L>::new(&of_patch[0], &own[0], places); MOST_BLOCKS];
        for (k, block) in of_patch.iter().enumerate().skip(1) {
            if let Some(own) = block::metrics_of::<1>(block, metrics, self.first + k) {
                centres[k] = Centres::new(block, &own[0], places);
            }
        }
        let mut volume = 0.0;
        for (block, centres) in of_patch.iter().zip(&centres) {
            let mut of_cells: Four = [0.0; 4];
            centres.volume.store(&mut of_cells);
            for cell in 0..block.count {
                volume += of_cells[cell] * block.winding[cell];
            }
        }
        let grown = self.grown(volume);
        let (shared_pa, gap) = match given {
            Some((_, shared_pa)) => (shared_pa, grown - shared_pa / self.lame_pa),
            None => (self.lame_pa * grown, 0.0),
        };
        for (k, (block, centres)) in of_patch.iter().zip(&centres).enumerate() {
            let own = given.map(|(of_cells, _)| &of_cells[self.first + k]);
            let (pressure, gap) = kernel::pressure(block, centres.volume, own);
            let shared = L::splat(shared_pa) * L::load(&block.winding);
            centres.push(block, pressure + shared, residual);
            if given.is_some() {
                gap.store(&mut gaps[self.first + k]);
            }
        }
        gap
    }

    /// J̄ − 1 of the patch; what has overflowed is far out, whatever it is.
    fn grown(&self, volume: f64) -> f64 {
        let grown = volume / self.volume_m3 - 1.0;
        match grown.is_nan() {
            true => 1e90,
            false => grown.clamp(-1e90, 1e90),
        }
    }

    /// λ (J̄ − 1) of what the cells share, Pa.
    #[cfg(test)]
    pub(super) fn pressure_pa(&self, blocks: &[CellBlock], places: &[Lane]) -> f64 {
        self.lame_pa * self.grown(self.volume(blocks, places))
    }

    fn volume(&self, blocks: &[CellBlock], places: &[Lane]) -> f64 {
        let mut volume = 0.0;
        for block in self.of(blocks) {
            let of_cells = centre::volumes(block, places);
            for cell in 0..block.count {
                volume += of_cells[cell] * block.winding[cell];
            }
        }
        volume
    }

    /// Energy of what the cells share, J.
    pub(super) fn energy_j(&self, blocks: &[CellBlock], places: &[Lane]) -> f64 {
        let grown = self.volume(blocks, places) / self.volume_m3 - 1.0;
        0.5 * self.lame_pa * self.volume_m3 * grown * grown
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, assert_forces_are_slopes};
    use super::super::{ContinuumLaw, Given, add_forces};
    use super::*;
    use crate::body::CellGrid;
    use crate::body::elements::law::Place;
    use palpate_geometry::math::lanes::Baseline;
    use palpate_geometry::math::{Matrix3, Point3, Vector3};

    const NEARLY_INCOMPRESSIBLE: Elastic = Elastic {
        young_pa: 3e4,
        poisson: 0.495,
    };

    /// 3 × 4 × 3 distorted cells and their patches of 2 × 2 × 2 and less.
    fn cells() -> (CellGrid, Vec<u32>) {
        let [low, high] = [Point3::origin(), Point3::new(0.1, 0.12, 0.09)];
        let mut grid = CellGrid::cuboid(&low, &high, [4, 5, 4]);
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
        let [a, b] = solids.map(|solid| solid.forces(&places));
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
        let [a, b] = solids.map(|solid| (solid.energy_j(&places), solid.forces(&places)));
        assert!((a.0 / b.0 - 1.0).abs() < 1e-11, "{} J, {} J", a.0, b.0);
        let largest = b.1.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for (f, g) in a.1.iter().zip(&b.1) {
            assert!((f - g).norm() < 1e-10 * largest, "{f} {g}");
        }
    }

    #[test]
    fn the_tangent_is_that_of_the_forces() {
        let (solid, mut random) = (solid(), Random(61));
        let rest: Vec<Lane> = moved(&solid, 0.0, &mut random);
        for _ in 0..20 {
            let ways: Vec<Vector3> = solid.rest().iter().map(|_| random.vector()).collect();
            let step = 1e-7;
            let at = |sign: f64| -> Vec<Vector3> {
                let lane = |(p, way): (&Point3, &Vector3)| {
                    let q = p + way * (sign * step);
                    [q.x, q.y, q.z, 0.0]
                };
                let places: Vec<Lane> = solid.rest().iter().zip(&ways).map(lane).collect();
                solid.forces(&places)
            };
            let differences = at(-1.0).into_iter().zip(at(1.0));
            let own: f64 = (differences.zip(&ways))
                .map(|((below, above), way)| (below - above).dot(way) / (2.0 * step))
                .sum();
            let mut of_step = 0.0;
            let place = Place {
                places: &rest,
                metrics: &[],
                pressures: &[],
            };
            solid.tangent_at(&place, &mut |a: u32, b: u32, block: Matrix3| {
                let product = ways[a as usize].dot(&(block * ways[b as usize]));
                of_step += if a == b { product } else { 2.0 * product };
            });
            solid.shared_at(&rest, &mut |growth, stiffness| {
                let along: f64 = growth
                    .iter()
                    .map(|&(node, g)| g.dot(&ways[node as usize]))
                    .sum();
                of_step += stiffness * along * along;
            });
            assert!((of_step / own - 1.0).abs() < 1e-6, "{of_step} {own}");
        }
    }

    /// A pressure that follows the volumes is no unknown: given as it is, it has no gap and the same forces; and its
    /// change with the places is G₀·d / V.
    #[test]
    fn given_pressures_are_those_of_the_volumes() {
        let (solid, mut random) = (solid(), Random(71));
        let places = moved(&solid, 2e-3, &mut random);
        let mut pressures = vec![[0.0; 4]; solid.pressure_lanes()];
        let mut gaps = pressures.clone();
        solid.pressures_at(&places, &mut pressures);
        let (mut given, mut own) = (vec![[0.0; 4]; places.len()], vec![[0.0; 4]; places.len()]);
        let unknown = Given {
            pressures: &pressures,
            gaps: &mut gaps,
        };
        solid.add_forces_of(&[], Some(unknown), &places, &mut given);
        solid.add_forces(&places, &mut own);
        let size = own
            .as_flattened()
            .iter()
            .fold(0.0f64, |a, f| a.max(f.abs()));
        for (a, b) in given.as_flattened().iter().zip(own.as_flattened()) {
            assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
        }
        for (block, gaps) in solid.blocks.iter().zip(&gaps) {
            assert!(gaps[..block.count].iter().all(|gap| gap.abs() < 1e-14));
        }
        let step = 1e-7;
        let ways: Vec<Lane> = places
            .iter()
            .map(|_| {
                let v = random.vector();
                [v.x, v.y, v.z, 0.0]
            })
            .collect();
        let ahead: Vec<Lane> = places
            .iter()
            .zip(&ways)
            .map(|(p, v)| std::array::from_fn(|k| p[k] + step * v[k]))
            .collect();
        let mut then = pressures.clone();
        solid.pressures_at(&ahead, &mut then);
        let growth = solid.growth_at(&places);
        let before = pressures.clone();
        solid.press(&growth, &ways, step, None, &mut pressures);
        let (mut largest, mut off) = (0.0f64, 0.0f64);
        // Cells that are not there have none.
        let there = |k: &usize| {
            solid
                .blocks
                .get(k / 4)
                .is_none_or(|block| k % 4 < block.count)
        };
        for k in (0..pressures.as_flattened().len()).filter(there) {
            let at = |lanes: &[Lane]| lanes.as_flattened()[k];
            largest = largest.max((at(&then) - at(&before)).abs());
            off = off.max((at(&then) - at(&pressures)).abs());
        }
        assert!(off < 1e-4 * largest, "{off} of {largest}");
        // Condensing is the transpose.
        let mut loads = vec![[0.0; 4]; places.len()];
        gaps.iter_mut()
            .for_each(|gap| *gap = std::array::from_fn(|_| random.unit()));
        solid.condense(&growth, &gaps, &mut loads);
        let work: f64 = loads
            .iter()
            .zip(&ways)
            .map(|(f, v)| f[0] * v[0] + f[1] * v[1] + f[2] * v[2])
            .sum();
        let mut change = vec![[0.0; 4]; gaps.len()];
        solid.press(&growth, &ways, 1.0, None, &mut change);
        let mut other = 0.0;
        for (k, block) in solid.blocks.iter().enumerate() {
            for lane in 0..block.count {
                other -= gaps[k][lane] * change[k][lane] / block.per_volume[lane].abs();
            }
        }
        for (k, patch) in solid.patches.iter().enumerate() {
            let at = |lanes: &[Lane]| lanes[solid.blocks.len()..].as_flattened()[k];
            other -= at(&gaps) * at(&change) * patch.volume_m3;
        }
        assert!((work / other - 1.0).abs() < 1e-10, "{work} {other}");
    }

    #[test]
    fn wide_registers_give_the_same_bits_and_all_are_finite() {
        let (solid, mut random) = (solid(), Random(67));
        for scale in [0.0, 1e-3, 0.1, 1e3, 1e100] {
            let places = moved(&solid, scale, &mut random);
            let (mut slow, mut fast) = (vec![[0.0; 4]; places.len()], vec![[0.0; 4]; places.len()]);
            add_forces::<Baseline>(&solid, &[], None, &places, &mut slow);
            solid.add_forces(&places, &mut fast);
            assert_eq!(slow, fast);
            assert!(
                slow.as_flattened().iter().all(|x| x.is_finite()),
                "at {scale}"
            );
        }
    }
}
