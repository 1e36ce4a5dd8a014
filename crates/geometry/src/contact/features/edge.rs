//! A sharp edge of a solid as a curve.

use super::search::ball_around;
use crate::math::{Point3, Vector3};

/// Points of a round edge that are the same in each query.
pub(super) const FIXED: usize = 8;
/// Halvings in search of the point of a curve next to another.
const NEAREST: usize = 40;

/// A sharp edge in the solid's frame, m.
#[derive(Clone, Debug, PartialEq)]
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
    /// Any other.
    Curve(Curve),
}

/// A smooth curve through points at equal distances: a cubic between each two.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Points, m, and unit ways along the curve; of one that comes round the first is not repeated.
    places: Vec<(Point3, Vector3)>,
    /// The corners in which it ends; none if it comes round.
    corners: Option<[usize; 2]>,
    length_m: f64,
    /// Centre and radius of a ball around it, m.
    ball: (Point3, f64),
}

impl Curve {
    /// Two places at least.
    pub(in crate::contact) fn new(
        places: Vec<(Point3, Vector3)>,
        corners: Option<[usize; 2]>,
    ) -> Self {
        let points: Vec<Point3> = places.iter().map(|(p, _)| *p).collect();
        let (centre, radius_m) = ball_around(&points);
        let mut curve = Self {
            places,
            corners,
            length_m: 0.0,
            ball: (centre, radius_m),
        };
        let lengths = (0..curve.spans()).map(|k| curve.span(k).2);
        let (sum_m, longest_m) = lengths.fold((0.0, 0.0_f64), |(sum, most), length| {
            (sum + length, most.max(length))
        });
        curve.length_m = sum_m;
        // Between its points it is no farther out than it is long.
        curve.ball.1 += 0.5 * longest_m;
        curve
    }

    fn spans(&self) -> usize {
        self.places.len() - usize::from(self.corners.is_some())
    }

    /// Both ends of a span, and its length, m.
    fn span(&self, k: usize) -> ((Point3, Vector3), (Point3, Vector3), f64) {
        let (from, to) = (self.places[k], self.places[(k + 1) % self.places.len()]);
        let turn = from.1.cross(&to.1).norm();
        (
            from,
            to,
            (to.0 - from.0).norm() * (1.0 + turn * turn / 24.0),
        )
    }

    fn at(&self, t: f64) -> (Point3, Vector3) {
        let spans = self.spans();
        let k = ((t * spans as f64) as usize).min(spans - 1);
        let ((p, from), (q, to), length_m) = self.span(k);
        let s = t * spans as f64 - k as f64;
        // Hermite's cubic, with slopes that lead it through the middle of an arc.
        let turn = from.cross(&to).norm();
        let slope_m = length_m * (1.0 + turn * turn / 48.0);
        let (from, to, whole) = (from * slope_m, to * slope_m, q - p);
        let bend = whole * 3.0 - from * 2.0 - to;
        let twist = from + to - whole * 2.0;
        let point = p + (from + (bend + twist * s) * s) * s;
        let way = from + (bend * 2.0 + twist * (3.0 * s)) * s;
        (point, way * spans as f64)
    }

    fn nearest(&self, p: &Point3) -> Point3 {
        let away = |k: usize| (self.places[k].0 - p).norm_squared();
        let near = (0..self.places.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
        let spans = self.spans() as f64;
        let middle = near.unwrap_or(0) as f64 / spans;
        let (mut low, mut high) = (middle - 1.0 / spans, middle + 1.0 / spans);
        let turn = |t: f64| match self.corners {
            Some(_) => t.clamp(0.0, 1.0),
            None => t.rem_euclid(1.0),
        };
        let at = |t: f64| self.at(turn(t));
        // The distance falls on one side of its least and rises on the other.
        for _ in 0..NEAREST {
            let t = 0.5 * (low + high);
            let (q, way) = at(t);
            if (q - p).dot(&way) < 0.0 {
                low = t;
            } else {
                high = t;
            }
        }
        at(0.5 * (low + high)).0
    }
}

impl Edge {
    /// Point, m, and derivative at t from 0 to 1.
    pub fn at(&self, t: f64) -> (Point3, Vector3) {
        match *self {
            Self::Curve(ref curve) => curve.at(t),
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
            Self::Curve(curve) => curve.length_m,
            Self::Segment { ends: [a, b], .. } => (b - a).norm(),
            Self::Circle { radius_m, .. } => std::f64::consts::TAU * radius_m,
        }
    }

    /// It ends where it begins.
    pub fn is_round(&self) -> bool {
        self.corners().is_none()
    }

    /// The corners in which it ends.
    pub(super) fn corners(&self) -> Option<[usize; 2]> {
        match self {
            Self::Segment { corners, .. } => Some(*corners),
            Self::Circle { .. } => None,
            Self::Curve(curve) => curve.corners,
        }
    }

    /// It has no bend.
    pub(super) fn is_straight(&self) -> bool {
        matches!(self, Self::Segment { .. })
    }

    /// Its point next to another, m.
    pub(super) fn nearest(&self, p: &Point3) -> Point3 {
        match *self {
            Self::Curve(ref curve) => curve.nearest(p),
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
            Self::Curve(ref curve) => curve.ball,
            Self::Segment { ends: [a, b], .. } => (nalgebra::center(&a, &b), 0.5 * (b - a).norm()),
            Self::Circle { z, radius_m } => (Point3::new(0.0, 0.0, z), radius_m),
        }
    }
}
