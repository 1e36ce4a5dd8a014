//! Tools that are known by their signed gap.

use palpate_geometry::contact::distance_squared_to_box;
use palpate_geometry::math::{Point3, Vector3};

/// A solid tool, in the frame of the body.
pub trait Solid {
    /// Signed distance of a point to the solid's boundary, or the best there is, m: negative
    /// inside; and the unit normal out of the solid there.
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3);

    /// A function that is positive outside, negative inside, and changes by at most a metre a
    /// metre: it says whether a ball about a point can reach the boundary. `None` when there is no
    /// such bound; then all points in range are tried.
    fn bounded_gap(&self, _point: &Point3) -> Option<f64> {
        None
    }

    /// False only when no point of a box is within `margin_m` of the solid.
    fn may_meet_box(&self, _low: &Point3, _high: &Point3, _margin_m: f64) -> bool {
        true
    }

    /// A point of the solid, to find it when all of it is inside the body.
    fn inner_point(&self) -> Option<Point3> {
        None
    }
}

/// A ball; a point when its radius is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub centre: Point3,
    pub radius_m: f64,
}

impl Solid for Ball {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let away = point - self.centre;
        let distance = away.norm();
        (
            distance - self.radius_m,
            away.try_normalize(0.0).unwrap_or_else(Vector3::z),
        )
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some((point - self.centre).norm() - self.radius_m)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        let reach = self.radius_m + margin_m;
        distance_squared_to_box(&self.centre, low, high) <= reach * reach
    }

    fn inner_point(&self) -> Option<Point3> {
        Some(self.centre)
    }
}

/// Everything below a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HalfSpace {
    pub origin: Point3,
    /// Unit, out of the tool.
    pub normal: Vector3,
}

impl Solid for HalfSpace {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        ((point - self.origin).dot(&self.normal), self.normal)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some((point - self.origin).dot(&self.normal))
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        let (centre, half) = (nalgebra::center(low, high), (high - low) * 0.5);
        (centre - self.origin).dot(&self.normal) - half.dot(&self.normal.abs()) <= margin_m
    }
}
