//! Two bodies, one of them translated: do they overlap, and how far apart are they?
//!
//! ```text
//! overlap   boxes of both trees → crossing triangles (ends at the first) → is a corner of one inside the other?
//! nearest   boxes by distance   → nearest triangles
//! cuts      boxes               → all crossing triangles with their segments
//! ```

use super::body::{Body, TOUCHING};
use super::bvh::Block;
use super::triangle::{Crossing, crossing};
use palpate_geometry::math::Vector3;

/// Normals of triangles whose cross product is shorter than this are parallel: their segment says
/// nothing.
const PARALLEL: f64 = 1e-6;

/// A moving and a fixed body. Translations are those of the moving one from where it stood at
/// first.
#[derive(Debug)]
pub(super) struct Pair<'a> {
    pub moving: &'a Body,
    pub fixed: &'a Body,
    /// Where the moving body stands at first, beside its own coordinates, m.
    start: Vector3,
    /// Diagonal of the box round both at first, m.
    pub diameter_m: f64,
    /// Lengths up to this are nothing, m.
    tolerance_m: f64,
    /// Overlap tests so far.
    pub tests: u32,
}

/// The nearest points of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Distance, m.
    pub gap_m: f64,
    /// Unit, from the fixed body to the moving one; `None` where they touch.
    pub normal: Option<Vector3>,
}

/// A segment in which a triangle of the moving body crosses one of the fixed body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// Triangles (of the moving, of the fixed body).
    pub triangles: [u32; 2],
    /// Ends, along normal of the moving × normal of the fixed triangle, m.
    pub ends: [Vector3; 2],
}

/// All crossings at one place.
#[derive(Clone, Debug, Default)]
pub(super) struct Cuts {
    pub segments: Vec<Cut>,
    /// Pairs of triangles that are coplanar, or nearly.
    pub parallel: usize,
}

impl Body {
    /// Whether this body, moved by `by` (m), and the other share more than single points.
    pub fn overlaps(&self, by: &Vector3, other: &Self) -> bool {
        Pair::new(self, other, Vector3::zeros()).overlap(by)
    }

    /// The distance of this body, moved by `by` (m), from another one that it does not overlap, m.
    pub fn gap_m(&self, by: &Vector3, other: &Self) -> f64 {
        Pair::new(self, other, Vector3::zeros()).nearest(by).gap_m
    }
}

impl<'a> Pair<'a> {
    pub fn new(moving: &'a Body, fixed: &'a Body, start: Vector3) -> Self {
        let mut both = *fixed.block();
        let Block { low, high } = *moving.block();
        both.add(&(Vector3::from(low) + start));
        both.add(&(Vector3::from(high) + start));
        let diameter_m = both.diagonal();
        let farthest = both
            .low
            .iter()
            .chain(&both.high)
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        let tolerance_m = TOUCHING * diameter_m + 8.0 * f64::EPSILON * farthest;
        Self {
            moving,
            fixed,
            start,
            diameter_m,
            tolerance_m,
            tests: 0,
        }
    }

    /// Lengths up to this are nothing, m.
    pub fn tolerance_m(&self) -> f64 {
        self.tolerance_m
    }

    /// What the moving body's own coordinates are moved by.
    pub fn moved_by(&self, translation: &Vector3) -> Vector3 {
        self.start + translation
    }

    /// From the fixed centroid to the moving one, at first.
    pub fn between_centroids(&self) -> Vector3 {
        self.moving.centroid + self.start - self.fixed.centroid
    }

    /// Whether the solids share more than single points.
    pub fn overlap(&mut self, translation: &Vector3) -> bool {
        self.tests += 1;
        let by = self.moved_by(translation);
        let tolerance = self.tolerance_m;
        let (moving, fixed) = (&self.moving.bvh, &self.fixed.bvh);
        if !moving.block().meets(&by, fixed.block(), tolerance) {
            return false;
        }
        let cross = moving.pairs(&by, fixed, tolerance, |i, j| {
            let (first, second) = (moving.triangle(i), fixed.triangle(j));
            if first.misses(&by, second, tolerance) {
                return false;
            }
            match crossing(&first.moved(&by), second, tolerance) {
                None => false,
                Some(Crossing::Coplanar) => true,
                Some(Crossing::Segment(p, q)) => (q - p).norm() > tolerance,
            }
        });
        // Without a crossing one holds the other or they are apart: one corner of each decides.
        cross
            || self.fixed.winding(&(self.moving.points[0] + by)) != 0
            || self.moving.winding(&(self.fixed.points[0] - by)) != 0
    }

    /// Nearest points of bodies that do not overlap.
    pub fn nearest(&self, translation: &Vector3) -> Nearest {
        self.near(translation, 0.0)
    }

    /// Nearest points, or any within `enough_m` of each other.
    pub fn near(&self, translation: &Vector3, enough_m: f64) -> Nearest {
        let by = self.moved_by(translation);
        let found = self.moving.bvh.nearest(&by, &self.fixed.bvh, enough_m);
        // A tree has a triangle, so there is a nearest pair.
        let (squared, p, q) = found.unwrap_or((0.0, by, by));
        let gap_m = squared.sqrt();
        let normal = if gap_m > self.tolerance_m {
            (p - q).try_normalize(0.0)
        } else {
            None
        };
        Nearest { gap_m, normal }
    }

    /// All segments of crossing triangles.
    pub fn cuts(&self, translation: &Vector3) -> Cuts {
        let by = self.moved_by(translation);
        let (moving, fixed) = (&self.moving.bvh, &self.fixed.bvh);
        let mut cuts = Cuts::default();
        moving.pairs(&by, fixed, self.tolerance_m, |i, j| {
            let (a, b) = (moving.triangle(i).moved(&by), fixed.triangle(j));
            match crossing(&a, b, self.tolerance_m) {
                None => {}
                Some(Crossing::Coplanar) => cuts.parallel += 1,
                Some(Crossing::Segment(..)) if a.normal.cross(&b.normal).norm() < PARALLEL => {
                    cuts.parallel += 1
                }
                Some(Crossing::Segment(p, q)) => {
                    cuts.segments.push(Cut {
                        triangles: [i as u32, j as u32],
                        ends: [p, q],
                    });
                }
            }
            false
        });
        cuts
    }

    /// A translation along the unit vector `direction` that certainly frees: the boxes of supports
    /// no longer meet.
    pub fn certain_exit_m(&self, direction: &Vector3) -> f64 {
        let along =
            |points: &[Vector3]| points.iter().map(|p| direction.dot(p)).collect::<Vec<_>>();
        let high = along(&self.fixed.points)
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        let low = along(&self.moving.points)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        (high - low - direction.dot(&self.start)).max(0.0) + 16.0 * self.tolerance_m
    }

    /// Angle between the vectors of centroids before and after, rad; `None` where one of them is
    /// zero.
    pub fn turn_rad(&self, translation: &Vector3) -> Option<f64> {
        let before = self.between_centroids();
        let after = before + translation;
        let nothing = 1e-9 * self.diameter_m;
        if before.norm() <= nothing || after.norm() <= nothing {
            return None;
        }
        Some(libm::atan2(before.cross(&after).norm(), before.dot(&after)))
    }
}
