//! Takes the poses: which are believed, and how much force their tools may feel.

use super::record::{TickInput, TickOutput};
use super::{PairState, ToolState, flags, load};
use crate::haptics::{LinkLimits, LinkPhase, Motion};
use crate::scene::{Scene, Tool};
use crate::solve::rows::Row;
use crate::solve::solver::Solver;
use palpate_geometry::math::turn_between;

/// A contact force of which no hand takes notice, N; of a weak device this share of what it bears.
const SMALL_N: f64 = 0.05;
const SMALL_SHARE: f64 = 0.01;

/// Bounds of a tool's link, with what its device bears.
fn limits_of(tool: &Tool, state: &ToolState) -> LinkLimits {
    LinkLimits {
        force_max_n: tool.limits.force_max_n.min(state.bounds.force_max_n),
        ..tool.limits
    }
}

/// Takes the poses.
pub(super) fn admit(
    scene: &Scene,
    tools: &mut [ToolState],
    pairs: &mut [PairState],
    input: &TickInput,
    wanted: bool,
    output: &mut TickOutput,
) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let tool_state = &mut tools[t];
        let before = tool_state.link.pose;
        let limits = limits_of(tool, tool_state);
        tool_state.link.pass(input.skipped, &limits, wanted);
        let admission = tool_state
            .link
            .admit(input.poses[t].as_ref(), &limits, wanted);
        let link = &tool_state.link;
        let out = &mut output.tools[t];
        if admission.seated {
            (tool_state.proxy, tool_state.orientation) =
                (link.pose.position, link.pose.orientation);
            for (pair, pair_state) in scene.pairs.iter().zip(pairs.iter_mut()) {
                if pair.tool() == Some(t) {
                    *pair_state = Default::default();
                }
            }
            tool_state.port.seat();
        } else {
            out.device_moved = link.pose.position - before.position;
            out.device_turned = turn_between(&before.orientation, &link.pose.orientation);
        }
        tool_state.port.observe(&Motion {
            moved: out.device_moved,
            turned: out.device_turned,
        });
        // Who sent a pose that is refused waits for its number too, and finds the flag there.
        let refused = input.poses[t].as_ref().filter(|_| admission.refused);
        let answered = refused.unwrap_or(&link.pose);
        (out.pose_seq, out.t_client_ns) = (answered.seq, answered.t_client_ns);
        out.pose_age_ticks = link.age_ticks;
        let mut bits = 0;
        // Also where the last poses were refused and no more come.
        if link.phase != LinkPhase::Absent && link.age_ticks > limits.stale_ticks {
            bits |= flags::STALE;
        }
        if admission.refused {
            bits |= flags::REFUSED;
        }
        if !wanted {
            bits |= flags::PAUSED;
        }
        if link.phase != LinkPhase::Absent && link.limit_n != link.goal_n(&limits, wanted) {
            bits |= flags::RAMPING;
        }
        out.flags = bits;
    }
}

/// Lets tools feel forces from now on whose contacts give small ones for the first time since they were seated; the
/// others feel none. Forces that cancel are not small: a tool in the middle of a body is not out of it.
pub(super) fn release(
    scene: &Scene,
    tools: &mut [ToolState],
    rows: &[Row],
    solver: &Solver,
    wanted: bool,
    output: &mut TickOutput,
) {
    for (t, tool) in scene.tools.iter().enumerate() {
        if tools[t].link.phase != LinkPhase::Withheld {
            continue;
        }
        let limits = limits_of(tool, &tools[t]);
        let small_n = SMALL_N.min(SMALL_SHARE * limits.force_max_n);
        let link = &mut tools[t].link;
        let flags = &mut output.tools[t].flags;
        if load::pushes_n(rows, solver, t) <= small_n {
            link.release(&limits, wanted);
            if link.limit_n != link.goal_n(&limits, wanted) {
                *flags |= flags::RAMPING;
            }
        } else {
            *flags |= flags::WITHHELD;
        }
    }
}
