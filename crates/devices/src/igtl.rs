//! OpenIGTLink messages: the header, and `TRANSFORM`, which trackers and 3D Slicer exchange poses with.
//!
//! Numbers are big-endian, lengths mm. Source: openigtlink.org, protocols `v2_header`, `v3_header`,
//! `v2_timestamp`, `v2_transform`; the checksum is that of ECMA-182, without reflection.

use crate::frame::v3;

/// The port that servers have.
pub const PORT: u16 = 18_944;
/// Bytes of a header.
pub const HEADER: usize = 58;
const TRANSFORM: &str = "TRANSFORM";
/// Bytes of what a transform says.
const MATRIX: usize = 48;
/// Columns of a rotation are of length 1 and at right angles within this.
const ROTATION: f64 = 1e-3;

/// What a header says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// 1, or 2 with an extended header in the body.
    pub version: u16,
    /// `TRANSFORM`.
    pub kind: String,
    /// Whose it is.
    pub device: String,
    /// When, ns since 1970; 0 when it is not said.
    pub time_ns: u64,
    /// Bytes that follow.
    pub body: u64,
    crc: u64,
}

/// A pose as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPose {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion x y z w.
    pub orientation: [f64; 4],
}

/// Why a message was not taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IgtlError {
    /// Another protocol, or one of the future.
    #[error("version {0} of the header is not known; there are 1 and 2")]
    Version(u16),
    /// Its checksum.
    #[error("a {kind} of {device:?} is damaged: its checksum is wrong")]
    Checksum {
        /// As in the header.
        kind: String,
        /// As in the header.
        device: String,
    },
    /// Fewer bytes than it says.
    #[error("a {0} is cut short")]
    Short(String),
    /// A matrix that is none of a pose.
    #[error("the matrix of {0:?} is not a rotation and a translation")]
    Matrix(String),
}

impl Header {
    /// Reads a header.
    ///
    /// # Errors
    /// A version that is not known.
    pub fn read(bytes: &[u8; HEADER]) -> Result<Self, IgtlError> {
        let number = |at: usize, len: usize| {
            let part = bytes[at..at + len].iter();
            part.fold(0_u64, |value, byte| value << 8 | u64::from(*byte))
        };
        let text = |at: usize, len: usize| {
            let part = &bytes[at..at + len];
            let end = part.iter().position(|byte| *byte == 0).unwrap_or(len);
            String::from_utf8_lossy(&part[..end]).into_owned()
        };
        let version = number(0, 2) as u16;
        if !(1..=2).contains(&version) {
            return Err(IgtlError::Version(version));
        }
        // The fraction counts 2⁻³² s.
        let fraction_ns = (number(38, 4) * 1_000_000_000) >> 32;
        Ok(Self {
            version,
            kind: text(2, 12),
            device: text(14, 20),
            time_ns: number(34, 4) * 1_000_000_000 + fraction_ns,
            body: number(42, 8),
            crc: number(50, 8),
        })
    }

    /// Reads the pose of a `TRANSFORM`; `None` for other messages.
    ///
    /// # Errors
    /// A body that is damaged, short, or no pose.
    pub fn pose(&self, body: &[u8]) -> Result<Option<TrackedPose>, IgtlError> {
        if self.kind != TRANSFORM {
            return Ok(None);
        }
        // Zero: the sender does not compute one.
        if self.crc != 0 && self.crc != crc64(body) {
            return Err(IgtlError::Checksum {
                kind: self.kind.clone(),
                device: self.device.clone(),
            });
        }
        let short = || IgtlError::Short(self.kind.clone());
        let start = match self.version {
            1 => 0,
            _ => match body {
                [high, low, ..] => usize::from(*high) << 8 | usize::from(*low),
                _ => return Err(short()),
            },
        };
        let content = body.get(start..start + MATRIX).ok_or_else(short)?;
        let mut m = [0.0; 12];
        for (value, bytes) in m.iter_mut().zip(content.chunks_exact(4)) {
            *value = f64::from(f32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
        }
        let column = |k: usize| [m[3 * k], m[3 * k + 1], m[3 * k + 2]];
        let wrong = || IgtlError::Matrix(self.device.clone());
        let orientation = rotation([column(0), column(1), column(2)]).ok_or_else(wrong)?;
        let position = column(3).map(|mm| mm * 1e-3);
        if position.iter().any(|x| !x.is_finite()) {
            return Err(wrong());
        }
        Ok(Some(TrackedPose {
            position,
            orientation,
        }))
    }
}

/// A `TRANSFORM` message: m, and a unit quaternion x y z w. Names longer than 20 bytes are cut.
pub fn transform(device: &str, time_ns: u64, position: [f64; 3], orientation: [f64; 4]) -> Vec<u8> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let columns = axes.map(|axis| v3::rotate(orientation, axis));
    let millimetres = position.map(|x| x * 1e3);
    let numbers = columns.iter().flatten().chain(&millimetres);
    let body: Vec<u8> = numbers.flat_map(|x| (*x as f32).to_be_bytes()).collect();
    let mut message = Vec::with_capacity(HEADER + body.len());
    message.extend(1_u16.to_be_bytes());
    put_text(&mut message, TRANSFORM, 12);
    put_text(&mut message, device, 20);
    let seconds = u32::try_from(time_ns / 1_000_000_000).unwrap_or(u32::MAX);
    let fraction = ((time_ns % 1_000_000_000) << 32) / 1_000_000_000;
    message.extend(seconds.to_be_bytes());
    message.extend((fraction as u32).to_be_bytes());
    message.extend((body.len() as u64).to_be_bytes());
    message.extend(crc64(&body).to_be_bytes());
    message.extend(body);
    message
}

fn put_text(message: &mut Vec<u8>, text: &str, room: usize) {
    let bytes = text.as_bytes();
    let count = bytes.len().min(room);
    message.extend(&bytes[..count]);
    message.extend(std::iter::repeat_n(0, room - count));
}

/// The quaternion of a rotation's columns; `None` if they are not of one.
fn rotation(columns: [[f64; 3]; 3]) -> Option<[f64; 4]> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z] = columns;
    for (a, b, wanted) in [
        (x, x, 1.0),
        (y, y, 1.0),
        (z, z, 1.0),
        (x, y, 0.0),
        (y, z, 0.0),
        (z, x, 0.0),
    ] {
        let off = (dot(a, b) - wanted).abs();
        if off.is_nan() || off > ROTATION {
            return None;
        }
    }
    let third = [
        x[1] * y[2] - x[2] * y[1],
        x[2] * y[0] - x[0] * y[2],
        x[0] * y[1] - x[1] * y[0],
    ];
    if dot(third, z) < 0.0 {
        return None;
    }
    // Shepperd: of the four ways the one that divides by the largest number.
    let trace = x[0] + y[1] + z[2];
    let squares = [x[0], y[1], z[2], trace];
    let largest = (1..4).fold(
        0,
        |best, k| if squares[k] > squares[best] { k } else { best },
    );
    let q = match largest {
        3 => [y[2] - z[1], z[0] - x[2], x[1] - y[0], 1.0 + trace],
        0 => [
            1.0 + x[0] - y[1] - z[2],
            y[0] + x[1],
            z[0] + x[2],
            y[2] - z[1],
        ],
        1 => [
            y[0] + x[1],
            1.0 - x[0] + y[1] - z[2],
            z[1] + y[2],
            z[0] - x[2],
        ],
        _ => [
            z[0] + x[2],
            z[1] + y[2],
            1.0 - x[0] - y[1] + z[2],
            x[1] - y[0],
        ],
    };
    v3::unit(q)
}

fn crc64(bytes: &[u8]) -> u64 {
    const POLYNOMIAL: u64 = 0x42f0_e1eb_a9ea_3693;
    bytes.iter().fold(0, |crc, byte| {
        let mut crc = crc ^ u64::from(*byte) << 56;
        for _ in 0..8 {
            crc = crc << 1 ^ if crc >> 63 == 1 { POLYNOMIAL } else { 0 };
        }
        crc
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(message: &[u8]) -> (Header, &[u8]) {
        let (head, body) = message.split_first_chunk::<HEADER>().unwrap();
        (Header::read(head).unwrap(), body)
    }

    #[test]
    fn the_checksum_is_that_of_ecma_182() {
        assert_eq!(crc64(b"123456789"), 0x6c40_df5f_0b49_7347);
    }

    #[test]
    fn a_pose_comes_back_in_every_orientation() {
        for k in 0..200 {
            let a = f64::from(k);
            let q = v3::unit([a.sin(), (2.0 * a).cos(), (0.7 * a).sin(), (1.3 * a).cos()]).unwrap();
            let position = [0.0123 * a.cos(), -0.5, 0.25];
            let message = transform("ball", 1_700_000_000_250_000_000, position, q);
            let (header, body) = parts(&message);
            assert_eq!(
                (header.kind.as_str(), header.device.as_str()),
                ("TRANSFORM", "ball")
            );
            assert_eq!(header.time_ns, 1_700_000_000_250_000_000);
            assert_eq!(header.body, body.len() as u64);
            let pose = header.pose(body).unwrap().unwrap();
            for c in 0..3 {
                assert!((pose.position[c] - position[c]).abs() < 1e-7);
            }
            let same = (0..4).map(|c| pose.orientation[c] * q[c]).sum::<f64>();
            assert!(
                (same.abs() - 1.0).abs() < 1e-6,
                "{q:?} {:?}",
                pose.orientation
            );
        }
    }

    #[test]
    fn damaged_short_and_crooked_messages_are_named() {
        let good = transform("ball", 0, [0.0; 3], [0.0, 0.0, 0.0, 1.0]);
        let (header, body) = parts(&good);
        let mut changed = body.to_vec();
        changed[40] ^= 1;
        assert!(matches!(
            header.pose(&changed),
            Err(IgtlError::Checksum { .. })
        ));
        let unchecked = Header {
            crc: 0,
            ..header.clone()
        };
        assert!(matches!(
            unchecked.pose(&body[..20]),
            Err(IgtlError::Short(_))
        ));
        for (at, value) in [(0, 1.1_f32), (0, f32::NAN), (4, 0.1), (44, f32::INFINITY)] {
            let mut crooked = body.to_vec();
            crooked[at..at + 4].copy_from_slice(&value.to_be_bytes());
            assert!(
                matches!(unchecked.pose(&crooked), Err(IgtlError::Matrix(_))),
                "{at} {value}"
            );
        }
        // A reflection is not a rotation.
        let mut mirror = body.to_vec();
        mirror[0..4].copy_from_slice(&(-1.0_f32).to_be_bytes());
        assert!(unchecked.pose(&mirror).is_err());
        let status = Header {
            kind: "STATUS".into(),
            ..header
        };
        assert_eq!(status.pose(&[]), Ok(None));
        let mut future = [0; HEADER];
        future[1] = 9;
        assert_eq!(Header::read(&future), Err(IgtlError::Version(9)));
    }

    #[test]
    fn an_extended_header_is_stepped_over() {
        let good = transform("ball", 0, [0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 1.0]);
        let (header, body) = parts(&good);
        let extended = [&[0, 12, 0, 2, 0, 0, 0, 0, 0, 0, 0, 7][..], body, &[0, 0]].concat();
        let header = Header {
            version: 2,
            crc: 0,
            ..header
        };
        let pose = header.pose(&extended).unwrap().unwrap();
        assert!((pose.position[2] - 0.3).abs() < 1e-7);
        for cut in 0..60 {
            assert!(header.pose(&extended[..cut]).is_err(), "{cut}");
        }
    }
}
