//! Feet between samples that carry.
//!
//! The deepest point of a contact is a row of its own, so that no small tool sinks in between samples. Under a tool that lies
//! on many samples the surface bulges between them by microns, and which of the bulges is deepest changes with every tick:
//! rows there would push each in its turn, and the force would tremble. So the row of a foot gives way as the four samples
//! around it come to be pressed, smoothly from nothing to everything.

use super::feet::{MAX_FEET, margin_m};
use crate::contact::friction::Law;
use crate::contact::rows::{FOOT, Row};
use crate::scene::{BodyModel, Scene, Scratch};

/// Covered entirely is next to entirely: the row stays, with a billionth of its force.
const MOST: f64 = 1.0 - 1e-9;

/// Adds to the compliance of every foot on a deforming body what its samples take over.
pub(super) fn ease_feet(scene: &Scene, scratch: &mut Scratch) {
    let Scratch { rows, problem, .. } = scratch;
    for (i, foot) in rows.rows.iter().enumerate().filter(|(_, row)| is_foot(row)) {
        let body = &scene.bodies[foot.body as usize];
        let BodyModel::Lattice(model) = &body.model else { continue };
        let Some(around) = model.samples.around(foot.u, foot.v) else { continue };
        let radius_m = foot.tool().and_then(|tool| scene.tools[tool].shape.ball_radius_m()).unwrap_or(0.0);
        let margin = margin_m(radius_m, body.size_m);
        let pressed = |sample: usize| {
            // Rows are ordered by key.
            let found = rows.rows.binary_search_by_key(&[foot.pair, sample as u32], Row::key);
            found.map_or(0.0, |row| (-rows.rows[row].gap_m / margin).clamp(0.0, MOST))
        };
        let share = around.into_iter().map(pressed).fold(MOST, f64::min);
        let own = problem.entry(i, i);
        problem.row_mut(i)[i] = own + own * (share / (1.0 - share));
    }
}

fn is_foot(row: &Row) -> bool {
    row.sample > FOOT - MAX_FEET as u32 && matches!(row.law, Law::Push { .. })
}
