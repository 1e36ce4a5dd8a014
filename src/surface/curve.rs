//! Curves in space, as surfaces have them: edges, iso-curves.

use super::lines::LinePoint;
use super::tensor::wrap;
use crate::basis::KnotVector;
use crate::math::{Point3, Vector3};

/// A B-spline or NURBS curve, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    knots: KnotVector,
    points: Vec<Point3>,
    weights: Option<Vec<f64>>,
}

impl Curve {
    /// From points that were checked.
    pub(super) fn from_line(knots: KnotVector, line: &[LinePoint], rational: bool) -> Self {
        debug_assert_eq!(knots.count(), line.len(), "points and knots disagree");
        let points = line.iter().map(|point| point.0).collect();
        Self { knots, points, weights: rational.then(|| line.iter().map(|point| point.1).collect()) }
    }

    /// Knots.
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
        let (mut sum, mut slope, mut weight, mut weight_slope) = (Vector3::zeros(), Vector3::zeros(), 0.0, 0.0);
        for (k, (n, d)) in window.values().iter().zip(window.first_derivatives()).enumerate() {
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
