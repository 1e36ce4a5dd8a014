//! Internal forces of a body: what its model is made of, and nothing else.

use super::bends::Bend;
use super::continuum::{ContinuumLaw, VolumeBarrier, Weight};
use super::material::Stiffening;
use super::spring_table::{ByCoordinate, SpringTable};
use super::springs::Spring;
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

/// How much stiffer than at rest the springs of the step's tangent are; the support of their cells is
/// added to them.
const SPRING_MARGIN: f64 = 1.0;

/// Springs, bends for membranes, or a continuum energy.
#[derive(Debug, Default)]
pub struct MaterialLaw {
    pub(super) springs: SpringTable,
    pub(super) bends: Vec<Bend>,
    pub(super) continuum: Option<ContinuumLaw>,
    /// Of flat cells, whose `continuum` is integrated at their centres: a small share at their Gauss
    /// points, so that no motion is without energy.
    share_at_points: Option<ContinuumLaw>,
    /// What keeps the cells of a lattice from being crushed.
    barrier: Option<VolumeBarrier>,
    /// Greatest slope of the springs, relative to that at rest.
    slope: f64,
}

impl MaterialLaw {
    /// Springs of a solid.
    pub fn springs(springs: &[Spring], stiffening: Option<Stiffening>) -> Self {
        Self::membrane(springs, stiffening, Vec::new())
    }

    /// Keeps cells from being crushed.
    pub fn with_barrier(mut self, barrier: VolumeBarrier) -> Self {
        self.barrier = Some(barrier);
        self
    }

    /// Springs and bends of a sheet.
    pub fn membrane(springs: &[Spring], stiffening: Option<Stiffening>, bends: Vec<Bend>) -> Self {
        let slope = stiffening.map_or(1.0, |law| law.greatest_ratio());
        Self {
            springs: SpringTable::new(springs, stiffening),
            bends,
            continuum: None,
            share_at_points: None,
            barrier: None,
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

    /// The energy of flat cells: most of it at their centres, a share at their Gauss points.
    pub fn flat_continuum(at_centres: ContinuumLaw, at_points: ContinuumLaw) -> Self {
        Self {
            share_at_points: Some(at_points),
            ..Self::continuum(at_centres)
        }
    }

    fn continua(&self) -> impl Iterator<Item = &ContinuumLaw> {
        self.continuum.iter().chain(&self.share_at_points)
    }

    /// Edges (a, b, k) of the Laplacian of the bounding matrix: a step that starts from the inertial
    /// prediction is stable while the matrix is at least 3/4 of the tangent. A spring's tangent is
    /// at most its slope, whatever its length and direction; stiffening springs count with 3/4 of
    /// their steepest slope, if that is more than their slope at rest.
    pub(super) fn edges(&self) -> Vec<(u32, u32, f64)> {
        self.weighted_edges((0.76 * self.slope).max(1.0), Weight::Bounding)
    }

    /// Edges of a Laplacian that gives way under a force on a small part of the surface as the body
    /// does, κ = μ / (1 − ν): a half-space of conductivity κ and an elastic half-space (Boussinesq)
    /// are displaced alike below the force.
    pub(super) fn response_edges(&self) -> Vec<(u32, u32, f64)> {
        // Springs that make a solid of modulus E with ν = 1/4 have a Laplacian of 2 E.
        self.weighted_edges(4.0 / 15.0, Weight::Response)
    }

    /// Edges of a Laplacian that is firm against turning: with it the tangent of rest bounds that of
    /// springs drawn to twice their length, and of cells under pressures of twice μ.
    pub(super) fn firm_edges(&self) -> Vec<(u32, u32, f64)> {
        self.weighted_edges(0.5 * self.slope, Weight::Firm)
    }

    fn weighted_edges(&self, springs: f64, weight: Weight) -> Vec<(u32, u32, f64)> {
        let each = self.springs.each();
        let springs = each.map(|(_, _, a, b, k)| (a as u32, b as u32, k * springs));
        let continuum = self.continua().flat_map(|law| law.laplacian(weight));
        springs
            .chain(self.bends.iter().flat_map(Bend::edges))
            .chain(continuum)
            .collect()
    }

    /// Hands out blocks (a, b, ∂²E/∂x_a∂x_b), N/m, at rest, a >= b or its mirror, each pair of nodes
    /// once or in parts; a little more than the law's own, so that strained states stay below 4/3 of
    /// it. `places`: (nodes) at rest.
    pub(super) fn tangent_at_rest(
        &self,
        places: &[Lane],
        strain: f64,
        out: &mut impl FnMut(u32, u32, Matrix3),
    ) {
        let at = |k: usize| Vector3::new(places[k][0], places[k][1], places[k][2]);
        let scale = SPRING_MARGIN * (0.76 * self.slope).max(1.0);
        for (_, _, a, b, k) in self.springs.each() {
            let Some(way) = (at(b) - at(a)).try_normalize(0.0) else {
                continue;
            };
            let block = way * way.transpose() * (k * scale);
            out(a as u32, a as u32, block);
            out(b as u32, b as u32, block);
            out(a as u32, b as u32, -block);
        }
        for bend in &self.bends {
            bend.tangent(out);
        }
        if let Some(barrier) = &self.barrier {
            barrier.support_at_rest(out);
        }
        match (&self.continuum, &self.share_at_points) {
            (Some(at_centres), Some(at_points)) => {
                at_centres.tangent_at_centres(strain, out);
                at_points.tangent_at_rest(strain, out);
            }
            (Some(continuum), None) => continuum.tangent_at_rest(strain, out),
            (None, _) => (),
        }
    }

    /// Hands out what cells that share a pressure add to that tangent: k g gᵀ, g by node (m²) and k in N/m⁵.
    pub(super) fn shared_at_rest(&self, out: &mut impl FnMut(&[(u32, Vector3)], f64)) {
        for law in self.continua() {
            law.shared_at_rest(out);
        }
    }

    /// Edges of the Laplacian that springs drawn to a tautness, 1 − rest length / length, have out of
    /// plane.
    pub(super) fn taut_edges(&self, taut: f64) -> Vec<(u32, u32, f64)> {
        let each = self.springs.each();
        each.map(|(_, _, a, b, k)| (a as u32, b as u32, k * self.slope * taut))
            .collect()
    }

    /// How taut the tautest spring is at `places` (nodes): 1 − rest length / length, 0 where none is
    /// drawn.
    pub(super) fn tautness(&self, rest: &[Lane], places: &[Lane]) -> f64 {
        self.springs.tautness(rest, places)
    }

    /// True for solids, whose tangent at rest resists every motion but rigid ones. Rows of a
    /// membrane carry their own tension: out of plane they are as stiff as they are drawn.
    pub(super) fn is_solid(&self) -> bool {
        self.bends.is_empty()
    }

    /// Edges of a Laplacian that is no less than any tangent: what explicit steps must resolve.
    pub(super) fn steepest_edges(&self) -> Vec<(u32, u32, f64)> {
        let springs = self
            .springs
            .each()
            .map(|(_, _, a, b, k)| (a as u32, b as u32, k * self.slope));
        // Its step follows tangents up to 4/3 of its own matrix.
        let continuum = self
            .continua()
            .flat_map(|law| law.laplacian(Weight::Bounding))
            .map(|(a, b, k)| (a, b, 4.0 / 3.0 * k));
        springs
            .chain(self.bends.iter().flat_map(Bend::edges))
            .chain(continuum)
            .collect()
    }

    /// True without bends and without stiffening.
    pub(super) fn is_plain_springs(&self) -> bool {
        self.continuum.is_none() && self.bends.is_empty() && self.slope == 1.0
    }

    /// Adds −∂E/∂x, N. `rest`: lengths of the springs without force, or metrics of cells that flow; `farther`: how much farther than
    /// the bounding matrix the step follows cells. Answers with the number of
    /// cells that were held back.
    pub(super) fn add_forces(
        &self,
        rest: &[Lane],
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
        farther: f64,
    ) -> u32 {
        self.springs.add_forces(rest, places, residual, buffers);
        for bend in &self.bends {
            bend.add_force(places, residual);
        }
        let crushed =
            (self.barrier.as_ref()).map_or(0, |barrier| barrier.add_forces(places, residual));
        let of_share = self.share_at_points.as_ref().map_or(0, |law| {
            let pass = law.add_forces_reaching(&[], places, residual, farther);
            pass.limited
        });
        crushed
            + of_share
            + self.continuum.as_ref().map_or(0, |continuum| {
                continuum
                    .add_forces_reaching(rest, places, residual, farther)
                    .limited
            })
    }

    /// Elastic energy, J.
    pub(super) fn energy_j(&self, rest: &[Lane], places: &[Lane]) -> f64 {
        let at = |k: usize| Point3::new(places[k][0], places[k][1], places[k][2]);
        let continuum = self
            .continuum
            .as_ref()
            .map_or(0.0, |continuum| continuum.energy_flowed_j(rest, places));
        let bends: f64 = self.bends.iter().map(|bend| bend.energy_j(places)).sum();
        let barrier = self
            .barrier
            .as_ref()
            .map_or(0.0, |barrier| barrier.energy_j(places));
        let share = self
            .share_at_points
            .as_ref()
            .map_or(0.0, |law| law.energy_flowed_j(&[], places));
        self.springs.energy_j(rest, at) + bends + continuum + barrier + share
    }
}
