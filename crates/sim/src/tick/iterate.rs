//! Further iterations of bodies that take several a step.
//!
//! A body's matrix A is above its tangent, so one iteration does not end its step. Contact is
//! settled within each: from where the contact forces so far bring the body, its free motion is
//! corrected, the gaps follow, and the forces are solved for anew on the same compliance. What
//! moves no more is at rest with its forces, however many iterations there are.

use super::{load, quality};
use crate::tick::balance::Balance;

/// Runs what iterations are left after the first.
pub(super) fn iterate(balance: &mut Balance<'_>) {
    let scene = balance.scene;
    let most = match balance.quality < quality::ONE_ITERATION {
        true => scene.parties().map(|body| body.iterations()).max(),
        false => None,
    };
    for iteration in 1..most.unwrap_or(1) {
        let Balance {
            tools,
            states,
            tool_parts,
            bodies,
            rows,
            solver,
            ..
        } = balance;
        load::limit_tools(scene, tools, rows, solver, tool_parts);
        for i in 0..rows.rows.len() {
            if solver.carries(i) {
                load::push_bodies(scene, rows, solver, tool_parts, bodies, i, iteration);
            }
        }
        for (b, body) in scene.parties().enumerate() {
            if body.iterations() > iteration {
                body.correct(&states[b], &mut bodies[b], rows);
            }
        }
        balance.solve_again();
    }
}
