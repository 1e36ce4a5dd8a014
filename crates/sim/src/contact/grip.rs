//! Grips: made where a tool touches while its button is down, held as rows, let go.

use super::feet::{HeldPoint, margin_m, push_anchor};
use crate::haptics::LinkPhase;
use crate::party::ToolScratch;
use crate::party::view;
use crate::party::{BodyScratch, ToolState};
use crate::scene::Scene;
use crate::solve::friction::FrictionLaw;
use crate::solve::grip::{GRAB, GripState, MAX_ANCHORS, apart_m, strength};
use crate::solve::row_key::RowKey;
use crate::solve::rows::{Row, RowSet};
use crate::solve::solver::Solver;
use crate::tick::flags;
use crate::tick::record::ToolOutput;
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::Vector3;

/// Brings the grips in line with the buttons and with where their points have come.
pub(crate) fn update(scene: &Scene, tools: &mut [ToolState], bodies: &[BodyScratch]) {
    for ToolState {
        link,
        proxy,
        orientation,
        grip,
        ..
    } in tools
    {
        if link.phase == LinkPhase::Absent || link.pose.buttons & GRAB == 0 {
            *grip = GripState::default();
            continue;
        }
        let rotation = *orientation;
        let body_of = |pair: u32| scene.pairs[pair as usize].body;
        if grip.fresh {
            grip.fresh = false;
            for anchor in grip.anchors_mut() {
                let on_surface = bodies[body_of(anchor.pair)].skin.point(anchor.u, anchor.v);
                anchor.offset = rotation.inverse_transform_vector(&(on_surface - *proxy));
            }
        } else if grip.holds() {
            grip.retain(|anchor| {
                let body = body_of(anchor.pair);
                let on_surface = bodies[body].skin.point(anchor.u, anchor.v);
                let on_tool = *proxy + rotation * anchor.offset;
                strength(apart_m(&on_tool, &on_surface), scene.bodies[body].size_m) > 0.0
            });
        }
    }
}

/// Rows of what tool `t` holds of the body of pair `p`.
pub(crate) fn push_anchors(
    scene: &Scene,
    (t, state): (usize, &ToolState),
    (p, below): (usize, bool),
    tool: &ToolScratch,
    parts: &BodyScratch,
    rows: &mut RowSet,
) {
    let ToolState { proxy, grip, .. } = state;
    let pair = &scene.pairs[p];
    let body = &scene.bodies[pair.body];
    let side = if below { -1.0 } else { 1.0 };
    for anchor in grip
        .anchors()
        .iter()
        .filter(|anchor| anchor.pair as usize == p)
    {
        let on_body = parts.skin.point(anchor.u, anchor.v);
        let arm = tool.free_turn * anchor.offset;
        let share = scene.tools[t].grip_n * grip.part();
        let limit_n = share * strength(apart_m(&(proxy + arm), &on_body), body.size_m);
        let on_tool = tool.free + arm;
        let normal = parts.skin.normal(anchor.u, anchor.v) * side;
        // A row needs some direction to be reported by, even at a pole.
        let normal = if normal.iter().all(|x| x.is_finite()) {
            normal
        } else {
            Vector3::z()
        };
        let away = on_tool - on_body;
        let (u, v) = (anchor.u, anchor.v);
        let contact = Contact {
            u,
            v,
            on_body,
            on_tool,
            normal,
            depth_m: -away.dot(&normal),
            tool_uv: None,
            point: ToolPoint::Found,
        };
        push_anchor(
            rows,
            p,
            pair,
            RowKey::Anchor(anchor.number as u8),
            &HeldPoint {
                contact,
                away,
                arm,
                limit_n,
            },
            view(body, parts).as_ref(),
            &parts.step,
        );
    }
}

/// Grabs what the tool touches now, if its button is down and it has not grabbed yet.
pub(crate) fn take(
    scene: &Scene,
    (t, tool_state): (usize, &mut ToolState),
    rows: &[Row],
    solver: &Solver,
    out: &mut ToolOutput,
) {
    let tool = &scene.tools[t];
    let grip = &mut tool_state.grip;
    if tool_state.link.pose.buttons & GRAB != 0 && tool.grip_n > 0.0 && grip.is_open() {
        let touches = |(i, row): &(usize, &Row)| {
            let margin = margin_m(
                tool.shape.ball_radius_m().unwrap_or(0.0),
                scene.bodies[row.body as usize].size_m,
            );
            row.tool() == Some(t)
                && matches!(row.law, FrictionLaw::Push { .. })
                && solver.gap_after(*i) < margin
        };
        let all = || rows.iter().enumerate().filter(touches);
        // Evenly over all of them when there are too many.
        let count = all().count();
        for (k, (_, row)) in all().enumerate() {
            if count <= MAX_ANCHORS || k * MAX_ANCHORS / count != (k + 1) * MAX_ANCHORS / count {
                grip.make(row.id.pair, row.u, row.v);
            }
        }
    }
    if grip.holds() && !tool_state.link.has_let_go() {
        out.flags |= flags::GRABBING;
    }
}
