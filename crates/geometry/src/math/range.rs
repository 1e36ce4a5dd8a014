//! The coordinates that everything here can calculate with.

use super::{Point3, Vector3};

/// Largest coordinate, m: a few times the distance to Jupiter. Powers and products of smaller ones, as areas, moments
/// and curvatures are made of, stay far from the largest number there is.
pub const MOST_COORDINATE_M: f64 = 1e12;

/// The first point with a coordinate that is not a number within ±[`MOST_COORDINATE_M`], and that coordinate.
/// Constructors of nets, curves, meshes and clouds ask it, so that what readers make of a file's numbers is
/// finite, and stays so in whatever is computed of it.
pub fn first_outside(points: &[Point3]) -> Option<(usize, f64)> {
    // Not a number is not within anything.
    let outside = |x: &&f64| !(-MOST_COORDINATE_M..=MOST_COORDINATE_M).contains(*x);
    let of = |(k, point): (usize, &Point3)| Some((k, *point.iter().find(outside)?));
    points.iter().enumerate().find_map(of)
}

/// The direction of a vector of any length above 0, also one whose square is 0 or infinite. `None` for zero, and for
/// what is not finite.
pub fn direction_of(v: &Vector3) -> Option<Vector3> {
    let plain = |v: &Vector3| v.norm_squared().is_normal().then(|| v.normalize());
    let largest = v.amax();
    if !(largest > 0.0 && v.iter().all(|x| x.is_finite())) {
        return None;
    }
    plain(v).or_else(|| plain(&(v / largest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_too_far_is_named_and_all_else_passes() {
        let at = |z: f64| [Point3::origin(), Point3::new(1.0, -MOST_COORDINATE_M, z)];
        for good in [0.0, -0.0, 5e-324, -1e12, 1e12] {
            assert_eq!(first_outside(&at(good)), None, "{good}");
        }
        for bad in [f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e155, 1.001e12] {
            assert_eq!(first_outside(&at(bad)), Some((1, bad)));
        }
        assert!(first_outside(&at(f64::NAN)).is_some_and(|(k, x)| k == 1 && x.is_nan()));
        assert_eq!(first_outside(&[]), None);
    }

    #[test]
    fn a_direction_does_not_depend_on_the_length_however_short_or_long() {
        let along = Vector3::new(1.0, -2.0, 2.0);
        for length in [1e-323, 1e-200, 1.0, 1e155, 8e307] {
            let direction = direction_of(&(along * length)).unwrap();
            let slack = if length < 1e-300 { 1e-1 } else { 1e-15 };
            assert!(
                (direction - along / 3.0).norm() < slack,
                "{length}: {direction}"
            );
            assert!((direction.norm() - 1.0).abs() < 1e-15, "{length}");
        }
        for none in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(direction_of(&Vector3::new(none, 0.0, 0.0)), None);
        }
    }
}
