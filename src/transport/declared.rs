//! Everything the daemon declares on its session, and what its callbacks do.

use super::devices::{Devices, take_device};
use crate::scene::Scene;
use crate::tick::ports::{BusPorts, PoseInbox};
use crate::wire;
use palpate_proto::codec::{decode, encoding_schema};
use palpate_proto::keys::Keys;
use palpate_proto::messages::{
    ContactSet, ControlNet, DeviceInfo, LoopStatus, Message, SimEvent, ToolContact, ToolForce, ToolPose,
};
use palpate_proto::rpc::METHODS;
use std::sync::atomic::Ordering;
use std::sync::mpsc::SyncSender;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::sample::SampleKind;

/// What callbacks hand to the bus thread. Queries wait here until the bus replies.
pub(super) enum Inbox {
    Rpc(&'static str, Query),
    Scene(Query),
    Status(Query),
    Net(usize, Query),
    Info(Query),
    Device(usize, Query),
    Told(usize, Box<DeviceInfo>),
    ToolToken { tool: String, present: bool },
}

pub(super) fn encoding<M: Message>() -> Encoding {
    Encoding::APPLICATION_OCTET_STREAM.with_schema(encoding_schema::<M>())
}

/// Schema part of a sample's encoding; empty when it has none.
fn schema_of(encoding: &Encoding) -> String {
    let text = encoding.to_string();
    text.split_once(';').map_or(String::new(), |(_, schema)| schema.to_owned())
}

/// Everything declared. Undeclared in this order: nothing comes in before nothing goes out.
pub(super) struct Declared {
    _tool_subscribers: Vec<zenoh::pubsub::Subscriber<()>>,
    _live_subscriber: zenoh::pubsub::Subscriber<()>,
    _queryables: Vec<zenoh::query::Queryable<()>>,
    _token: zenoh::liveliness::LivelinessToken,
    pub(super) forces: Vec<Publisher<'static>>,
    /// What contacts do, by tool.
    pub(super) tool_contacts: Vec<Publisher<'static>>,
    pub(super) nets: Vec<Publisher<'static>>,
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
        let (mut forces, mut tool_contacts, mut tool_subscribers) = (Vec::new(), Vec::new(), Vec::new());
        for tool in 0..scene.tool_count() {
            let id = scene.tool_id(tool);
            forces.push(publisher(keys.tool_force(id), encoding::<ToolForce>(), Priority::RealTime, drop, true)?);
            let key = keys.tool_contact(id);
            tool_contacts.push(publisher(key, encoding::<ToolContact>(), Priority::RealTime, drop, true)?);
            let poses = ports.poses[tool].clone();
            let subscriber = session
                .declare_subscriber(keys.tool_pose(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put {
                        take_pose(&poses, &sample.payload().to_bytes(), &schema_of(sample.encoding()));
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
            let (inbox, refused) = (inbox.clone(), devices.refused(tool));
            let subscriber = session
                .declare_subscriber(keys.tool_device(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put {
                        let schema = schema_of(sample.encoding());
                        if let Some(info) = take_device(&refused, &sample.payload().to_bytes(), &schema) {
                            let _ = inbox.try_send(Inbox::Told(tool, Box::new(info)));
                        }
                    }
                })
                .wait()?;
            tool_subscribers.push(subscriber);
        }
        let mut nets = Vec::new();
        let mut queryables = Vec::new();
        let mut queryable = |key: String, wrap: Box<dyn Fn(Query) -> Inbox + Send + Sync>| -> zenoh::Result<()> {
            let inbox = inbox.clone();
            let callback = move |query| {
                let _ = inbox.try_send(wrap(query));
            };
            queryables.push(session.declare_queryable(key).callback(callback).wait()?);
            Ok(())
        };
        for body in 0..scene.body_count() {
            let key = keys.body_net(scene.body_id(body));
            nets.push(publisher(key.clone(), encoding::<ControlNet>(), Priority::Data, drop, false)?);
            queryable(key, Box::new(move |query| Inbox::Net(body, query)))?;
        }
        for tool in 0..scene.tool_count() {
            queryable(keys.tool_device(scene.tool_id(tool)), Box::new(move |query| Inbox::Device(tool, query)))?;
        }
        queryable(keys.scene(), Box::new(Inbox::Scene))?;
        queryable(keys.status(), Box::new(Inbox::Status))?;
        queryable(keys.meta_info(), Box::new(Inbox::Info))?;
        for method in METHODS {
            queryable(keys.rpc(method), Box::new(move |query| Inbox::Rpc(method, query)))?;
        }
        let live_inbox = inbox.clone();
        let live_keys = keys.clone();
        let live_subscriber = session
            .liveliness()
            .declare_subscriber(keys.live_tool("*"))
            .callback(move |sample| {
                if let Some(tool) = live_keys.tool_of_live(sample.key_expr().as_str()) {
                    let present = sample.kind() == SampleKind::Put;
                    let _ = live_inbox.try_send(Inbox::ToolToken { tool: tool.to_owned(), present });
                }
            })
            .wait()?;
        let token = session.liveliness().declare_token(keys.live_server(&session.zid().to_string())).wait()?;
        Ok(Self {
            _tool_subscribers: tool_subscribers,
            _live_subscriber: live_subscriber,
            _queryables: queryables,
            _token: token,
            forces,
            tool_contacts,
            nets,
            contacts: publisher(keys.contact(), encoding::<ContactSet>(), Priority::DataHigh, drop, false)?,
            status: publisher(keys.status(), encoding::<LoopStatus>(), Priority::DataHigh, drop, false)?,
            events: publisher(keys.event(), encoding::<SimEvent>(), Priority::InteractiveLow, block, false)?,
        })
    }
}

/// Decodes, checks, stores. Runs on a receive thread: counts what it refuses and never logs a flood.
fn take_pose(inbox: &PoseInbox, bytes: &[u8], schema: &str) {
    match decode::<ToolPose>(bytes, schema) {
        Err(error) => {
            if inbox.counters.malformed.fetch_add(1, Ordering::Relaxed) == 0 {
                tracing::warn!(%error, "a pose was dropped; later ones are only counted");
            }
        }
        Ok(pose) => match pose.validated() {
            Err(error) => {
                if inbox.counters.invalid.fetch_add(1, Ordering::Relaxed) == 0 {
                    tracing::warn!(%error, "a pose was dropped; later ones are only counted");
                }
            }
            Ok(pose) => {
                inbox.offer(wire::device_pose(&pose));
            }
        },
    }
}
