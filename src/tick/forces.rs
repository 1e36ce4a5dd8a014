//! First half of a tick: from poses to forces.
//!
//! Contact, virtual couplings and bodies are solved together: rows of one tool share the compliance of its coupling, rows
//! on one body that of its surface, `D_ij = n_i · n_j ([same tool] / K' + [same body] N_iᵀ W N_j)`.

use super::record::{ContactReport, TickInput, TickOutput};
use crate::contact::ToolShape;
use crate::contact::proxy::BallContact;
use crate::contact::rows::{DeformingView, FOOT, Row};
use crate::haptics::{LinkPhase, limit};
use crate::math::Vector3;
use crate::scene::{BodyModel, BodyScratch, Scene, SceneState, Scratch, WarmRow, flags};

/// Takes the poses.
pub(super) fn admit(scene: &Scene, state: &mut SceneState, input: &TickInput, wanted: bool, output: &mut TickOutput) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let tool_state = &mut state.tools[t];
        let before = tool_state.link.pose.position;
        let admission = tool_state.link.admit(input.poses[t].as_ref(), &tool.limits, wanted);
        let link = &tool_state.link;
        let out = &mut output.tools[t];
        if admission.seated {
            tool_state.proxy = link.pose.position;
            out.device_moved = Vector3::zeros();
            for (pair, pair_state) in scene.pairs.iter().zip(&mut state.pairs) {
                if pair.tool == t {
                    *pair_state = Default::default();
                }
            }
        } else {
            out.device_moved = link.pose.position - before;
        }
        out.pose_seq = link.pose.seq;
        out.t_client_ns = link.pose.t_client_ns;
        out.pose_age_ticks = link.age_ticks;
        let mut bits = 0;
        if link.phase == LinkPhase::Stale {
            bits |= flags::STALE;
        }
        if admission.refused {
            bits |= flags::REFUSED;
        }
        if !wanted {
            bits |= flags::PAUSED;
        }
        if link.phase != LinkPhase::Absent && link.limit_n != tool.limits.force_max_n {
            bits |= flags::RAMPING;
        }
        out.flags = bits;
    }
}

/// Moves the proxies on the surfaces as they stand and writes the rows of the contact problem.
pub(super) fn gather(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, _output: &TickOutput) {
    scratch.rows.clear();
    for (t, tool) in scene.tools.iter().enumerate() {
        let link = state.tools[t].link;
        if link.phase == LinkPhase::Absent {
            continue;
        }
        let start = state.tools[t].proxy;
        let free = tool.coupling.free_position(&link.pose.position, &link.velocity(), &start);
        let mut centre = free;
        for (pair, pair_state) in scene.pairs.iter().zip(&mut state.pairs).filter(|(pair, _)| pair.tool == t) {
            let body = &scene.bodies[pair.body];
            let BodyScratch { surface, solver, deforming } = &mut scratch.bodies[pair.body];
            let row = Row::new(t, pair.body);
            let moved = state.bodies[pair.body].moved_m;
            if let Some(radius_m) = tool.shape.ball_radius_m() {
                let mut ball =
                    BallContact { surface, solver, size_m: body.size_m, radius_m, two_sided: body.two_sided };
                let held = ball.constrain(&start, &centre, moved, &mut pair_state.proxy);
                match (&body.model, deforming) {
                    (BodyModel::Lattice(model), Some(deforming)) => {
                        let view = DeformingView {
                            body: pair.body as u32,
                            surface,
                            predicted: &deforming.predicted_net,
                            samples: &model.samples,
                        };
                        let margin = margin_m(radius_m, body.size_m);
                        if radius_m > 0.0 && held.gap_m < radius_m {
                            view.ball_rows(&mut scratch.rows, t as u32, &held.centre, &free, radius_m, margin);
                        }
                        let at = (held.foot.u, held.foot.v);
                        view.foot_row(&mut scratch.rows, t as u32, at, held.normal, &free, radius_m, margin);
                    }
                    _ => {
                        if held.gap_m < 0.0 {
                            scratch.rows.push_rigid(Row {
                                normal: held.normal,
                                gap_m: held.gap_m,
                                point: held.foot.point,
                                u: held.foot.u,
                                v: held.foot.v,
                                ..row
                            });
                        }
                    }
                }
                centre = held.centre;
            } else if let ToolShape::Plane { normal } = &tool.shape {
                let plane = link.pose.orientation * normal;
                match (&body.model, deforming) {
                    (BodyModel::Lattice(model), Some(deforming)) => {
                        let view = DeformingView {
                            body: pair.body as u32,
                            surface,
                            predicted: &deforming.predicted_net,
                            samples: &model.samples,
                        };
                        let margin = margin_m(0.0, body.size_m);
                        view.plane_rows(&mut scratch.rows, t as u32, &free, &plane, margin);
                    }
                    _ => {
                        let (u, v, point) = solver.deepest_along(surface, &-plane);
                        let gap_m = (point - free).dot(&plane);
                        if gap_m < 0.0 {
                            scratch.rows.push_rigid(Row { normal: -plane, gap_m, point, u, v, ..row });
                        }
                    }
                }
            }
        }
        scratch.rows.proxies[t] = centre;
        scratch.rows.free[t] = free;
    }
}

/// Rows join a little before they touch, so that a bulge is met by a row in the tick in which it rises.
fn margin_m(radius_m: f64, size_m: f64) -> f64 {
    if radius_m > 0.0 { 0.02 * radius_m } else { 1e-4 * size_m }
}

/// Solves for the force of every row.
pub(super) fn solve(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch) {
    let count = scratch.rows.rows.len();
    scratch.problem.begin(count);
    if count == 0 {
        return;
    }
    let mut sweeps = 1;
    for i in 0..count {
        let a = scratch.rows.rows[i];
        let compliance = scene.tools[a.tool as usize].coupling.compliance_m_n();
        for j in 0..count {
            let b = &scratch.rows.rows[j];
            if a.tool == b.tool {
                scratch.problem.row_mut(i)[j] = compliance * a.normal.dot(&b.normal);
            }
        }
    }
    for (b, body) in scene.bodies.iter().enumerate() {
        if let BodyModel::Lattice(model) = &body.model {
            sweeps = sweeps.max(model.sweeps);
            add_body_compliance(b, &model.lattice, scratch);
        }
    }
    if count > 1 {
        // Rows on rigid bodies are few: enough sweeps for a corner of three planes.
        sweeps = sweeps.max(50);
    }
    let mut warm = state.warm[..state.warm_len].iter().peekable();
    for (i, row) in scratch.rows.rows.iter().enumerate() {
        // Both lists are ordered by key.
        while warm.next_if(|old| old.key < row.key()).is_some() {}
        let force = warm.next_if(|old| old.key == row.key()).map_or(0.0, |old| old.force_n);
        scratch.problem.set(i, row.gap_m, force);
    }
    scratch.problem.solve(sweeps);
}

/// Adds n_i · n_j N_iᵀ W N_j for all rows on one body.
fn add_body_compliance(body: usize, lattice: &crate::body::Lattice, scratch: &mut Scratch) {
    let Scratch { rows, problem, response, involved, is_involved, .. } = scratch;
    involved.clear();
    for row in rows.rows.iter().filter(|row| row.body as usize == body) {
        for &control in rows.weights_of(row).0 {
            if let Some(unknown) = lattice.unknown(lattice.node_of_control(control as usize))
                && !is_involved[unknown]
            {
                is_involved[unknown] = true;
                involved.push(unknown as u32);
            }
        }
    }
    for (i, a) in rows.rows.iter().enumerate().filter(|(_, row)| row.body as usize == body) {
        // What a unit force on this row does to the nodes concerned.
        for &unknown in involved.iter() {
            response[unknown as usize] = 0.0;
        }
        let (controls, weights) = rows.weights_of(a);
        for (&control, &weight) in controls.iter().zip(weights) {
            if let Some(column) = lattice.compliance_of(lattice.node_of_control(control as usize)) {
                for &unknown in involved.iter() {
                    response[unknown as usize] += weight * column[unknown as usize];
                }
            }
        }
        for (j, b) in rows.rows.iter().enumerate().skip(i).filter(|(_, row)| row.body as usize == body) {
            let (controls, weights) = rows.weights_of(b);
            let mut moved = 0.0;
            for (&control, &weight) in controls.iter().zip(weights) {
                if let Some(unknown) = lattice.unknown(lattice.node_of_control(control as usize)) {
                    moved += weight * response[unknown];
                }
            }
            let entry = a.normal.dot(&b.normal) * moved;
            problem.row_mut(i)[j] += entry;
            if j > i {
                problem.row_mut(j)[i] += entry;
            }
        }
    }
    for &unknown in involved.iter() {
        is_involved[unknown as usize] = false;
    }
}

/// Limits the forces, loads the bodies with their opposites, and writes what the tools get.
pub(super) fn emit(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, output: &mut TickOutput) {
    state.warm_len = 0;
    for (t, tool) in scene.tools.iter().enumerate() {
        let own = |row: &&Row| row.tool as usize == t;
        let forces = scratch.problem.forces();
        let tool_state = &mut state.tools[t];
        let out = &mut output.tools[t];
        out.proxy_orientation = tool_state.orientation();
        if tool_state.link.phase == LinkPhase::Absent {
            out.proxy_position = tool_state.proxy;
            continue;
        }
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (row, &lambda) in scratch.rows.rows.iter().zip(forces).filter(|(row, _)| own(row)) {
            let push = row.normal * lambda;
            force += push;
            if tool.shape.ball_radius_m().is_none() {
                torque += (row.point - scratch.rows.free[t]).cross(&push);
            }
        }
        let (rendered, factor) = limit(force, torque, tool_state.link.limit_n);
        let free = scratch.rows.free[t];
        let held = free + force * tool.coupling.compliance_m_n();
        // A saturated coupling lets the device in further than the balance knows; the proxy then stays on the surface.
        let whole = factor == 1.0 && held.iter().all(|x| x.is_finite());
        tool_state.proxy = if whole { held } else { scratch.rows.proxies[t] };
        let device = tool_state.link.pose.position;
        let mut depth = 0.0;
        for (i, row) in scratch.rows.rows.iter().enumerate().filter(|(_, row)| own(row)) {
            let lambda = scratch.problem.forces()[i];
            if lambda <= 0.0 {
                continue;
            }
            out.contact_count += 1;
            let below = row.normal.dot(&(held - device)) - scratch.problem.gap_after(i);
            if out.contact.is_none() || below > depth {
                depth = below;
                let (u, v) = parameter(scene, row);
                out.contact =
                    Some(ContactReport { body: row.body, u, v, point: row.point, normal: row.normal, depth_m: below });
            }
        }
        if factor < 1.0 {
            out.flags |= flags::SATURATED;
        }
        out.force_n = rendered.newtons();
        out.torque_nm = rendered.torque_nm();
        out.proxy_position = tool_state.proxy;
        tool_state.energy_j -= out.force_n.dot(&out.device_moved);
        out.energy_j = tool_state.energy_j;
        scratch.rows.factors[t] = factor;
    }
    load_bodies(scene, state, scratch);
}

fn parameter(scene: &Scene, row: &Row) -> (f64, f64) {
    match &scene.bodies[row.body as usize].model {
        BodyModel::Lattice(model) if row.sample != FOOT => model.samples.parameter(row.sample as usize),
        _ => (row.u, row.v),
    }
}

/// −λ n N_i on the nodes of every row, scaled as the hand's force was; and the warm start of the next tick.
fn load_bodies(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch) {
    let Scratch { bodies, rows, problem, .. } = scratch;
    for (row, &lambda) in rows.rows.iter().zip(problem.forces()) {
        if lambda == 0.0 || !lambda.is_finite() {
            continue;
        }
        state.warm[state.warm_len] = WarmRow { key: row.key(), force_n: lambda };
        state.warm_len += 1;
        let body = &scene.bodies[row.body as usize];
        if let (BodyModel::Lattice(model), Some(deforming)) = (&body.model, &mut bodies[row.body as usize].deforming) {
            let force = row.normal * -(lambda * rows.factors[row.tool as usize]);
            let (controls, weights) = rows.weights_of(row);
            for (&control, &weight) in controls.iter().zip(weights) {
                let node = model.lattice.node_of_control(control as usize);
                model.lattice.push(&mut deforming.lattice, node, force * weight);
            }
        }
    }
}
