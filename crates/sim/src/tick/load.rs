//! What the rows' forces come to on tools and bodies.

use crate::haptics::LinkPhase;
use crate::party::{BodyScratch, ToolScratch, ToolState};
use crate::scene::Scene;
use crate::solve::rows::{Holder, Row, RowSet};
use crate::solve::solver::Solver;
use palpate_geometry::math::Vector3;

/// Sum of the sizes of the forces of the rows on a tool, N.
pub(crate) fn pushes_n(rows: &[Row], solver: &Solver, t: usize) -> f64 {
    let own = rows.iter().enumerate();
    let own = own.filter(|(_, row)| row.tool() == Some(t));
    own.map(|(i, _)| solver.force_n(i).norm()).sum()
}

/// Finds what share of its rows' forces each tool's device bears.
pub(crate) fn limit_tools(
    scene: &Scene,
    states: &[ToolState],
    rows: &RowSet,
    solver: &Solver,
    parts: &mut [ToolScratch],
) {
    for (t, tool) in scene.tool_parties().enumerate() {
        if states[t].link.phase != LinkPhase::Absent {
            tool.weigh(&states[t], &mut parts[t], rows, solver);
        }
    }
}

/// Force of a row on its holder, N, scaled as the hand's was; its body gets the opposite.
pub(crate) fn on_bodies(row: &Row, i: usize, solver: &Solver, tools: &[ToolScratch]) -> Vector3 {
    let factor = row.tool().map_or(1.0, |tool| tools[tool].borne);
    solver.force_n(i) * factor
}

/// Gives a row's force, scaled as the hand's was, to its bodies whose steps have more iterations than
/// `iteration`.
pub(crate) fn push_bodies(
    scene: &Scene,
    rows: &RowSet,
    solver: &Solver,
    tools: &[ToolScratch],
    bodies: &mut [BodyScratch],
    i: usize,
    iteration: usize,
) {
    let row = &rows.rows[i];
    let push_n = on_bodies(row, i, solver, tools);
    let other = match row.holder {
        Holder::Body(other) if other != row.body => Some(other),
        _ => None,
    };
    for body in std::iter::once(row.body).chain(other) {
        let body = body as usize;
        (scene.party(body)).take(&mut bodies[body], rows, row, push_n, iteration);
    }
}
