//! Several bodies: pair after pair, until a pass moves nothing.
//!
//! Of two bodies that overlap, or are nearer than the gap, the one listed first stays and the other
//! moves. A pass takes all pairs in the order (0, 1), (0, 2), (1, 2), (0, 3), …; body 0 never
//! moves. Moving apart from one body may push a body into another, which a later pass takes apart
//! again; bodies may push each other to and fro for ever, so passes are bounded.

use super::grid;
use super::pair::Pair;
use super::{
    Body, IsolateError, IsolateSpec, IsolateStatus, Isolated, Reason, Resolution, isolate_ready,
};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;

/// Most passes over all pairs.
const MOST_PASSES: usize = 20;

/// One pair that was taken apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Number of the pass, from 1.
    pub pass: usize,
    /// Number of the body that moved, from 0.
    pub moving: usize,
    /// Number of the body that stayed.
    pub fixed: usize,
    /// How; its translation is from where the body stood then.
    pub answer: Isolated,
}

/// Why some bodies still overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsettled {
    /// A pair has no answer.
    #[error("body {moving} could not be taken away from body {fixed}: {reason}")]
    Pair {
        /// The one to move.
        moving: usize,
        /// The one to stay.
        fixed: usize,
        /// Why not.
        reason: Reason,
    },
    /// Bodies push each other to and fro.
    #[error(
        "bodies still push each other after {passes} passes, the last ones {fixed} and {moving}"
    )]
    Passes {
        /// Passes made.
        passes: usize,
        /// The one that moved last.
        moving: usize,
        /// The one that it moved from.
        fixed: usize,
    },
}

/// The answer for several bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct IsolatedAll {
    /// (body count) what to move each body by, m. Where `unsettled` is set: how far things came.
    pub translations_m: Vec<Vector3>,
    /// Everything that was moved, in order.
    pub moves: Vec<Move>,
    /// Passes over all pairs; the last one moved nothing, unless `unsettled`.
    pub passes: usize,
    /// Why not all pairs are apart; `None` when they are.
    pub unsettled: Option<Unsettled>,
}

/// Isolates all pairs of bodies.
///
/// # Errors
/// Fewer than two; and as [`isolate`](super::isolate).
pub fn isolate_all(surfaces: &[Surface], spec: &IsolateSpec) -> Result<IsolatedAll, IsolateError> {
    if surfaces.len() < 2 {
        return Err(IsolateError::TooFew(surfaces.len()));
    }
    let bodies: Vec<Body> = surfaces
        .iter()
        .enumerate()
        .map(|(k, surface)| {
            let cells = match spec.resolution {
                Resolution::Cells(cells) => cells,
                Resolution::Usual | Resolution::Halving => grid::usual_cells(surface),
            };
            Body::new(surface, cells, k)
        })
        .collect::<Result<_, _>>()?;
    let mut all = IsolatedAll {
        translations_m: vec![Vector3::zeros(); surfaces.len()],
        moves: Vec::new(),
        passes: 0,
        unsettled: None,
    };
    for pass in 1..=MOST_PASSES {
        all.passes = pass;
        let mut last = None;
        for moving in 1..bodies.len() {
            for fixed in 0..moving {
                let start = all.translations_m[moving] - all.translations_m[fixed];
                if far_apart(&bodies[moving], &bodies[fixed], &start, spec) {
                    continue;
                }
                let (a, b) = (
                    (&surfaces[moving], &bodies[moving]),
                    (&surfaces[fixed], &bodies[fixed]),
                );
                let answer = isolate_ready(a, b, &start, spec)?;
                match answer.status {
                    IsolateStatus::Apart => {}
                    IsolateStatus::Isolated => {
                        all.translations_m[moving] += answer.translation_m;
                        all.moves.push(Move {
                            pass,
                            moving,
                            fixed,
                            answer,
                        });
                        last = Some((moving, fixed));
                    }
                    IsolateStatus::Failed(reason) => {
                        all.unsettled = Some(Unsettled::Pair {
                            moving,
                            fixed,
                            reason,
                        });
                        return Ok(all);
                    }
                }
            }
        }
        let Some((moving, fixed)) = last else {
            all.unsettled = None;
            return Ok(all);
        };
        all.unsettled = Some(Unsettled::Passes {
            passes: pass,
            moving,
            fixed,
        });
    }
    Ok(all)
}

/// Boxes of the triangles so far apart that the surfaces must be too.
fn far_apart(moving: &Body, fixed: &Body, start: &Vector3, spec: &IsolateSpec) -> bool {
    let pair = Pair::new(moving, fixed, *start);
    let margin = spec.gap_m.unwrap_or(0.0).max(0.05 * pair.diameter_m);
    !moving.block().meets(start, fixed.block(), margin)
}
