//! Forces that are less accurate than the scene asks for.

use crate::party::{BodyScratch, ToolState};
use crate::scene::Scene;
use crate::solve::rows::{Holder, Row};
use crate::solve::solver::Solver;
use crate::tick::record::TickOutput;
use crate::tick::{flags, quality};

/// Flags the tools that press on a body whose step does less than the scene asks for, or on one that presses
/// on such a body. A tool that feels nothing has no force that could be less accurate.
pub(crate) fn mark(
    scene: &Scene,
    tools: &[ToolState],
    bodies: &[BodyScratch],
    rows: &[Row],
    solver: &Solver,
    degraded: &mut [bool],
    output: &mut TickOutput,
) {
    let level = output.quality;
    for (b, body) in scene.parties().enumerate() {
        degraded[b] = body.is_degraded(level, &bodies[b]);
    }
    let count = rows.len();
    loop {
        let mut more = false;
        for i in 0..count {
            let (a, holder) = (rows[i].body as usize, rows[i].holder);
            if let Holder::Body(b) = holder
                && degraded[a] != degraded[b as usize]
                && solver.carries(i)
            {
                (degraded[a], degraded[b as usize], more) = (true, true, true);
            }
        }
        if !more {
            break;
        }
    }
    for i in 0..count {
        let row = &rows[i];
        if let Some(t) = row.tool()
            && (level >= quality::FEWER_SWEEPS || degraded[row.body as usize])
            && solver.carries(i)
            && !tools[t].link.feels_nothing()
        {
            output.tools[t].flags |= flags::DEGRADED;
        }
    }
}
