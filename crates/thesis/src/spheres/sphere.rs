//! A sphere about four neighbouring points.
//!
//! The seed's choice: the circle through the ends of the longer diagonal and one remaining point
//! gives centre and radius. Where that triangle is obtuse its circle is larger than it need be, so
//! the sphere over its longest side is taken; and a fourth point that is still outside widens the
//! sphere, so that all four are always in it.

use palpate_geometry::math::{Point3, Vector3};

/// A ball, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, m.
    pub centre: Point3,
    /// Radius, m.
    pub radius_m: f64,
}

impl Sphere {
    /// About the corners of a cell, in order round it.
    #[inline(always)]
    pub(super) fn about([a, b, c, d]: &[Point3; 4]) -> Self {
        let (ac, bd) = ((c - a).norm_squared(), (d - b).norm_squared());
        let ([p, q], [x, y], square) = if ac >= bd {
            ([a, c], [b, d], ac)
        } else {
            ([b, d], [a, c], bd)
        };
        let middle = nalgebra::center(p, q);
        let (to_x, to_y) = ((x - middle).norm_squared(), (y - middle).norm_squared());
        // The farther of the two decides: with both inside, the diagonal is a diameter.
        if to_x <= 0.25 * square && to_y <= 0.25 * square {
            return Self {
                centre: middle,
                radius_m: 0.5 * square.sqrt(),
            };
        }
        let (third, fourth) = if to_x >= to_y { (x, y) } else { (y, x) };
        let mut sphere = Self::about_triangle(p, q, third);
        sphere.widen(fourth);
        sphere
    }

    /// The smallest about three points.
    fn about_triangle(a: &Point3, b: &Point3, c: &Point3) -> Self {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let (p, q, r) = (ab.norm_squared(), ac.norm_squared(), bc.norm_squared());
        let over = |x: &Point3, y: &Point3, square: f64| Self {
            centre: nalgebra::center(x, y),
            radius_m: 0.5 * square.sqrt(),
        };
        let mut sphere = if p >= q + r {
            over(a, b, p)
        } else if q >= p + r {
            over(a, c, q)
        } else if r >= p + q {
            over(b, c, r)
        } else {
            let n = ab.cross(&ac);
            let to_centre: Vector3 =
                (n.cross(&ab) * q + ac.cross(&n) * p) / (2.0 * n.norm_squared());
            Self {
                centre: a + to_centre,
                radius_m: to_centre.norm(),
            }
        };
        if !sphere.radius_m.is_finite() {
            sphere = over(a, b, p);
        }
        // Rounding, or what the line above let go.
        for point in [a, b, c] {
            sphere.widen(point);
        }
        sphere
    }

    /// The smallest that holds this one and a point.
    fn widen(&mut self, point: &Point3) {
        let away = point - self.centre;
        let square = away.norm_squared();
        if square > self.radius_m * self.radius_m {
            let distance = square.sqrt();
            let grown = 0.5 * (distance + self.radius_m);
            self.centre += away * ((distance - grown) / distance);
            self.radius_m = grown;
        }
    }
}

/// A sphere about a cell and the slab that the cell lies in: a lens, that holds as much of the
/// surface in less room.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub sphere: Sphere,
    /// Across the diagonals, unit; zero where they have no cross product.
    pub normal: Vector3,
    /// Half the thickness of the slab about the sphere's centre, m.
    pub half_m: f64,
}

impl Lens {
    /// About the corners of a cell whose surface is within `sag_m` of their bilinear patch.
    #[inline(always)]
    pub fn about(corners: &[Point3; 4], sag_m: f64) -> Self {
        let mut sphere = Sphere::about(corners);
        let [a, b, c, d] = corners;
        let across = (c - a).cross(&(d - b));
        let square = across.norm_squared();
        let normal = if square > 0.0 {
            across / square.sqrt()
        } else {
            Vector3::zeros()
        };
        let mut half_m: f64 = 0.0;
        for corner in corners {
            let off = (corner - sphere.centre).dot(&normal).abs();
            half_m = if off > half_m { off } else { half_m };
        }
        sphere.radius_m += sag_m;
        Self {
            sphere,
            normal,
            half_m: half_m + sag_m,
        }
    }

    /// The square of a distance that no point in the lens is nearer to `q` than, m²; and of that of
    /// the centre.
    #[inline(always)]
    pub fn bound(&self, q: &Point3) -> (f64, f64) {
        let away = q - self.sphere.centre;
        let (square, along) = (away.norm_squared(), away.dot(&self.normal));
        let beside = (square - along * along).max(0.0).sqrt() - self.sphere.radius_m;
        let above = along.abs() - self.half_m;
        let (beside, above) = (
            if beside > 0.0 { beside } else { 0.0 },
            if above > 0.0 { above } else { 0.0 },
        );
        (beside * beside + above * above, square)
    }

    /// The spheres are within `margin_m` of each other, and so are the slabs.
    #[inline(always)]
    pub fn meets(&self, other: &Self, margin_m: f64) -> bool {
        let (r, s) = (self.sphere.radius_m, other.sphere.radius_m);
        let between = self.sphere.centre - other.sphere.centre;
        let reach = r + s + margin_m;
        if between.norm_squared() > reach * reach {
            return false;
        }
        let cosine = self.normal.dot(&other.normal).abs();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        // How far one reaches along the other's normal: its disc tilted, and its thickness.
        let along = |lens: &Self| {
            (lens.half_m * cosine + lens.sphere.radius_m * sine).min(lens.sphere.radius_m)
        };
        between.dot(&self.normal).abs() <= self.half_m + along(other) + margin_m
            && between.dot(&other.normal).abs() <= other.half_m + along(self) + margin_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    #[test]
    fn all_four_corners_are_inside_and_no_room_is_wasted() {
        let mut random = Random(5);
        let mut widest: f64 = 0.0;
        for k in 0..20_000 {
            let mut point = || {
                Point3::new(
                    random.float(-1.0, 1.0),
                    random.float(-1.0, 1.0),
                    random.float(-0.3, 0.3),
                )
            };
            let mut corners = [point(), point(), point(), point()];
            if k % 5 == 0 {
                corners[1] = corners[0];
            }
            if k % 7 == 0 {
                corners[3] = nalgebra::center(&corners[0], &corners[2]);
            }
            let sphere = Sphere::about(&corners);
            let mut across: f64 = 0.0;
            for a in &corners {
                assert!(
                    (a - sphere.centre).norm() <= sphere.radius_m * (1.0 + 1e-12),
                    "{corners:?}: {sphere:?}"
                );
                across = corners
                    .iter()
                    .map(|b| (a - b).norm())
                    .fold(across, f64::max);
            }
            // Jung: √(3/8) of the greatest distance holds any points; widening may cost as much
            // again at worst.
            widest = widest.max(sphere.radius_m / across);
        }
        assert!(widest <= 0.85, "{widest}");
    }

    #[test]
    fn a_rectangle_has_its_diagonal_and_a_single_point_nothing() {
        let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let sphere = Sphere::about(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 3.0), at(0.0, 3.0)]);
        assert!(
            (sphere.radius_m - 2.5).abs() < 1e-15 && (sphere.centre - at(2.0, 1.5)).norm() < 1e-15
        );
        assert_eq!(
            Sphere::about(&[at(1.0, 1.0); 4]),
            Sphere {
                centre: at(1.0, 1.0),
                radius_m: 0.0
            }
        );
    }
}
