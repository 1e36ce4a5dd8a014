//! What a replay restores of a deforming body.

use super::convergence::Convergence;
use super::following::Following;
use super::matter::Matter;
use super::stillness::{STILL_STEPS, Stillness};
use crate::in_place::clone_in_place;
use palpate_geometry::math::{Lane, Point3, Vector3};
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
    pub convergence: Convergence,
    /// Body steps in a row in which nothing moved; at a hundred the body sleeps.
    pub still: u32,
    /// How long it has stayed where it is, on other bodies.
    pub stillness: Stillness,
    /// It lies still on others, and neither steps nor is looked at.
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
    convergence,
    still,
    stillness,
    left_alone,
    slept,
});

impl DeformableState {
    /// It has stayed where it is for a while, on other bodies or by itself, and no tool touched it.
    pub fn lies_still(&self) -> bool {
        self.stillness.is_long() || self.still >= STILL_STEPS
    }

    /// It lies still on other bodies and neither steps nor is looked at.
    pub fn is_left_alone(&self) -> bool {
        self.left_alone
    }

    /// Leaves it alone, at rest, or takes it up again.
    pub fn leave_alone(&mut self, left_alone: bool) {
        self.left_alone = left_alone;
        if left_alone {
            self.velocities.fill(Vector3::zeros());
        } else {
            self.stillness.steps = 0;
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
        convergence,
        still,
        stillness,
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
    let Convergence {
        corrections,
        level,
        steps,
        next,
    } = convergence;
    walk.lanes(corrections)?;
    walk.coded("matrix of the step", level)?;
    walk.coded("cautious steps", steps)?;
    walk.coded("cautious steps next time", next)?;
    walk.coded("number of still steps", still)?;
    let Stillness { from, steps } = stillness;
    walk.triples(from)?;
    walk.coded("number of calm steps", steps)?;
    walk.coded("left alone", left_alone)?;
    walk.word(slept)
});

impl Matter {
    /// The state at the start: at rest, or launched.
    pub fn rest_state(&self) -> DeformableState {
        let mut state = DeformableState::default();
        self.set_to_rest(&mut state);
        state
    }

    /// Sets a state of this body back to rest. Allocates nothing.
    pub fn set_to_rest(&self, state: &mut DeformableState) {
        let DeformableState {
            positions,
            velocities,
            rest_lengths,
            plastic_strain,
            contact_n,
            pressures,
            following,
            convergence,
            still,
            stillness,
            left_alone,
            slept,
        } = state;
        contact_n.clear();
        contact_n.resize(self.surface.len(), Vector3::zeros());
        pressures.fill([0.0; 4]);
        following.set_to_rest();
        convergence.set_to_rest();
        positions.clone_from(&self.rest);
        velocities.clear();
        match &self.launch {
            Some(launch) => velocities.extend(self.rest.iter().map(|x| launch.velocity(x))),
            None => velocities.resize(self.rest.len(), Vector3::zeros()),
        }
        let rest: &[Lane] = match &self.flow {
            Some(flow) => flow.rest(&self.law),
            None => &[],
        };
        rest_lengths.clear();
        rest_lengths.extend_from_slice(rest);
        plastic_strain.clear();
        plastic_strain.resize(self.strain_lanes(), [0.0; 4]);
        (*still, *stillness, *left_alone, *slept) = (0, Stillness::default(), false, 0);
    }

    /// Lengths of the springs without force, or metrics of cells that flow.
    pub fn rest_lengths<'a>(&'a self, state: &'a DeformableState) -> &'a [Lane] {
        if self.flow.is_some() {
            &state.rest_lengths
        } else {
            self.law.springs.rest()
        }
    }
}
