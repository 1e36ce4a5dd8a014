//! What the rows' forces come to: a wrench on each tool, and forces on the control points of
//! bodies.

use crate::haptics::{LinkPhase, limit};
use crate::party::{BodyScratch, Gives, ToolScratch, ToolState};
use crate::scene::{Body, BodyModel, DeformingBody, Tool};
use crate::solve::friction::{FrictionLaw, FrictionProblem};
use crate::solve::rows::{Holder, Row, RowSet};
use crate::solve::solver::Solver;
use palpate_geometry::math::{Point3, Vector3};

/// Force (N) and torque (N m) of the rows on tool `t`, about its reference point; `free`: where free motion
/// takes it.
pub(super) fn wrench(
    tool: &Tool,
    state: &ToolState,
    t: usize,
    rows: &[Row],
    solver: &Solver,
    free: &Point3,
) -> (Vector3, Vector3) {
    if solver.is_whole() {
        return whole_wrench(tool, state, t, rows, &solver.friction, free);
    }
    let turns = tool.coupling.turns();
    let ball = tool.shape.ball_radius_m().is_some();
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    let rows = rows.iter().zip(solver.problem.forces());
    for (row, &lambda) in rows.filter(|(row, _)| row.tool() == Some(t)) {
        let push = row.normal * lambda;
        force += push;
        if turns {
            // As the solve turned it.
            torque += row.arm.cross(&push);
        } else if !ball {
            torque += (row.point - free).cross(&push);
        }
    }
    (force, torque)
}

/// The same when forces have three components. Drag on a ball turns it about its centre; what
/// presses it does not.
fn whole_wrench(
    tool: &Tool,
    state: &ToolState,
    t: usize,
    rows: &[Row],
    friction: &FrictionProblem,
    free: &Point3,
) -> (Vector3, Vector3) {
    let own = || {
        rows.iter()
            .enumerate()
            .filter(|(_, row)| row.tool() == Some(t))
    };
    let force: Vector3 = own().map(|(i, _)| friction.force_n(i)).sum();
    let coupling = tool.coupling_for(&state.bounds);
    if coupling.turns() {
        return (
            force,
            own()
                .map(|(i, row)| row.arm.cross(&friction.force_n(i)))
                .sum(),
        );
    }
    let ball = tool.shape.ball_radius_m().is_some();
    let held: Point3 = free + force * coupling.compliance_m_n();
    let centre = if ball { held } else { *free };
    let turns = |i: usize, row: &Row| match row.law {
        FrictionLaw::Push { .. } if ball => friction.tangent_n(i),
        _ => friction.force_n(i),
    };
    let torque = own()
        .map(|(i, row)| (row.point - centre).cross(&turns(i, row)))
        .sum();
    (force, torque)
}

/// Sum of the sizes of the forces of the rows on a tool, N.
pub(super) fn pushes_n(rows: &[Row], solver: &Solver, t: usize) -> f64 {
    let own = rows.iter().enumerate();
    let own = own.filter(|(_, row)| row.tool() == Some(t));
    own.map(|(i, _)| match solver.is_whole() {
        true => solver.friction.force_n(i).norm(),
        false => solver.problem.forces()[i],
    })
    .sum()
}

/// What torque the device bears now, N m: it ramps as its force does.
pub(super) fn torque_limit_nm(tool: &Tool, state: &ToolState) -> f64 {
    let force_max_n = tool.limits.force_max_n.min(state.bounds.force_max_n);
    let most = tool.device.torque_max_nm.min(state.bounds.torque_max_nm);
    // Infinity times zero is not a number.
    if state.link.limit_n >= force_max_n {
        most
    } else {
        most.min(f64::MAX) * (state.link.limit_n / force_max_n)
    }
}

/// Writes what share of its rows' forces each tool's device bears.
pub(super) fn limit_tools(
    tools: &[Tool],
    states: &[ToolState],
    rows: &[Row],
    solver: &Solver,
    parts: &mut [ToolScratch],
) {
    for (t, state) in states.iter().enumerate() {
        if state.link.phase != LinkPhase::Absent {
            let (force, torque) = wrench(&tools[t], state, t, rows, solver, &parts[t].free);
            let limit_nm = torque_limit_nm(&tools[t], state);
            parts[t].borne = limit(force, torque, state.link.limit_n, limit_nm).1;
        }
    }
}

/// Force of a row on its holder, N, scaled as the hand's was; its body gets the opposite.
pub(super) fn on_bodies(row: &Row, i: usize, solver: &Solver, tools: &[ToolScratch]) -> Vector3 {
    let factor = row.tool().map_or(1.0, |tool| tools[tool].borne);
    match solver.is_whole() {
        true => solver.friction.force_n(i) * factor,
        false => row.normal * (solver.problem.forces()[i] * factor),
    }
}

/// ∓λ n N_i on the nodes of a row's sides, scaled as the hand's force was, for the bodies that are
/// `wanted`.
pub(super) fn push_bodies(
    constants: &[Body],
    rows: &RowSet,
    solver: &Solver,
    tools: &[ToolScratch],
    bodies: &mut [BodyScratch],
    i: usize,
    wanted: impl Fn(&DeformingBody) -> bool,
) {
    let row = &rows.rows[i];
    let factor = row.tool().map_or(1.0, |tool| tools[tool].borne);
    let whole = solver.is_whole().then(|| solver.friction.force_n(i));
    let lambda = solver.problem.forces()[i];
    let other = match row.holder {
        Holder::Body(other) if other != row.body => Some(other),
        _ => None,
    };
    for body in std::iter::once(row.body).chain(other) {
        let (BodyModel::Deforming(model), Some(deforming)) = (
            &constants[body as usize].model,
            &mut bodies[body as usize].deforming,
        ) else {
            continue;
        };
        if !wanted(model) {
            continue;
        }
        if row.tool().is_some() {
            model.deformable.handle(&mut deforming.deformable);
        }
        for (sign, range) in row.sides_on(body as usize) {
            let force = match whole {
                Some(push) => push * (sign * factor),
                None => row.normal * (sign * lambda * factor),
            };
            let (controls, weights) = rows.weights_in(range);
            for (&control, &weight) in controls.iter().zip(weights) {
                let node = model.deformable.coordinate_of_control(control as usize);
                model
                    .deformable
                    .push(&mut deforming.deformable, node, force * weight);
            }
        }
    }
}

/// Force (N) and moment about its centre of mass (N·m) of the contacts of the tick on a free body.
pub(super) fn load_on(
    rows: &[Row],
    solver: &Solver,
    tools: &[ToolScratch],
    body: usize,
    gives: &Gives,
) -> (Vector3, Vector3) {
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (i, row) in rows.iter().enumerate() {
        for (sign, _) in row.sides_on(body) {
            if solver.carries(i) {
                let push = on_bodies(row, i, solver, tools) * sign;
                force += push;
                moment += gives.arm(row).cross(&push);
            }
        }
    }
    (force, moment)
}
