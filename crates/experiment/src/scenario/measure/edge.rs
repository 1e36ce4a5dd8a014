//! Lines of a surface: which way they go and how straight they are.

use palpate_geometry::math::{Matrix3, Point3, Vector3};
use palpate_geometry::surface::Surface;
use serde::Deserialize;

/// Points on a part of a line.
const POINTS: usize = 41;

/// Two parts of a line of constant v (or u) of a body's surface.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EdgeSpec {
    /// The body.
    pub body: String,
    /// `u` or `v`: the parameter that changes along the line.
    pub along: Parameter,
    /// The other one.
    pub at: f64,
    /// First part.
    pub from: [f64; 2],
    /// Second part.
    pub to: [f64; 2],
}

/// A parameter of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Parameter {
    /// The first.
    U,
    /// The second.
    V,
}

/// The straight line nearest to points.
pub struct Line {
    /// From the first point to the last.
    pub direction: Vector3,
    /// Greatest distance of a point from it, m.
    pub straightness_m: f64,
}

impl EdgeSpec {
    /// Points of a part, in order.
    pub fn points(&self, surface: &Surface, [from, to]: [f64; 2]) -> Vec<Point3> {
        let at = |k: usize| from + (to - from) * k as f64 / (POINTS - 1) as f64;
        let point = |t: f64| match self.along {
            Parameter::U => surface.point(t, self.at),
            Parameter::V => surface.point(self.at, t),
        };
        (0..POINTS).map(|k| point(at(k))).collect()
    }

    /// Between the two parts, rad.
    pub fn angle_rad(&self, surface: &Surface) -> f64 {
        let of = |part| Line::through(&self.points(surface, part)).direction;
        let (a, b) = (of(self.from), of(self.to));
        libm::atan2(a.cross(&b).norm(), a.dot(&b))
    }
}

impl Line {
    /// In the sense of least squares.
    pub fn through(points: &[Point3]) -> Self {
        let centre: Vector3 =
            points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64;
        let mut spread = Matrix3::zeros();
        for point in points {
            let arm = point.coords - centre;
            spread += arm * arm.transpose();
        }
        let eigen = spread.symmetric_eigen();
        let most = (0..3).max_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let axis: Vector3 = eigen.eigenvectors.column(most.unwrap_or(0)).into();
        let way = points[points.len() - 1] - points[0];
        let direction = if axis.dot(&way) < 0.0 { -axis } else { axis };
        let off = |point: &Point3| {
            let arm = point.coords - centre;
            (arm - direction * arm.dot(&direction)).norm()
        };
        Self {
            direction,
            straightness_m: points.iter().map(off).fold(0.0, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_is_as_far_from_straight_as_its_sagitta_says() {
        let (radius, half) = (0.5, 0.2);
        let points: Vec<Point3> = (-50..=50)
            .map(|k| {
                let angle = half * f64::from(k) / 50.0;
                Point3::new(radius * libm::sin(angle), 0.3, radius * libm::cos(angle))
            })
            .collect();
        let line = Line::through(&points);
        assert!((line.direction - Vector3::x()).norm() < 1e-12);
        // The line of least squares halves it unevenly: between a half and all of the sagitta.
        let sagitta = radius * (1.0 - libm::cos(half));
        assert!(line.straightness_m > 0.5 * sagitta && line.straightness_m < sagitta);
    }
}
