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

    /// As [`Self::new`], but directions that have length 1 and are at right angles, to rounding, stay as they are to the last
    /// bit.
    pub(crate) fn exactly(origin: Point3, z: &Vector3, x: &Vector3) -> Option<Self> {
        if !(is_unit(z) && is_unit(x) && z.dot(x).abs() <= UNIT) {
            return Self::new(origin, z, Some(x));
        }
        Some(Self {
            origin,
            x: *x,
            y: z.cross(x),
            z: *z,
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

/// What rounding makes of the squared length of a unit vector.
const UNIT: f64 = 8.0 * f64::EPSILON;

/// Its length is 1 to rounding.
pub(crate) fn is_unit(v: &Vector3) -> bool {
    (v.norm_squared() - 1.0).abs() <= UNIT
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
            Self::Torus {
                major_m, minor_m, ..
            } if minor_m > major_m => [TAU, 0.0],
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

/// Whether a surface closes in u and in v: by its knots, or because its first and last lines coincide.
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

impl Carrier {
    /// What an elementary surface is laid along; `None` for B-splines.
    pub(super) fn axes(&self) -> Option<&Axes> {
        match self {
            Self::Plane(axes)
            | Self::Cylinder { axes, .. }
            | Self::Cone { axes, .. }
            | Self::Sphere { axes, .. }
            | Self::Torus { axes, .. } => Some(axes),
            Self::Spline(_) => None,
        }
    }

    /// S(u, v), m.
    pub fn point(&self, [u, v]: [f64; 2]) -> Point3 {
        let (sin, cos) = libm::sincos(u);
        let round = |axes: &Axes, r: f64, z: f64| axes.to_world(&Vector3::new(r * cos, r * sin, z));
        match self {
            Self::Plane(axes) => axes.to_world(&Vector3::new(u, v, 0.0)),
            Self::Cylinder { axes, radius_m } => round(axes, *radius_m, v),
            Self::Cone {
                axes,
                half_angle_rad,
            } => round(axes, v * libm::tan(*half_angle_rad), v),
            Self::Sphere { axes, radius_m } => {
                let (up, out) = libm::sincos(v);
                round(axes, radius_m * out, radius_m * up)
            }
            Self::Torus {
                axes,
                major_m,
                minor_m,
            } => {
                let (up, out) = libm::sincos(v);
                round(axes, major_m + minor_m * out, minor_m * up)
            }
            Self::Spline(surface) => surface.point(u, v),
        }
    }

    /// Unit normal of the carrier at (u, v).
    pub fn normal(&self, [u, v]: [f64; 2]) -> Vector3 {
        let (sin, cos) = libm::sincos(u);
        let round = |axes: &Axes, out: f64, up: f64| {
            axes.direction(&Vector3::new(out * cos, out * sin, up))
        };
        match self {
            Self::Plane(axes) => axes.z,
            Self::Cylinder { axes, .. } => round(axes, 1.0, 0.0),
            Self::Cone {
                axes,
                half_angle_rad,
            } => {
                let (sin, cos) = libm::sincos(*half_angle_rad);
                round(axes, cos, -sin)
            }
            Self::Sphere { axes, .. } | Self::Torus { axes, .. } => {
                let (up, out) = libm::sincos(v);
                round(axes, out, up)
            }
            Self::Spline(surface) => {
                let normal = tip_normal(surface, [u, v]).unwrap_or_else(|| surface.normal(u, v));
                if surface.flip_normal() {
                    -normal
                } else {
                    normal
                }
            }
        }
    }

    /// The foot of a point on an elementary surface: the only minimum of the distance, except on an axis or at a centre,
    /// where it is one of equal ones. `None` for B-splines, and where the nearest point of a cone is its apex or that of a
    /// self-crossing torus on its axis.
    pub fn foot(&self, point: &Point3) -> Option<[f64; 2]> {
        let local = self.axes()?.to_local(point);
        let rho = libm::hypot(local.x, local.y);
        let u = || libm::atan2(local.y, local.x);
        match self {
            Self::Plane(_) => Some([local.x, local.y]),
            Self::Cylinder { .. } => Some([u(), local.z]),
            Self::Cone { half_angle_rad, .. } => {
                let (sin, cos) = libm::sincos(*half_angle_rad);
                let v = (rho * sin + local.z * cos) * cos;
                (v >= 0.0).then(|| [u(), v])
            }
            Self::Sphere { .. } => Some([u(), libm::atan2(local.z, rho)]),
            Self::Torus {
                major_m, minor_m, ..
            } => {
                let v = libm::atan2(local.z, rho - major_m);
                (major_m + minor_m * libm::cos(v) >= 0.0).then(|| [u(), v])
            }
            Self::Spline(_) => None,
        }
    }
}

impl Carrier {
    /// Whether a place of the surface may be nearer than the root of `ceiling` (m²); rounding counts as nearer.
    pub(super) fn may_be_within(&self, point: &Point3, ceiling: f64) -> bool {
        let floor_m = self.distance_floor_m(point);
        floor_m * floor_m * (1.0 - 1e-9) <= ceiling
    }

    /// No place of the surface is nearer than this, m: the distance of the foot on planes, cylinders, spheres and tori, to
    /// rounding; 0 on others.
    fn distance_floor_m(&self, point: &Point3) -> f64 {
        let Some(axes) = self.axes() else {
            return 0.0;
        };
        let local = axes.to_local(point);
        let rho = || (local.x * local.x + local.y * local.y).sqrt();
        match self {
            Self::Plane(_) => local.z.abs(),
            Self::Cylinder { radius_m, .. } => (rho() - radius_m).abs(),
            Self::Sphere { radius_m, .. } => (local.norm() - radius_m).abs(),
            Self::Torus {
                major_m, minor_m, ..
            } => {
                let out = rho() - major_m;
                ((out * out + local.z * local.z).sqrt() - minor_m).abs()
            }
            Self::Cone { .. } | Self::Spline(_) => 0.0,
        }
    }

    /// Places at which a box around the face may touch it away from its edges: where the normal is along an axis of the
    /// world. None on surfaces that are straight in one direction, which lie between their edges.
    pub(super) fn summits(&self) -> Vec<[f64; 2]> {
        let (Self::Sphere { axes, .. } | Self::Torus { axes, .. }) = self else {
            return Vec::new();
        };
        let mut all = Vec::new();
        for k in 0..3 {
            for sign in [1.0, -1.0] {
                let d = Vector3::ith(k, sign);
                let [x, y, z] = [axes.x.dot(&d), axes.y.dot(&d), axes.z.dot(&d)];
                let rho = libm::hypot(x, y);
                all.push([libm::atan2(y, x), libm::atan2(z, rho)]);
                if matches!(self, Self::Torus { .. }) {
                    all.push([libm::atan2(-y, -x), libm::atan2(z, -rho)]);
                }
            }
        }
        all
    }

    /// Where the surface ends in a point: its place, the mean of the normals around it, and its v.
    pub(super) fn apexes(&self) -> Vec<(Point3, Vector3, f64)> {
        match self {
            Self::Cone { axes, .. } => vec![(axes.origin, -axes.z, 0.0)],
            Self::Torus {
                axes,
                major_m,
                minor_m,
            } if minor_m > major_m => {
                let v = libm::acos(-major_m / minor_m);
                let up = axes.z * (minor_m * libm::sin(v));
                vec![
                    (axes.origin + up, axes.z, v),
                    (axes.origin - up, -axes.z, -v),
                ]
            }
            _ => Vec::new(),
        }
    }
}

/// Of the range of a parameter: nearer than this to a pole is at it.
const AT_POLE: f64 = 1e-9;
/// Normals around a pole that differ by more are those of a tip.
const SHARP: f64 = 1e-6;

/// At a pole where a B-spline comes to a tip: the mean of the normals around it, as of the apex of a cone. Those of single
/// parameters point away from places that see the tip from the other side.
fn tip_normal(surface: &Surface, uv: [f64; 2]) -> Option<Vector3> {
    let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
    let end = |k: usize| {
        let (low, high) = domain[k];
        let near = AT_POLE * (high - low);
        [low, high]
            .into_iter()
            .find(|end| (uv[k] - end).abs() <= near)
    };
    (0..2).find_map(|k| {
        let end = end(k)?;
        let (low, high) = domain[1 - k];
        let place = |share: f64| {
            let along = low + share * (high - low);
            if k == 0 { [end, along] } else { [along, end] }
        };
        let shares = (0..8).map(|i| f64::from(i) / 8.0);
        let first = surface.point(place(0.0)[0], place(0.0)[1]);
        let close_m = AT_POLE * surface.size();
        let is_point = (shares.clone().skip(1)).all(|share| {
            (surface.point(place(share)[0], place(share)[1]) - first).norm() <= close_m
        });
        if !is_point {
            return None;
        }
        let normals: Vec<Vector3> = shares
            .map(|share| surface.normal(place(share)[0], place(share)[1]))
            .collect();
        let sharp = normals.iter().any(|n| (n - normals[0]).norm() > SHARP);
        let mean: Vector3 = normals.iter().sum();
        if sharp {
            mean.try_normalize(SHARP)
        } else {
            None
        }
    })
}

impl Carrier {
    /// Where a B-spline ends, and is more than a pole: at the start and the end of u and of v.
    pub(super) fn rims(&self) -> [[bool; 2]; 2] {
        let Self::Spline(surface) = self else {
            return [[false; 2]; 2];
        };
        let periods = self.periods();
        let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
        let points = surface.net().points();
        let far_m = points.iter().map(|p| (p - points[0]).norm());
        let close_m = 1e-9 * far_m.fold(0.0, f64::max);
        std::array::from_fn(|k| {
            let (low, high) = domain[1 - k];
            [domain[k].0, domain[k].1].map(|end| {
                let at = |s: f64| {
                    let along = low + s * (high - low);
                    if k == 0 {
                        surface.point(end, along)
                    } else {
                        surface.point(along, end)
                    }
                };
                let is_pole = || {
                    [0.3, 0.6, 0.9]
                        .iter()
                        .all(|&s| (at(s) - at(0.0)).norm() <= close_m)
                };
                periods[k] == 0.0 && !is_pole()
            })
        })
    }

    /// A place of a B-spline is where it ends, by [`Carrier::rims`].
    pub(super) fn is_on_rim(&self, rims: &[[bool; 2]; 2], uv: [f64; 2]) -> bool {
        let Self::Spline(surface) = self else {
            return false;
        };
        let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
        (0..2).any(|k| rims[k][0] && uv[k] <= domain[k].0 || rims[k][1] && uv[k] >= domain[k].1)
    }
}
