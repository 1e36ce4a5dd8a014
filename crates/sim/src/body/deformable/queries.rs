//! What others ask of a body: forces, energy, counts. Nothing here moves it.

use super::{Deformable, FIXED, Stepper, lanes};
use crate::body::cells::CellQuality;
use crate::body::node_map::NodeMap;
use crate::body::state::{DeformableScratch, DeformableState};
use palpate_geometry::math::{Lane, Point3, Vector3};

impl Deformable {
    /// Forces of the law on the coordinates at a state, N (x, y, z, 0).
    pub fn internal_forces<'a>(
        &self,
        state: &DeformableState,
        scratch: &'a mut DeformableScratch,
    ) -> &'a [Lane] {
        lanes(&state.positions, &mut scratch.coordinates);
        scratch.residual.fill([0.0; 4]);
        self.matter.add_law_forces(state, scratch);
        &scratch.residual
    }

    /// Kinetic plus elastic energy, J.
    pub fn energy_j(&self, state: &DeformableState) -> f64 {
        let kinetic: f64 = self
            .matter
            .masses
            .iter()
            .zip(&state.velocities)
            .map(|(m, v)| 0.5 * m * v.norm_squared())
            .sum();
        let places: Vec<Lane> = self
            .nodes(&state.positions)
            .iter()
            .map(|p| [p.x, p.y, p.z, 0.0])
            .collect();
        kinetic
            + self
                .matter
                .law
                .energy_j(self.matter.rest_lengths(state), &places)
    }

    /// Sum of the law's forces on the fixed coordinates, N: the reaction of the base.
    pub fn base_reaction_n(&self, state: &DeformableState) -> Vector3 {
        let mut scratch = self.scratch();
        let forces = self.internal_forces(state, &mut scratch);
        let fixed = (0..self.matter.rest.len()).filter(|&c| self.matter.unknown[c] == FIXED);
        fixed
            .map(|c| Vector3::from_column_slice(&forces[c][..3]))
            .sum()
    }

    /// Nodes of coordinates.
    pub fn nodes(&self, coordinates: &[Point3]) -> Vec<Point3> {
        self.matter.map.nodes(coordinates)
    }

    /// Number of coordinates.
    pub fn coordinate_count(&self) -> usize {
        self.matter.rest.len()
    }

    /// Nodes that carry the law.
    pub fn node_count(&self) -> usize {
        match &self.matter.map {
            NodeMap::Same => self.matter.rest.len(),
            NodeMap::Sparse(map) => map.rows(),
        }
    }

    /// Coordinates that can move.
    pub fn unknown_count(&self) -> usize {
        self.matter.unknown_count()
    }

    /// Cells with a continuum energy.
    pub fn cell_count(&self) -> usize {
        self.matter
            .law
            .continuum
            .as_ref()
            .map_or(0, |continuum| continuum.cell_count())
    }

    /// Cells that the last pass held back, as their tangent passed what the step can follow.
    pub fn limited(&self, scratch: &DeformableScratch) -> u32 {
        scratch.limited
    }

    /// Number of springs.
    pub fn spring_count(&self) -> usize {
        self.matter.law.springs.len()
    }

    /// Non-zeros of the factor; 0 for methods without one.
    pub fn factor_non_zeros(&self) -> usize {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.factor_non_zeros(),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => 0,
        }
    }

    /// Iterations of an implicit step; 1 for other methods.
    pub fn iterations(&self) -> usize {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.iterations(),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => 1,
        }
    }

    /// Iterations or substeps of a step, and the name of the method.
    pub fn integration(&self) -> (&'static str, usize) {
        match &self.stepper {
            Stepper::Implicit(implicit) => ("implicit", implicit.iterations()),
            Stepper::Explicit(explicit) => ("explicit", explicit.substeps()),
            Stepper::Xpbd(xpbd) => ("xpbd", xpbd.substeps()),
        }
    }

    /// Bytes of the compliance columns.
    pub fn compliance_bytes(&self) -> usize {
        (self.compliance.response.columns.len() + self.compliance.response.bounding.len())
            * size_of::<f64>()
    }

    /// Quality of the cells.
    pub fn quality(&self) -> &CellQuality {
        &self.matter.quality
    }

    /// Total mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.matter.masses.iter().sum()
    }

    /// Mass of each coordinate, kg.
    pub fn masses(&self) -> &[f64] {
        &self.matter.masses
    }

    /// dt of the body, s.
    pub fn dt_s(&self) -> f64 {
        self.matter.settings.dt_s
    }
}
