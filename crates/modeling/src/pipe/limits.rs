//! The largest radius and what limits it.

use super::{BodyToBody, EndToEnd, EndsToBody, LocalCurvature, PipeError, Spine};
use super::{body_to_body, end_to_end, ends_to_body, largest_curvature};
use crate::ipp::Status;
use palpate_geometry::surface::Curve;

/// Which of the four bounds is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Limit {
    /// 1 / κ_max.
    #[serde(rename = "local")]
    LocalCurvature,
    /// Body to body.
    #[serde(rename = "bb")]
    BodyToBody,
    /// End circle to end circle.
    #[serde(rename = "ee")]
    EndToEnd,
    /// End circle to body.
    #[serde(rename = "eb")]
    EndToBody,
}

/// Whether a pipe is free of self-intersection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It is.
    Free,
    /// It meets itself.
    Intersects,
    /// No bound is reached, but the search was cut short.
    Unknown,
}

/// All bounds of the radius of a pipe.
#[derive(Clone, Debug)]
pub struct PipeLimits {
    /// LocalCurvature self-intersection.
    pub local: LocalCurvature,
    /// Body to body.
    pub body: BodyToBody,
    /// End circle to end circle; `None` where they never touch.
    pub end_to_end: Option<EndToEnd>,
    /// End circles to body.
    pub ends_to_body: EndsToBody,
}

impl PipeLimits {
    /// Of a curve.
    ///
    /// # Errors
    /// What [`Spine::new`] refuses.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::{basis::KnotVector, math::Point3, surface::Curve};
    /// use palpate_modeling::pipe::PipeLimits;
    /// // A quarter of the unit circle: a pipe around it can have a radius up to 1 m.
    /// let points = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
    /// let weights = vec![1.0, std::f64::consts::FRAC_1_SQRT_2, 1.0];
    /// let arc = Curve::new(KnotVector::clamped_uniform(2, 3)?, points.to_vec(), Some(weights))?;
    /// let (r_max_m, _limit) = PipeLimits::of(&arc)?.r_max_m().unwrap();
    /// assert!((r_max_m - 1.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(curve: &Curve) -> Result<Self, PipeError> {
        Ok(Self::of_spine(&Spine::new(curve)?))
    }

    /// Of a spine that was checked.
    pub fn of_spine(spine: &Spine) -> Self {
        Self {
            local: largest_curvature(spine),
            body: body_to_body(spine),
            end_to_end: end_to_end(spine),
            ends_to_body: ends_to_body(spine),
        }
    }

    /// The four bounds, m; `None` where there is none.
    pub fn bounds_m(&self) -> [(Limit, Option<f64>); 4] {
        [
            (Limit::LocalCurvature, self.local.radius_m),
            (Limit::BodyToBody, self.body.radius_m),
            (Limit::EndToEnd, self.end_to_end.map(|touch| touch.radius_m)),
            (
                Limit::EndToBody,
                self.ends_to_body
                    .touches
                    .first()
                    .map(|touch| touch.radius_m),
            ),
        ]
    }

    /// The least bound, m, and which it is; `None` for a straight spine, whose pipe may be of any
    /// radius.
    pub fn r_max_m(&self) -> Option<(f64, Limit)> {
        let bounds = self
            .bounds_m()
            .into_iter()
            .filter_map(|(limit, radius_m)| Some((radius_m?, limit)));
        bounds.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The worst status of the parts.
    pub fn status(&self) -> Status {
        self.local
            .status
            .max(self.body.status)
            .max(self.ends_to_body.status)
    }

    /// Whether the pipe of a radius (m, above 0) is free of self-intersection: exactly below the
    /// least bound.
    pub fn answer(&self, radius_m: f64) -> Answer {
        match self.r_max_m() {
            Some((r_max_m, _)) if radius_m >= r_max_m => Answer::Intersects,
            _ if self.status() == Status::Budget => Answer::Unknown,
            _ => Answer::Free,
        }
    }
}

#[cfg(test)]
#[path = "limits_tests.rs"]
mod tests;
