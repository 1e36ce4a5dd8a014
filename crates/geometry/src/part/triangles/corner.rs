//! What triangles have for corners, and why there are none.

/// What a corner is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Id {
    Vertex(u32),
    /// Edge, and which of its points.
    Edge(u32, u32),
    /// Of one face alone.
    Pole(u32),
    /// Of one face alone.
    Inner(u32),
}

/// Why a part was not divided into triangles.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrianglesError {
    /// Not a length.
    #[error("a tolerance of {0} m cannot be kept: it must be finite and above 0")]
    Tolerance(f64),
    /// Too fine.
    #[error("that takes more than {most} triangles: raise the tolerance")]
    TooMany {
        /// As allowed.
        most: usize,
    },
    /// A face that goes on without end.
    #[error("face #{face} has no bounds")]
    Unbounded {
        /// In the file.
        face: u64,
    },
    /// A face whose edges cross each other or do not close.
    #[error("the edges of face #{face} cross each other or do not close within its surface")]
    Loops {
        /// In the file.
        face: u64,
    },
    /// Too large to calculate with.
    #[error("coordinates leave the range of lengths")]
    Range,
}
