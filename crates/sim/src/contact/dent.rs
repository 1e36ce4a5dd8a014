//! How far a tool goes into a solid beyond what the solid's net shows, in a tick.

use super::profile;
use super::search::{PairState, Search};
use crate::solve::indentation::{EASE, Resolution, Touch};
use crate::solve::rows::{MAX_ROWS_PER_PAIR, Row, RowSet};
use crate::solve::solver::Solver;
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
    let mut warm = (warm.of_pair(p))
        .filter(|old| !old.id.key.is_anchor())
        .peekable();
    let (mut carried_n, mut force_n, mut deep_m) = (0.0, 0.0, 0.0_f64);
    let mut pushes = [(Point3::origin(), 0.0); MAX_ROWS_PER_PAIR];
    let mut count = 0;
    let (mut carrying, mut touching) = (Place::default(), Place::default());
    for row in rows.of_pair().iter().filter(|row| !row.id.key.is_anchor()) {
        // Both lists are ordered by it.
        while let Some(old) = warm.next_if(|old| old.id < row.id) {
            force_n += old.force_n;
        }
        deep_m = deep_m.max(-row.now_m);
        let (controls, weights) = rows.weights_in(row.on_body);
        let resolution = Resolution::blend(of_controls, controls, weights);
        touching.add((-row.gap_m).max(0.0), &resolution, row);
        if let Some(old) = warm.next_if(|old| old.id == row.id) {
            force_n += old.force_n;
            carried_n += old.force_n;
            carrying.add(old.force_n, &resolution, row);
            if old.force_n > 0.0 && count < pushes.len() {
                pushes[count] = (row.point, old.force_n);
                count += 1;
            }
        }
    }
    force_n += warm.map(|old| old.force_n).sum::<f64>();
    // At first it is where the tool is deepest.
    let place = if carried_n > 0.0 { carrying } else { touching };
    let Some((mut place, point, normal)) = place.mean() else {
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
    let shape = &scene.tools[t].shape;
    let over = (&point, &normal, deep_m);
    let Some(profile) = profile::of(shape, &narrow[p], pose, over, place.patch_m) else {
        return;
    };
    touches[p] = Touch {
        profile: profile.on(place.curvature_1_m),
        most_m: shape
            .reach_m()
            .unwrap_or(f64::INFINITY)
            .min(1.0 / place.thin_1_m),
        place,
        normal,
        force_n,
        share: together(&pushes[..count], TOGETHER * place.patch_m),
        less_m: pairs[p].less_m,
    };
}

/// Which share of pushes is in one place, of this radius: 1 where all are, one half of two that are far
/// from each other.
fn together(pushes: &[(Point3, f64)], radius_m: f64) -> f64 {
    let (mut near, mut all) = (0.0, 0.0);
    for (k, (point, force_n)) in pushes.iter().enumerate() {
        near += force_n * force_n;
        all += force_n;
        for (other, other_n) in &pushes[..k] {
            let far = (point - other).norm_squared() / (radius_m * radius_m);
            near += 2.0 * force_n * other_n / ((1.0 + far) * (1.0 + far));
        }
    }
    if all > 0.0 { near / (all * all) } else { 1.0 }
}

/// Pushes this far from each other, relative to the patch, are half in one place.
const TOGETHER: f64 = 2.5;

/// Finds how far tools go in, once it is known how the rows give way, and lets their gaps and the matrix know.
pub(crate) fn settle(rows: &mut RowSet, solver: &mut Solver) {
    let Solver {
        matrix,
        touches,
        indentations,
        ..
    } = solver;
    let mut start = 0;
    for of_pair in rows.rows.chunk_by_mut(|a, b| a.id.pair == b.id.pair) {
        let first = start;
        start += of_pair.len();
        let p = of_pair[0].id.pair as usize;
        let pushing = (of_pair.iter().enumerate()).filter(|(_, row)| !row.id.key.is_anchor());
        let deepest = pushing.min_by(|(_, a), (_, b)| a.gap_m.total_cmp(&b.gap_m));
        let Some((i, row)) = deepest.filter(|_| touches[p].place.patch_m > 0.0) else {
            continue;
        };
        let own = matrix.along(first + i);
        let dent = touches[p].indentation(-row.gap_m, own);
        for row in of_pair.iter_mut().filter(|row| !row.id.key.is_anchor()) {
            row.gap_m += dent.offset_m * row.normal.dot(&dent.normal);
        }
        indentations[p] = dent;
        if dent.slope_m_n == 0.0 {
            continue;
        }
        let block = dent.normal * dent.normal.transpose() * dent.slope_m_n;
        let pushes = |i: &usize| !of_pair[*i].id.key.is_anchor();
        for i in (0..of_pair.len()).filter(pushes) {
            for j in (0..=i).filter(pushes) {
                matrix.add(first + i, first + j, &block);
            }
        }
    }
}

/// Keeps how far tools went in.
pub(crate) fn remember(rows: &RowSet, solver: &Solver, pairs: &mut [PairState]) {
    let own = |i: usize| {
        let row = &rows.rows[i];
        (!row.id.key.is_anchor()).then(|| solver.force_n(i).dot(&row.normal))
    };
    let mut start = 0;
    let of_pairs = rows.rows.chunk_by(|a, b| a.id.pair == b.id.pair);
    let mut of_pairs = of_pairs.peekable();
    for (p, pair) in pairs.iter_mut().enumerate() {
        let rows = of_pairs
            .next_if(|rows| rows[0].id.pair as usize == p)
            .unwrap_or(&[]);
        let each = start..start + rows.len();
        start += rows.len();
        let (touch, dent) = (&solver.touches[p], &solver.indentations[p]);
        let along = |i: usize| {
            own(i).map(|force_n| force_n * rows[i - each.start].normal.dot(&dent.normal))
        };
        let force_n: f64 = each.clone().filter_map(along).sum();
        pair.patch_m = touch.place.patch_m;
        pair.sunk_m = dent.offset_m + dent.slope_m_n * force_n;
        pair.less_m = if pair.patch_m > 0.0 {
            pair.less_m + EASE * (touch.less_under_m(force_n) - pair.less_m)
        } else {
            0.0
        };
    }
}

/// Rows with their shares.
#[derive(Default)]
struct Place {
    whole: f64,
    resolution: Resolution,
    point: Vector3,
    normal: Vector3,
}

impl Place {
    fn add(&mut self, share: f64, resolution: &Resolution, row: &Row) {
        self.whole += share;
        self.resolution.add(share, resolution);
        self.point += row.point.coords * share;
        self.normal += row.normal * share;
    }

    /// None without rows, or where they push in opposite directions.
    fn mean(&self) -> Option<(Resolution, Point3, Vector3)> {
        let normal = self.normal.try_normalize(1e-3 * self.whole)?;
        let mut mean = Resolution::default();
        mean.add(1.0 / self.whole, &self.resolution);
        Some((mean, (self.point / self.whole).into(), normal))
    }
}
