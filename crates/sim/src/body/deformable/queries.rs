//! What others ask of a body: forces, energy, counts. Nothing here moves it.

use super::{Deformable, FIXED, Stepper, lanes};
use crate::body::cells::{Cell, CellQuality};
use crate::body::field::Field;
use crate::body::matter::Grain;
use crate::body::node_map::NodeMap;
use crate::body::scratch::DeformableScratch;
use crate::body::settings::FallBack;
use crate::body::state::DeformableState;
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

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

    /// What a step from one state to the other leaves of its own equation, backward Euler, N by coordinate:
    /// forces of field, law and contact less M (z − y)/dt²; zero of fixed coordinates.
    /// `None` where the step slept or has no such equation.
    pub fn residual(
        &self,
        before: &DeformableState,
        after: &DeformableState,
        field: Field,
    ) -> Option<Vec<Vector3>> {
        debug_assert_eq!(
            before.positions.len(),
            after.positions.len(),
            "two states of one body"
        );
        let Stepper::Implicit(implicit) = &self.stepper else {
            return None;
        };
        if self.asleep(before) && after.positions == before.positions {
            return None;
        }
        let mut scratch = self.scratch();
        self.set_field(&mut scratch, field);
        self.begin(implicit, before, &mut scratch);
        scratch.reached.copy_from_slice(&after.positions);
        let forces = self.matter.surface.iter().zip(&after.contact_n);
        scratch.carried = forces.map(|(&c, &force)| (c, force)).collect();
        scratch.implicit.pressures.copy_from_slice(&after.pressures);
        implicit.weigh(&self.matter, before, &mut scratch);
        let left = scratch.residual.iter().enumerate();
        let left = left.map(|(c, lane)| match self.unknown(c) {
            Some(_) => Vector3::new(lane[0], lane[1], lane[2]),
            None => Vector3::zeros(),
        });
        Some(left.collect())
    }

    /// What free points feel in the step that the scratch stands for.
    pub fn field(&self, scratch: &DeformableScratch) -> Field {
        scratch.field
    }

    /// The fall-back of the step that the scratch stands for, if one acts; none while the body sleeps.
    pub fn fall_back(&self, scratch: &DeformableScratch) -> Option<FallBack> {
        if scratch.at_rest {
            return None;
        }
        if scratch.shortened {
            return Some(FallBack::Shortened);
        }
        if scratch.before.halved {
            return Some(FallBack::Halved);
        }
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.fall_back(&scratch.implicit),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => None,
        }
    }

    /// Kinetic plus elastic energy, J.
    pub fn energy_j(&self, state: &DeformableState) -> f64 {
        debug_assert_eq!(
            state.positions.len(),
            self.coordinate_count(),
            "a state of another body"
        );
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
        debug_assert_eq!(
            coordinates.len(),
            self.coordinate_count(),
            "a place a coordinate"
        );
        self.matter.map.nodes(coordinates)
    }

    /// Coordinates at rest, m.
    pub fn rest(&self) -> &[Point3] {
        &self.matter.rest
    }

    /// Cells of a solid, by the numbers of their nodes; none of a membrane.
    pub fn cells(&self) -> &[Cell] {
        &self.matter.cells
    }

    /// (cells): Young's modulus, Pa.
    pub fn young_pa(&self) -> &[f64] {
        &self.matter.young_pa
    }

    /// Volume and stiffness of the solid around a coordinate; `None` for membranes and nets.
    pub fn grain(&self, coordinate: usize) -> Option<Grain> {
        self.matter.grains.get(coordinate).copied()
    }

    /// How much stiffer damping makes it within a step.
    pub fn voigt(&self) -> f64 {
        self.matter.voigt()
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

    /// Number of springs.
    pub fn spring_count(&self) -> usize {
        self.matter.law.springs.len()
    }

    /// Non-zeros of the factor; 0 for methods without one.
    pub fn factor_non_zeros(&self) -> usize {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.factor().non_zeros(),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => 0,
        }
    }

    /// Bits of most numbers of the factor; 0 for methods without one.
    pub fn factor_bits(&self) -> u32 {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.factor().bits(),
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

    /// Matrix of an implicit step: `tangent` or `bounding`.
    pub fn step_matrix(&self) -> Option<&'static str> {
        match &self.stepper {
            Stepper::Implicit(implicit) => Some(implicit.matrix_name()),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => None,
        }
    }

    /// How far a step of so many iterations takes the body from where the converged step takes it, in
    /// a tenth of a second after a blow that shears and stretches it: rms by mass over that time,
    /// relative to the motion. Small amplitudes, no contact, no gravity.
    pub fn motion_error(&self, iterations: usize) -> f64 {
        /// Iterations of a step that counts as converged.
        const CONVERGED: usize = 20;
        /// The blow's greatest displacement in a step, of the size of the body.
        const BLOW: f64 = 1e-4;
        let steps = (0.1 / self.dt_s()).ceil().clamp(1.0, 200.0) as usize;
        let rest = self.rest_state();
        let free: Vec<usize> = (rest.positions.iter().enumerate())
            .map(|(c, _)| c)
            .filter(|&c| self.unknown(c).is_some())
            .collect();
        let mean: Vector3 = free.iter().map(|&c| rest.positions[c].coords).sum();
        let centre = Point3::from(mean / free.len().max(1) as f64);
        let blow =
            Matrix3::new(0.5, 1.0, 0.3, 0.2, -0.5, 1.0, 1.0, 0.1, 0.2) * (BLOW / self.dt_s());
        let mut first = rest.clone();
        for &c in &free {
            first.velocities[c] = blow * (rest.positions[c] - centre);
        }
        let path = |iterations: usize| {
            let (mut state, mut scratch) = (first.clone(), self.scratch());
            let mut places = Vec::with_capacity(steps);
            for _ in 0..steps {
                self.predict(&state, &mut scratch);
                for _ in 1..iterations {
                    self.iterate(&state, &mut scratch);
                }
                self.advance(&mut state, &mut scratch);
                places.push(state.positions.clone());
            }
            places
        };
        let (given, exact) = (path(iterations), path(CONVERGED));
        let (mut off, mut moved) = (0.0, 0.0);
        for (given, exact) in given.iter().zip(&exact) {
            for &c in &free {
                off += self.matter.masses[c] * (given[c] - exact[c]).norm_squared();
                moved += self.matter.masses[c] * (exact[c] - rest.positions[c]).norm_squared();
            }
        }
        if moved > 0.0 {
            (off / moved).sqrt()
        } else {
            0.0
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

    /// Bytes of what answers contact.
    pub fn compliance_bytes(&self) -> usize {
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.surface_bytes(),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => self.by_trial.bytes(),
        }
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
