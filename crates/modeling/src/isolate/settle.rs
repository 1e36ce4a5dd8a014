//! From contact to a gap of the wanted width: of the meshes, then of the surfaces themselves; and back towards the
//! start as far as the gap allows.

use super::Reason;
use super::pair::Pair;
use super::planes::{HalfSpace, keep, shortest};
use super::search::SearchLimit;
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::contact::{Contact, ContactSet, Reach};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{ClosestSolver, Surface};

/// The gap may be wider than asked for by this share.
const WIDER: f64 = 0.3;
/// What is aimed at, inside that, and how nearly.
const AIM: f64 = 0.1;
const NEARLY: f64 = 0.02;
/// How many gaps away the surfaces may be where the meshes have the right gap.
const LOOK_FAR: f64 = 16.0;
/// Contact planes that the next place respects: bodies may touch all round a ring.
const KEPT: usize = 12;
/// Rounds of shortening, the least gain of one that is worth the next, and how far it may lead:
/// shares of the length.
const MOST_ROUNDS: usize = 24;
const LEAST_GAIN: f64 = 1e-6;
const BESIDE: f64 = 0.25;
/// Most halvings of a push that leads into something.
const MOST_HALVINGS: usize = 12;
/// Most pushes.
const MOST_PUSHES: usize = 60;
/// Most steps back, and the least share of a step by which the gap is taken to narrow.
const MOST_TRIMS: usize = 100;
const GLANCING: f64 = 0.1;

/// Widens the gap of the meshes to `gap_m` or more, from a free place: along a unit vector, if one is given; by the
/// shortest way that the contact planes seen so far allow; straight on. The shortest of these, so that what leads to a
/// wider gap is no shorter than what leads to this one.
pub(super) fn settled(
    pair: &mut Pair<'_>,
    limit: &SearchLimit,
    from: &Vector3,
    along: Option<Vector3>,
    gap_m: f64,
) -> Result<Vector3, Reason> {
    if pair.nearest(from).gap_m >= gap_m {
        return Ok(*from);
    }
    let onward = from.try_normalize(0.0);
    let ways = [
        along.and_then(|along| pushed_along(pair, from, along, gap_m)),
        pushed(pair, from, gap_m),
        onward.and_then(|onward| pushed_along(pair, from, onward, gap_m)),
    ];
    let mut found: Result<Vector3, Reason> = Err(Reason::NoGap);
    for place in ways.into_iter().flatten() {
        found = match found {
            Ok(best) if !limit.allows(pair, &place) || place.norm() >= best.norm() => Ok(best),
            Err(_) if !limit.allows(pair, &place) => Err(Reason::Turned),
            _ => Ok(place),
        };
    }
    found
}

fn pushed_along(
    pair: &mut Pair<'_>,
    from: &Vector3,
    along: Vector3,
    gap_m: f64,
) -> Option<Vector3> {
    let mut at = *from;
    for _ in 0..MOST_PUSHES {
        let gap = pair.nearest(&at).gap_m;
        if gap >= gap_m {
            return Some(at);
        }
        // The gap widens by no more than the push.
        at += along * (gap_m * (1.0 + AIM) - gap);
        if pair.overlap(&at) {
            return None;
        }
    }
    None
}

/// By contact planes: each place that is too near adds one.
fn pushed(pair: &mut Pair<'_>, from: &Vector3, gap_m: f64) -> Option<Vector3> {
    let mut at = *from;
    let mut planes = Vec::new();
    for _ in 0..MOST_PUSHES {
        let near = pair.nearest(&at);
        if near.gap_m >= gap_m {
            return Some(at);
        }
        // Bodies that touch have no normal between them: away from the fixed body's centroid.
        let normal = near
            .normal
            .or_else(|| (pair.between_centroids() + at).try_normalize(0.0))?;
        let at_least = normal.dot(&(at - from)) + gap_m * (1.0 + AIM) - near.gap_m;
        keep(&mut planes, HalfSpace { normal, at_least }, KEPT);
        at = from + shortest(&planes)?;
        // Into something else: as far as is free, whose contact plane is the next one.
        for _ in 0..MOST_HALVINGS {
            if !pair.overlap(&at) {
                break;
            }
            at = from + (at - from) * 0.5;
        }
        if pair.overlap(&at) {
            return None;
        }
    }
    None
}

/// From a place with a gap of `gap_m` or more straight towards the start, as far as the gap stays: to a gap of `gap_m` …
/// 1.3 `gap_m`, or to the start itself. The place and its gap.
///
/// On this way the length falls with the gap, whatever the gap that is asked for, and there is one for each gap: before
/// the start, where the bodies overlap, the gap goes through all widths. `gap_at` is below `gap_m`, or negative,
/// where bodies overlap.
pub(super) fn trimmed(
    from: &Vector3,
    gap_there_m: f64,
    gap_m: f64,
    gap_at: &mut dyn FnMut(&Vector3) -> f64,
) -> (Vector3, f64) {
    let (aim, enough) = (gap_m * (1.0 + AIM), gap_m * (1.0 + AIM + NEARLY));
    // Shares of the way, with their gaps: wide enough, and not.
    let (mut far, mut near): (_, Option<(f64, f64)>) = ((1.0, gap_there_m), None);
    let length = from.norm();
    let mut slope = 1.0;
    for _ in 0..MOST_TRIMS {
        if far.1 <= enough || length <= 0.0 {
            break;
        }
        let next = match near {
            // The gap narrows by no more than the way.
            None => (far.0 - (far.1 - aim) / (slope * length)).max(0.0),
            Some((at, gap)) if gap.is_finite() => {
                let share = (aim - gap) / (far.1 - gap);
                at + (far.0 - at) * share.clamp(0.02, 0.98)
            }
            Some((at, _)) => 0.5 * (at + far.0),
        };
        if next >= far.0 || near.is_some_and(|(at, _)| next <= at) {
            break;
        }
        let gap = gap_at(&(from * next));
        if gap >= gap_m {
            slope = ((far.1 - gap) / ((far.0 - next) * length)).clamp(GLANCING, 1.0);
            far = (next, gap);
            if next <= 0.0 {
                break;
            }
        } else {
            near = Some((next, gap));
        }
    }
    (from * far.0, far.1)
}

/// The surfaces themselves, without triangles.
pub(super) struct Exact {
    moved: Surface,
    moving: Surface,
    fixed: Surface,
    solvers: [ClosestSolver; 2],
    pair: PairSolver,
    contacts: ContactSet,
    /// Of both, m.
    size_m: f64,
}

impl Exact {
    pub fn new(moving: &Surface, fixed: &Surface) -> Self {
        // A pole or a seam that is off by rounding stays as it is: only the outward side matters
        // here.
        let (moving, fixed) = (
            moving.clone().oriented_outward(),
            fixed.clone().oriented_outward(),
        );
        Self {
            solvers: [ClosestSolver::new(&fixed), ClosestSolver::new(&moving)],
            pair: PairSolver::new(&fixed, &moving),
            contacts: ContactSet::new(),
            size_m: fixed.size() + moving.size(),
            moved: moving.clone(),
            moving,
            fixed,
        }
    }

    /// Looks for contacts, and gaps up to `margin_m`, with the moving surface moved.
    fn look(&mut self, by: &Vector3, margin_m: f64) {
        for (to, from) in self
            .moved
            .net_mut()
            .points_mut()
            .iter_mut()
            .zip(self.moving.net().points())
        {
            *to = from + by;
        }
        let [fixed_solver, moved_solver] = &mut self.solvers;
        moved_solver.net_changed();
        let body = PairSide {
            surface: &self.fixed,
            solver: fixed_solver,
        };
        let tool = PairSide {
            surface: &self.moved,
            solver: moved_solver,
        };
        self.pair.contacts(
            body,
            tool,
            Reach {
                margin_m,
                below: false,
                closing_m: 0.0,
            },
            &mut self.contacts,
        );
    }

    /// Looks as far as it needs to find a contact, from a margin on.
    fn look_for(&mut self, by: &Vector3, margin_m: f64) -> Option<Contact> {
        let mut reach_m = margin_m;
        loop {
            self.look(by, reach_m);
            let deepest = self.contacts.deepest().copied();
            if deepest.is_some() || reach_m > self.size_m {
                return deepest;
            }
            reach_m *= LOOK_FAR;
        }
    }

    /// Gap of the surfaces at a place, negative for a depth, with a guess how wide it is. `None` where they are far
    /// apart.
    pub fn gap_m(&mut self, by: &Vector3, guess_m: f64) -> Option<f64> {
        Some(-self.look_for(by, guess_m)?.depth_m)
    }

    /// Moves on from a place where the meshes are apart until the surfaces are apart by `gap_m` …
    /// 1.3 `gap_m`. Along a unit vector, if one is given, or the shortest way. The place and the
    /// gap there.
    pub fn settled(
        &mut self,
        start: &Vector3,
        from: &Vector3,
        along: Option<Vector3>,
        gap_m: f64,
    ) -> Option<(Vector3, f64)> {
        let (aim, margin) = (gap_m * (1.0 + AIM), gap_m * (1.0 + WIDER));
        let (mut from, mut at) = (*from, *from);
        let mut planes: Vec<HalfSpace> = Vec::new();
        for _ in 0..MOST_PUSHES {
            // Meshes lie inside convex and outside hollow parts, so the gap can also be too wide by
            // what they miss.
            let reach = if planes.is_empty() {
                LOOK_FAR * margin
            } else {
                margin
            };
            let deepest = self.look_for(&(start + at), reach)?;
            let gap = -deepest.depth_m;
            if (gap_m..=margin).contains(&gap) {
                return Some((at, gap));
            }
            if let Some(along) = along {
                at += along * (aim - gap);
                continue;
            }
            if gap > margin {
                at += deepest.normal * (aim - gap);
                from = at;
                planes.clear();
                continue;
            }
            for contact in self.contacts.contacts().iter().take(KEPT / 3) {
                let at_least = contact.normal.dot(&(at - from)) + aim + contact.depth_m;
                keep(
                    &mut planes,
                    HalfSpace {
                        normal: contact.normal,
                        at_least,
                    },
                    KEPT,
                );
            }
            at = from + shortest(&planes)?;
        }
        None
    }

    /// A shorter way than `from` with the same gap, beside it: the triangles' shortest way leans a
    /// little to one of their corners. Contact planes of the surfaces, until nothing is gained;
    /// planes add up while they lead into overlap.
    pub fn shortened(
        &mut self,
        start: &Vector3,
        from: &Vector3,
        gap_m: f64,
    ) -> Option<(Vector3, f64)> {
        let (aim, margin) = (gap_m * (1.0 + AIM), gap_m * (1.0 + WIDER));
        let (mut at, mut least, mut best) = (*from, from.norm(), None);
        let mut planes: Vec<HalfSpace> = Vec::new();
        for round in 0..MOST_ROUNDS {
            let Some(deepest) = self.look_for(&(start + at), LOOK_FAR * margin) else {
                break;
            };
            let gap = -deepest.depth_m;
            if gap >= gap_m {
                planes.clear();
            }
            if (gap_m..=margin).contains(&gap) {
                let gain = least - at.norm();
                if gain > 0.0 {
                    (least, best) = (at.norm(), Some((at, gap)));
                }
                if round > 0 && gain < LEAST_GAIN * least {
                    break;
                }
            }
            for contact in self.contacts.contacts().iter().take(KEPT / 3) {
                let at_least = contact.normal.dot(&at) + aim + contact.depth_m;
                keep(
                    &mut planes,
                    HalfSpace {
                        normal: contact.normal,
                        at_least,
                    },
                    KEPT,
                );
            }
            let Some(next) = shortest(&planes) else { break };
            // What is known of the surfaces here says nothing about places far away.
            if (next - at).norm() > BESIDE * from.norm() {
                break;
            }
            at = next;
        }
        best
    }
}
