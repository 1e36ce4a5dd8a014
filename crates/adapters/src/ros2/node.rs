//! A node of the ROS graph on a Zenoh session: publishers, subscribers, services, with the attachments
//! and tokens that rmw_zenoh expects.

use super::super::unix_ns;
use palpate_client::is_one_key;
use palpate_devices::cdr::{self, encode};
use palpate_devices::ros2::{
    Attachment, Endpoint, Gid, Kind, Node, Qos, RosMessage, RosType, TriggerResponse, node_token,
    topic_key, topic_subscription,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::{Query, Queryable};
use zenoh::sample::{Sample, SampleKind};

/// A node; its token lasts as long as it.
pub struct RosNode {
    session: zenoh::Session,
    node: Node,
    next: AtomicU64,
    _token: LivelinessToken,
}

/// Publishes one topic.
pub struct RosPublisher {
    publisher: Publisher<'static>,
    gid: Gid,
    sequence: AtomicI64,
    _token: LivelinessToken,
}

/// Subscribes to one topic, or answers one service.
pub struct RosReceiver {
    _subscriber: Option<Subscriber<()>>,
    _queryable: Option<Queryable<()>>,
    _token: LivelinessToken,
}

/// Messages of a topic that were taken, and that were dropped, by cause.
#[derive(Debug, Default)]
pub struct Intake {
    /// Taken.
    pub taken: AtomicU64,
    /// No attachment.
    pub no_attachment: AtomicU64,
    /// An attachment of neither form.
    pub bad_attachment: AtomicU64,
    /// Not such a message.
    pub malformed: AtomicU64,
    /// In a frame other than the one that was asked for.
    pub wrong_frame: AtomicU64,
    /// Marked as not valid by a stamp of 0.
    pub not_valid: AtomicU64,
    /// Of a second publisher while the first one is there.
    pub other_publisher: AtomicU64,
    /// Came faster than they were taken.
    pub overrun: AtomicU64,
}

impl Intake {
    /// Counts; says why once.
    pub fn drop_one(&self, counter: &AtomicU64, topic: &str, why: &str) {
        if counter.fetch_add(1, Ordering::Relaxed) == 0 {
            tracing::warn!(
                topic,
                why,
                "a ROS message was dropped; later ones like it are only counted"
            );
        }
    }

    /// All counts by name.
    pub fn counts(&self) -> [(&'static str, u64); 8] {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        [
            ("taken", count(&self.taken)),
            ("no attachment", count(&self.no_attachment)),
            ("bad attachment", count(&self.bad_attachment)),
            ("malformed", count(&self.malformed)),
            ("wrong frame", count(&self.wrong_frame)),
            ("not valid", count(&self.not_valid)),
            ("other publisher", count(&self.other_publisher)),
            ("overrun", count(&self.overrun)),
        ]
    }
}

impl RosNode {
    /// Joins the graph.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn new(session: &zenoh::Session, domain: u32, name: &str) -> zenoh::Result<Self> {
        let node = Node {
            domain,
            zid: session.zid().to_string(),
            id: 0,
            name: name.to_owned(),
        };
        let token = session
            .liveliness()
            .declare_token(node_token(&node))
            .wait()?;
        Ok(Self {
            session: session.clone(),
            node,
            next: AtomicU64::new(1),
            _token: token,
        })
    }

    fn endpoint(
        &self,
        kind: Kind,
        topic: &str,
        ros_type: &'static RosType,
        qos: Qos,
    ) -> zenoh::Result<(LivelinessToken, Gid)> {
        let end = Endpoint {
            kind,
            id: self.next.fetch_add(1, Ordering::Relaxed),
            topic: topic.to_owned(),
            ros_type,
            qos,
        };
        let token = end.token(&self.node);
        let declared = self.session.liveliness().declare_token(token).wait()?;
        Ok((declared, end.gid(&self.node)))
    }

    /// Publishes a topic.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn publisher<M: RosMessage>(&self, topic: &str, qos: Qos) -> zenoh::Result<RosPublisher> {
        let (token, gid) = self.endpoint(Kind::Publisher, topic, M::TYPE, qos)?;
        let key = topic_key(self.node.domain, topic, M::TYPE);
        let (priority, congestion) = match qos {
            Qos::Newest => (Priority::RealTime, CongestionControl::Drop),
            Qos::Reliable => (Priority::DataHigh, CongestionControl::Block),
        };
        let publisher = (self.session)
            .declare_publisher(key)
            .encoding(Encoding::APPLICATION_CDR)
            .priority(priority)
            .congestion_control(congestion)
            .express(qos == Qos::Newest)
            .wait()?;
        Ok(RosPublisher {
            publisher,
            gid,
            sequence: AtomicI64::new(1),
            _token: token,
        })
    }

    /// Calls `take` for each message, on a receive thread.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn subscriber<M: RosMessage>(
        &self,
        topic: &str,
        qos: Qos,
        intake: &Arc<Intake>,
        take: impl Fn(M, Attachment) + Send + Sync + 'static,
    ) -> zenoh::Result<RosReceiver> {
        let (token, _) = self.endpoint(Kind::Subscription, topic, M::TYPE, qos)?;
        let (intake, name) = (intake.clone(), topic.to_owned());
        let callback = move |sample: Sample| {
            if sample.kind() == SampleKind::Put
                && is_one_key(sample.key_expr())
                && let Some((message, attachment)) = read(&sample, &intake, &name)
            {
                take(message, attachment);
            }
        };
        let subscriber = (self.session)
            .declare_subscriber(topic_subscription(self.node.domain, topic, M::TYPE))
            .callback(callback)
            .wait()?;
        Ok(RosReceiver {
            _subscriber: Some(subscriber),
            _queryable: None,
            _token: token,
        })
    }

    /// Answers `std_srvs/srv/Trigger`: `take` gets each call, on a receive thread.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn trigger(
        &self,
        service: &str,
        take: impl Fn(TriggerCall) + Send + Sync + 'static,
    ) -> zenoh::Result<RosReceiver> {
        let ros_type = TriggerResponse::TYPE;
        let (token, _) = self.endpoint(Kind::Service, service, ros_type, Qos::Reliable)?;
        let queryable = (self.session)
            .declare_queryable(topic_subscription(self.node.domain, service, ros_type))
            .complete(true)
            .callback(move |query: Query| {
                // A browser of the bus that asks for a pattern calls no service.
                if is_one_key(query.key_expr()) {
                    take(TriggerCall(query));
                }
            })
            .wait()?;
        Ok(RosReceiver {
            _subscriber: None,
            _queryable: Some(queryable),
            _token: token,
        })
    }
}

fn read<M: RosMessage>(sample: &Sample, intake: &Intake, topic: &str) -> Option<(M, Attachment)> {
    let Some(attachment) = sample.attachment() else {
        intake.drop_one(&intake.no_attachment, topic, "it has no attachment");
        return None;
    };
    let attachment = match Attachment::from_bytes(&attachment.to_bytes()) {
        Ok(attachment) => attachment,
        Err(error) => {
            intake.drop_one(&intake.bad_attachment, topic, &error.to_string());
            return None;
        }
    };
    match cdr::decode(&sample.payload().to_bytes()) {
        Ok(message) => Some((message, attachment)),
        Err(error) => {
            intake.drop_one(&intake.malformed, topic, &error.to_string());
            None
        }
    }
}

impl RosPublisher {
    /// Publishes a message.
    pub fn put<M: RosMessage>(&self, message: &M) {
        let attachment = Attachment {
            sequence: self.sequence.fetch_add(1, Ordering::Relaxed),
            source_ns: unix_ns() as i64,
            gid: self.gid,
        };
        let put = (self.publisher)
            .put(encode(message))
            .attachment(attachment.to_bytes())
            .wait();
        if let Err(error) = put {
            tracing::debug!(%error, "publishing a ROS message");
        }
    }

    /// Someone subscribes.
    pub fn is_wanted(&self) -> bool {
        let status = self.publisher.matching_status().wait();
        status.is_ok_and(|status| status.matching())
    }
}

/// A call of a service that waits for its answer.
pub struct TriggerCall(Query);

impl TriggerCall {
    /// Answers. The attachment carries the caller's number and identity, by which it knows the
    /// answer.
    pub fn answer(self, success: bool, message: String) {
        let asked = self.0.attachment().map(|bytes| bytes.to_bytes());
        let Some(Ok(asked)) = asked.map(|bytes| Attachment::from_bytes(&bytes)) else {
            let _ = self
                .0
                .reply_err("a ROS service call has an attachment")
                .wait();
            return;
        };
        let attachment = Attachment {
            source_ns: unix_ns() as i64,
            ..asked
        };
        let response = TriggerResponse { success, message };
        let _ = (self.0)
            .reply(self.0.key_expr().clone(), encode(&response))
            .encoding(Encoding::APPLICATION_CDR)
            .attachment(attachment.to_bytes())
            .wait();
    }
}
