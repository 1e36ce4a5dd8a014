//! Model `lattice`: point masses at the nodes of cells, springs along their edges and face diagonals.

use super::cells::CellGrid;
use super::deformable::{Blueprint, Deformable, DeformableError, StepSettings};
use super::law::Law;
use super::material::Material;
use super::node_map::NodeMap;
use super::springs::{self, SpringRule};

/// Builds a lattice. `material(cell)`: what each cell is made of; damping, flow and stiffening are the body's, `common`'s.
/// `enclosed_volume_m3` is the surface's own volume (the control polyhedron is larger): it sets the mass.
/// `fixed[node]` nodes never move.
///
/// # Errors
/// Cells without volume, no free node, or a step that cannot be built.
pub fn lattice(
    grid: &CellGrid,
    common: &Material,
    material: impl Fn(usize) -> Material,
    enclosed_volume_m3: f64,
    fixed: &[bool],
    rule: SpringRule,
    settings: StepSettings,
) -> Result<Deformable, DeformableError> {
    let masses = cell_masses(grid, |cell| material(cell).density_kg_m3, enclosed_volume_m3)?;
    let springs = springs::from_cells(grid, |cell| material(cell).young_pa, rule);
    let blueprint = Blueprint {
        coordinates: grid.nodes.clone(),
        map: NodeMap::Same,
        masses,
        law: Law::springs(&springs, common.stiffening),
        coordinate_of_control: grid.node_of_control.clone(),
        fixed: fixed.to_vec(),
        quality: grid.quality(),
    };
    Deformable::new(blueprint, common.damping_s, common.plastic, settings)
}

/// Masses of nodes, kg: an eighth of each cell's for each of its corners, scaled so that the whole fills the enclosed volume.
pub(super) fn cell_masses(
    grid: &CellGrid,
    density_kg_m3: impl Fn(usize) -> f64,
    enclosed_volume_m3: f64,
) -> Result<Vec<f64>, DeformableError> {
    let volumes: Vec<f64> = grid.cells.iter().map(|cell| grid.volume(cell)).collect();
    let whole: f64 = volumes.iter().sum();
    let mean = whole / volumes.len() as f64;
    let flat = volumes.iter().filter(|&&volume| !(volume > 1e-9 * mean)).count();
    if flat > 0 {
        return Err(DeformableError::FlatCells { count: flat, total: volumes.len() });
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
