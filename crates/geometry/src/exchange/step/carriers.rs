//! The surfaces of faces. ISO 10303-42, §4.4.
//!
//! What a line or a circle sweeps is given as the plane, cylinder, cone, sphere or torus that it is; other swept surfaces
//! become B-splines, exactly: an extrusion as far as the face's edges go, a revolution once round.

use super::StepError;
use super::curves::{self, ROUND, Whole, ellipse, round_knots};
use super::entity::{Entity, File};
use super::offset;
use super::surface;
use super::units::Context;
use crate::basis::KnotVector;
use crate::exchange::SplineError;
use crate::math::{Point3, Vector3};
use crate::part::{Axes, Brep, BrepBound, BrepCurve, BrepEdge, Carrier};
use crate::surface::{ControlNet, Curve, Surface, SurfaceError};
use std::f64::consts::FRAC_PI_2;

/// Surfaces of surfaces.
const MOST_NESTED: usize = 8;

/// Directions are parallel or at right angles within this, and lines meet within this part of their distances: twelve
/// digits of a file, and room for what they were rounded from.
const SAME_DIRECTION: f64 = 1e-10;

/// How much farther than the face an extruded surface goes, as a part of its height.
const MARGIN: f64 = 0.01;

const SPLINES: [&str; 5] = [
    "B_SPLINE_SURFACE",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "BEZIER_SURFACE",
    "QUASI_UNIFORM_SURFACE",
    "UNIFORM_SURFACE",
];

/// A face's surface.
pub(super) struct Found {
    pub carrier: Carrier,
    /// The normal of the file's surface is the opposite of the carrier's.
    pub turned: bool,
}

/// What bounds a face, already read.
pub(super) struct Rim<'c> {
    pub brep: &'c Brep,
    pub bounds: &'c [BrepBound],
}

impl Rim<'_> {
    fn edges(&self) -> impl Iterator<Item = &BrepEdge> {
        let loops = self.bounds.iter().filter_map(|bound| match bound {
            BrepBound::Loop(uses) => Some(uses),
            BrepBound::Vertex(_) => None,
        });
        loops
            .flatten()
            .map(|(edge, _)| &self.brep.edges[*edge as usize])
    }

    fn vertices(&self) -> impl Iterator<Item = &Point3> {
        let ends = self.edges().flat_map(|edge| edge.ends);
        let alone = self.bounds.iter().filter_map(|bound| match bound {
            BrepBound::Loop(_) => None,
            BrepBound::Vertex(vertex) => Some(*vertex),
        });
        ends.chain(alone)
            .map(|vertex| &self.brep.vertices[vertex as usize])
    }

    /// Points whose convex hull contains all edges.
    fn hull(&self) -> Vec<Point3> {
        let mut points: Vec<Point3> = self.vertices().copied().collect();
        for edge in self.edges() {
            let ends = edge.ends.map(|vertex| self.brep.vertices[vertex as usize]);
            match &edge.curve {
                BrepCurve::Line { .. } => {}
                BrepCurve::Circle { axes, radius_m } => {
                    points.extend(corners(axes, [*radius_m, *radius_m]));
                }
                BrepCurve::Ellipse { axes, radii_m } => points.extend(corners(axes, *radii_m)),
                // Where the tangents at the ends meet.
                BrepCurve::Hyperbola {
                    axes,
                    radii_m: [a, b],
                } => {
                    let [s, t] = ends.map(|p| libm::asinh(axes.to_local(&p).y / b));
                    let (mean, half) = ((s + t) / 2.0, libm::cosh((s - t) / 2.0));
                    let (x, y) = (a * libm::cosh(mean) / half, b * libm::sinh(mean) / half);
                    points.push(axes.to_world(&Vector3::new(x, y, 0.0)));
                }
                BrepCurve::Parabola { axes, focal_m } => {
                    let [s, t] = ends.map(|p| axes.to_local(&p).y / (2.0 * focal_m));
                    let local = Vector3::new(focal_m * s * t, focal_m * (s + t), 0.0);
                    points.push(axes.to_world(&local));
                }
                BrepCurve::Spline(curve) => points.extend(curve.points()),
            }
        }
        points
    }
}

fn corners(axes: &Axes, [a, b]: [f64; 2]) -> [Point3; 4] {
    [[a, b], [-a, b], [-a, -b], [a, -b]].map(|[x, y]| axes.to_world(&Vector3::new(x, y, 0.0)))
}

/// Reads the surface that `from` refers to, of a face within the rim.
pub(super) fn read(
    file: &File<'_, '_>,
    id: u64,
    from: u64,
    context: &Context,
    rim: &Rim<'_>,
) -> Result<Found, StepError> {
    let (mut id, mut from, mut turned) = (id, from, false);
    // Along the normal of the surface that the others lead to, m.
    let mut offset_m = None;
    for _ in 0..MOST_NESTED {
        let entity = file.entity(id, from)?;
        match entity.kind() {
            // The face's own bounds lie inside; the parameters may run backwards.
            "RECTANGULAR_TRIMMED_SURFACE" => {
                if entity.flag(6)? != entity.flag(7)? {
                    turned = !turned;
                    offset_m = offset_m.map(|by_m: f64| -by_m);
                }
            }
            "OFFSET_SURFACE" => {
                let by_m = context.length.to_metres(entity.number(2)?);
                if by_m.is_nan() || by_m.abs() > crate::math::MOST_COORDINATE_M {
                    return Err(entity.value("the distance (m)", by_m, "within ±1e12"));
                }
                *offset_m.get_or_insert(0.0) += by_m;
            }
            _ => {
                let mut found = plain(file, &entity, context, rim)?;
                if let Some(by_m) = offset_m {
                    let by_m = if found.turned { -by_m } else { by_m };
                    let uncertainty_m = context.uncertainty_m;
                    found.carrier =
                        offset::moved(file, &entity, found.carrier, by_m, rim, uncertainty_m)?;
                }
                found.turned ^= turned;
                return Ok(found);
            }
        }
        (from, id) = (id, entity.reference(1)?);
    }
    Err(file
        .entity(id, from)?
        .unreadable("surfaces of surfaces are read eight deep"))
}

fn plain(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
    rim: &Rim<'_>,
) -> Result<Found, StepError> {
    let (id, unit) = (entity.id, &context.length);
    let axes = || file.axes(entity.reference(1)?, id, unit);
    let length = |k: usize, what: &str| entity.length(k, what, unit);
    let carrier = match entity.kind() {
        "PLANE" => Carrier::Plane(axes()?),
        "CYLINDRICAL_SURFACE" => Carrier::Cylinder {
            axes: axes()?,
            radius_m: length(2, "the radius")?,
        },
        "SPHERICAL_SURFACE" => Carrier::Sphere {
            axes: axes()?,
            radius_m: length(2, "the radius")?,
        },
        "CONICAL_SURFACE" => cone(entity, axes()?, context, rim)?,
        "DEGENERATE_TOROIDAL_SURFACE" if !entity.flag(4)? => {
            return Err(entity.unreadable("the inner part of a torus that crosses itself"));
        }
        "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => Carrier::Torus {
            axes: axes()?,
            major_m: length(2, "the major radius")?,
            minor_m: length(3, "the minor radius")?,
        },
        "SURFACE_OF_LINEAR_EXTRUSION" => return extrusion(file, entity, context, rim),
        "SURFACE_OF_REVOLUTION" => return revolution(file, entity, context, rim),
        _ if SPLINES.iter().any(|name| entity.is(name)) => {
            let read = surface::read(file.exchange, id, unit)?.build();
            let read = read.map_err(|source| StepError::Spline { id, source })?;
            Carrier::Spline(Box::new(read.surface))
        }
        _ => {
            let why = "convert it to a B-spline surface where the file comes from";
            return Err(entity.unreadable(why));
        }
    };
    let turned = false;
    Ok(Found { carrier, turned })
}

/// A radius at the origin, growing along the axis by the tangent of the half angle. S_u × S_v = ρ (cos u, sin u, −tan α)
/// points away from the axis on both nappes, where ρ = r + v tan α > 0 and where it is < 0: turning a cone over to its
/// other nappe leaves the face's sense as it is.
fn cone(
    entity: &Entity<'_>,
    axes: Axes,
    context: &Context,
    rim: &Rim<'_>,
) -> Result<Carrier, StepError> {
    let radius = entity.number(2)?;
    let radius_m = context.length.to_metres(radius);
    if !(0.0..=crate::math::MOST_COORDINATE_M).contains(&radius_m) {
        return Err(entity.value("the radius", radius, "a length from 0 to 1e12 m"));
    }
    let angle = entity.number(3)?;
    let half_angle_rad = angle * context.angle_rad;
    if !(half_angle_rad > 0.0 && half_angle_rad < FRAC_PI_2) {
        let wanted = "above 0 and below a right angle, in the file's unit of angles";
        return Err(entity.value("the half angle", angle, wanted));
    }
    let apex = axes.origin - axes.z * (radius_m / libm::tan(half_angle_rad));
    if let Some((_, value)) = crate::math::first_outside(&[apex]) {
        return Err(entity.value("a coordinate of the apex (m)", value, "within ±1e12"));
    }
    Ok(Carrier::Cone {
        axes: into_nappe(
            Axes {
                origin: apex,
                ..axes
            },
            rim,
        ),
        half_angle_rad,
    })
}

/// Axes at an apex, turned over where the face lies below it.
pub(super) fn into_nappe(axes: Axes, rim: &Rim<'_>) -> Axes {
    let heights = rim.vertices().map(|p| axes.z.dot(&(p - axes.origin)));
    let far = heights.fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
    if far < 0.0 {
        Axes {
            y: -axes.y,
            z: -axes.z,
            ..axes
        }
    } else {
        axes
    }
}

/// S(u, v) = C(u) + v d; the normal is C' × d.
fn extrusion(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
    rim: &Rim<'_>,
) -> Result<Found, StepError> {
    let id = entity.id;
    let whole = curves::read(file, entity.reference(1)?, id, context)?;
    let along = file.vector(entity.reference(2)?, id)?;
    let against = !whole.along;
    match &whole.curve {
        BrepCurve::Line { origin, direction } => {
            let axes = Axes::new(*origin, &direction.cross(&along), Some(direction));
            let axes = axes.filter(|_| direction.cross(&along).norm() > SAME_DIRECTION);
            let axes = axes.ok_or_else(|| entity.unreadable("a line extruded along itself"))?;
            let carrier = Carrier::Plane(axes);
            return Ok(Found {
                carrier,
                turned: against,
            });
        }
        BrepCurve::Circle { axes, radius_m } if axes.z.cross(&along).norm() < SAME_DIRECTION => {
            let carrier = Carrier::Cylinder {
                axes: *axes,
                radius_m: *radius_m,
            };
            let turned = (axes.z.dot(&along) < 0.0) != against;
            return Ok(Found { carrier, turned });
        }
        _ => {}
    }
    let curve = profile(entity, &whole)?;
    let span = |points: &[Point3]| {
        let heights = points.iter().map(|p| along.dot(&p.coords));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| {
            [a.min(h), b.max(h)]
        })
    };
    let ([low, high], [c_low, c_high]) = (span(&rim.hull()), span(curve.points()));
    let (from_m, to_m) = (low - c_high, high - c_low);
    if !(from_m < to_m && to_m.is_finite()) {
        return Err(entity.unreadable("no edges say how far it goes"));
    }
    let margin = MARGIN * (to_m - from_m);
    let ends = [from_m - margin, to_m + margin];
    let straight = vec![ends[0], ends[0], ends[1], ends[1]];
    let both = |p: &Point3| ends.map(|v| p + along * v);
    let points = curve.points().iter().flat_map(both).collect();
    let weights = curve
        .weights()
        .map(|w| w.iter().flat_map(|w| [*w, *w]).collect());
    let carrier = tensor(
        id,
        curve.knots().clone(),
        (1, straight),
        points,
        weights,
        false,
    )?;
    Ok(Found {
        carrier,
        turned: against,
    })
}

/// S(u, v): C(v) turned about an axis by u; the normal is (axis × r) × C', with r from the axis to the point.
fn revolution(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
    rim: &Rim<'_>,
) -> Result<Found, StepError> {
    let id = entity.id;
    let whole = curves::read(file, entity.reference(1)?, id, context)?;
    let placement = file.entity(entity.reference(2)?, id)?;
    if placement.kind() != "AXIS1_PLACEMENT" {
        return Err(placement.other("an AXIS1_PLACEMENT"));
    }
    let axis = Axis {
        point: file.point(placement.reference(1)?, placement.id, &context.length)?,
        direction: file.direction(placement.reference(2)?, placement.id)?,
    };
    let known = match &whole.curve {
        BrepCurve::Line { origin, direction } => axis.turned_line(origin, direction, rim),
        BrepCurve::Circle { axes, radius_m } => {
            axis.turned_circle(axes, *radius_m, whole.middle.unwrap_or(0.0))
        }
        _ => None,
    };
    if let Some(found) = known {
        return Ok(Found {
            turned: found.turned == whole.along,
            ..found
        });
    }
    let curve = match &whole.curve {
        BrepCurve::Line { origin, direction } => {
            let ends = axis.ends(origin, direction, rim);
            let ends = ends.ok_or_else(|| entity.unreadable("no edges say how far it goes"))?;
            let knots = KnotVector::clamped_uniform(1, 2);
            let curve = knots.map(|knots| Curve::new(knots, ends.to_vec(), None));
            match curve {
                Ok(Ok(curve)) => curve,
                _ => return Err(entity.unreadable("it leaves the range of lengths")),
            }
        }
        _ => profile(entity, &whole)?,
    };
    let mut points = Vec::with_capacity(ROUND.len() * curve.points().len());
    let mut weights = Vec::with_capacity(points.capacity());
    for ([cos, sin], round) in ROUND {
        for (k, point) in curve.points().iter().enumerate() {
            let r = axis.from(point);
            points.push(point - r + r * cos + axis.direction.cross(&r) * sin);
            weights.push(round * curve.weights().map_or(1.0, |w| w[k]));
        }
    }
    let round = (2, round_knots());
    let carrier = tensor(
        id,
        curve.knots().clone(),
        round,
        points,
        Some(weights),
        true,
    )?;
    let turned = !whole.along;
    Ok(Found { carrier, turned })
}

/// The curve that is swept, as a B-spline.
fn profile(entity: &Entity<'_>, whole: &Whole) -> Result<Curve, StepError> {
    let id = entity.id;
    let curve = match &whole.curve {
        BrepCurve::Spline(curve) => return Ok(curve.clone()),
        BrepCurve::Circle { axes, radius_m } => ellipse(axes, [*radius_m, *radius_m]),
        BrepCurve::Ellipse { axes, radii_m } => ellipse(axes, *radii_m),
        _ => return Err(entity.unreadable("sweep a B-spline instead of a parabola or hyperbola")),
    };
    curve
        .build()
        .map_err(|source| StepError::Spline { id, source })
}

/// A surface of a curve and another direction, which is u where it comes `first`.
fn tensor(
    id: u64,
    curve: KnotVector,
    (degree, other): (usize, Vec<f64>),
    points: Vec<Point3>,
    weights: Option<Vec<f64>>,
    first: bool,
) -> Result<Carrier, StepError> {
    let direction = if first { 'u' } else { 'v' };
    let build = || -> Result<Surface, SurfaceError> {
        let other = KnotVector::new(degree, other)
            .map_err(|source| SurfaceError::Knots { direction, source })?;
        let (u, v) = if first {
            (other, curve)
        } else {
            (curve, other)
        };
        let net = ControlNet::new(u.count(), v.count(), points)?;
        Ok(Surface::new(u, v, net, weights)?.loaded()?.surface)
    };
    let spline = |source| StepError::Spline {
        id,
        source: SplineError::Surface(source),
    };
    Ok(Carrier::Spline(Box::new(build().map_err(spline)?)))
}

/// A line that something is turned about.
struct Axis {
    point: Point3,
    direction: Vector3,
}

impl Axis {
    /// From the axis to a point, at right angles.
    fn from(&self, point: &Point3) -> Vector3 {
        let d = point - self.point;
        d - self.direction * self.direction.dot(&d)
    }

    /// The axis' point nearest to another.
    fn foot(&self, point: &Point3) -> Point3 {
        point - self.from(point)
    }

    /// A cylinder, a plane or a cone; `None` for a line that passes the axis by.
    fn turned_line(&self, origin: &Point3, d: &Vector3, rim: &Rim<'_>) -> Option<Found> {
        let r = self.from(origin);
        let rise = d.dot(&self.direction);
        let out = d - self.direction * rise;
        if out.norm() < SAME_DIRECTION {
            let carrier = Carrier::Cylinder {
                axes: Axes::new(self.point, &self.direction, Some(&r))?,
                radius_m: r.norm(),
            };
            let turned = rise < 0.0;
            return (r.norm() > 0.0).then_some(Found { carrier, turned });
        }
        if rise.abs() < SAME_DIRECTION {
            // (axis × r) × d = −axis (r · d); of a line from the axis outwards r · d > 0.
            let axes = Axes::new(self.foot(origin), &self.direction, Some(d))?;
            let turned =
                r.dot(d) >= 0.0 || r.norm() < SAME_DIRECTION * (origin - self.point).norm();
            let carrier = Carrier::Plane(axes);
            return Some(Found { carrier, turned });
        }
        let aside = self.direction.cross(&out).dot(&r) / out.norm();
        if aside.abs() > SAME_DIRECTION * (origin - self.point).norm() {
            return None;
        }
        let apex = self.foot(&(origin - d * (r.dot(&out) / out.norm_squared())));
        let carrier = Carrier::Cone {
            axes: into_nappe(Axes::new(apex, &self.direction, Some(&r))?, rim),
            half_angle_rad: libm::atan2(out.norm(), rise.abs()),
        };
        let turned = rise < 0.0;
        Some(Found { carrier, turned })
    }

    /// A sphere or a torus; `None` for a circle in another plane. Angle `t` is one that the face has.
    fn turned_circle(&self, axes: &Axes, radius_m: f64, t: f64) -> Option<Found> {
        let off = axes.z.dot(&(self.point - axes.origin)).abs();
        if axes.z.dot(&self.direction).abs() > SAME_DIRECTION || off > SAME_DIRECTION * radius_m {
            return None;
        }
        let middle = self.from(&axes.origin);
        let carrier = if middle.norm() < SAME_DIRECTION * radius_m {
            Carrier::Sphere {
                axes: Axes::new(axes.origin, &self.direction, None)?,
                radius_m,
            }
        } else {
            Carrier::Torus {
                axes: Axes::new(self.foot(&axes.origin), &self.direction, Some(&middle))?,
                major_m: middle.norm(),
                minor_m: radius_m,
            }
        };
        let at = |t: f64| axes.direction(&Vector3::new(libm::cos(t), libm::sin(t), 0.0));
        // Not where the circle meets the axis.
        let t = [t, t + 1.0].into_iter().max_by(|a, b| {
            let far = |t: f64| self.from(&(axes.origin + at(t) * radius_m)).norm();
            far(*a).total_cmp(&far(*b))
        })?;
        let r = self.from(&(axes.origin + at(t) * radius_m));
        let normal = self.direction.cross(&r).cross(&at(t + FRAC_PI_2));
        let turned = normal.dot(&at(t)) < 0.0;
        Some(Found { carrier, turned })
    }

    /// The stretch of a line that the rim needs, turned.
    fn ends(&self, origin: &Point3, d: &Vector3, rim: &Rim<'_>) -> Option<[Point3; 2]> {
        let rise = d.dot(&self.direction);
        let at = |p: &Point3| self.direction.dot(&(p - origin)) / rise;
        let hull = rim.hull();
        let (low, high) = hull
            .iter()
            .map(at)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| {
                (a.min(t), b.max(t))
            });
        let margin = MARGIN * (high - low);
        let ends = [low - margin, high + margin].map(|t| origin + d * t);
        (low < high && crate::math::first_outside(&ends).is_none()).then_some(ends)
    }
}
