//! The step of a body: one of three methods.

use super::core::SurfaceBlocks;
use super::explicit::Explicit;
use super::implicit::ImplicitStep;
use super::matter::Matter;
use super::scratch::DeformableScratch;
use super::settings::{DeformableError, Integrator};
use super::state::DeformableState;
use super::xpbd::Xpbd;
use palpate_geometry::math::Vector3;

/// Constants of a body's method.
#[derive(Debug)]
pub(super) enum Stepper {
    Implicit(ImplicitStep),
    Explicit(Explicit),
    Xpbd(Xpbd),
}

impl Stepper {
    /// The method that the body's settings name.
    ///
    /// # Errors
    /// A matrix without factor, or a combination that is not there.
    pub fn new(matter: &Matter) -> Result<Self, DeformableError> {
        Ok(match matter.settings.integrator {
            Integrator::Implicit { iterations, matrix } => {
                Self::Implicit(ImplicitStep::new(matter, iterations, matrix)?)
            }
            Integrator::Explicit { substeps } => Self::Explicit(Explicit::new(matter, substeps)?),
            Integrator::Xpbd { substeps } => Self::Xpbd(Xpbd::new(matter, substeps)?),
        })
    }

    /// A step of a method without matrix, with the forces of the scratch, into its `predicted` and
    /// `speed`.
    pub fn run(&self, matter: &Matter, state: &DeformableState, scratch: &mut DeformableScratch) {
        match self {
            Self::Implicit(_) => {}
            Self::Explicit(explicit) => explicit.run(matter, state, scratch),
            Self::Xpbd(xpbd) => xpbd.run(matter, state, scratch),
        }
    }

    /// How forces on the net move a body whose step has no matrix; nothing of others.
    pub fn by_trial(&self, matter: &Matter) -> SurfaceBlocks {
        match self {
            Self::Implicit(_) => SurfaceBlocks::default(),
            Self::Explicit(_) | Self::Xpbd(_) => {
                SurfaceBlocks::of_scalars(matter, &self.columns_by_trial(matter, &matter.surface))
            }
        }
    }

    /// (surface × unknowns), m/N: what small forces do to the body at rest.
    fn columns_by_trial(&self, matter: &Matter, surface: &[u32]) -> Vec<f64> {
        let (n, state, mut scratch) = (
            matter.unknown_count(),
            matter.rest_state(),
            matter.scratch(),
        );
        self.run(matter, &state, &mut scratch);
        let free = scratch.predicted.clone();
        let size = matter
            .rest
            .iter()
            .map(|p| (p - matter.rest[0]).norm())
            .fold(0.0, f64::max);
        let mut columns = Vec::with_capacity(surface.len() * n);
        for &coordinate in surface {
            // Along z, which is as good as any; far above rounding and far below what bends the
            // law.
            let force_n =
                1e-7 * size * matter.masses[coordinate as usize] / matter.settings.dt_s.powi(2);
            scratch.forces[coordinate as usize] = Vector3::z() * force_n;
            self.run(matter, &state, &mut scratch);
            scratch.forces[coordinate as usize] = Vector3::zeros();
            let moved = |&c: &u32| (scratch.predicted[c as usize].z - free[c as usize].z) / force_n;
            columns.extend(matter.coordinate_of_unknown.iter().map(moved));
        }
        columns
    }
}
