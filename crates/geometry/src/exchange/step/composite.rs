//! Curves joined of several, as one B-spline that is the same point for point. ISO 10303-42, §4.4.
//!
//! ```text
//! segments ── trims ──▶ rational Bézier pieces ── degrees raised to the highest, weights scaled to meet ──▶ C⁰ B-spline
//! ```

use super::StepError;
use super::curves::{parameter, plain};
use super::entity::{Entity, File};
use super::syntax::Value;
use super::units::Context;
use crate::exchange::spline::FileCurve;
use crate::math::{Point3, Vector3};
use crate::part::bezier::{Homogeneous, projected};
use crate::part::{BrepCurve, chain_between, chain_of};
use crate::surface::Curve;

/// Curves of curves.
const MOST_NESTED: usize = 8;

/// Of the size of the curve: segments that are farther apart do not meet.
const SAME_PLACE: f64 = 1e-3;
/// Of the size of the curve: nearer than this, what is between two segments is rounding and not worth a word.
const ROUNDING: f64 = 1e-9;

/// Control points of one segment.
type Piece = Vec<Homogeneous>;

/// The segments of a `COMPOSITE_CURVE` end to start.
pub(super) fn joined(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
) -> Result<Curve, StepError> {
    let pieces = segments(file, entity, context, MOST_NESTED)?;
    let curve = FileCurve::of_segments(&pieces);
    let curve = curve.ok_or_else(|| entity.unreadable("a curve joined of no segments"))?;
    let id = entity.id;
    curve
        .build()
        .map_err(|source| StepError::Spline { id, source })
}

/// The pieces of all segments in order, each beginning where the one before ends.
fn segments(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
    deep: usize,
) -> Result<Vec<Piece>, StepError> {
    let mut chains = Vec::new();
    for id in entity.references(1)? {
        let segment = file.entity(id, entity.id)?;
        let mut chain = bounded(file, segment.reference(2)?, id, context, deep)?;
        if !segment.flag(1)? {
            turn(&mut chain);
        }
        chains.push((id, chain));
    }
    let all = || chains.iter().flat_map(|(_, chain)| chain).flatten();
    let Some(origin) = all().next().map(projected) else {
        return Ok(Vec::new());
    };
    let size_m = all().fold(0.0, |m: f64, h| m.max((projected(h) - origin).norm()));
    let allowed_m = (SAME_PLACE * size_m).max(2.0 * context.uncertainty_m);
    let ends = |chain: &[Piece]| -> Option<[Point3; 2]> {
        Some([chain.first()?.first()?, chain.last()?.last()?].map(projected))
    };
    for pair in chains.windows(2) {
        let [(before, a), (id, b)] = pair else {
            continue;
        };
        let (Some([_, end]), Some([start, _])) = (ends(a), ends(b)) else {
            continue;
        };
        let gap_m = (start - end).norm();
        if gap_m > allowed_m {
            return Err(StepError::OpenLoop {
                id: entity.id,
                edge: *before,
                gap_m,
                allowed_m,
            });
        }
        if gap_m > ROUNDING * size_m {
            file.note(format!(
                "#{}: segments #{before} and #{id} are {gap_m:.1e} m apart and taken as joined",
                entity.id
            ));
        }
    }
    Ok(chains.into_iter().flat_map(|(_, chain)| chain).collect())
}

fn turn(chain: &mut [Piece]) {
    chain.reverse();
    chain.iter_mut().for_each(|piece| piece.reverse());
}

/// A curve that has two ends, or goes once round.
fn bounded(
    file: &File<'_, '_>,
    id: u64,
    from: u64,
    context: &Context,
    deep: usize,
) -> Result<Vec<Piece>, StepError> {
    let entity = file.entity(id, from)?;
    match entity.kind() {
        "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "COMPOSITE_CURVE" if deep == 0 => {
            Err(entity.unreadable("curves of curves are read eight deep"))
        }
        "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
            bounded(file, entity.reference(1)?, id, context, deep - 1)
        }
        "COMPOSITE_CURVE" => segments(file, &entity, context, deep - 1),
        "TRIMMED_CURVE" => trimmed(file, &entity, context),
        _ => {
            let curve = plain(file, &entity, context)?;
            let start = match &curve {
                BrepCurve::Spline(curve) => {
                    let (a, b) = curve.knots().domain();
                    return Ok(chain_between(curve, true, [a, b]));
                }
                BrepCurve::Circle { .. } | BrepCurve::Ellipse { .. } => at(&curve, 0.0),
                _ => return Err(entity.unreadable("a segment without ends: trim it")),
            };
            pieces(&entity, &curve, true, [&start, &start])
        }
    }
}

/// The piece of a curve between two trims: parameters where both are given so and the file does not prefer points.
fn trimmed(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
) -> Result<Vec<Piece>, StepError> {
    let along = entity.flag(4)?;
    let basis = file.entity(entity.reference(1)?, entity.id)?;
    let curve = plain(file, &basis, context)?;
    let prefers_points = entity.get(5) == Some(&Value::Enumeration("CARTESIAN"));
    let parameters = [parameter(entity, 2), parameter(entity, 3)];
    if let (BrepCurve::Spline(spline), [Some(a), Some(b)], false) =
        (&curve, parameters, prefers_points)
    {
        let (low, high) = spline.knots().domain();
        if [a, b].iter().any(|t| !(low..=high).contains(t)) {
            return Err(entity.unreadable("it is trimmed beyond the knots of its B-spline"));
        }
        return match chain_between(spline, along, [a, b]) {
            pieces if pieces.is_empty() => Err(entity.unreadable(NO_LENGTH)),
            pieces => Ok(pieces),
        };
    }
    let scale = match &curve {
        BrepCurve::Line { .. } => {
            let vector = file.entity(basis.reference(2)?, basis.id)?;
            context.length.to_metres(vector.number(2)?).abs()
        }
        BrepCurve::Circle { .. } | BrepCurve::Ellipse { .. } => context.angle_rad,
        _ => 1.0,
    };
    let mut ends = [Point3::origin(); 2];
    for (k, end) in ends.iter_mut().enumerate() {
        let given = point(entity, 2 + k);
        *end = match (given, parameters[k]) {
            (Some(to), t) if prefers_points || t.is_none() => {
                file.point(to, entity.id, &context.length)?
            }
            (_, Some(t)) => at(&curve, t * scale),
            _ => return Err(entity.wrong(2 + k, "a parameter or a point", entity.get(2 + k))),
        };
    }
    if let Some((_, value)) = crate::math::first_outside(&ends) {
        return Err(entity.value("a coordinate of an end (m)", value, "within ±1e12"));
    }
    pieces(entity, &curve, along, [&ends[0], &ends[1]])
}

/// A trim's point, if the file gives it so.
fn point(entity: &Entity<'_>, k: usize) -> Option<u64> {
    let Some(Value::List(ways)) = entity.get(k) else {
        return None;
    };
    ways.iter().find_map(|way| match way {
        Value::Reference(to) => Some(*to),
        _ => None,
    })
}

/// A curve's point at a parameter: m of lines, rad of circles and ellipses, that of the standard for others.
fn at(curve: &BrepCurve, t: f64) -> Point3 {
    let (sin, cos) = libm::sincos(t);
    match curve {
        BrepCurve::Line { origin, direction } => origin + direction * t,
        BrepCurve::Circle { axes, radius_m: r } => {
            axes.to_world(&Vector3::new(r * cos, r * sin, 0.0))
        }
        BrepCurve::Ellipse {
            axes,
            radii_m: [a, b],
        } => axes.to_world(&Vector3::new(a * cos, b * sin, 0.0)),
        BrepCurve::Hyperbola {
            axes,
            radii_m: [a, b],
        } => axes.to_world(&Vector3::new(a * libm::cosh(t), b * libm::sinh(t), 0.0)),
        BrepCurve::Parabola { axes, focal_m: f } => {
            axes.to_world(&Vector3::new(f * t * t, 2.0 * f * t, 0.0))
        }
        BrepCurve::Spline(curve) => {
            let (low, high) = curve.knots().domain();
            curve.point(t.clamp(low, high))
        }
    }
}

fn pieces(
    entity: &Entity<'_>,
    curve: &BrepCurve,
    along: bool,
    ends: [&Point3; 2],
) -> Result<Vec<Piece>, StepError> {
    let closed = ends[0] == ends[1];
    let pieces = chain_of(curve, along, ends, closed);
    pieces.map_err(|_| entity.unreadable(NO_LENGTH))
}

const NO_LENGTH: &str = "both its ends are at one place";
