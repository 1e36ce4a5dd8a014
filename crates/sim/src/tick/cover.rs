//! Feet between samples that carry.
//!
//! The deepest point of a contact is a row of its own, so that no small tool sinks in between
//! samples. Under a tool that lies on many samples the surface bulges between them by microns, and
//! which of the bulges is deepest changes with every tick: rows there would push each in its turn,
//! and the force would tremble. So the row of a foot gives way as the four samples around it come
//! to be pressed, smoothly from nothing to everything; and it is named after its place between the
//! samples, so that the next tick knows it again. A foot that carried stays a row where it was,
//! unless a new one takes its place: pressed flat it is no longer a deepest point, and without its
//! row it would bulge again.

use super::Scratch;
use super::feet::margin_m;
use crate::scene::{BodyModel, Scene};
use crate::solve::row_key::{RowId, RowKey};
use crate::solve::rows::{DeformingView, Row, RowSet};
use palpate_geometry::contact::Contact;

/// Covered so far, a foot is left out.
const MOST: f64 = 0.999;

/// Key of the row of the `k`-th contact; `None` if rows of samples hold that place already, or
/// another foot does.
pub(super) fn foot_key(
    rows: &RowSet,
    p: usize,
    k: usize,
    contact: &Contact,
    view: Option<&DeformingView<'_>>,
    margin: f64,
) -> Option<RowKey> {
    let around = view.and_then(|view| view.samples.around(contact.u, contact.v));
    let here = rows.of_pair();
    debug_assert!(
        here.iter().all(|row| row.id.pair as usize == p),
        "rows of another pair"
    );
    let key = RowKey::foot(k, around);
    let share = around.map_or(0.0, |around| {
        pressed(around, margin, |sample| {
            here.iter().find(|row| row.id.key == sample)
        })
    });
    (share < MOST && here.iter().all(|row| row.id.key != key)).then_some(key)
}

/// Adds to the compliance of every foot on a deforming body what its samples take over.
pub(super) fn ease_feet(scene: &Scene, scratch: &mut Scratch) {
    let Scratch { rows, problem, .. } = scratch;
    let is_foot = |(_, row): &(usize, &Row)| row.id.key.is_foot();
    for (i, foot) in rows.rows.iter().enumerate().filter(is_foot) {
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
        let share = pressed(around, margin_m(radius_m, body.size_m), |key| {
            let id = RowId { key, ..foot.id };
            // Rows are ordered by it.
            let found = rows.rows.binary_search_by_key(&id, |row| row.id);
            found.ok().map(|row| &rows.rows[row])
        });
        let own = problem.entry(i, i);
        problem.row_mut(i)[i] = own + own * (share / (1.0 - share));
    }
}

/// How much the least pressed of four samples carries: 0 where it does not touch, [`MOST`] where it
/// is deeper than the margin in free motion.
fn pressed<'a>(around: [usize; 4], margin: f64, row: impl Fn(RowKey) -> Option<&'a Row>) -> f64 {
    let depth = |sample: usize| {
        row(RowKey::sample(sample)).map_or(0.0, |row| (-row.gap_m / margin).clamp(0.0, MOST))
    };
    around.into_iter().map(depth).fold(MOST, f64::min)
}
