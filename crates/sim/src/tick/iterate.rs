//! Further iterations of bodies that take several a step.
//!
//! A body's matrix A is above its tangent, so one iteration does not end its step. Contact is
//! settled within each: from where the contact forces so far bring the body, its free motion is
//! corrected, the gaps follow, and the forces are solved for anew on the same compliance. What
//! moves no more is at rest with its forces, however many iterations there are.

use super::{balance, load};
use crate::scene::{BodyModel, LatticeBody, Scene, SceneState, Scratch, quality};

/// Runs what iterations are left after the first.
pub(super) fn iterate(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    let of = |model: &LatticeBody| model.lattice.iterations();
    let lattices = scene.bodies.iter().filter_map(|body| match &body.model {
        BodyModel::Lattice(model) => Some(of(model)),
        BodyModel::Rigid => None,
    });
    let most = if state.quality < quality::ONE_ITERATION {
        lattices.max().unwrap_or(1)
    } else {
        1
    };
    for iteration in 1..most {
        load::limit_tools(scene, state, scratch);
        for i in 0..scratch.rows.rows.len() {
            if load::carries(scratch, i) {
                load::push_bodies(scene, scratch, i, |model| of(model) > iteration);
            }
        }
        for (b, body) in scene.bodies.iter().enumerate() {
            if let BodyModel::Lattice(model) = &body.model
                && of(model) > iteration
            {
                correct(b, model, state, scratch);
            }
        }
        balance::solve_again(scene, state, scratch);
    }
}

/// One iteration of a body; its rows follow.
fn correct(b: usize, model: &LatticeBody, state: &SceneState, scratch: &mut Scratch) {
    let Scratch { bodies, rows, .. } = scratch;
    let (Some(lattice), Some(deforming)) = (&state.bodies[b].lattice, &mut bodies[b].deforming)
    else {
        return;
    };
    model.lattice.iterate(lattice, &mut deforming.lattice);
    for (control, point) in deforming.predicted_net.iter_mut().enumerate() {
        let next = deforming.lattice.predicted[model.lattice.coordinate_of_control(control)];
        deforming.change[control] = next - *point;
        *point = next;
    }
    rows.shift(b, &deforming.change);
}

/// Takes back the further iterations of a tick in which bodies stand still: the next tick begins
/// with the first.
pub(super) fn forget(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    for (b, body) in scene.bodies.iter().enumerate() {
        if let BodyModel::Lattice(model) = &body.model
            && model.lattice.iterations() > 1
        {
            scene.prepare_body(b, state, scratch, false);
        }
    }
}
