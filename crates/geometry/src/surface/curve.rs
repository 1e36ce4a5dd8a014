//! Curves in space, as surfaces have them: edges, iso-curves.

use super::lines::LinePoint;
use super::tensor::{WEIGHTS, wrap};
use crate::basis::KnotVector;
use crate::math::{MOST_COORDINATE_M, Point3, Vector3, first_outside};

/// A B-spline or NURBS curve, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    knots: KnotVector,
    points: Vec<Point3>,
    weights: Option<Vec<f64>>,
}

/// Why a curve was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// As many points as the knots ask for.
    #[error("the knots require {needed} control points, {given} are given")]
    Count {
        /// Of the knots.
        needed: usize,
        /// As given.
        given: usize,
    },
    /// One weight a point.
    #[error("{weights} weights for {points} control points")]
    WeightCount {
        /// Number of weights given.
        weights: usize,
        /// Number of points given.
        points: usize,
    },
    /// A coordinate that is not finite, or too large to calculate with.
    #[error(
        "control point {index} has coordinate {value} m, not a finite number within ±{MOST_COORDINATE_M:e} m"
    )]
    NotFinite {
        /// Index in the list.
        index: usize,
        /// As given.
        value: f64,
    },
    /// A weight outside [`WEIGHTS`].
    #[error("weight {index} is {value}; weights are from {:e} to {:e}", WEIGHTS.start(), WEIGHTS.end())]
    Weight {
        /// Index in the list.
        index: usize,
        /// As given.
        value: f64,
    },
}

impl Curve {
    /// A curve of checked knots.
    ///
    /// # Errors
    /// Numbers of points or weights that do not fit, points that are not within ±[`MOST_COORDINATE_M`],
    /// weights that are not in [`WEIGHTS`].
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::basis::KnotVector;
    /// use palpate_geometry::math::Point3;
    /// use palpate_geometry::surface::Curve;
    /// // A quarter of the unit circle, as a rational quadratic.
    /// let points = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
    /// let weights = vec![1.0, std::f64::consts::FRAC_1_SQRT_2, 1.0];
    /// let arc = Curve::new(KnotVector::clamped_uniform(2, 3)?, points.to_vec(), Some(weights))?;
    /// assert!((arc.point(0.3).coords.norm() - 1.0).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        knots: KnotVector,
        points: Vec<Point3>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, CurveError> {
        if points.len() != knots.count() {
            return Err(CurveError::Count {
                needed: knots.count(),
                given: points.len(),
            });
        }
        if let Some((index, value)) = first_outside(&points) {
            return Err(CurveError::NotFinite { index, value });
        }
        if let Some(weights) = &weights {
            if weights.len() != points.len() {
                return Err(CurveError::WeightCount {
                    weights: weights.len(),
                    points: points.len(),
                });
            }
            if let Some(index) = weights.iter().position(|w| !WEIGHTS.contains(w)) {
                return Err(CurveError::Weight {
                    index,
                    value: weights[index],
                });
            }
        }
        Ok(Self {
            knots,
            points,
            weights,
        })
    }

    /// From points that were checked.
    pub(super) fn from_line(knots: KnotVector, line: &[LinePoint], rational: bool) -> Self {
        debug_assert_eq!(knots.count(), line.len(), "points and knots disagree");
        let points = line.iter().map(|point| point.0).collect();
        Self {
            knots,
            points,
            weights: rational.then(|| line.iter().map(|point| point.1).collect()),
        }
    }

    /// The knot vector.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// Control points, m.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Weights, if any.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// The point at a parameter, confined to the domain.
    pub fn point(&self, t: f64) -> Point3 {
        self.point_and_tangent(t).0
    }

    /// The point and the derivative by the parameter, m.
    pub fn point_and_tangent(&self, t: f64) -> (Point3, Vector3) {
        let window = self.knots.window(t);
        let (mut sum, mut slope, mut weight, mut weight_slope) =
            (Vector3::zeros(), Vector3::zeros(), 0.0, 0.0);
        for (k, (n, d)) in window
            .values()
            .iter()
            .zip(window.first_derivatives())
            .enumerate()
        {
            let k = wrap(window.first + k, self.points.len());
            let w = self.weights.as_ref().map_or(1.0, |w| w[k]);
            sum += self.points[k].coords * (n * w);
            slope += self.points[k].coords * (d * w);
            weight += n * w;
            weight_slope += d * w;
        }
        if self.weights.is_none() {
            return (Point3::from(sum), slope);
        }
        let point = sum / weight;
        (Point3::from(point), (slope - point * weight_slope) / weight)
    }
}
