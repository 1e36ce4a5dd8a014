//! What a tick says of tools: forces for their devices, and what contacts do to them.

use super::clients::{ClientCounts, ClientLink};
use super::devices::Devices;
use super::events::server_ns;
use super::rate::{RateNews, RateWatch};
use super::view::View;
use crate::drive::ports::PoseInbox;
use crate::wire;
use palpate_client::publisher;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{ToolContact, ToolForce, force_flags};
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickOutput;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;
use zenoh::Wait;
use zenoh::pubsub::Publisher;

/// The newest output of the loop, and where its parts for tools go.
pub(super) struct Forces {
    outputs: rtrb::Consumer<Arc<TickOutput>>,
    newest: TickOutput,
    tools: Vec<ToolLine>,
    /// Every tick's force is awaited, as in lockstep and out of a recording.
    every: bool,
    /// The tick whose forces pages have.
    shown: u64,
    rate: RateWatch,
    /// Outputs that a newer one made needless.
    overtaken: u64,
}

/// The line to one tool.
struct ToolLine {
    inbox: Arc<PoseInbox>,
    force: Publisher<'static>,
    contact: Publisher<'static>,
    /// Somebody subscribes to what contacts do.
    contact_wanted: bool,
    /// Forces published.
    published: u64,
    client: Arc<ClientLink>,
}

impl Forces {
    /// Declares the publishers of all tools.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        outputs: rtrb::Consumer<Arc<TickOutput>>,
        poses: &[Arc<PoseInbox>],
        clients: &[Arc<ClientLink>],
        every: bool,
    ) -> zenoh::Result<Self> {
        let line = |(tool, inbox): (usize, &Arc<PoseInbox>)| {
            let id = scene.tool_id(tool);
            Ok(ToolLine {
                inbox: inbox.clone(),
                force: publisher::<ToolForce>(session, keys.tool_force(id))?,
                contact: publisher::<ToolContact>(session, keys.tool_contact(id))?,
                contact_wanted: false,
                published: 0,
                client: clients[tool].clone(),
            })
        };
        let tools = poses.iter().enumerate().map(line);
        Ok(Self {
            outputs,
            newest: TickOutput::for_tools(scene.tool_count()),
            tools: tools.collect::<zenoh::Result<_>>()?,
            every,
            shown: 0,
            rate: RateWatch::new(1.0 / scene.dt_s),
            overtaken: 0,
        })
    }

    /// The tick whose output is next, if it is there.
    pub(super) fn next_tick(&mut self) -> Option<u64> {
        self.outputs.peek().ok().map(|output| output.tick)
    }

    /// Takes the next output and publishes what it says of tools; false if a newer one waits that
    /// makes it needless.
    pub(super) fn publish_next(&mut self, scene: &Scene, devices: &mut Devices) -> bool {
        let Ok(output) = self.outputs.pop() else {
            return false;
        };
        if !self.every {
            self.rate.tick(Instant::now());
        }
        // Where not every force is awaited only the newest counts.
        if !self.every && !self.outputs.is_empty() {
            self.overtaken += 1;
            return false;
        }
        self.newest.clone_from(&output);
        for tool in 0..self.tools.len() {
            self.put_tool(tool, scene, devices);
        }
        true
    }

    fn put_tool(&mut self, tool: usize, scene: &Scene, devices: &mut Devices) {
        let (tick, out) = (self.newest.tick, self.newest.tools[tool]);
        if out.pose_seq == 0 {
            return;
        }
        if self.every || devices.wants(tool, tick, &out) {
            self.put_force(tool);
        }
        if self.tools[tool].contact_wanted {
            let contact = self.contact_of(tool, scene, devices);
            let _ = self.tools[tool].contact.put(encode(&contact)).wait();
        }
    }

    fn contact_of(&self, tool: usize, scene: &Scene, devices: &Devices) -> ToolContact {
        let limit_n = scene.spec.tools[tool].device.force_max_n;
        let limit_n = limit_n.min(devices.force_max_n(tool));
        wire::tool_contact(self.newest.tick, limit_n, &self.newest.tools[tool])
    }

    /// Shows pages the newest forces; also those that its tool's hand could not tell from the last.
    /// A loop that stands still has shown them, except to a page that has just opened (`all`).
    pub(super) fn show(&mut self, scene: &Scene, devices: &Devices, all: bool, view: &mut View) {
        if self.newest.tick == self.shown && !all {
            return;
        }
        self.shown = self.newest.tick;
        for tool in 0..self.tools.len() {
            let out = &self.newest.tools[tool];
            if out.pose_seq == 0 {
                continue;
            }
            let force = wire::tool_force(self.newest.tick, server_ns(), out);
            view.message(scene.tool_id(tool), &force);
            let contact = self.contact_of(tool, scene, devices);
            view.message(scene.tool_id(tool), &contact);
        }
    }

    /// What changed of the loop's rate. Call it often: forces fade by it.
    pub(super) fn rate_news(&mut self) -> Option<RateNews> {
        self.rate.look(Instant::now())
    }

    /// Ticks a second, by the clock.
    pub(super) fn rate(&self) -> &RateWatch {
        &self.rate
    }

    fn put_force(&mut self, tool: usize) {
        let out = &self.newest.tools[tool];
        if out.pose_seq == 0 {
            return;
        }
        let mut force = wire::tool_force(self.newest.tick, server_ns(), out);
        let gain = self.rate.gain();
        if gain < 1.0 {
            force.force = force.force.map(|f| f * gain);
            force.torque = force.torque.map(|t| t * gain);
            force.flags |= force_flags::RAMPING;
        }
        let line = &mut self.tools[tool];
        let _ = line.force.put(encode(&force)).wait();
        line.published += 1;
        line.client.sent();
    }

    /// A duplicate pose means that its force got lost.
    pub(super) fn answer_again(&mut self) {
        for tool in 0..self.tools.len() {
            let asked = self.tools[tool]
                .inbox
                .asked_again
                .swap(false, Ordering::AcqRel);
            if asked && self.every {
                self.put_force(tool);
            }
        }
    }

    /// Whom to tell what contacts do: messages that nobody takes are not made.
    pub(super) fn look_for_listeners(&mut self) {
        for tool in &mut self.tools {
            let status = tool.contact.matching_status().wait();
            tool.contact_wanted = status.is_ok_and(|status| status.matching());
        }
    }

    /// The newest output that was published.
    pub(super) fn newest(&self) -> &TickOutput {
        &self.newest
    }

    /// The bodies changed: contacts with the bodies before are dropped.
    pub(super) fn forget_contacts(&mut self) {
        self.newest.contacts = Default::default();
    }

    /// The tool's holder is gone: the next one counts its poses from 1.
    pub(super) fn forget_sender(&self, tool: usize) {
        self.tools[tool].inbox.forget_sender();
    }

    /// Forces published, by tool.
    pub(super) fn published(&self) -> Vec<u64> {
        self.tools.iter().map(|tool| tool.published).collect()
    }

    /// What is counted of the clients that say what they receive, by tool.
    pub(super) fn clients(&self) -> Vec<Option<ClientCounts>> {
        self.tools.iter().map(|tool| tool.client.counts()).collect()
    }

    /// Outputs of ticks whose forces were not published, because newer ones were there.
    pub(super) fn overtaken(&self) -> u64 {
        self.overtaken
    }

    /// Poses of clients that do not hold their tool, by tool.
    pub(super) fn strangers(&self) -> Vec<u64> {
        let strangers = |tool: &ToolLine| tool.inbox.counters.strangers.load(Ordering::Relaxed);
        self.tools.iter().map(strangers).collect()
    }

    /// Poses taken, by tool.
    pub(super) fn received(&self) -> Vec<u64> {
        let received = |tool: &ToolLine| tool.inbox.counters.received.load(Ordering::Relaxed);
        self.tools.iter().map(received).collect()
    }
}
