//! How far a ball goes into a solid beyond what the solid's net shows, in a tick.

use super::{SceneState, Scratch};
use crate::scene::{BodyModel, Scene};
use crate::solve::indentation::{Indentation, Resolution};
use palpate_geometry::math::Vector3;

/// Finds it for a pair whose rows stand, and lets their gaps know.
///
/// The place and the direction are those of the last tick's forces: a contact point that hops from one
/// place to another has no force there yet, so what the ball goes in changes as forces do, not by
/// the hop.
pub(super) fn push(
    scene: &Scene,
    state: &SceneState,
    scratch: &mut Scratch,
    p: usize,
    radius_m: f64,
) {
    let BodyModel::Deforming(model) = &scene.bodies[scene.pairs[p].body].model else {
        return;
    };
    if model.resolution.is_empty() {
        return;
    }
    let Scratch {
        rows, indentations, ..
    } = scratch;
    let mut warm = (state.warm[..state.warm_len].iter())
        .filter(|old| old.id.pair as usize == p && !old.id.key.is_anchor())
        .peekable();
    let (mut carried_n, mut force_n) = (0.0, 0.0);
    let (mut carrying, mut touching) = (Place::default(), Place::default());
    for row in rows.of_pair().iter().filter(|row| !row.id.key.is_anchor()) {
        // Both lists are ordered by it.
        while let Some(old) = warm.next_if(|old| old.id < row.id) {
            force_n += old.force_n;
        }
        let (controls, weights) = rows.weights_in(row.on_body);
        let resolution = Resolution::blend(&model.resolution, controls, weights);
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
    let dent = Indentation::of(radius_m, &resolution, force_n, &normal);
    for row in rows.of_pair_mut() {
        if !row.id.key.is_anchor() {
            row.gap_m += dent.offset_m * row.normal.dot(&normal);
        }
    }
    indentations[p] = dent;
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
