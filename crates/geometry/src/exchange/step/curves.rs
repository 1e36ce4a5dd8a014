//! The curves of edges: lines, conics, polylines, B-splines. ISO 10303-42, §4.4.
//!
//! Of a curve with pictures in the parameters of surfaces the curve in space is the master, whatever the file says; of a
//! trimmed one the whole is taken, since edges have ends of their own.

use super::StepError;
use super::composite;
use super::entity::{Entity, File};
use super::surface::implied;
use super::syntax::Value;
use super::units::Context;
use crate::basis::KnotVector;
use crate::exchange::spline::{FileCurve, Runs};
use crate::math::Point3;
use crate::part::{Axes, BrepCurve};
use crate::surface::Curve;
use std::f64::consts::FRAC_1_SQRT_2;

/// Curves of curves.
const MOST_NESTED: usize = 8;

const FORMS: [&str; 4] = [
    "B_SPLINE_CURVE_WITH_KNOTS",
    "BEZIER_CURVE",
    "QUASI_UNIFORM_CURVE",
    "UNIFORM_CURVE",
];

/// A curve as a whole.
pub(super) struct Whole {
    pub curve: BrepCurve,
    /// What the file calls its direction is the curve's own.
    pub along: bool,
    /// The middle of what the file trims a circle or an ellipse to, if it says so in angles, rad.
    pub middle: Option<f64>,
}

/// Reads the curve that `from` refers to.
pub(super) fn read(
    file: &File<'_, '_>,
    id: u64,
    from: u64,
    context: &Context,
) -> Result<Whole, StepError> {
    let (mut id, mut from, mut along) = (id, from, true);
    let mut trims = None;
    for _ in 0..MOST_NESTED {
        let entity = file.entity(id, from)?;
        from = id;
        match entity.kind() {
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => id = entity.reference(1)?,
            "TRIMMED_CURVE" => {
                along = along == entity.flag(4)?;
                trims = trims.or_else(|| Some((parameter(&entity, 2)?, parameter(&entity, 3)?)));
                id = entity.reference(1)?;
            }
            "COMPOSITE_CURVE" => {
                let [segment] = entity.references(1)?[..] else {
                    let curve = BrepCurve::Spline(composite::joined(file, &entity, context)?);
                    let middle = None;
                    return Ok(Whole {
                        curve,
                        along,
                        middle,
                    });
                };
                let segment = file.entity(segment, id)?;
                along = along == segment.flag(1)?;
                (id, from) = (segment.reference(2)?, segment.id);
            }
            _ => {
                let curve = plain(file, &entity, context)?;
                let middle = trims.map(|(a, b)| middle(&curve, a, b, along, context));
                return Ok(Whole {
                    curve,
                    along,
                    middle: middle.flatten(),
                });
            }
        }
    }
    Err(file
        .entity(id, from)?
        .unreadable("curves of curves are read eight deep"))
}

/// A trim's parameter, if the file gives it so.
pub(super) fn parameter(entity: &Entity<'_>, k: usize) -> Option<f64> {
    let Some(Value::List(ways)) = entity.get(k) else {
        return None;
    };
    ways.iter().find_map(|way| match way {
        Value::Typed("PARAMETER_VALUE", values) => match values.as_slice() {
            [Value::Number(number)] => Some(*number),
            _ => None,
        },
        _ => None,
    })
}

/// The middle of a trimmed conic, rad.
fn middle(curve: &BrepCurve, a: f64, b: f64, along: bool, context: &Context) -> Option<f64> {
    let (a, mut b) = if along { (a, b) } else { (b, a) };
    match curve {
        BrepCurve::Circle { .. } | BrepCurve::Ellipse { .. } => {
            let turn = std::f64::consts::TAU / context.angle_rad;
            if b <= a {
                b += turn * ((a - b) / turn).floor() + turn;
            }
            Some((a + b) / 2.0 * context.angle_rad)
        }
        _ => None,
    }
}

pub(super) fn plain(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
) -> Result<BrepCurve, StepError> {
    let (id, unit) = (entity.id, &context.length);
    let axes = || file.axes(entity.reference(1)?, id, unit);
    let length = |k: usize, what: &str| entity.length(k, what, unit);
    match entity.kind() {
        "LINE" => Ok(BrepCurve::Line {
            origin: file.point(entity.reference(1)?, id, unit)?,
            direction: file.vector(entity.reference(2)?, id)?,
        }),
        "CIRCLE" => Ok(BrepCurve::Circle {
            axes: axes()?,
            radius_m: length(2, "the radius")?,
        }),
        "ELLIPSE" => Ok(BrepCurve::Ellipse {
            axes: axes()?,
            radii_m: [length(2, "a semi-axis")?, length(3, "a semi-axis")?],
        }),
        "HYPERBOLA" => Ok(BrepCurve::Hyperbola {
            axes: axes()?,
            radii_m: [length(2, "a semi-axis")?, length(3, "a semi-axis")?],
        }),
        "PARABOLA" => Ok(BrepCurve::Parabola {
            axes: axes()?,
            focal_m: length(2, "the focal distance")?,
        }),
        "POLYLINE" => {
            let points = points(file, id, &entity.references(1)?, context)?;
            let knots = KnotVector::new(1, polyline_knots(points.len()));
            let spline = |source: crate::exchange::SplineError| StepError::Spline { id, source };
            let knots = knots.map_err(|source| {
                let direction = 't';
                spline(crate::surface::SurfaceError::Knots { direction, source }.into())
            })?;
            let curve = Curve::new(knots, points, None).map_err(|source| spline(source.into()))?;
            Ok(BrepCurve::Spline(curve))
        }
        _ if entity.is("B_SPLINE_CURVE") || FORMS.contains(&entity.kind()) => {
            let curve = spline(file, entity, context)?.build();
            let curve = curve.map_err(|source| StepError::Spline { id, source })?;
            Ok(BrepCurve::Spline(curve))
        }
        "PCURVE" => Err(entity.unreadable("edges need a curve in space, not in parameters alone")),
        _ => Err(entity.unreadable("convert it to a B-spline where the file comes from")),
    }
}

/// 0, 0, 1, 2, …, n − 1, n − 1.
fn polyline_knots(count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1);
    let inner = (0..count).map(|k| k as f64);
    std::iter::once(0.0)
        .chain(inner)
        .chain(std::iter::once(last as f64))
        .collect()
}

fn points(
    file: &File<'_, '_>,
    id: u64,
    ids: &[u64],
    context: &Context,
) -> Result<Vec<Point3>, StepError> {
    let each = ids
        .iter()
        .map(|point| file.point(*point, id, &context.length));
    each.collect()
}

/// Degree, points, form, closed, self-intersecting; multiplicities, knots, kind of knots; weights.
fn spline(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    context: &Context,
) -> Result<FileCurve, StepError> {
    let id = entity.id;
    let form = FORMS.into_iter().find(|form| entity.is(form));
    let form = form.unwrap_or(FORMS[0]);
    let own = entity.own("B_SPLINE_CURVE").or_else(|| entity.own(form));
    let own = own.unwrap_or_default();
    let wrong = |k: usize, wanted| entity.wrong(k, wanted, own.get(k));
    let degree = own
        .first()
        .and_then(whole)
        .ok_or_else(|| wrong(0, "a degree"))?;
    let Some(Value::List(list)) = own.get(1) else {
        return Err(wrong(1, "a list of points"));
    };
    let ids: Option<Vec<u64>> = list.iter().map(reference).collect();
    let ids = ids.ok_or_else(|| wrong(1, "a list of points"))?;
    let points = points(file, id, &ids, context)?;
    let degree = usize::try_from(degree).unwrap_or(usize::MAX);
    let knots = if form == FORMS[0] {
        let after = if entity.is("B_SPLINE_CURVE") { 0 } else { 5 };
        let own = entity.own(form).and_then(|own| own.get(after..));
        let [times, values, ..] = own.unwrap_or_default() else {
            return Err(entity.other("a curve with its knots"));
        };
        runs(entity, times, values)?
    } else {
        implied(form, degree, points.len())
    };
    let weights = entity.own("RATIONAL_B_SPLINE_CURVE").map(|own| {
        let numbers = own.last().and_then(numbers);
        numbers.ok_or_else(|| entity.wrong(0, "a list of weights", own.last()))
    });
    Ok(FileCurve {
        degree,
        knots,
        points,
        weights: weights.transpose()?,
    })
}

fn runs(entity: &Entity<'_>, times: &Value<'_>, values: &Value<'_>) -> Result<Runs, StepError> {
    let whole_list = |list: &Value<'_>| match list {
        Value::List(values) => values.iter().map(whole).collect::<Option<Vec<u64>>>(),
        _ => None,
    };
    let times = whole_list(times).ok_or_else(|| entity.wrong(0, "multiplicities", Some(times)))?;
    let knots = numbers(values).ok_or_else(|| entity.wrong(1, "knots", Some(values)))?;
    if times.len() != knots.len() {
        let (knots, multiplicities, direction) = (knots.len(), times.len(), 't');
        return Err(StepError::Spline {
            id: entity.id,
            source: crate::exchange::SplineError::Multiplicities {
                direction,
                knots,
                multiplicities,
            },
        });
    }
    Ok(knots.into_iter().zip(times).collect())
}

fn numbers(value: &Value<'_>) -> Option<Vec<f64>> {
    let Value::List(values) = value else {
        return None;
    };
    let each = values.iter().map(|value| match value {
        Value::Number(number) => Some(*number),
        _ => None,
    });
    each.collect()
}

fn reference(value: &Value<'_>) -> Option<u64> {
    match value {
        Value::Reference(to) => Some(*to),
        _ => None,
    }
}

fn whole(value: &Value<'_>) -> Option<u64> {
    match value {
        Value::Number(number) if *number >= 0.0 && number.fract() == 0.0 && *number < 1e15 => {
            Some(*number as u64)
        }
        _ => None,
    }
}

/// Once round: places (cos, sin) of the control points of a circle's four rational quadratics, with their weights.
pub(super) const ROUND: [([f64; 2], f64); 9] = [
    ([1.0, 0.0], 1.0),
    ([1.0, 1.0], FRAC_1_SQRT_2),
    ([0.0, 1.0], 1.0),
    ([-1.0, 1.0], FRAC_1_SQRT_2),
    ([-1.0, 0.0], 1.0),
    ([-1.0, -1.0], FRAC_1_SQRT_2),
    ([0.0, -1.0], 1.0),
    ([1.0, -1.0], FRAC_1_SQRT_2),
    ([1.0, 0.0], 1.0),
];

/// The knots that belong to [`ROUND`].
pub(super) fn round_knots() -> Vec<f64> {
    [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].map(f64::from).to_vec()
}

/// An ellipse as a rational B-spline, the same points in the same order.
pub(super) fn ellipse(axes: &Axes, radii_m: [f64; 2]) -> FileCurve {
    let [a, b] = radii_m;
    let place =
        |([cos, sin], _): &([f64; 2], f64)| axes.origin + axes.x * (a * cos) + axes.y * (b * sin);
    FileCurve {
        degree: 2,
        knots: crate::exchange::spline::runs(&round_knots()),
        points: ROUND.iter().map(place).collect(),
        weights: Some(ROUND.map(|(_, weight)| weight).to_vec()),
    }
}
