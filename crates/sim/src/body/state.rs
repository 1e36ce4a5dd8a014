//! What a replay restores of a deforming body, and the buffers of its step.

use super::before::Before;
use super::calm::{Calm, STILL_STEPS};
use super::caution::{Caution, ImplicitScratch};
use super::elements::spring_table::ByCoordinate;
use super::field::Field;
use super::follow::{Following, Follows};
use super::guard::RigidStep;
use super::rigid_velocity::RigidVelocity;
use crate::in_place::clone_in_place;
use palpate_geometry::math::{Lane, Point3, Rows, Vector3};
use palpate_geometry::stateful;

/// What a replay restores.
#[derive(Debug, Default, PartialEq)]
pub struct DeformableState {
    /// (coordinates), m.
    pub positions: Vec<Point3>,
    /// (coordinates), m/s.
    pub velocities: Vec<Vector3>,
    /// Of springs that flow: lengths without force, m, four by four. Of continuum cells that flow:
    /// J₀⁻¹ Cp⁻¹ J₀⁻ᵀ (1/m², xx yy zz xy xz yz) at each point where they are integrated, four cells a
    /// row. Empty otherwise.
    pub rest_lengths: Vec<Lane>,
    /// Plastic strain of each spring, or of each such point, so far; empty unless they flow.
    pub plastic_strain: Vec<Lane>,
    /// (free coordinates of the net), N: contact forces of the last implicit step.
    pub contact_n: Vec<Vector3>,
    /// Pressures of the cells, four a row, then of the patches that share one, Pa; empty unless they are unknowns of the
    /// step.
    pub pressures: Vec<Lane>,
    /// Which matrix its step takes.
    pub following: Following,
    /// Whether the implicit step's tangent can follow springs.
    pub caution: Caution,
    /// Body steps in a row in which nothing moved; at a hundred the body sleeps.
    pub still: u32,
    /// How long it has stayed where it is, on other bodies.
    pub calm: Calm,
    /// It lies calm on others, and neither steps nor is looked at.
    pub left_alone: bool,
    /// Body steps slept through.
    pub slept: u64,
}

clone_in_place!(DeformableState {
    positions,
    velocities,
    rest_lengths,
    plastic_strain,
    contact_n,
    pressures,
    following,
    caution,
    still,
    calm,
    left_alone,
    slept,
});

impl DeformableState {
    /// It has stayed where it is for a while, on other bodies or by itself, and no tool touched it.
    pub fn lies_calm(&self) -> bool {
        self.calm.is_long() || self.still >= STILL_STEPS
    }

    /// It lies calm on other bodies and neither steps nor is looked at.
    pub fn is_left_alone(&self) -> bool {
        self.left_alone
    }

    /// Leaves it alone, at rest, or takes it up again.
    pub fn leave_alone(&mut self, left_alone: bool) {
        self.left_alone = left_alone;
        if left_alone {
            self.velocities.fill(Vector3::zeros());
        } else {
            self.calm.steps = 0;
        }
    }
}

stateful!(DeformableState, |this, walk| {
    let DeformableState {
        positions,
        velocities,
        rest_lengths,
        plastic_strain,
        contact_n,
        pressures,
        following,
        caution,
        still,
        calm,
        left_alone,
        slept,
    } = this;
    walk.triples(positions)?;
    walk.triples(velocities)?;
    walk.lanes(rest_lengths)?;
    walk.lanes(plastic_strain)?;
    walk.triples(contact_n)?;
    walk.lanes(pressures)?;
    if !pressures.is_empty() {
        walk.part(following)?;
    }
    let Caution {
        corrections,
        level,
        steps,
        next,
    } = caution;
    walk.lanes(corrections)?;
    walk.coded("matrix of the step", level)?;
    walk.coded("cautious steps", steps)?;
    walk.coded("cautious steps next time", next)?;
    walk.coded("number of still steps", still)?;
    let Calm { from, steps } = calm;
    walk.triples(from)?;
    walk.coded("number of calm steps", steps)?;
    walk.coded("left alone", left_alone)?;
    walk.word(slept)
});

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
    /// Plastic strains within a step; empty unless the body flows.
    pub(super) flow: Vec<Lane>,
}
