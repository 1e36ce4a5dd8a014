//! Area, and the centroid of what a surface encloses.

use super::Surface;
use super::closed::{RATIONAL_NODES, gauss_nodes};
use crate::basis::{BasisWindow, KnotVector};
use crate::math::{Point3, Vector3};

/// Two areas this close, relatively, end the doubling.
const AREA_TOLERANCE: f64 = 1e-12;

/// Most Gauss points a span and direction.
const MOST_NODES: usize = 96;

impl Surface {
    /// Area, m², each patch of a branching surface once; to about 1e-12 of itself where the surface
    /// is smooth in every span, 1e-8 where |S_u × S_v| has a kink there. Gauss points are doubled
    /// until nothing changes.
    pub fn area(&self) -> f64 {
        let mut nodes = self.knots_u().degree().max(self.knots_v().degree()) + 2;
        let mut last = f64::NAN;
        loop {
            let area = self.integrate([nodes; 2], |frame| frame.du.cross(&frame.dv).norm());
            if (area - last).abs() <= AREA_TOLERANCE * area || nodes >= MOST_NODES {
                return area;
            }
            (last, nodes) = (area, 2 * nodes);
        }
    }

    /// Centre of mass of the closed surface's inside, m. `None` when it is not closed or encloses
    /// nothing.
    pub fn centroid(&self) -> Option<Point3> {
        if !self.topology().is_closed() {
            return None;
        }
        let centre = self.bounding_centre();
        // ∫ x dV = ½ ∮ x² n_x dA, and so on: degree 2p in the squares, 2p − 1 in the normal.
        let nodes = |knots: &KnotVector| {
            let exact = 2 * knots.degree();
            if self.weights().is_some() {
                exact.max(RATIONAL_NODES)
            } else {
                exact
            }
        };
        let nodes = [nodes(self.knots_u()), nodes(self.knots_v())];
        let mut first = Vector3::zeros();
        let volume = self.integrate(nodes, |frame| {
            (frame.point - centre).dot(&frame.du.cross(&frame.dv)) / 3.0
        });
        for axis in 0..3 {
            first[axis] = self.integrate(nodes, |frame| {
                let x = frame.point[axis] - centre[axis];
                0.5 * x * x * frame.du.cross(&frame.dv)[axis]
            });
        }
        let from_centre = first / volume;
        from_centre
            .iter()
            .all(|x| x.is_finite())
            .then(|| centre + from_centre)
    }

    /// Middle of the net's bounding box.
    fn bounding_centre(&self) -> Point3 {
        let points = self.net().points();
        let (low, high) = points
            .iter()
            .fold((points[0], points[0]), |(low, high), p| {
                (low.inf(p), high.sup(p))
            });
        nalgebra::center(&low, &high)
    }

    /// ∬ f du dv, duplicates of a branching surface left out, with that many Gauss points a span in
    /// u and v.
    pub(super) fn integrate(&self, nodes: [usize; 2], f: impl Fn(&super::Frame) -> f64) -> f64 {
        let joints = self.joints();
        let hidden = |i: usize, j: usize| {
            joints
                .as_ref()
                .is_some_and(|t| t.is_duplicate(i / nodes[0], j / nodes[1]))
        };
        let windows: Vec<(BasisWindow, f64)> = gauss_nodes(self.knots_v(), nodes[1])
            .into_iter()
            .map(|(v, weight)| (self.knots_v().window(v), weight))
            .collect();
        let mut sum = 0.0;
        for (i, (u, weight_u)) in gauss_nodes(self.knots_u(), nodes[0])
            .into_iter()
            .enumerate()
        {
            let wu = self.knots_u().window(u);
            let shown = windows
                .iter()
                .enumerate()
                .filter(|(j, _)| !hidden(i, *j))
                .map(|(_, window)| window);
            let along: f64 = shown
                .map(|(wv, weight)| weight * f(&self.frame_in(&wu, wv)))
                .sum();
            sum += weight_u * along;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::tilted;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn area_and_centroid_of_a_rational_sphere() {
        for radius in [0.05, 3.0] {
            let sphere = builtin("sphere", None, Some(radius)).unwrap();
            let area = tilted(&sphere).area() / (4.0 * PI * radius * radius) - 1.0;
            assert!(area.abs() < 1e-12, "radius {radius}: relative error {area}");
            // The middle, moved as `tilted` moves it.
            let centroid = tilted(&sphere).centroid().unwrap();
            assert!((centroid - Point3::new(0.3, -0.2, 0.7)).norm() < 1e-13 * radius.max(1.0));
        }
    }

    #[test]
    fn a_sheet_has_its_area_and_no_inside() {
        let sheet = builtin("sheet", None, Some(0.2)).unwrap();
        assert!((tilted(&sheet).area() - 0.04).abs() < 1e-15);
        assert!(sheet.centroid().is_none());
    }

    // Tetrahedra from the origin to a fine triangulation, extrapolated.
    #[test]
    fn area_and_centroid_of_the_teardrop_are_what_fine_triangles_tend_to() {
        let drop = tilted(&builtin("teardrop", None, None).unwrap());
        let measure = |count: usize| -> [f64; 4] {
            let at = |i: usize, j: usize| {
                drop.point(i as f64 / count as f64, j as f64 / count as f64)
                    .coords
            };
            let (mut area, mut volume, mut first) = (0.0, 0.0, Vector3::zeros());
            for i in 0..count {
                for j in 0..count {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    for [a, b, c] in [[a, b, c], [a, c, d]] {
                        area += (b - a).cross(&(c - a)).norm() / 2.0;
                        let six = a.dot(&b.cross(&c));
                        volume += six / 6.0;
                        first += (a + b + c) * (six / 24.0);
                    }
                }
            }
            let centroid = first / volume;
            [area, centroid.x, centroid.y, centroid.z]
        };
        let (coarse, middle, fine) = (measure(40), measure(80), measure(160));
        let limit = |k: usize| {
            let (first, second) = (
                (4.0 * middle[k] - coarse[k]) / 3.0,
                (4.0 * fine[k] - middle[k]) / 3.0,
            );
            (16.0 * second - first) / 15.0
        };
        let area = drop.area();
        assert!(
            (area / limit(0) - 1.0).abs() < 1e-8,
            "{area} m², triangles tend to {} m²",
            limit(0)
        );
        let centroid = drop.centroid().unwrap();
        for axis in 0..3 {
            assert!(
                (centroid[axis] - limit(axis + 1)).abs() < 1e-9 * drop.size(),
                "axis {axis}: {}",
                centroid[axis]
            );
        }
    }
}
