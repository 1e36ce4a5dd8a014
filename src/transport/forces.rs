//! What a tick says of tools: forces for their devices, and what contacts do to them.

use super::clients::{ClientCounts, ClientLink};
use super::devices::Devices;
use super::events::server_ns;
use super::rate::{RateNews, RateWatch};
use super::view::View;
use palpate_client::publisher;
use palpate_drive::ports::{PoseInbox, Published, SenderId};
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{ToolContact, ToolForce, ToolForceV2, force_flags};
use palpate_sim::scene::Scene;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::{TickOutput, ToolOutput};
use palpate_wire as wire;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;
use zenoh::Wait;
use zenoh::pubsub::Publisher;

/// The newest output of the loop, and where its parts for tools go.
pub(super) struct Forces {
    outputs: rtrb::Consumer<Arc<Published>>,
    newest: TickOutput,
    /// By tool: whose pose the newest force answers.
    senders: Vec<SenderId>,
    tools: Vec<ToolLine>,
    /// Every tick's force is awaited, as in lockstep and out of a recording.
    every: bool,
    /// The newest tick that came.
    seen: u64,
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
    force_v2: Publisher<'static>,
    /// Someone subscribes to forces with their errors.
    error_wanted: bool,
    contact: Publisher<'static>,
    /// Someone subscribes to what contacts do.
    contact_wanted: bool,
    /// Forces that were not published while someone moved the tool, because newer ones were there.
    overtaken: u64,
    /// What the bus and pages got last was of a pose.
    had_pose: bool,
    shown: bool,
    client: Arc<ClientLink>,
}

/// What became of the forces of a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ForceCounts {
    /// Published.
    pub sent: u64,
    /// Not published while someone moved the tool, because a newer one was there.
    pub overtaken: u64,
    /// Published, and not received by a client that says what it receives.
    pub lost: u64,
}

/// Whether a tool's force is published: while there is a pose, and once more when a reset has taken it away, or
/// everybody would keep the last force.
fn is_due(had_pose: &mut bool, out: &ToolOutput) -> bool {
    let here = out.pose_seq > 0;
    std::mem::replace(had_pose, here) || here
}

impl Forces {
    /// Declares the publishers of all tools.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        outputs: rtrb::Consumer<Arc<Published>>,
        poses: &[Arc<PoseInbox>],
        clients: &[Arc<ClientLink>],
        every: bool,
    ) -> zenoh::Result<Self> {
        let line = |(tool, inbox): (usize, &Arc<PoseInbox>)| {
            let id = scene.tool_id(tool);
            Ok(ToolLine {
                inbox: inbox.clone(),
                force: publisher::<ToolForce>(session, keys.tool_force(id))?,
                force_v2: publisher::<ToolForceV2>(session, keys.tool_force_v2(id))?,
                error_wanted: false,
                contact: publisher::<ToolContact>(session, keys.tool_contact(id))?,
                contact_wanted: false,
                overtaken: 0,
                had_pose: false,
                shown: false,
                client: clients[tool].clone(),
            })
        };
        let tools = poses.iter().enumerate().map(line);
        Ok(Self {
            outputs,
            newest: TickOutput::for_tools(scene.tool_count()),
            senders: vec![SenderId::default(); scene.tool_count()],
            tools: tools.collect::<zenoh::Result<_>>()?,
            every,
            seen: 0,
            shown: 0,
            rate: RateWatch::new(1.0 / scene.dt_s),
            overtaken: 0,
        })
    }

    /// The tick whose output is next, if it is there.
    pub(super) fn next_tick(&mut self) -> Option<u64> {
        self.outputs
            .peek()
            .ok()
            .map(|published| published.output.tick)
    }

    /// Takes the next output and publishes what it says of tools; false if a newer one waits that
    /// makes it needless.
    pub(super) fn publish_next(&mut self, scene: &Scene, devices: &mut Devices) -> bool {
        let Ok(published) = self.outputs.pop() else {
            return false;
        };
        let output = &published.output;
        if !self.every {
            self.rate.tick(Instant::now());
        }
        // Where not every force is awaited only the newest counts.
        // Those in between did not even come: the bus was too far behind.
        let missing = output.tick.saturating_sub(self.seen + 1);
        self.seen = output.tick;
        let overtaken = !self.every && !self.outputs.is_empty();
        if !self.every {
            self.count_overtaken(output, missing + u64::from(overtaken));
        }
        if overtaken {
            return false;
        }
        self.newest.clone_from(output);
        self.senders.clone_from(&published.senders);
        for tool in 0..self.tools.len() {
            self.put_tool(tool, scene, devices);
        }
        true
    }

    fn put_tool(&mut self, tool: usize, scene: &Scene, devices: &mut Devices) {
        let (tick, out) = (self.newest.tick, self.newest.tools[tool]);
        if !is_due(&mut self.tools[tool].had_pose, &out) {
            return;
        }
        if self.every || devices.wants(tool, tick, &out) || out.pose_seq == 0 {
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
            if !is_due(&mut self.tools[tool].shown, out) {
                continue;
            }
            let force = wire::tool_force(self.newest.tick, server_ns(), out);
            // Pages know the error when the force of its tick comes.
            let with_error = wire::tool_force_v2(&force, out.error_n);
            view.message(scene.tool_id(tool), &with_error);
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
        let mut force = wire::tool_force(self.newest.tick, server_ns(), out);
        let gain = self.rate.gain();
        if gain < 1.0 {
            force.force = force.force.map(|f| f * gain);
            force.torque = force.torque.map(|t| t * gain);
            force.flags |= force_flags::RAMPING;
        }
        let line = &mut self.tools[tool];
        // Counted first: its client may answer before this thread goes on.
        line.client.sent(force.t_server_ns);
        let put = line.force.put(encode(&force));
        // Who hears it knows whether it is its own.
        let _ = put.attachment(self.senders[tool].bytes()).wait();
        if line.error_wanted {
            // What fades by the clock is off by as much less.
            let force = wire::tool_force_v2(&force, out.error_n * gain.min(1.0));
            let put = line.force_v2.put(encode(&force));
            let _ = put.attachment(self.senders[tool].bytes()).wait();
        }
    }

    fn count_overtaken(&mut self, output: &TickOutput, ticks: u64) {
        self.overtaken += ticks;
        for (line, out) in self.tools.iter_mut().zip(output.tools.as_slice()) {
            let moved = out.pose_seq > 0 && out.flags & flags::STALE == 0;
            line.overtaken += ticks * u64::from(moved);
        }
    }

    /// A duplicate pose means that its force got lost.
    pub(super) fn answer_again(&mut self) {
        for tool in 0..self.tools.len() {
            let asked = self.tools[tool]
                .inbox
                .asked_again
                .swap(false, Ordering::AcqRel);
            if asked && self.every && self.newest.tools[tool].pose_seq > 0 {
                self.put_force(tool);
            }
        }
    }

    /// Whom to tell what contacts do: messages that no one takes are not made.
    pub(super) fn look_for_listeners(&mut self) {
        for tool in &mut self.tools {
            let wanted = |publisher: &Publisher<'_>| {
                let status = publisher.matching_status().wait();
                status.is_ok_and(|status| status.matching())
            };
            tool.contact_wanted = wanted(&tool.contact);
            tool.error_wanted = wanted(&tool.force_v2);
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

    /// Who holds a tool.
    pub(super) fn holder(&self, tool: usize) -> Option<SenderId> {
        self.tools[tool].inbox.holder()
    }

    /// What became of them, by tool.
    pub(super) fn counts(&self) -> Vec<ForceCounts> {
        let counts = |tool: &ToolLine| {
            let (sent, lost) = tool.client.sent_and_lost();
            ForceCounts {
                sent,
                overtaken: tool.overtaken,
                lost,
            }
        };
        self.tools.iter().map(counts).collect()
    }

    /// The same for people, by tool.
    pub(super) fn report(&self, scene: &Scene) -> serde_json::Value {
        let counts = self.counts();
        let tools = counts.iter().enumerate().map(|(tool, counts)| {
            let ForceCounts {
                sent,
                overtaken,
                lost,
            } = counts;
            let report = serde_json::json!({ "sent": sent, "overtaken": overtaken, "lost": lost });
            (scene.tool_id(tool).to_owned(), report)
        });
        serde_json::Value::Object(tools.collect())
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
