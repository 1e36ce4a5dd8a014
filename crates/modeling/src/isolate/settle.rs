//! From contact to a gap of the wanted width: of the meshes, then of the surfaces themselves.

use super::Reason;
use super::pair::Pair;
use super::planes::{HalfSpace, keep, shortest};
use super::search::SearchLimit;
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::contact::{ContactSet, Reach};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{ClosestSolver, Surface};

/// The gap may be wider than asked for by this share.
pub(super) const WIDER: f64 = 0.3;
/// What is aimed at, inside that.
const AIM: f64 = 0.1;
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

/// Widens the gap of the meshes to `gap_m` … 1.3 `gap_m`, from a free place. First along a unit
/// vector, if one is given; where that leads to no gap, by the shortest way that the contact planes
/// seen so far allow; then straight on.
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
    let far = along
        .and_then(|along| pushed_along(pair, from, along, gap_m))
        .or_else(|| pushed(pair, from, gap_m))
        .or_else(|| {
            from.try_normalize(0.0)
                .and_then(|onward| pushed_along(pair, from, onward, gap_m))
        });
    let place = far
        .map(|far| narrowed(pair, from, &far, gap_m))
        .ok_or(Reason::NoGap)?;
    if limit.allows(pair, &place) {
        Ok(place)
    } else {
        Err(Reason::Turned)
    }
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

/// On the way from a place with too little gap to one with enough: where the gap is not too wide
/// either.
fn narrowed(pair: &mut Pair<'_>, near: &Vector3, far: &Vector3, gap_m: f64) -> Vector3 {
    let (mut low, mut high) = (0.0, 1.0);
    let span = far - near;
    for _ in 0..60 {
        let place = near + span * high;
        let gap = pair.nearest(&place).gap_m;
        if gap <= gap_m * (1.0 + WIDER / 2.0) {
            break;
        }
        let middle = 0.5 * (low + high);
        let there = near + span * middle;
        if !pair.overlap(&there) && pair.nearest(&there).gap_m >= gap_m {
            high = middle;
        } else {
            low = middle;
        }
        if high - low < 1e-12 {
            break;
        }
    }
    near + span * high
}

/// The surfaces themselves, without triangles.
pub(super) struct Exact {
    moved: Surface,
    moving: Surface,
    fixed: Surface,
    solvers: [ClosestSolver; 2],
    pair: PairSolver,
    contacts: ContactSet,
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
            },
            &mut self.contacts,
        );
    }

    /// Gap of the surfaces at a place, negative for a depth; `None` when it is above `margin_m`.
    pub fn gap_m(&mut self, by: &Vector3, margin_m: f64) -> Option<f64> {
        self.look(by, margin_m);
        self.contacts.deepest().map(|contact| -contact.depth_m)
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
            self.look(&(start + at), reach);
            let deepest = self.contacts.deepest()?;
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
            self.look(&(start + at), LOOK_FAR * margin);
            let Some(deepest) = self.contacts.deepest() else {
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
