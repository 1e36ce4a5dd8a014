//! Messages of whatever type, as JSON: for tools that show what is on the bus.

use crate::codec::{DecodeError, decode};
use crate::messages::{
    ContactSet, ControlNet, DeviceInfo, LoopStatus, Message, SceneSnapshot, SimEvent, ToolContact,
    ToolForce, ToolPose,
};
use serde_json::Value;

type Decoder = fn(&[u8]) -> Result<Value, DecodeError>;

fn decoder<M: Message>() -> (&'static str, Decoder) {
    fn to_json<M: Message>(bytes: &[u8]) -> Result<Value, DecodeError> {
        let message: M = decode(bytes, "")?;
        // Numbers that JSON does not have become null.
        Ok(serde_json::to_value(message).unwrap_or(Value::Null))
    }
    (M::NAME, to_json::<M>)
}

fn decoders() -> [(&'static str, Decoder); 9] {
    [
        decoder::<ToolPose>(),
        decoder::<ToolForce>(),
        decoder::<ToolContact>(),
        decoder::<DeviceInfo>(),
        decoder::<ControlNet>(),
        decoder::<ContactSet>(),
        decoder::<LoopStatus>(),
        decoder::<SimEvent>(),
        decoder::<SceneSnapshot>(),
    ]
}

/// Versioned name of the messages under a key, for messages without an encoding.
pub fn name_of_key(key: &str) -> Option<&'static str> {
    let chunks: Vec<&str> = key.split('/').collect();
    let ["palpate", _, rest @ ..] = &chunks[..] else {
        return None;
    };
    Some(match rest {
        ["tool", _, "pose"] => ToolPose::NAME,
        ["tool", _, "force"] => ToolForce::NAME,
        ["tool", _, "contact"] => ToolContact::NAME,
        ["tool", _, "device"] => DeviceInfo::NAME,
        ["body", _, "net"] => ControlNet::NAME,
        ["contact"] => ContactSet::NAME,
        ["status"] => LoopStatus::NAME,
        ["event"] => SimEvent::NAME,
        ["scene"] => SceneSnapshot::NAME,
        _ => return None,
    })
}

/// A message as JSON by its versioned name; `None` for a name that is not ours.
///
/// # Errors
/// Not the bytes of such a message.
pub fn to_json(name: &str, bytes: &[u8]) -> Option<Result<Value, DecodeError>> {
    decoders()
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, decode)| decode(bytes))
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
