//! Are two convex hulls apart? By a direction that separates them.
//!
//! The last tick's direction, the witness, is tried first: one pass over the points. Otherwise GJK
//! (Gilbert, Johnson & Keerthi 1988) looks for another on the difference of the two, which it knows
//! by its farthest points only, so no hull is ever built. "Apart" is said on the strength of a
//! direction that was checked; all doubt counts as "may touch".

use palpate_geometry::math::Vector3;

/// Steps of GJK. Hulls that touch to rounding may need any number; a handful decides all others.
const STEPS: usize = 24;

/// The direction that last separated two hulls, from the second to the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Witness(Vector3);

impl Default for Witness {
    fn default() -> Self {
        Self(Vector3::x())
    }
}

impl Witness {
    /// More than `margin_m` apart. `support`: the point of (first − second) that is farthest along
    /// a unit direction.
    pub fn separates(&mut self, support: impl Fn(&Vector3) -> Vector3, margin_m: f64) -> bool {
        let mut nearest = support(&self.0);
        if nearest.dot(&self.0) < -margin_m {
            return true;
        }
        let mut simplex = Simplex {
            points: [nearest; 4],
            count: 1,
        };
        for _ in 0..STEPS {
            let distance = nearest.norm();
            if distance.is_nan() || distance <= margin_m {
                return false;
            }
            let direction = -nearest / distance;
            let farthest = support(&direction);
            let along = farthest.dot(&direction);
            if along < -margin_m {
                self.0 = direction;
                return true;
            }
            // Nothing lies beyond the nearest point: it is the distance, which is not above the
            // margin.
            if distance + along <= 1e-12 * distance {
                return false;
            }
            simplex.points[simplex.count] = farthest;
            simplex.count += 1;
            match simplex.nearest() {
                Some(point) => nearest = point,
                None => return false,
            }
        }
        false
    }
}

/// Up to four points.
struct Simplex {
    points: [Vector3; 4],
    count: usize,
}

impl Simplex {
    /// The point of the simplex nearest to the origin, and only those corners kept that hold it;
    /// `None` when the origin is inside.
    fn nearest(&mut self) -> Option<Vector3> {
        let p = self.points;
        let mut best: Option<(f64, Vector3, [usize; 3], usize)> = None;
        let mut offer = |point: Vector3, kept: [usize; 3], count: usize| {
            let square = point.norm_squared();
            if best.is_none_or(|(least, ..)| square < least) {
                best = Some((square, point, kept, count));
            }
        };
        // The newest point is part of the answer: faces, edges and the corner at it are enough.
        let last = self.count - 1;
        if last == 3 && inside(&p) {
            return None;
        }
        for a in 0..last {
            for b in 0..a {
                if let Some(point) = on_face(&p[b], &p[a], &p[last]) {
                    offer(point, [b, a, last], 3);
                }
            }
            if let Some(point) = on_edge(&p[a], &p[last]) {
                offer(point, [a, last, 0], 2);
            }
        }
        offer(p[last], [last, 0, 0], 1);
        let (_, point, kept, count) = best?;
        for k in 0..count {
            self.points[k] = p[kept[k]];
        }
        self.count = count;
        Some(point)
    }
}

/// The foot of the origin on an edge, if it falls between the ends.
fn on_edge(a: &Vector3, b: &Vector3) -> Option<Vector3> {
    let ab = b - a;
    let (t, square) = (-a.dot(&ab), ab.norm_squared());
    (t > 0.0 && t < square).then(|| a + ab * (t / square))
}

/// The foot of the origin on a face, if it falls inside.
fn on_face(a: &Vector3, b: &Vector3, c: &Vector3) -> Option<Vector3> {
    let n = (b - a).cross(&(c - a));
    let square = n.norm_squared();
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(p, q)| (*q - *p).cross(&-**p).dot(&n) > 0.0);
    (inside && square > 0.0).then(|| n * (a.dot(&n) / square))
}

/// The origin is in the tetrahedron: on the inner side of each face.
fn inside(p: &[Vector3; 4]) -> bool {
    [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]]
        .iter()
        .all(|&[a, b, c, d]| {
            let n = (p[b] - p[a]).cross(&(p[c] - p[a]));
            let (of_origin, of_other) = (-p[a].dot(&n), (p[d] - p[a]).dot(&n));
            of_origin * of_other > 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn farthest(points: &[Vector3], d: &Vector3) -> Vector3 {
        *points
            .iter()
            .max_by(|a, b| a.dot(d).total_cmp(&b.dot(d)))
            .unwrap()
    }

    // Two boxes, turned alike, at a known distance along one axis of theirs: closed form for the
    // answer.
    #[test]
    fn boxes_are_apart_exactly_when_their_distance_is_above_the_margin() {
        let mut random = Random(9);
        let (mut apart, mut close) = (0, 0);
        for _ in 0..3_000 {
            let mut vector = || {
                Vector3::new(
                    random.float(-1.0, 1.0),
                    random.float(-1.0, 1.0),
                    random.float(-1.0, 1.0),
                )
            };
            let turn = palpate_geometry::math::Rotation::from_scaled_axis(vector() * 2.0);
            let corners = |centre: Vector3| -> Vec<Vector3> {
                (0..8)
                    .map(|k| {
                        centre
                            + Vector3::new(
                                f64::from(k & 1) - 0.5,
                                f64::from(k >> 1 & 1) - 0.5,
                                f64::from(k >> 2) - 0.5,
                            )
                    })
                    .map(|p| turn * p)
                    .collect()
            };
            let offset = vector() * 2.0;
            let (a, b) = (corners(offset), corners(Vector3::zeros()));
            let gap = offset.map(|x| (x.abs() - 1.0).max(0.0)).norm();
            let margin = 0.1;
            if (gap - margin).abs() < 1e-9 {
                continue;
            }
            let mut witness = Witness::default();
            let support = |d: &Vector3| farthest(&a, d) - farthest(&b, &-d);
            let answer = witness.separates(support, margin);
            assert_eq!(answer, gap > margin, "offset {offset}: gap {gap}");
            if answer {
                assert!(
                    support(&witness.0).dot(&witness.0) < -margin,
                    "the witness holds"
                );
                apart += 1;
            } else {
                close += 1;
            }
        }
        assert!(apart > 300 && close > 300, "{apart} {close}");
    }

    #[test]
    fn no_answer_is_a_no() {
        let nan = |_: &Vector3| Vector3::repeat(f64::NAN);
        assert!(!Witness::default().separates(nan, 0.0));
        assert!(!Witness::default().separates(|_| Vector3::zeros(), 0.0));
    }
}
