//! What an IGES file says about a surface that is not taken over: the trimming of its face (entity 144) and other
//! faces. IGES 5.3, §4.33 (144), §4.32 (142).
//!
//! A boundary (142) names its curve in the surface's parameters or in space; the curve may be composed (102) of lines
//! (110) and B-splines (126). Points on it that are not at the edge of the surface mean that a part is cut away.

use super::read::Parameters;
use super::sections::{Entry, File};
use crate::basis::KnotVector;
use crate::exchange::{LeftOut, LengthUnit};
use crate::math::Point3;
use crate::surface::{ClosestSolver, Surface};

const TRIMMED: u64 = 144;
const BOUNDARY: u64 = 142;
const COMPOSITE: u64 = 102;
const LINE: u64 = 110;
const SPLINE: u64 = 126;

/// A point is at the edge of a surface within this part of the domain, and on the surface within this part of its
/// size.
const ON_EDGE: f64 = 1e-4;

/// Points looked at on each piece of a boundary.
const SAMPLES: usize = 9;

/// Curves inside each other at most.
const MOST_DEPTH: usize = 8;

/// What of a file is left out when surface `id` alone is read, whole.
pub(super) fn left_out(
    file: &File<'_>,
    id: u64,
    ids: &[u64],
    surface: &Surface,
    unit: &LengthUnit,
) -> LeftOut {
    let mut left = LeftOut::default();
    for entry in file
        .entries()
        .flatten()
        .filter(|entry| entry.kind == TRIMMED)
    {
        let Some(face) = Numbers::of(file, &entry) else {
            continue;
        };
        left.faces += 1;
        let on = face.pointer(0);
        left.other_faces += usize::from(!on.is_some_and(|on| ids.contains(&on)));
        if on != Some(id) {
            continue;
        }
        let (outer, holes) = (face.at(1), face.at(2));
        let open = !surface.topology().is_closed();
        let cut = outer != Some(0.0)
            && face
                .pointer(3)
                .is_some_and(|boundary| leaves_edge(file, boundary, surface, unit));
        if cut || (open && holes.is_some_and(|count| count > 0.0)) {
            left.trimmed = true;
        }
    }
    left
}

/// The parameters of an entity as numbers; `None` where one is something else.
struct Numbers(Vec<f64>);

impl Numbers {
    fn of(file: &File<'_>, entry: &Entry) -> Option<Self> {
        let read = Parameters::of(file, entry, entry.kind as u32).ok()?;
        Some(Self(
            (0..read.count())
                .map_while(|k| read.real(k, "").ok())
                .collect(),
        ))
    }

    fn at(&self, k: usize) -> Option<f64> {
        self.0.get(k).copied()
    }

    fn pointer(&self, k: usize) -> Option<u64> {
        self.at(k)
            .filter(|id| *id >= 1.0 && id.fract() == 0.0)
            .map(|id| id as u64)
    }

    fn count(&self, k: usize) -> Option<usize> {
        self.at(k)
            .filter(|count| *count >= 0.0 && count.fract() == 0.0 && *count < 1e6)
            .map(|count| count as usize)
    }
}

/// Whether a boundary has points that are not at the edge of its surface.
fn leaves_edge(file: &File<'_>, boundary: u64, surface: &Surface, unit: &LengthUnit) -> bool {
    let of = |id: u64, kind: u64| {
        let entry = file.entry(id).filter(|entry| entry.kind == kind)?;
        Numbers::of(file, &entry)
    };
    let Some(boundary) = of(boundary, BOUNDARY) else {
        return false;
    };
    let knots = [surface.knots_u(), surface.knots_v()];
    let at_edge = |parameters: [f64; 2]| {
        parameters.iter().zip(knots).any(|(parameter, knots)| {
            let (start, end) = knots.domain();
            let near = ON_EDGE * (end - start);
            (parameter - start).abs() <= near || (end - parameter).abs() <= near
        })
    };
    let mut points = Vec::new();
    // In parameters first: there no unit and no matrix comes between.
    if let Some(curve) = boundary.pointer(2)
        && sample(file, curve, 0, &mut points).is_some()
    {
        return points.iter().any(|p| !at_edge([p.x, p.y]));
    }
    points.clear();
    let Some(curve) = boundary.pointer(3) else {
        return false;
    };
    if sample(file, curve, 0, &mut points).is_none() {
        return false;
    }
    let mut solver = ClosestSolver::new(surface);
    points.iter().any(|p| {
        let foot = solver.closest(surface, &p.map(|x| unit.to_metres(x)));
        // A point off the surface says nothing.
        foot.distance <= ON_EDGE * surface.size() && !at_edge([foot.u, foot.v])
    })
}

/// Points along a curve; `None` for kinds that are not read.
fn sample(file: &File<'_>, id: u64, depth: usize, points: &mut Vec<Point3>) -> Option<()> {
    let entry = file.entry(id).filter(|_| depth < MOST_DEPTH)?;
    let numbers = Numbers::of(file, &entry)?;
    match entry.kind {
        COMPOSITE => {
            for k in 0..numbers.count(0)? {
                sample(file, numbers.pointer(k + 1)?, depth + 1, points)?;
            }
        }
        LINE => {
            let end = |k: usize| {
                Some(Point3::new(
                    numbers.at(k)?,
                    numbers.at(k + 1)?,
                    numbers.at(k + 2)?,
                ))
            };
            let (from, to) = (end(0)?, end(3)?);
            let share = |k: usize| k as f64 / (SAMPLES - 1) as f64;
            points.extend((0..SAMPLES).map(|k| from + (to - from) * share(k)));
        }
        SPLINE => spline(&numbers, points)?,
        _ => return None,
    }
    Some(())
}

/// Points of a rational B-spline curve: upper index, degree, four flags, knots, weights, points, range, normal.
fn spline(numbers: &Numbers, points: &mut Vec<Point3>) -> Option<()> {
    let (count, degree) = (numbers.count(0)? + 1, numbers.count(1)?);
    let all = numbers.0.get(6..)?;
    let (knots, all) = all.split_at_checked(count + degree + 1)?;
    let (weights, all) = all.split_at_checked(count)?;
    let (places, all) = all.split_at_checked(3 * count)?;
    let knots = KnotVector::new(degree, knots.to_vec()).ok()?;
    let (low, high) = knots.domain();
    let (start, end) = (all.first()?.max(low), all.get(1)?.min(high));
    for k in 0..SAMPLES {
        let window = knots.window(start + (end - start) * k as f64 / (SAMPLES - 1) as f64);
        let mut sum = [0.0; 4];
        for (a, n) in window.order(0).iter().enumerate() {
            let i = (window.first + a) % count;
            let weight = n * weights[i];
            (0..3).for_each(|axis| sum[axis] += weight * places[3 * i + axis]);
            sum[3] += weight;
        }
        points.push(Point3::new(sum[0], sum[1], sum[2]) / sum[3]);
    }
    Some(())
}
