//! Second half of a tick: parties take the contact forces, and their next free motion is predicted.

use super::executor::SideBySide;
use super::frame::FrameState;
use super::record::TickFault;
use crate::party::{Around, BodyScratch, BodyState, Pipeline, ToolState};
use crate::scene::Scene;

/// Moves every body, and gives the last fault for which one had to be set back.
pub(super) fn advance(
    scene: &Scene,
    states: &mut [BodyState],
    tools: &[ToolState],
    frame: &mut FrameState,
    scratch: &mut [BodyScratch],
    (side_by_side, pipeline): (&mut SideBySide, &mut Option<Box<dyn Pipeline>>),
) -> Option<TickFault> {
    scene.follow_frame(frame, tools);
    let around = Around {
        tools,
        field: scene.field(frame),
        moving: true,
    };
    for (b, body) in scene.parties().enumerate() {
        body.hand_over(&around, &mut states[b], &mut scratch[b], pipeline);
    }
    side_by_side.each(states, scratch, |b, state, scratch| {
        scratch.fault = scene.party(b).apply(&around, state, scratch);
    });
    for (b, body) in scene.parties().enumerate() {
        body.follow(&mut states[b], &mut scratch[b], pipeline);
    }
    side_by_side.each(states, scratch, |b, state, scratch| {
        scene.party(b).look_ahead(&around, state, scratch);
    });
    scratch.iter().rev().find_map(|body| body.fault)
}

/// A tick in which bodies do not move.
pub(super) fn stand_still(
    scene: &Scene,
    frame: &FrameState,
    states: &[BodyState],
    scratch: &mut [BodyScratch],
) {
    let field = scene.field(frame);
    for (b, body) in scene.parties().enumerate() {
        body.stand_still(field, &states[b], &mut scratch[b]);
    }
}
