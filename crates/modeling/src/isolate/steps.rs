//! The procedure of the methods 1 to 7: step while there is overlap, then back along the last step
//! to contact.

use super::Reason;
use super::directions::{DirectionRule, displacement};
use super::pair::Pair;
use super::search::SearchLimit;
use palpate_geometry::math::Vector3;

/// Most steps, as in the thesis' worst cases and some more.
pub(super) const MOST_STEPS: u32 = 20;
/// Halvings of the last step: its contact is found to a thousandth of it, as the published tables
/// were.
const HALVINGS: u32 = 10;

/// A free place reached by steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stepped {
    /// At contact, m.
    pub contact: Vector3,
    /// Unit vector of the last step.
    pub along: Vector3,
    /// Steps taken.
    pub steps: u32,
}

/// Steps until the bodies are apart. The pair overlaps at first.
pub(super) fn stepped(
    pair: &mut Pair<'_>,
    rule: DirectionRule,
    limit: &SearchLimit,
) -> Result<Stepped, Reason> {
    let mut at = Vector3::zeros();
    for steps in 1..=MOST_STEPS {
        let step = displacement(rule, pair, &at)?;
        let Some(along) = step.try_normalize(1e-12 * pair.diameter_m) else {
            return Err(Reason::NoNormal);
        };
        let next = at + step;
        if pair.overlap(&next) {
            at = next;
            continue;
        }
        let (mut inside, mut outside) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if pair.overlap(&(at + step * middle)) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        let contact = at + step * outside;
        return if limit.allows(pair, &contact) {
            Ok(Stepped {
                contact,
                along,
                steps,
            })
        } else {
            Err(Reason::Turned)
        };
    }
    Err(Reason::StepLimit { steps: MOST_STEPS })
}

/// Method 7: method 6 with five pairs of weights, the shortest.
pub(super) fn best_of_blends(pair: &mut Pair<'_>, limit: &SearchLimit) -> Result<Stepped, Reason> {
    let mut best: Result<Stepped, Reason> = Err(Reason::NoRegion);
    for (k, (a, b)) in [
        (1.0, 0.0),
        (0.75, 0.25),
        (0.5, 0.5),
        (0.25, 0.75),
        (0.0, 1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let found = stepped(pair, DirectionRule::Blend(a, b), limit);
        best = match (best, found) {
            (Ok(x), Ok(y)) => Ok(if y.contact.norm() < x.contact.norm() {
                y
            } else {
                x
            }),
            (Ok(x), Err(_)) | (Err(_), Ok(x)) => Ok(x),
            (Err(x), Err(y)) => Err(if k == 0 { y } else { x }),
        };
    }
    best
}
