//! How far a ball goes into a solid beyond what the solid's net shows, in a tick.

use super::warm::Warm;
use crate::scene::Scene;
use crate::solve::indentation::{Indentation, Resolution, Touch};
use crate::solve::rows::RowSet;
use crate::solve::solver::Solver;
use palpate_geometry::math::Vector3;

/// Finds where a pair whose rows stand touches.
///
/// The place and the direction are those of the last tick's forces: a contact point that hops from one
/// place to another has no force there yet, so what the ball goes in changes as forces do, not by
/// the hop.
pub(crate) fn touch(
    scene: &Scene,
    warm: &Warm,
    rows: &RowSet,
    touches: &mut [Touch],
    p: usize,
    radius_m: f64,
) {
    let party = scene.party(scene.pairs[p].body);
    let of_controls = party.resolution();
    if of_controls.is_empty() {
        return;
    }
    let mut warm = (warm.of_pair(p))
        .filter(|old| !old.id.key.is_anchor())
        .peekable();
    let (mut carried_n, mut force_n) = (0.0, 0.0);
    let (mut carrying, mut touching) = (Place::default(), Place::default());
    for row in rows.of_pair().iter().filter(|row| !row.id.key.is_anchor()) {
        // Both lists are ordered by it.
        while let Some(old) = warm.next_if(|old| old.id < row.id) {
            force_n += old.force_n;
        }
        let (controls, weights) = rows.weights_in(row.on_body);
        let resolution = Resolution::blend(of_controls, controls, weights);
        touching.add(1.0, &resolution, &row.normal);
        if let Some(old) = warm.next_if(|old| old.id == row.id) {
            force_n += old.force_n;
            carried_n += old.force_n;
            carrying.add(old.force_n, &resolution, &row.normal);
        }
    }
    force_n += warm.map(|old| old.force_n).sum::<f64>();
    let place = if carried_n > 0.0 { carrying } else { touching };
    let Some((resolution, normal)) = place.mean() else {
        return;
    };
    touches[p] = Touch {
        radius_m,
        place: resolution,
        normal,
        force_n,
    };
}

/// Finds how far balls go in, once it is known how the rows give way, and lets their gaps and the matrix know.
pub(crate) fn settle(rows: &mut RowSet, solver: &mut Solver) {
    let Solver {
        matrix,
        touches,
        indentations,
        ..
    } = solver;
    indentations.fill(Indentation::default());
    let mut start = 0;
    for of_pair in rows.rows.chunk_by_mut(|a, b| a.id.pair == b.id.pair) {
        let first = start;
        start += of_pair.len();
        let p = of_pair[0].id.pair as usize;
        let pushing = (of_pair.iter().enumerate()).filter(|(_, row)| !row.id.key.is_anchor());
        let deepest = pushing.min_by(|(_, a), (_, b)| a.gap_m.total_cmp(&b.gap_m));
        let Some((i, row)) = deepest.filter(|_| touches[p].radius_m > 0.0) else {
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

/// Rows with their shares.
#[derive(Default)]
struct Place {
    whole: f64,
    resolution: Resolution,
    normal: Vector3,
}

impl Place {
    fn add(&mut self, share: f64, resolution: &Resolution, normal: &Vector3) {
        self.whole += share;
        self.resolution.add(share, resolution);
        self.normal += normal * share;
    }

    /// None without rows, or where they push in opposite directions.
    fn mean(&self) -> Option<(Resolution, Vector3)> {
        let normal = self.normal.try_normalize(1e-3 * self.whole)?;
        let mut mean = Resolution::default();
        mean.add(1.0 / self.whole, &self.resolution);
        Some((mean, normal))
    }
}
