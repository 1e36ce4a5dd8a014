//! Surfaces that need no file. Closed ones have their normals outwards.
//!
//! | name | what | size | net unless given |
//! |---|---|---|---|
//! | `teardrop` | a bent drop along +z, bicubic, seam in u, poles at both ends of v; nets 8×8, 12×12 and 20×20 | length | 8×8 |
//! | `sheet` | a square in z = 0 about the origin, normal +z, bicubic, S affine in (u, v) | side | 8×8 |
//! | `sphere` | an exact sphere about the origin, rational biquadratic, seam in u, poles at both ends of v | radius | 8×5 |
//! | `torus` | about the z axis, periodic bicubic through points of the exact one; small radius 0.4 × great | great radius | 16×12 |
//!
//! Nets count distinct control points except for the teardrop, whose rows include the seam's
//! double. A sphere finer than 8×5 is the same sphere refined.

use super::{ControlNet, FileError, Surface, SurfaceError, file};
use crate::basis::KnotVector;
use crate::math::Point3;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// The names that [`builtin`] knows.
pub const BUILTINS: [&str; 4] = ["sheet", "sphere", "teardrop", "torus"];

/// Most control points in one direction of a builtin's net.
const MAX_COUNT: usize = 512;

/// Small radius of the torus over its great one.
const TORUS_RATIO: f64 = 0.4;

/// Why a builtin surface was not made.
#[derive(Debug, thiserror::Error)]
pub enum BuiltinError {
    /// Unknown name.
    #[error("no builtin surface is called \"{0}\"; there are sheet, sphere, teardrop and torus")]
    Name(String),
    /// A net it does not come with.
    #[error("{name} has no net of {} × {}; {allowed}", net[0], net[1])]
    Net {
        /// Name of the builtin surface.
        name: &'static str,
        /// Net asked for.
        net: [usize; 2],
        /// What there is.
        allowed: &'static str,
    },
    /// A size that is not a positive finite number.
    #[error("size of {name} is {size_m}; it is a length in m, above 0")]
    Size {
        /// Name of the builtin surface.
        name: &'static str,
        /// Size asked for.
        size_m: f64,
    },
    /// The data of a builtin.
    #[error(transparent)]
    File(#[from] FileError),
    /// The values of a builtin.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

/// A builtin surface; net and size (m) default as in the table above.
///
/// # Errors
/// Unknown name, a net the builtin does not have, or a size that is not positive.
pub fn builtin(
    name: &str,
    net: Option<[usize; 2]>,
    size_m: Option<f64>,
) -> Result<Surface, BuiltinError> {
    let (name, default_m) = match name {
        "teardrop" => ("teardrop", 0.1),
        "sheet" => ("sheet", 0.1),
        "sphere" => ("sphere", 0.05),
        "torus" => ("torus", 0.05),
        _ => return Err(BuiltinError::Name(name.to_owned())),
    };
    let size_m = size_m.unwrap_or(default_m);
    // Squares and cubes of it must stay numbers too.
    if !(1e-9..=1e9).contains(&size_m) {
        return Err(BuiltinError::Size { name, size_m });
    }
    match name {
        "teardrop" => teardrop(net.unwrap_or([8, 8]), size_m),
        "sheet" => sheet(net.unwrap_or([8, 8]), size_m),
        "sphere" => sphere(net.unwrap_or([8, 5]), size_m),
        _ => torus(net.unwrap_or([16, 12]), size_m),
    }
}

fn teardrop(net: [usize; 2], length_m: f64) -> Result<Surface, BuiltinError> {
    let json = match net {
        [8, 8] => include_str!("data/teardrop_8.json"),
        [12, 12] => include_str!("data/teardrop_12.json"),
        [20, 20] => include_str!("data/teardrop_20.json"),
        _ => {
            return Err(BuiltinError::Net {
                name: "teardrop",
                net,
                allowed: "there are 8 × 8, 12 × 12 and 20 × 20",
            });
        }
    };
    let drop = file::read(json)?;
    // The data is 0.1 m long: that size stays as it is, bit for bit.
    let drop = if length_m == 0.1 {
        drop
    } else {
        drop.scaled(length_m / 0.1)
    };
    Ok(drop.with_exact_seams())
}

fn sheet(net: [usize; 2], side_m: f64) -> Result<Surface, BuiltinError> {
    if !net.iter().all(|count| (4..=MAX_COUNT).contains(count)) {
        return Err(BuiltinError::Net {
            name: "sheet",
            net,
            allowed: "each direction has 4 to 512",
        });
    }
    let (u, v) = (
        knots(KnotVector::clamped_uniform(3, net[0]), 'u')?,
        knots(KnotVector::clamped_uniform(3, net[1]), 'v')?,
    );
    // Control points at the Greville abscissae make S affine in (u, v).
    let (x, y) = (u.greville(), v.greville());
    let at = |g: f64| (g - 0.5) * side_m;
    let points = x
        .iter()
        .flat_map(|&x| y.iter().map(move |&y| Point3::new(at(x), at(y), 0.0)))
        .collect();
    surface(u, v, points, None)
}

/// A half circle in the xz plane, from the south pole to the north, turned about z; each arc of 90°
/// has the middle weight cos 45° (Piegl & Tiller, §7.5 and §8.5).
fn sphere(net: [usize; 2], radius_m: f64) -> Result<Surface, BuiltinError> {
    if !(8..=MAX_COUNT).contains(&net[0]) || !(5..=MAX_COUNT).contains(&net[1]) {
        return Err(BuiltinError::Net {
            name: "sphere",
            net,
            allowed: "it has 8 to 512 around and 5 to 512 up",
        });
    }
    let around = vec![
        0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0,
    ];
    let up = vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0];
    let (u, v) = (
        knots(KnotVector::new(2, around), 'u')?,
        knots(KnotVector::new(2, up), 'v')?,
    );
    const SQUARE: [[f64; 2]; 9] = [
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
    ];
    const HALF: [[f64; 2]; 5] = [[0.0, -1.0], [1.0, -1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corner = |k: usize| if k % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
    let mut points = Vec::with_capacity(45);
    let mut weights = Vec::with_capacity(45);
    for (i, [x, y]) in SQUARE.into_iter().enumerate() {
        for (j, [rho, z]) in HALF.into_iter().enumerate() {
            points.push(Point3::new(x * rho, y * rho, z) * radius_m);
            weights.push(corner(i) * corner(j));
        }
    }
    Ok(surface(u, v, points, Some(weights))?.refined_to(net[0], net[1])?)
}

fn torus(net: [usize; 2], great_m: f64) -> Result<Surface, BuiltinError> {
    if !net.iter().all(|count| (4..=MAX_COUNT).contains(count)) {
        return Err(BuiltinError::Net {
            name: "torus",
            net,
            allowed: "each direction has 4 to 512",
        });
    }
    let (u, v) = (
        knots(KnotVector::periodic_uniform(3, net[0]), 'u')?,
        knots(KnotVector::periodic_uniform(3, net[1]), 'v')?,
    );
    // A uniform cubic has (P₋ + 4 P + P₊) / 6 at its knots: control points on a circle give one
    // smaller by (2 + cos h) / 3, so this net's surface goes through the exact torus at all pairs
    // of knots.
    let ring = |count: usize| -> Vec<[f64; 2]> {
        let step = TAU / count as f64;
        let radius = 3.0 / (2.0 + libm::cos(step));
        (0..count)
            .map(|k| {
                [
                    radius * libm::cos(step * k as f64),
                    radius * libm::sin(step * k as f64),
                ]
            })
            .collect()
    };
    let (around, small) = (ring(net[0]), ring(net[1]));
    let mut points = Vec::with_capacity(net[0] * net[1]);
    for [x, y] in around {
        for [rho, z] in &small {
            let distance = 1.0 + TORUS_RATIO * rho;
            points.push(Point3::new(x * distance, y * distance, TORUS_RATIO * z) * great_m);
        }
    }
    surface(u, v, points, None)
}

fn knots(
    knots: Result<KnotVector, crate::basis::KnotError>,
    direction: char,
) -> Result<KnotVector, SurfaceError> {
    knots.map_err(|source| SurfaceError::Knots { direction, source })
}

fn surface(
    u: KnotVector,
    v: KnotVector,
    points: Vec<Point3>,
    weights: Option<Vec<f64>>,
) -> Result<Surface, BuiltinError> {
    let net = ControlNet::new(u.count(), v.count(), points).map_err(SurfaceError::from)?;
    Ok(Surface::new(u, v, net, weights)?.oriented_outward())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_is_there_with_the_size_asked_for_and_normals_out() {
        for name in BUILTINS {
            let surface = builtin(name, None, None).unwrap();
            let large = builtin(name, None, Some(1.0)).unwrap();
            assert!(large.size() > 5.0 * surface.size(), "{name}");
            if name != "sheet" {
                assert!(
                    surface.topology().is_closed() && surface.volume() > 0.0,
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn a_teardrop_is_as_long_as_asked_in_all_its_nets() {
        for count in [8, 12, 20] {
            for length in [0.1, 0.25] {
                let drop = builtin("teardrop", Some([count; 2]), Some(length)).unwrap();
                let (low, high) = (drop.net().at(0, 0).z, drop.net().at(0, count - 1).z);
                assert!(
                    (high - low - length).abs() < 1e-15,
                    "{count}: {low} to {high}"
                );
                assert_eq!(drop.clone().with_exact_seams(), drop);
                for i in 0..count {
                    assert_eq!(drop.net().at(i, 0), drop.net().at(0, 0));
                    assert_eq!(drop.net().at(i, count - 1), drop.net().at(0, count - 1));
                    assert_eq!(drop.net().at(0, i), drop.net().at(count - 1, i));
                }
            }
        }
    }

    #[test]
    fn every_point_of_the_sphere_is_at_its_radius() {
        for net in [[8, 5], [13, 9]] {
            let sphere = builtin("sphere", Some(net), Some(0.2)).unwrap();
            assert_eq!(sphere.distinct_counts(), net);
            for k in 0..2000 {
                let (u, v) = (f64::from(k) * 0.618 % 1.0, f64::from(k) / 1999.0);
                let error = sphere.point(u, v).coords.norm() / 0.2 - 1.0;
                assert!(error.abs() < 1e-14, "({u}, {v}) is off by {error} radii");
            }
        }
    }

    #[test]
    fn the_sheet_is_affine_in_its_parameters() {
        let sheet = builtin("sheet", Some([6, 9]), Some(0.3)).unwrap();
        for k in 0..500 {
            let (u, v) = (f64::from(k) * 0.618 % 1.0, f64::from(k) / 499.0);
            let wanted = Point3::new((u - 0.5) * 0.3, (v - 0.5) * 0.3, 0.0);
            assert!((sheet.point(u, v) - wanted).norm() < 1e-15, "({u}, {v})");
        }
        let frame = sheet.frame(0.3, 0.4);
        assert!(frame.du.cross(&frame.dv).z > 0.0);
    }

    #[test]
    fn the_torus_goes_through_the_exact_one_at_its_knots_and_stays_near_it_between() {
        let torus = builtin("torus", None, Some(1.0)).unwrap();
        let distance = |u: f64, v: f64| {
            let p = torus.point(u, v);
            (p.x.hypot(p.y) - 1.0).hypot(p.z) - TORUS_RATIO
        };
        for i in 0..16 {
            for j in 0..12 {
                let (u, v) = (f64::from(i) / 16.0, f64::from(j) / 12.0);
                assert!(distance(u, v).abs() < 1e-15);
                // A cubic misses a circle by about h⁴ / 384 radii between its knots: here 3e-4.
                assert!(distance(u + 0.5 / 16.0, v + 0.5 / 12.0).abs() < 3e-4);
            }
        }
    }

    #[test]
    fn what_does_not_exist_is_refused_with_what_does() {
        let message = |name, net, size| builtin(name, net, size).unwrap_err().to_string();
        let unknown = message("cube", None, None);
        assert!(
            BUILTINS.iter().all(|name| unknown.contains(name)),
            "{unknown}"
        );
        assert_eq!(
            message("teardrop", Some([9, 9]), None),
            "teardrop has no net of 9 × 9; there are 8 × 8, 12 × 12 and 20 × 20"
        );
        for name in ["sheet", "sphere", "torus"] {
            for net in [[0, 8], [8, 3], [1000, 8]] {
                assert!(
                    matches!(
                        builtin(name, Some(net), None),
                        Err(BuiltinError::Net { .. })
                    ),
                    "{name} {net:?}"
                );
            }
        }
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(
                    builtin("sheet", None, Some(size)),
                    Err(BuiltinError::Size { .. })
                ),
                "{size}"
            );
        }
    }
}
