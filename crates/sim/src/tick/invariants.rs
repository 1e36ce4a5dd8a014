//! What holds after each stage of a tick, asserted in debug builds. What is no number is a fault, which the tick
//! reports itself, and passes here.

use super::record::TickOutput;
use super::state::SceneState;
use super::{flags, quality};
use crate::contact::Warm;
use crate::haptics::LinkPhase;
use crate::party::{BodyScratch, ToolScratch, ToolState};
use crate::scene::{Body, Scene};
use crate::solve::friction::FrictionLaw;
use crate::solve::grip::{GRAB, MAX_ANCHORS};
use crate::solve::rows::{Holder, MAX_ROWS_PER_PAIR, Range, RowSet};
use crate::solve::solver::Solver;
use palpate_geometry::math::{Point3, Rotation};
use std::cmp::Ordering;

/// Rounding of sums of a few terms, relative.
const ROUNDING: f64 = 1e-9;

fn at_least(a: f64, b: f64) -> bool {
    a.partial_cmp(&b) != Some(Ordering::Less)
}

fn at_most(a: f64, b: f64) -> bool {
    a.partial_cmp(&b) != Some(Ordering::Greater)
}

fn is_unit(rotation: &Rotation) -> bool {
    let off = (rotation.as_vector().norm_squared() - 1.0).abs();
    at_most(off, ROUNDING)
}

/// Predict: where free motion takes the parties.
pub(super) fn of_motion(scene: &Scene, tools: &[ToolScratch], bodies: &[BodyScratch]) {
    debug_assert_eq!(tools.len(), scene.tools.len(), "buffers of tools");
    debug_assert_eq!(bodies.len(), scene.bodies.len(), "buffers of bodies");
    for (body, parts) in scene.bodies.iter().zip(bodies) {
        let (low, high) = &parts.bounds;
        let points = || parts.skin.points().iter();
        let below = |a: &Point3, b: &Point3| (0..3).all(|axis| at_most(a[axis], b[axis]));
        debug_assert!(at_least(parts.step.most_m, 0.0), "a way is no length");
        debug_assert!(below(low, high), "a box is turned inside out");
        debug_assert!(points().all(|p| below(low, p)), "a net leaves its box");
        debug_assert!(points().all(|p| below(p, high)), "a net leaves its box");
        let stands = body.mover.is_none();
        debug_assert!(!stands || parts.step.most_m == 0.0, "it does not move");
        debug_assert!(body.free().is_some() || parts.gives().is_none(), "firm");
    }
}

/// Contacts: the rows of the contact problem.
pub(super) fn of_rows(scene: &Scene, tools: &[ToolState], rows: &RowSet) {
    let all = &rows.rows;
    debug_assert!(
        all.len() <= scene.most_rows(),
        "more rows than there is room for"
    );
    debug_assert!(
        all.is_sorted_by(|a, b| a.id < b.id),
        "rows are out of order"
    );
    for of_pair in all.chunk_by(|a, b| a.id.pair == b.id.pair) {
        debug_assert!(
            of_pair.len() <= MAX_ROWS_PER_PAIR,
            "too many rows of a pair"
        );
    }
    for row in all {
        let pair = &scene.pairs[row.id.pair as usize];
        debug_assert_eq!(row.body as usize, pair.body, "a row of another body");
        debug_assert_eq!(row.holder, pair.holder, "a row of another holder");
        let off = (row.normal.norm_squared() - 1.0).abs();
        debug_assert!(
            at_most(off, 1e-6),
            "a normal of length {}",
            row.normal.norm()
        );
        debug_assert!(
            at_least(row.regularization, 0.0),
            "a row stiffer than its parties"
        );
        debug_assert!(at_least(row.counts_m, 0.0), "a row that counts as outside");
        let weights = |body: &Body, range: Range| {
            let (controls, weights) = rows.weights_in(range);
            let net = body.skin.points().len();
            debug_assert_eq!(controls.is_empty(), !body.is_soft(), "rigid has no weights");
            debug_assert!(
                controls.iter().all(|&c| (c as usize) < net),
                "no control point"
            );
            let off = (weights.iter().sum::<f64>() - 1.0).abs();
            debug_assert!(
                controls.is_empty() || off < ROUNDING,
                "weights do not sum to 1"
            );
        };
        weights(&scene.bodies[pair.body], row.on_body);
        match row.holder {
            Holder::Tool(t) => {
                let away = tools[t as usize].link.phase == LinkPhase::Absent;
                debug_assert!(
                    rows.weights_in(row.on_holder).0.is_empty(),
                    "a tool has no weights"
                );
                debug_assert!(!away, "a row of an absent tool");
            }
            Holder::Body(other) => weights(&scene.bodies[other as usize], row.on_holder),
        }
        match row.law {
            FrictionLaw::Push { mu, drag_n_m } => {
                debug_assert!(mu >= 0.0, "friction that drives");
                debug_assert!(drag_n_m >= 0.0, "drag that drives");
                debug_assert!(
                    mu == 0.0 || pair.friction.is_some(),
                    "friction of a smooth pair"
                );
            }
            FrictionLaw::Grip { limit_n } => {
                debug_assert!(limit_n >= 0.0, "a grip below none");
                debug_assert!(row.tool().is_some(), "bodies do not grip");
                debug_assert!(row.id.key.is_anchor(), "a grip without an anchor");
            }
        }
    }
}

/// Solve: the matrix and the forces of the rows.
pub(super) fn of_forces(rows: &RowSet, solver: &Solver) {
    let (problem, matrix) = (&solver.problem, &solver.matrix);
    debug_assert_eq!(matrix.rows(), rows.rows.len(), "a force a row");
    for a in 0..matrix.size() {
        let own = matrix.entry(a, a);
        debug_assert!(
            at_least(own, 0.0),
            "direction {a} gives way against its force"
        );
        for b in 0..a {
            let most = own.max(matrix.entry(b, b));
            let there_and_back = (matrix.entry(a, b) - matrix.entry(b, a)).abs();
            debug_assert!(
                at_most(there_and_back, ROUNDING * most),
                "directions {a}, {b}: one-sided"
            );
        }
    }
    for i in 0..rows.rows.len() {
        let (normal_n, tangent_n) = (problem.normal_n(i), problem.tangent_n(i).norm());
        match problem.law(i) {
            FrictionLaw::Push { mu, drag_n_m } => {
                debug_assert!(at_least(normal_n, 0.0), "row {i} pulls");
                let most_n = mu * normal_n * (1.0 + 1e-6) + 1e-12;
                let within = drag_n_m > 0.0 || at_most(tangent_n, most_n);
                debug_assert!(within, "row {i}: {tangent_n} N across, {normal_n} N along");
            }
            FrictionLaw::Grip { limit_n } => {
                let force_n = problem.force_n(i).norm();
                let most_n = limit_n * (1.0 + 1e-6) + 1e-12;
                debug_assert!(
                    at_most(force_n, most_n),
                    "grip {i} holds {force_n} N of {limit_n}",
                );
            }
        }
    }
}

/// Report: forces for the hands, and what is kept of contact.
pub(super) fn of_output(
    scene: &Scene,
    tools: &[ToolState],
    parts: &[ToolScratch],
    warm: &Warm,
    output: &TickOutput,
) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let (own, out) = (&tools[t], &output.tools[t]);
        let (limit_n, force_n) = (own.link.limit_n, out.force_n.norm());
        debug_assert!(at_least(limit_n, 0.0), "a limit below none");
        debug_assert!(
            limit_n <= tool.limits.force_max_n,
            "more than the device bears"
        );
        debug_assert!(
            at_most(force_n, limit_n * (1.0 + ROUNDING)),
            "{force_n} N of {limit_n}",
        );
        debug_assert!(
            at_least(parts[t].borne, 0.0) && at_most(parts[t].borne, 1.0),
            "no share",
        );
        let holds = own.grip.holds();
        debug_assert!(
            !holds || own.link.pose.buttons & GRAB != 0,
            "a grip of an open hand"
        );
        debug_assert!(own.grip.anchors().len() <= MAX_ANCHORS, "too many anchors");
        let away = own.link.phase == LinkPhase::Absent;
        debug_assert!(!away || force_n == 0.0, "a force on an absent tool");
        debug_assert!(
            !away || out.contact_count == 0,
            "a contact of an absent tool"
        );
        let withheld = out.flags & flags::WITHHELD != 0;
        debug_assert!(!withheld || force_n == 0.0, "a withheld force that is felt");
    }
    of_memory(scene, warm);
}

/// Rows that are kept from tick to tick.
fn of_memory(scene: &Scene, warm: &Warm) {
    let rows = warm.rows();
    debug_assert!(
        rows.len() <= scene.most_rows(),
        "more rows kept than there are"
    );
    debug_assert!(
        rows.is_sorted_by(|a, b| a.id < b.id),
        "kept rows are out of order"
    );
    for row in rows {
        debug_assert!(
            (row.id.pair as usize) < scene.pairs.len(),
            "a row of no pair"
        );
        debug_assert!(
            at_least(row.force_n, 0.0) || row.id.key.is_anchor(),
            "a contact that pulled"
        );
        let across = row.slips || row.tangent_n.norm_squared() > 0.0;
        debug_assert!(!across || row.rubs, "friction of a smooth row");
    }
}

impl SceneState {
    /// Apply: the state after the tick.
    pub(super) fn check(&self, scene: &Scene) {
        debug_assert!(self.quality <= quality::LOWEST, "no such quality");
        debug_assert_eq!(self.bodies.len(), scene.bodies.len(), "states of bodies");
        debug_assert_eq!(self.tools.len(), scene.tools.len(), "states of tools");
        debug_assert_eq!(self.pairs.len(), scene.pairs.len(), "states of pairs");
        for pair in &self.pairs {
            debug_assert!(
                at_least(pair.proxy.clear_m, 0.0),
                "clear by less than nothing"
            );
            debug_assert!(at_least(pair.proxy.deepest_m, 0.0), "deeper than outside");
        }
        for (b, (body, own)) in scene.bodies.iter().zip(&self.bodies).enumerate() {
            debug_assert_eq!(
                own.deformable.is_some(),
                body.is_soft(),
                "body {b}: state of a kind"
            );
            debug_assert_eq!(
                own.rigid.is_some(),
                body.mover.is_some(),
                "body {b}: state of a kind"
            );
            debug_assert!(at_least(own.moved_m, 0.0), "body {b}: a way is no length");
            debug_assert!(
                own.phase < scene.steps_every(b).max(1),
                "body {b}: a step too long"
            );
            debug_assert!(
                !own.put_off || scene.steps_apart(b),
                "body {b}: no step to put off"
            );
            debug_assert_eq!(
                own.loads.is_empty(),
                !scene.steps_apart(b),
                "body {b}: loads kept"
            );
            debug_assert!(
                !own.is_left_alone() || own.lies_still(),
                "body {b}: resting in motion"
            );
            debug_assert!(
                !body.is_firm() || !own.lies_still(),
                "body {b}: firm and resting"
            );
            debug_assert!(
                body.free().is_none() || own.rigid.is_none_or(|rigid| is_unit(&rigid.rotation)),
                "body {b}: turned"
            );
        }
    }
}
