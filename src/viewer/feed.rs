//! The bus thread's end of the page: what it posts.

use super::board::{Board, Lasts};
use super::frames::key_of;
use super::holders::Holders;
use crate::transport::{Health, LoopMetrics, ViewSink};
use palpate_proto::messages::{DeviceInfo, SceneSnapshot, SimEvent};
use palpate_sim::scene::Scene;
use palpate_wire::tool_outlines;
use std::sync::{Arc, Mutex, PoisonError};

/// Takes messages for pages.
pub struct Feed {
    pub(super) board: Arc<Board>,
    pub(super) holders: Arc<Holders>,
    pub(super) health: Arc<Health>,
    /// The scene that runs.
    pub(super) scene: Arc<Mutex<Arc<Scene>>>,
    /// What `/tools.json` answers.
    pub(super) outlines: Arc<Mutex<String>>,
}

impl ViewSink for Feed {
    fn watched(&self) -> bool {
        self.board.watched()
    }

    fn wants_nodes(&mut self) -> Option<bool> {
        self.board.wants_nodes()
    }

    fn take_newcomer(&mut self) -> bool {
        self.board.take_newcomer()
    }

    fn scene(&mut self, scene: &Arc<Scene>, snapshot: &[u8]) {
        *self.scene.lock().unwrap_or_else(PoisonError::into_inner) = scene.clone();
        *self.outlines.lock().unwrap_or_else(PoisonError::into_inner) = tool_outlines(scene);
        self.board
            .begin_scene(&key_of::<SceneSnapshot>(""), snapshot);
    }

    fn message(&mut self, key: &str, payload: &[u8]) {
        self.board.post(key, Lasts::WhileWatched, payload);
    }

    fn event(&mut self, payload: &[u8]) {
        self.board.event(&key_of::<SimEvent>(""), payload);
    }

    fn device(&mut self, tool: &str, name: &str, payload: &[u8]) {
        self.holders.device(tool, name);
        let key = key_of::<DeviceInfo>(tool);
        self.board.post(&key, Lasts::UntilChanged, payload);
    }

    fn token(&mut self, tool: &str, present: bool) {
        self.holders.token(tool, present);
        if !present {
            self.board.forget(&key_of::<DeviceInfo>(tool));
        }
    }

    fn figures(&mut self, figures: &LoopMetrics) {
        self.health.put(figures.clone());
    }

    fn turn_over(&mut self) {
        self.board.tell();
    }
}
