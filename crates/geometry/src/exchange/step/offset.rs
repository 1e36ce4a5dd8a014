//! Surfaces at a distance from others. ISO 10303-42, §4.4.
//!
//! Those of planes, cylinders, cones, spheres and tori are of the same kind. Those of B-splines are none: S + d n has no
//! polynomial form, and is interpolated, finer and finer until it fits.

use super::StepError;
use super::carriers::{Rim, into_nappe};
use super::entity::{Entity, File};
use crate::basis::{Blending, KnotVector, MAX_DEGREE};
use crate::math::{Point3, Vector3};
use crate::part::{Axes, Carrier};
use crate::surface::{ControlNet, GridFit, SampleGrid, Surface};

/// Of the size: how near the fit has to come.
const FIT: f64 = 1e-9;
/// Of the size: what is too far off to be used, unless the file itself is less certain.
const WORST: f64 = 1e-6;
/// Control points of a fit, at most.
const MOST_POINTS: usize = 1 << 16;
/// An interpolant of this degree, or of that of the surface if it is higher, errs by the sixth power of its spans.
const DEGREE: usize = 5;
/// Least cosine between the normals of a surface and of its offset; −1 where the offset is folded over.
const UNFOLDED: f64 = 0.5;

/// A carrier moved by a distance (m) along its normal. Axes of cones are chosen anew for the nappe that the face lies on.
pub(super) fn moved(
    file: &File<'_, '_>,
    entity: &Entity<'_>,
    carrier: Carrier,
    by_m: f64,
    rim: &Rim<'_>,
    uncertainty_m: f64,
) -> Result<Carrier, StepError> {
    let along = |axes: Axes, by_m: f64| Axes {
        origin: axes.origin + axes.z * by_m,
        ..axes
    };
    let radius = |radius_m: f64| match radius_m + by_m {
        r if r > 0.0 => Ok(r),
        _ => Err(entity.unreadable("it is offset inwards by its radius or more")),
    };
    Ok(match carrier {
        Carrier::Plane(axes) => Carrier::Plane(along(axes, by_m)),
        Carrier::Cylinder { axes, radius_m } => Carrier::Cylinder {
            axes,
            radius_m: radius(radius_m)?,
        },
        Carrier::Sphere { axes, radius_m } => Carrier::Sphere {
            axes,
            radius_m: radius(radius_m)?,
        },
        Carrier::Torus {
            axes,
            major_m,
            minor_m,
        } => Carrier::Torus {
            axes,
            major_m,
            minor_m: radius(minor_m)?,
        },
        Carrier::Cone {
            axes,
            half_angle_rad,
        } => {
            let nappe = along(axes, -by_m / libm::sin(half_angle_rad));
            let axes = into_nappe(nappe, rim);
            if axes != nappe {
                return Err(entity.unreadable("it is offset past its apex"));
            }
            Carrier::Cone {
                axes,
                half_angle_rad,
            }
        }
        Carrier::Spline(surface) => {
            let most_m = (WORST * surface.size()).max(uncertainty_m);
            let (fitted, off_m) = fitted(&surface.clamped(), by_m)
                .ok_or_else(|| entity.unreadable("it is folded over, or has too many spans"))?;
            if off_m > most_m {
                return Err(entity.value("what a B-spline misses it by (m)", off_m, CLOSER));
            }
            file.note(format!(
                "#{}: the offset surface is fitted by a B-spline; where it was measured it is {off_m:.1e} m off at most",
                entity.id
            ));
            Carrier::Spline(Box::new(fitted))
        }
    })
}

const CLOSER: &str = "1e-6 of its size or the file's uncertainty: convert it to a B-spline where the file comes from";

/// The offset of an open or clamped surface and by how much it is off, m; `None` where it is folded over or too large.
fn fitted(surface: &Surface, by_m: f64) -> Option<(Surface, f64)> {
    let basis = Carrier::Spline(Box::new(surface.clone()));
    let at = |u: f64, v: f64| basis.point([u, v]) + basis.normal([u, v]) * by_m;
    let mut best: Option<(Surface, f64)> = None;
    let mut parts = 1;
    while let Some(knots) = [surface.knots_u(), surface.knots_v()]
        .map(|knots| divided(knots, parts))
        .into_iter()
        .collect::<Option<Vec<KnotVector>>>()
        .filter(|knots| knots[0].count().saturating_mul(knots[1].count()) <= MOST_POINTS)
    {
        let (u, v) = (&knots[0], &knots[1]);
        let (us, vs) = (u.greville(), v.greville());
        let points: Vec<Point3> = (us.iter())
            .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
            .map(|(u, v)| at(u, v))
            .collect();
        let mut net = ControlNet::new(us.len(), vs.len(), points.clone()).ok()?;
        let grid = SampleGrid::from_blendings(Blending::new(u, &us), Blending::new(v, &vs));
        GridFit::new(&grid).fit_into(&points, &mut net);
        let fit = Surface::new(u.clone(), v.clone(), net, None).ok()?;
        let off_m = apart(&fit, &basis, at)?;
        let converges = best.as_ref().is_none_or(|(_, before_m)| off_m < *before_m);
        if converges {
            best = Some((fit, off_m));
        }
        if !converges || off_m <= FIT * surface.size() {
            break;
        }
        parts *= 2;
    }
    best
}

/// The knots of an interpolant: each span in equal parts, one derivative less than the surface has at its own knots.
fn divided(knots: &KnotVector, parts: usize) -> Option<KnotVector> {
    let from = knots.degree();
    let degree = from.clamp(DEGREE, MAX_DEGREE);
    let (low, high) = knots.domain();
    let mut all = vec![low; degree + 1];
    let t = knots.knots();
    for span in knots.spans() {
        let [a, b] = [t[span], t[span + 1]];
        all.extend((1..parts).map(|k| a + (b - a) * k as f64 / parts as f64));
        let times = match b < high {
            true => (degree + 1 + knots.multiplicity(b))
                .saturating_sub(from)
                .min(degree),
            false => degree + 1,
        };
        all.extend(std::iter::repeat_n(b, times));
    }
    KnotVector::new(degree, all).ok()
}

/// The most that two surfaces of the same parameters are apart, m, at two by two places of each span; `None` where their
/// normals are.
fn apart(fit: &Surface, basis: &Carrier, at: impl Fn(f64, f64) -> Point3) -> Option<f64> {
    let places = |knots: &KnotVector| -> Vec<f64> {
        let t = knots.knots();
        let spans = knots.spans().map(|span| [t[span], t[span + 1]]);
        spans
            .flat_map(|[a, b]| [0.3, 0.75].map(|s| a + s * (b - a)))
            .collect()
    };
    let vs = places(fit.knots_v());
    let mut off_m = 0.0f64;
    for u in places(fit.knots_u()) {
        for &v in &vs {
            let normal: Vector3 = fit.normal(u, v);
            if normal.dot(&basis.normal([u, v])) < UNFOLDED {
                return None;
            }
            off_m = off_m.max((fit.point(u, v) - at(u, v)).norm());
        }
    }
    Some(off_m)
}
