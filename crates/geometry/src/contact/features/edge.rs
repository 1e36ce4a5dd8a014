//! A sharp edge of a solid as a curve.

use crate::math::{Point3, Vector3};

/// Points of a round edge that are the same in each query.
pub(super) const FIXED: usize = 8;

/// A sharp edge in the solid's frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// A straight one, between two corners by their index.
    Segment {
        /// Where it begins and ends, m.
        ends: [Point3; 2],
        /// The corners there.
        corners: [usize; 2],
    },
    /// A circle around z.
    Circle {
        /// Its height, m.
        z: f64,
        /// Its radius, m.
        radius_m: f64,
    },
}

impl Edge {
    /// Point, m, and derivative at t from 0 to 1.
    pub fn at(&self, t: f64) -> (Point3, Vector3) {
        match *self {
            Self::Segment { ends: [a, b], .. } => (a + (b - a) * t, b - a),
            Self::Circle { z, radius_m } => {
                let angle = std::f64::consts::TAU * t;
                let (s, c) = (libm::sin(angle), libm::cos(angle));
                let way = Vector3::new(-s, c, 0.0) * (std::f64::consts::TAU * radius_m);
                (Point3::new(radius_m * c, radius_m * s, z), way)
            }
        }
    }

    /// Length, m.
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Segment { ends: [a, b], .. } => (b - a).norm(),
            Self::Circle { radius_m, .. } => std::f64::consts::TAU * radius_m,
        }
    }

    /// It ends where it begins.
    pub fn is_round(&self) -> bool {
        matches!(self, Self::Circle { .. })
    }

    /// Its point next to another, m.
    pub(super) fn nearest(&self, p: &Point3) -> Point3 {
        match *self {
            Self::Segment { ends: [a, b], .. } => {
                let way = b - a;
                a + way * ((p - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)
            }
            Self::Circle { z, radius_m } => {
                let out = Vector3::new(p.x, p.y, 0.0);
                let out = out.try_normalize(0.0).unwrap_or_else(Vector3::x);
                Point3::new(0.0, 0.0, z) + out * radius_m
            }
        }
    }

    /// A ball that holds it: centre and radius, m.
    pub(super) fn ball(&self) -> (Point3, f64) {
        match *self {
            Self::Segment { ends: [a, b], .. } => (nalgebra::center(&a, &b), 0.5 * (b - a).norm()),
            Self::Circle { z, radius_m } => (Point3::new(0.0, 0.0, z), radius_m),
        }
    }
}
