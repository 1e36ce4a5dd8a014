//! Tensor-product B-spline and NURBS surfaces.
//!
//! `S(u, v) = Σ N_i(u) M_j(v) w_ij P_ij / Σ N_i M_j w_ij`, net u-major: point (i, j) is `points[i * s + j]`.
//! The outward normal is `S_u × S_v`, unless the surface says `flip_normal`.

pub mod builtin;
mod closed;
pub mod file;
mod net;
mod normal;
mod refine;
mod samples;
mod tensor;
mod topology;

#[cfg(test)]
pub(crate) mod testing;

pub use builtin::{BuiltinError, builtin};
pub use closed::{DistinctPoints, SAME_POINT};
pub use file::FileError;
pub use net::{ControlNet, NetError};
pub use normal::Curvature;
pub use samples::{GridFit, SampleGrid, Samples};
pub use tensor::{Frame, Surface, SurfaceError};
pub use topology::{Closing, Topology};
