//! The step of a body: one of three methods.

use super::explicit::Explicit;
use super::implicit::{ImplicitStep, Response};
use super::matter::{FIXED, Matter};
use super::settings::{DeformableError, Integrator};
use super::state::{DeformableScratch, DeformableState};
use super::xpbd::Xpbd;
use palpate_geometry::math::Vector3;

/// Constants of a body's method.
#[derive(Debug)]
pub(super) enum Stepper {
    Implicit(ImplicitStep),
    Explicit(Explicit),
    Xpbd(Xpbd),
}

/// How far a force held on the surface through one step moves each coordinate.
#[derive(Debug)]
pub(super) struct Compliance {
    /// (coordinates): column of the response, or [`FIXED`].
    pub column: Vec<u32>,
    pub response: Response,
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

    /// Drops digits that steps do not need: after [`Stepper::compliance`].
    pub fn round(&mut self, matter: &Matter) {
        if let Self::Implicit(implicit) = self {
            implicit.round(matter);
        }
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

    /// Columns of the surface's coordinates.
    ///
    /// # Errors
    /// A matrix without factor.
    pub fn compliance(&self, matter: &Matter) -> Result<Compliance, DeformableError> {
        let mut index = vec![FIXED; matter.rest.len()];
        for (column, &coordinate) in matter.surface.iter().enumerate() {
            index[coordinate as usize] = column as u32;
        }
        let response = match self {
            Self::Implicit(implicit) => implicit.response(matter, &matter.surface)?,
            Self::Explicit(_) | Self::Xpbd(_) => Response {
                columns: vec![self.columns_by_trial(matter, &matter.surface)],
                ..Response::default()
            },
        };
        Ok(Compliance {
            column: index,
            response,
        })
    }

    /// Compliance of a step that has no matrix: what small forces do to the body at rest, made
    /// symmetric.
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
        let row = |coordinate: u32| matter.unknown[coordinate as usize] as usize;
        for (i, &a) in surface.iter().enumerate() {
            for (j, &b) in surface.iter().enumerate().take(i) {
                let (there, back) = (i * n + row(b), j * n + row(a));
                let mean = 0.5 * (columns[there] + columns[back]);
                (columns[there], columns[back]) = (mean, mean);
            }
        }
        columns
    }
}
