//! Bytes of messages: postcard, with the type's versioned name in the encoding's schema.

pub use crate::decode_error::{DecodeError, PoseError};
pub use crate::layout::MAX_BYTES;
use crate::layout::Message;
use serde_json::Value;

/// Schema string of the encoding that goes with a message: `postcard;palpate.ToolPose.v1`.
pub fn encoding_schema<M: Message>() -> String {
    format!("postcard;{}", M::NAME)
}

/// Bytes of a message.
pub fn encode<M: Message>(message: &M) -> Vec<u8> {
    postcard::to_allocvec(message).expect("messages hold only what postcard can write")
}

/// What can be checked without reading the bytes: whether an `M` may have so many, under this schema
/// (empty: none).
///
/// # Errors
/// Another schema, or too many bytes.
pub fn check_head<M: Message>(bytes: usize, schema: &str) -> Result<(), DecodeError> {
    if !schema.is_empty() && schema.strip_prefix("postcard;") != Some(M::NAME) {
        // A schema may be as long as its sender likes; a report of it is not.
        let got = schema.chars().take(128).collect();
        return Err(DecodeError::WrongSchema {
            expected: encoding_schema::<M>(),
            got,
        });
    }
    if bytes > M::MAX_BYTES {
        return Err(DecodeError::Oversized {
            name: M::NAME,
            bytes,
            most: M::MAX_BYTES,
        });
    }
    Ok(())
}

/// Reads a message. `schema` is that of the sample's encoding; an empty one is not checked.
///
/// # Errors
/// Another schema, too many bytes, or not the bytes of an `M`.
pub fn decode<M: Message>(bytes: &[u8], schema: &str) -> Result<M, DecodeError> {
    check_head::<M>(bytes.len(), schema)?;
    match postcard::take_from_bytes(bytes) {
        Ok((message, [])) => Ok(message),
        Ok((_, rest)) => Err(DecodeError::Trailing {
            name: M::NAME,
            extra: rest.len(),
        }),
        Err(reason) => Err(DecodeError::Malformed {
            name: M::NAME,
            reason: reason.to_string(),
        }),
    }
}

/// A message as JSON.
pub(crate) fn decode_to_json<M: Message>(bytes: &[u8]) -> Result<Value, DecodeError> {
    let message: M = decode(bytes, "")?;
    // Numbers that JSON does not have become null.
    Ok(serde_json::to_value(message).unwrap_or(Value::Null))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::{
        ContactSet, ControlNet, DeviceInfo, LoopStatus, SceneSnapshot, SimEvent, ToolContact,
        ToolForce, ToolPose,
    };

    fn pose() -> ToolPose {
        ToolPose {
            seq: 300,
            t_client_ns: 1_000_000_007,
            position: [0.1, -0.2, 0.3],
            orientation: [0.0, 0.0, 0.6, 0.8],
            linear_velocity: [0.0, -0.0, 1.5],
            angular_velocity: [0.0; 3],
            buttons: 1,
            flags: 0,
        }
    }

    #[test]
    fn a_message_comes_back_bit_for_bit() {
        let bytes = encode(&pose());
        let back: ToolPose = decode(&bytes, "postcard;palpate.ToolPose.v1").unwrap();
        assert_eq!(back, pose());
        assert_eq!(back.linear_velocity[1].to_bits(), (-0.0f64).to_bits());
    }

    #[test]
    fn other_types_versions_lengths_and_tails_are_refused_by_name() {
        let bytes = encode(&pose());
        assert!(matches!(
            decode::<ToolPose>(&bytes, "postcard;palpate.ToolPose.v2"),
            Err(DecodeError::WrongSchema { .. })
        ));
        assert!(matches!(
            decode::<ToolPose>(&bytes[..50], ""),
            Err(DecodeError::Malformed { .. })
        ));
        let mut long = bytes.clone();
        long.push(0);
        assert!(matches!(
            decode::<ToolPose>(&[0; 200], ""),
            Err(DecodeError::Oversized {
                bytes: 200,
                most: 134,
                ..
            })
        ));
        assert!(matches!(
            decode::<ToolPose>(&long, ""),
            Err(DecodeError::Trailing { extra: 1, .. })
        ));
        assert!(matches!(
            decode::<ControlNet>(&vec![0; MAX_BYTES + 1], ""),
            Err(DecodeError::Oversized { .. })
        ));
    }

    #[test]
    fn the_largest_pose_and_device_are_as_large_as_they_say() {
        let pose = ToolPose {
            seq: u64::MAX,
            t_client_ns: u64::MAX,
            buttons: u32::MAX,
            flags: u32::MAX,
            ..pose()
        };
        assert_eq!(encode(&pose).len(), ToolPose::MAX_BYTES);
        assert_eq!(decode::<ToolPose>(&encode(&pose), "").unwrap(), pose);
        let device = DeviceInfo {
            name: "x".repeat(64),
            dof_force: 3,
            dof_torque: 3,
            workspace: [1.0; 3],
            force_max: 1.0,
            force_continuous: 1.0,
            torque_max: 1.0,
            mass: 1.0,
            damping: 1.0,
            coulomb_friction: 1.0,
            encoder_resolution: 0.1,
            rate_hz: 1.0,
            delay_s: 1.0,
            deadband: 0.5,
        };
        // A count may be written with leading zeros: nine bytes more.
        assert_eq!(encode(&device).len() + 9, DeviceInfo::MAX_BYTES);
    }

    #[test]
    fn random_truncated_and_flipped_bytes_never_panic() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as usize
        };
        let good = encode(&pose());
        let mut accepted = 0;
        for _ in 0..20_000 {
            let mut bytes = if random() % 2 == 0 {
                good.clone()
            } else {
                (0..random() % 200).map(|_| random() as u8).collect()
            };
            if !bytes.is_empty() {
                let at = random() % bytes.len();
                bytes[at] ^= 1 << (random() % 8);
                bytes.truncate(bytes.len() - random() % 2);
            }
            accepted += usize::from(
                decode::<ToolPose>(&bytes, "").is_ok_and(|pose| pose.validated().is_ok()),
            );
            let _ = decode::<ToolForce>(&bytes, "");
            let _ = decode::<ToolContact>(&bytes, "");
            let _ = decode::<DeviceInfo>(&bytes, "").map(DeviceInfo::validated);
            let _ = decode::<ControlNet>(&bytes, "");
            let _ = decode::<ContactSet>(&bytes, "");
            let _ = decode::<LoopStatus>(&bytes, "");
            let _ = decode::<SimEvent>(&bytes, "");
            let _ = decode::<SceneSnapshot>(&bytes, "");
        }
        assert!(
            accepted > 0,
            "a flipped low bit of a position is still a pose"
        );
    }

    #[test]
    fn poses_that_no_rigid_body_can_have_are_refused() {
        assert!(pose().validated().is_ok());
        let bent = ToolPose {
            orientation: [0.0, 0.0, 0.6, 0.9],
            ..pose()
        };
        assert!(matches!(
            bent.validated(),
            Err(PoseError::Quaternion { seq: 300, .. })
        ));
        let lost = ToolPose {
            position: [0.0, f64::NAN, 0.0],
            ..pose()
        };
        assert!(matches!(
            lost.validated(),
            Err(PoseError::NotFinite { seq: 300 })
        ));
        let nearly = ToolPose {
            orientation: [0.0, 0.0, 0.6, 0.8 + 1e-8],
            ..pose()
        };
        let unit = nearly.validated().unwrap().orientation;
        assert!((unit.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
