//! ROS 2 as rmw_zenoh speaks it: types, keys, attachments, the graph.
//!
//! Sources: `ros2/rmw_zenoh`, `docs/design.md` and `rmw_zenoh_cpp/src/detail`
//! (`liveliness_utils.cpp`, `attachment_helpers.cpp`).

mod attachment;
mod bag;
mod graph;
mod markers;
mod messages;
mod preset;
mod types;

pub use attachment::{Attachment, AttachmentError};
pub use bag::schema_text;
pub use graph::{
    Endpoint, Gid, Kind, Node, Qos, gid_of, node_token, topic_key, topic_subscription,
};
pub use markers::NetLines;
pub use messages::*;
pub use preset::{ButtonKind, ForceKind, Preset, PresetSettings};
pub use types::{RosType, TYPES};
