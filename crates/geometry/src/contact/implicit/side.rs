//! The smooth sides of shapes that are given by sizes.

use super::shape::ImplicitShape;
use crate::math::{Point3, Vector3};

/// A side that goes on beyond its edges, in the tool's frame; axes are along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    /// Of a ball.
    Ball { radius_m: f64 },
    /// Of a bar without end.
    Bar { radius_m: f64 },
    /// Of a cone whose tip is the origin: cosine and sine of half its angle.
    Slope { cos: f64, sin: f64 },
    /// Of a ring.
    Ring { major_m: f64, minor_m: f64 },
    /// Across an axis, so far from the origin, up or down it.
    Flat {
        axis: usize,
        sign: f64,
        offset_m: f64,
    },
}

impl Side {
    /// Height of a point above the side, m, and the unit way up.
    pub fn gap(&self, p: &Point3) -> (f64, Vector3) {
        match *self {
            Self::Ball { radius_m } => {
                let (length_m, up) = from_axis(p.coords);
                (length_m - radius_m, up)
            }
            Self::Bar { radius_m } => {
                let (length_m, up) = from_axis(Vector3::new(p.x, p.y, 0.0));
                (length_m - radius_m, up)
            }
            Self::Slope { cos, sin } => {
                let (length_m, out) = from_axis(Vector3::new(p.x, p.y, 0.0));
                (length_m * cos - p.z * sin, out * cos - Vector3::z() * sin)
            }
            Self::Ring { major_m, minor_m } => {
                let (length_m, out) = from_axis(Vector3::new(p.x, p.y, 0.0));
                let (away_m, up) = from_axis(out * (length_m - major_m) + Vector3::z() * p.z);
                (away_m - minor_m, up)
            }
            Self::Flat {
                axis,
                sign,
                offset_m,
            } => {
                let mut up = Vector3::zeros();
                up[axis] = sign;
                (p[axis] * sign - offset_m, up)
            }
        }
    }
}

/// Length and direction; on the axis itself, that of x.
fn from_axis(way: Vector3) -> (f64, Vector3) {
    let length_m = way.norm();
    let direction = if length_m > 0.0 {
        way / length_m
    } else {
        Vector3::x()
    };
    (length_m, direction)
}

impl ImplicitShape {
    /// The sides whose gaps' greatest is the shape's function; none where that is no distance.
    pub(super) fn sides(&self) -> Vec<Side> {
        let flat = |axis, sign, offset_m| Side::Flat {
            axis,
            sign,
            offset_m,
        };
        match *self {
            Self::Sphere { radius_m } => vec![Side::Ball { radius_m }],
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => {
                let ends = half_length_m.iter();
                let ends = ends.flat_map(|&half| [flat(2, 1.0, half), flat(2, -1.0, half)]);
                std::iter::once(Side::Bar { radius_m })
                    .chain(ends)
                    .collect()
            }
            Self::Cone {
                half_angle_rad,
                height_m,
            } => {
                let (sin, cos) = (libm::sin(half_angle_rad), libm::cos(half_angle_rad));
                vec![Side::Slope { cos, sin }, flat(2, 1.0, height_m)]
            }
            Self::Torus {
                major_radius_m: major_m,
                minor_radius_m: minor_m,
            } => vec![Side::Ring { major_m, minor_m }],
            Self::Box { half_extents_m } => (0..3)
                .flat_map(|axis| [1.0, -1.0].map(|sign| flat(axis, sign, half_extents_m[axis])))
                .collect(),
            Self::Ellipsoid { .. } | Self::Expression { .. } => Vec::new(),
        }
    }
}
