//! Models `lattice` and `continuum`, whole or reduced: point masses at the nodes of cells, with
//! springs along their edges and face diagonals, or with the energy of an elastic solid in them.

use super::cells::{Cell, CellGrid};
use super::deformable::Deformable;
use super::elements::MaterialLaw;
use super::elements::continuum::{ContinuumError, ContinuumLaw, Elastic, VolumeBarrier};
use super::elements::springs::{MODULI, Spring, SpringLaw, springs_of_cells};
use super::material::Material;
use super::matter::{Blueprint, Grain};
use super::node_map::NodeMap;
use super::settings::{DeformableError, StepSettings};
use palpate_geometry::math::Point3;

/// What acts between the nodes of cells.
#[derive(Clone, Copy, Debug)]
pub enum Inside {
    /// Springs between nodes.
    Springs,
    /// Springs by a law that a caller brings.
    SpringsBy(&'static dyn SpringLaw),
    /// Stable neo-Hookean solid.
    Continuum,
    /// The same, for nodes that few smooth coordinates move.
    SmoothContinuum,
    /// An elastic solid in cells much longer than thick, most of its energy at their centres: with all of it
    /// at Gauss points, such cells lock in bending.
    FlatContinuum,
    /// The energy that springs stand for in cubes, in such cells: springs across them have no stiffness
    /// against shear.
    FlatSprings,
}

/// ν of springs.
const SPRINGS_POISSON: f64 = 0.25;

/// Share of a flat cell's energy that is taken at its Gauss points: bending a cell of length l in a plate
/// of thickness t costs ½ (l / t)² of that too much, and shapes without any other energy are held.
const SHARE_AT_POINTS: f64 = 0.02;

/// A solid to be built.
pub struct Solid<'a, M: Fn(usize) -> Material> {
    /// Its cells.
    pub grid: &'a CellGrid,
    /// Nodes from coordinates.
    pub map: NodeMap,
    /// (cells): as [`Reduced::patch_of_cell`](super::net::Reduced::patch_of_cell).
    pub patch_of_cell: &'a [u32],
    /// (coordinates), m, at rest.
    pub coordinates: Vec<Point3>,
    /// (control points).
    pub coordinate_of_control: Vec<u32>,
    /// (coordinates): never move.
    pub fixed: Vec<bool>,
    /// Volume that the surface encloses, m³ (the control polyhedron is larger): it sets the mass.
    pub enclosed_volume_m3: f64,
    /// What acts between nodes.
    pub inside: Inside,
    /// What each cell is made of.
    pub material: M,
    /// (cells): how much stiffer it is than that; empty where none is.
    pub firmness: &'a [f64],
}

/// Share of the mean volume below which a cell whose nodes have run together is a sliver.
const SLIVER: f64 = 0.05;
/// Largest ratio of Poisson of a sliver. Around a pole there are more volumes to keep than nodes to move: nearly
/// incompressible they jam, and turn over where the body swings (the tip of a teardrop at ν = 0.499).
const OF_SLIVERS: f64 = 0.45;

impl<'a, M: Fn(usize) -> Material> Solid<'a, M> {
    /// A solid whose nodes are its coordinates.
    pub fn whole(
        grid: &'a CellGrid,
        fixed: &[bool],
        enclosed_volume_m3: f64,
        inside: Inside,
        material: M,
    ) -> Self {
        Self {
            grid,
            map: NodeMap::Same,
            patch_of_cell: &[],
            coordinates: grid.nodes.clone(),
            coordinate_of_control: grid.node_of_control.clone(),
            fixed: fixed.to_vec(),
            enclosed_volume_m3,
            inside,
            material,
            firmness: &[],
        }
    }

    /// Builds it. Damping, flow and stiffening are the body's, `common`'s.
    ///
    /// # Errors
    /// Cells without volume or too distorted, no free coordinate, or a step that cannot be built.
    pub fn build(
        self,
        common: &Material,
        settings: StepSettings,
    ) -> Result<Deformable, DeformableError> {
        let Self {
            grid,
            map,
            patch_of_cell,
            coordinates,
            coordinate_of_control,
            fixed,
            enclosed_volume_m3,
            inside,
            material,
            firmness,
        } = self;
        let masses = cell_masses(
            grid,
            |cell| material(cell).density_kg_m3,
            enclosed_volume_m3,
        )?;
        let elastic = |cell| Elastic {
            young_pa: material(cell).young_pa,
            poisson: material(cell).poisson,
        };
        let quality = grid.quality();
        let firm = |cell| Elastic {
            young_pa: material(cell).young_pa * firmness.get(cell).copied().unwrap_or(1.0),
            ..elastic(cell)
        };
        let of_cells = || -> Vec<Elastic> { (0..grid.cells.len()).map(firm).collect() };
        let firm_pa = |cell| firm(cell).young_pa;
        let of = |springs: &[Spring]| {
            let law = MaterialLaw::springs(springs, common.stiffening);
            law.with_barrier(VolumeBarrier::new(&grid.nodes, &grid.cells, firm_pa))
        };
        let of_springs = || of(&springs_of_cells(grid, firm_pa, MODULI));
        let law = match inside {
            Inside::Springs => of_springs(),
            Inside::SpringsBy(law) => of(&law.springs(grid, &firm_pa)),
            Inside::Continuum => {
                let mut of_cells = of_cells();
                soften_slivers(grid, &mut of_cells);
                MaterialLaw::continuum(ContinuumLaw::new(grid, &of_cells)?)
            }
            Inside::FlatContinuum => flat_continuum(grid, &of_cells())?,
            Inside::FlatSprings => {
                let like_springs = |of: Elastic| Elastic {
                    poisson: SPRINGS_POISSON,
                    ..of
                };
                let of_cells: Vec<Elastic> = of_cells().into_iter().map(like_springs).collect();
                // Springs live with cells that no energy does.
                flat_continuum(grid, &of_cells).unwrap_or_else(|_| of_springs())
            }
            // Smooth coordinates leave cells no motion without energy: one point a cell is enough.
            Inside::SmoothContinuum => {
                MaterialLaw::continuum(ContinuumLaw::in_patches(grid, &of_cells(), patch_of_cell)?)
            }
        };
        let grains = grains(grid, &map, coordinates.len(), elastic);
        let blueprint = Blueprint {
            coordinates,
            map,
            masses,
            law,
            coordinate_of_control,
            fixed,
            quality,
            cells: grid.cells.clone(),
            young_pa: (0..grid.cells.len())
                .map(|cell| material(cell).young_pa)
                .collect(),
            grains,
        };
        Deformable::new(blueprint, common.damping_s, common.plastic, settings)
    }
}

/// Leaves slivers, small cells at a pole, a ratio of Poisson that they can keep.
fn soften_slivers(grid: &CellGrid, elastic: &mut [Elastic]) {
    let volumes: Vec<f64> = grid.cells.iter().map(|cell| grid.volume(cell)).collect();
    let mean_m3 = volumes.iter().sum::<f64>() / volumes.len() as f64;
    let runs_together = |cell: &Cell| (1..8).any(|k| cell[..k].contains(&cell[k]));
    for ((cell, volume_m3), elastic) in grid.cells.iter().zip(volumes).zip(elastic) {
        if volume_m3 < SLIVER * mean_m3 && runs_together(cell) {
            elastic.poisson = elastic.poisson.min(OF_SLIVERS);
        }
    }
}

/// What each coordinate stands for: an eighth of the cells of each of its nodes.
fn grains(
    grid: &CellGrid,
    map: &NodeMap,
    coordinates: usize,
    elastic: impl Fn(usize) -> Elastic,
) -> Vec<Grain> {
    // Volumes, and moduli and ratios times volumes.
    let mut sums = [(); 3].map(|()| vec![0.0; grid.nodes.len()]);
    for (c, cell) in grid.cells.iter().enumerate() {
        let Elastic { young_pa, poisson } = elastic(c);
        let share = grid.volume(cell) / 8.0;
        for &node in cell {
            let parts = [1.0, young_pa / (1.0 - poisson * poisson), poisson];
            for (sum, part) in sums.iter_mut().zip(parts) {
                sum[node as usize] += share * part;
            }
        }
    }
    let [volumes, moduli, ratios] = sums.map(|of_nodes| map.lumped(&of_nodes, coordinates));
    let grain = |c: usize| Grain {
        volume_m3: volumes[c],
        plane_modulus_pa: moduli[c] / volumes[c],
        poisson: ratios[c] / volumes[c],
    };
    (0..coordinates).map(grain).collect()
}

/// Most of the energy at the centres of the cells, a share at their Gauss points.
fn flat_continuum(grid: &CellGrid, elastic: &[Elastic]) -> Result<MaterialLaw, ContinuumError> {
    let part = |share: f64| -> Vec<Elastic> {
        let of = |of: &Elastic| Elastic {
            young_pa: share * of.young_pa,
            ..*of
        };
        elastic.iter().map(of).collect()
    };
    Ok(MaterialLaw::flat_continuum(
        ContinuumLaw::at_centres(grid, &part(1.0 - SHARE_AT_POINTS))?,
        ContinuumLaw::new(grid, &part(SHARE_AT_POINTS))?,
    ))
}

/// Masses of nodes, kg: an eighth of each cell's for each of its corners, scaled so that the whole
/// fills the enclosed volume.
pub(super) fn cell_masses(
    grid: &CellGrid,
    density_kg_m3: impl Fn(usize) -> f64,
    enclosed_volume_m3: f64,
) -> Result<Vec<f64>, DeformableError> {
    let volumes: Vec<f64> = grid.cells.iter().map(|cell| grid.volume(cell)).collect();
    let whole: f64 = volumes.iter().sum();
    let mean = whole / volumes.len() as f64;
    let flat = volumes
        .iter()
        .filter(|&volume| volume.is_nan() || *volume <= 1e-9 * mean)
        .count();
    if flat > 0 {
        return Err(DeformableError::FlatCells {
            count: flat,
            total: volumes.len(),
        });
    }
    let mut masses = vec![0.0; grid.nodes.len()];
    for (c, (cell, volume)) in grid.cells.iter().zip(&volumes).enumerate() {
        let share = volume * (density_kg_m3(c) * enclosed_volume_m3 / whole) / 8.0;
        for &node in cell {
            masses[node as usize] += share;
        }
    }
    Ok(masses)
}
