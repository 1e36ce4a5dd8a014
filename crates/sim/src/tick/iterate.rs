//! Further iterations of bodies that take several a step.
//!
//! A body's matrix A is above its tangent, so one iteration does not end its step. Contact is
//! settled within each: from where the contact forces so far bring the body, its free motion is
//! corrected, the gaps follow, and the forces are solved for anew on the same compliance. What
//! moves no more is at rest with its forces, however many iterations there are.

use super::balance::Balance;
use super::{BodyScratch, BodyState, SceneState, Scratch, load, quality};
use crate::scene::{BodyModel, DeformingBody, Scene};
use crate::solve::rows::RowSet;

/// Runs what iterations are left after the first; `states`: of the bodies.
pub(super) fn iterate(balance: &mut Balance<'_>, states: &[BodyState]) {
    let scene = balance.scene;
    let of = |model: &DeformingBody| model.deformable.iterations();
    let deformables = scene.bodies.iter().filter_map(|body| match &body.model {
        BodyModel::Deforming(model) => Some(of(model)),
        BodyModel::Rigid => None,
    });
    let most = if balance.quality < quality::ONE_ITERATION {
        deformables.max().unwrap_or(1)
    } else {
        1
    };
    for iteration in 1..most {
        let Balance {
            tools,
            tool_parts,
            bodies,
            rows,
            solver,
            ..
        } = balance;
        load::limit_tools(&scene.tools, tools, &rows.rows, solver, tool_parts);
        for i in 0..rows.rows.len() {
            if solver.carries(i) {
                let wanted = |model: &DeformingBody| of(model) > iteration;
                load::push_bodies(&scene.bodies, rows, solver, tool_parts, bodies, i, wanted);
            }
        }
        for (b, body) in scene.bodies.iter().enumerate() {
            if let BodyModel::Deforming(model) = &body.model
                && of(model) > iteration
            {
                correct(b, model, &states[b], &mut bodies[b], rows);
            }
        }
        balance.solve_again();
    }
}

/// One iteration of a body; its rows follow.
fn correct(
    b: usize,
    model: &DeformingBody,
    state: &BodyState,
    parts: &mut BodyScratch,
    rows: &mut RowSet,
) {
    let (Some(deformable), Some(deforming)) = (&state.deformable, &mut parts.deforming) else {
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
