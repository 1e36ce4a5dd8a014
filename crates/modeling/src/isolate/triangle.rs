//! Two triangles: where they cross, and how far apart they are.
//!
//! Crossing by signed distances to each other's planes and intervals on the common line (Möller, *A
//! fast triangle-triangle intersection test*, 1997). Distances within a tolerance of a plane are
//! zero, so that touching counts as crossing. Distance by the nine pairs of edges and six of corner
//! and face (Ericson, *Real-Time Collision Detection*, ch. 5).

use palpate_geometry::math::Vector3;

/// A triangle with its plane, m. The normal is zero when the triangle has no area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub corners: [Vector3; 3],
    /// Unit, by the right-hand rule.
    pub normal: Vector3,
    /// normal · x of the plane.
    pub offset: f64,
}

/// How two triangles meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Crossing {
    /// In one plane, with a common point.
    Coplanar,
    /// Along a segment of the line of their planes; the ends are equal when they only touch.
    Segment(Vector3, Vector3),
}

impl Triangle {
    pub fn new(corners: [Vector3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::zeros);
        // The mean of three products is nearer to all corners than the product of one.
        Self {
            corners,
            normal,
            offset: normal.dot(&(a + b + c)) / 3.0,
        }
    }

    /// Returns this triangle translated by `by`, m.
    pub fn moved(&self, by: &Vector3) -> Self {
        Self {
            corners: self.corners.map(|p| p + by),
            normal: self.normal,
            offset: self.offset + self.normal.dot(by),
        }
    }

    /// The other lies beyond `tolerance` on one side of this plane moved by `by`: most pairs need
    /// to know no more.
    #[inline]
    pub fn misses(&self, by: &Vector3, other: &Self, tolerance: f64) -> bool {
        let offset = self.offset + self.normal.dot(by);
        let [x, y, z] = other.corners.map(|p| self.normal.dot(&p) - offset);
        (x > tolerance && y > tolerance && z > tolerance)
            || (x < -tolerance && y < -tolerance && z < -tolerance)
    }

    fn has_area(&self) -> bool {
        self.normal != Vector3::zeros()
    }

    /// Signed distances of the other's corners from this plane; within `tolerance` is zero.
    fn heights(&self, other: &Self, tolerance: f64) -> [f64; 3] {
        other.corners.map(|p| {
            let height = self.normal.dot(&p) - self.offset;
            if height.abs() <= tolerance {
                0.0
            } else {
                height
            }
        })
    }

    /// The part on the plane that its corners have these heights over: up to two ends.
    fn cut(&self, heights: &[f64; 3]) -> Option<(Vector3, Vector3)> {
        let mut ends: [Option<Vector3>; 2] = [None; 2];
        let mut push = |p: Vector3| match &mut ends {
            [slot @ None, _] | [_, slot @ None] => *slot = Some(p),
            _ => {}
        };
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (a, b) = (heights[i], heights[j]);
            if a == 0.0 {
                push(self.corners[i]);
            } else if a * b < 0.0 {
                push(self.corners[i] + (self.corners[j] - self.corners[i]) * (a / (a - b)));
            }
        }
        let first = ends[0]?;
        Some((first, ends[1].unwrap_or(first)))
    }
}

/// Where two triangles meet; triangles without area meet nothing. The segment runs along `a.normal
/// × b.normal`.
pub(super) fn crossing(a: &Triangle, b: &Triangle, tolerance: f64) -> Option<Crossing> {
    let apart = |h: &[f64; 3]| h.iter().all(|&x| x > 0.0) || h.iter().all(|&x| x < 0.0);
    let over_a = a.heights(b, tolerance);
    if apart(&over_a) {
        return None;
    }
    let over_b = b.heights(a, tolerance);
    if apart(&over_b) || !a.has_area() || !b.has_area() {
        return None;
    }
    if over_a == [0.0; 3] || over_b == [0.0; 3] {
        return coplanar_meet(a, b, tolerance).then_some(Crossing::Coplanar);
    }
    let line = a.normal.cross(&b.normal).try_normalize(0.0)?;
    let on_line = |(p, q): (Vector3, Vector3)| {
        let (s, t) = (line.dot(&p), line.dot(&q));
        if s <= t {
            [(s, p), (t, q)]
        } else {
            [(t, q), (s, p)]
        }
    };
    let [a_low, a_high] = on_line(a.cut(&over_b)?);
    let [b_low, b_high] = on_line(b.cut(&over_a)?);
    let low = if a_low.0 >= b_low.0 { a_low } else { b_low };
    let high = if a_high.0 <= b_high.0 { a_high } else { b_high };
    if high.0 < low.0 - tolerance {
        return None;
    }
    Some(if high.0 < low.0 {
        Crossing::Segment(low.1, low.1)
    } else {
        Crossing::Segment(low.1, high.1)
    })
}

/// Two triangles of one plane: no edge of either has the other wholly on its outer side (separating
/// axes).
fn coplanar_meet(a: &Triangle, b: &Triangle, tolerance: f64) -> bool {
    let outside = |t: &Triangle, other: &Triangle| {
        (0..3).any(|i| {
            let (p, q) = (t.corners[i], t.corners[(i + 1) % 3]);
            let outward = (q - p).cross(&t.normal);
            let reach = tolerance * outward.norm();
            other.corners.iter().all(|c| outward.dot(&(c - p)) > reach)
        })
    };
    !outside(a, b) && !outside(b, a)
}

/// A plane between them is wider than the square root of `squared`: one of theirs, or one across
/// the line of their middles. Says no more than what is certain; it is a fifth of the work of
/// [`nearest`].
pub(super) fn certainly_farther(a: &Triangle, b: &Triangle, squared: f64) -> bool {
    let line =
        (a.corners[0] + a.corners[1] + a.corners[2]) - (b.corners[0] + b.corners[1] + b.corners[2]);
    let along = |t: &Triangle| t.corners.map(|p| line.dot(&p));
    let ([x, y, z], [u, v, w]) = (along(a), along(b));
    let between = x.min(y).min(z) - u.max(v).max(w);
    if between > 0.0 && between * between > squared * line.norm_squared() {
        return true;
    }
    let beyond = |plane: &Triangle, t: &Triangle| {
        let [x, y, z] = plane.heights(t, 0.0);
        let (low, high) = (x.min(y).min(z), x.max(y).max(z));
        let nearest = if low > 0.0 { low } else { -high };
        nearest > 0.0 && nearest * nearest > squared
    };
    beyond(a, b) || beyond(b, a)
}

/// Nearest points of two triangles that do not cross: (squared distance, on a, on b).
pub(super) fn nearest(a: &Triangle, b: &Triangle) -> (f64, Vector3, Vector3) {
    let mut best = (f64::INFINITY, a.corners[0], b.corners[0]);
    let mut offer = |p: Vector3, q: Vector3| {
        let d = (p - q).norm_squared();
        if d < best.0 {
            best = (d, p, q);
        }
    };
    for i in 0..3 {
        for j in 0..3 {
            let (p, q) = nearest_of_segments(
                (a.corners[i], a.corners[(i + 1) % 3]),
                (b.corners[j], b.corners[(j + 1) % 3]),
            );
            offer(p, q);
        }
    }
    for &corner in &a.corners {
        if let Some(foot) = foot_inside(b, &corner) {
            offer(corner, foot);
        }
    }
    for &corner in &b.corners {
        if let Some(foot) = foot_inside(a, &corner) {
            offer(foot, corner);
        }
    }
    best
}

/// The foot of a point on the plane of a triangle, where it lies inside.
fn foot_inside(t: &Triangle, point: &Vector3) -> Option<Vector3> {
    if !t.has_area() {
        return None;
    }
    let foot = point - t.normal * (t.normal.dot(point) - t.offset);
    let inside = (0..3).all(|i| {
        let (p, q) = (t.corners[i], t.corners[(i + 1) % 3]);
        (q - p).cross(&(foot - p)).dot(&t.normal) >= 0.0
    });
    inside.then_some(foot)
}

/// Nearest points of two segments (Ericson, 5.1.9).
fn nearest_of_segments(
    (p1, q1): (Vector3, Vector3),
    (p2, q2): (Vector3, Vector3),
) -> (Vector3, Vector3) {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.norm_squared(), d2.norm_squared(), d2.dot(&r));
    let unit = |x: f64| x.clamp(0.0, 1.0);
    let (s, t) = if a <= 0.0 && e <= 0.0 {
        (0.0, 0.0)
    } else if a <= 0.0 {
        (0.0, unit(f / e))
    } else {
        let c = d1.dot(&r);
        if e <= 0.0 {
            (unit(-c / a), 0.0)
        } else {
            let b = d1.dot(&d2);
            let determinant = a * e - b * b;
            let s = if determinant > 0.0 {
                unit((b * f - c * e) / determinant)
            } else {
                0.0
            };
            let t = (b * s + f) / e;
            if t < 0.0 {
                (unit(-c / a), 0.0)
            } else if t > 1.0 {
                (unit((b - c) / a), 1.0)
            } else {
                (s, t)
            }
        }
    };
    (p1 + d1 * s, p2 + d2 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn random(random: &mut Random, spread: f64) -> Triangle {
        let centre = Vector3::from_fn(|_, _| random.float(-spread, spread));
        Triangle::new([0; 3].map(|_| centre + Vector3::from_fn(|_, _| random.float(-1.0, 1.0))))
    }

    // Slow twin: an edge of one passes through the other, by volumes of tetrahedra.
    fn edge_through(a: &Triangle, b: &Triangle) -> bool {
        let volume =
            |p: Vector3, q: Vector3, r: Vector3, s: Vector3| (q - p).dot(&(r - p).cross(&(s - p)));
        (0..3).any(|i| {
            let (p, q) = (a.corners[i], a.corners[(i + 1) % 3]);
            let [x, y, z] = b.corners;
            let sides = volume(p, x, y, z) * volume(q, x, y, z) < 0.0;
            let turns = [volume(p, q, x, y), volume(p, q, y, z), volume(p, q, z, x)];
            sides && (turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0))
        })
    }

    #[test]
    fn triangles_cross_where_an_edge_of_one_passes_through_the_other() {
        let mut numbers = Random(7);
        let mut counts = [0, 0];
        for _ in 0..20_000 {
            let (a, b) = (random(&mut numbers, 0.6), random(&mut numbers, 0.6));
            let found = crossing(&a, &b, 1e-13);
            assert_eq!(
                found.is_some(),
                edge_through(&a, &b) || edge_through(&b, &a),
                "{a:?} {b:?}"
            );
            counts[usize::from(found.is_some())] += 1;
            let Some(Crossing::Segment(p, q)) = found else {
                continue;
            };
            for end in [p, q] {
                assert!(
                    (a.normal.dot(&end) - a.offset).abs() < 1e-12
                        && (b.normal.dot(&end) - b.offset).abs() < 1e-12
                );
            }
            assert!(
                (q - p).dot(&a.normal.cross(&b.normal)) >= 0.0,
                "along the product of the normals"
            );
        }
        assert!(counts[0] > 2000 && counts[1] > 2000, "{counts:?}");
    }

    // Slow twin: alternating closest points on fine grids of both triangles can only find longer
    // distances.
    #[test]
    fn no_points_of_two_triangles_are_nearer_than_the_nearest() {
        let mut numbers = Random(9);
        let grid = |t: &Triangle| -> Vec<Vector3> {
            let n = 12;
            (0..=n)
                .flat_map(|i| (0..=n - i).map(move |j| (i as f64 / n as f64, j as f64 / n as f64)))
                .map(|(s, r)| t.corners[0] * (1.0 - s - r) + t.corners[1] * s + t.corners[2] * r)
                .collect()
        };
        let mut pruned = 0;
        for _ in 0..400 {
            let (a, b) = (random(&mut numbers, 3.0), random(&mut numbers, 3.0));
            if crossing(&a, &b, 0.0).is_some() {
                continue;
            }
            let (squared, p, q) = nearest(&a, &b);
            assert!(((p - q).norm_squared() - squared).abs() < 1e-12);
            let (on_a, on_b) = (grid(&a), grid(&b));
            let sampled = on_a
                .iter()
                .flat_map(|p| on_b.iter().map(move |q| (p - q).norm()))
                .fold(f64::INFINITY, f64::min);
            // Cells have sides up to 0.3, so samples are at most that much too long.
            assert!(
                squared.sqrt() <= sampled + 1e-12 && sampled <= squared.sqrt() + 0.35,
                "{squared} {sampled}"
            );
            assert!(
                !certainly_farther(&a, &b, squared * (1.0 + 1e-9)),
                "{a:?} {b:?}"
            );
            pruned += usize::from(certainly_farther(&a, &b, 0.5 * squared));
        }
        assert!(pruned > 200, "{pruned} of 400 are seen at a glance");
    }

    #[test]
    fn triangles_without_area_and_coplanar_ones_are_no_trouble() {
        let flat = |x: f64| {
            Triangle::new([[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]].map(Vector3::from))
        };
        assert_eq!(
            crossing(&flat(0.0), &flat(0.5), 1e-12),
            Some(Crossing::Coplanar)
        );
        assert_eq!(crossing(&flat(0.0), &flat(1.5), 1e-12), None);
        let needle =
            Triangle::new([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]].map(Vector3::from));
        assert_eq!(crossing(&needle, &flat(-0.2), 1e-12), None);
        let point = Triangle::new([Vector3::z(); 3]);
        assert_eq!(nearest(&point, &flat(-0.2)).0, 1.0);
    }
}
