//! Flat closed bodies: which control points lie opposite each other across the thickness.
//!
//! Rings of a round section shrink towards a curve. Those of a flat one, a lens or a blade, would
//! become cells that are slanted by the ratio of its axes. They shrink towards the surface midway
//! between its two sides instead: each control point towards the middle between itself and its
//! opposite, which share the innermost node, so that cells stand in columns through the body.
//! Points on the rim are opposite themselves, and the cells beside them are wedges.

use super::layers::{self, Insets, Rings};
use palpate_geometry::math::{Point3, Vector3};

/// What the rings of a body shrink towards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medial {
    /// A curve with a point for each ring.
    #[default]
    Curve,
    /// A surface: the poles lie on the two sides, and ring j is opposite ring n − 1 − j.
    Ends,
    /// A surface: each ring lies on both sides, and its point i is opposite the point s − i.
    Sides(usize),
}

/// How many times as wide as thick a body is that has a medial surface. A homothetic shell of an
/// ellipse of these axes has corners of 2 · atan(1 / 3) = 37°, and the cells get worse from there.
const FLAT: f64 = 3.0;

/// Part of the half thickness by which a pole between two sides gives way, and the rings beside it
/// less and less: the cells beside a smooth pole would have no volume.
const POLE_INSET: f64 = 0.5;
/// Rings beside a pole that give way.
const POLE_RINGS: usize = 3;

impl Rings {
    /// True where the body has a medial surface.
    pub fn is_flat(&self) -> bool {
        self.medial != Medial::Curve
    }

    /// The place around and along that lies opposite, itself on the rim; of a body with a medial
    /// surface.
    pub fn opposite(&self, i: usize, j: usize) -> (usize, usize) {
        match self.medial {
            Medial::Curve => (i, j),
            Medial::Ends => (i, self.along - 1 - j),
            Medial::Sides(sum) => ((sum + self.around - i) % self.around, j),
        }
    }

    /// True for a place whose ring is one point.
    pub(super) fn is_pole(&self, j: usize) -> bool {
        (j == 0 && self.ends.first_pole) || (j + 1 == self.along && self.ends.last_pole)
    }

    /// True for a control point that is opposite itself.
    pub(super) fn is_rim(&self, i: usize, j: usize) -> bool {
        self.is_flat() && self.opposite(i, j) == (i, j) && !self.is_pole(j)
    }

    /// True where the cells between a place and the next, around or along, would lie in the rim and
    /// have no volume.
    pub(super) fn is_closed_up(&self, i: usize, j: usize) -> bool {
        match self.medial {
            Medial::Curve => false,
            Medial::Ends => self.opposite(i, j).1 == j + 1,
            Medial::Sides(_) => self.opposite(i, j).0 == (i + 1) % self.around,
        }
    }

    /// The same rings with the medial curve or surface that suits these control points. One that
    /// would fold cells is not taken.
    pub fn with_medial(mut self, points: &[Point3]) -> Self {
        let outer = |i: usize, j: usize| points[self.control(i, j)];
        self.medial = medial(outer, &self);
        if self.is_flat() {
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

fn medial(outer: impl Fn(usize, usize) -> Point3, rings: &Rings) -> Medial {
    let Rings {
        around,
        along,
        ends,
        ..
    } = *rings;
    let (mut mean_width, mut width) = (0.0_f64, 0.0_f64);
    for j in 0..along {
        let sum: Vector3 = (0..around).map(|i| outer(i, j).coords).sum();
        let centre = Point3::from(sum / around as f64);
        let radii = (0..around).map(|i| (outer(i, j) - centre).norm());
        mean_width = mean_width.max(2.0 * radii.clone().sum::<f64>() / around as f64);
        width = width.max(2.0 * radii.fold(0.0, f64::max));
    }
    let thickness = |medial: Medial| {
        let rings = Rings {
            medial,
            ..rings.clone()
        };
        let across = |i: usize, j: usize| {
            let (k, l) = rings.opposite(i, j);
            (outer(i, j) - outer(k, l)).norm()
        };
        (0..along)
            .flat_map(|j| (0..around).map(move |i| (i, j)))
            .map(|(i, j)| across(i, j))
            .fold(0.0, f64::max)
    };
    let poles = ends.first_pole && ends.last_pole;
    if poles && along > 2 && mean_width > FLAT * thickness(Medial::Ends) {
        return Medial::Ends;
    }
    let sides = Medial::Sides(sum_of_opposites(&outer, around, along));
    if around > 3 && width > FLAT * thickness(sides) {
        return sides;
    }
    Medial::Curve
}

/// The sum of the numbers around of two points that are opposite each other: the one with which the
/// squares of their distances are least.
pub(super) fn sum_of_opposites(
    outer: impl Fn(usize, usize) -> Point3,
    around: usize,
    along: usize,
) -> usize {
    let squares = |sum: usize| -> f64 {
        (0..along)
            .flat_map(|j| (0..around).map(move |i| (i, j)))
            .map(|(i, j)| (outer(i, j) - outer((sum + around - i) % around, j)).norm_squared())
            .sum()
    };
    let mut best = (f64::INFINITY, 0);
    for sum in 0..around {
        let trial = squares(sum);
        // With a hair of tolerance: rounding of symmetric sections must not decide.
        if trial < best.0 * (1.0 - 1e-9) {
            best = (trial, sum);
        }
    }
    best.1
}

/// What each control point shrinks towards, ring after ring.
pub(super) fn middles(points: &[Point3], rings: &Rings) -> Vec<Point3> {
    let Rings { around, along, .. } = *rings;
    let outer = |i: usize, j: usize| points[rings.control(i, j)];
    let shifts = pole_shifts(points, rings);
    let mut targets = Vec::with_capacity(around * along);
    for (j, shift) in shifts.iter().enumerate() {
        for i in 0..around {
            let (k, l) = rings.opposite(i, j);
            let middle = Point3::from((outer(i, j).coords + outer(k, l).coords) * 0.5);
            targets.push(if rings.is_rim(i, j) {
                middle
            } else {
                middle + shift
            });
        }
    }
    targets
}

/// How far each ring gives way beside poles that lie between the two sides.
fn pole_shifts(points: &[Point3], rings: &Rings) -> Vec<Vector3> {
    let Rings {
        around,
        along,
        ends,
        ..
    } = *rings;
    let mut shifts = vec![Vector3::zeros(); along];
    if !matches!(rings.medial, Medial::Sides(_)) || along <= 2 * POLE_RINGS {
        return shifts;
    }
    let outer = |i: usize, j: usize| points[rings.control(i, j)];
    let centres = layers::medial_curve(points, rings, &Insets::NONE);
    let Some(axis) = (centres[along - 1] - centres[0]).try_normalize(0.0) else {
        return shifts;
    };
    let thickness = (0..along)
        .flat_map(|j| (0..around).map(move |i| (i, j)))
        .map(|(i, j)| {
            let (k, l) = rings.opposite(i, j);
            (outer(i, j) - outer(k, l)).norm()
        })
        .fold(0.0, f64::max);
    let gap = |a: usize, b: usize| (centres[a] - centres[b]).dot(&axis).abs();
    for (pole, way, at) in [
        (ends.first_pole, 1.0, [0, 1, 2, 3]),
        (
            ends.last_pole,
            -1.0,
            [along - 1, along - 2, along - 3, along - 4],
        ),
    ] {
        if !pole {
            continue;
        }
        // So that no ring passes the next one.
        let most = 0.5 * POLE_RINGS as f64 * gap(at[1], at[2]).min(gap(at[2], at[3]));
        let inset = (0.5 * POLE_INSET * thickness).min(most);
        for (k, &j) in at.iter().enumerate().take(POLE_RINGS) {
            shifts[j] += axis * (way * inset * (1.0 - k as f64 / POLE_RINGS as f64));
        }
    }
    shifts
}
