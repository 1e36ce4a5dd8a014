//! Bodies that rest on others.
//!
//! A pile that lies still costs as much as one that falls, tick after tick, to come to the same forces.
//! So bodies that nothing but other bodies touches, and in which nothing has moved for a while, are left
//! alone together with their contacts: neither queries nor steps, until anything that is not at rest, a
//! tool or a body, comes near one of those they may lean on. The forces of their contacts stay in the
//! state; what is reported of them is computed once.

use super::between::bodies;
use super::record::ContactReport;
use super::{SceneState, Scratch, WarmRow};
use crate::haptics::LinkPhase;
use crate::party::rigid;
use crate::scene::{Body, BodyModel, Pair, Scene};
use crate::solve::rows::Holder;

/// Such a body can be left alone.
fn may_rest(body: &Body) -> bool {
    match &body.model {
        BodyModel::Deforming(model) => model.every == 1,
        BodyModel::Rigid => body.free().is_some(),
    }
}

/// Settles which bodies are left alone in this tick. Pairs that can touch are marked.
pub(super) fn settle(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, moving: bool) {
    let calm =
        |state: &SceneState, b: usize| state.bodies[b].lies_calm() && may_rest(&scene.bodies[b]);
    if !(0..scene.bodies.len()).any(|b| calm(state, b)) {
        return;
    }
    let Scratch {
        near, rest, bodies, ..
    } = scratch;
    let awake = &mut rest.awake;
    for (b, body) in scene.bodies.iter().enumerate() {
        awake[b] = match &body.model {
            BodyModel::Rigid if body.free().is_some() => !calm(state, b),
            BodyModel::Rigid => state.bodies[b].moved_m > 0.0 || bodies[b].step.most_m > 0.0,
            BodyModel::Deforming(_) => !calm(state, b),
        };
    }
    let pairs = || (scene.pairs.iter().enumerate()).filter(|&(p, _)| near.is_near(p));
    for (_, pair) in pairs() {
        if let Holder::Tool(t) = pair.holder
            && state.tools[t as usize].link.phase != LinkPhase::Absent
        {
            awake[pair.body] = true;
        }
    }
    let gives = |b: usize| !scene.bodies[b].is_firm();
    loop {
        let mut more = false;
        for (_, pair) in pairs() {
            let Holder::Body(other) = pair.holder else {
                continue;
            };
            for (from, to) in [(pair.body, other as usize), (other as usize, pair.body)] {
                if awake[from] && !awake[to] && gives(to) {
                    (awake[to], more) = (true, true);
                }
            }
        }
        if !more {
            break;
        }
    }
    for b in 0..scene.bodies.len() {
        let leave = calm(state, b) && !scratch.rest.awake[b];
        if let Some(flight) = state.bodies[b]
            .rigid
            .as_mut()
            .and_then(|body| body.flight_mut())
        {
            if flight.is_left_alone() != leave {
                flight.leave_alone(leave);
                rigid::aim(
                    scene,
                    &scene.bodies[b],
                    &state.bodies[b],
                    &state.tools,
                    &mut scratch.bodies[b],
                    moving,
                );
            }
            continue;
        }
        let Some(deformable) = &mut state.bodies[b].deformable else {
            continue;
        };
        if deformable.is_left_alone() == leave {
            continue;
        }
        deformable.leave_alone(leave);
        scene.prepare_body(b, state, scratch, false);
    }
}

/// Both bodies of a pair are left alone, or one and the other is rigid and stands still.
pub(super) fn lies(scene: &Scene, state: &SceneState, scratch: &Scratch, pair: &Pair) -> bool {
    let Holder::Body(other) = pair.holder else {
        return false;
    };
    let firm = |b: usize| scene.bodies[b].is_firm();
    let still = |b: usize| match firm(b) {
        true => state.bodies[b].moved_m == 0.0 && scratch.bodies[b].step.most_m == 0.0,
        false => state.bodies[b].is_left_alone(),
    };
    let (a, b) = (pair.body, other as usize);
    still(a) && still(b) && !(firm(a) && firm(b))
}

/// Keeps the rows of a pair that is left alone, and sees to it that they can be reported.
pub(super) fn keep(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, p: usize) {
    let own = |row: &&WarmRow| row.id.pair as usize == p;
    scratch.rest.rows.extend(state.warm.of_pair(p));
    if scratch.rest.reported[p] {
        return;
    }
    scratch.rest.reported[p] = true;
    let Holder::Body(other) = scene.pairs[p].holder else {
        return;
    };
    // Looks once more, and leaves no trace but the reports.
    let before = state.pairs[p];
    bodies(scene, state, scratch, p, other as usize);
    state.pairs[p] = before;
    let Scratch { rest, rows, .. } = scratch;
    for row in rows.of_pair() {
        let mut kept = rest.rows.iter().filter(own);
        let Some(kept) = kept.find(|kept| kept.id == row.id && kept.force_n > 0.0) else {
            continue;
        };
        let report = ContactReport {
            body: row.body,
            holder: row.holder,
            u: row.u,
            v: row.v,
            point: row.point,
            normal: row.normal,
            depth_m: -row.now_m,
            force_n: row.normal * kept.force_n + kept.tangent_n,
        };
        if rest.reports.len() < rest.reports.capacity() {
            let at = rest.reports.partition_point(|(pair, _)| *pair <= p as u32);
            rest.reports.insert(at, (p as u32, report));
        }
    }
    rows.drop_pair();
}

/// A pair is not left alone.
pub(super) fn wake(scratch: &mut Scratch, p: usize) {
    if std::mem::take(&mut scratch.rest.reported[p]) {
        scratch.rest.reports.retain(|(pair, _)| *pair != p as u32);
    }
}
