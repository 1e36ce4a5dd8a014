//! Answers to queries and commands.

use super::bus::BusThread;
use super::declared::{Inbox, encoding};
use crate::tick::ports::CommandRequest;
use crate::tick::record::Command;
use crate::wire;
use palpate_proto::codec::encode;
use palpate_proto::messages::{
    ContactSet, ControlNet, DeviceInfo, EventKind, LoopState, LoopStatus, Message, SceneSnapshot, SimEvent,
    ToolContact, ToolForce, ToolPose,
};
use palpate_proto::rpc::{Reply, Request};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::query::Query;

impl BusThread {
    /// Answers a query, or takes what a client told.
    pub(super) fn answer(&mut self, request: Inbox) {
        match request {
            Inbox::Scene(query) => {
                let scene = &self.settings.scene;
                let snapshot = wire::scene_snapshot(scene, self.settings.scene_hash, &self.nets, &self.output);
                reply::<SceneSnapshot>(&query, &snapshot);
            }
            Inbox::Status(query) => reply(&query, &self.status),
            Inbox::Net(body, query) => reply(&query, &self.nets[body]),
            Inbox::Info(query) => reply_json(&query, &self.info()),
            Inbox::Device(tool, query) => {
                // Nothing to say is no reply: the query ends empty.
                if let Some(info) = self.devices.info(tool) {
                    reply(&query, info);
                }
            }
            Inbox::Told(tool, info) => self.told(tool, *info),
            Inbox::ToolToken { tool, present } => {
                let Some(t) = self.settings.scene.tool_index(&tool) else { return };
                if present {
                    self.release(t);
                } else {
                    self.ports.poses[t].forget_sender();
                    self.devices.forget(t);
                }
            }
            Inbox::Rpc(method, query) => self.rpc(method, query),
        }
    }

    fn info(&self) -> serde_json::Value {
        let scene = &self.settings.scene;
        serde_json::json!({
            "name": "palpate",
            "version": env!("CARGO_PKG_VERSION"),
            "instance": self.settings.instance,
            "scene": scene.name,
            "rate_hz": 1.0 / scene.dt_s,
            "tools": (0..scene.tool_count()).map(|t| scene.tool_id(t)).collect::<Vec<_>>(),
            "bodies": (0..scene.body_count()).map(|b| scene.body_id(b)).collect::<Vec<_>>(),
            "devices": self.devices.report(|tool| scene.tool_id(tool)),
            "messages": [ToolPose::NAME, ToolForce::NAME, ToolContact::NAME, DeviceInfo::NAME, ControlNet::NAME, ContactSet::NAME, LoopStatus::NAME,
                SimEvent::NAME, SceneSnapshot::NAME],
        })
    }

    fn rpc(&mut self, method: &'static str, query: Query) {
        let payload = query.payload().map(|p| p.to_bytes().into_owned()).unwrap_or_default();
        let request = match Request::parse(&payload) {
            Ok(request) => request,
            Err(error) => {
                let error = Some(format!("the arguments of {method} do not parse: {error}"));
                return reply_json(&query, &Reply { ok: false, tick: None, error });
            }
        };
        let (command, event) = match method {
            "reset" => (Command::Reset, Some(EventKind::Reset)),
            "pause" => (Command::Pause, Some(EventKind::Paused)),
            "resume" => (Command::Resume, Some(EventKind::Resumed)),
            "step" => (Command::Step(request.ticks.unwrap_or(1)), None),
            _ => (Command::Stop, None),
        };
        let id = self.next_id;
        self.next_id += 1;
        if self.ports.commands.push(CommandRequest { id, command }).is_err() {
            let error = Some("too many commands are waiting; try again".to_owned());
            return reply_json(&query, &Reply { ok: false, tick: None, error });
        }
        match command {
            Command::Pause => self.status.state = LoopState::Paused,
            Command::Resume => self.status.state = LoopState::Running,
            Command::Stop => self.status.state = LoopState::Stopping,
            Command::Reset | Command::Step(_) | Command::Quality(_) | Command::Device { .. } => {}
        }
        self.pending.push((id, query));
        if let Some(kind) = event {
            self.event(kind);
        }
    }
}

fn reply<M: Message>(query: &Query, message: &M) {
    let _ = query.reply(query.key_expr().clone(), encode(message)).encoding(encoding::<M>()).wait();
}

pub(super) fn reply_json(query: &Query, value: &impl serde::Serialize) {
    let text = serde_json::to_string(value).unwrap_or_default();
    let _ = query.reply(query.key_expr().clone(), text).encoding(Encoding::APPLICATION_JSON).wait();
}
