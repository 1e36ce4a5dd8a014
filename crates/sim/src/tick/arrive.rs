//! Parties take the contact forces; what strains more in the tick than a step can follow is shortened, and the forces
//! with it, before they are out: a hand and a body feel the same.

use super::executor::SideBySide;
use super::load;
use crate::solve::rows::Holder;
use crate::tick::balance::Balance;

/// Hands the forces over. `shares`: by body, left with the share of its motion that was taken.
pub(super) fn arrive(balance: &mut Balance<'_>, shares: &mut [f64], side_by_side: &mut SideBySide) {
    let scene = balance.scene;
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
            load::push_bodies(scene, rows, solver, tool_parts, bodies, i, 0);
        }
    }
    side_by_side.each(shares, bodies, |b, share, scratch| {
        *share = scene.party(b).arrive(&states[b], scratch);
    });
    if cfg!(debug_assertions) {
        for (b, body) in scene.parties().enumerate() {
            body.check_arrival(&bodies[b], rows, solver);
        }
    }
    if shares.iter().all(|share| *share >= 1.0) {
        return;
    }
    // Bodies that press on each other have one share.
    loop {
        let mut more = false;
        for i in 0..rows.rows.len() {
            let a = rows.rows[i].body as usize;
            if let Holder::Body(b) = rows.rows[i].holder
                && shares[a] != shares[b as usize]
                && solver.carries(i)
            {
                let least = shares[a].min(shares[b as usize]);
                (shares[a], shares[b as usize], more) = (least, least, true);
            }
        }
        if !more {
            break;
        }
    }
    for (b, body) in scene.parties().enumerate() {
        if shares[b] < 1.0 {
            body.shorten(&states[b], &mut bodies[b], shares[b]);
        }
    }
    for i in 0..rows.rows.len() {
        let row = &rows.rows[i];
        let share = shares[row.body as usize];
        if share < 1.0 && solver.carries(i) {
            // What the hand does not bear, the body did not feel.
            let felt = load::on_bodies(row, i, solver, tool_parts) * share;
            solver.problem.set_force(&solver.matrix, i, &felt);
        }
    }
}
