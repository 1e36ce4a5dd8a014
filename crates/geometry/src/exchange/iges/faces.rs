//! What an IGES file says about a surface that is not taken over: the trimming of its face (entities 144, 143, 510) and other
//! faces; IGES 5.3, chapter 4, under these numbers.
//!
//! A boundary names its curves in the surface's parameters or in space; a curve may be composed (102) of lines (110), arcs
//! (100), polylines (106) and B-splines (126). Points on it that are not at the edge of the surface mean that a part is cut
//! away, and so do curves that cannot be read.

use super::read::placement;
use super::sections::{Entry, File};
use super::uses::{FACES, Numbers, Uses};
use crate::basis::KnotVector;
use crate::exchange::{LeftOut, LengthUnit};
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Surface};

/// A point is at the edge of a surface within this part of the domain, and on the surface within this part of its
/// size.
const ON_EDGE: f64 = 1e-4;

/// Points looked at on each line and arc of a boundary, less one.
const STEPS: usize = 8;

/// Curves inside each other at most.
const MOST_DEPTH: usize = 8;

/// Whether an entity that stands by itself is a face or a body, but not of a B-spline surface.
fn is_other(file: &File<'_>, entry: &Entry) -> bool {
    let is_shape = match entry.kind {
        114 | 118 | 120 | 122 | 140 | 150..=168 | 190..=198 => true,
        // A plane, where it has a boundary.
        108 => Numbers::of(file, entry).is_some_and(|plane| plane.pointer(4).is_some()),
        _ => false,
    };
    is_shape && !entry.dependent
}

/// What of a file is left out when a surface alone, one of `ids`, is read, whole.
pub(super) fn left_out(
    file: &File<'_>,
    uses: &Uses,
    ids: &[u64],
    surface: &Surface,
    unit: &LengthUnit,
) -> LeftOut {
    let mut left = LeftOut::default();
    for entry in file.entries().flatten() {
        if FACES.contains(&entry.kind) {
            let on = Numbers::of(file, &entry)
                .and_then(|face| face.pointer(usize::from(entry.kind == 143)));
            left.faces += 1;
            left.other_faces += usize::from(!on.is_some_and(|on| ids.contains(&on)));
        } else if is_other(file, &entry) {
            left.faces += 1;
            left.other_faces += 1;
        } else {
            left.faces += usize::from(entry.kind == 128 && !entry.dependent);
        }
    }
    if uses.other && left.other_faces == 0 {
        left.faces += 1;
        left.other_faces += 1;
    }
    left.trimmed = uses
        .faces
        .iter()
        .any(|face| is_cut(file, face, uses, surface, unit));
    if !left.trimmed {
        left.placements = uses.placements;
    }
    left
}

/// A piece of a boundary.
struct Piece {
    /// Its curves in the surface's parameters, if there are any.
    parameters: Vec<u64>,
    /// Its curve in space.
    space: Option<u64>,
}

/// Whether a face is less than its surface.
fn is_cut(
    file: &File<'_>,
    face: &Entry,
    uses: &Uses,
    surface: &Surface,
    unit: &LengthUnit,
) -> bool {
    let Some(pieces) = pieces(file, face) else {
        return true;
    };
    let knots = [surface.knots_u(), surface.knots_v()];
    let at_edge = |parameters: [f64; 2]| {
        parameters.iter().zip(knots).any(|(parameter, knots)| {
            let (start, end) = knots.domain();
            let near = ON_EDGE * (end - start);
            let parameter = if knots.is_periodic() {
                knots.confine(*parameter)
            } else {
                *parameter
            };
            (parameter - start).abs() <= near || (end - parameter).abs() <= near
        })
    };
    let outside = &uses.chain[1..];
    let Ok(placed) = placement(file, outside) else {
        return true;
    };
    let mut solver = None;
    pieces.iter().any(|piece| {
        let mut points = Vec::new();
        // In parameters first: there no unit and no matrix comes between.
        let mut sampled = piece
            .parameters
            .iter()
            .map(|&curve| sample(file, curve, 0, &mut points));
        if !piece.parameters.is_empty() && sampled.all(|done| done.is_some()) {
            return points.iter().any(|p| !at_edge([p.x, p.y]));
        }
        points.clear();
        if piece
            .space
            .and_then(|curve| sample(file, curve, 0, &mut points))
            .is_none()
        {
            return true;
        }
        let solver = solver.get_or_insert_with(|| ClosestSolver::new(surface));
        points.iter().any(|p| {
            let place = placed
                .as_ref()
                .map_or(*p, |(turn, shift)| Point3::from(turn * p.coords + shift));
            let foot = solver.closest(surface, &place.map(|x| unit.to_metres(x)));
            foot.distance > ON_EDGE * surface.size() || !at_edge([foot.u, foot.v])
        })
    })
}

fn numbers(file: &File<'_>, id: u64, kind: u64) -> Option<Numbers> {
    let entry = file.entry(id).filter(|entry| entry.kind == kind)?;
    Numbers::of(file, &entry)
}

/// The boundaries of a face, in pieces; `None` where they cannot be read.
fn pieces(file: &File<'_>, face: &Entry) -> Option<Vec<Piece>> {
    let said = Numbers::of(file, face)?;
    let mut pieces = Vec::new();
    match face.kind {
        144 => {
            // Without an outer boundary that of the surface is meant.
            let outer = (said.at(1)? != 0.0).then_some(3);
            for k in outer.into_iter().chain(4..4 + said.count(2)?) {
                let boundary = numbers(file, said.pointer(k)?, 142)?;
                pieces.push(Piece {
                    parameters: boundary.pointer(2).into_iter().collect(),
                    space: boundary.pointer(3),
                });
            }
        }
        143 => {
            for k in 0..said.count(2)? {
                let boundary = numbers(file, said.pointer(3 + k)?, 141)?;
                let mut at = 4;
                for _ in 0..boundary.count(3)? {
                    let count = boundary.count(at + 2)?;
                    let parameters = (0..count).map(|k| boundary.pointer(at + 3 + k));
                    pieces.push(Piece {
                        parameters: parameters.collect::<Option<_>>()?,
                        space: boundary.pointer(at),
                    });
                    at += 3 + count;
                }
            }
        }
        _ => {
            for k in 0..said.count(1)? {
                pieces.extend(edges(file, &numbers(file, said.pointer(3 + k)?, 508)?)?);
            }
        }
    }
    Some(pieces)
}

/// The edges of a loop (508), each a curve of an edge list (504).
fn edges(file: &File<'_>, all: &Numbers) -> Option<Vec<Piece>> {
    let mut pieces = Vec::new();
    let mut at = 1;
    for _ in 0..all.count(0)? {
        let (is_vertex, count) = (all.at(at)? == 1.0, all.count(at + 4)?);
        // Each with a flag before it.
        let parameters = (0..count)
            .map(|k| all.pointer(at + 6 + 2 * k))
            .collect::<Option<Vec<_>>>()?;
        let index = all.count(at + 2)?.checked_sub(1)?;
        let curve = all
            .pointer(at + 1)
            .and_then(|list| numbers(file, list, 504)?.pointer(1 + 5 * index));
        // A vertex, such as a pole, cuts nothing away.
        if !(is_vertex && parameters.is_empty()) {
            pieces.push(Piece {
                parameters,
                space: curve,
            });
        }
        at += 5 + 2 * count;
    }
    Some(pieces)
}

/// Points along a curve; `None` for kinds that are not read.
fn sample(file: &File<'_>, id: u64, depth: usize, points: &mut Vec<Point3>) -> Option<()> {
    let entry = file.entry(id).filter(|_| depth < MOST_DEPTH)?;
    let numbers = Numbers::of(file, &entry)?;
    let before = points.len();
    let share = |k: usize| k as f64 / STEPS as f64;
    match entry.kind {
        102 => {
            for k in 0..numbers.count(0)? {
                sample(file, numbers.pointer(k + 1)?, depth + 1, points)?;
            }
        }
        110 => {
            let end = |k: usize| Some(Point3::from_slice(numbers.0.get(k..k + 3)?));
            let (from, to) = (end(0)?, end(3)?);
            points.extend((0..=STEPS).map(|k| from + (to - from) * share(k)));
        }
        100 => points.extend(arc(&numbers)?),
        106 => points.extend(polyline(&numbers)?),
        126 => spline(&numbers, points)?,
        _ => return None,
    }
    if let Some((turn, shift)) = placement(file, &[entry]).ok()? {
        for point in &mut points[before..] {
            *point = Point3::from(turn * point.coords + shift);
        }
    }
    points[before..]
        .iter()
        .all(|p| p.iter().all(|x| x.is_finite()))
        .then_some(())
}

/// An arc: height, centre, start, end, anticlockwise.
fn arc(numbers: &Numbers) -> Option<Vec<Point3>> {
    let &[z, x, y, from_x, from_y, to_x, to_y, ..] = &numbers.0[..] else {
        return None;
    };
    let angle = |dx: f64, dy: f64| libm::atan2(dy, dx);
    let (start, end) = (angle(from_x - x, from_y - y), angle(to_x - x, to_y - y));
    let round = std::f64::consts::TAU;
    let sweep = if end > start {
        end - start
    } else {
        end - start + round
    };
    let radius = libm::hypot(from_x - x, from_y - y);
    let at = |k: usize| start + sweep * k as f64 / STEPS as f64;
    let point = |angle: f64| {
        Point3::new(
            x + radius * libm::cos(angle),
            y + radius * libm::sin(angle),
            z,
        )
    };
    Some((0..=STEPS).map(|k| point(at(k))).collect())
}

/// A polyline: pairs at one height, triples, or triples with directions.
fn polyline(numbers: &Numbers) -> Option<Vec<Point3>> {
    let (first, width) = match numbers.count(0)? {
        1 => (3, 2),
        2 => (2, 3),
        3 => (2, 6),
        _ => return None,
    };
    let values = numbers.0.get(first..first + width * numbers.count(1)?)?;
    let z = numbers.at(2)?;
    let corners = values
        .chunks_exact(width)
        .map(|at| Point3::new(at[0], at[1], if width == 2 { z } else { at[2] }));
    let corners: Vec<Point3> = corners.collect();
    let line = |pair: &[Point3]| {
        let (from, way): (Point3, Vector3) = (pair[0], pair[1] - pair[0]);
        (0..=STEPS).map(move |k| from + way * (k as f64 / STEPS as f64))
    };
    Some(corners.windows(2).flat_map(line).collect())
}

/// Points of a rational B-spline curve: upper index, degree, four flags, knots, weights, points, range, normal.
///
/// So many in each span that a curve which has them all on the four edges has no others.
fn spline(numbers: &Numbers, points: &mut Vec<Point3>) -> Option<()> {
    let (count, degree) = (numbers.count(0)? + 1, numbers.count(1)?);
    let all = numbers.0.get(6..)?;
    let (knots, all) = all.split_at_checked(count + degree + 1)?;
    let (weights, all) = all.split_at_checked(count)?;
    let (places, all) = all.split_at_checked(3 * count)?;
    let knots = KnotVector::new(degree, knots.to_vec()).ok()?;
    let (low, high) = knots.domain();
    let (start, end) = (all.first()?.max(low), all.get(1)?.min(high));
    let steps = 4 * degree;
    for span in knots.spans() {
        let (from, to) = (
            knots.knots()[span].max(start),
            knots.knots()[span + 1].min(end),
        );
        if from > to {
            continue;
        }
        for k in 0..=steps {
            let window = knots.window(from + (to - from) * k as f64 / steps as f64);
            let mut sum = [0.0; 4];
            for (a, n) in window.order(0).iter().enumerate() {
                let i = (window.first + a) % count;
                let weight = n * weights[i];
                (0..3).for_each(|axis| sum[axis] += weight * places[3 * i + axis]);
                sum[3] += weight;
            }
            points.push(Point3::new(sum[0], sum[1], sum[2]) / sum[3]);
        }
    }
    Some(())
}
