//! Buffers for bodies that rest.

use super::WarmRow;
use super::record::ContactReport;
use crate::scene::{Pair, Scene};
use crate::solve::rows::Holder;

/// Buffers; the state says which bodies are left alone.
#[derive(Debug, Default)]
pub(super) struct Rest {
    /// By body: something moves it, or may.
    pub awake: Vec<bool>,
    /// By pair: `reports` holds its contacts.
    pub reported: Vec<bool>,
    /// Contacts of pairs left alone, by pair.
    pub reports: Vec<(u32, ContactReport)>,
    /// Their rows, in order.
    pub rows: Vec<WarmRow>,
}

impl Rest {
    pub(super) fn new(scene: &Scene) -> Self {
        let between = |pair: &&Pair| matches!(pair.holder, Holder::Body(_));
        let most = match scene.pairs.iter().filter(between).count() {
            0 => 0,
            _ => scene.most_rows(),
        };
        Self {
            awake: vec![false; scene.bodies.len()],
            reported: vec![false; scene.pairs.len()],
            reports: Vec::with_capacity(most),
            rows: Vec::with_capacity(most),
        }
    }

    /// What it holds is of another state.
    pub(super) fn forget(&mut self) {
        self.reported.fill(false);
        self.reports.clear();
        self.rows.clear();
    }
}
