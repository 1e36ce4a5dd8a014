//! The shortest vector that several half spaces allow.

use palpate_geometry::math::{Matrix3, Vector3};

/// Vectors x with normal · x ≥ at_least.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    /// Unit normal.
    pub normal: Vector3,
    /// Lower bound of the distance, m.
    pub at_least: f64,
}

/// Adds a half space; of more than `most` only the last ones are kept.
pub(super) fn keep(planes: &mut Vec<HalfSpace>, plane: HalfSpace, most: usize) {
    if planes.len() >= most {
        planes.remove(0);
    }
    planes.push(plane);
}

/// The shortest x in all half spaces, `None` when there is none (or only beyond rounding).
///
/// At most three of them hold it in place, so all sets of up to three are tried: the answer is the
/// shortest of the points of least norm on their planes that the others allow.
pub(super) fn shortest(planes: &[HalfSpace]) -> Option<Vector3> {
    let scale = planes.iter().map(|p| p.at_least.abs()).fold(0.0, f64::max);
    let allowed = |x: &Vector3| {
        planes
            .iter()
            .all(|p| p.normal.dot(x) >= p.at_least - 1e-10 * scale)
    };
    let mut best: Option<Vector3> = Some(Vector3::zeros()).filter(allowed);
    let mut offer = |x: Option<Vector3>| {
        if let Some(x) = x
            .filter(|x| x.iter().all(|c| c.is_finite()))
            .filter(allowed)
            && best.is_none_or(|best| x.norm_squared() < best.norm_squared())
        {
            best = Some(x);
        }
    };
    for (i, a) in planes.iter().enumerate() {
        offer(Some(a.normal * a.at_least));
        for (j, b) in planes.iter().enumerate().take(i) {
            offer(on_two(a, b));
            for c in planes.iter().take(j) {
                offer(on_three(a, b, c));
            }
        }
    }
    best
}

/// x = s n_a + t n_b on both planes.
fn on_two(a: &HalfSpace, b: &HalfSpace) -> Option<Vector3> {
    let cosine = a.normal.dot(&b.normal);
    let determinant = 1.0 - cosine * cosine;
    if determinant < 1e-9 {
        return None;
    }
    let s = (a.at_least - cosine * b.at_least) / determinant;
    let t = (b.at_least - cosine * a.at_least) / determinant;
    Some(a.normal * s + b.normal * t)
}

fn on_three(a: &HalfSpace, b: &HalfSpace, c: &HalfSpace) -> Option<Vector3> {
    let rows = Matrix3::from_rows(&[
        a.normal.transpose(),
        b.normal.transpose(),
        c.normal.transpose(),
    ]);
    if rows.determinant().abs() < 1e-6 {
        return None;
    }
    Some(rows.try_inverse()? * Vector3::new(a.at_least, b.at_least, c.at_least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn planes(random: &mut Random, count: usize) -> Vec<HalfSpace> {
        (0..count)
            .map(|_| {
                let v = Vector3::new(
                    random.float(-1.0, 1.0),
                    random.float(-1.0, 1.0),
                    random.float(-1.0, 1.0),
                );
                HalfSpace {
                    normal: v.normalize(),
                    at_least: random.float(-0.5, 1.0),
                }
            })
            .collect()
    }

    // Karush, Kuhn, Tucker: x is a sum of the normals it rests on, none of them pulling. Checked
    // against Dykstra's alternating projections, which know nothing of sets of three.
    #[test]
    fn the_shortest_vector_is_what_alternating_projections_tend_to() {
        let mut random = Random(11);
        let mut solved = 0;
        for _ in 0..300 {
            let count = random.integer(1, 5);
            let planes = planes(&mut random, count);
            let Some(x) = shortest(&planes) else { continue };
            solved += 1;
            let mut y = Vector3::zeros();
            let mut corrections = vec![Vector3::zeros(); planes.len()];
            for _ in 0..20_000 {
                for (plane, correction) in planes.iter().zip(&mut corrections) {
                    let z = y + *correction;
                    let lack = (plane.at_least - plane.normal.dot(&z)).max(0.0);
                    y = z + plane.normal * lack;
                    *correction = z - y;
                }
            }
            let feasible = planes.iter().all(|p| p.normal.dot(&y) >= p.at_least - 1e-6);
            assert!(
                !feasible || (x - y).norm() < 1e-4 * (1.0 + x.norm()),
                "{x} is not {y} of {planes:?}"
            );
        }
        assert!(solved > 200, "{solved} of 300 had an answer");
    }

    #[test]
    fn half_spaces_that_face_away_from_each_other_have_no_common_vector() {
        let up = HalfSpace {
            normal: Vector3::z(),
            at_least: 1.0,
        };
        let down = HalfSpace {
            normal: -Vector3::z(),
            at_least: 1.0,
        };
        assert_eq!(shortest(&[up, down]), None);
        assert_eq!(shortest(&[]), Some(Vector3::zeros()));
        assert_eq!(shortest(&[up]), Some(Vector3::z()));
    }
}
