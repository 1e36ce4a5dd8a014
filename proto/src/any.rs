//! Messages of whatever type, as JSON: for tools that show what is on the bus.

use crate::decode_error::DecodeError;
use crate::layout::MessageType;
use crate::messages::ALL;
use serde_json::Value;

/// The message under a key, where there is no encoding that names it.
pub fn type_of_key(key: &str) -> Option<&'static MessageType> {
    let rest = key.strip_prefix("palpate/")?.split_once('/')?.1;
    ALL.iter().copied().find(|message| {
        let (mut own, mut given) = (message.key.split('/'), rest.split('/'));
        loop {
            match (own.next(), given.next()) {
                (None, None) => return true,
                (Some(own), Some(given)) if own == given || own.starts_with('{') => {}
                _ => return false,
            }
        }
    })
}

/// Versioned name of the messages under a key, where there is no encoding that names it.
pub fn name_of_key(key: &str) -> Option<&'static str> {
    type_of_key(key).map(|message| message.name)
}

/// A message as JSON by its versioned name; `None` for a name that is not ours.
///
/// # Errors
/// Not the bytes of such a message.
pub fn to_json(name: &str, bytes: &[u8]) -> Option<Result<Value, DecodeError>> {
    ALL.iter()
        .find(|message| message.name == name)
        .map(|message| (message.to_json)(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_shown_by_name_and_keys_tell_names() {
        let pose = [&[1, 2][..], &[0; 13 * 8], &[0, 0]].concat();
        let value = to_json("palpate.ToolPose.v1", &pose).unwrap().unwrap();
        assert_eq!(
            (value["seq"].as_u64(), value["t_client_ns"].as_u64()),
            (Some(1), Some(2))
        );
        assert!(to_json("palpate.ToolPose.v1", &pose[1..]).unwrap().is_err());
        assert!(to_json("palpate.ToolPose.v9", &pose).is_none());
        assert_eq!(
            name_of_key("palpate/default/tool/ball/contact"),
            Some("palpate.ToolContact.v1")
        );
        assert_eq!(
            name_of_key("palpate/default/contact"),
            Some("palpate.ContactSet.v1")
        );
        assert_eq!(name_of_key("demo/contact"), None);
    }
}
