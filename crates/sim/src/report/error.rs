//! How far the forces of a tick are from those of the exact step of the same dt from the same state.
//!
//! A tick solves equations that are linear about where it starts, once or a few times. Where it arrives, three things
//! are left of the true ones, and each is looked at there:
//!
//! - the body's own equation: loads r that neither inertia nor matter nor contact balances, of the coordinates that
//!   contact forces press. They move row i by J_i A r, A the operator by which the step answers contact;
//! - the gap: that between the places of both parties now, less the linear one;
//! - the normal n': it has turned, and the force f with it; what that changes of the load counts in r.
//!
//! Under gaps off by these the rows are solved for once more, on the same matrix D and from the forces that are there.
//! The difference of a tool's forces, and what their turning makes, is one more Newton step of the whole tick, as far as
//! contact sees it; the error is twice that. Where the step has converged it is zero, but for one thing: a point of a tool
//! that stays in touch ([`crate::contact`]) pushes along the body's normal, not along its own, and where it is not quite the
//! deepest one both differ at rest, too.
//!
//! Not seen: what is left of the equation beyond the coordinates that carry; bodies that take several ticks a step, or
//! step without a matrix; gaps of B-spline tools and between bodies.

use crate::party::{ToolScratch, ToolState};
use crate::solve::friction::FrictionLaw;
use crate::solve::problem::ContactProblem;
use crate::solve::rows::{Holder, Row};
use crate::tick::balance::Balance;
use crate::tick::flags;
use crate::tick::record::TickOutput;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::dispatch::{Method, Narrow};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3};

/// Sweeps over the rows: they start from the forces that are there, and only the sum counts.
const SWEEPS: usize = 5;
/// Times what that step changes: further ones would go on. Where each changes at most half as much as the one before, all
/// of them together change no more.
const FURTHER: f64 = 2.0;
/// An error that a hand may feel: more than this, N, and more than this share of the force.
const FELT_N: f64 = 0.02;
const FELT_SHARE: f64 = 0.05;
/// A normal that turns by more than this is another one (cosine).
const SAME_NORMAL: f64 = 0.5;
/// How far from a row's gap the tool's is looked for, m: any that can be.
const REACH_M: f64 = f64::INFINITY;

/// Buffers for the errors of a tick.
#[derive(Debug)]
pub(crate) struct Errors {
    /// By row: how much farther apart its parties are than the solve knows, m.
    off: Vec<Vector3>,
    /// By row: what its force on the holder lacks because its normal has turned, N.
    turned: Vec<Vector3>,
    problem: ContactProblem,
    /// By tool, N.
    pub error_n: Vec<f64>,
}

impl Errors {
    /// Room for so many rows, whose forces have so many directions together.
    pub fn new(rows: usize, directions: usize, tools: usize) -> Self {
        Self {
            off: Vec::with_capacity(rows),
            turned: Vec::with_capacity(rows),
            problem: ContactProblem::new(rows, directions),
            error_n: vec![0.0; tools],
        }
    }
}

/// Estimates them, once parties are where their forces take them. `pairs`: as contacts were looked for.
pub(crate) fn estimate(balance: &mut Balance<'_>, pairs: &[Narrow], errors: &mut Errors) {
    let Errors {
        off,
        turned,
        problem,
        error_n,
    } = errors;
    error_n.fill(0.0);
    let scene = balance.scene;
    let soft = |row: &Row| {
        let holder = match row.holder {
            Holder::Body(b) => scene.bodies[b as usize].is_soft(),
            Holder::Tool(_) => false,
        };
        holder || scene.bodies[row.body as usize].is_soft()
    };
    let count = balance.rows.rows.len();
    if !balance.rows.rows.iter().any(soft) {
        return;
    }
    for (t, tool) in scene.tool_parties().enumerate() {
        // As rows push now.
        tool.weigh(
            &balance.tools[t],
            &mut balance.tool_parts[t],
            balance.rows,
            balance.solver,
        );
    }
    off.clear();
    turned.clear();
    for i in 0..count {
        let (gap_m, normal) = look(balance, pairs, i).unwrap_or_default();
        let row = &balance.rows.rows[i];
        off.push(row.normal * gap_m);
        turned.push(normal * balance.solver.problem.normal_n(i));
    }
    for (b, body) in scene.parties().enumerate() {
        body.miss(
            &balance.states[b],
            &mut balance.bodies[b],
            balance.rows,
            balance.solver,
            turned,
            off,
        );
    }
    let (rows, solver) = (&balance.rows.rows, &*balance.solver);
    problem.set_off(&solver.problem, off);
    problem.solve(&solver.matrix, SWEEPS);
    for (t, error_n) in error_n.iter_mut().enumerate() {
        let own = (0..count).filter(|&i| rows[i].tool() == Some(t));
        let changes = own.map(|i| problem.force_n(i) - solver.problem.force_n(i) + turned[i]);
        *error_n = changes.sum::<Vector3>().norm() * FURTHER * balance.tool_parts[t].borne;
    }
}

/// Writes them into the output, and flags the tools whose forces are far off.
pub(crate) fn report(
    errors: &Errors,
    tools: &[ToolState],
    tool_parts: &[ToolScratch],
    output: &mut TickOutput,
) {
    for (t, &error_n) in errors.error_n.iter().enumerate() {
        if tools[t].link.feels_nothing() {
            continue;
        }
        let out = &mut output.tools[t];
        out.error_n = error_n;
        let force_n = out.contact_force_n.norm() * tool_parts[t].borne;
        if error_n > FELT_N && error_n > FELT_SHARE * force_n {
            out.flags |= flags::DEGRADED;
        }
    }
}

/// Of a row of a tool that carries, how much wider its gap is now than the linear one, m, and how much its normal has
/// turned.
fn look(balance: &Balance<'_>, pairs: &[Narrow], i: usize) -> Option<(f64, Vector3)> {
    let (scene, row) = (balance.scene, &balance.rows.rows[i]);
    let t = row.tool().filter(|_| balance.solver.carries(i))?;
    if !matches!(row.law, FrictionLaw::Push { .. }) {
        return None;
    }
    let shape = &scene.tools[t].shape;
    if matches!(shape, ToolShape::Surface(_)) {
        return None;
    }
    let b = row.body as usize;
    let at = (scene.party(b)).side_at(&balance.bodies[b], balance.rows, row.on_body)?;
    let pair = row.id.pair as usize;
    let mut pose = (scene.tool_party(t)).pose_held(&balance.tools[t], &balance.tool_parts[t]);
    if shape.ball_radius_m().is_some() && scene.pairs[pair].method == Method::Exact {
        // Its rows know no orientation.
        pose = Pose::from_parts(pose.translation, Rotation::identity());
    }
    let on_tool: Point3 = pose * Point3::from(row.on_tool);
    let linear_m = row.normal.dot(&(on_tool - at));
    let facing = pairs[pair].facing(shape, &pose, &at, REACH_M)?;
    let same = facing.normal.dot(&row.normal) > SAME_NORMAL;
    same.then(|| (facing.gap_m - linear_m, facing.normal - row.normal))
}
