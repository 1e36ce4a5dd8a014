//! How far a tool goes into a solid beyond what the solid's net shows, in a tick.

use super::search::{PairState, Search};
use super::{face, profile};
use crate::solve::indentation::{EASE, Indentation, Resolution, Touch};
use crate::solve::matrix::ContactMatrix;
use crate::solve::rows::{MAX_ROWS_PER_PAIR, Row, RowSet};
use crate::solve::solver::{Solver, Touching};
use palpate_geometry::math::{Point3, Pose, Vector3};

/// Finds where a pair whose rows stand touches.
///
/// The place and the direction are those of the last tick's forces: a contact point that hops from one
/// place to another has no force there yet, so what the ball goes in changes as forces do, not by
/// the hop.
pub(super) fn touch(search: &mut Search<'_>, p: usize, t: usize, pose: &Pose) {
    let Search {
        scene,
        warm,
        bodies,
        rows,
        narrow,
        touches,
        pairs,
        ..
    } = search;
    let pair = &scene.pairs[p];
    let party = scene.party(pair.body);
    let of_controls = party.resolution();
    if of_controls.is_empty() || !pair.near_field {
        return;
    }
    let shape = &scene.tools[t].shape;
    let Some(surface) = bodies[pair.body].skin.surface() else {
        return;
    };
    let has_edges = shape.features().is_some();
    let mut warm = (warm.of_pair(p).iter())
        .filter(|old| !old.id.key.is_anchor())
        .peekable();
    let (mut carried_n, mut force_n, mut deep_m) = (0.0, 0.0, 0.0_f64);
    let mut forces = [(Point3::origin(), 0.0); MAX_ROWS_PER_PAIR];
    let mut count = 0;
    let (mut carrying, mut touching) = (Place::default(), Place::default());
    for row in rows.of_pair().iter().filter(|row| pushes(row)) {
        // Both lists are ordered by it.
        while let Some(old) = warm.next_if(|old| old.id < row.id) {
            force_n += old.force_n;
        }
        deep_m = deep_m.max(-row.now_m);
        let (controls, weights) = rows.weights_in(row.on_body);
        let resolution = Resolution::blend(of_controls, controls, weights);
        let outward = |row: &Row| match has_edges {
            true => surface.normal(row.u, row.v),
            false => row.normal,
        };
        touching.add((-row.gap_m).max(0.0), &resolution, row, outward);
        if let Some(old) = warm.next_if(|old| old.id == row.id) {
            force_n += old.force_n;
            carried_n += old.force_n;
            carrying.add(old.force_n, &resolution, row, outward);
            if old.force_n > 0.0 && count < forces.len() {
                forces[count] = (row.point, old.force_n);
                count += 1;
            }
        }
    }
    force_n += warm.map(|old| old.force_n).sum::<f64>();
    // At first it is where the tool is deepest.
    let place = if carried_n > 0.0 { carrying } else { touching };
    let Some((mut place, point, normal, outward)) = place.mean() else {
        return;
    };
    if place.patch_m <= 0.0 {
        return;
    }
    // Where many rows push, which of them do changes with how far the tool goes in.
    let last_m = pairs[p].patch_m;
    if last_m > 0.0 {
        place.patch_m = last_m + EASE * (place.patch_m - last_m);
    }
    let over = (&point, &normal, deep_m);
    let Some(profile) = profile::of(shape, &narrow[p], pose, over, &place) else {
        return;
    };
    let at = face::Place {
        point: &point,
        outward: &outward,
        bounds: &bodies[pair.body].bounds,
        patch_m: place.patch_m,
    };
    let face = face::of(shape, &narrow[p], pose, &at).unwrap_or_default();
    let normal = match face.share {
        0.0 => normal,
        share => (normal * (1.0 - share) + face.normal * share).normalize(),
    };
    let thick = (1.0 / (place.thin_1_m * place.patch_m)).min(1.0);
    touches[p] = Touch {
        profile,
        flat_1_m: thick * face.missing_1_m,
        most_m: shape
            .reach_m()
            .unwrap_or(f64::INFINITY)
            .min(1.0 / place.thin_1_m),
        place,
        normal,
        force_n,
        share: together(&forces[..count], place.patch_m),
        beside_n: 0.0,
        point,
        less_m: pairs[p].less_m,
        drawn_m: pairs[p].drawn_m,
        mu: pair.friction.map_or(0.0, |friction| friction.mu),
    };
}

/// Which share of pushes is in one place, of this radius: 1 where all are, one half of two that are far
/// from each other.
fn together(pushes: &[(Point3, f64)], patch_m: f64) -> f64 {
    let (mut near, mut all) = (0.0, 0.0);
    for (k, (point, force_n)) in pushes.iter().enumerate() {
        near += force_n * force_n;
        all += force_n;
        for (other, other_n) in &pushes[..k] {
            near += 2.0 * force_n * other_n * beside(point, other, patch_m);
        }
    }
    if all > 0.0 { near / (all * all) } else { 1.0 }
}

/// How much of a push is in the place of another: 1 of one at the same point, 0 far away.
fn beside(a: &Point3, b: &Point3, patch_m: f64) -> f64 {
    let far = (a - b).norm_squared() / (TOGETHER * patch_m).powi(2);
    1.0 / ((1.0 + far) * (1.0 + far))
}

/// Pushes this far from each other, relative to the patch, are a quarter in one place.
const TOGETHER: f64 = 2.5;

/// Finds how far tools go in, once it is known how the rows give way, and lets their gaps and the matrix know.
pub(crate) fn settle(rows: &mut RowSet, solver: &mut Solver) {
    let Solver {
        matrix,
        touches,
        indentations,
        touching,
        ..
    } = solver;
    let rows = &mut rows.rows;
    let mut start = 0;
    for of_pair in rows.chunk_by(|a, b| a.id.pair == b.id.pair) {
        let own = start..start + of_pair.len();
        start = own.end;
        let p = of_pair[0].id.pair as usize;
        if touches[p].place.patch_m > 0.0 {
            touching.push((p, own));
        }
    }
    for one in touching.iter() {
        let of =
            |other: &Touching| shared(touches, rows, one, other) * touches[other.0].in_place_n();
        touches[one.0].beside_n = touching.iter().map(of).sum();
    }
    for (p, own) in touching.iter() {
        let pushing = own.clone().filter(|&i| pushes(&rows[i]));
        let Some(deepest) = pushing.min_by(|&i, &j| rows[i].gap_m.total_cmp(&rows[j].gap_m)) else {
            continue;
        };
        let indentation = touches[*p].indentation(-rows[deepest].gap_m, matrix.along(deepest));
        indentations[*p] = indentation;
        for row in rows[own.clone()].iter_mut().filter(|row| pushes(row)) {
            row.gap_m += indentation.offset_m * row.normal.dot(&indentation.normal);
        }
        if indentation.slope_m_n == 0.0 {
            continue;
        }
        let block = indentation.block_m_n();
        for i in own.clone().filter(|&i| pushes(&rows[i])) {
            for j in (own.start..=i).filter(|&j| pushes(&rows[j])) {
                matrix.add(i, j, &block);
            }
        }
    }
    for (k, one) in touching.iter().enumerate() {
        for other in &touching[..k] {
            couple(rows, matrix, (touches, indentations), one, other);
        }
    }
}

/// What the forces of two tools beside each other make of each other's way in, beyond those of the last tick.
fn couple(
    rows: &mut [Row],
    matrix: &mut ContactMatrix,
    (touches, indentations): (&[Touch], &[Indentation]),
    one: &Touching,
    other: &Touching,
) {
    let [a, b] = [one, other].map(|(p, _)| &indentations[*p]);
    let slope_m_n = shared(touches, rows, one, other) * (a.slope_m_n * b.slope_m_n).sqrt();
    if slope_m_n == 0.0 {
        return;
    }
    for (mine, normal, theirs) in [(one, a.normal, other), (other, b.normal, one)] {
        let moved_m = slope_m_n * touches[theirs.0].force_n;
        for row in rows[mine.1.clone()].iter_mut().filter(|row| pushes(row)) {
            row.gap_m -= moved_m * row.normal.dot(&normal);
        }
    }
    let block = a.normal * b.normal.transpose() * slope_m_n;
    for i in one.1.clone().filter(|&i| pushes(&rows[i])) {
        for j in other.1.clone().filter(|&j| pushes(&rows[j])) {
            matrix.add(i, j, &block);
        }
    }
}

/// How much of the push of one pair is in the place of another.
fn shared(touches: &[Touch], rows: &[Row], (p, of_p): &Touching, (q, of_q): &Touching) -> f64 {
    if p == q || rows[of_p.start].body != rows[of_q.start].body {
        return 0.0;
    }
    let (one, other) = (&touches[*p], &touches[*q]);
    let patch_m = one.place.patch_m.min(other.place.patch_m);
    one.normal.dot(&other.normal).max(0.0) * beside(&one.point, &other.point, patch_m)
}

/// A grip's anchor has no patch.
fn pushes(row: &Row) -> bool {
    !row.id.key.is_anchor()
}

/// Keeps how far tools went in.
pub(crate) fn remember(rows: &RowSet, solver: &Solver, pairs: &mut [PairState]) {
    for (pair, touch) in pairs.iter_mut().zip(&solver.touches) {
        (pair.sunk_m, pair.patch_m) = (0.0, touch.place.patch_m);
        pair.drawn_m = Vector3::zeros();
        if pair.patch_m == 0.0 {
            pair.less_m = 0.0;
        }
    }
    for (p, own) in &solver.touching {
        let (pair, indentation) = (&mut pairs[*p], &solver.indentations[*p]);
        let along = |i: usize| {
            solver.force_n(i).dot(&rows.rows[i].normal)
                * rows.rows[i].normal.dot(&indentation.normal)
        };
        let pushing = || own.clone().filter(|&i| pushes(&rows.rows[i]));
        let force_n: f64 = pushing().map(along).sum();
        let whole_n: Vector3 = pushing().map(|i| solver.force_n(i)).sum();
        let across_n = whole_n - indentation.normal * whole_n.dot(&indentation.normal);
        pair.drawn_m = solver.touches[*p].left_m() - across_n * indentation.across_m_n;
        pair.sunk_m = indentation.offset_m + indentation.slope_m_n * force_n;
        pair.less_m += EASE * (solver.touches[*p].less_under_m(force_n) - pair.less_m);
    }
}

/// Rows with their shares.
#[derive(Default)]
struct Place {
    whole: f64,
    resolution: Resolution,
    point: Vector3,
    normal: Vector3,
    /// Of the body's surface, on the side of the rows.
    outward: Vector3,
}

impl Place {
    /// `outward`: of the body's surface at a row, on either side.
    fn add(
        &mut self,
        share: f64,
        resolution: &Resolution,
        row: &Row,
        outward: impl Fn(&Row) -> Vector3,
    ) {
        if share == 0.0 {
            return;
        }
        let outward = outward(row);
        self.whole += share;
        self.resolution.add(share, resolution);
        self.point += row.point.coords * share;
        self.normal += row.normal * share;
        self.outward += outward * (share * outward.dot(&row.normal));
    }

    /// None without rows, or where they push in opposite directions.
    fn mean(&self) -> Option<(Resolution, Point3, Vector3, Vector3)> {
        let normal = self.normal.try_normalize(1e-3 * self.whole)?;
        let mut mean = Resolution::default();
        mean.add(1.0 / self.whole, &self.resolution);
        let outward = self.outward.try_normalize(0.0).unwrap_or(normal);
        Some((mean, (self.point / self.whole).into(), normal, outward))
    }
}
