//! Why two bodies were not truncated.

use palpate_geometry::part::PartError;

/// Why two bodies were not truncated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TruncateError {
    /// An open surface.
    #[error(
        "body {body} (counted from 0) is open and bounds no solid: close it, by edges that meet or by poles"
    )]
    Open {
        /// Which one, from 0.
        body: usize,
    },
    /// A surface that encloses nothing.
    #[error(
        "body {body} (counted from 0) encloses no volume: it is flat, turned inside out in parts, or too large to calculate with"
    )]
    NoVolume {
        /// Which one, from 0.
        body: usize,
    },
    /// A surface that crosses itself.
    #[error(
        "body {body} (counted from 0) crosses itself near {at:?} m, so that its inside is not defined: repair it first"
    )]
    SelfCrossing {
        /// Which one, from 0.
        body: usize,
        /// m.
        at: [f64; 3],
    },
    /// A tolerance that is not a length above 0.
    #[error("the tolerance is {0} m; it must be a length above 0, or be left out")]
    Tolerance(f64),
    /// One body is inside the other.
    #[error(
        "body {inner} lies inside body {outer} (counted from 0): their surfaces do not cross, so no wall between them has an \
         edge; to take one from the other they need no truncation"
    )]
    Contained {
        /// Which one, from 0.
        inner: usize,
        /// The other.
        outer: usize,
    },
    /// The surfaces lie on each other.
    #[error(
        "the surfaces lie on each other ({share:.0} % of the places compared are within {within_m:.1e} m), so they do not cross \
         in a curve: move one of the bodies"
    )]
    Coincident {
        /// Places of the first surface on the second, %.
        share: f64,
        /// m.
        within_m: f64,
    },
    /// A curve that does not close.
    #[error(
        "the curve in which the surfaces cross ends near {at:?} m, where they are tangent: move one of the bodies a little"
    )]
    CurveEnds {
        /// m.
        at: [f64; 3],
    },
    /// The surfaces cross, and the curve was not found.
    #[error(
        "body 0 reaches {depth_m:.3e} m into body 1, but no curve was found in which their surfaces cross: move one of the \
         bodies a little"
    )]
    NoCurve {
        /// m.
        depth_m: f64,
    },
    /// A piece of the wall that is neither a disc nor a ring.
    #[error(
        "the wall that begins near {at:?} m has {rims} edges; only discs (one edge) and rings (two) can be fitted: truncate \
         the bodies in parts"
    )]
    Branches {
        /// Curves that bound it.
        rims: usize,
        /// m.
        at: [f64; 3],
    },
    /// The wall could not be followed.
    #[error(
        "the wall that begins near {at:?} m is too intricate to follow: where its curves come closer to each other than 1/500 \
         of their length, move one of the bodies a little"
    )]
    Unclear {
        /// m.
        at: [f64; 3],
    },
    /// What is left does not make a part.
    #[error("body {body} (counted from 0): {source}")]
    Part {
        /// Which one, from 0.
        body: usize,
        /// What is wrong.
        source: PartError,
    },
    /// A closed wall inside, which no curve shows.
    #[error(
        "{wrong} of {compared} places in both bodies are on the wrong side of the wall: where one body is thin inside the other, \
         the wall has a piece that touches no surface, which cannot be cut out"
    )]
    Undivided {
        /// Places on the wrong side.
        wrong: usize,
        /// Places compared.
        compared: usize,
    },
}
