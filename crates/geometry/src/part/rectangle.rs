//! Rectangles of elementary carriers as rational B-splines, point for point.

use super::carrier::Carrier;
use crate::basis::KnotVector;
use crate::math::{Point3, Vector3};
use crate::surface::{ControlNet, Surface, SurfaceError};
use std::f64::consts::FRAC_PI_2;

/// A direction of a patch: degree, knots, and what each control point stands for with its weight. Angles are those at which
/// the tangents of an arc cross.
struct Axis {
    degree: usize,
    knots: Vec<f64>,
    places: Vec<(f64, f64)>,
}

impl Axis {
    fn line([a, b]: [f64; 2]) -> Self {
        Self {
            degree: 1,
            knots: vec![a, a, b, b],
            places: vec![(a, 1.0), (b, 1.0)],
        }
    }

    /// Arcs of a quarter turn at most.
    fn arcs([a, b]: [f64; 2]) -> Self {
        let count = ((b - a) / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let at = |k: f64| {
            if k < count {
                a + (b - a) * (k / count)
            } else {
                b
            }
        };
        let weight = libm::cos(0.5 * (b - a) / count);
        let (mut knots, mut places) = (vec![a; 3], vec![(a, 1.0)]);
        for k in 0..count as usize {
            let (from, to) = (at(k as f64), at(k as f64 + 1.0));
            knots.extend([to; 2]);
            places.extend([(0.5 * (from + to), weight), (to, 1.0)]);
        }
        knots.push(b);
        Self {
            degree: 2,
            knots,
            places,
        }
    }
}

impl Carrier {
    /// The surface over a rectangle of its parameters. At the knots, which are the ends of the rectangle and those of quarter
    /// turns at most, the parameters are the carrier's own; between, they are half-angle tangents along angles. B-splines
    /// stay as they are.
    ///
    /// # Errors
    /// Coordinates out of the range of lengths, an empty rectangle.
    pub(crate) fn patch(&self, [u, v]: [[f64; 2]; 2]) -> Result<Surface, SurfaceError> {
        type Meridian<'a> = Box<dyn Fn(f64, f64) -> [f64; 2] + 'a>; // (radius, height) at v
        let (across, axes, meridian): (Axis, _, Meridian<'_>) = match self {
            Self::Spline(surface) => return Ok((**surface).clone()),
            Self::Plane(axes) => (Axis::line(v), axes, Box::new(|_, _| [0.0; 2])),
            Self::Cylinder { axes, radius_m } => {
                (Axis::line(v), axes, Box::new(|v, _| [*radius_m, v]))
            }
            Self::Cone {
                axes,
                half_angle_rad,
            } => {
                let slope = libm::tan(*half_angle_rad);
                (Axis::line(v), axes, Box::new(move |v, _| [v * slope, v]))
            }
            Self::Sphere { axes, radius_m } => {
                let on = move |v: f64, w: f64| {
                    [radius_m * libm::cos(v) / w, radius_m * libm::sin(v) / w]
                };
                (Axis::arcs(v), axes, Box::new(on))
            }
            Self::Torus {
                axes,
                major_m,
                minor_m,
            } => {
                let on = move |v: f64, w: f64| {
                    let out = minor_m * libm::cos(v) / w;
                    [major_m + out, minor_m * libm::sin(v) / w]
                };
                (Axis::arcs(v), axes, Box::new(on))
            }
        };
        let flat = matches!(self, Self::Plane(_));
        let along = if flat { Axis::line(u) } else { Axis::arcs(u) };
        let point = |(u, w): (f64, f64), (v, x): (f64, f64)| -> Point3 {
            if flat {
                return axes.to_world(&Vector3::new(u, v, 0.0));
            }
            let [rho, z] = meridian(v, x);
            let (sin, cos) = libm::sincos(u);
            axes.to_world(&Vector3::new(rho * cos / w, rho * sin / w, z))
        };
        let pairs =
            || (along.places.iter()).flat_map(|&a| across.places.iter().map(move |&b| (a, b)));
        let points = pairs().map(|(a, b)| point(a, b)).collect();
        let weights = (!flat).then(|| pairs().map(|(a, b)| a.1 * b.1).collect());
        let [knots_u, knots_v] = [('u', &along), ('v', &across)].map(|(direction, axis)| {
            KnotVector::new(axis.degree, axis.knots.clone())
                .map_err(|source| SurfaceError::Knots { direction, source })
        });
        let net = ControlNet::new(along.places.len(), across.places.len(), points)?;
        Surface::new(knots_u?, knots_v?, net, weights)
    }
}
