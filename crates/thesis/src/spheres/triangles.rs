//! The two triangles of a cell: nearest points, and whether two triangles meet.
//!
//! Nearest point: Ericson, *Real-Time Collision Detection*, §5.1.5. Meeting: Guigue & Devillers
//! 2003, which decides by signs of determinants alone. Their test takes no degenerate triangles;
//! those, and pairs in one plane, are decided by separating axes.

use palpate_geometry::math::{Point3, Vector3};

/// Corners of a triangle.
pub(super) type Triangle = [Point3; 3];

/// Corners of the two triangles of a cell, among its four in order round it: split along the
/// shorter diagonal.
#[inline]
pub(super) fn split([a, b, c, d]: &[Point3; 4]) -> [[usize; 3]; 2] {
    if (c - a).norm_squared() <= (d - b).norm_squared() {
        [[0, 1, 2], [0, 2, 3]]
    } else {
        [[0, 1, 3], [1, 2, 3]]
    }
}

/// The point of a triangle nearest to `q`, by its weights of the corners.
#[inline]
pub(super) fn nearest(q: &Point3, [a, b, c]: &Triangle) -> [f64; 3] {
    let (ab, ac, aq) = (b - a, c - a, q - a);
    let (d1, d2) = (ab.dot(&aq), ac.dot(&aq));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bq = q - b;
    let (d3, d4) = (ab.dot(&bq), ac.dot(&bq));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 - d3 > 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cq = q - c;
    let (d5, d6) = (ab.dot(&cq), ac.dot(&cq));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 - d6 > 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && (d4 - d3) + (d5 - d6) > 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    if sum > 0.0 {
        [va / sum, vb / sum, vc / sum]
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// Two triangles share a point.
pub(super) fn meet(first: &Triangle, second: &Triangle) -> bool {
    let [p1, q1, r1] = first;
    let [p2, q2, r2] = second;
    let (n1, n2) = ((q1 - p1).cross(&(r1 - p1)), (p2 - r2).cross(&(q2 - r2)));
    if is_degenerate(first, &n1) || is_degenerate(second, &n2) {
        return !apart(first, second);
    }
    let first_sides = first.map(|p| (p - r2).dot(&n2));
    if one_sided(&first_sides) {
        return false;
    }
    let second_sides = second.map(|p| (p - r1).dot(&n1));
    if one_sided(&second_sides) {
        return false;
    }
    // The first triangle is turned so that its first corner is alone on its side of the second's
    // plane, the second is mirrored where that side is below.
    let Some((at, up)) = lone_corner(&first_sides) else {
        return !apart_in_plane(first, second, &n2);
    };
    let first = turned(first, at);
    let (second, sides) = if up {
        (*second, second_sides)
    } else {
        mirrored(second, &second_sides)
    };
    let Some((at, up)) = lone_corner(&sides) else {
        return !apart_in_plane(&first, &second, &n1);
    };
    let second = turned(&second, at);
    let [p1, q1, r1] = if up {
        first
    } else {
        [first[0], first[2], first[1]]
    };
    let [p2, q2, r2] = second;
    // Along the line of both planes the two intervals overlap: two determinants.
    (p2 - q1).cross(&(p1 - q1)).dot(&(q2 - q1)) <= 0.0
        && (p2 - p1).cross(&(r1 - p1)).dot(&(r2 - p1)) <= 0.0
}

fn one_sided(s: &[f64; 3]) -> bool {
    (s[0] > 0.0 && s[1] > 0.0 && s[2] > 0.0) || (s[0] < 0.0 && s[1] < 0.0 && s[2] < 0.0)
}

fn mirrored(t: &Triangle, s: &[f64; 3]) -> (Triangle, [f64; 3]) {
    ([t[0], t[2], t[1]], [s[0], s[2], s[1]])
}

fn turned(t: &Triangle, at: usize) -> Triangle {
    [t[at], t[(at + 1) % 3], t[(at + 2) % 3]]
}

/// The corner that a plane parts from the two others, and whether it is above; `None` when all
/// three lie in the plane.
fn lone_corner(s: &[f64; 3]) -> Option<(usize, bool)> {
    let (above, below) = (s.map(|x| x > 0.0), s.map(|x| x < 0.0));
    let count = |flags: &[bool; 3]| flags.iter().filter(|f| **f).count();
    let only = |flags: &[bool; 3]| flags.iter().position(|f| *f);
    match (count(&above), count(&below)) {
        (0, 0) => None,
        (1, _) => only(&above).map(|k| (k, true)),
        (_, 1) => only(&below).map(|k| (k, false)),
        // Two on one side and the third in the plane: it is the lone one, on the other side.
        (2, 0) => only(&above.map(|f| !f)).map(|k| (k, false)),
        _ => only(&below.map(|f| !f)).map(|k| (k, true)),
    }
}

/// Without an area, to rounding.
fn is_degenerate([a, b, c]: &Triangle, normal: &Vector3) -> bool {
    let longest = (b - a)
        .norm_squared()
        .max((c - b).norm_squared())
        .max((a - c).norm_squared());
    normal.norm_squared() <= 1e-24 * longest * longest
}

/// Some edge of two triangles in one plane separates them.
fn apart_in_plane(first: &Triangle, second: &Triangle, normal: &Vector3) -> bool {
    let separates = |t: &Triangle, k: usize, other: &Triangle| {
        let axis = normal.cross(&(t[(k + 1) % 3] - t[k]));
        let inner = (t[(k + 2) % 3] - t[k]).dot(&axis);
        let across = other.map(|p| (p - t[k]).dot(&axis) * inner);
        across.iter().all(|s| *s < 0.0)
    };
    (0..3).any(|k| separates(first, k, second) || separates(second, k, first))
}

/// Some axis separates them. All axes that any pair of triangles, segments or points may need; not
/// quick.
fn apart(first: &Triangle, second: &Triangle) -> bool {
    let edges = |t: &Triangle| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let (e, f) = (edges(first), edges(second));
    let normal = |e: &[Vector3; 3]| {
        let n = e[0].cross(&e[1]);
        // A difference within rounding has no direction.
        if n.norm_squared() > 1e-24 * e[0].norm_squared() * e[1].norm_squared() {
            n
        } else {
            Vector3::zeros()
        }
    };
    let (n, m) = (normal(&e), normal(&f));
    let separates = |axis: Vector3| {
        let size = axis.norm();
        if size.is_nan() || size <= 0.0 {
            return false;
        }
        let range = |t: &Triangle| {
            let s = t.map(|p| (p - first[0]).dot(&axis) / size);
            (s[0].min(s[1]).min(s[2]), s[0].max(s[1]).max(s[2]))
        };
        let ((low, high), (from, to)) = (range(first), range(second));
        let noise = 1e-14 * (high - low).max(to - from);
        low > to + noise || from > high + noise
    };
    if separates(n) || separates(m) {
        return true;
    }
    let between = second[0] - first[0];
    for a in &e {
        for b in &f {
            let c = a.cross(b);
            let parallel = c.norm_squared() <= 1e-24 * a.norm_squared() * b.norm_squared();
            if !parallel && (separates(c) || separates(c.cross(a)) || separates(c.cross(b))) {
                return true;
            }
        }
    }
    let rest = |a: &Vector3| between - a * (between.dot(a) / a.norm_squared());
    e.iter()
        .any(|a| separates(n.cross(a)) || separates(*a) || separates(rest(a)))
        || f.iter()
            .any(|a| separates(m.cross(a)) || separates(*a) || separates(rest(a)))
        || separates(between) && e.iter().chain(&f).all(|a| a.norm_squared() <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    /// Brute force: some edge of one goes through the other, by solving three equations for each.
    fn oracle(a: &Triangle, b: &Triangle) -> Option<bool> {
        let (mut sure, mut found) = (true, false);
        for (t, s) in [(a, b), (b, a)] {
            for k in 0..3 {
                let (from, to) = (t[k], t[(k + 1) % 3]);
                let m = palpate_geometry::math::Matrix3::from_columns(&[
                    from - to,
                    s[1] - s[0],
                    s[2] - s[0],
                ]);
                let inverse = m.try_inverse()?;
                let x = inverse * (from - s[0]);
                let slack = [x[0], 1.0 - x[0], x[1], x[2], 1.0 - x[1] - x[2]]
                    .into_iter()
                    .fold(f64::INFINITY, f64::min);
                found |= slack > 0.0;
                sure &= slack.abs() > 1e-9;
            }
        }
        (sure || found).then_some(found)
    }

    fn point(random: &mut Random, size: f64) -> Point3 {
        Point3::new(
            random.float(-size, size),
            random.float(-size, size),
            random.float(-size, size),
        )
    }

    #[test]
    fn meeting_agrees_with_edges_through_faces_on_random_pairs() {
        let mut random = Random(3);
        let mut counts = [0, 0];
        for _ in 0..20_000 {
            let mut three = |size: f64| {
                [
                    point(&mut random, size),
                    point(&mut random, size),
                    point(&mut random, size),
                ]
            };
            let (a, b) = (three(1.0), three(1.0));
            let Some(wanted) = oracle(&a, &b) else {
                continue;
            };
            counts[usize::from(wanted)] += 1;
            for (x, y) in [(a, b), (b, a), ([a[1], a[2], a[0]], [b[2], b[1], b[0]])] {
                assert_eq!(meet(&x, &y), wanted, "{x:?} {y:?}");
            }
        }
        assert!(counts[0] > 4_000 && counts[1] > 2_000, "{counts:?}");
    }

    /// Corners on a small grid of integers: coplanar pairs, shared corners and edges, points on
    /// faces, no area at all. Distances are then 0 or far from it, so an independent minimisation
    /// can tell.
    #[test]
    fn meeting_agrees_with_the_distance_on_degenerate_pairs() {
        let mut random = Random(4);
        let mut counts = [0, 0];
        for k in 0..6_000 {
            let flat = k % 2 == 0;
            let mut corner = || {
                let mut c = || random.integer(0, 3) as f64;
                Point3::new(c(), c(), if flat { 0.0 } else { c() })
            };
            let (a, b) = (
                [corner(), corner(), corner()],
                [corner(), corner(), corner()],
            );
            let wanted = distance(&a, &b) < 1e-6;
            counts[usize::from(wanted)] += 1;
            assert_eq!(meet(&a, &b), wanted, "{a:?} {b:?}: {}", distance(&a, &b));
        }
        assert!(counts[0] > 1_000 && counts[1] > 1_000, "{counts:?}");
    }

    /// Of segments with triangles, all six: the distance along a segment to a convex set is convex,
    /// so thirds close in. And 0 where an edge goes through a face.
    fn distance(a: &Triangle, b: &Triangle) -> f64 {
        let to = |q: Point3, t: &Triangle| {
            let w = nearest(&q, t);
            (q.coords - (t[0].coords * w[0] + t[1].coords * w[1] + t[2].coords * w[2])).norm()
        };
        let mut least = f64::INFINITY;
        for (t, s) in [(a, b), (b, a)] {
            for k in 0..3 {
                let (p, d) = (t[k], t[(k + 1) % 3] - t[k]);
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..60 {
                    let (x, y) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                    if to(p + d * x, s) <= to(p + d * y, s) {
                        high = y
                    } else {
                        low = x
                    }
                }
                for x in [0.0, 1.0, low] {
                    least = least.min(to(p + d * x, s));
                }
            }
        }
        least
    }

    #[test]
    fn the_nearest_point_is_no_farther_than_any_other() {
        let mut random = Random(6);
        for k in 0..3_000 {
            let mut t = [
                point(&mut random, 1.0),
                point(&mut random, 1.0),
                point(&mut random, 1.0),
            ];
            if k % 10 == 0 {
                t[2] = nalgebra::center(&t[0], &t[1]);
            }
            if k % 11 == 0 {
                t[1] = t[0];
            }
            let q = point(&mut random, 2.0);
            let at = |w: [f64; 3]| {
                Point3::from(t[0].coords * w[0] + t[1].coords * w[1] + t[2].coords * w[2])
            };
            let weights = nearest(&q, &t);
            assert!(
                (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12
                    && weights.iter().all(|w| *w >= 0.0)
            );
            let found = (at(weights) - q).norm();
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let w = [f64::from(i) / 40.0, f64::from(j) / 40.0];
                    let other = (at([w[0], w[1], 1.0 - w[0] - w[1]]) - q).norm();
                    assert!(found <= other + 1e-9, "{q} to {t:?}: {found}, but {other}");
                }
            }
        }
    }
}
