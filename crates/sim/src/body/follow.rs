//! A matrix of the step that follows the body.
//!
//! One iteration from the inertial prediction is stable while no area of a cell has grown by a third since its matrix
//! was made, nor a stiffness by plastic flow. Where one has by [`MOST_GROWN`], the matrix is made anew where the body is
//! now, elsewhere, and taken over [`DUE`] steps later, whenever it was done: a replay makes the same one from the same
//! places.

use super::core::Core;
use super::elements::continuum::{areas_squared, inverses, squares_at_centre};
use super::matter::{Matter, lanes, lanes_of};
use super::state::DeformableState;
use crate::in_place::clone_in_place;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3};
use palpate_geometry::stateful;
use std::ops::Range;
use std::sync::Arc;

/// Most that an area of a cell may have grown by, as a factor, before a matrix is made anew; and within which that of
/// rest is taken.
const MOST_GROWN: f64 = 1.1;
const BACK_AT_REST: f64 = 1.06;
/// Least volume of a cell over its own at rest where one is made.
const LEAST_VOLUME: f64 = 0.1;
/// Steps from where a matrix is made until it is taken over.
pub(super) const DUE: u32 = 32;
/// Steps in which all cells are looked at once.
const ROUND: usize = 4;

/// Where a matrix is made.
#[derive(Debug, Default, PartialEq)]
pub struct Shape {
    /// It is not that of rest.
    pub is_set: bool,
    /// (coordinates), m.
    pub positions: Vec<Point3>,
    /// As those of the state.
    pub pressures: Vec<Lane>,
    /// As [`DeformableState::rest_lengths`].
    pub metrics: Vec<Lane>,
}

clone_in_place!(Shape {
    is_set,
    positions,
    pressures,
    metrics
});

stateful!(Shape, |this, walk| {
    let Shape {
        is_set,
        positions,
        pressures,
        metrics,
    } = this;
    walk.coded("matrix of another shape", is_set)?;
    if *is_set {
        walk.triples(positions)?;
        walk.lanes(pressures)?;
        walk.lanes(metrics)?;
    }
    Ok(())
});

/// Which matrix a body takes. One without room for shapes keeps that of rest.
#[derive(Debug, Default, PartialEq)]
pub struct Following {
    /// Where that of the step was made.
    pub now: Shape,
    /// Where the next one is made.
    pub next: Shape,
    /// Steps since then.
    pub age: u32,
    /// Steps, counted round.
    pub step: u32,
}

clone_in_place!(Following {
    now,
    next,
    age,
    step
});

stateful!(Following, |this, walk| {
    let Following {
        now,
        next,
        age,
        step,
    } = this;
    walk.packed("steps of a matrix", [(0, age), (32, step)])?;
    walk.part(now)?;
    walk.part(next)
});

impl Shape {
    fn set(&mut self, state: &DeformableState) {
        self.is_set = true;
        self.positions.clone_from(&state.positions);
        self.pressures.clone_from(&state.pressures);
        self.metrics.clone_from(&state.rest_lengths);
    }
}

impl Following {
    /// That of rest, of a body with as many coordinates, lanes of pressures, and of what flows; nothing is allocated
    /// where there is room.
    pub(super) fn set_to_rest(&mut self) {
        (self.now.is_set, self.next.is_set) = (false, false);
        (self.age, self.step) = (0, 0);
    }

    /// Room for shapes of a state.
    pub(super) fn for_state(state: &DeformableState) -> Self {
        let room = || Shape {
            is_set: false,
            positions: state.positions.clone(),
            pressures: state.pressures.clone(),
            metrics: state.rest_lengths.clone(),
        };
        Self {
            now: room(),
            next: room(),
            age: 0,
            step: 0,
        }
    }

    /// A matrix is to be taken over in the step that begins.
    pub fn is_due(&self) -> bool {
        self.next.is_set && self.age >= DUE
    }

    /// It will be at the end of this step.
    pub fn is_nearly_due(&self) -> bool {
        self.next.is_set && self.age + 1 >= DUE
    }

    /// A matrix that is due is not there yet: it is taken over a step later.
    pub fn put_off(&mut self) {
        self.age = self.age.saturating_sub(1);
    }
}

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
    rounds: [Vec<u32>; ROUND],
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

    /// Cells that are looked at in a round.
    fn round(&self, round: usize) -> Range<usize> {
        let end = |round: usize| round * self.nodes.len() / ROUND;
        end(round)..end(round + 1)
    }

    /// The most that an area of some of the cells has grown by since, at `places` (nodes), as a factor, or a little more.
    fn grown(&self, places: &[Lane], cells: Range<usize>) -> f64 {
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
fn stiffened(made: &Cells, metrics: &[Lane], first: usize) -> f64 {
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

/// What a step found of its matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// It goes on with it.
    On,
    /// Another one is to be made, of [`Following::next`].
    Begun,
    /// It goes on with that of rest.
    AtRest,
}

/// Looks at how far a body is from where its matrix was made. `coordinates` and `nodes` are buffers.
pub(super) fn look(
    matter: &Matter,
    (now, rest): (&Core, &Core),
    state: &mut DeformableState,
    (coordinates, nodes): (&mut [Lane], &mut [Lane]),
) -> Follows {
    if state.following.now.positions.is_empty() {
        return Follows::On;
    }
    if state.following.next.is_set {
        state.following.age += 1;
        return Follows::On;
    }
    let round = state.following.step as usize % ROUND;
    state.following.step = (round as u32 + 1) % ROUND as u32;
    lanes(&state.positions, coordinates);
    if state.following.now.is_set && round == 0 {
        let places = matter.nodes_of(coordinates, nodes);
        let metrics = &state.rest_lengths;
        let stiffened =
            (0..ROUND).any(|first| stiffened(&rest.cells, metrics, first) > BACK_AT_REST);
        if !stiffened && rest.cells.grown(places, 0..rest.cells.nodes.len()) <= BACK_AT_REST {
            state.following.now.is_set = false;
            return Follows::AtRest;
        }
    }
    let places = matter.some_nodes_of(&now.cells.rounds[round], coordinates, nodes);
    let grown = now.cells.grown(places, now.cells.round(round));
    if grown.max(stiffened(&now.cells, &state.rest_lengths, round)) <= MOST_GROWN {
        return Follows::On;
    }
    let places = matter.nodes_of(coordinates, nodes);
    // A tangent of crushed cells says little about the body once it has come out of that.
    let solid = matter.law.continuum.as_ref();
    if solid.is_none_or(|solid| solid.least_volume(places) < LEAST_VOLUME) {
        return Follows::On;
    }
    let mut next = std::mem::take(&mut state.following.next);
    next.set(state);
    (state.following.next, state.following.age) = (next, 0);
    Follows::Begun
}

/// A matrix that was made elsewhere.
#[derive(Clone, Debug)]
pub struct Made(pub(super) Arc<Core>);

/// Nodes of a shape.
pub(super) fn nodes_of(matter: &Matter, shape: &Shape) -> Vec<Lane> {
    lanes_of(&matter.map.nodes(&shape.positions))
}
