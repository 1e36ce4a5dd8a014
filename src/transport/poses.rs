//! Poses as they come in: checked, counted by cause, handed to the loop.
//!
//! Runs on receive threads. Of each cause only the first is logged: a flood of bad poses must not
//! become a flood of lines.

use super::declared::schema_of;
use palpate_drive::ports::{LinkCounters, Offered, PoseInbox, SenderId};
use palpate_proto::codec::{DecodeError, PoseError, check_head, decode};
use palpate_proto::messages::ToolPose;
use palpate_wire as wire;
use zenoh::bytes::{Encoding, ZBytes};

/// Decodes, checks, stores. What is too long is not even copied. True if the loop gets it.
pub(super) fn take_pose(
    inbox: &PoseInbox,
    payload: &ZBytes,
    encoding: &Encoding,
    sender: SenderId,
) -> bool {
    let schema = schema_of(encoding);
    let read = check_head::<ToolPose>(payload.len(), &schema)
        .and_then(|()| decode(&payload.to_bytes(), &schema));
    take(inbox, read, sender)
}

/// Who sent a sample.
pub(super) fn sender_of(attachment: Option<&ZBytes>) -> SenderId {
    SenderId::of(attachment.map(ZBytes::to_bytes).as_deref())
}

fn take(inbox: &PoseInbox, read: Result<ToolPose, DecodeError>, sender: SenderId) -> bool {
    let counters = &inbox.counters;
    let pose = match read {
        Ok(pose) => pose,
        Err(error) => {
            let counter = match error {
                DecodeError::WrongSchema { .. } => &counters.wrong_version,
                DecodeError::Oversized { .. } => &counters.oversized,
                DecodeError::Malformed { .. } | DecodeError::Trailing { .. } => &counters.malformed,
            };
            if LinkCounters::count(counter) {
                tracing::warn!(%error, "a pose was dropped; later ones like it are only counted");
            }
            return false;
        }
    };
    match pose.validated() {
        Err(error) => {
            let counter = match error {
                PoseError::NotFinite { .. } => &counters.not_finite,
                PoseError::Quaternion { .. } => &counters.bad_quaternion,
            };
            if LinkCounters::count(counter) {
                tracing::warn!(%error, "a pose was dropped; later ones like it are only counted");
            }
            false
        }
        Ok(pose) => offer(inbox, &pose, sender),
    }
}

fn offer(inbox: &PoseInbox, pose: &ToolPose, sender: SenderId) -> bool {
    let offered = inbox.offer(wire::device_pose(pose), sender);
    match offered {
        Offered::Stranger { first: true } => {
            tracing::warn!(
                "a pose of a client that does not hold its tool was dropped; later ones are only counted"
            );
        }
        Offered::OutOfOrder { first: true } => {
            tracing::warn!(
                seq = pose.seq,
                "a pose was older than the newest; later ones are only counted"
            );
        }
        // In lockstep that is how a client asks for a lost force.
        Offered::Duplicate { first: true } => {
            tracing::debug!(seq = pose.seq, "a pose came twice")
        }
        Offered::Taken
        | Offered::Duplicate { .. }
        | Offered::OutOfOrder { .. }
        | Offered::Stranger { .. } => {}
    }
    offered == Offered::Taken
}
