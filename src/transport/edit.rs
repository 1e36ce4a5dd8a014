//! Changes of the scene: a client asks, somebody makes the next scene beside the loop, the loop
//! takes it over between two ticks, and the bus declares what it has.
//!
//! ```text
//! rpc merge, isolate ─▶ Editor ─▶ EditNews::Ready ─▶ swap ─▶ loop ─▶ receipt: from this tick on
//! ```

use super::bus::BusThread;
use crate::drive::editor::{Edit, EditNews, EditRequest};
use crate::drive::ports::NetEnd;
use crate::wire;
use palpate_proto::messages::EventKind;
use palpate_proto::rpc::Answer;
use palpate_sim::scene::Scene;
use std::sync::Arc;

/// A change under way; there is one at a time.
pub(super) enum Change {
    /// The next scene is being made.
    Asked,
    /// The loop has it, or will.
    Sent(Box<Next>),
}

/// What the bus goes on with after a change.
pub(super) struct Next {
    id: u64,
    scene: Arc<Scene>,
    scene_hash: [u8; 32],
    nets: Vec<NetEnd>,
    what: String,
    report: serde_json::Value,
    /// First tick of the scene, once the loop has it.
    tick: Option<u64>,
}

impl BusThread {
    pub(super) fn ask_editor(
        &mut self,
        id: u64,
        edit: Edit,
        names: &[String],
    ) -> Result<(), String> {
        if self.change.is_some() {
            return Err("the scene is being changed; try again".into());
        }
        let scene = self.settings.scene.clone();
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
        if bodies.len() < 2 || twice {
            return Err("name at least two bodies, each once: {\"bodies\": [\"a\", \"b\"]}".into());
        }
        let nets = bodies
            .iter()
            .map(|&body| self.nets[body].points.iter().map(|&p| p.into()).collect())
            .collect();
        let Some(editor) = &mut self.settings.editor else {
            return Err(
                "this daemon keeps its scene: it runs with --self-check, or only plays".into(),
            );
        };
        editor.ask(id, &scene, nets, EditRequest { bodies, edit });
        self.change = Some(Change::Asked);
        Ok(())
    }

    /// What whoever remakes scenes has to tell.
    pub(super) fn take_editor_news(&mut self) {
        while let Some(news) = self
            .settings
            .editor
            .as_mut()
            .and_then(|editor| editor.news())
        {
            match news {
                EditNews::Ready {
                    swap,
                    nets,
                    scene_hash,
                    what,
                    report,
                } => {
                    let (id, scene) = (swap.id, swap.scene().clone());
                    if self.ports.swaps.push(swap).is_err() {
                        self.change = None;
                        self.settle(
                            id,
                            &Answer::refused(
                                "the loop has not taken the last change yet; try again",
                            ),
                        );
                        continue;
                    }
                    let next = Next {
                        id,
                        scene,
                        scene_hash,
                        nets,
                        what,
                        report,
                        tick: None,
                    };
                    self.change = Some(Change::Sent(Box::new(next)));
                    // A loop in lockstep may sleep.
                    self.ports.wake_tick();
                }
                EditNews::Nothing { id, report } => {
                    self.change = None;
                    self.settle(id, &Answer::with_report(self.status.tick + 1, report));
                }
                EditNews::Refused { id, reason } => {
                    self.change = None;
                    self.settle(id, &Answer::refused(reason));
                }
            }
        }
    }

    /// Answers commands that have had their effect. That of a change waits until all of the scene
    /// before it is told.
    pub(super) fn take_receipts(&mut self) {
        while let Ok(receipt) = self.ports.receipts.pop() {
            match &mut self.change {
                Some(Change::Sent(next)) if next.id == receipt.id => next.tick = Some(receipt.tick),
                _ => self.settle(receipt.id, &Answer::at(receipt.tick)),
            }
        }
    }

    /// Goes on with the next scene if the loop does from `tick` on, or has told all before it
    /// (`None`).
    pub(super) fn follow_change(&mut self, tick: Option<u64>) {
        let due = matches!(&self.change, Some(Change::Sent(next))
            if next.tick.is_some_and(|first| tick.is_none_or(|tick| tick >= first)));
        if !due {
            return;
        }
        let Some(Change::Sent(next)) = self.change.take() else {
            return;
        };
        let Next {
            id,
            scene,
            scene_hash,
            nets,
            what,
            report,
            tick,
        } = *next;
        self.nets = wire::all_nets(&scene, &scene.initial_state());
        (
            self.ports.nets,
            self.settings.scene,
            self.settings.scene_hash,
        ) = (nets, scene.clone(), scene_hash);
        self.output.contacts = Default::default();
        if let Err(error) = self.declare_bodies() {
            tracing::error!(%error, "the bodies of the next scene");
        }
        if let Some(viewer) = &mut self.settings.viewer {
            let ids: Vec<&str> = (0..scene.body_count())
                .map(|body| scene.body_id(body))
                .collect();
            viewer.bodies(&ids, scene.net_gaps());
        }
        self.refresh_nets();
        self.event(EventKind::SceneChanged { what });
        while let Ok(retired) = self.ports.retired.pop() {
            // A large scene takes its time to go.
            let _ = std::thread::Builder::new()
                .name("palpate-retired".into())
                .spawn(move || drop(retired));
        }
        self.settle(id, &Answer::with_report(tick.unwrap_or_default(), report));
    }
}
