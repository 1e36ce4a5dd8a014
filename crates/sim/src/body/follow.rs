//! A matrix of the step that follows the body.
//!
//! One iteration from the inertial prediction is stable while no area of a cell has grown by a third since its matrix
//! was made, nor a stiffness by plastic flow. Where one has by [`MOST_GROWN`], the matrix is made anew where the body is
//! now, elsewhere, and taken over [`DUE`] steps later, whenever it was done: a replay makes the same one from the same
//! places.

use super::core::Core;
use super::following::{Follows, Shape};
use super::grown::{ROUND, stiffened};
use super::matter::{Matter, lanes, lanes_of};
use super::state::DeformableState;
use palpate_geometry::math::Lane;

/// Most that an area of a cell may have grown by, as a factor, before a matrix is made anew; and within which that of
/// rest is taken.
const MOST_GROWN: f64 = 1.1;
const BACK_AT_REST: f64 = 1.06;
/// Least volume of a cell over its own at rest where one is made.
const LEAST_VOLUME: f64 = 0.1;
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
        if !stiffened && rest.cells.grown(places, 0..rest.cells.count()) <= BACK_AT_REST {
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
    next.set(&state.positions, &state.pressures, &state.rest_lengths);
    (state.following.next, state.following.age) = (next, 0);
    Follows::Begun
}

/// Nodes of a shape.
pub(super) fn nodes_of(matter: &Matter, shape: &Shape) -> Vec<Lane> {
    lanes_of(&matter.map.nodes(&shape.positions))
}
