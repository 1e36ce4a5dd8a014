//! The attachment of every message and service call: number, time, sender.

use super::Gid;

/// Who sent a message, when, and as which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Counts the messages of an endpoint from 1.
    pub sequence: i64,
    /// ns since 1970.
    pub source_ns: i64,
    /// The sending endpoint.
    pub gid: Gid,
}

/// Bytes that cannot be read as an attachment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "an attachment has 33 bytes (or 77 with the names of its fields, as Jazzy 0.2.0 to 0.2.3 write it), not {size} \
     like this"
)]
pub struct AttachmentError {
    /// Bytes that it has.
    pub size: usize,
}

/// Names before the fields, each after its length.
const NAMES: [&[u8]; 3] = [
    b"\x0fsequence_number",
    b"\x10source_timestamp",
    b"\x0asource_gid",
];
const GID_BYTES: u8 = 16;

impl Attachment {
    /// Bytes of the bare form.
    pub const SIZE: usize = 33;
    /// Bytes of the form with names.
    pub const NAMED_SIZE: usize = 33 + 16 + 17 + 11;

    /// The bare form, which every release reads.
    pub fn to_bytes(self) -> [u8; Self::SIZE] {
        let mut bytes = [0; Self::SIZE];
        bytes[..8].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.source_ns.to_le_bytes());
        bytes[16] = GID_BYTES;
        bytes[17..].copy_from_slice(&self.gid);
        bytes
    }

    /// Reads either form.
    ///
    /// # Errors
    /// The size fits neither, or the names are others.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, AttachmentError> {
        let wrong = AttachmentError { size: bytes.len() };
        let named = bytes.len() == Self::NAMED_SIZE;
        if !named && bytes.len() != Self::SIZE {
            return Err(wrong);
        }
        let mut left = bytes;
        let mut field = |name: &[u8]| -> Result<[u8; 8], AttachmentError> {
            if named {
                left = left.strip_prefix(name).ok_or(wrong)?;
            }
            let (value, rest) = left.split_first_chunk().ok_or(wrong)?;
            left = rest;
            Ok(*value)
        };
        let sequence = i64::from_le_bytes(field(NAMES[0])?);
        let source_ns = i64::from_le_bytes(field(NAMES[1])?);
        if named {
            left = left.strip_prefix(NAMES[2]).ok_or(wrong)?;
        }
        let gid = match left.split_first() {
            Some((&GID_BYTES, gid)) => gid.try_into().map_err(|_| wrong)?,
            _ => return Err(wrong),
        };
        Ok(Self {
            sequence,
            source_ns,
            gid,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENT: Attachment = Attachment {
        sequence: 258,
        source_ns: 3,
        gid: [7; 16],
    };

    #[test]
    fn an_attachment_of_33_bytes_has_number_time_and_sender() {
        let bytes = SENT.to_bytes();
        assert_eq!(bytes[..3], [2, 1, 0]);
        assert_eq!((bytes[8], bytes[16], bytes[17]), (3, 16, 7));
        assert_eq!(Attachment::from_bytes(&bytes), Ok(SENT));
    }

    #[test]
    fn an_attachment_of_77_bytes_has_names_before_its_fields() {
        let bare = SENT.to_bytes();
        let named = [
            NAMES[0],
            &bare[..8],
            NAMES[1],
            &bare[8..16],
            NAMES[2],
            &bare[16..],
        ]
        .concat();
        assert_eq!(named.len(), 77);
        assert_eq!(Attachment::from_bytes(&named), Ok(SENT));
        let mut other = named;
        other[3] ^= 1;
        assert!(Attachment::from_bytes(&other).is_err());
    }

    #[test]
    fn an_attachment_that_is_missing_or_of_32_bytes_is_none() {
        for size in [0, 16, 32, 34, 76, 78] {
            assert_eq!(
                Attachment::from_bytes(&vec![16; size]),
                Err(AttachmentError { size })
            );
        }
        let mut wrong_gid = SENT.to_bytes();
        wrong_gid[16] = 15;
        assert!(Attachment::from_bytes(&wrong_gid).is_err());
    }
}
