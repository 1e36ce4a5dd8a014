//! Elastic solids: stable neo-Hookean hexahedra.
//!
//! Smith, de Goes & Kim 2018, *Stable Neo-Hookean Flesh Simulation*, eq. 14 with their μ' = 4/3 μ
//! and λ' = λ + 5/6 μ, so that E and ν are those of small strains and rest is without stress: `Ψ =
//! ∫ μ'/2 (I_C − 3 − ln((I_C + 1) / 4)) dV + V₀ (λ'/2 (J̄ − 1)² − 3/4 μ' (J̄ − 1))`. The first
//! integral is by 2 × 2 × 2 Gauss points. J̄ is the volume of the whole cell over that at rest
//! (mean dilatation, Nagtegaal, Parks & Rice 1974), so nearly incompressible cells do not lock.
//! Inverted and flat cells have finite forces that lead back.
//!
//! The implicit step knows pressures as unknowns of their own.

mod barrier;
mod block;
mod bound;
mod centre;
mod elastic;
mod flow;
mod hessian;
mod kernel;
mod patch;
mod rest;
#[cfg(test)]
pub(in crate::body) mod tests;
mod unknown;

use crate::body::cells::{Cell, CellGrid};
pub use barrier::VolumeBarrier;
pub use elastic::Elastic;
pub(in crate::body) use flow::{CellCarry, CellFlow, SpringCarry};
use kernel::CellBlock;
pub(in crate::body) use kernel::{areas_squared, inverses, squares_at_centre, stretched};
use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, Point3, Vector3};
use patch::Patch;
use rest::RestShape;
pub(in crate::body) use unknown::Growth;

/// Cells below this least scaled Jacobian are refused: their strains say little about the solid.
pub const LEAST_SCALED_JACOBIAN: f64 = 0.2;

/// Least share of a cell's volume at a Gauss point, over the mean share. A wedge has 0.42, a
/// pyramid 0.13.
const LEAST_EVENNESS: f64 = 0.01;

/// Why cells cannot carry a continuum energy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContinuumError {
    /// One material a cell, please.
    #[error("{materials} materials for {cells} cells")]
    Count {
        /// Materials given.
        materials: usize,
        /// Cells given.
        cells: usize,
    },
    /// A material that no solid has.
    #[error(
        "cell {cell}: E = {young_pa} Pa, ν = {poisson}; E must be above 0 and ν from 0 to below 0.5"
    )]
    Material {
        /// The first such cell.
        cell: usize,
        /// Its E.
        young_pa: f64,
        /// Its ν.
        poisson: f64,
    },
    /// Cells too flat or folded.
    #[error(
        "{count} of {total} cells are too distorted: cell {worst} has scaled Jacobian {quality:.3}, the least allowed is \
         {LEAST_SCALED_JACOBIAN}; refine the net where it is long and thin, use fewer layers, draw a flat body with the poles of its net in \
         the middle of its two sides, or take model = \"lattice\""
    )]
    Distorted {
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
        /// The worst of them.
        worst: usize,
        /// Its least scaled Jacobian; of a cell that folds at a Gauss point, its least share of
        /// volume there.
        quality: f64,
    },
}

/// The constant of an elastic solid.
#[derive(Clone, Debug)]
pub struct ContinuumLaw {
    /// (cells / 4, rounded up).
    blocks: Vec<CellBlock>,
    rest: Vec<Point3>,
    /// In the order of the blocks.
    cells: Vec<Cell>,
    materials: Vec<Elastic>,
    points: Points,
    /// Cells that share a pressure; empty where each has its own.
    patches: Vec<Patch>,
}

/// Pressures that a pass over the cells is given, and the gaps that it answers with: both
/// [`ContinuumLaw::pressure_lanes`] long.
pub(in crate::body) struct Given<'a> {
    /// Pa.
    pub pressures: &'a [Lane],
    /// J − 1 − q / λ.
    pub gaps: &'a mut [Lane],
}

impl Given<'_> {
    /// The same once more.
    fn again(&mut self) -> Given<'_> {
        Given {
            pressures: self.pressures,
            gaps: self.gaps,
        }
    }
}

/// Where a cell's energy is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Points {
    /// At 2 × 2 × 2 Gauss points, the volume over the whole cell.
    Eight,
    /// At its centre.
    Centre,
}

impl ContinuumLaw {
    /// Checks cells and materials (one a cell) and integrates the cells at rest.
    ///
    /// # Errors
    /// A material out of range, or distorted cells.
    pub fn new(grid: &CellGrid, elastic: &[Elastic]) -> Result<Self, ContinuumError> {
        Self::integrated(grid, elastic, Points::Eight)
    }

    /// The same with one point a cell, a fifth of the work. A cell by itself then has motions
    /// without energy: only for grids whose nodes are moved by fewer, smoother coordinates.
    ///
    /// # Errors
    /// As [`ContinuumLaw::new`].
    pub fn at_centres(grid: &CellGrid, elastic: &[Elastic]) -> Result<Self, ContinuumError> {
        Self::integrated(grid, elastic, Points::Centre)
    }

    fn integrated(
        grid: &CellGrid,
        elastic: &[Elastic],
        points: Points,
    ) -> Result<Self, ContinuumError> {
        check(grid, elastic)?;
        let mut blocks = Vec::with_capacity(grid.cells.len().div_ceil(4));
        for (cells, materials) in grid.cells.chunks(4).zip(elastic.chunks(4)) {
            let mut block = block::block(&grid.nodes, cells, materials);
            if points == Points::Centre {
                centre::reduce(&mut block, &grid.nodes, cells, materials);
            }
            blocks.push(block);
        }
        let (cells, materials) = (grid.cells.clone(), elastic.to_vec());
        Ok(Self {
            blocks,
            rest: grid.nodes.clone(),
            cells,
            materials,
            points,
            patches: Vec::new(),
        })
    }

    /// Takes distorted cells as well, without a check.
    fn unchecked(nodes: &[Point3], cells: &[Cell], elastic: &[Elastic]) -> Self {
        let four = cells.chunks(4).zip(elastic.chunks(4));
        Self {
            blocks: four
                .map(|(cells, materials)| block::block(nodes, cells, materials))
                .collect(),
            rest: nodes.to_vec(),
            cells: cells.to_vec(),
            materials: elastic.to_vec(),
            points: Points::Eight,
            patches: Vec::new(),
        }
    }

    /// The same for grids with more cells than coordinates, in which nearly incompressible cells would lock if
    /// each kept its own volume. From ν = 0.4 on, cells with the same number in `patch_of_cell` (cells) share a
    /// pressure; they must be neighbours. Empty: every cell has its own.
    ///
    /// # Errors
    /// As [`ContinuumLaw::new`].
    pub fn in_patches(
        grid: &CellGrid,
        elastic: &[Elastic],
        patch_of_cell: &[u32],
    ) -> Result<Self, ContinuumError> {
        check(grid, elastic)?;
        debug_assert!(
            patch_of_cell.is_empty() || patch_of_cell.len() == grid.cells.len(),
            "one number a cell, or none"
        );
        let groups = patch::grouped(patch_of_cell, elastic);
        if groups.is_empty() {
            return Self::at_centres(grid, elastic);
        }
        let mut law = Self {
            blocks: Vec::new(),
            rest: grid.nodes.clone(),
            cells: Vec::new(),
            materials: Vec::new(),
            points: Points::Centre,
            patches: Vec::new(),
        };
        for group in groups {
            let cells: Vec<Cell> = group.iter().map(|&cell| grid.cells[cell]).collect();
            let materials: Vec<Elastic> = group.iter().map(|&cell| elastic[cell]).collect();
            let (blocks, patch) = patch::blocks(grid, &cells, &materials, law.blocks.len());
            law.blocks.extend(blocks);
            law.cells.extend(cells);
            law.materials.extend(materials);
            law.patches.push(patch);
        }
        Ok(law)
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.rest.len()
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The largest ν of its cells.
    pub(in crate::body) fn largest_poisson(&self) -> f64 {
        let each = self.materials.iter().map(|elastic| elastic.poisson);
        each.fold(0.0, f64::max)
    }

    /// Rest positions, m.
    pub fn rest(&self) -> &[Point3] {
        &self.rest
    }

    /// Adds −∂Ψ/∂x (N) at `places` (m, fourth number ignored) to `residual`, both (node_count).
    /// Finite for places up to 1e100 m.
    pub fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        self.add_forces_of(&[], None, places, residual);
    }

    /// Adds forces of cells that flow, or under given pressures. `metrics`: as [`CellFlow::rest`], empty where none
    /// flows; `given`: pressures instead of those that follow the volumes.
    pub(in crate::body) fn add_forces_of(
        &self,
        metrics: &[Lane],
        given: Option<Given<'_>>,
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        debug_assert!(
            places.len() == self.rest.len() && residual.len() == places.len(),
            "one place and force a node"
        );
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_forces_avx2(self, metrics, given, places, residual) };
        }
        add_forces::<Baseline>(self, metrics, given, places, residual);
    }

    /// Blocks of cells, or patches where cells share pressures.
    pub(in crate::body) fn part_count(&self) -> usize {
        match self.patches.len() {
            0 => self.blocks.len(),
            count => count,
        }
    }

    /// The blocks of a part.
    fn blocks_of_part(&self, part: usize) -> std::ops::Range<usize> {
        match self.patches.get(part) {
            Some(patch) => patch.first..patch.first + patch.count,
            None => part..part + 1,
        }
    }

    /// Nodes of each part.
    pub(in crate::body) fn nodes_of_parts(&self) -> Vec<Vec<u32>> {
        let of_block = |k: usize| {
            let block = &self.blocks[k];
            let there = |four: &[u32; 4]| four[..block.count].to_vec();
            block.nodes.iter().flat_map(there).collect::<Vec<_>>()
        };
        let nodes = |part| self.blocks_of_part(part).flat_map(of_block).collect();
        (0..self.part_count()).map(nodes).collect()
    }

    /// [`ContinuumLaw::add_forces_of`] of some parts, whose numbers count from a first one.
    pub(in crate::body) fn add_forces_of_some(
        &self,
        parts: (&[u32], u32),
        metrics: &[Lane],
        given: Option<Given<'_>>,
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe {
                add_forces_of_some_avx2(self, parts, metrics, given, places, residual)
            };
        }
        add_forces_of_some::<Baseline>(self, parts, metrics, given, places, residual);
    }

    /// −∂Ψ/∂x (node_count), N.
    pub fn forces(&self, places: &[Lane]) -> Vec<Vector3> {
        let mut residual = vec![[0.0; 4]; places.len()];
        self.add_forces(places, &mut residual);
        let forces = residual.iter();
        forces.map(|r| Vector3::new(r[0], r[1], r[2])).collect()
    }

    /// The least volume of a cell over its own at rest; below 0 where one is turned inside out.
    pub(in crate::body) fn least_volume(&self, places: &[Lane]) -> f64 {
        let mut least = f64::INFINITY;
        for block in &self.blocks {
            let volumes = match self.points {
                Points::Eight => block::volumes(block, places),
                Points::Centre => centre::volumes(block, places),
            };
            let shares = volumes.iter().zip(&block.per_volume).take(block.count);
            least = shares.map(|(v, per_v)| v * per_v).fold(least, f64::min);
        }
        least
    }

    /// Ψ, J; zero at rest.
    pub fn energy_j(&self, places: &[Lane]) -> f64 {
        self.energy_flowed_j(&[], places)
    }

    /// The same of cells that flow: `metrics` as [`CellFlow::rest`].
    pub(in crate::body) fn energy_flowed_j(&self, metrics: &[Lane], places: &[Lane]) -> f64 {
        let blocks = self.blocks.iter().enumerate();
        let energies =
            blocks.filter_map(|(k, block)| match self.points {
                Points::Eight => block::metrics_of(block, metrics, k)
                    .map(|own| block::energy(block, own, places)),
                Points::Centre => block::metrics_of(block, metrics, k)
                    .map(|own| centre::energy(block, own, places)),
            });
        let shared = self
            .patches
            .iter()
            .map(|patch| patch.energy_j(&self.blocks, places));
        energies
            .map(|four| four.iter().sum::<f64>())
            .chain(shared)
            .sum()
    }
}

#[inline(always)]
fn add_forces<L: Lanes>(
    law: &ContinuumLaw,
    metrics: &[Lane],
    mut given: Option<Given<'_>>,
    places: &[Lane],
    residual: &mut [Lane],
) {
    for part in 0..law.part_count() {
        let given = given.as_mut().map(Given::again);
        add_forces_of_part::<L>(law, part, metrics, given, places, residual);
    }
}

/// Of the cells that have a block in common, or a pressure.
#[inline(always)]
fn add_forces_of_part<L: Lanes>(
    law: &ContinuumLaw,
    part: usize,
    metrics: &[Lane],
    given: Option<Given<'_>>,
    places: &[Lane],
    residual: &mut [Lane],
) {
    let blocks = &law.blocks;
    let (pressures, gaps): (Option<&[Lane]>, &mut [Lane]) = match given {
        Some(Given { pressures, gaps }) => (Some(pressures), gaps),
        None => (None, &mut []),
    };
    if let Some(patch) = law.patches.get(part) {
        let parts = pressures.map(|all| all.split_at(blocks.len()));
        let of_patch = parts.map(|(cells, patches)| (cells, patches.as_flattened()[part]));
        let gap = patch.add_forces::<L>(blocks, metrics, of_patch, places, residual, gaps);
        if parts.is_some() {
            gaps[blocks.len()..].as_flattened_mut()[part] = gap;
        }
        return;
    }
    let block = &blocks[part];
    let given = pressures.map(|all| &all[part]);
    let gap = match law.points {
        Points::Eight => match block::metrics_of(block, metrics, part) {
            Some(own) => kernel::add_forces::<L>(block, own, given, places, residual),
            None => return,
        },
        Points::Centre => match block::metrics_of(block, metrics, part) {
            Some(own) => centre::add_forces::<L>(block, own, given, places, residual),
            None => return,
        },
    };
    if given.is_some() {
        gap.store(&mut gaps[part]);
    }
}

#[inline(always)]
fn add_forces_of_some<L: Lanes>(
    law: &ContinuumLaw,
    (parts, first): (&[u32], u32),
    metrics: &[Lane],
    mut given: Option<Given<'_>>,
    places: &[Lane],
    residual: &mut [Lane],
) {
    for part in parts {
        let given = given.as_mut().map(Given::again);
        let part = (part - first) as usize;
        add_forces_of_part::<L>(law, part, metrics, given, places, residual);
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_avx2(
    law: &ContinuumLaw,
    metrics: &[Lane],
    given: Option<Given<'_>>,
    places: &[Lane],
    residual: &mut [Lane],
) {
    add_forces::<palpate_geometry::math::lanes::Wide>(law, metrics, given, places, residual);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_of_some_avx2(
    law: &ContinuumLaw,
    parts: (&[u32], u32),
    metrics: &[Lane],
    given: Option<Given<'_>>,
    places: &[Lane],
    residual: &mut [Lane],
) {
    use palpate_geometry::math::lanes::Wide;
    add_forces_of_some::<Wide>(law, parts, metrics, given, places, residual);
}

fn check(grid: &CellGrid, elastic: &[Elastic]) -> Result<(), ContinuumError> {
    let total = grid.cells.len();
    if elastic.len() != total {
        return Err(ContinuumError::Count {
            materials: elastic.len(),
            cells: total,
        });
    }
    for (cell, &Elastic { young_pa, poisson }) in elastic.iter().enumerate() {
        if !(young_pa.is_finite() && young_pa > 0.0 && (0.0..0.5).contains(&poisson)) {
            return Err(ContinuumError::Material {
                cell,
                young_pa,
                poisson,
            });
        }
    }
    let (mut count, mut worst, mut quality) = (0, 0, f64::INFINITY);
    for (k, cell) in grid.cells.iter().enumerate() {
        if let Some(value) = too_distorted(grid, cell) {
            count += 1;
            if value <= quality {
                (worst, quality) = (k, value);
            }
        }
    }
    if count > 0 {
        Err(ContinuumError::Distorted {
            count,
            total,
            worst,
            quality,
        })
    } else {
        Ok(())
    }
}

/// The quality of a cell that is refused for it.
fn too_distorted(grid: &CellGrid, cell: &Cell) -> Option<f64> {
    let [jacobian, evenness] = quality(grid, cell);
    if evenness <= LEAST_EVENNESS {
        Some(jacobian.min(evenness))
    } else {
        (jacobian < LEAST_SCALED_JACOBIAN).then_some(jacobian)
    }
}

/// Least scaled Jacobian and least share of the volume of a cell; positions that are not numbers give the worst.
fn quality(grid: &CellGrid, cell: &Cell) -> [f64; 2] {
    let known = |x: f64| if x.is_nan() { f64::NEG_INFINITY } else { x };
    let rest = RestShape::new(&grid.nodes, cell);
    let jacobian = rest::scaled_jacobian(&grid.nodes, cell, rest.volume).unwrap_or(1.0);
    [known(jacobian), known(rest.evenness)]
}

/// How good a cell is, relative to the least that [`ContinuumLaw::new`] takes: below 1 it is refused.
pub(in crate::body) fn worth(grid: &CellGrid, cell: &Cell) -> f64 {
    let [jacobian, evenness] = quality(grid, cell);
    (jacobian / LEAST_SCALED_JACOBIAN).min(evenness / LEAST_EVENNESS)
}

/// How many cells [`ContinuumLaw::new`] would refuse.
pub(crate) fn refused_cells(grid: &CellGrid) -> usize {
    let refused = |cell: &&Cell| too_distorted(grid, cell).is_some();
    grid.cells.iter().filter(refused).count()
}
