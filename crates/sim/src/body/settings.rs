//! How a body steps, and why one cannot be built.

use super::elements::continuum::ContinuumError;
use palpate_geometry::math::CholeskyError;

/// How a body steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// dt of the body, s.
    pub dt_s: f64,
    /// Which method.
    pub integrator: Integrator,
    /// A body in which no coordinate is faster, m/s, and which nothing touches, falls asleep; 0
    /// keeps it awake.
    pub sleep_m_s: f64,
}

/// Time integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Backward Euler from the inertial prediction by a constant matrix, with this many iterations (≥ 1) a step.
    Implicit {
        /// Quasi-Newton iterations.
        iterations: usize,
        /// Their matrix.
        matrix: StepMatrix,
    },
    /// Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as stability needs, or
    /// more.
    Explicit {
        /// At least so many.
        substeps: usize,
    },
    /// Extended position-based dynamics (Macklin et al. 2019, small steps).
    Xpbd {
        /// Substeps, one iteration each.
        substeps: usize,
    },
}

/// The constant matrix of an implicit step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepMatrix {
    /// The tangent where it fits, else the bounding matrix.
    #[default]
    Auto,
    /// The tangent of rest, turned with the body: motion is right after one iteration. Bodies that
    /// have none take the bounding matrix.
    Tangent,
    /// A scalar matrix above every tangent: a third of the memory, and motion that is too slow.
    Bounding,
}

/// What a step does instead of what its settings say, where its own matrix cannot follow the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FallBack {
    /// It takes a matrix that is firmer against turning than the tangent of rest.
    Firmer,
    /// It takes the bounding matrix: its motion is too slow.
    Bounding,
    /// Half of a correction was taken back, since the next one grew.
    Halved,
    /// It was shortened: cells would have strained more in a tick than a step can follow.
    Shortened,
}

/// Why a body could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeformableError {
    /// A cell without volume.
    #[error("{count} of {total} cells have no volume; the surface is too thin there or folded")]
    FlatCells {
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
    },
    /// Every coordinate is fixed.
    #[error(
        "all {0} nodes are fixed: nothing can deform; use model = \"rigid\" or fix fewer nodes"
    )]
    AllFixed(usize),
    /// A coordinate without mass.
    #[error("{0} nodes have no mass; the surface is too thin there or folded")]
    NoMass(usize),
    /// The matrix of the step could not be factored.
    #[error("the matrix of the implicit step has no factor: {0}")]
    Factor(#[from] CholeskyError),
    /// The factor of the matrix is larger than any machine has room for.
    #[error("the matrix of the implicit step is too large; use fewer nodes, or model = \"net\"")]
    TooLarge,
    /// Stability needs more substeps than anyone waits for.
    #[error(
        "the explicit step needs {needed} substeps a tick, more than {most}; use integrator = \"implicit\""
    )]
    Substeps {
        /// Required number.
        needed: usize,
        /// Largest allowed number.
        most: usize,
    },
    /// Cells that cannot carry a continuum energy.
    #[error(transparent)]
    ContinuumLaw(#[from] ContinuumError),
    /// A combination that is not there.
    #[error("{0}")]
    Unsupported(&'static str),
}
