//! Why the forces of a tick are what they are.
//!
//! A row carries the force that closes its gap after free motion against the compliance of all that
//! gives way under it: the coupling, the bodies, the near field of a ball. Each of these numbers is
//! computed here from the parties alone, beside the matrix that the solve used, and a debug build
//! compares both.

use crate::body::{FallBack, Ledger};
use crate::party::{Begun, BodyScratch, BodyState, Party as _, Problem};
use crate::scene::Scene;
use crate::solve::friction::FrictionLaw;
use crate::solve::rows::{Holder, Row};
use crate::tick::balance::Balance;
use crate::tick::record::TickOutput;
use serde::Serialize;
use std::collections::BTreeMap;

/// Why the forces of one tick are what they are. Made by [`step_explained`](crate::tick::step_explained).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// The tick.
    pub tick: u64,
    /// Level of quality; 0 is full.
    pub quality: u8,
    /// Tools, in the order of the scene.
    pub tools: Vec<ToolExplained>,
    /// Rows of the contact solve, in its order.
    pub rows: Vec<RowExplained>,
    /// How the solve ended.
    pub solve: SolveExplained,
    /// Bodies that deform, in the order of the scene.
    pub bodies: Vec<BodyExplained>,
}

/// How the solve of a tick ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SolveExplained {
    /// Direct steps after the sweeps: none without a free rigid body, or where it has too many rows.
    pub direct_steps: usize,
    /// The most by which the law of a row would still change its force, relative to the largest force.
    pub left: f64,
}

/// The sum of a tool's rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolExplained {
    /// Its id.
    pub tool: String,
    /// Force for the device, N, world axes.
    pub force_n: [f64; 3],
    /// Sum of its rows' forces, N.
    pub contact_force_n: [f64; 3],
    /// Share of it that the device's limits let through.
    pub borne: f64,
    /// How far the force may be from that of the exact step, N.
    pub error_n: f64,
    /// Bits of [`flags`](crate::tick::flags).
    pub flags: u32,
}

/// One unilateral constraint between two parties, or one anchor of a grip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowExplained {
    /// The body's id.
    pub body: String,
    /// The other party: a tool's id, or a body's.
    pub holder: String,
    /// An anchor of a grip: it also pulls.
    pub grip: bool,
    /// On the body's surface, m.
    pub point_m: [f64; 3],
    /// From the body to the holder.
    pub normal: [f64; 3],
    /// Gap as the surfaces stand, m; negative inside.
    pub gap_m: f64,
    /// Gap after free motion of both parties, m: without contact forces.
    pub gap_free_m: f64,
    /// How much the gap opens for each newton of this row alone.
    pub compliance_m_per_n: ComplianceExplained,
    /// Force along the normal, N, before the device's limits.
    pub force_n: f64,
    /// Force across the normal, N.
    pub tangent_n: [f64; 3],
    /// What is left of the gap under all forces where the row carries, m; of others, how far they are
    /// inside (0 outside).
    pub residual_m: f64,
}

/// Compliance along a row's normal.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ComplianceExplained {
    /// m/N: `tool:ID` is a coupling, `body:ID` what a body gives way, `near_field` how far a ball goes in
    /// beyond what a net shows, `ease` what other rows carry instead of it.
    pub by_party: BTreeMap<String, f64>,
    /// All of it, m/N.
    pub sum: f64,
}

/// How well a deforming body's step solves its own equation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyExplained {
    /// Its id.
    pub body: String,
    /// Norm over all coordinates of M (z − y)/dt² less all forces at the end of the step, N; none where the tick ended no step of a matrix.
    pub residual_n: Option<f64>,
    /// Norm of the contact forces on its coordinates, N, to compare it with.
    pub contact_n: f64,
    /// Matrix of the step: `tangent`, `firmer` or `bounding`; none of methods without one.
    pub matrix: Option<&'static str>,
    /// The fall-back of the step that acts, if one does.
    pub fall_back: Option<FallBack>,
    /// Where the energy of the step went; none where the tick ended no step of a matrix.
    pub energy: Option<Ledger>,
}

/// The tick after contact has been solved and before bodies move.
pub(crate) fn of_contact(balance: &mut Balance<'_>, output: &TickOutput) -> Explanation {
    let scene = balance.scene;
    let tools = (0..scene.tool_count()).map(|t| {
        let out = &output.tools[t];
        ToolExplained {
            tool: scene.tool_id(t).to_owned(),
            force_n: out.force_n.into(),
            contact_force_n: out.contact_force_n.into(),
            borne: balance.tool_parts[t].borne,
            error_n: out.error_n,
            flags: out.flags,
        }
    });
    let mut explanation = Explanation {
        tick: output.tick,
        quality: output.quality,
        tools: tools.collect(),
        solve: SolveExplained {
            direct_steps: balance.solver.direct.steps(),
            left: balance.solver.problem.missed(),
        },
        ..Explanation::default()
    };
    for i in 0..balance.rows.rows.len() {
        let explained = explain_row(balance, i);
        explanation.rows.push(explained);
    }
    explanation
}

fn explain_row(balance: &mut Balance<'_>, i: usize) -> RowExplained {
    let row = balance.rows.rows[i];
    let compliance = compliance(balance, &row);
    let (scene, solver) = (balance.scene, &*balance.solver);
    let solved = solver.matrix.along(i);
    debug_assert!(
        (compliance.sum - solved).abs() <= 1e-9 * solved,
        "row {i}: the parties give way by {} m/N, the solve by {solved}",
        compliance.sum
    );
    let (force_n, tangent_n) = (solver.problem.normal_n(i), solver.problem.tangent_n(i));
    let after_m = solver.gap_after(i);
    let holder = match row.holder {
        Holder::Tool(tool) => scene.tool_id(tool as usize),
        Holder::Body(body) => scene.body_id(body as usize),
    };
    let grip = matches!(row.law, FrictionLaw::Grip { .. });
    RowExplained {
        body: scene.body_id(row.body as usize).to_owned(),
        holder: holder.to_owned(),
        grip,
        point_m: row.point.coords.into(),
        normal: row.normal.into(),
        gap_m: row.now_m,
        gap_free_m: row.gap_m,
        compliance_m_per_n: compliance,
        force_n,
        tangent_n: tangent_n.into(),
        residual_m: match force_n > 0.0 || grip {
            true => after_m,
            false => after_m.min(0.0),
        },
    }
}

/// What gives way along a row's normal under a force of that row.
fn compliance(balance: &mut Balance<'_>, row: &Row) -> ComplianceExplained {
    let scene = balance.scene;
    let mut by_party = BTreeMap::new();
    let mut add = |party: String, m_per_n: f64| {
        if m_per_n != 0.0 {
            *by_party.entry(party).or_insert(0.0) += m_per_n;
        }
    };
    let Balance {
        tools,
        states,
        tool_parts,
        bodies,
        rows,
        solver,
        ..
    } = balance;
    let problem = &mut Problem { rows, solver };
    for (t, tool) in scene.tool_parties().enumerate() {
        let m_per_n = tool.gives(&tools[t], &tool_parts[t], row, problem);
        add(format!("tool:{}", scene.tool_id(t)), m_per_n);
    }
    for (b, body) in scene.parties().enumerate() {
        let m_per_n = body.gives(&states[b], &bodies[b], row, problem);
        add(format!("body:{}", scene.body_id(b)), m_per_n);
    }
    let indentation = &balance.solver.indentations[row.id.pair as usize];
    if !row.id.key.is_anchor() {
        add(
            "near_field".to_owned(),
            indentation.slope_m_n * row.normal.dot(&indentation.normal).powi(2),
        );
    }
    let sum: f64 = by_party.values().sum();
    let eased = sum * row.regularization;
    if eased != 0.0 {
        by_party.insert("ease".to_owned(), eased);
    }
    ComplianceExplained {
        by_party,
        sum: sum + eased,
    }
}

/// The steps of a tick whose contact has been solved, before they are taken.
pub(crate) fn steps(
    scene: &Scene,
    states: &[BodyState],
    parts: &[BodyScratch],
) -> Vec<(usize, Begun)> {
    let bodies = scene.parties().enumerate();
    let begun = bodies.filter_map(|(b, body)| Some((b, body.begun(&states[b], &parts[b])?)));
    begun.collect()
}

/// How those steps ended.
pub(crate) fn of_bodies(
    scene: &Scene,
    states: &[BodyState],
    moved: bool,
    steps: Vec<(usize, Begun)>,
) -> Vec<BodyExplained> {
    let ended = steps.into_iter().filter_map(|(b, step)| {
        let ended = scene.party(b).balance(&step, &states[b], moved)?;
        Some(BodyExplained {
            body: scene.body_id(b).to_owned(),
            residual_n: ended.residual_n,
            contact_n: ended.contact_n,
            matrix: step.matrix,
            fall_back: step.fall_back,
            energy: ended.energy,
        })
    });
    ended.collect()
}
