//! Tensor-product B-spline and NURBS surfaces.
//!
//! `S(u, v) = Σ N_i(u) M_j(v) w_ij P_ij / Σ N_i M_j w_ij`, net u-major: point (i, j) is `points[i *
//! s + j]`. The outward normal is `S_u × S_v`, unless the surface says `flip_normal`. Parameters
//! are confined to the domain; [`KnotVector::checked`](crate::basis::KnotVector::checked) refuses
//! those outside.
//!
//! ```
//! use palpate_geometry::surface::builtin;
//!
//! let drop = builtin("teardrop", None, None)?;
//! let fine = drop.refined_to(22, 23)?;
//! assert!((fine.point(0.3, 0.6) - drop.point(0.3, 0.6)).norm() < 1e-15);
//! assert!(fine.topology().is_closed() && fine.volume() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod bezier;
pub mod builtin;
mod closed;
pub(crate) mod closest;
mod cloud_fit;
mod curve;
pub mod file;
mod grid_fit;
pub(crate) mod joints;
mod lines;
mod load;
mod measure;
mod mesh;
mod net;
mod normal;
mod parts;
mod refine;
mod samples;
mod shell;
mod shell_fit;
mod simplify;
mod sphere_map;
mod tensor;
mod tessellate;
mod topology;
mod trim;

#[cfg(test)]
pub(crate) mod testing;

pub(crate) use bezier::extraction;
pub use bezier::{BezierPieces, Bounds};
pub use builtin::{BuiltinError, builtin};
pub use closed::{DistinctPoints, SAME_POINT};
pub(crate) use closest::{Basin, Clip};
pub use closest::{ClosestPoint, ClosestSolver, Summit, WarmFoot};
pub use cloud_fit::CloudSpec;
pub use curve::{Curve, CurveError};
pub use file::FileError;
pub(crate) use grid_fit::LineFit;
pub use grid_fit::{FitError, Fitted, GridSpec};
pub use joints::{Joints, Patch};
pub use lines::Direction;
pub use load::{Loaded, MergedKnots, Slit, SlitPlace};
pub use mesh::Mesh;
pub use net::{ControlNet, NetError};
pub use normal::Curvature;
pub use samples::{GridFit, SampleGrid, Samples};
pub use shell::{Census, Shell};
pub use shell_fit::Apart;
pub use simplify::Simplified;
pub(crate) use tensor::wrap;
pub use tensor::{Frame, MOST_WEIGHTS, Surface, SurfaceError, WEIGHTS};
pub use tessellate::TessellateError;
pub use topology::{Closing, Topology};
pub use trim::{Trim, TrimError};
