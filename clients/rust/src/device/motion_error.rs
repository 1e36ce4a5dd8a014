//! Why a motion is refused.

/// Names of motions.
pub(super) const NAMES: &str = "press, slide, tap, circle, pull, tremor, hold";

/// Why a motion was refused: what, where, and what would do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// Not a motion we know.
    #[error(
        "{0:?} is not a known motion; use one of {NAMES}, or a TOML file with [[waypoint]] or [[step]] entries"
    )]
    Unknown(String),
    /// The scene has nothing to touch.
    #[error("the scene has no body to aim tool {0:?} at")]
    NoBody(String),
    /// Not such TOML.
    #[error("{origin}: {reason}")]
    Toml {
        /// The file.
        origin: String,
        /// What the parser found, with line and column.
        reason: String,
    },
    /// Neither way-points nor steps, or both.
    #[error("{origin}: a motion needs [[waypoint]] entries or [[step]] entries, and not both")]
    Kind {
        /// The file.
        origin: String,
    },
    /// An entry that cannot be done.
    #[error("{origin}: {entry} {index}: {field} is {value}; {expected} is needed")]
    Entry {
        /// The file.
        origin: String,
        /// `waypoint` or `step`.
        entry: &'static str,
        /// Counted from 1.
        index: usize,
        /// Name of the field.
        field: &'static str,
        /// As given.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
}
