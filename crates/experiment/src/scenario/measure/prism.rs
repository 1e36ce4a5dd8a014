//! Volume of a body inside an upright prism.
//!
//! By the divergence theorem with the field (0, 0, z): the volume is ∮ z n_z dA. The prism's sides are
//! upright, so n_z = 0 on them and what a cut opens there adds nothing: it is enough to clip the
//! body's triangles and to sum over what is left.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::{Mesh, Surface};

/// Points on each edge of a rim.
const POINTS: usize = 64;

/// A convex prism along z, without ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Prism {
    /// Its outline, counter-clockwise; empty: all of space.
    outline: Vec<[f64; 2]>,
}

impl Prism {
    /// All of space.
    pub fn everywhere() -> Self {
        Self {
            outline: Vec::new(),
        }
    }

    /// Over the convex outline of the rim of an open surface, as seen from above.
    pub fn over_rim(surface: &Surface) -> Self {
        let ((a, b), (c, d)) = (surface.knots_u().domain(), surface.knots_v().domain());
        let mut points = Vec::with_capacity(4 * POINTS);
        for k in 0..POINTS {
            let s = k as f64 / POINTS as f64;
            let (u, v) = (a + (b - a) * s, c + (d - c) * s);
            for (u, v) in [(u, c), (b, v), (b + a - u, d), (a, d + c - v)] {
                let point = surface.point(u, v);
                points.push([point.x, point.y]);
            }
        }
        Self {
            outline: convex(points),
        }
    }

    /// Volume inside of a body with these triangles, m³.
    pub fn volume_m3(&self, mesh: &Mesh) -> f64 {
        let mut sum = 0.0;
        let (mut polygon, mut clipped) = (Vec::new(), Vec::new());
        for triangle in &mesh.triangles {
            polygon.clear();
            polygon.extend(triangle.map(|corner| mesh.points[corner as usize]));
            for k in 0..self.outline.len() {
                let (a, b) = (self.outline[k], self.outline[(k + 1) % self.outline.len()]);
                clip(&polygon, a, b, &mut clipped);
                std::mem::swap(&mut polygon, &mut clipped);
            }
            for k in 2..polygon.len() {
                sum += under(&polygon[0], &polygon[k - 1], &polygon[k]);
            }
        }
        sum
    }
}

/// ∫ z dx dy over a triangle, negative where it faces down.
fn under(a: &Point3, b: &Point3, c: &Point3) -> f64 {
    let twice = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    twice * (a.z + b.z + c.z) / 6.0
}

/// The part of a polygon to the left of the line from a to b (Sutherland & Hodgman 1974).
fn clip(polygon: &[Point3], a: [f64; 2], b: [f64; 2], out: &mut Vec<Point3>) {
    out.clear();
    let left = |p: &Point3| (b[0] - a[0]) * (p.y - a[1]) - (b[1] - a[1]) * (p.x - a[0]);
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (side_p, side_q) = (left(p), left(q));
        if side_p >= 0.0 {
            out.push(*p);
        }
        if (side_p >= 0.0) != (side_q >= 0.0) {
            out.push(p + (q - p) * (side_p / (side_p - side_q)));
        }
    }
}

/// Convex hull, counter-clockwise (Andrew 1979).
fn convex(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let turns_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while hull.len() >= 2 && !turns_left(hull[hull.len() - 2], hull[hull.len() - 1], point)
            {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::surface::builtin;
    use std::f64::consts::PI;

    // A ball of radius r, moved by d across the side of a square prism: a cap of height h = r − d is
    // outside, π h² (3 r − h) / 3. A ball at the middle is inside, one far away is not.
    #[test]
    fn the_cap_of_a_ball_past_a_side_is_what_the_closed_form_says() {
        let sheet = builtin("sheet", None, Some(0.1)).unwrap();
        let prism = Prism::over_rim(&sheet);
        let r = 0.012;
        for (x, y, z) in [
            (0.0, 0.0, 0.3),
            (0.045, 0.01, -0.2),
            (-0.05, 0.0, 0.0),
            (0.0, 0.056, 1.0),
            (0.5, 0.0, 0.0),
        ] {
            let mut ball = builtin("sphere", None, Some(r)).unwrap();
            for point in ball.net_mut().points_mut() {
                *point += palpate_geometry::math::Vector3::new(x, y, z);
            }
            let mesh = ball.tessellated([40, 40]).unwrap();
            let whole = Prism::everywhere().volume_m3(&mesh);
            assert!(
                (whole / (4.0 / 3.0 * PI * r * r * r) - 1.0).abs() < 1e-3,
                "{whole}"
            );
            let past = f64::max(f64::abs(x), f64::abs(y)) - 0.05;
            let h = (r + past).clamp(0.0, 2.0 * r);
            let outside = PI * h * h * (3.0 * r - h) / 3.0;
            let found = whole - prism.volume_m3(&mesh);
            assert!(
                (found - outside).abs() < 2e-3 * whole,
                "{x} {y}: {found} {outside}"
            );
        }
    }
}
