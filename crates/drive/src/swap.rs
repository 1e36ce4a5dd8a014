//! Another scene in the place of the running one, between two ticks.
//!
//! Everything that takes time or memory is made beside the loop; the loop copies what goes on, and
//! hands the old scene back to be dropped elsewhere.

use super::journal::Journal;
use super::nets::NetPool;
use super::ports::{BUS_NETS, NetEnd, NetPort, net_ports};
use super::workers::Workers;
use palpate_sim::scene::Scene;
use palpate_sim::tick::{CarryOver, SceneState, Scratch};
use std::sync::Arc;

/// A scene on its way into the loop; on its way back, the one before.
pub struct Swap {
    /// Of the request, under which the receipt comes back.
    pub id: u64,
    scene: Arc<Scene>,
    state: SceneState,
    scratch: Scratch,
    carry: CarryOver,
    pub(super) nets: NetPool,
    pub(super) net_port: NetPort,
    pub(super) journal: Box<dyn Journal>,
}

impl Swap {
    /// Makes all that the loop needs for another scene with the same tools; the other ends of its nets are for the bus.
    ///
    /// # Errors
    /// The system refuses a thread for bodies that step apart.
    pub fn new(
        id: u64,
        scene: Arc<Scene>,
        carry: CarryOver,
        journal: Box<dyn Journal>,
    ) -> std::io::Result<(Self, Vec<NetEnd>)> {
        let state = scene.initial_state();
        let mut scratch = scene.scratch(&state);
        if let Some(workers) = Workers::start(&scene)? {
            scratch.set_pipeline(Box::new(workers));
        }
        let nets = NetPool::new(&scene, BUS_NETS + journal.nets_held());
        let (net_port, ends) = net_ports(&scene);
        Ok((
            Self {
                id,
                scene,
                state,
                scratch,
                carry,
                nets,
                net_port,
                journal,
            },
            ends,
        ))
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Puts the next scene in the place of a running one, which it keeps from then on: nothing is
    /// allocated, nothing dropped.
    pub fn exchange(
        &mut self,
        scene: &mut Arc<Scene>,
        state: &mut SceneState,
        scratch: &mut Scratch,
    ) {
        self.scene
            .carry_over(scene, state, &self.carry, &mut self.state);
        self.scene.prepare(&self.state, &mut self.scratch);
        let executor = scratch.take_executor();
        self.scratch.set_executor(&self.scene, executor);
        std::mem::swap(scene, &mut self.scene);
        std::mem::swap(state, &mut self.state);
        std::mem::swap(scratch, &mut self.scratch);
    }
}
