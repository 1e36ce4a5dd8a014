//! What comes out of the contact solve: limited forces for the hands, loads for the bodies, reports
//! for everybody.

use crate::body::Field;
use crate::contact::bounce::is_between_rigid;
use crate::contact::feet::margin_m;
use crate::contact::warm::{Warm, WarmRow};
use crate::contact::{grip, lying};
use crate::haptics::{LinkPhase, Motion, RenderedForce, Wrench, limit};
use crate::party::{Around, Party as _, torque_limit_nm};
use crate::party::{BodyScratch, ToolScratch, ToolState};
use crate::rest::Rest;
use crate::scene::Scene;
use crate::solve::friction::FrictionLaw;
use crate::solve::rows::Row;
use crate::solve::rows::RowSet;
use crate::solve::solver::Solver;
use crate::tick::flags;
use crate::tick::record::{ContactReport, TickOutput, ToolOutput};
use palpate_geometry::math::{Vector3, turn_between};

/// Limits the forces, and writes what the tools get.
pub(crate) fn write(
    scene: &Scene,
    tools: &mut [ToolState],
    tool_parts: &mut [ToolScratch],
    rows: &RowSet,
    solver: &Solver,
    rest: &Rest,
    output: &mut TickOutput,
) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let own = |row: &&Row| row.tool() == Some(t);
        let tool_state = &tools[t];
        let out = &mut output.tools[t];
        if tool_state.link.phase == LinkPhase::Absent {
            (out.proxy_position, out.proxy_orientation) =
                (tool_state.proxy, tool_state.orientation);
            continue;
        }
        let party = scene.tool_party(t);
        let tool_state = &mut tools[t];
        let parts = &mut tool_parts[t];
        let rendered = party.weigh(tool_state, parts, rows, solver);
        let still = Around {
            tools: &[],
            field: Field::default(),
            moving: false,
        };
        let fault = party.apply(&still, tool_state, parts);
        let let_go = tool_state.link.has_let_go();
        let (force, torque, factor) = (parts.force_n, parts.torque_nm, parts.borne);
        if !let_go {
            (out.contact_force_n, out.contact_torque_nm) = (force, torque);
        }
        if fault.is_some() {
            out.flags |= flags::FAULT;
            output.fault = fault;
        }
        let limit_nm = torque_limit_nm(tool, tool_state);
        let lifted = turn_between(&tool_state.link.pose.orientation, &tool_state.orientation);
        let device = tool_state.link.pose.position;
        for (i, row) in rows
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| own(row) && !let_go)
        {
            if !solver.carries(i) {
                continue;
            }
            let push = solver.force_n(i) * factor;
            out.contact_count += 1;
            let depth_m = row
                .normal
                .dot(&(parts.held - device + lifted.cross(&row.arm)))
                - solver.gap_after(i);
            let report = report(row, depth_m, push);
            if out.contact.is_none_or(|deepest| depth_m > deepest.depth_m) {
                out.contact = Some(report);
            }
            output.contacts.push(report, scene.tools.len());
        }
        // A device without motors for torque lacks nothing that it could have; a force that is on its way to
        // none is not held back for the device's sake.
        let wanted = tool_state.link.phase == LinkPhase::Live && out.flags & flags::PAUSED == 0;
        if wanted && (factor < 1.0 || limit_nm > 0.0 && rendered.torque_nm() != torque) {
            out.flags |= flags::SATURATED;
        }
        let (rendered, damped) = keep_passive(scene, tool_state, t, rendered, out, limit_nm);
        if damped {
            out.flags |= flags::DAMPED;
        }
        out.force_n = rendered.newtons();
        out.torque_nm = rendered.torque_nm();
        (out.proxy_position, out.proxy_orientation) = (tool_state.proxy, tool_state.orientation);
        (out.energy_j, out.dissipated_j) =
            (tool_state.port.energy_j(), tool_state.port.dissipated_j());
    }
    for (i, row) in rows
        .rows
        .iter()
        .enumerate()
        .filter(|(_, row)| row.tool().is_none())
    {
        if solver.carries(i) {
            let push = solver.force_n(i);
            output
                .contacts
                .push(report(row, -solver.gap_after(i), push), scene.tools.len());
        }
    }
    for (_, report) in &rest.reports {
        output.contacts.push(*report, scene.tools.len());
    }
    for t in 0..scene.tools.len() {
        grip::take(
            scene,
            (t, &mut tools[t]),
            &rows.rows,
            solver,
            &mut output.tools[t],
        );
    }
}

/// Adds the damper of the passivity controller, if the tool has one and needs it; what the device
/// then holds is remembered.
fn keep_passive(
    scene: &Scene,
    tool: &mut ToolState,
    t: usize,
    rendered: RenderedForce,
    out: &ToolOutput,
    limit_nm: f64,
) -> (RenderedForce, bool) {
    let wanted = Wrench {
        force_n: rendered.newtons(),
        torque_nm: rendered.torque_nm(),
    };
    let most = scene.tools[t].device.passivity_damping_n_s_m;
    let motion = Motion {
        moved: out.device_moved,
        turned: out.device_turned,
    };
    let damper = most.map_or(Wrench::default(), |most| {
        tool.port.damper(&wanted, &motion, scene.dt_s, most)
    });
    if damper == Wrench::default() {
        tool.port.hold(wanted, damper);
        return (rendered, false);
    }
    let (force_n, torque_nm) = (
        wanted.force_n + damper.force_n,
        wanted.torque_nm + damper.torque_nm,
    );
    let (held, _) = limit(force_n, torque_nm, tool.link.limit_n, limit_nm);
    let held_wrench = Wrench {
        force_n: held.newtons(),
        torque_nm: held.torque_nm(),
    };
    // The limit may have taken part of it.
    let damper = Wrench {
        force_n: held_wrench.force_n - wanted.force_n,
        torque_nm: held_wrench.torque_nm - wanted.torque_nm,
    };
    tool.port.hold(held_wrench, damper);
    (held, true)
}

fn report(row: &Row, depth_m: f64, force_n: Vector3) -> ContactReport {
    let Row {
        body,
        holder,
        u,
        v,
        point,
        normal,
        ..
    } = *row;
    ContactReport {
        body,
        holder,
        u,
        v,
        point,
        normal,
        depth_m,
        force_n,
    }
}

/// Such a contact is remembered though it does not carry: a tool that may turn, or a free body, may tip
/// onto it, and the foot of any tool on a deforming body goes along with it.
fn is_near(scene: &Scene, row: &Row, gap_m: f64) -> bool {
    let Some(tool) = row.tool().map(|tool| &scene.tools[tool]) else {
        return row.id.key.is_foot()
            && is_between_rigid(scene, row)
            && gap_m < lying::near_m(scene, row);
    };
    let body = &scene.bodies[row.body as usize];
    let deforms = body.is_soft();
    let radius_m = tool.shape.ball_radius_m().filter(|_| deforms);
    (tool.coupling.turns() || deforms && row.id.key.is_foot())
        && matches!(row.law, FrictionLaw::Push { .. })
        && gap_m < margin_m(radius_m.unwrap_or(0.0), body.size_m)
}

/// The warm start of the next tick.
pub(crate) fn remember(
    scene: &Scene,
    warm: &mut Warm,
    bodies: &mut [BodyScratch],
    rows: &RowSet,
    solver: &Solver,
    rest: &Rest,
) {
    warm.begin();
    for i in 0..rows.rows.len() {
        let row = rows.rows[i];
        let turns = row
            .tool()
            .is_some_and(|tool| scene.tools[tool].coupling.turns());
        let lasts = solver.carries(i) || is_near(scene, &row, solver.gap_after(i));
        if !lasts {
            continue;
        }
        warm.arms |= turns;
        let (Row { u, v, on_tool, .. }, force_n) = (row, solver.problem.normal_n(i));
        let on_tool = match turns || row.id.key.is_foot() {
            true => lying::on_holder(scene, bodies, &row).unwrap_or(on_tool),
            false => Vector3::zeros(),
        };
        warm.push(WarmRow {
            id: row.id,
            uv: if row.id.key.is_foot() {
                [u, v]
            } else {
                [0.0; 2]
            },
            force_n,
            on_tool,
            tangent_n: solver.problem.tangent_n(i),
            rubs: row.law.acts_across(),
            slips: solver.problem.slips(i),
            stick: solver.sticks[i],
        });
    }
    warm.merge(&rest.rows);
}
