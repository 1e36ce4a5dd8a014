//! Changes of the scene: a client asks, someone makes the next scene beside the loop, the loop
//! takes it over between two ticks, and the bus declares what it has.
//!
//! ```text
//! rpc merge, isolate, truncate, cut ─▶ Editor ─▶ EditNews::Ready ─▶ swap ─▶ loop ─▶ receipt: from this tick on
//! tools that cut ─▶ Knives ───────────▶ ┘
//! ```

use super::desk::Desk;
use super::events::Events;
use super::knives::ToolCut;
use super::link::LoopLink;
use super::nets::Nets;
use palpate_drive::editor::{Edit, EditNews, EditRequest, Editor};
use palpate_drive::ports::{NetEnd, Receipt};
use palpate_proto::rpc::Answer;
use palpate_sim::scene::Scene;
use std::sync::Arc;

/// A change under way; there is one at a time.
enum SceneEdit {
    /// The next scene is being made.
    Asked,
    /// The loop has it, or will.
    Sent(Box<DueScene>),
}

/// What the bus goes on with after a change.
pub(super) struct DueScene {
    id: u64,
    pub(super) scene: Arc<Scene>,
    pub(super) scene_hash: [u8; 32],
    pub(super) nets: Vec<NetEnd>,
    /// Words for the event.
    pub(super) what: String,
    report: serde_json::Value,
    /// First tick of the scene, once the loop has it.
    tick: Option<u64>,
}

/// Changes of the scene: who makes them, and the one under way.
pub(super) struct Edits {
    editor: Option<Box<dyn Editor>>,
    change: Option<SceneEdit>,
    /// The cut of a tool, if that is the change.
    tool_cut: Option<ToolCut>,
}

impl Edits {
    /// No change is under way; without an editor none will be.
    pub(super) fn new(editor: Option<Box<dyn Editor>>) -> Self {
        Self {
            editor,
            change: None,
            tool_cut: None,
        }
    }

    /// Asks for a change of a scene whose bodies stand as the newest nets say.
    pub(super) fn ask(
        &mut self,
        id: u64,
        scene: &Arc<Scene>,
        nets: &Nets,
        edit: Edit,
        names: &[String],
    ) -> Result<(), String> {
        if self.change.is_some() {
            return Err("the scene is being changed; try again".into());
        }
        let index = |name: &String| {
            scene.body_index(name).ok_or_else(|| {
                let known: Vec<&str> = (0..scene.body_count())
                    .map(|body| scene.body_id(body))
                    .collect();
                format!(
                    "there is no body {name:?} in this scene; it has {}",
                    known.join(", ")
                )
            })
        };
        let bodies = names.iter().map(index).collect::<Result<Vec<_>, _>>()?;
        let twice = (1..bodies.len()).any(|k| bodies[..k].contains(&bodies[k]));
        let of_one = matches!(edit, Edit::Cut { .. });
        if !of_one && (bodies.len() < 2 || twice) {
            return Err("name at least two bodies, each once: {\"bodies\": [\"a\", \"b\"]}".into());
        }
        let standing = bodies.iter().map(|&body| nets.standing(scene, body));
        let standing = standing.collect();
        let Some(editor) = &mut self.editor else {
            return Err(
                "this daemon keeps its scene: it runs with --self-check, or only plays".into(),
            );
        };
        editor.ask(id, scene, standing, EditRequest { bodies, edit });
        self.change = Some(SceneEdit::Asked);
        Ok(())
    }

    /// Asks for the cut of a tool.
    pub(super) fn ask_cut(
        &mut self,
        id: u64,
        scene: &Arc<Scene>,
        nets: &Nets,
        cut: ToolCut,
        events: &mut Events,
    ) {
        let edit = Edit::Cut {
            plane: cut.plane,
            kerf_m: 0.0,
        };
        match self.ask(id, scene, nets, edit, std::slice::from_ref(&cut.body)) {
            Ok(()) => self.tool_cut = Some(cut),
            Err(reason) => cut.tell_refused(&reason, events),
        }
    }

    /// The change under way cannot be made: answers its request.
    fn refuse(&mut self, id: u64, reason: &str, desk: &mut Desk, events: &mut Events) {
        self.change = None;
        match self.tool_cut.take() {
            Some(cut) => cut.tell_refused(reason, events),
            None => desk.settle(id, &Answer::refused(reason)),
        }
    }

    /// What whoever remakes scenes has to tell; `next_tick` is the one that runs next.
    pub(super) fn take_news(
        &mut self,
        next_tick: u64,
        link: &mut LoopLink,
        desk: &mut Desk,
        events: &mut Events,
    ) {
        while let Some(news) = self.editor.as_mut().and_then(|editor| editor.news()) {
            match news {
                EditNews::Ready {
                    swap,
                    nets,
                    scene_hash,
                    what,
                    report,
                } => {
                    let (id, scene) = (swap.id, swap.scene().clone());
                    if !link.swap(swap) {
                        let reason = "the loop has not taken the last change yet; try again";
                        self.refuse(id, reason, desk, events);
                        continue;
                    }
                    let next = DueScene {
                        id,
                        scene,
                        scene_hash,
                        nets,
                        what,
                        report,
                        tick: None,
                    };
                    self.change = Some(SceneEdit::Sent(Box::new(next)));
                }
                EditNews::Nothing { id, report } => {
                    (self.change, self.tool_cut) = (None, None);
                    desk.settle(id, &Answer::with_report(next_tick, report));
                }
                EditNews::Refused { id, reason } => self.refuse(id, &reason, desk, events),
            }
        }
    }

    /// A change is being made, or waits for its first tick.
    pub(super) fn under_way(&self) -> bool {
        self.change.is_some()
    }

    /// Takes the receipt of a change; that of another command is not for here (false). A change is
    /// answered when all of the scene before it is published.
    pub(super) fn take_receipt(&mut self, receipt: Receipt) -> bool {
        match &mut self.change {
            Some(SceneEdit::Sent(next)) if next.id == receipt.id => {
                next.tick = Some(receipt.tick);
                true
            }
            _ => false,
        }
    }

    /// The next scene if the loop goes on with it from `tick` on, or has published all before it
    /// (`None`).
    pub(super) fn due(&mut self, tick: Option<u64>) -> Option<DueScene> {
        let is_due = matches!(&self.change, Some(SceneEdit::Sent(next))
            if next.tick.is_some_and(|first| tick.is_none_or(|tick| tick >= first)));
        if !is_due {
            return None;
        }
        self.tool_cut = None;
        match self.change.take() {
            Some(SceneEdit::Sent(next)) => Some(*next),
            _ => None,
        }
    }
}

impl DueScene {
    /// Answers who asked for it.
    pub(super) fn settle(self, desk: &mut Desk) {
        let answer = Answer::with_report(self.tick.unwrap_or_default(), self.report);
        desk.settle(self.id, &answer);
    }
}
