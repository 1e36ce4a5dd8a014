//! What comes out of the contact solve: limited forces for the hands, loads for the bodies, reports for everybody.

use super::record::{ContactReport, TickOutput};
use super::{grip, load, stick};
use crate::contact::rows::Row;
use crate::haptics::{LinkPhase, limit};
use crate::math::Vector3;
use crate::scene::{Method, Scene, SceneState, Scratch, WarmRow, flags};

/// Limits the forces, loads the bodies with their opposites, and writes what the tools get.
pub(super) fn emit(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, output: &mut TickOutput) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let own = |row: &&Row| row.tool() == Some(t);
        let tool_state = &mut state.tools[t];
        let out = &mut output.tools[t];
        out.proxy_orientation = tool_state.orientation();
        if tool_state.link.phase == LinkPhase::Absent {
            out.proxy_position = tool_state.proxy;
            continue;
        }
        let ball = tool.shape.ball_radius_m().is_some();
        let free = scratch.rows.free[t];
        let (force, torque) = load::wrench(scene, scratch, t);
        (out.contact_force_n, out.contact_torque_nm) = (force, torque);
        let (rendered, factor) = limit(force, torque, tool_state.link.limit_n);
        let held = free + force * tool.coupling.compliance_m_n();
        // A saturated coupling lets the device in further than the balance knows: a ball then stays on the surface as it
        // stands; other shapes see at the next tick how far they are in.
        let guarded = ball && scene.pairs.iter().all(|pair| pair.tool() != Some(t) || pair.method == Method::Exact);
        // A grip holds it where it is whatever the device bears.
        let whole = (factor == 1.0 || !guarded || tool_state.grip.holds()) && held.iter().all(|x| x.is_finite());
        tool_state.proxy = if whole { held } else { scratch.rows.proxies[t] };
        let device = tool_state.link.pose.position;
        for (i, row) in scratch.rows.rows.iter().enumerate().filter(|(_, row)| own(row)) {
            let lambda = scratch.problem.forces()[i];
            let (carries, push) = if scratch.friction.is_active() {
                let push = scratch.friction.force_n(i);
                (push != Vector3::zeros(), push * factor)
            } else {
                (lambda > 0.0, row.normal * (lambda * factor))
            };
            if !carries {
                continue;
            }
            out.contact_count += 1;
            let depth_m = row.normal.dot(&(held - device)) - scratch.gap_after(i);
            let report = report(row, depth_m, push);
            if out.contact.is_none_or(|deepest| depth_m > deepest.depth_m) {
                out.contact = Some(report);
            }
            output.contacts.push(report);
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
    for (i, row) in scratch.rows.rows.iter().enumerate().filter(|(_, row)| row.tool().is_none()) {
        let lambda = scratch.problem.forces()[i];
        if lambda > 0.0 {
            let push = if scratch.friction.is_active() { scratch.friction.force_n(i) } else { row.normal * lambda };
            output.contacts.push(report(row, -scratch.gap_after(i), push));
        }
    }
    for t in 0..scene.tools.len() {
        grip::take(scene, state, scratch, t, &mut output.tools[t]);
    }
    load_bodies(scene, state, scratch);
}

fn report(row: &Row, depth_m: f64, force_n: Vector3) -> ContactReport {
    let Row { body, holder, u, v, point, normal, .. } = *row;
    ContactReport { body, holder, u, v, point, normal, depth_m, force_n }
}

/// Forces of all rows on the bodies, and the warm start of the next tick.
fn load_bodies(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch) {
    state.warm_len = 0;
    state.warm_friction = scratch.friction.is_active();
    for i in 0..scratch.rows.rows.len() {
        if !load::carries(scratch, i) {
            continue;
        }
        let (Row { u, v, .. }, force_n) = (scratch.rows.rows[i], scratch.problem.forces()[i]);
        let mut warm = WarmRow { key: scratch.rows.rows[i].key(), uv: [u, v], force_n, ..WarmRow::default() };
        if scratch.friction.is_active() {
            warm.tangent_n = scratch.friction.tangent_n(i);
            warm.slips = scratch.friction.slips(i);
            warm.stick = stick::kept(i, scratch);
        }
        state.warm[state.warm_len] = warm;
        state.warm_len += 1;
        load::push_bodies(scene, scratch, i, |_| true);
    }
}
