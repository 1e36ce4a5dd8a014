//! Bodies that rest on others.
//!
//! A pile that lies still costs as much as one that falls, tick after tick, for the same forces.
//! So bodies that nothing but other bodies touches, and in which nothing has moved for a while, are left
//! alone together with their contacts: neither queries nor steps, until anything that is not at rest, a
//! tool or a body, comes near one of those they may lean on. The forces of their contacts stay in the
//! state; what is reported of them is computed once.

use crate::contact::near::Near;
use crate::contact::warm::WarmRow;
use crate::haptics::LinkPhase;
use crate::party::{Around, BodyScratch, BodyState};
use crate::scene::{Pair, Scene};
use crate::solve::rows::Holder;
use crate::tick::record::ContactReport;

/// Settles which bodies sleep in this tick. Pairs that can touch are marked.
pub(crate) fn settle(
    scene: &Scene,
    around: &Around<'_>,
    bodies: &mut [BodyState],
    parts: &mut [BodyScratch],
    near: &Near,
    rest: &mut Rest,
) {
    let quiet =
        |bodies: &[BodyState], b: usize| bodies[b].lies_still() && scene.party(b).may_rest();
    if !(0..bodies.len()).any(|b| quiet(bodies, b)) {
        return;
    }
    let awake = &mut rest.awake;
    for (b, body) in scene.bodies.iter().enumerate() {
        awake[b] = match body.is_firm() {
            true => moves(&bodies[b], &parts[b]),
            false => !quiet(bodies, b),
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
        let leave = quiet(bodies, b) && !awake[b];
        if bodies[b].is_left_alone() != leave {
            (scene.party(b)).leave_alone(around, &mut bodies[b], &mut parts[b], leave);
        }
    }
}

/// What gives way to nothing has moved or will.
fn moves(state: &BodyState, parts: &BodyScratch) -> bool {
    state.moved_m > 0.0 || parts.step.most_m > 0.0
}

/// Both bodies of a pair sleep, or one and the other is rigid and stands still.
pub(crate) fn lies(
    scene: &Scene,
    states: &[BodyState],
    parts: &[BodyScratch],
    pair: &Pair,
) -> bool {
    let Holder::Body(other) = pair.holder else {
        return false;
    };
    let firm = |b: usize| scene.bodies[b].is_firm();
    let still = |b: usize| match firm(b) {
        true => !moves(&states[b], &parts[b]),
        false => states[b].is_left_alone(),
    };
    let (a, b) = (pair.body, other as usize);
    still(a) && still(b) && !(firm(a) && firm(b))
}

/// Buffers; the state says which bodies sleep.
#[derive(Debug, Default)]
pub(crate) struct Rest {
    /// By body: something moves it, or may.
    pub awake: Vec<bool>,
    /// By pair: `reports` holds its contacts.
    pub reported: Vec<bool>,
    /// Contacts of sleeping pairs, by pair.
    pub reports: Vec<(u32, ContactReport)>,
    /// Their rows, in order.
    pub rows: Vec<WarmRow>,
}

impl Rest {
    pub(crate) fn new(scene: &Scene) -> Self {
        let between = |pair: &&Pair| matches!(pair.holder, Holder::Body(_));
        let most = match scene.pairs.iter().filter(between).count() {
            0 => 0,
            _ => scene.most_rows(),
        };
        Self {
            awake: vec![false; scene.bodies.len()],
            reported: vec![false; scene.pairs.len()],
            reports: Vec::with_capacity(most),
            rows: Vec::with_capacity(most),
        }
    }

    /// What it holds is of another state.
    pub(crate) fn forget(&mut self) {
        self.reported.fill(false);
        self.reports.clear();
        self.rows.clear();
    }
    /// A pair is awake.
    pub(crate) fn wake(&mut self, p: usize) {
        if std::mem::take(&mut self.reported[p]) {
            self.reports.retain(|(pair, _)| *pair != p as u32);
        }
    }
}
