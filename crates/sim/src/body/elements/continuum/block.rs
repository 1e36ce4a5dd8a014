//! Four cells at rest, side by side in lanes.

use super::elastic::Elastic;
use super::kernel::{self, CellBlock, ROWS};
use super::rest::RestCell;
use crate::body::cells::Cell;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Point3};

/// Metrics of a block at its N points: its own, or those of the cells that flow. `None` for too few.
#[inline(always)]
pub(super) fn metrics_of<'a, const N: usize>(
    block: &'a CellBlock,
    metrics: &'a [Lane],
    index: usize,
) -> Option<&'a [[Four; 6]; N]> {
    if metrics.is_empty() {
        return block.metric.first_chunk();
    }
    let (rows, _) = metrics.as_chunks::<{ ROWS }>();
    rows.get(N * index..)?.first_chunk()
}

pub(super) fn energy(block: &CellBlock, metrics: &[[Four; 6]; 8], places: &[Lane]) -> Four {
    let c = kernel::modes::<Baseline>(&block.nodes, places);
    let slopes = kernel::slopes(&c);
    let mut energy = [0.0; 4];
    for gauss in 0..8 {
        let [i, j, k] = kernel::at(gauss);
        let (_, lanes) =
            kernel::stretch(&metrics[gauss], [slopes[0][i], slopes[1][j], slopes[2][k]]);
        let mut invariant = [0.0; 4];
        lanes.store(&mut invariant);
        for cell in 0..4 {
            let strain = invariant[cell] - 3.0;
            energy[cell] +=
                0.5 * block.stiffness_j[gauss][cell] * (strain - libm::log1p(0.25 * strain));
        }
    }
    let mut volume = [0.0; 4];
    kernel::volume(&c).1.store(&mut volume);
    for cell in 0..4 {
        let grown = volume[cell] * block.per_volume[cell] - 1.0;
        let at_rest = block.winding[cell] / block.per_volume[cell];
        energy[cell] +=
            at_rest * (0.5 * block.bulk_pa[cell] * grown - block.shear_pa[cell]) * grown;
    }
    energy
}

/// V, m³, by cell.
pub(super) fn volumes(block: &CellBlock, places: &[Lane]) -> Four {
    let mut volumes = [0.0; 4];
    let c = kernel::modes::<Baseline>(&block.nodes, places);
    kernel::volume(&c).1.store(&mut volumes);
    volumes
}

/// Up to four cells. The places of missing ones are those of the first, their stiffness is zero.
pub(super) fn block(nodes: &[Point3], cells: &[Cell], materials: &[Elastic]) -> CellBlock {
    debug_assert!(
        cells.len() == materials.len() && (1..=4).contains(&cells.len()),
        "up to four cells"
    );
    let mut block = CellBlock {
        count: cells.len(),
        metric: [[[0.0; 4]; 6]; 8],
        stiffness_j: [[0.0; 4]; 8],
        nodes: cells[0].map(|node| [node; 4]),
        per_volume: [1.0; 4],
        winding: [1.0; 4],
        bulk_pa: [0.0; 4],
        per_bulk: [0.0; 4],
        shear_pa: [0.0; 4],
    };
    for (k, (cell, elastic)) in cells.iter().zip(materials).enumerate() {
        let rest = RestCell::new(nodes, cell);
        let (shear, lame) = elastic.lame_pa();
        for corner in 0..8 {
            block.nodes[corner][k] = cell[corner];
        }
        for gauss in 0..8 {
            for (row, value) in kernel::rows_of(&rest.metrics[gauss])
                .into_iter()
                .enumerate()
            {
                block.metric[gauss][row][k] = value;
            }
            block.stiffness_j[gauss][k] = 4.0 / 3.0 * shear * rest.weights[gauss];
        }
        block.per_volume[k] = 1.0 / rest.volume;
        block.winding[k] = rest.volume.signum();
        block.bulk_pa[k] = lame + 5.0 / 6.0 * shear;
        block.per_bulk[k] = 1.0 / block.bulk_pa[k];
        block.shear_pa[k] = shear;
    }
    block
}
