//! Internal forces of a body: what its model is made of, and nothing else.

use super::bends::Bend;
use super::continuum::ContinuumLaw;
use super::material::Stiffening;
use super::spring_table::{ByCoordinate, SpringTable};
use super::springs::Spring;
use palpate_geometry::math::{Lane, Point3};

/// Springs, bends for membranes, or a continuum energy.
#[derive(Debug, Default)]
pub struct MaterialLaw {
    pub(super) springs: SpringTable,
    pub(super) bends: Vec<Bend>,
    pub(super) continuum: Option<ContinuumLaw>,
    /// Greatest slope of the springs, relative to that at rest.
    slope: f64,
}

impl MaterialLaw {
    /// Springs of a solid.
    pub fn springs(springs: &[Spring], stiffening: Option<Stiffening>) -> Self {
        Self::membrane(springs, stiffening, Vec::new())
    }

    /// Springs and bends of a sheet.
    pub fn membrane(springs: &[Spring], stiffening: Option<Stiffening>, bends: Vec<Bend>) -> Self {
        let slope = stiffening.map_or(1.0, |law| law.greatest_ratio());
        Self {
            springs: SpringTable::new(springs, stiffening),
            bends,
            continuum: None,
            slope,
        }
    }

    /// A continuum energy.
    pub fn continuum(continuum: ContinuumLaw) -> Self {
        Self {
            continuum: Some(continuum),
            slope: 1.0,
            ..Self::default()
        }
    }

    /// Edges (a, b, k) of the Laplacian of the step's matrix. The step is stable while its matrix
    /// is at least half of the tangent; stiffening springs count with their steepest slope's half,
    /// if that is more than their slope at rest.
    pub(super) fn edges(&self) -> Vec<(u32, u32, f64)> {
        let scale = (0.55 * self.slope).max(1.0);
        let springs = self
            .springs
            .each()
            .map(|(_, _, a, b, k)| (a as u32, b as u32, k * scale));
        let continuum = self
            .continuum
            .iter()
            .flat_map(ContinuumLaw::bounding_springs);
        springs
            .chain(self.bends.iter().flat_map(Bend::edges))
            .chain(continuum)
            .collect()
    }

    /// Edges of a Laplacian that is no less than any tangent: what explicit steps must resolve.
    pub(super) fn steepest_edges(&self) -> Vec<(u32, u32, f64)> {
        let springs = self
            .springs
            .each()
            .map(|(_, _, a, b, k)| (a as u32, b as u32, k * self.slope));
        // Its step follows tangents up to twice its own matrix.
        let continuum = self
            .continuum
            .iter()
            .flat_map(ContinuumLaw::bounding_springs)
            .map(|(a, b, k)| (a, b, 2.0 * k));
        springs
            .chain(self.bends.iter().flat_map(Bend::edges))
            .chain(continuum)
            .collect()
    }

    /// True without bends and without stiffening.
    pub(super) fn is_plain_springs(&self) -> bool {
        self.continuum.is_none() && self.bends.is_empty() && self.slope == 1.0
    }

    /// Adds −∂E/∂x, N. `rest`: lengths of the springs without force. Answers with the number of
    /// cells that were held back.
    pub(super) fn add_forces(
        &self,
        rest: &[Lane],
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) -> u32 {
        self.springs.add_forces(rest, places, residual, buffers);
        for bend in &self.bends {
            bend.add_force(places, residual);
        }
        self.continuum.as_ref().map_or(0, |continuum| {
            continuum.add_forces(places, residual).limited
        })
    }

    /// Elastic energy, J.
    pub(super) fn energy_j(&self, rest: &[Lane], places: &[Lane]) -> f64 {
        let at = |k: usize| Point3::new(places[k][0], places[k][1], places[k][2]);
        let continuum = self
            .continuum
            .as_ref()
            .map_or(0.0, |continuum| continuum.energy_j(places));
        let bends: f64 = self.bends.iter().map(|bend| bend.energy_j(places)).sum();
        self.springs.energy_j(rest, at) + bends + continuum
    }
}
