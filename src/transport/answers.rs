//! Answers to queries.

use super::bus::BusThread;
use super::declared::{Inbox, encoding};
use super::schemas;
use crate::wire;
use palpate_proto::codec::encode;
use palpate_proto::messages::{ALL, Message, SceneSnapshot};
use palpate_proto::rpc::{Answer, METHODS};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;
use zenoh::query::Query;

impl BusThread {
    /// Answers a query, or takes what a client told.
    pub(super) fn answer(&mut self, request: Inbox) {
        match request {
            Inbox::Scene(query) => {
                let scene = &self.settings.scene;
                let snapshot =
                    wire::scene_snapshot(scene, self.settings.scene_hash, &self.nets, &self.output);
                reply::<SceneSnapshot>(&query, &snapshot);
            }
            Inbox::Status(query) => {
                self.count_links();
                reply(&query, &self.status);
            }
            Inbox::Net(body, query) => {
                // A body that has just gone is no reply: the query ends empty.
                if let Some(net) = self.nets.iter().find(|net| net.body == body) {
                    reply(&query, net);
                }
            }
            Inbox::Info(query) => reply_json(&query, query.key_expr().clone(), &self.info()),
            Inbox::Schema(query) => schemas::answer(&self.keys, &query),
            Inbox::Metrics(query) => {
                self.count_links();
                let text = self.figures().text();
                let encoding = Encoding::APPLICATION_OPENMETRICS_TEXT;
                let _ = query
                    .reply(query.key_expr().clone(), text)
                    .encoding(encoding)
                    .wait();
            }
            Inbox::Events(query) => self.past_events(&query),
            Inbox::Device(tool, query) => {
                // Nothing to say is no reply: the query ends empty.
                if let Some(info) = self.devices.info(tool) {
                    reply(&query, info);
                }
            }
            Inbox::Told(tool, info) => self.told(tool, *info),
            Inbox::ToolToken { tool, present } => {
                let Some(t) = self.settings.scene.tool_index(&tool) else {
                    return;
                };
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
            "messages": ALL.iter().map(|message| message.name).collect::<Vec<_>>(),
            "methods": METHODS,
            "played": self.settings.player.is_some(),
            "recorder": self.status.recorder,
            "viewer": self.settings.viewer_url,
        })
    }

    /// The events kept whose number is above `after`, each in an answer of its own, oldest first.
    fn past_events(&self, query: &Query) {
        let after = match query.parameters().get("after").map(str::parse::<u64>) {
            None => 0,
            Some(Ok(after)) => after,
            Some(Err(_)) => {
                return reply_refused(query, "after is the number of an event: event?after=17");
            }
        };
        for event in self.history.after(after) {
            reply(query, event);
        }
    }
}

fn reply<M: Message>(query: &Query, message: &M) {
    let _ = query
        .reply(query.key_expr().clone(), encode(message))
        .encoding(encoding::<M>())
        .wait();
}

/// Answers under a key with JSON.
pub(super) fn reply_json(query: &Query, key: KeyExpr<'static>, value: &impl serde::Serialize) {
    let text = serde_json::to_string(value).unwrap_or_default();
    let _ = query
        .reply(key, text)
        .encoding(Encoding::APPLICATION_JSON)
        .wait();
}

/// Answers with an error: JSON like that of a refused command.
pub(super) fn reply_refused(query: &Query, reason: &str) {
    let text = serde_json::to_string(&Answer::<()>::refused(reason)).unwrap_or_default();
    let _ = query
        .reply_err(text)
        .encoding(Encoding::APPLICATION_JSON)
        .wait();
}
