//! The surfaces that faces lie on: planes, cylinders, cones, spheres, tori, with their parameters and feet in closed form,
//! and B-splines.

use crate::math::{Point3, Vector3};
use crate::surface::Surface;
use std::f64::consts::TAU;

/// Where an elementary surface or curve lies: an origin and three unit vectors, right-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// m.
    pub origin: Point3,
    /// Where angles begin.
    pub x: Vector3,
    /// z × x.
    pub y: Vector3,
    /// The axis, or the normal of a plane.
    pub z: Vector3,
}

impl Axes {
    /// At a point, with an axis and roughly an x direction; `None` where the axis has no length. An x along the axis, or none,
    /// is replaced.
    pub fn new(origin: Point3, axis: &Vector3, about: Option<&Vector3>) -> Option<Self> {
        let z = axis.try_normalize(f64::MIN_POSITIVE)?;
        let across = |v: &Vector3| (v - z * z.dot(v)).try_normalize(1e-9 * v.norm());
        let least = z.iamin();
        let x = about.and_then(across);
        let x = x.or_else(|| across(&Vector3::ith(least, 1.0)))?;
        Some(Self {
            origin,
            x,
            y: z.cross(&x),
            z,
        })
    }

    /// A point's coordinates along the three axes, m.
    pub fn to_local(&self, point: &Point3) -> Vector3 {
        let d = point - self.origin;
        Vector3::new(self.x.dot(&d), self.y.dot(&d), self.z.dot(&d))
    }

    /// A direction given along the three axes.
    pub fn direction(&self, local: &Vector3) -> Vector3 {
        self.x * local.x + self.y * local.y + self.z * local.z
    }

    /// The point at coordinates along the three axes, m.
    pub fn to_world(&self, local: &Vector3) -> Point3 {
        self.origin + self.direction(local)
    }
}

/// An unbounded surface that a face is a part of. Its parameters are lengths (m) and angles (rad).
#[derive(Clone, Debug, PartialEq)]
pub enum Carrier {
    /// u along x, v along y; the normal is z.
    Plane(Axes),
    /// u an angle, v a length along z; the normal points away from the axis, as for those below.
    Cylinder {
        /// z is the axis.
        axes: Axes,
        /// m.
        radius_m: f64,
    },
    /// The nappe above the apex, which is the origin: u an angle, v the height above it.
    Cone {
        /// z is the axis, into the nappe.
        axes: Axes,
        /// Between the axis and the lines through the apex, rad; within (0, π/2).
        half_angle_rad: f64,
    },
    /// u the longitude, v the latitude.
    Sphere {
        /// At the centre.
        axes: Axes,
        /// m.
        radius_m: f64,
    },
    /// u the angle about z, v the angle about the tube's centre line, 0 on the outside.
    Torus {
        /// z is the axis.
        axes: Axes,
        /// Of the tube's centre line, m.
        major_m: f64,
        /// Of the tube, m. Where it is the greater one, the outer part of the surface is meant.
        minor_m: f64,
    },
    /// A B-spline or NURBS surface with its own parameters; the normal is that of its parametrisation, S_u × S_v.
    Spline(Box<Surface>),
}

impl Carrier {
    /// As files call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Spline(_) => "b-spline",
        }
    }

    /// Periods of u and v; 0 where there is none. A B-spline that closes on itself has the length of its domain.
    pub fn periods(&self) -> [f64; 2] {
        match self {
            Self::Plane(_) => [0.0, 0.0],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [TAU, 0.0],
            Self::Torus { .. } => [TAU, TAU],
            Self::Spline(surface) => {
                let (u, v) = (surface.knots_u(), surface.knots_v());
                let ends = |knots: &crate::basis::KnotVector| {
                    let domain = knots.domain();
                    domain.1 - domain.0
                };
                let [closed_u, closed_v] = closed(surface);
                [
                    if closed_u { ends(u) } else { 0.0 },
                    if closed_v { ends(v) } else { 0.0 },
                ]
            }
        }
    }
}

/// Whether a surface meets itself in u and in v: by its knots, or because its first and last lines agree.
pub(super) fn closed(surface: &Surface) -> [bool; 2] {
    let points = surface.net().points();
    let far_m = points.iter().map(|p| (p - points[0]).norm());
    let close_m = 1e-9 * far_m.fold(0.0, f64::max);
    let same = |a: (f64, f64), b: (f64, f64)| {
        (surface.point(a.0, a.1) - surface.point(b.0, b.1)).norm() <= close_m
    };
    let (u, v) = (surface.knots_u(), surface.knots_v());
    let ((u0, u1), (v0, v1)) = (u.domain(), v.domain());
    let steps = || (0..=16).map(|k| f64::from(k) / 16.0);
    [
        u.is_periodic()
            || steps().all(|s| same((u0, v0 + s * (v1 - v0)), (u1, v0 + s * (v1 - v0)))),
        v.is_periodic()
            || steps().all(|s| same((u0 + s * (u1 - u0), v0), (u0 + s * (u1 - u0), v1))),
    ]
}
