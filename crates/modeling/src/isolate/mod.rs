//! Isolation: the short translation that takes two overlapping solids apart.
//!
//! Both surfaces are closed; the first moves, the second stays, neither changes its shape. The
//! answer is a translation after which they are apart by a small gap. Methods 1 to 7 are the
//! heuristics of a thesis on isolating closed B-spline bodies (of a head, for planning
//! radiotherapy); two searches, one local and one global, come close to the least length there is.
//!
//! ```text
//! body         surface → grid → triangles, tree of boxes, centroid; open or self-crossing surfaces are refused
//! pair         two bodies, one translated: overlap? nearest points? crossing segments?
//! regions      segments → lines → regions with normals and farthest pairs
//! directions   regions → the displacements of methods 1 to 7;   steps: the procedure round them
//! search       exits along directions, descents along the boundary of free space: local, global
//! settle       contact → the wanted gap, of the triangles, then of the surfaces themselves
//! many         several bodies: pair after pair until none overlaps
//! ```
//! No method is proven to be shortest. `Global` reached the best known length on all pairs of the
//! tests.

mod body;
mod bvh;
mod directions;
pub mod given;
mod grid;
mod many;
mod pair;
mod planes;
mod regions;
mod search;
mod settle;
mod spec;
mod steps;
#[cfg(test)]
mod tests;
mod triangle;

pub use body::Body;
pub use many::{IsolatedAll, Move, Unsettled, isolate_all};
pub use spec::{
    IsolateError, IsolateMethod, IsolateSpec, IsolateStatus, Isolated, Reason, Resolution,
};

use self::directions::DirectionRule;
use self::pair::Pair;
use self::regions::Regions;
use self::search::{SearchLimit, TranslationSearch};
use self::settle::Exact;
use self::steps::{Stepped, best_of_blends, stepped};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;

/// Default gap, relative to the diagonal of the box around both bodies.
const USUAL_GAP: f64 = 1e-3;
/// Least gap, as a share of the same, and in lengths that are nothing to an overlap test: below it the digits of a
/// translation end, or those of coordinates far from the origin.
const LEAST_GAP: f64 = 1e-9;
const ROUNDING: f64 = 16.0;
/// A gap that contact planes lead to from contact, as a share of the same: wider than what a search leaves, and about
/// what triangles are off from their surfaces.
const WORKING_GAP: f64 = 1e-4;
/// How much farther than what certainly frees the triangles, as a share of the same: the surfaces too.
const FAR: f64 = 0.1;
/// Most halvings of the grid step.
const MOST_HALVINGS: usize = 3;

/// Isolates `moving` from `fixed`.
///
/// # Errors
/// A surface that is open, flat, not finite or crosses itself; a gap, turn or resolution out of
/// range.
///
/// ```
/// use palpate_geometry::math::{Pose, Vector3};
/// use palpate_modeling::isolate::{IsolateSpec, isolate};
/// use palpate_geometry::surface::builtin;
///
/// let fixed = builtin("sphere", None, Some(0.05))?;
/// let moving = fixed.transformed(&Pose::translation(0.08, 0.0, 0.0));
/// let answer = isolate(&moving, &fixed, &IsolateSpec { gap_m: Some(1e-4), ..IsolateSpec::default() })?;
/// // Radii of 0.05 m, centres 0.08 m apart: 0.02 m and the gap are missing.
/// assert!((answer.translation_m - Vector3::new(0.02, 0.0, 0.0)).norm() < 2e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Examples
/// ```
/// use palpate_geometry::surface::builtin;
/// use palpate_modeling::isolate::{IsolateSpec, isolate};
/// let fixed = builtin("sphere", None, Some(1.0))?; // radius 1 m
/// let mut moving = fixed.clone();
/// moving.net_mut().points_mut().iter_mut().for_each(|point| point.x += 1.9);
/// let answer = isolate(&moving, &fixed, &IsolateSpec::default())?;
/// assert!(answer.is_apart());
/// assert!((0.1..0.11).contains(&answer.translation_m.norm()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn isolate(
    moving: &Surface,
    fixed: &Surface,
    spec: &IsolateSpec,
) -> Result<Isolated, IsolateError> {
    let cells = [moving, fixed].map(|surface| cells_of(surface, spec));
    let bodies = (
        Body::new(moving, cells[0], 0)?,
        Body::new(fixed, cells[1], 1)?,
    );
    isolate_ready(
        (moving, &bodies.0),
        (fixed, &bodies.1),
        &Vector3::zeros(),
        spec,
    )
}

/// Isolates bodies that were made ready before, each with its surface. The moving one stands at
/// `start` (m) beside its own coordinates; the answer's translation is from there.
///
/// # Errors
/// A gap or turn out of range, or a resolution too fine.
pub fn isolate_ready(
    moving: (&Surface, &Body),
    fixed: (&Surface, &Body),
    start: &Vector3,
    spec: &IsolateSpec,
) -> Result<Isolated, IsolateError> {
    let mut pair = Pair::new(moving.1, fixed.1, *start);
    let asked = Asked::new(&pair, spec)?;
    let mut exact = spec.exact.then(|| Exact::new(moving.0, fixed.0));
    let mut answer = asked.answer(&mut pair, exact.as_mut(), spec);
    if spec.resolution != Resolution::Halving || answer.status != IsolateStatus::Isolated {
        return Ok(answer);
    }
    for _ in 0..MOST_HALVINGS {
        let [a, b] = answer.cells.map(|cells| cells.map(|n| 2 * n));
        let finer = (
            Body::unchecked(moving.0, a, 0)?,
            Body::unchecked(fixed.0, b, 1)?,
        );
        let mut pair = Pair::new(&finer.0, &finer.1, *start);
        // The basin is known by now: the finer triangles only move its bottom.
        let again = match answer.method {
            IsolateMethod::Local | IsolateMethod::Global | IsolateMethod::Thorough => IsolateSpec {
                method: IsolateMethod::Local,
                warm_m: Some(answer.contact_m),
                ..*spec
            },
            method => IsolateSpec { method, ..*spec },
        };
        let next = asked.answer(&mut pair, exact.as_mut(), &again);
        if next.status != IsolateStatus::Isolated {
            break;
        }
        let change_m = (next.contact_m.norm() - answer.contact_m.norm()).abs();
        answer = Isolated {
            method: answer.method,
            fell_back: answer.fell_back,
            overlap_tests: answer.overlap_tests + next.overlap_tests,
            change_m: Some(change_m),
            ..next
        };
        if change_m < asked.gap_m {
            break;
        }
    }
    Ok(answer)
}

fn cells_of(surface: &Surface, spec: &IsolateSpec) -> [usize; 2] {
    match spec.resolution {
        Resolution::Cells(cells) => cells,
        Resolution::Usual | Resolution::Halving => grid::usual_cells(surface),
    }
}

/// A question that was checked.
struct Asked {
    gap_m: f64,
    limit: SearchLimit,
}

impl Asked {
    fn new(pair: &Pair<'_>, spec: &IsolateSpec) -> Result<Self, IsolateError> {
        let diameter_m = pair.diameter_m;
        let gap_m = spec.gap_m.unwrap_or(USUAL_GAP * diameter_m);
        let least_m = (LEAST_GAP * diameter_m).max(ROUNDING * pair.tolerance_m());
        if !(gap_m >= least_m && gap_m <= diameter_m) {
            return Err(IsolateError::Gap {
                gap_m,
                least_m,
                most_m: diameter_m,
            });
        }
        if let Some(turn) = spec.max_turn_deg
            && !(0.0..=180.0).contains(&turn)
        {
            return Err(IsolateError::MaxTurn(turn));
        }
        if spec
            .warm_m
            .is_some_and(|warm| warm.iter().any(|x| !x.is_finite()))
        {
            return Err(IsolateError::Warm);
        }
        Ok(Self {
            gap_m,
            limit: SearchLimit {
                most_rad: spec.max_turn_deg.map(f64::to_radians),
            },
        })
    }

    /// Contact, then the gap.
    fn answer(
        &self,
        pair: &mut Pair<'_>,
        exact: Option<&mut Exact>,
        spec: &IsolateSpec,
    ) -> Isolated {
        let mut answer = Isolated {
            status: IsolateStatus::Apart,
            translation_m: Vector3::zeros(),
            contact_m: Vector3::zeros(),
            gap_m: None,
            exact: exact.is_some(),
            turn_deg: pair.turn_rad(&Vector3::zeros()).map(f64::to_degrees),
            method: spec.method,
            fell_back: None,
            steps: 0,
            regions: 0,
            overlap_tests: 0,
            cells: [pair.moving.cells(), pair.fixed.cells()],
            change_m: None,
        };
        let found = self.contact(pair, spec, &mut answer);
        let settled = found.and_then(|along| self.settled(pair, exact, &answer.contact_m, along));
        answer.overlap_tests = pair.tests;
        match settled {
            Ok((translation_m, gap_m)) => {
                let moved = translation_m != Vector3::zeros();
                answer.status = if moved {
                    IsolateStatus::Isolated
                } else {
                    IsolateStatus::Apart
                };
                (answer.translation_m, answer.gap_m) = (translation_m, Some(gap_m));
                answer.turn_deg = pair.turn_rad(&translation_m).map(f64::to_degrees);
            }
            Err(reason) => answer.status = IsolateStatus::Failed(reason),
        }
        answer
    }

    /// A free place at contact, into `answer`; and the direction to widen the gap in, if there is
    /// one.
    fn contact(
        &self,
        pair: &mut Pair<'_>,
        spec: &IsolateSpec,
        answer: &mut Isolated,
    ) -> Result<Option<Vector3>, Reason> {
        if !pair.overlap(&Vector3::zeros()) {
            return Ok(self
                .limit
                .most_rad
                .and_then(|_| pair.between_centroids().try_normalize(0.0)));
        }
        answer.regions =
            Regions::new(pair, &Vector3::zeros()).map_or(0, |regions| regions.list.len());
        let found = self
            .by_method(pair, spec.method, spec.warm_m.as_ref())
            .or_else(|reason| {
                let searched =
                    matches!(spec.method, IsolateMethod::Global | IsolateMethod::Thorough);
                if searched || !spec.fall_back {
                    return Err(reason);
                }
                (answer.method, answer.fell_back) = (IsolateMethod::Global, Some(reason));
                self.by_method(pair, IsolateMethod::Global, None)
            })?;
        (answer.contact_m, answer.steps) = (found.contact, found.steps);
        Ok(Some(found.along).filter(|along| along.norm_squared() > 0.0))
    }

    /// The contact that a method finds; `along` is zero where the contact planes say best how to
    /// widen the gap.
    fn by_method(
        &self,
        pair: &mut Pair<'_>,
        method: IsolateMethod,
        warm: Option<&Vector3>,
    ) -> Result<Stepped, Reason> {
        let limit = self.limit;
        let rule = match method {
            IsolateMethod::Farthest => DirectionRule::Farthest,
            IsolateMethod::FarthestOfRegion => DirectionRule::FarthestOfRegion,
            IsolateMethod::Normal => DirectionRule::Normal,
            IsolateMethod::Normals => DirectionRule::Normals,
            IsolateMethod::Centroids => DirectionRule::Centroids,
            IsolateMethod::Blend => DirectionRule::Blend(0.5, 0.5),
            IsolateMethod::BestBlend => return best_of_blends(pair, &limit),
            IsolateMethod::Local | IsolateMethod::Global | IsolateMethod::Thorough => {
                return self.searched(pair, method, warm);
            }
        };
        stepped(pair, rule, &limit)
    }

    fn searched(
        &self,
        pair: &mut Pair<'_>,
        method: IsolateMethod,
        warm: Option<&Vector3>,
    ) -> Result<Stepped, Reason> {
        let between = pair.between_centroids();
        let axis = between.try_normalize(1e-9 * pair.diameter_m);
        if self.limit.most_rad.is_some() && axis.is_none() {
            return Err(Reason::CoincidentCentroids);
        }
        let mut search = TranslationSearch {
            pair,
            limit: self.limit,
        };
        let contact = if method == IsolateMethod::Local {
            search.local(warm)?
        } else {
            let (mut spread, descents) = match method {
                IsolateMethod::Thorough => (search::forty_two(), 3),
                _ => (search::fourteen(), 2),
            };
            if let (Some(half_angle), Some(axis)) = (self.limit.most_rad, axis) {
                let count = spread.len();
                spread.extend(search::cone(&axis, half_angle, count));
            }
            search.global(&spread, descents)?
        };
        // Along the line of the centroids nothing turns; where nothing may, the gap is widened
        // along it.
        let along = self
            .limit
            .most_rad
            .and_then(|_| (between + contact).try_normalize(0.0));
        Ok(Stepped {
            contact,
            along: along.unwrap_or_else(Vector3::zeros),
            steps: 0,
        })
    }

    /// Translation with the gap, and the gap.
    ///
    /// The least gap of use for contact planes is wider than the least that can be asked for, so narrower ones are
    /// reached from there: a smaller gap is never harder to leave than a larger one, nor farther away.
    fn settled(
        &self,
        pair: &mut Pair<'_>,
        mut exact: Option<&mut Exact>,
        contact: &Vector3,
        along: Option<Vector3>,
    ) -> Result<(Vector3, f64), Reason> {
        let start = pair.moved_by(&Vector3::zeros());
        let gap_at = |pair: &mut Pair<'_>, exact: &mut Option<&mut Exact>, at: &Vector3| {
            match exact {
                // Far apart is wide enough.
                Some(exact) => exact
                    .gap_m(&(start + at), 2.0 * self.gap_m)
                    .unwrap_or(pair.diameter_m),
                None if pair.overlap(at) => f64::NEG_INFINITY,
                None => pair.nearest(at).gap_m,
            }
        };
        if *contact == Vector3::zeros() {
            let gap_m = gap_at(pair, &mut exact, contact);
            if gap_m >= self.gap_m {
                return Ok((*contact, gap_m));
            }
        }
        let mut wide_m = self.gap_m.max(WORKING_GAP * pair.diameter_m);
        let (at, gap_m) = loop {
            match self.widened(pair, exact.as_deref_mut(), contact, along, wide_m) {
                Ok(found) => break found,
                // There may be room for less.
                Err(_) if wide_m > self.gap_m => wide_m = self.gap_m.max(0.1 * wide_m),
                Err(reason) => {
                    let mut gap_at =
                        |pair: &mut Pair<'_>, at: &Vector3| gap_at(pair, &mut exact, at);
                    let round = self.round(pair, &mut gap_at, contact, along);
                    return round.ok_or(reason);
                }
            }
        };
        let mut gap_at = |at: &Vector3| gap_at(pair, &mut exact, at);
        Ok(settle::trimmed(&at, gap_m, self.gap_m, &mut gap_at))
    }

    /// Where a hole that the bodies stand in has no room for the gap: from far away, in spread directions, back to it.
    fn round(
        &self,
        pair: &mut Pair<'_>,
        gap_at: &mut dyn FnMut(&mut Pair<'_>, &Vector3) -> f64,
        contact: &Vector3,
        along: Option<Vector3>,
    ) -> Option<(Vector3, f64)> {
        let mut best: Option<(Vector3, f64)> = None;
        let onward = contact.try_normalize(0.0);
        for direction in onward.into_iter().chain(along).chain(search::fourteen()) {
            let far_m = pair.certain_exit_m(&direction) + self.gap_m + FAR * pair.diameter_m;
            let far = direction * far_m;
            let gap_m = gap_at(pair, &far);
            if gap_m < self.gap_m {
                continue;
            }
            let found = settle::trimmed(&far, gap_m, self.gap_m, &mut |at| gap_at(pair, at));
            let shorter = best.is_none_or(|(at, _)| found.0.norm() < at.norm());
            if shorter && self.limit.allows(pair, &found.0) {
                best = Some(found);
            }
        }
        best
    }

    /// A place with a gap of at least `gap_m`, and the gap.
    fn widened(
        &self,
        pair: &mut Pair<'_>,
        exact: Option<&mut Exact>,
        contact: &Vector3,
        along: Option<Vector3>,
        gap_m: f64,
    ) -> Result<(Vector3, f64), Reason> {
        let at = settle::settled(pair, &self.limit, contact, along, gap_m)?;
        let Some(exact) = exact else {
            return Ok((at, pair.nearest(&at).gap_m));
        };
        let start = pair.moved_by(&Vector3::zeros());
        let turning = if self.limit.most_rad.is_some() {
            along
        } else {
            None
        };
        let (at, found_m) = exact
            .settled(&start, &at, turning, gap_m)
            .or_else(|| exact.settled(&start, &at, at.try_normalize(0.0), gap_m))
            .ok_or(Reason::NoGap)?;
        if along.is_none()
            && let Some(shorter) = exact.shortened(&start, &at, gap_m)
        {
            return Ok(shorter);
        }
        if self.limit.allows(pair, &at) {
            Ok((at, found_m))
        } else {
            Err(Reason::Turned)
        }
    }
}
