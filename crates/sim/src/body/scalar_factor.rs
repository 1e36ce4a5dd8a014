//! The factor of a scalar matrix of a step: in double precision, or, of a large body, in single.

use palpate_geometry::math::{
    Cholesky, CholeskyError, Lane, Point3, Rows, SingleCholesky, SingleLane, SymmetricTriplets,
    Vector3,
};

/// Unknowns from which a factor is kept in single precision: it is then beyond the caches, and a solve
/// waits for memory.
const LARGE: usize = 2_500;

/// A factor.
#[derive(Debug)]
pub(super) enum ScalarFactor {
    Double(Cholesky),
    Single(SingleCholesky),
}

/// Right-hand sides of a solve; the lanes of a factor that is kept otherwise are empty.
#[derive(Clone, Debug, Default)]
pub(super) struct ScalarWork {
    double: Rows,
    single: Vec<SingleLane>,
}

impl ScalarFactor {
    /// The factor of a matrix whose unknowns are at `places`.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub(super) fn new(
        matrix: &SymmetricTriplets,
        places: &[Point3],
    ) -> Result<Self, CholeskyError> {
        Cholesky::placed(matrix, places).map(Self::Double)
    }

    /// That of a large body in single precision from here on.
    pub(super) fn round(&mut self) {
        if let Self::Double(factor) = self
            && factor.n() >= LARGE
        {
            *self = Self::Single(factor.single());
        }
    }

    /// Numbers in the factor.
    pub(super) fn non_zeros(&self) -> usize {
        match self {
            Self::Double(factor) => factor.non_zeros(),
            Self::Single(factor) => factor.non_zeros(),
        }
    }

    /// Buffers for [`ScalarFactor::solve`].
    pub(super) fn work(&self, n: usize) -> ScalarWork {
        match self {
            Self::Double(_) => ScalarWork {
                double: Rows::zeros(n),
                single: Vec::new(),
            },
            Self::Single(_) => ScalarWork {
                double: Rows::zeros(0),
                single: vec![[0.0; 4]; n],
            },
        }
    }

    /// Solves in place.
    pub(super) fn solve(&self, rhs: &mut [Vector3], work: &mut ScalarWork) {
        match self {
            Self::Double(factor) => {
                let lanes: &mut [Lane] = &mut work.double;
                factor.solve(rhs, lanes);
            }
            Self::Single(factor) => factor.solve(rhs, &mut work.single),
        }
    }
}
