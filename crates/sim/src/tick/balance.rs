//! Contact, virtual couplings and bodies solved together.
//!
//! Rows of one tool share the compliance of its coupling, rows on one body that of its surface:
//! `D_ij = n_i · n_j ([same tool] / K' + Σ_sides ±± N_iᵀ W N_j)`, the sum over the sides of both
//! rows on the same body, each with the sign with which its normal pushes it. A tool that may turn
//! adds `(r_i × n_i) · (r_j × n_j) / K'_r` for two of its rows with arms r.
//!
//! A free rigid body adds to two of its rows what it gives way in a tick: dt² / m times the bracket's
//! signs, and by its turn dt² I⁻¹ (r_j × f_j) × r_i. With friction its turns about the three principal axes
//! are modes.
//!
//! With friction or grips, forces have three components and rows move each other by the bracket
//! alone, without n_i · n_j.

use super::flight::Gives;
use super::{SceneState, Scratch, WarmRow, quality};
use super::{dent, stick};
use crate::body::Deformable;
use crate::scene::{Body, BodyModel, Scene};
use crate::solve::cones::{self, ConeShare};
use crate::solve::friction::{FrictionLaw, Lever};
use crate::solve::hold::{Barrier, hold};
use crate::solve::rows::{Holder, Row};
use crate::solve::sharing::{Share, share};
use crate::solve::solver::Solver;
use palpate_geometry::math::Vector3;

/// Rows up to which soft modes are added to the matrix.
pub(super) const MANY_ROWS: usize = 256;
/// Enough for a corner of three planes: rows on rigid bodies are few.
const RIGID_SWEEPS: usize = 50;
/// Rows of a tool that turns lean on each other through its arms.
const TURNING_SWEEPS: usize = 200;
/// Rows of a free body lean on each other through its mass: three and more carry it where one would.
const FREE_SWEEPS: usize = 200;
/// Turns of a free body.
pub(super) const TURNS: usize = 3;
/// Fewest sweeps under lower quality, where there are as many.
const LEAST_SWEEPS: usize = 10;
/// Weight of a row that carries, relative to the depth that its force means to the coupling.
const LEAST_WEIGHT: f64 = 1e-3;

/// Where a solve starts.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    /// With the forces of the last tick.
    LastTick,
    /// With those there are.
    Here,
}

/// Solves for the force of every row.
pub(super) fn solve(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    let count = scratch.rows.rows.len();
    scratch.solver.problem.begin(count);
    scratch.solver.friction.clear();
    if count == 0 {
        return;
    }
    let whole = is_whole(scene, scratch);
    for i in 0..count {
        let a = scratch.rows.rows[i];
        let Some(tool) = a.tool() else { continue };
        let coupling = scene.tools[tool].coupling_for(&state.tools[tool].bounds);
        let (compliance, turning) = (
            coupling.compliance_m_n(),
            coupling.turning_compliance_rad_nm(),
        );
        let twist = a.arm.cross(&a.normal) * turning;
        for j in 0..count {
            let b = &scratch.rows.rows[j];
            if a.holder == b.holder {
                let mut moved = compliance * direction(&a, b, whole);
                if turning > 0.0 && !whole {
                    moved += twist.dot(&b.arm.cross(&b.normal));
                }
                scratch.solver.problem.row_mut(i)[j] = moved;
            }
        }
    }
    for (b, body) in scene.bodies.iter().enumerate() {
        if let BodyModel::Deforming(model) = &body.model {
            add_body_compliance(b, &model.deformable, whole, scratch);
            if !whole {
                add_soft_modes(b, &model.deformable, scratch);
            }
        }
        if let Some(gives) = scratch.bodies[b].gives().copied() {
            add_free_body(b, &gives, whole, scratch);
        }
    }
    dent::settle(&mut scratch.rows, &mut scratch.solver);
    if !whole {
        add_indentations(scratch);
    }
    for i in 0..count {
        let own = scratch.solver.problem.entry(i, i);
        scratch.solver.problem.row_mut(i)[i] = own + own * scratch.rows.rows[i].ease;
    }
    solve_rows(scene, state, scratch, Start::LastTick);
}

/// Solves once more, on the same compliance, after gaps have changed.
pub(super) fn solve_again(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    if !scratch.rows.rows.is_empty() {
        solve_rows(scene, state, scratch, Start::Here);
    }
}

/// Some force has three components, or there are so many rows on bodies with soft modes that these
/// are better kept apart than added to the matrix.
fn is_whole(scene: &Scene, scratch: &Scratch) -> bool {
    let rows = &scratch.rows.rows;
    let modes = |body: &Body| match &body.model {
        BodyModel::Deforming(model) => model.deformable.mode_count(),
        BodyModel::Rigid => 0,
    };
    rows.iter().any(|row| row.law != FrictionLaw::SMOOTH)
        || (rows.len() > MANY_ROWS && scene.bodies.iter().any(|body| modes(body) > 0))
}

/// How often a solve goes over its rows. They start with the forces of the last tick: under lower
/// quality, what few sweeps leave is settled over some ticks.
fn sweeps(scene: &Scene, state: &SceneState, rows: &[Row]) -> usize {
    let turns = scene.tools.iter().any(|tool| tool.coupling.turns());
    let rigid = match (rows.len(), turns) {
        _ if rows.iter().any(|row| is_on_free(scene, row)) => FREE_SWEEPS,
        (1, false) => 1,
        (_, false) => RIGID_SWEEPS,
        (_, true) => TURNING_SWEEPS,
    };
    let of_bodies = scene.bodies.iter().filter_map(|body| match &body.model {
        BodyModel::Deforming(model) => Some(model.sweeps),
        BodyModel::Rigid => None,
    });
    let full = of_bodies.fold(rigid, usize::max);
    if state.quality < quality::FEWER_SWEEPS {
        full
    } else {
        full.min((full / 4).max(LEAST_SWEEPS))
    }
}

/// One of its parties is a free rigid body.
fn is_on_free(scene: &Scene, row: &Row) -> bool {
    let holder = match row.holder {
        Holder::Body(other) => Some(other),
        Holder::Tool(_) => None,
    };
    let mut bodies = std::iter::once(row.body).chain(holder);
    bodies.any(|body| scene.bodies[body as usize].free().is_some())
}

fn solve_rows(scene: &Scene, state: &SceneState, scratch: &mut Scratch, start: Start) {
    if is_whole(scene, scratch) {
        return solve_whole(scene, state, scratch, start);
    }
    let mut warm = state.warm.rows().iter().peekable();
    for (i, row) in scratch.rows.rows.iter().enumerate() {
        // Both lists are ordered by it.
        while warm.next_if(|old| old.id < row.id).is_some() {}
        let old = warm.next_if(|old| old.id == row.id);
        let force = match start {
            Start::LastTick => old.map_or(0.0, |old| old.force_n),
            Start::Here => scratch.solver.problem.forces()[i],
        };
        scratch.solver.problem.set(i, row.gap_m, force);
    }
    scratch
        .solver
        .problem
        .solve(sweeps(scene, state, &scratch.rows.rows));
    for tool in 0..scene.tools.len() {
        hold_by_rigid(scene, state, scratch, tool);
        share_among_rigid(scene, state, scratch, tool);
    }
}

/// A tool that only translates and touches nothing that gives way is held exactly.
fn hold_by_rigid(scene: &Scene, state: &SceneState, scratch: &mut Scratch, tool: usize) {
    let Scratch { rows, solver, .. } = scratch;
    let Solver {
        problem, barriers, ..
    } = solver;
    let coupling = scene.tools[tool].coupling_for(&state.tools[tool].bounds);
    let own = |row: &&Row| row.tool() == Some(tool);
    let is_firm = |row: &Row| scene.bodies[row.body as usize].is_firm();
    if coupling.turns() || !rows.rows.iter().filter(own).all(is_firm) {
        return;
    }
    barriers.clear();
    barriers.extend(rows.rows.iter().filter(own).map(|row| Barrier {
        normal: row.normal,
        depth_m: -row.gap_m,
        part_m: 0.0,
    }));
    if barriers.len() < 2 || !hold(barriers) {
        return;
    }
    let compliance = coupling.compliance_m_n();
    let indices = (0..rows.rows.len()).filter(|&i| own(&&rows.rows[i]));
    for (i, barrier) in indices.zip(barriers.iter()) {
        problem.set_force(i, barrier.part_m / compliance);
    }
}

/// Solves for forces of three components.
fn solve_whole(scene: &Scene, state: &SceneState, scratch: &mut Scratch, start: Start) {
    let count = scratch.rows.rows.len();
    scratch.solver.sticks.clear();
    let mut warm = state.warm.rows().iter().peekable();
    for i in 0..count {
        let row = scratch.rows.rows[i];
        // Both lists are ordered by it.
        while warm.next_if(|old| old.id < row.id).is_some() {}
        let old = warm.next_if(|old| old.id == row.id);
        let WarmRow {
            force_n,
            tangent_n,
            slips,
            ..
        } = old.copied().unwrap_or_default();
        let (slip, stuck) = stick::slip(scene, scratch, &row, old);
        scratch.solver.sticks.push(stuck);
        let (law, free) = match row.law {
            FrictionLaw::Push {
                mu,
                drag_n_m: viscous_n_s_m,
            } => {
                let pair = scene.pairs[row.id.pair as usize].friction.filter(|_| slips);
                let free = slip + row.normal * (row.gap_m - slip.dot(&row.normal));
                let drag_n_m = match viscous_n_s_m > 0.0 {
                    true => {
                        viscous_n_s_m / scene.dt_s * share_of_drag(state, scratch, &row, force_n)
                    }
                    false => 0.0,
                };
                (
                    FrictionLaw::Push {
                        mu: pair.map_or(mu, |friction| friction.mu_kinetic),
                        drag_n_m,
                    },
                    free,
                )
            }
            grip => (grip, row.slip),
        };
        match start {
            Start::LastTick => {
                scratch.solver.friction.push(
                    &row.normal,
                    &free,
                    law,
                    &(row.normal * force_n + tangent_n),
                );
                if let Some(tool) = row
                    .tool()
                    .filter(|&tool| scene.tools[tool].coupling.turns())
                {
                    let compliance_rad_nm = scene.tools[tool].coupling.turning_compliance_rad_nm();
                    scratch.solver.friction.set_lever(&Lever {
                        tool,
                        arm: row.arm,
                        compliance_rad_nm,
                    });
                }
                give_modes(scene, scratch, &row);
            }
            Start::Here => scratch.solver.friction.set_free(i, &free),
        }
    }
    scratch.solver.friction.solve(
        scratch.solver.problem.matrix(),
        sweeps(scene, state, &scratch.rows.rows),
    );
    for tool in 0..scene.tools.len() {
        share_whole_among_rigid(scene, state, scratch, tool);
    }
    for i in 0..count {
        scratch
            .solver
            .problem
            .set_force(i, scratch.solver.friction.normal_n(i));
    }
}

/// Part of its pair's drag that a row has: as much as it carried of the pair's force in the last
/// tick.
fn share_of_drag(state: &SceneState, scratch: &Scratch, row: &Row, force_n: f64) -> f64 {
    let warm = state.warm.of_pair(row.id.pair as usize);
    let whole: f64 = warm.map(|old| old.force_n.max(0.0)).sum();
    if whole > 0.0 {
        return force_n.max(0.0) / whole;
    }
    // It has just come to touch.
    1.0 / scratch
        .rows
        .rows
        .iter()
        .filter(|other| other.id.pair == row.id.pair)
        .count() as f64
}

/// [`share_among_rigid`] with friction and grips. A grip counts as deep as its part of the force
/// means to the coupling.
fn share_whole_among_rigid(scene: &Scene, state: &SceneState, scratch: &mut Scratch, tool: usize) {
    let Scratch { rows, solver, .. } = scratch;
    let Solver {
        friction, cones, ..
    } = solver;
    let coupling = scene.tools[tool].coupling_for(&state.tools[tool].bounds);
    if coupling.turns() {
        return;
    }
    let compliance = coupling.compliance_m_n();
    cones.clear();
    let total: Vector3 = rigid_rows(scene, &rows.rows, tool)
        .map(|(i, _)| friction.force_n(i))
        .sum();
    let count = rigid_rows(scene, &rows.rows, tool).count() as f64;
    for (i, row) in rigid_rows(scene, &rows.rows, tool) {
        let (mut law, force_n) = (friction.law(i), friction.force_n(i));
        if let FrictionLaw::Push { mu, drag_n_m } = &mut law
            && *drag_n_m > 0.0
            && friction.normal_n(i) > 0.0
        {
            // Drag goes beyond the cone; it is shared as if the cone held it.
            *mu = mu.max(friction.tangent_n(i).norm() / friction.normal_n(i));
        }
        let weight_m = match law {
            FrictionLaw::Push { .. } => {
                (-row.gap_m).clamp(0.0, row.counts_m)
                    + LEAST_WEIGHT * compliance * friction.normal_n(i)
            }
            FrictionLaw::Grip { .. } => compliance * total.norm() / count,
        };
        cones.push(ConeShare {
            normal: row.normal,
            law,
            weight_m,
            force_n,
        });
    }
    if cones.len() > 1 && cones::share(cones) {
        for ((i, _), share) in rigid_rows(scene, &rows.rows, tool).zip(cones.iter()) {
            friction.set_force(i, &share.force_n);
        }
    }
}

/// Rows of a tool on bodies that do not give way.
fn rigid_rows<'a>(
    scene: &'a Scene,
    rows: &'a [Row],
    tool: usize,
) -> impl Iterator<Item = (usize, &'a Row)> {
    let rigid = |row: &Row| scene.bodies[row.body as usize].is_firm();
    rows.iter()
        .enumerate()
        .filter(move |(_, row)| row.tool() == Some(tool) && rigid(row))
}

/// Rows of a tool on bodies that do not give way share their force by depth; balance does not say
/// how.
fn share_among_rigid(scene: &Scene, state: &SceneState, scratch: &mut Scratch, tool: usize) {
    let Scratch { rows, solver, .. } = scratch;
    let Solver {
        problem, shares, ..
    } = solver;
    let coupling = scene.tools[tool].coupling_for(&state.tools[tool].bounds);
    if coupling.turns() {
        // Moments count: the solve has shared.
        return;
    }
    let compliance = coupling.compliance_m_n();
    let rigid = |row: &Row| row.tool() == Some(tool) && scene.bodies[row.body as usize].is_firm();
    shares.clear();
    for (i, row) in rows.rows.iter().enumerate().filter(|(_, row)| rigid(row)) {
        let force_n = problem.forces()[i];
        // What carries has some weight, even where the device is not below that contact itself.
        let weight_m = (-row.gap_m).clamp(0.0, row.counts_m) + LEAST_WEIGHT * compliance * force_n;
        shares.push(Share {
            normal: row.normal,
            weight_m,
            force_n,
        });
    }
    if shares.len() > 1 && share(shares) {
        let indices = rows
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| rigid(row))
            .map(|(i, _)| i);
        for (i, share) in indices.zip(shares.iter()) {
            problem.set_force(i, share.force_n);
        }
    }
}

/// Adds what a body's surface gives way under its rows.
fn add_body_compliance(body: usize, deformable: &Deformable, whole: bool, scratch: &mut Scratch) {
    let Scratch {
        rows,
        solver,
        bodies,
        ..
    } = scratch;
    let Solver {
        problem, delassus, ..
    } = solver;
    let Some(deforming) = &bodies[body].deforming else {
        return;
    };
    delassus.clear();
    for (i, row) in rows.rows.iter().enumerate() {
        for (sign, side) in row.sides_on(body) {
            let (controls, weights) = rows.weights_in(side);
            let moving = controls
                .iter()
                .zip(weights)
                .filter_map(|(&control, &weight)| {
                    let coordinate = deformable.coordinate_of_control(control as usize);
                    Some((deformable.unknown(coordinate)?, coordinate, weight))
                });
            delassus.add(i, sign, moving);
        }
    }
    delassus.respond(|coordinate| deformable.compliance_of(&deforming.deformable, coordinate));
    delassus.each_pair(|pair| {
        let [i, j] = pair.rows;
        let entry = pair.compliance * direction(&rows.rows[i], &rows.rows[j], whole);
        problem.row_mut(i)[j] += entry;
        if !pair.same {
            problem.row_mut(j)[i] += entry;
        }
    });
}

/// Adds how far balls go in beyond what nets show; where forces have three components, that is a mode.
fn add_indentations(scratch: &mut Scratch) {
    let Scratch { rows, solver, .. } = scratch;
    let Solver {
        problem,
        indentations,
        ..
    } = solver;
    for (i, a) in rows.rows.iter().enumerate() {
        let dent = &indentations[a.id.pair as usize];
        if dent.slope_m_n == 0.0 {
            continue;
        }
        let along = dent.slope_m_n * a.normal.dot(&dent.normal);
        for (j, b) in rows.rows.iter().enumerate() {
            if a.id.pair == b.id.pair {
                problem.row_mut(i)[j] += along * b.normal.dot(&dent.normal);
            }
        }
    }
}

/// Adds what a free rigid body gives way; with friction only what it shifts, its turns are modes.
fn add_free_body(body: usize, gives: &Gives, whole: bool, scratch: &mut Scratch) {
    let Scratch { rows, solver, .. } = scratch;
    let (rows, problem) = (&rows.rows, &mut solver.problem);
    for (i, a) in rows.iter().enumerate() {
        for (sign_a, _) in a.sides_on(body) {
            let turn = match whole {
                true => Vector3::zeros(),
                false => gives.turned(&gives.arm(a).cross(&a.normal)),
            };
            for (j, b) in rows.iter().enumerate().take(i + 1) {
                for (sign_b, _) in b.sides_on(body) {
                    let mut entry = gives.shift_m_n * direction(a, b, whole);
                    if !whole {
                        entry += turn.dot(&gives.arm(b).cross(&b.normal));
                    }
                    entry *= sign_a * sign_b;
                    problem.row_mut(i)[j] += entry;
                    if i != j {
                        problem.row_mut(j)[i] += entry;
                    }
                }
            }
        }
    }
}

/// How each soft mode of a body moves a row, into the scratch; false if none does.
pub(super) fn modes_of_row(
    body: usize,
    deformable: &Deformable,
    scratch: &mut Scratch,
    row: &Row,
) -> bool {
    let Scratch {
        bodies,
        rows,
        solver,
        ..
    } = scratch;
    let mode_moves = &mut solver.mode_moves;
    let Some(deforming) = &bodies[body].deforming else {
        return false;
    };
    let moves = &mut mode_moves[..deformable.mode_count()];
    moves.fill(Vector3::zeros());
    let mut any = false;
    for (sign, side) in row.sides_on(body) {
        any = true;
        let (controls, weights) = rows.weights_in(side);
        for (&control, &weight) in controls.iter().zip(weights) {
            let coordinate = deformable.coordinate_of_control(control as usize);
            deformable.add_modes(&deforming.deformable, coordinate, sign * weight, moves);
        }
    }
    any
}

/// Adds what soft modes of a body move rows along their normals.
fn add_soft_modes(body: usize, deformable: &Deformable, scratch: &mut Scratch) {
    let (modes, count) = (deformable.mode_count(), scratch.rows.rows.len());
    if modes == 0 {
        return;
    }
    for i in 0..count {
        let row = scratch.rows.rows[i];
        let moved = modes_of_row(body, deformable, scratch, &row);
        let along = &mut scratch.solver.modes_along[i * modes..(i + 1) * modes];
        for (along, moves) in along.iter_mut().zip(&scratch.solver.mode_moves) {
            *along = if moved { moves.dot(&row.normal) } else { 0.0 };
        }
    }
    let gains = deformable.mode_gains();
    for i in 0..count {
        let first = &scratch.solver.modes_along[i * modes..(i + 1) * modes];
        for j in 0..=i {
            let second = &scratch.solver.modes_along[j * modes..(j + 1) * modes];
            let mut entry = 0.0;
            for ((a, b), gain) in first.iter().zip(second).zip(gains) {
                entry += a * b * gain;
            }
            scratch.solver.problem.row_mut(i)[j] += entry;
            if i != j {
                scratch.solver.problem.row_mut(j)[i] += entry;
            }
        }
    }
}

/// Gives the row just added to the friction problem the soft modes of its bodies, and the turns of free
/// ones.
fn give_modes(scene: &Scene, scratch: &mut Scratch, row: &Row) {
    let mut first = 0;
    for (b, body) in scene.bodies.iter().enumerate() {
        let BodyModel::Deforming(model) = &body.model else {
            if let Some(gives) = scratch.bodies[b].gives() {
                for (sign, _) in row.sides_on(b) {
                    let moves = gives.moves(&gives.arm(row));
                    for (k, (moves, gain)) in moves.iter().zip(gives.turn_rad_nm).enumerate() {
                        scratch
                            .solver
                            .friction
                            .add_turn(first + k, gain, &(moves * sign));
                    }
                }
                first += TURNS;
            }
            continue;
        };
        let deformable = &model.deformable;
        if deformable.mode_count() > 0 && modes_of_row(b, deformable, scratch, row) {
            let moves = scratch
                .solver
                .mode_moves
                .iter()
                .zip(deformable.mode_gains());
            for (k, (moves, gain)) in moves.enumerate() {
                scratch.solver.friction.add_mode(first + k, *gain, moves);
            }
        }
        first += deformable.mode_count();
    }
    let pair = row.id.pair as usize;
    let dent = &scratch.solver.indentations[pair];
    if dent.slope_m_n > 0.0 && !row.id.key.is_anchor() {
        scratch
            .solver
            .friction
            .add_mode(first + pair, dent.slope_m_n, &dent.normal);
    }
    scratch.solver.friction.bound_turns();
}

/// How much a force of one row moves another, in terms of what their places give way.
fn direction(a: &Row, b: &Row, whole: bool) -> f64 {
    if whole { 1.0 } else { a.normal.dot(&b.normal) }
}
