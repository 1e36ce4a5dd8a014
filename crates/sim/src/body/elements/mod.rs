//! Laws of matter: the internal forces of a body.
//!
//! A law is one file here, which implements [`ForceLaw`], and a line in [`MaterialLaw`]'s constructors.

mod bends;
pub mod continuum;
mod law;
pub(super) mod spring_table;
pub(super) mod springs;

use super::material::Stiffening;
pub use bends::Bend;
use continuum::{ContinuumLaw, Given, VolumeBarrier};
pub use law::{Edge, Weight};
pub(crate) use law::{ForceLaw, Place};
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};
use spring_table::{ByCoordinate, SpringTable};
use springs::Spring;

/// Springs, bends for membranes, or a continuum energy.
#[derive(Debug, Default)]
pub struct MaterialLaw {
    pub(in crate::body) springs: SpringTable,
    /// The solid, whose cells may flow.
    pub(in crate::body) continuum: Option<ContinuumLaw>,
    /// Bends of sheets; what keeps the cells of a lattice from being crushed; of flat cells, whose `continuum` is
    /// integrated at their centres, a small share at their Gauss points, so that no motion is without energy.
    others: Vec<Box<dyn ForceLaw>>,
    /// Greatest slope of the springs, relative to that at rest.
    slope: f64,
}

impl MaterialLaw {
    /// Springs of a solid.
    pub fn springs(springs: &[Spring], stiffening: Option<Stiffening>) -> Self {
        Self {
            springs: SpringTable::new(springs, stiffening),
            slope: stiffening.map_or(1.0, |law| law.greatest_ratio()),
            ..Self::default()
        }
    }

    /// Springs and bends of a sheet.
    pub fn membrane(springs: &[Spring], stiffening: Option<Stiffening>, bends: Vec<Bend>) -> Self {
        Self::springs(springs, stiffening).with(bends)
    }

    /// Keeps cells from being crushed.
    pub fn with_barrier(self, barrier: VolumeBarrier) -> Self {
        self.with(barrier)
    }

    /// A continuum energy.
    pub fn continuum(continuum: ContinuumLaw) -> Self {
        Self {
            continuum: Some(continuum),
            slope: 1.0,
            ..Self::default()
        }
    }

    /// The energy of flat cells: most of it at their centres, a share at their Gauss points.
    pub fn flat_continuum(at_centres: ContinuumLaw, at_points: ContinuumLaw) -> Self {
        Self::continuum(at_centres).with(at_points)
    }

    fn with(mut self, law: impl ForceLaw + 'static) -> Self {
        self.others.push(Box::new(law));
        self
    }

    /// The laws beside springs.
    fn laws(&self) -> impl Iterator<Item = &dyn ForceLaw> {
        let continuum = self.continuum.iter().map(|law| law as &dyn ForceLaw);
        continuum.chain(self.others.iter().map(|law| &**law))
    }

    /// Edges of a Laplacian. A spring's tangent is at most its slope, whatever its length and direction; in the
    /// bounding one stiffening springs count with 3/4 of their steepest slope, if that is more than their slope at
    /// rest.
    pub(in crate::body) fn edges(&self, of: Weight) -> Vec<Edge> {
        let scale = match of {
            Weight::Bounding => (0.76 * self.slope).max(1.0),
            Weight::Firm => 0.5 * self.slope,
            Weight::Steepest => self.slope,
        };
        let springs = self.spring_edges(scale);
        springs
            .chain(self.laws().flat_map(|law| law.edges()))
            .collect()
    }

    fn spring_edges(&self, scale: f64) -> impl Iterator<Item = Edge> {
        let each = self.springs.each();
        each.map(move |(_, _, a, b, k)| (a as u32, b as u32, k * scale))
    }

    /// Hands out blocks (a, b, ∂²E/∂x_a∂x_b), N/m, a >= b or its mirror, each pair of nodes once or in parts; without
    /// what is negative.
    pub(in crate::body) fn tangent_at(
        &self,
        at: &Place<'_>,
        out: &mut impl FnMut(u32, u32, Matrix3),
    ) {
        let margin = (0.76 * self.slope).max(1.0);
        self.springs.tangent_at(at, margin, out);
        if let Some(continuum) = &self.continuum {
            continuum.tangent_at(at, out);
        }
        for law in &self.others {
            law.tangent_at(at, out);
        }
    }

    /// Hands out what cells that share a pressure add to that tangent: k g gᵀ, g by node (m²) and k in N/m⁵.
    pub(in crate::body) fn shared_at(
        &self,
        places: &[Lane],
        out: &mut impl FnMut(&[(u32, Vector3)], f64),
    ) {
        if let Some(law) = &self.continuum {
            law.shared_at(places, out);
        }
    }

    /// Edges of the Laplacian that springs have out of plane that are drawn to a stretch,
    /// 1 − rest length / length.
    pub(in crate::body) fn tension_edges(&self, stretch: f64) -> Vec<Edge> {
        let each = self.springs.each();
        each.map(|(_, _, a, b, k)| (a as u32, b as u32, k * self.slope * stretch))
            .collect()
    }

    /// The greatest stretch of a spring at `places` (nodes): 1 − rest length / length, 0 where none is
    /// drawn.
    pub(in crate::body) fn greatest_stretch(&self, rest: &[Lane], places: &[Lane]) -> f64 {
        self.springs.greatest_stretch(rest, places)
    }

    /// True for solids, whose tangent at rest resists every motion but rigid ones. Rows of a
    /// membrane carry their own tension.
    pub(in crate::body) fn is_solid(&self) -> bool {
        !self.laws().any(|law| law.is_of_sheets())
    }

    /// True without bends and without stiffening.
    pub(in crate::body) fn is_plain_springs(&self) -> bool {
        self.slope == 1.0 && self.laws().all(|law| law.is_safeguard())
    }

    /// Adds −∂E/∂x, N. `rest`: lengths of the springs without force, or metrics of cells that flow; `given`: pressures
    /// instead of those that follow the volumes.
    pub(in crate::body) fn add_forces(
        &self,
        rest: &[Lane],
        given: Option<Given<'_>>,
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) {
        debug_assert_eq!(places.len(), residual.len(), "one place and force a node");
        self.springs.add_forces(rest, places, residual, buffers);
        for law in &self.others {
            law.add_forces(places, residual);
        }
        if let Some(continuum) = &self.continuum {
            continuum.add_forces_of(rest, given, places, residual);
        }
    }

    /// Parts of the law, each with its nodes: blocks of cells, springs, bends.
    pub(in crate::body) fn parts(&self) -> Vec<Vec<u32>> {
        let continuum = self.continuum.as_ref();
        let mut parts = continuum.map_or(Vec::new(), ContinuumLaw::nodes_of_parts);
        parts.extend(self.springs.ends().map(|ends| ends.to_vec()));
        parts.extend(self.others.iter().flat_map(|law| law.parts()));
        parts
    }

    /// [`MaterialLaw::add_forces`] of some parts (ascending), under given pressures.
    pub(in crate::body) fn add_forces_of_parts(
        &self,
        mut parts: &[u32],
        rest: &[Lane],
        given: Given<'_>,
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        let mut first = 0;
        let mut next = |count: usize| {
            let begin = first;
            first += count as u32;
            let (own, others) = parts.split_at(parts.partition_point(|part| *part < first));
            parts = others;
            (own, begin)
        };
        if let Some(continuum) = &self.continuum {
            let own = next(continuum.part_count());
            continuum.add_forces_of_some(own, rest, Some(given), places, residual);
        }
        let own = next(self.springs.len());
        self.springs.add_forces_of_some(own, rest, places, residual);
        for law in &self.others {
            law.add_forces_of_parts(next(law.part_count()), places, residual);
        }
    }

    /// Lanes of pressures that are unknowns; none without a continuum.
    pub(in crate::body) fn pressure_lanes(&self) -> usize {
        self.continuum
            .as_ref()
            .map_or(0, ContinuumLaw::pressure_lanes)
    }

    /// Elastic energy, J.
    pub(in crate::body) fn energy_j(&self, rest: &[Lane], places: &[Lane]) -> f64 {
        let at = |k: usize| Point3::new(places[k][0], places[k][1], places[k][2]);
        let continuum = self.continuum.as_ref();
        let continuum = continuum.map_or(0.0, |law| law.energy_flowed_j(rest, places));
        let others: f64 = self.others.iter().map(|law| law.energy_j(places)).sum();
        self.springs.energy_j(rest, at) + continuum + others
    }
}
