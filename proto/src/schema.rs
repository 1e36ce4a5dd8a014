//! Layouts of the messages as data, for programs that do not know them.

use crate::codec::encoding_schema;
use crate::messages::{
    ContactSet, ControlNet, DeviceInfo, LoopStatus, Message, SceneSnapshot, SimEvent, ToolContact,
    ToolForce, ToolPose,
};
use postcard_schema::Schema;
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
    /// Most bytes that one has.
    pub max_bytes: usize,
    /// Fields in order, as crate `postcard-schema` 0.2 writes them: `{"name": …, "ty": "U64" |
    /// {"Struct": […]} | …}`.
    pub layout: &'static NamedType,
}

impl MessageSchema {
    fn of<M: Message + Schema>() -> Self {
        Self {
            name: M::NAME,
            max_bytes: M::MAX_BYTES,
            layout: M::SCHEMA,
        }
    }

    /// What the encoding of such a message carries.
    pub fn encoding_schema(&self) -> String {
        format!("postcard;{}", self.name)
    }
}

/// All messages of the bus.
pub fn all() -> [MessageSchema; 9] {
    debug_assert_eq!(
        encoding_schema::<ToolPose>(),
        MessageSchema::of::<ToolPose>().encoding_schema()
    );
    [
        MessageSchema::of::<ToolPose>(),
        MessageSchema::of::<ToolForce>(),
        MessageSchema::of::<ToolContact>(),
        MessageSchema::of::<DeviceInfo>(),
        MessageSchema::of::<ControlNet>(),
        MessageSchema::of::<ContactSet>(),
        MessageSchema::of::<LoopStatus>(),
        MessageSchema::of::<SimEvent>(),
        MessageSchema::of::<SceneSnapshot>(),
    ]
}
