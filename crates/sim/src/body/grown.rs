//! How far cells have come from where a matrix was made.

use super::elements::continuum::{areas_squared, inverses, squares_at_centre};
use super::matter::Matter;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3};
use std::ops::Range;

/// Steps in which all cells are looked at once.
pub(super) const ROUND: usize = 4;

/// Cells of a solid where a matrix was made.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// (corner, cell) of four cells.
    nodes: Vec<[[u32; 4]; 8]>,
    /// J⁻¹ J⁻ᵀ at the centres, 1/m².
    metrics: Vec<[Four; 6]>,
    /// Of what flows: inverses of its metrics, m².
    flowed: Vec<[Four; 6]>,
    /// (rounds): nodes of the cells that are looked at in it.
    pub rounds: [Vec<u32>; ROUND],
}

impl Cells {
    /// At `places` (nodes), with `metrics` of what flows.
    pub fn at(matter: &Matter, places: &[Lane], metrics: &[Lane]) -> Self {
        let mut all = Self {
            flowed: metrics.as_chunks().0.iter().map(inverses).collect(),
            ..Self::default()
        };
        for four in matter.cells.chunks(4) {
            let mut nodes = four[0].map(|node| [node; 4]);
            for (k, cell) in four.iter().enumerate() {
                for corner in 0..8 {
                    nodes[corner][k] = cell[corner];
                }
            }
            all.metrics
                .push(inverses(&squares_at_centre(&nodes, places)));
            all.nodes.push(nodes);
        }
        for round in 0..ROUND {
            let nodes = all.nodes[all.round(round)].as_flattened().as_flattened();
            let mut nodes = nodes.to_vec();
            nodes.sort_unstable();
            nodes.dedup();
            all.rounds[round] = nodes;
        }
        all
    }

    /// Number of blocks of four cells.
    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Cells that are looked at in a round.
    pub fn round(&self, round: usize) -> Range<usize> {
        let end = |round: usize| round * self.nodes.len() / ROUND;
        end(round)..end(round + 1)
    }

    /// The most that an area of some of the cells has grown by since, at `places` (nodes), as a factor, or a little more.
    pub fn grown(&self, places: &[Lane], cells: Range<usize>) -> f64 {
        let mut most = 0.0_f64;
        let cells = self.nodes[cells.clone()].iter().zip(&self.metrics[cells]);
        for (nodes, metric) in cells {
            let mut squares = [0.0; 4];
            areas_squared::<Baseline>(nodes, metric, places).store(&mut squares);
            // What is not a number is no reason for a matrix.
            most = squares.into_iter().fold(most, f64::max);
        }
        most.sqrt()
    }
}

/// The most that a stiffness has grown by since, as a factor, or a little more: of every [`ROUND`]-th of `metrics` from
/// `first` on, the largest eigenvalue of S S₀⁻¹.
pub(super) fn stiffened(made: &Cells, metrics: &[Lane], first: usize) -> f64 {
    let mut most = 0.0_f64;
    let points = metrics.as_chunks().0.iter().zip(&made.flowed);
    for (now, inverse) in points.skip(first).step_by(ROUND) {
        for k in 0..4 {
            let of = |[xx, yy, zz, xy, xz, yz]: [f64; 6]| {
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            };
            let grown = of(now.map(|row: Four| row[k])) * of(inverse.map(|row| row[k]));
            // Its eigenvalues are real: at most m + 2 p, m their mean and 6 p² the sum of the squares of what is left.
            let mean = grown.trace() / 3.0;
            let squares = (grown * grown).trace() - 3.0 * mean * mean;
            most = most.max(mean + (squares.max(0.0) * 2.0 / 3.0).sqrt());
        }
    }
    most
}
