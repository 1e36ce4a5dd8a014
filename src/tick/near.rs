//! Broad phase: which pairs can touch in this tick.

use super::feet::{margin_m, meet};
use crate::contact::rows::Holder;
use crate::math::{Point3, Pose};
use crate::scene::{Scene, SceneState, Scratch};

/// Marks the pairs whose boxes meet. A tool's box holds its whole way from the last proxy to where it is free to go.
pub(super) fn find(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    let Scratch { bodies, rows, near, .. } = scratch;
    for (p, pair) in scene.pairs.iter().enumerate() {
        let body = &scene.bodies[pair.body];
        let bounds = &bodies[pair.body].bounds;
        let is_near = match pair.holder {
            Holder::Tool(t) => {
                let t = t as usize;
                let tool = &scene.tools[t];
                let rotation = state.tools[t].link.pose.orientation;
                let at = |place: Point3| tool.shape.bounds(&Pose::from_parts(place.coords.into(), rotation));
                match (at(state.tools[t].proxy), at(rows.free[t])) {
                    (Some((low, high)), Some((free_low, free_high))) => {
                        let margin = margin_m(tool.shape.ball_radius_m().unwrap_or(0.0), body.size_m);
                        meet(bounds, &low.inf(&free_low), &high.sup(&free_high), margin)
                    }
                    _ => true,
                }
            }
            Holder::Body(other) if other as usize == pair.body => true,
            Holder::Body(other) => {
                let other = other as usize;
                let (low, high) = &bodies[other].bounds;
                meet(bounds, low, high, margin_m(0.0, body.size_m.max(scene.bodies[other].size_m)))
            }
        };
        near.mark(p, is_near);
    }
}
