//! Flat closed bodies: which control points lie opposite each other across the thickness.
//!
//! Rings shrink towards a curve between the poles. In a lens, whose poles lie in the middle of its two
//! sides, that curve is as short as the lens is thick, and the cells would be slanted by the ratio of
//! its axes. Its rings shrink towards the surface midway between the sides instead: each control point
//! towards the middle between itself and its opposite, which share the innermost node, so that cells
//! stand in columns through the body. A ring on the rim is opposite itself, and the cells beside it
//! are wedges. A flat body whose poles lie on its rim (a blade) keeps its curve: its net has no two
//! sides there that could be paired.

use super::layers::{self, Rings};
use palpate_geometry::math::{Point3, Vector3};

/// What the rings of a body shrink towards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medial {
    /// A curve with a point for each ring.
    #[default]
    Curve,
    /// A surface: the poles lie on the two sides, and ring j is opposite ring n − 1 − j.
    Surface,
}

/// How many times as wide as thick a body is that has a medial surface. Towards a curve, the cells of an
/// ellipsoid of these axes are slanted to atan(1 / 3) = 18°, and get worse from there.
const FLAT: f64 = 3.0;

impl Rings {
    /// True where the body has a medial surface.
    pub fn is_flat(&self) -> bool {
        self.medial == Medial::Surface
    }

    /// The ring that lies opposite in a flat body, itself on the rim.
    pub fn opposite(&self, j: usize) -> usize {
        self.along - 1 - j
    }

    /// True for a ring that is one point.
    pub(super) fn is_pole(&self, j: usize) -> bool {
        (j == 0 && self.ends.first_pole) || (j + 1 == self.along && self.ends.last_pole)
    }

    /// True for a ring that is opposite itself.
    pub(super) fn is_rim(&self, j: usize) -> bool {
        self.is_flat() && self.opposite(j) == j
    }

    /// True where the cells between a ring and the next would lie in the rim and have no volume.
    pub(super) fn is_closed_up(&self, j: usize) -> bool {
        self.is_flat() && self.opposite(j) == j + 1
    }

    /// Chooses the medial curve or surface that suits these control points; not a surface that would fold
    /// cells.
    pub fn with_medial(mut self, points: &[Point3]) -> Self {
        let ends = self.ends;
        if ends.axis_closed || !(ends.first_pole && ends.last_pole) || self.along < 3 {
            return self;
        }
        let outer = |i: usize, j: usize| points[self.control(i, j)];
        let (mut width, mut thickness) = (0.0_f64, 0.0_f64);
        for j in 0..self.along {
            let sum: Vector3 = (0..self.around).map(|i| outer(i, j).coords).sum();
            let centre = Point3::from(sum / self.around as f64);
            let radii = (0..self.around).map(|i| (outer(i, j) - centre).norm());
            width = width.max(2.0 * radii.sum::<f64>() / self.around as f64);
            for i in 0..self.around {
                thickness = thickness.max((outer(i, j) - outer(i, self.opposite(j))).norm());
            }
        }
        if width > FLAT * thickness {
            self.medial = Medial::Surface;
            let targets = middles(points, &self);
            if layers::rings_about(&targets, points, &self, 1)
                .quality()
                .folded_cells
                > 0
            {
                self.medial = Medial::Curve;
            }
        }
        self
    }
}

/// What each control point of a flat body shrinks towards, ring after ring.
pub(super) fn middles(points: &[Point3], rings: &Rings) -> Vec<Point3> {
    let outer = |i: usize, j: usize| points[rings.control(i, j)].coords;
    let middle = |i: usize, j: usize| (outer(i, j) + outer(i, rings.opposite(j))) * 0.5;
    (0..rings.along)
        .flat_map(|j| (0..rings.around).map(move |i| (i, j)))
        .map(|(i, j)| Point3::from(middle(i, j)))
        .collect()
}
