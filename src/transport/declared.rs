//! What the daemon listens to on its session, and what its callbacks do.

use super::clients::ClientLink;
use super::devices::{Devices, refuse_stranger, take_device};
use super::events::server_ns;
use super::poses::{sender_of, take_pose};
use super::post::{Asked, Post};
use crate::drive::ports::PoseInbox;
use palpate_proto::keys::Keys;
use palpate_proto::messages::DeviceInfo;
use palpate_proto::rpc::METHODS;
use palpate_sim::scene::Scene;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::sample::SampleKind;

/// What callbacks hand to the bus thread. Queries wait here until the bus replies.
pub(super) enum Inbox {
    Rpc(&'static str, Asked),
    Scene(Asked),
    Status(Asked),
    Net(String, Asked),
    Info(Asked),
    Schema(Asked),
    Metrics(Asked),
    Events(Asked),
    Device(usize, Asked),
    Told(usize, Box<DeviceInfo>),
    ToolToken { tool: String, present: bool },
}

/// Schema part of a sample's encoding; empty when it has none.
pub(super) fn schema_of(encoding: &Encoding) -> String {
    let text = encoding.to_string();
    text.split_once(';')
        .map_or(String::new(), |(_, schema)| schema.to_owned())
}

/// Everything through which something comes in, and the tokens that say who is here.
pub(super) struct Declared {
    _tool_subscribers: Vec<zenoh::pubsub::Subscriber<()>>,
    _live_subscriber: Option<zenoh::pubsub::Subscriber<()>>,
    _queryables: Vec<zenoh::query::Queryable<()>>,
    _tokens: Vec<LivelinessToken>,
    /// While something is recorded.
    recorder_token: Option<LivelinessToken>,
    recorder_key: String,
}

impl Declared {
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        poses: &[Arc<PoseInbox>],
        clients: &[Arc<ClientLink>],
        devices: &Devices,
        inbox: &SyncSender<Inbox>,
        post: &Post,
        roles: Roles,
    ) -> zenoh::Result<Self> {
        let mut tool_subscribers = Vec::new();
        for tool in 0..scene.tool_count() {
            let id = scene.tool_id(tool);
            // Nobody holds a tool of a recording.
            if roles.player {
                continue;
            }
            let poses = poses[tool].clone();
            let (moved, client) = (poses.clone(), clients[tool].clone());
            let subscriber = session
                .declare_subscriber(keys.tool_pose(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put {
                        let sender = sender_of(sample.attachment());
                        if take_pose(&moved, sample.payload(), sample.encoding(), sender) {
                            client.heard(sender, sample.attachment(), server_ns());
                        }
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
            let (inbox, refused, holder) = (inbox.clone(), devices.refused(tool), poses.clone());
            let subscriber = session
                .declare_subscriber(keys.tool_device(id))
                .callback(move |sample| {
                    // Who does not hold the tool does not say what its device can bear.
                    let sender = sender_of(sample.attachment());
                    if !holder.may_hold(sender) {
                        refuse_stranger(&refused);
                    } else if sample.kind() == SampleKind::Put
                        && let Some(info) =
                            take_device(&refused, sample.payload(), &schema_of(sample.encoding()))
                    {
                        let _ = inbox.try_send(Inbox::Told(tool, Box::new(info)));
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
        }
        let mut queryables = Vec::new();
        let mut queryable =
            |key: String, wrap: Box<dyn Fn(Asked) -> Inbox + Send + Sync>| -> zenoh::Result<()> {
                let (inbox, post) = (inbox.clone(), post.clone());
                let callback = move |query| {
                    // Without room its client hears nothing, which is how it ends.
                    if post.has_room() {
                        let _ = inbox.try_send(wrap(Asked::new(query, &post)));
                    }
                };
                queryables.push(session.declare_queryable(key).callback(callback).wait()?);
                Ok(())
            };
        for tool in 0..scene.tool_count() {
            queryable(
                keys.tool_device(scene.tool_id(tool)),
                Box::new(move |query| Inbox::Device(tool, query)),
            )?;
        }
        queryable(keys.scene(), Box::new(Inbox::Scene))?;
        queryable(keys.status(), Box::new(Inbox::Status))?;
        queryable(keys.event(), Box::new(Inbox::Events))?;
        queryable(keys.meta_info(), Box::new(Inbox::Info))?;
        queryable(keys.meta_schema("*"), Box::new(Inbox::Schema))?;
        queryable(keys.meta_metrics(), Box::new(Inbox::Metrics))?;
        for &method in METHODS {
            queryable(
                keys.rpc(method),
                Box::new(move |query| Inbox::Rpc(method, query)),
            )?;
        }
        let live_subscriber = if roles.player {
            None
        } else {
            Some(tokens_of_tools(session, keys, inbox)?)
        };
        let id = session.zid().to_string();
        let mut tokens = vec![
            session
                .liveliness()
                .declare_token(keys.live_server(&id))
                .wait()?,
        ];
        if roles.viewer {
            tokens.push(
                session
                    .liveliness()
                    .declare_token(keys.live_viewer(&id))
                    .wait()?,
            );
        }
        Ok(Self {
            _tool_subscribers: tool_subscribers,
            _live_subscriber: live_subscriber,
            _queryables: queryables,
            _tokens: tokens,
            recorder_token: None,
            recorder_key: keys.live_recorder(&id),
        })
    }

    /// Shows whether something is being recorded.
    pub(super) fn show_recording(&mut self, session: &zenoh::Session, recording: bool) {
        if recording == self.recorder_token.is_some() {
            return;
        }
        self.recorder_token = if recording {
            let declared = session
                .liveliness()
                .declare_token(self.recorder_key.clone())
                .wait();
            declared
                .inspect_err(|error| tracing::warn!(%error, "the recorder's token"))
                .ok()
        } else {
            None
        };
    }
}

/// What else a daemon is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Roles {
    /// It plays a recording: poses and devices are not listened to.
    pub player: bool,
    /// It serves a page.
    pub viewer: bool,
}

/// Tells when a tool gets another holder.
fn tokens_of_tools(
    session: &zenoh::Session,
    keys: &Keys,
    inbox: &SyncSender<Inbox>,
) -> zenoh::Result<zenoh::pubsub::Subscriber<()>> {
    let (inbox, live_keys) = (inbox.clone(), keys.clone());
    session
        .liveliness()
        .declare_subscriber(keys.live_tool("*"))
        .callback(move |sample| {
            if let Some(tool) = live_keys.tool_of_live(sample.key_expr().as_str()) {
                let present = sample.kind() == SampleKind::Put;
                let _ = inbox.try_send(Inbox::ToolToken {
                    tool: tool.to_owned(),
                    present,
                });
            }
        })
        .wait()
}
