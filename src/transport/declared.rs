//! What the daemon listens to on its session, and what its callbacks do.

use super::clients::ClientLink;
use super::devices::{Devices, refuse_stranger, take_device};
use super::events::server_ns;
use super::intake::{Intake, Question};
use super::poses::{sender_of, take_pose};
use palpate_client::is_one_key;
use palpate_drive::ports::PoseInbox;
use palpate_proto::keys::Keys;
use palpate_proto::rpc::METHODS;
use palpate_sim::scene::Scene;
use std::sync::Arc;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::sample::SampleKind;

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

/// Where what comes in goes.
pub(super) struct Inboxes<'a> {
    /// (tools)
    pub poses: &'a [Arc<PoseInbox>],
    /// (tools)
    pub clients: &'a [Arc<ClientLink>],
    pub devices: &'a Devices,
    pub intake: &'a Intake,
}

impl Declared {
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        inboxes: &Inboxes<'_>,
        roles: Roles,
    ) -> zenoh::Result<Self> {
        let Inboxes {
            poses,
            clients,
            devices,
            intake,
        } = *inboxes;
        let mut tool_subscribers = Vec::new();
        for tool in 0..scene.tool_count() {
            let id = scene.tool_id(tool);
            // No one holds a tool of a recording.
            if roles.player {
                continue;
            }
            let poses = poses[tool].clone();
            let (moved, client) = (poses.clone(), clients[tool].clone());
            let subscriber = session
                .declare_subscriber(keys.tool_pose(id))
                .callback(move |sample| {
                    // A message under a pattern names no tool.
                    if sample.kind() == SampleKind::Put && is_one_key(sample.key_expr()) {
                        let sender = sender_of(sample.attachment());
                        if take_pose(&moved, sample.payload(), sample.encoding(), sender) {
                            client.heard(sender, sample.attachment(), server_ns());
                        }
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
            let notices = intake.notices.clone();
            let (refused, holder) = (devices.refused(tool), poses.clone());
            let subscriber = session
                .declare_subscriber(keys.tool_device(id))
                .callback(move |sample| {
                    if !is_one_key(sample.key_expr()) {
                        return;
                    }
                    // Who does not hold the tool does not say what its device can bear.
                    let sender = sender_of(sample.attachment());
                    if !holder.may_hold(sender) {
                        refuse_stranger(&refused);
                    } else if sample.kind() == SampleKind::Put
                        && let Some(info) =
                            take_device(&refused, sample.payload(), &schema_of(sample.encoding()))
                    {
                        notices.reported(tool, Box::new(info));
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
        }
        let mut queryables = Vec::new();
        let mut question = |key: String, what: fn() -> Question| -> zenoh::Result<()> {
            let callback = intake.question(&intake.post(), what);
            queryables.push(session.declare_queryable(key).callback(callback).wait()?);
            Ok(())
        };
        question(keys.scene(), || Question::Scene)?;
        question(keys.status(), || Question::Status)?;
        question(keys.event(), || Question::Events)?;
        question(keys.meta_info(), || Question::Info)?;
        question(keys.meta_schema("*"), || Question::Schema)?;
        question(keys.meta_metrics(), || Question::Metrics)?;
        let devices_post = intake.post();
        for tool in 0..scene.tool_count() {
            let key = keys.tool_device(scene.tool_id(tool));
            let callback = intake.question(&devices_post, move || Question::Device(tool));
            queryables.push(session.declare_queryable(key).callback(callback).wait()?);
        }
        for &method in METHODS {
            let (key, callback) = (keys.rpc(method), intake.command(method));
            queryables.push(session.declare_queryable(key).callback(callback).wait()?);
        }
        let live_subscriber = if roles.player {
            None
        } else {
            Some(tokens_of_tools(session, keys, scene, intake)?)
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

/// Notes when a tool gets another holder.
fn tokens_of_tools(
    session: &zenoh::Session,
    keys: &Keys,
    scene: &Scene,
    intake: &Intake,
) -> zenoh::Result<zenoh::pubsub::Subscriber<()>> {
    let (notices, live_keys) = (intake.notices.clone(), keys.clone());
    // Tools stay what they are when a scene changes.
    let ids: Vec<String> = (0..scene.tool_count())
        .map(|tool| scene.tool_id(tool).to_owned())
        .collect();
    session
        .liveliness()
        .declare_subscriber(keys.live_tool("*"))
        .callback(move |sample| {
            let held = live_keys.tool_of_live(sample.key_expr().as_str());
            if let Some(tool) = held.and_then(|id| ids.iter().position(|known| known == id)) {
                notices.token(tool, sample.kind() == SampleKind::Put);
            }
        })
        .wait()
}
