//! Tensor-product B-spline and NURBS surfaces.
//!
//! `S(u, v) = Σ N_i(u) M_j(v) w_ij P_ij / Σ N_i M_j w_ij`, net u-major: point (i, j) is `points[i * s + j]`.
//! The outward normal is `S_u × S_v`, unless the surface says `flip_normal`.

mod bezier;
pub mod builtin;
mod closed;
mod closest;
pub mod file;
mod net;
mod refine;
mod tensor;
mod topology;

#[cfg(test)]
pub(crate) mod testing;

pub use bezier::{BezierPieces, Bounds};
pub use builtin::{BuiltinError, builtin};
pub use closed::{DistinctPoints, SAME_POINT};
pub use closest::{ClosestPoint, ClosestSolver, WarmFoot};
pub use file::FileError;
pub use net::{ControlNet, NetError};
pub use tensor::{Frame, Surface, SurfaceError};
pub use topology::{Closing, Topology};
