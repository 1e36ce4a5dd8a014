//! Why a message is refused.

/// Why bytes were refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Another type or version.
    #[error("the encoding's schema is {got:?}, not {expected:?}")]
    WrongSchema {
        /// The schema of the type that was asked for.
        expected: String,
        /// The schema that the sender gave.
        got: String,
    },
    /// Too long.
    #[error("{bytes} bytes are more than any {name} has ({most})")]
    Oversized {
        /// Type name.
        name: &'static str,
        /// How many.
        bytes: usize,
        /// Most that it has.
        most: usize,
    },
    /// Not the bytes of this type.
    #[error("not the bytes of a {name}: {reason}")]
    Malformed {
        /// Type name.
        name: &'static str,
        /// postcard's words.
        reason: String,
    },
    /// Bytes after the end.
    #[error("{extra} bytes after the end of a {name}")]
    Trailing {
        /// Type name.
        name: &'static str,
        /// How many.
        extra: usize,
    },
}

/// Why a pose was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// NaN or infinity.
    #[error("pose {seq} has a value that is not finite")]
    NotFinite {
        /// Its number.
        seq: u64,
    },
    /// Not a rotation.
    #[error("pose {seq} has a quaternion of length {norm}; it must be 1 within 1e-6")]
    Quaternion {
        /// Its number.
        seq: u64,
        /// Its length.
        norm: f64,
    },
}
