//! Pipe surfaces: the largest radius without self-intersection, and the pipe as a surface.
//!
//! Patrikalakis & Maekawa, *Shape Interrogation for Computer Aided Design and Manufacturing*,
//! section 11.6: the pipe of radius r around a spine c(t) intersects itself nowhere if and only if
//! r < min(1 / κ_max, r_bb, r_ee, r_eb) (theorem 11.6.1).
//!
//! ```text
//! file ─▶ Curve ─▶ Spine: Bézier pieces, checked ─▶ forms: N, K, G as intervals
//!                    ├─ curvature ─▶ r_local = 1 / κ_max
//!                    ├─ adjacent, body ─▶ r_bb, all stationary pairs         (ipp: two variables)
//!                    └─ ends ─▶ r_ee, r_eb                                   (ipp: one variable)
//!                  Limits: r_max and what limits it; is_free(r)
//!         Curve, r ─▶ sweep: sections with a rotation-minimising frame ─▶ Surface
//! ```
//! The pipe is open: its end discs are not part of it. What cannot be decided in double precision is a
//! status, see [`Status`](crate::ipp::Status).

mod adjacent;
mod body;
pub mod cases;
mod curvature;
mod ends;
mod error;
pub mod file;
mod forms;
mod frame;
mod limits;
pub mod oracle;
mod piece;
mod spine;
mod sweep;

#[cfg(test)]
mod hard_tests;
#[cfg(test)]
mod random_tests;
#[cfg(test)]
mod testing;

pub use body::{BodyToBody, PairKind, StationaryPair, Unresolved, body_to_body};
pub use curvature::{LocalCurvature, LocalKind, LocalWitness, largest_curvature};
pub use ends::{EndToBody, EndToEnd, EndsToBody, end_to_end, ends_to_body};
pub use error::PipeError;
pub use limits::{Answer, Limit, PipeLimits};
pub use spine::{CORNER_RAD, Corner, MOST_PIECES, Spine};
pub use sweep::{MOST_STRETCHES, PipeSurface, SweepError, pipe_surface};
