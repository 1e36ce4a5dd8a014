//! How messages are published: encoding and quality of service by type.

use palpate_proto::codec::encoding_schema;
use palpate_proto::layout::Delivery;
use palpate_proto::messages::Message;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};

/// Encoding that goes with a message: `application/octet-stream;postcard;palpate.ToolPose.v1`.
pub fn encoding<M: Message>() -> Encoding {
    Encoding::APPLICATION_OCTET_STREAM.with_schema(encoding_schema::<M>())
}

/// Declares a publisher of a message, with the quality of service that docs/wire.md lists for it.
///
/// # Errors
/// Zenoh refused.
pub fn publisher<M: Message>(
    session: &zenoh::Session,
    key: String,
) -> zenoh::Result<Publisher<'static>> {
    let (priority, congestion) = match M::TYPE.delivery {
        Delivery::Motion => (Priority::RealTime, CongestionControl::Drop),
        Delivery::Health => (Priority::DataHigh, CongestionControl::Drop),
        Delivery::Net => (Priority::Data, CongestionControl::Drop),
        Delivery::Event => (Priority::InteractiveLow, CongestionControl::Block),
        Delivery::Announcement => (Priority::InteractiveHigh, CongestionControl::Block),
        Delivery::Answer => (Priority::DEFAULT, CongestionControl::DEFAULT),
    };
    session
        .declare_publisher(key)
        .encoding(encoding::<M>())
        .priority(priority)
        .congestion_control(congestion)
        .express(M::TYPE.delivery == Delivery::Motion)
        .wait()
}
