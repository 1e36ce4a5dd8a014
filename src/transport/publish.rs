//! What goes out after a tick: forces, contacts, nets.

use super::bus::{BusThread, server_ns};
use crate::wire;
use palpate_proto::codec::encode;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use zenoh::Wait;

const CONTACTS_EVERY: Duration = Duration::from_micros(16_667);
const NET_REFRESH: Duration = Duration::from_secs(1);

impl BusThread {
    pub(super) fn publish_forces(&mut self) {
        let mut fresh = false;
        while let Ok(output) = self.ports.outputs.peek() {
            let tick = output.tick;
            if self.change.is_some() {
                self.take_receipts();
                self.follow_change(Some(tick));
            }
            let Ok(output) = self.ports.outputs.pop() else {
                break;
            };
            // In lockstep every tick's force is awaited; in real time only the newest counts.
            if self.lockstep || self.ports.outputs.is_empty() {
                self.output.clone_from(&output);
                fresh = true;
                for tool in 0..self.tools.len() {
                    self.put_tool(tool);
                }
            }
        }
        if fresh {
            self.publish_contacts();
        }
    }

    /// What a tick says of a tool: the force for its device, and what contacts do to it.
    fn put_tool(&mut self, tool: usize) {
        let out = self.output.tools[tool];
        if out.pose_seq == 0 {
            return;
        }
        // In lockstep every tick's force is awaited.
        if self.lockstep || self.devices.wants(tool, self.output.tick, &out) {
            self.put_force(tool);
        } else if let Some(viewer) = &mut self.settings.viewer {
            viewer.force(tool, &wire::tool_force(self.output.tick, server_ns(), &out));
        }
        if self.contact_wanted[tool] {
            let limit_n = self.settings.scene.spec.tools[tool].device.force_max_n;
            let limit_n = limit_n.min(self.devices.force_max_n(tool));
            let contact = wire::tool_contact(self.output.tick, limit_n, &out);
            let _ = self.declared().tool_contacts[tool]
                .put(encode(&contact))
                .wait();
        }
    }

    /// Whom to tell what contacts do: messages that nobody takes are not made.
    pub(super) fn look_for_listeners(&mut self) {
        for tool in 0..self.tools.len() {
            let status = self.declared().tool_contacts[tool].matching_status().wait();
            self.contact_wanted[tool] = status.is_ok_and(|status| status.matching());
        }
    }

    fn put_force(&mut self, tool: usize) {
        let out = &self.output.tools[tool];
        if out.pose_seq == 0 {
            return;
        }
        let force = wire::tool_force(self.output.tick, server_ns(), out);
        let _ = self.declared().forces[tool].put(encode(&force)).wait();
        if let Some(viewer) = &mut self.settings.viewer {
            viewer.force(tool, &force);
        }
    }

    /// A duplicate pose means that its force got lost.
    pub(super) fn answer_again(&mut self) {
        for tool in 0..self.tools.len() {
            if self.ports.poses[tool]
                .asked_again
                .swap(false, Ordering::AcqRel)
                && self.lockstep
            {
                self.put_force(tool);
            }
        }
    }

    fn publish_contacts(&mut self) {
        let mut changed = false;
        let outputs = self.output.tools.first(self.tools.len());
        for (tally, out) in self.tools.iter_mut().zip(outputs) {
            changed |= tally.touching != out.contact.is_some();
            tally.touching = out.contact.is_some();
        }
        // Bodies may touch without a tool.
        let any = !self.output.contacts.list().is_empty();
        changed |= self.touching != any;
        self.touching = any;
        let due = self.last_contacts.elapsed() >= CONTACTS_EVERY && any;
        if changed || due {
            self.last_contacts = Instant::now();
            let set = wire::contact_set(&self.settings.scene, &self.output);
            if let Some(viewer) = &mut self.settings.viewer {
                viewer.contacts(&set);
            }
            let _ = self.declared().contacts.put(encode(&set)).wait();
        }
    }

    /// All nets go out next, changed or not.
    pub(super) fn refresh_nets(&mut self) {
        self.last_nets = self
            .last_nets
            .checked_sub(NET_REFRESH)
            .unwrap_or(self.last_nets);
    }

    pub(super) fn publish_nets(&mut self) {
        let refresh = self.last_nets.elapsed() >= NET_REFRESH;
        for body in 0..self.nets.len() {
            let scene = &self.settings.scene;
            let fresh = self.ports.nets[body].newest();
            let changed = fresh.is_some();
            if let Some(frame) = fresh {
                self.nets[body] =
                    wire::control_net(scene, body, frame.tick, frame.revision, &frame.points);
            }
            if changed || refresh {
                let _ = self.declared().nets[body]
                    .put(encode(&self.nets[body]))
                    .wait();
                if let Some(viewer) = &mut self.settings.viewer {
                    viewer.net(&self.nets[body]);
                }
            }
        }
        if refresh {
            self.last_nets = Instant::now();
        }
    }
}
