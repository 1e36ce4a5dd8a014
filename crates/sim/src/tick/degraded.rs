//! Forces that are less accurate than the scene asks for.

use super::record::TickOutput;
use super::{Scratch, flags, quality};
use crate::scene::{BodyModel, Scene};
use crate::solve::rows::Holder;

/// Flags the tools that press on a body whose step does less than the scene asks for, or on one that presses
/// on such a body.
pub(super) fn mark(scene: &Scene, scratch: &mut Scratch, output: &mut TickOutput) {
    let level = output.quality;
    for (b, body) in scene.bodies.iter().enumerate() {
        let BodyModel::Deforming(model) = &body.model else {
            continue;
        };
        let fewer = level >= quality::ONE_ITERATION && model.deformable.iterations() > 1;
        let falls_back = scratch.bodies[b]
            .deforming
            .as_ref()
            .is_some_and(|parts| model.deformable.fall_back(&parts.deformable).is_some());
        scratch.degraded[b] = fewer || falls_back;
    }
    let count = scratch.rows.rows.len();
    loop {
        let mut more = false;
        for i in 0..count {
            let row = &scratch.rows.rows[i];
            let (a, holder) = (row.body as usize, row.holder);
            if let Holder::Body(b) = holder
                && scratch.degraded[a] != scratch.degraded[b as usize]
                && scratch.solver.carries(i)
            {
                (scratch.degraded[a], scratch.degraded[b as usize], more) = (true, true, true);
            }
        }
        if !more {
            break;
        }
    }
    for i in 0..count {
        let row = &scratch.rows.rows[i];
        if let Some(t) = row.tool()
            && (level >= quality::FEWER_SWEEPS || scratch.degraded[row.body as usize])
            && scratch.solver.carries(i)
        {
            output.tools[t].flags |= flags::DEGRADED;
        }
    }
}
