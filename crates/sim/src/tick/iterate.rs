//! Further iterations of bodies that take several a step.
//!
//! A body's matrix A is above its tangent, so one iteration does not end its step. Contact is
//! settled within each: from where the contact forces so far bring the body, its free motion is
//! corrected, the gaps follow, and the forces are solved for anew on the same compliance. What
//! moves no more is at rest with its forces, however many iterations there are.

use super::{SceneState, Scratch, quality};
use super::{balance, load};
use crate::scene::{BodyModel, DeformingBody, Scene};

/// Runs what iterations are left after the first.
pub(super) fn iterate(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    let of = |model: &DeformingBody| model.deformable.iterations();
    let deformables = scene.bodies.iter().filter_map(|body| match &body.model {
        BodyModel::Deforming(model) => Some(of(model)),
        BodyModel::Rigid => None,
    });
    let most = if state.quality < quality::ONE_ITERATION {
        deformables.max().unwrap_or(1)
    } else {
        1
    };
    for iteration in 1..most {
        load::limit_tools(scene, state, scratch);
        for i in 0..scratch.rows.rows.len() {
            if scratch.solver.carries(i) {
                load::push_bodies(scene, scratch, i, |model| of(model) > iteration);
            }
        }
        for (b, body) in scene.bodies.iter().enumerate() {
            if let BodyModel::Deforming(model) = &body.model
                && of(model) > iteration
            {
                correct(b, model, state, scratch);
            }
        }
        balance::solve_again(scene, state, scratch);
    }
}

/// One iteration of a body; its rows follow.
fn correct(b: usize, model: &DeformingBody, state: &SceneState, scratch: &mut Scratch) {
    let Scratch { bodies, rows, .. } = scratch;
    let (Some(deformable), Some(deforming)) =
        (&state.bodies[b].deformable, &mut bodies[b].deforming)
    else {
        return;
    };
    model
        .deformable
        .iterate(deformable, &mut deforming.deformable);
    for (control, point) in deforming.predicted_net.iter_mut().enumerate() {
        let next = deforming.deformable.predicted[model.deformable.coordinate_of_control(control)];
        deforming.change[control] = next - *point;
        *point = next;
    }
    rows.shift(b, &deforming.change);
}

/// Takes back the further iterations of a tick in which bodies stand still: the next tick begins
/// with the first.
pub(super) fn forget(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    for (b, body) in scene.bodies.iter().enumerate() {
        if let BodyModel::Deforming(model) = &body.model
            && model.deformable.iterations() > 1
        {
            scene.prepare_body(b, state, scratch, false);
        }
    }
}
