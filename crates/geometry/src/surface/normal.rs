//! Outward normals and principal curvatures, also where S_u × S_v vanishes.
//!
//! At a pole (a collapsed edge, S_u = 0 along it) the normal is the limit from inside at that
//! parameter: with d pointing inwards, S_u × S_v grows as its derivative along d, S_uu × S_v + S_u
//! × S_uv in u and S_uv × S_v + S_u × S_vv in v. Where the surface has no tangent plane (the tip of
//! a cone) the limit depends on the parameter along the edge, and so does the answer. Where that
//! derivative vanishes too (both tangents collapse at a corner, two equal rows) we step inside and
//! extrapolate, good to about 1e-7.

use super::{Frame, Surface};
use crate::basis::KnotVector;
use crate::math::Vector3;

/// Below this sine (times the ratio of the tangents) the cross product has lost half its digits,
/// and the limit has fewer than half left to lose.
const SINGULAR: f64 = 1e-8;

/// First step inside, in lengths of the domain: its square and the rounding of a difference of
/// second order, 1e-16 / 1e-8, are then alike.
const STEP_INSIDE: f64 = 1e-4;

/// Nearer to an end of the domain than this, in lengths of the domain, "inside" is away from that
/// end.
const NEAR_EDGE: f64 = 1e-6;

/// Principal curvatures and their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// The greater, 1/m. Positive where the surface bends away from its outward normal: a ball of
    /// radius r has 1/r.
    pub max: f64,
    /// The lesser, 1/m.
    pub min: f64,
    /// Unit tangent along which the curvature is `max`; `normal × direction_max` is that of `min`.
    pub direction_max: Vector3,
}

impl Curvature {
    /// Mean curvature, 1/m.
    pub fn mean(&self) -> f64 {
        0.5 * (self.max + self.min)
    }

    /// Gaussian curvature, 1/m².
    pub fn gaussian(&self) -> f64 {
        self.max * self.min
    }
}

impl Surface {
    /// Unit outward normal. The zero vector only where all points nearby are one point or one
    /// curve.
    pub fn normal(&self, u: f64, v: f64) -> Vector3 {
        self.normal_of(&self.frame(u, v), u, v)
    }

    /// [`Surface::normal`] from the frame at (u, v), at hand.
    pub fn normal_of(&self, frame: &Frame, u: f64, v: f64) -> Vector3 {
        let across = match self.regular_normal(frame) {
            Some(normal) => normal,
            None => self.limit_normal(frame, u, v),
        };
        if self.flip_normal() { -across } else { across }
    }

    /// Principal curvatures; at a pole, those a ten-thousandth of the domain inside. `None` where
    /// there is no normal.
    pub fn curvature(&self, u: f64, v: f64) -> Option<Curvature> {
        let mut frame = self.frame(u, v);
        if self.regular_normal(&frame).is_none() {
            let (u, v) = self.inside(u, v, STEP_INSIDE);
            frame = self.frame(u, v);
        }
        let normal = self.regular_normal(&frame)?;
        let outward = if self.flip_normal() { -normal } else { normal };
        // The second fundamental form in an orthonormal basis of the tangent plane: J⁻ᵀ II J⁻¹, J =
        // [S_u S_v].
        let x = frame.du.normalize();
        let y = normal.cross(&x);
        let (a, b, d) = (frame.du.dot(&x), frame.dv.dot(&x), frame.dv.dot(&y));
        let (l, m, n) = (
            frame.duu.dot(&outward),
            frame.duv.dot(&outward),
            frame.dvv.dot(&outward),
        );
        let xx = -l / (a * a);
        let xy = -(m - l * b / a) / (a * d);
        let yy = -(n - 2.0 * m * b / a + l * b * b / (a * a)) / (d * d);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = libm::hypot(half, xy);
        // Of the two rows that give the eigenvector, the one that does not cancel.
        let (cos, sin) = if half >= 0.0 {
            (half + radius, xy)
        } else {
            (xy, radius - half)
        };
        let length = libm::hypot(cos, sin);
        let direction_max = if length > 0.0 {
            (x * cos + y * sin) / length
        } else {
            x
        };
        Some(Curvature {
            max: mean + radius,
            min: mean - radius,
            direction_max,
        })
    }

    /// Tangents in metres per length of the domain, which compares them fairly.
    fn lengths(&self) -> (f64, f64) {
        (self.knots_u().length(), self.knots_v().length())
    }

    /// Unit S_u × S_v where it is well determined.
    fn regular_normal(&self, frame: &Frame) -> Option<Vector3> {
        let (length_u, length_v) = self.lengths();
        let (a, b) = (frame.du * length_u, frame.dv * length_v);
        let cross = a.cross(&b);
        let tangent = a.norm().max(b.norm());
        let bend = (frame.duu.norm() * length_u * length_u)
            .max(frame.duv.norm() * length_u * length_v)
            .max(frame.dvv.norm() * length_v * length_v);
        let area = cross.norm();
        (area > SINGULAR * tangent * tangent && tangent > SINGULAR * bend).then(|| cross / area)
    }

    fn limit_normal(&self, frame: &Frame, u: f64, v: f64) -> Vector3 {
        let (length_u, length_v) = self.lengths();
        let (a, b) = (frame.du * length_u, frame.dv * length_v);
        let auu = frame.duu * (length_u * length_u);
        let auv = frame.duv * (length_u * length_v);
        let avv = frame.dvv * (length_v * length_v);
        let (inward_u, inward_v) = (inward(self.knots_u(), u), inward(self.knots_v(), v));
        let growth =
            (auu.cross(&b) + a.cross(&auv)) * inward_u + (auv.cross(&b) + a.cross(&avv)) * inward_v;
        let scale = a.norm().max(b.norm()) * auu.norm().max(auv.norm()).max(avv.norm());
        if growth.norm() > 1e-6 * scale {
            return growth.normalize();
        }
        let mut step = STEP_INSIDE;
        while step < 0.2 {
            let at = |step: f64| {
                let (u, v) = self.inside(u, v, step);
                self.regular_normal(&self.frame(u, v))
            };
            if let (Some(near), Some(far)) = (at(step), at(2.0 * step)) {
                // On the normals of a line through the answer: twice the near one less the far one.
                return (near * 2.0 - far).normalize();
            }
            step *= 10.0;
        }
        Vector3::zeros()
    }

    /// (u, v) moved inside by a fraction of the domain: away from the ends it is at, else towards
    /// the middle.
    fn inside(&self, u: f64, v: f64, step: f64) -> (f64, f64) {
        let (length_u, length_v) = self.lengths();
        let (mut inward_u, mut inward_v) = (inward(self.knots_u(), u), inward(self.knots_v(), v));
        if inward_u == 0.0 && inward_v == 0.0 {
            let towards_middle = |knots: &KnotVector, at: f64| {
                let (start, end) = knots.domain();
                if at < 0.5 * (start + end) { 1.0 } else { -1.0 }
            };
            (inward_u, inward_v) = (
                towards_middle(self.knots_u(), u),
                towards_middle(self.knots_v(), v),
            );
        }
        (
            u + inward_u * step * length_u,
            v + inward_v * step * length_v,
        )
    }
}

/// +1 at the start of a domain that does not wrap, −1 at its end, else 0.
pub(super) fn inward(knots: &KnotVector, at: f64) -> f64 {
    if knots.is_periodic() {
        return 0.0;
    }
    let (start, end) = knots.domain();
    let near = NEAR_EDGE * (end - start);
    if at <= start + near {
        1.0
    } else if at >= end - near {
        -1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::ControlNet;
    use super::super::builtin::builtin;
    use super::super::testing::{fifty_surfaces, tilted};
    use super::*;
    use crate::math::Point3;

    fn surface(degrees: [usize; 2], rows: usize, points: &[[f64; 3]]) -> Surface {
        let columns = points.len() / rows;
        let points = points.iter().map(|&p| Point3::from(p)).collect();
        Surface::new(
            KnotVector::clamped_uniform(degrees[0], rows).unwrap(),
            KnotVector::clamped_uniform(degrees[1], columns).unwrap(),
            ControlNet::new(rows, columns, points).unwrap(),
            None,
        )
        .unwrap()
    }

    #[test]
    fn normals_of_a_sphere_are_radial_at_its_poles_and_as_near_them_as_can_be() {
        for sphere in [
            builtin("sphere", None, None).unwrap(),
            builtin("sphere", Some([20, 17]), None).unwrap(),
        ] {
            for swapped in [false, true] {
                let sphere = if swapped {
                    sphere.swap_uv()
                } else {
                    sphere.clone()
                };
                for k in 0..=40 {
                    let around = f64::from(k) / 40.0;
                    for near in [
                        0.0, 1e-16, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-3, 0.1, 0.4,
                    ] {
                        for up in [near, 1.0 - near] {
                            let (u, v) = if swapped { (up, around) } else { (around, up) };
                            let radial = sphere.point(u, v).coords.normalize();
                            let error = (sphere.normal(u, v) - radial).norm();
                            // Half the digits of f64, where the tangents have lost the other half.
                            assert!(error < 1e-7, "({u}, {v}) swapped {swapped}: off by {error}");
                            if near == 0.0 || near >= 1e-3 {
                                assert!(
                                    error < 1e-11,
                                    "({u}, {v}) swapped {swapped}: off by {error}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn normals_at_the_poles_of_the_teardrop_continue_those_beside_them() {
        for net in [8, 12, 20] {
            let drop = tilted(&builtin("teardrop", Some([net; 2]), None).unwrap());
            for k in 0..50 {
                let u = f64::from(k) / 49.0;
                for (pole, inside) in [(0.0, 1.0), (1.0, -1.0)] {
                    let (at, h) = (drop.normal(u, pole), 1e-4);
                    let (near, far) = (
                        drop.normal(u, pole + inside * h),
                        drop.normal(u, pole + inside * 2.0 * h),
                    );
                    // Extrapolated; what is left is the second difference, (curvature · 1e-4 ·
                    // length)².
                    assert!(
                        (2.0 * near - far - at).norm() < 1e-5,
                        "{net}: ({u}, {pole}) {at} beside {near}"
                    );
                }
            }
        }
    }

    // The tip of a cone has a normal for each line that leads to it.
    #[test]
    fn the_tip_of_a_cone_has_the_normal_of_each_of_its_lines() {
        let quarter = surface(
            [2, 1],
            3,
            &[
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [0.0, 1.0, 0.0],
            ],
        );
        let mut seen = Vec::new();
        for k in 0..=10 {
            let u = f64::from(k) / 10.0;
            let (tip, below) = (quarter.normal(u, 0.0), quarter.normal(u, 0.5));
            assert!(
                (tip - below).norm() < 1e-14,
                "u = {u}: {tip} at the tip, {below} below"
            );
            seen.push(tip);
        }
        assert!((seen[0] - seen[10]).norm() > 0.5, "the limit depends on u");
    }

    // Three corners of a bilinear patch make a triangle; two equal rows make S_v and S_uv vanish
    // together.
    #[test]
    fn normals_at_degenerate_corners_and_doubled_poles_are_found_inside() {
        let triangle = surface(
            [1, 1],
            2,
            &[
                [0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
            ],
        );
        for (u, v) in [(0.0, 0.0), (0.0, 0.4), (0.0, 1.0), (1.0, 1.0)] {
            assert!(
                (triangle.normal(u, v) - Vector3::z()).norm() < 1e-14,
                "({u}, {v})"
            );
        }
        // x = (1 + u) v², y = u v² …: all of order v² at the doubled pole, in the plane z = 0 and
        // curved with v⁴ above it.
        let fan = surface(
            [1, 2],
            2,
            &[
                [0.0; 3],
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0; 3],
                [0.0; 3],
                [0.0, 1.0, 0.0],
            ],
        );
        for u in [0.0, 0.3, 1.0] {
            assert!(
                (fan.normal(u, 0.0) - Vector3::z() * fan.normal(u, 0.5).z).norm() < 1e-9,
                "u = {u}"
            );
        }
        // Both tangents at the corner lie along x, since the point across is on that line too.
        let folded = surface(
            [2, 2],
            3,
            &[
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [2.0, 1.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.5, 0.0, 0.0],
                [2.5, 1.0, 0.0],
                [2.0, -1.0, 0.0],
                [2.5, -1.0, 0.0],
                [3.0, 0.0, 0.0],
            ],
        );
        assert!(
            (folded.normal(0.0, 0.0).z.abs() - 1.0).abs() < 1e-12,
            "{}",
            folded.normal(0.0, 0.0)
        );
        let nothing = surface([1, 1], 2, &[[1.0; 3]; 4]);
        assert_eq!(nothing.normal(0.3, 0.0), Vector3::zeros());
        assert_eq!(nothing.curvature(0.3, 0.0), None);
    }

    #[test]
    fn normals_are_unit_and_across_the_tangents_and_turn_with_the_flag() {
        for surface in fifty_surfaces(61).into_iter().take(20) {
            let (start, end) = surface.knots_u().domain();
            let v = surface
                .knots_v()
                .confine(0.37 + surface.knots_v().domain().0);
            for k in 0..20 {
                let u = start + (end - start) * (f64::from(k) + 0.3) / 20.0;
                let (frame, normal) = (surface.frame(u, v), surface.normal(u, v));
                assert!((normal.norm() - 1.0).abs() < 1e-14);
                assert!(
                    normal.dot(&frame.du.normalize()).abs() < 1e-7
                        && normal.dot(&frame.dv.normalize()).abs() < 1e-7
                );
                assert_eq!(surface.clone().with_flip_normal(true).normal(u, v), -normal);
            }
        }
    }

    #[test]
    fn curvatures_of_a_sphere_are_one_over_its_radius_everywhere() {
        let sphere = tilted(&builtin("sphere", None, Some(0.2)).unwrap());
        for (u, v) in [(0.1, 0.3), (0.7, 0.77), (0.25, 0.5), (0.3, 0.0), (0.9, 1.0)] {
            let curvature = sphere.curvature(u, v).unwrap();
            let tolerance = if v == 0.0 || v == 1.0 { 1e-5 } else { 1e-11 };
            for value in [curvature.min, curvature.max] {
                assert!(
                    (value * 0.2 - 1.0).abs() < tolerance,
                    "({u}, {v}): {curvature:?}"
                );
            }
        }
    }

    // S = (u, v, (4 v² − u²)/2) in skewed parameters: at the vertex the curvatures are 1 along x
    // and −4 along y.
    #[test]
    fn curvatures_of_a_saddle_have_their_signs_and_directions() {
        let height = |x: f64, y: f64| 2.0 * y * y - 0.5 * x * x;
        // Exact for a quadratic: its polar form at the knots gives the net.
        let mut points = Vec::new();
        let ends = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        for [a, b] in ends {
            for [c, d] in ends {
                // x = s + t / 2, y = t, with s and t blossomed.
                let (s, t) = (0.5 * (a + b), 0.5 * (c + d));
                let xx = a * b + s * t + 0.25 * c * d;
                points.push([s + 0.5 * t, t, 2.0 * c * d - 0.5 * xx]);
            }
        }
        let saddle = surface([2, 2], 3, &points);
        let p = saddle.point(0.3, 0.9);
        assert!(
            (p.z - height(p.x, p.y)).abs() < 1e-14,
            "the net is that of the saddle"
        );
        let curvature = saddle.curvature(0.5, 0.5).unwrap();
        assert!(
            (curvature.max - 1.0).abs() < 1e-13 && (curvature.min + 4.0).abs() < 1e-13,
            "{curvature:?}"
        );
        assert!(
            curvature.direction_max.cross(&Vector3::x()).norm() < 1e-13,
            "{curvature:?}"
        );
        let below = saddle.with_flip_normal(true).curvature(0.5, 0.5).unwrap();
        assert!((below.max - 4.0).abs() < 1e-13 && (below.mean() - 1.5).abs() < 1e-13);
        assert!((below.gaussian() + 4.0).abs() < 1e-12);
        assert!(below.direction_max.cross(&Vector3::y()).norm() < 1e-13);
    }
}
