//! Everything the daemon declares on its session, and what its callbacks do.

use super::devices::{Devices, take_device};
use super::poses::take_pose;
use crate::drive::ports::BusPorts;
use palpate_proto::codec::encoding_schema;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{
    ContactSet, ControlNet, DeviceInfo, LoopStatus, Message, SimEvent, ToolContact, ToolForce,
};
use palpate_proto::rpc::METHODS;
use palpate_sim::scene::Scene;
use std::sync::mpsc::SyncSender;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::sample::SampleKind;

/// What callbacks hand to the bus thread. Queries wait here until the bus replies.
pub(super) enum Inbox {
    Rpc(&'static str, Query),
    Scene(Query),
    Status(Query),
    Net(String, Query),
    Info(Query),
    Schema(Query),
    Metrics(Query),
    Events(Query),
    Device(usize, Query),
    Told(usize, Box<DeviceInfo>),
    ToolToken { tool: String, present: bool },
}

pub(super) fn encoding<M: Message>() -> Encoding {
    Encoding::APPLICATION_OCTET_STREAM.with_schema(encoding_schema::<M>())
}

/// Schema part of a sample's encoding; empty when it has none.
pub(super) fn schema_of(encoding: &Encoding) -> String {
    let text = encoding.to_string();
    text.split_once(';')
        .map_or(String::new(), |(_, schema)| schema.to_owned())
}

/// Everything declared. Undeclared in this order: nothing comes in before nothing goes out.
pub(super) struct Declared {
    _tool_subscribers: Vec<zenoh::pubsub::Subscriber<()>>,
    _live_subscriber: Option<zenoh::pubsub::Subscriber<()>>,
    _queryables: Vec<zenoh::query::Queryable<()>>,
    _tokens: Vec<LivelinessToken>,
    /// While something is recorded.
    recorder_token: Option<LivelinessToken>,
    recorder_key: String,
    pub(super) forces: Vec<Publisher<'static>>,
    /// What contacts do, by tool.
    pub(super) tool_contacts: Vec<Publisher<'static>>,
    pub(super) nets: Vec<Publisher<'static>>,
    /// Of bodies: they may change.
    net_queryables: Vec<zenoh::query::Queryable<()>>,
    inbox: SyncSender<Inbox>,
    pub(super) contacts: Publisher<'static>,
    pub(super) status: Publisher<'static>,
    pub(super) events: Publisher<'static>,
}

impl Declared {
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        ports: &BusPorts,
        devices: &Devices,
        inbox: &SyncSender<Inbox>,
        roles: Roles,
    ) -> zenoh::Result<Self> {
        let publisher = |key: String, encoding, priority, congestion, express| {
            session
                .declare_publisher(key)
                .encoding(encoding)
                .priority(priority)
                .congestion_control(congestion)
                .express(express)
                .wait()
        };
        let (drop, block) = (CongestionControl::Drop, CongestionControl::Block);
        let (mut forces, mut tool_contacts, mut tool_subscribers) =
            (Vec::new(), Vec::new(), Vec::new());
        for tool in 0..scene.tool_count() {
            let id = scene.tool_id(tool);
            forces.push(publisher(
                keys.tool_force(id),
                encoding::<ToolForce>(),
                Priority::RealTime,
                drop,
                true,
            )?);
            let key = keys.tool_contact(id);
            tool_contacts.push(publisher(
                key,
                encoding::<ToolContact>(),
                Priority::RealTime,
                drop,
                true,
            )?);
            // Nobody holds a tool of a recording.
            if roles.player {
                continue;
            }
            let poses = ports.poses[tool].clone();
            let subscriber = session
                .declare_subscriber(keys.tool_pose(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put {
                        take_pose(&poses, sample.payload(), sample.encoding());
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
            let (inbox, refused) = (inbox.clone(), devices.refused(tool));
            let subscriber = session
                .declare_subscriber(keys.tool_device(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put
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
            |key: String, wrap: Box<dyn Fn(Query) -> Inbox + Send + Sync>| -> zenoh::Result<()> {
                let inbox = inbox.clone();
                let callback = move |query| {
                    let _ = inbox.try_send(wrap(query));
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
        let mut declared = Self {
            _tool_subscribers: tool_subscribers,
            _live_subscriber: live_subscriber,
            _queryables: queryables,
            _tokens: tokens,
            recorder_token: None,
            recorder_key: keys.live_recorder(&id),
            forces,
            tool_contacts,
            nets: Vec::new(),
            net_queryables: Vec::new(),
            inbox: inbox.clone(),
            contacts: publisher(
                keys.contact(),
                encoding::<ContactSet>(),
                Priority::DataHigh,
                drop,
                false,
            )?,
            status: publisher(
                keys.status(),
                encoding::<LoopStatus>(),
                Priority::DataHigh,
                drop,
                false,
            )?,
            events: publisher(
                keys.event(),
                encoding::<SimEvent>(),
                Priority::InteractiveLow,
                block,
                false,
            )?,
        };
        declared.bodies(session, keys, scene)?;
        Ok(declared)
    }

    /// Declares the nets of a scene in the place of those before.
    pub(super) fn bodies(
        &mut self,
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
    ) -> zenoh::Result<()> {
        self.nets.clear();
        self.net_queryables.clear();
        for body in 0..scene.body_count() {
            let id = scene.body_id(body).to_owned();
            let key = keys.body_net(&id);
            let net = session
                .declare_publisher(key.clone())
                .encoding(encoding::<ControlNet>())
                .priority(Priority::Data)
                .congestion_control(CongestionControl::Drop)
                .wait()?;
            let inbox = self.inbox.clone();
            let asked = move |query| {
                let _ = inbox.try_send(Inbox::Net(id.clone(), query));
            };
            self.net_queryables
                .push(session.declare_queryable(key).callback(asked).wait()?);
            self.nets.push(net);
        }
        Ok(())
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
