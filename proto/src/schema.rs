//! Layouts of the messages as data, for programs that do not know them.

use crate::layout::MessageType;
use crate::messages::ALL;
use postcard_schema::schema::NamedType;
use serde::Serialize;

pub use postcard_schema::schema::owned::{
    OwnedDataModelType, OwnedDataModelVariant, OwnedNamedType, OwnedNamedValue, OwnedNamedVariant,
};

/// The layout of one message.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MessageSchema {
    /// Versioned name.
    #[serde(rename = "type")]
    pub name: &'static str,
    /// Greatest size of one message, bytes.
    pub max_bytes: usize,
    /// Fields in order, as crate `postcard-schema` 0.2 writes them: `{"name": …, "ty": "U64" |
    /// {"Struct": […]} | …}`.
    pub layout: &'static NamedType,
}

impl From<&MessageType> for MessageSchema {
    fn from(message: &MessageType) -> Self {
        Self {
            name: message.name,
            max_bytes: message.max_bytes,
            layout: message.schema,
        }
    }
}

/// All messages of the bus.
pub fn all() -> impl Iterator<Item = MessageSchema> {
    ALL.iter().map(|message| MessageSchema::from(*message))
}
