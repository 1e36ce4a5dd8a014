//! The Foxglove WebSocket protocol, as far as a server speaks it that only shows.
//!
//! Text is JSON with an `op`; a message of a channel is binary. Source: foxglove/ws-protocol,
//! `docs/spec.md` (`foxglove.websocket.v1`); `foxglove.sdk.v1` is the same for what is used here.

use base64::Engine as _;
use palpate_proto::recording::descriptors;
use palpate_record::ViewTopic;
use serde::Deserialize;

/// Subprotocols that are spoken, the newest first.
pub(super) const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// Begins a message of a channel.
const MESSAGE_DATA: u8 = 1;

/// What a client asks for. Other requests, for abilities that were not announced, are not read.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(super) enum Request {
    /// Messages of channels.
    Subscribe {
        /// One for each channel.
        subscriptions: Vec<Subscription>,
    },
    /// No more messages.
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        /// As given by the client.
        subscription_ids: Vec<u32>,
    },
    /// Anything else.
    #[serde(other)]
    Other,
}

/// A client's name for the messages of a channel.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "camelCase")]
pub(super) struct Subscription {
    pub(super) id: u32,
    pub(super) channel_id: u32,
}

/// The first message of a server.
pub(super) fn server_info(instance: &str, session: &str) -> String {
    serde_json::json!({
        "op": "serverInfo",
        "name": format!("palpate {instance}"),
        "capabilities": [],
        "supportedEncodings": [],
        "metadata": { "version": env!("CARGO_PKG_VERSION") },
        "sessionId": session,
    })
    .to_string()
}

/// Announces views as channels whose ids count from `first`.
pub(super) fn advertise(first: u32, topics: &[ViewTopic]) -> String {
    let channels: Vec<_> = (first..)
        .zip(topics)
        .map(|(id, view)| {
            let schema = descriptors(view.schema).unwrap_or_default();
            serde_json::json!({
                "id": id,
                "topic": view.topic,
                "encoding": "protobuf",
                "schemaName": view.schema,
                "schema": base64::engine::general_purpose::STANDARD.encode(schema),
                "schemaEncoding": "protobuf",
            })
        })
        .collect();
    serde_json::json!({ "op": "advertise", "channels": channels }).to_string()
}

/// Takes channels back.
pub(super) fn unadvertise(ids: std::ops::Range<u32>) -> String {
    let ids: Vec<u32> = ids.collect();
    serde_json::json!({ "op": "unadvertise", "channelIds": ids }).to_string()
}

/// Tells a client what it did wrong.
pub(super) fn warning(message: &str) -> String {
    serde_json::json!({ "op": "status", "level": 1, "message": message }).to_string()
}

/// A message of a channel, for one subscription.
pub(super) fn message_data(subscription: u32, time_ns: u64, payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(13 + payload.len());
    bytes.push(MESSAGE_DATA);
    bytes.extend_from_slice(&subscription.to_le_bytes());
    bytes.extend_from_slice(&time_ns.to_le_bytes());
    bytes.extend_from_slice(payload);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_and_unknown_ones_are_known_as_such() {
        let read = |text: &str| serde_json::from_str::<Request>(text);
        let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":3}]}"#;
        assert!(matches!(
            read(subscribe),
            Ok(Request::Subscribe { subscriptions })
                if subscriptions == [Subscription { id: 7, channel_id: 3 }]
        ));
        let unsubscribe = r#"{"op":"unsubscribe","subscriptionIds":[7]}"#;
        assert!(matches!(
            read(unsubscribe),
            Ok(Request::Unsubscribe { subscription_ids }) if subscription_ids == [7]
        ));
        let other = r#"{"op":"getParameters","parameterNames":[]}"#;
        assert!(matches!(read(other), Ok(Request::Other)));
        for wrong in ["", "[]", "{}", r#"{"op":"subscribe"}"#] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_message_begins_with_its_kind_subscription_and_time() {
        let bytes = message_data(0x0102_0304, 0x1122_3344_5566_7788, b"ab");
        let expected = [
            1, 4, 3, 2, 1, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, b'a', b'b',
        ];
        assert_eq!(bytes, expected);
    }
}
