//! Tools that cut: when their button goes down, what their plane crosses is cut, one body after the other.

use super::events::Events;
use super::nets::Nets;
use palpate_geometry::cut::CutPlane;
use palpate_proto::messages::EventKind;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::solve::grip::GRAB;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::{TickOutput, TickRecord, ToolOutput};
use std::collections::VecDeque;

/// Presses that may wait while the scene is being changed.
const MOST_WAITING: usize = 32;

/// A cut that a tool makes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ToolCut {
    /// Id of the tool.
    pub(super) tool: String,
    /// Id of the body.
    pub(super) body: String,
    /// Where the tool was.
    pub(super) plane: CutPlane,
}

impl ToolCut {
    /// Tells why it was not made. No one waits for an answer to a button.
    pub(super) fn tell_refused(&self, reason: &str, events: &mut Events) {
        let Self { tool, body, .. } = self;
        tracing::warn!(tool, body, reason, "a tool did not cut");
        let reason = format!("tool {tool} did not cut {body}: {reason}");
        events.tell(EventKind::Fault { reason });
    }
}

/// A tool whose button has gone down.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Press {
    tool: usize,
    /// Where it was.
    plane: CutPlane,
}

/// Tools that cut, and the cuts that wait for their turn.
pub(super) struct Knives {
    /// Index, and whether the button is down. Tools stay what they are when a scene changes.
    tools: Vec<(usize, bool)>,
    pressed: VecDeque<Press>,
    /// Of the press whose turn it is.
    waiting: VecDeque<ToolCut>,
}

impl Knives {
    /// No button is down.
    pub(super) fn new(scene: &Scene) -> Self {
        let cutting = (0..scene.tool_count()).filter(|&tool| scene.cuts(tool));
        Self {
            tools: cutting.map(|tool| (tool, false)).collect(),
            pressed: VecDeque::new(),
            waiting: VecDeque::new(),
        }
    }

    /// No tool cuts where scenes do not change.
    pub(super) fn none() -> Self {
        Self {
            tools: Vec::new(),
            pressed: VecDeque::new(),
            waiting: VecDeque::new(),
        }
    }

    /// Looks at the buttons of a tick.
    pub(super) fn see(&mut self, scene: &Scene, record: &TickRecord) {
        for (tool, down) in &mut self.tools {
            let out = &record.output.tools[*tool];
            let goes_down = goes_down(down, out, record.input.poses[*tool].as_ref());
            let (at, turned) = (&out.proxy_position, &out.proxy_orientation);
            let Some(plane) = scene.tool_plane(*tool, at, turned).filter(|_| goes_down) else {
                continue;
            };
            if self.pressed.len() == MOST_WAITING {
                tracing::warn!(tool = scene.tool_id(*tool), "too many cuts are waiting");
                continue;
            }
            self.pressed.push_back(Press { tool: *tool, plane });
        }
    }

    /// The cut whose turn it is, in a scene that is not being changed. What a press cuts is found when its turn comes:
    /// the pieces of one before it are bodies by then.
    pub(super) fn next_cut(&mut self, scene: &Scene, nets: &Nets) -> Option<ToolCut> {
        while self.waiting.is_empty() {
            let Press { tool, plane } = self.pressed.pop_front()?;
            let crossed = (0..scene.body_count())
                .filter(|&body| scene.deforms(body) && nets.is_crossed(body, &plane));
            self.waiting.extend(crossed.map(|body| ToolCut {
                tool: scene.tool_id(tool).to_owned(),
                body: scene.body_id(body).to_owned(),
                plane,
            }));
        }
        self.waiting.pop_front()
    }
}

/// Takes what a tick says of a button; true if it goes down.
fn goes_down(down: &mut bool, out: &ToolOutput, pose: Option<&DevicePose>) -> bool {
    // After a reset no one is there until the next pose.
    let was = *down && out.pose_seq > 0;
    let taken = pose.filter(|_| out.flags & flags::REFUSED == 0);
    *down = taken.map_or(was, |pose| pose.buttons & GRAB != 0);
    *down && !was
}

/// The plane of a tool where it is now.
pub(super) fn plane_now(scene: &Scene, id: &str, newest: &TickOutput) -> Result<CutPlane, String> {
    let tool = scene.tool_index(id).ok_or_else(|| {
        let known: Vec<&str> = (0..scene.tool_count()).map(|t| scene.tool_id(t)).collect();
        format!(
            "there is no tool {id:?} in this scene; it has {}",
            known.join(", ")
        )
    })?;
    let (at, turned) = if newest.tick == 0 {
        scene.tool_start(tool)
    } else {
        let out = &newest.tools[tool];
        (out.proxy_position, out.proxy_orientation)
    };
    scene.tool_plane(tool, &at, &turned).ok_or_else(|| {
        format!(
            "tool {id:?} has the shape {}, and only a plane cuts: name a tool that is one, or give the plane itself",
            scene.shape_name(tool)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_sim::haptics::Link;

    #[test]
    fn a_button_goes_down_once_until_it_is_up_or_the_tool_is_nobodys() {
        // The pose in use, flags, the buttons of a new pose, whether the button goes down.
        let rows = [
            ("nobody", 0, 0, None, false),
            ("a pose", 1, 0, Some(0), false),
            ("another button", 2, 0, Some(2), false),
            ("down", 3, 0, Some(GRAB), true),
            ("no news", 3, 0, None, false),
            ("still down", 4, 0, Some(GRAB | 2), false),
            ("up", 5, 0, Some(0), false),
            ("a jump is not taken", 6, flags::REFUSED, Some(GRAB), false),
            ("down again", 7, 0, Some(GRAB), true),
            ("up by a jump", 8, flags::REFUSED, Some(0), false),
            ("still down", 9, 0, Some(GRAB), false),
            ("a reset", 0, 0, None, false),
            ("down after it", 10, 0, Some(GRAB), true),
        ];
        let mut down = false;
        for (what, pose_seq, flags, buttons, expected) in rows {
            let out = ToolOutput {
                pose_seq,
                flags,
                ..ToolOutput::default()
            };
            let pose = buttons.map(|buttons| DevicePose {
                buttons,
                ..Link::default().pose
            });
            let found = goes_down(&mut down, &out, pose.as_ref());
            assert_eq!(found, expected, "{what}");
        }
    }
}
