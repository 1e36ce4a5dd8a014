//! Feet between samples that carry.
//!
//! The deepest point of a contact is a row of its own, so that no small tool sinks in between
//! samples. Under a tool that lies on many samples the surface bulges between them by microns, and
//! which of the bulges is deepest changes with every tick: rows there would push each in its turn,
//! and the force would tremble. So the row of a foot gives way as the four samples around it come
//! to be pressed, smoothly from nothing to everything; and it is named after its place between the
//! samples, so that the next tick knows it again. A foot that carried stays a row where it was,
//! unless a new one takes its place: pressed flat it is no deepest point any more, and without its
//! row it would bulge again.

use super::feet::margin_m;
use crate::scene::{BodyModel, Scene, Scratch};
use crate::solve::friction::Law;
use crate::solve::rows::{DeformingView, FOOT, LEAST_FOOT, Row, RowSet};
use palpate_geometry::contact::Contact;

/// Covered so far, a foot is left out.
const MOST: f64 = 0.999;
/// Feet without four samples around them are numbered down from [`FOOT`], the others from there
/// less this.
pub(super) const UNPLACED: u32 = 64;

/// Name of the row of the `k`-th contact; `None` if rows of samples hold that place already, or
/// another foot does.
pub(super) fn foot_name(
    rows: &RowSet,
    p: usize,
    k: usize,
    contact: &Contact,
    view: Option<&DeformingView<'_>>,
    margin: f64,
) -> Option<u32> {
    let around = view.and_then(|view| view.samples.around(contact.u, contact.v));
    let here = rows.of_pair();
    debug_assert!(
        here.iter().all(|row| row.pair as usize == p),
        "rows of another pair"
    );
    let Some(around) = around else {
        let name = FOOT - (k as u32).min(UNPLACED - 1);
        return here.iter().all(|row| row.sample != name).then_some(name);
    };
    let name = FOOT - UNPLACED - around[0] as u32;
    let share = pressed(around, margin, |sample| {
        here.iter().find(|row| row.sample == sample)
    });
    (share < MOST && here.iter().all(|row| row.sample != name)).then_some(name)
}

/// Adds to the compliance of every foot on a deforming body what its samples take over.
pub(super) fn ease_feet(scene: &Scene, scratch: &mut Scratch) {
    let Scratch { rows, problem, .. } = scratch;
    for (i, foot) in rows.rows.iter().enumerate().filter(|(_, row)| is_foot(row)) {
        let body = &scene.bodies[foot.body as usize];
        let BodyModel::Deforming(model) = &body.model else {
            continue;
        };
        let Some(around) = model.samples.around(foot.u, foot.v) else {
            continue;
        };
        let radius_m = foot
            .tool()
            .and_then(|tool| scene.tools[tool].shape.ball_radius_m())
            .unwrap_or(0.0);
        let share = pressed(around, margin_m(radius_m, body.size_m), |sample| {
            // Rows are ordered by key.
            let found = rows
                .rows
                .binary_search_by_key(&[foot.pair, sample], Row::key);
            found.ok().map(|row| &rows.rows[row])
        });
        let own = problem.entry(i, i);
        problem.row_mut(i)[i] = own + own * (share / (1.0 - share));
    }
}

/// How much the least pressed of four samples carries: 0 where it does not touch, [`MOST`] where it
/// is deeper than the margin in free motion.
fn pressed<'a>(around: [usize; 4], margin: f64, row: impl Fn(u32) -> Option<&'a Row>) -> f64 {
    let depth = |sample: usize| {
        row(sample as u32).map_or(0.0, |row| (-row.gap_m / margin).clamp(0.0, MOST))
    };
    around.into_iter().map(depth).fold(MOST, f64::min)
}

fn is_foot(row: &Row) -> bool {
    row.sample >= LEAST_FOOT && matches!(row.law, Law::Push { .. })
}
