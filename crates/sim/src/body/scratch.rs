//! Buffers of a body's step.

use super::before::{Before, Look};
use super::convergence::Convergence;
use super::core::{FactorWork, Made};
use super::elements::spring_table::ByCoordinate;
use super::field::Field;
use super::following::Follows;
use super::frame::Frame;
use super::guard::RigidStep;
use super::matter::Matter;
use super::missed::Missed;
use super::node_map::NodeMap;
use super::rigid_motion::Inertia;
use super::rigid_velocity::RigidVelocity;
use crate::solve::rigid_part::RigidPart;
use palpate_geometry::math::{Lane, Point3, Rows, Vector3};

/// Buffers of a body's step.
#[derive(Clone, Debug)]
pub struct DeformableScratch {
    /// (coordinates): x*, the next free motion, by [`super::Deformable::predict`].
    pub predicted: Vec<Point3>,
    /// (coordinates): where a step of a few iterations is so far, contact forces included.
    pub(super) reached: Vec<Point3>,
    /// Contact forces that the last correction knew, by coordinate of the net.
    pub(super) carried: Vec<(u32, Vector3)>,
    /// The scratch stands for a sleeping body already.
    pub(super) at_rest: bool,
    /// Of steps of several iterations: where the last look was, and the pressures at this one.
    pub(super) before: Before,
    pub(super) looked: Vec<Lane>,
    /// Room for what contact changes of them.
    pub(super) changed: Vec<(u32, Vector3)>,
    /// The step has taken its contact forces.
    pub(super) arrived: bool,
    /// The share of its motion then that the body can follow, and the rigid part of that motion, if it is free.
    pub(super) share: f64,
    pub(super) rigid: Option<RigidStep>,
    /// The step was shortened.
    pub(super) shortened: bool,
    /// What the last step found of its matrix.
    pub(super) follows: Follows,
    /// The rigid motion of a free body at the start of its step.
    pub(super) turning: Option<RigidVelocity>,
    pub(super) implicit: ImplicitScratch,
    /// (coordinates), N: contact forces, by the caller, used up by [`super::Deformable::advance`].
    pub(super) forces: Vec<Vector3>,
    /// Coordinates with a force, in the order they were given, and whether a coordinate is among
    /// them.
    pub(super) loaded: Vec<u32>,
    pub(super) is_loaded: Vec<bool>,
    /// A tool gave some of them.
    pub(super) handled: bool,
    /// (coordinates) and (nodes), x y z 0; the second is empty when nodes are coordinates.
    pub(super) coordinates: Rows,
    pub(super) nodes: Rows,
    /// (coordinates) and (nodes), N.
    pub(super) residual: Rows,
    pub(super) node_residual: Rows,
    /// Of the force pass over springs.
    pub(super) springs: ByCoordinate,
    /// (coordinates), m/s: velocities within a tick of substeps.
    pub(super) speed: Vec<Vector3>,
    /// (coordinates), m: how far damping looks ahead.
    pub(super) ahead: Vec<Vector3>,
    /// (coordinates): what closing the gaps of pressures pulls, N, or how far it moves, m, in the frame of the matrix.
    pub(super) pull: Rows,
    /// What free points feel.
    pub(super) field: Field,
    /// What the step leaves of its equation where contact forces act.
    pub(super) missed: Missed,
    /// Plastic strains within a step; empty unless the body flows.
    pub(super) flow: Vec<Lane>,
}

/// Buffers of a correction.
#[derive(Clone, Debug, Default)]
pub(super) struct ImplicitScratch {
    /// (unknowns).
    pub(super) frames: Vec<Frame>,
    pub(super) work: FactorWork,
    /// (unknowns): right-hand side and solution, in the frame of the matrix.
    pub(super) rows: Rows,
    /// (unknowns), N: the right-hand side once more, of steps of several iterations.
    pub(super) loads: Rows,
    /// Of the last residual, its product with the correction: its square in the norm of B⁻¹, J.
    pub(super) merit_j: f64,
    /// (unknowns), m: the solution in the world.
    pub(super) moved: Vec<Vector3>,
    /// As in the state after the step.
    pub(super) convergence: Convergence,
    /// Σ |correction|² of the last further iteration, m².
    pub(super) last_m2: f64,
    /// Pressures so far, Pa, and the gaps between them and the volumes at the last look.
    pub(super) pressures: Vec<Lane>,
    pub(super) gaps: Vec<Lane>,
    /// Which core the step takes.
    pub(super) core: usize,
    /// Which of them a sheet stretched as in this step takes.
    pub(super) by_stretch: usize,
    /// (coordinates), m: where the step starts.
    pub(super) starts: Vec<Point3>,
    /// Of a free body, there.
    pub(super) inertia: Option<Inertia>,
    /// How its rigid motions answer, once contact has asked for it.
    pub(super) rigid: RigidPart,
    /// The core that was made where the body is, in place of that of rest.
    pub(super) followed: Option<Made>,
}

impl DeformableScratch {
    /// Where its step is looked at, and where it was before.
    pub(super) fn look(&mut self) -> (&mut Before, Look<'_>) {
        let look = Look {
            reached: &mut self.reached,
            predicted: &mut self.predicted,
            looked: &self.looked,
            pressures: &mut self.implicit.pressures,
            carried: &mut self.carried,
        };
        (&mut self.before, look)
    }
}

impl Matter {
    /// Buffers; call [`super::Deformable::predict`] before the first step.
    pub fn scratch(&self) -> DeformableScratch {
        let count = self.rest.len();
        let nodes = match &self.map {
            NodeMap::Same => 0,
            NodeMap::Sparse(map) => map.rows(),
        };
        DeformableScratch {
            predicted: self.rest.clone(),
            forces: vec![Vector3::zeros(); count],
            loaded: Vec::with_capacity(self.coordinate_of_control.len()),
            is_loaded: vec![false; count],
            handled: false,
            coordinates: Rows::zeros(count),
            nodes: Rows::zeros(nodes),
            residual: Rows::zeros(count),
            node_residual: Rows::zeros(nodes),
            springs: self.law.springs.buffers(),
            speed: vec![Vector3::zeros(); count],
            ahead: vec![Vector3::zeros(); count],
            reached: self.rest.clone(),
            carried: Vec::with_capacity(2 * self.surface.len()),
            at_rest: false,
            before: Before::default(),
            looked: Vec::new(),
            changed: Vec::with_capacity(2 * self.surface.len()),
            arrived: false,
            share: 1.0,
            rigid: None,
            shortened: false,
            follows: Follows::On,
            turning: None,
            implicit: ImplicitScratch::default(),
            pull: Rows::zeros(count),
            field: Field::default(),
            missed: Missed::default(),
            flow: vec![[0.0; 4]; self.strain_lanes()],
        }
    }
}
