//! Bodies that rest on others.
//!
//! A pile that lies still costs as much as one that falls, tick after tick, to come to the same forces.
//! So bodies that nothing but other bodies touches, and in which nothing has moved for a while, are left
//! alone together with their contacts: neither queries nor steps, until anything that is not at rest, a
//! tool or a body, comes near one of those they may lean on. The forces of their contacts stay in the
//! state; what is reported of them is computed once.

use super::between::bodies;
use super::record::ContactReport;
use super::resting::Rest;
use super::scratch::Near;
use super::{SceneState, Scratch, WarmRow};
use crate::haptics::LinkPhase;
use crate::party::{Around, BodyScratch, BodyState};
use crate::scene::{Pair, Scene};
use crate::solve::rows::Holder;

/// Settles which bodies are left alone in this tick. Pairs that can touch are marked.
pub(super) fn settle(
    scene: &Scene,
    around: &Around<'_>,
    bodies: &mut [BodyState],
    parts: &mut [BodyScratch],
    near: &Near,
    rest: &mut Rest,
) {
    let calm = |bodies: &[BodyState], b: usize| bodies[b].lies_calm() && scene.party(b).may_rest();
    if !(0..bodies.len()).any(|b| calm(bodies, b)) {
        return;
    }
    let awake = &mut rest.awake;
    for (b, body) in scene.bodies.iter().enumerate() {
        awake[b] = match body.is_firm() {
            true => moves(&bodies[b], &parts[b]),
            false => !calm(bodies, b),
        };
    }
    let pairs = || (scene.pairs.iter().enumerate()).filter(|&(p, _)| near.is_near(p));
    for (_, pair) in pairs() {
        if let Holder::Tool(t) = pair.holder
            && around.tools[t as usize].link.phase != LinkPhase::Absent
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
    for b in 0..bodies.len() {
        let leave = calm(bodies, b) && !awake[b];
        if bodies[b].is_left_alone() != leave {
            (scene.party(b)).leave_alone(around, &mut bodies[b], &mut parts[b], leave);
        }
    }
}

/// What gives way to nothing has moved or will.
fn moves(state: &BodyState, parts: &BodyScratch) -> bool {
    state.moved_m > 0.0 || parts.step.most_m > 0.0
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
