//! Frames of the page's socket: a key relative to `palpate/{inst}/`, then the payload of the bus.
//!
//! ```text
//! varint length of the key │ key, UTF-8 │ payload, bit for bit as on the bus
//! ```

use axum::body::Bytes;
use palpate_proto::messages::Message;
use serde::Serialize;

/// Longest frame that a page may send, bytes.
pub(super) const MOST_BYTES: usize = 64 << 10;

/// The key of a message relative to its instance; `id` is that of its tool or body.
pub(super) fn key_of<M: Message>(id: &str) -> String {
    M::KEY.replace("{tool}", id).replace("{body}", id)
}

/// A frame.
pub(super) fn frame(key: &str, payload: &[u8]) -> Bytes {
    let mut bytes = Vec::with_capacity(key.len() + payload.len() + 3);
    put_text(&mut bytes, key);
    bytes.extend_from_slice(payload);
    bytes.into()
}

/// A frame whose payload is a string that holds JSON.
pub(super) fn json_frame(key: &str, value: &impl Serialize) -> Bytes {
    let mut payload = Vec::new();
    put_text(
        &mut payload,
        &serde_json::to_string(value).unwrap_or_default(),
    );
    frame(key, &payload)
}

/// The answer to a command of the page: its number, then JSON.
pub(super) fn answer_frame(id: u64, json: &str) -> Bytes {
    let mut payload = Vec::new();
    put_varint(&mut payload, id);
    put_text(&mut payload, json);
    frame("rpc", &payload)
}

/// A write of the page was refused.
pub(super) fn refused_frame(key: &str, reason: &str) -> Bytes {
    json_frame(
        "refused",
        &serde_json::json!({ "key": key, "error": reason }),
    )
}

/// Key and payload of a frame; `None` if it is not one.
pub(super) fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    take_text(bytes)
}

/// A string, and what follows it.
pub(super) fn take_text(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (length, rest) = postcard::take_from_bytes::<u64>(bytes).ok()?;
    let (text, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((std::str::from_utf8(text).ok()?, rest))
}

/// A number, and what follows it.
pub(super) fn take_varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    postcard::take_from_bytes::<u64>(bytes).ok()
}

fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put_varint(bytes, text.len() as u64);
    bytes.extend_from_slice(text.as_bytes());
}

fn put_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_read_back_and_pieces_of_one_are_refused() {
        let long = "k".repeat(200);
        for key in ["scene", "tool/ball/pose", &long] {
            let bytes = frame(key, &[1, 2, 3]);
            assert_eq!(split(&bytes), Some((key, &[1u8, 2, 3][..])));
            for cut in 0..key.len() {
                assert_eq!(split(&bytes[..cut]), None, "{key} cut at {cut}");
            }
        }
        assert_eq!(split(&[2, 0xff, 0xfe]), None, "not UTF-8");
        assert_eq!(split(&[0xff; 20]), None, "no length");
    }

    #[test]
    fn an_answer_has_its_number_before_its_text() {
        let bytes = answer_frame(300, "{\"ok\":true}");
        let (key, payload) = split(&bytes).unwrap();
        let (id, rest) = take_varint(payload).unwrap();
        assert_eq!(
            (key, id, take_text(rest).unwrap().0),
            ("rpc", 300, "{\"ok\":true}")
        );
    }
}
