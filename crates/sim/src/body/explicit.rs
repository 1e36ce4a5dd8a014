//! Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as its stability needs.
//!
//! With the greatest frequency ω and the damping time d, a substep h is stable while h² ω² + 2 h d
//! ω² ≤ 4.

use super::implicit::{add_edges, greatest_frequency_squared};
use super::matter::{Matter, lanes};
use super::node_map::NodeMap;
use super::settings::DeformableError;
use super::state::{DeformableScratch, DeformableState};
use palpate_geometry::math::{Lane, Vector3};

/// Most substeps of a step.
pub(super) const MOST_SUBSTEPS: usize = 20_000;
/// Share of the stable substep that is taken.
const SAFETY: f64 = 0.9;

/// Constants of the method.
#[derive(Debug)]
pub(super) struct Explicit {
    substeps: usize,
    /// Edges that damp, k d.
    damping: Vec<(u32, u32, f64)>,
}

impl Explicit {
    pub(super) fn new(matter: &Matter, at_least: usize) -> Result<Self, DeformableError> {
        let (dt, d) = (matter.settings.dt_s, matter.damping_s);
        let squared = greatest_frequency_squared(matter);
        let stable = (d * d + 4.0 / squared).sqrt() - d;
        let needed = (dt / (SAFETY * stable)).ceil();
        if needed.is_nan() || needed > MOST_SUBSTEPS as f64 {
            return Err(DeformableError::Substeps {
                needed: needed as usize,
                most: MOST_SUBSTEPS,
            });
        }
        let damping = if d > 0.0 {
            matter.law_edges()
        } else {
            Vec::new()
        };
        let damping = damping.into_iter().map(|(a, b, k)| (a, b, k * d)).collect();
        Ok(Self {
            substeps: at_least.max(needed as usize).max(1),
            damping,
        })
    }

    pub(super) fn substeps(&self) -> usize {
        self.substeps
    }

    /// A step from `state` with the scratch's forces, into its `predicted` and `speed`.
    pub(super) fn run(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let h = matter.settings.dt_s / self.substeps as f64;
        scratch.predicted.copy_from_slice(&state.positions);
        scratch.speed.copy_from_slice(&state.velocities);
        for _ in 0..self.substeps {
            for (load, force) in scratch.residual.iter_mut().zip(&scratch.forces) {
                *load = [force.x, force.y, force.z, 0.0];
            }
            self.add_damping(matter, scratch);
            lanes(&scratch.predicted, &mut scratch.coordinates);
            matter.add_law_forces(state, scratch);
            for &c in &matter.coordinate_of_unknown {
                let c = c as usize;
                let force = Vector3::from_column_slice(&scratch.residual[c][..3]);
                let felt = scratch.field.at(&scratch.predicted[c], &scratch.speed[c]);
                scratch.speed[c] += (force / matter.masses[c] + felt) * h;
                scratch.predicted[c] += scratch.speed[c] * h;
            }
        }
    }

    fn add_damping(&self, matter: &Matter, scratch: &mut DeformableScratch) {
        if self.damping.is_empty() {
            return;
        }
        let DeformableScratch {
            speed,
            coordinates,
            nodes,
            residual,
            node_residual,
            ..
        } = scratch;
        for (lane, v) in coordinates.iter_mut().zip(speed.iter()) {
            *lane = [v.x, v.y, v.z, 0.0];
        }
        match &matter.map {
            NodeMap::Same => add_edges(&self.damping, coordinates, residual),
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                node_residual.fill([0.0; 4]);
                add_edges(&self.damping, nodes, node_residual);
                let forces: &[Lane] = node_residual;
                map.add_transposed(forces, residual);
            }
        }
    }
}
