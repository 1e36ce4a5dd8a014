//! Names for nalgebra's types, small dense and sparse linear algebra, and the state hash. Imports
//! nothing of ours.

use nalgebra as na;

/// Displacement, velocity, force, normal: three components, SI.
pub type Vector3 = na::Vector3<f64>;
/// A place, m.
pub type Point3 = na::Point3<f64>;
/// Unit quaternion.
pub type Rotation = na::UnitQuaternion<f64>;
/// Rigid placement: rotation then translation, m.
pub type Pose = na::Isometry3<f64>;
/// 3 × 3 matrix.
pub type Matrix3 = na::Matrix3<f64>;

mod aligned;
mod block_cholesky;
mod cholesky;
mod dissection;
mod eigen;
mod eight;
#[doc(hidden)]
pub mod lanes;
mod ordering;
mod quadrature;
mod random;
mod range;
pub mod simd;
mod state;
mod turn;
mod walk;

pub use aligned::Rows;
pub use block_cholesky::{BlockCholesky, BlockTriplets, BlockWork};
pub use cholesky::{Cholesky, CholeskyError, Lane, SingleCholesky, SingleLane, SymmetricTriplets};
pub use eigen::symmetric_eigen;
pub use quadrature::gauss_legendre;
pub use random::Random;
pub use range::{MOST_COORDINATE_M, direction_of, first_outside};
pub use state::{
    SavedState, StateError, StateSink, StateSize, StateSource, Stateful, state_hash, state_size,
};
pub use turn::{rotation_by, rotation_onto, turn_between};
pub use walk::{Coded, Restorer, Saver, Triple};
