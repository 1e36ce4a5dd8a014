//! On which side of an open surface a point is.
//!
//! A closed surface has an inside. On an open one only the way a point came says on which side it
//! is: a soft sheet that swings past a tool is found on its other side, and the tool has not passed
//! it. So the side is state, and the sign of the distance changes it only where the way from the last
//! look allows it:
//!
//! ```text
//! distance before or after > motion in between     nothing passed: the sign is right (another sheet is nearer now)
//! the foot is on the rim, the point beside it      it may go round: the sign is right (not at a seam)
//! else                                             the surface came over the point: the side stays
//! ```
//! Motion is that of the point and of the surface together. One that folds within one motion so that
//! another sheet passes the point while the foot stays where it was is not noticed.

use super::proxy::ProxyState;
use palpate_geometry::math::Point3;
use palpate_geometry::skin::{Skin, SkinSolver};
use palpate_geometry::surface::ClosestPoint;

/// Nearer than this, relative to the surface's size, a point is on the surface: far above rounding
/// (1e-16), far below what a hand feels.
pub(super) const TOUCH: f64 = 1e-9;
/// A foot is straight below its point when the way between them turns from the normal by less: the
/// cosine of 1.4e-3 rad, far above what Newton's method leaves over.
const STRAIGHT: f64 = 1.0 - 1e-6;

/// A body as it stands, for points that keep their side of it.
#[derive(Debug)]
pub struct Sided<'a> {
    /// As it stands.
    pub skin: &'a Skin,
    /// Its solver.
    pub solver: &'a mut SkinSolver,
    /// Length the tolerances refer to, m.
    pub size_m: f64,
    /// An open surface can be touched from both sides; a closed one only from outside.
    pub two_sided: bool,
}

/// What a look found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// The point is on its side, which may be a new one; its closest point.
    Free(ClosestPoint),
    /// The surface came over it; the place that did.
    Swept(ClosestPoint),
}

impl Sided<'_> {
    /// Looks at a point that nothing holds, and settles its side. `moved_m`: how far any control
    /// point moved since the last look.
    pub fn look(&mut self, point: &Point3, moved_m: f64, state: &mut ProxyState) -> Found {
        let (before, went_m) = (state.foot, (point - state.queried).norm() + moved_m);
        let foot = self.closest(point, moved_m, state);
        let distance_m = foot.distance;
        if !self.two_sided {
            return Found::Free(foot);
        }
        if distance_m <= TOUCH * self.size_m {
            // On the surface itself rounding decides no side.
            state.clear_m = 0.0;
            return Found::Free(foot);
        }
        let other = side(state) * foot.signed_distance < 0.0;
        let passed = state.clear_m == 0.0 || went_m >= state.clear_m.max(distance_m);
        if state.known && other && passed {
            let own = self.solver.local(self.skin, point, before.u, before.v);
            let own = own.unwrap_or(foot);
            if !self.is_beside(&own, point) {
                state.clear_m = 0.0;
                return Found::Swept(own);
            }
        }
        state.below = foot.signed_distance < 0.0;
        (state.known, state.clear_m) = (true, distance_m);
        Found::Free(foot)
    }

    /// Beside the rim, the side of a point in touch is where it is: it goes round.
    pub fn go_round(&self, foot: &ClosestPoint, point: &Point3, state: &mut ProxyState) {
        if self.is_beside(foot, point) {
            state.below = foot.signed_distance < 0.0;
        }
    }

    /// How far a point at a foot is from the surface on its side, m; negative: behind it. Beside the
    /// rim no point is behind.
    pub fn clearance_m(&self, foot: &ClosestPoint, point: &Point3, state: &ProxyState) -> f64 {
        let along_m = side(state) * foot.signed_distance;
        if along_m < 0.0 && self.two_sided && self.is_beside(foot, point) {
            foot.distance
        } else {
            along_m
        }
    }

    /// The foot is on the rim of an open surface, and the point is past it, neither above nor below.
    pub fn is_beside(&self, foot: &ClosestPoint, point: &Point3) -> bool {
        let way = point - foot.point;
        let along = way.dot(&foot.normal);
        let aside = (way - foot.normal * along).norm();
        self.two_sided
            && aside > 10.0 * TOUCH * self.size_m
            && along.abs() < STRAIGHT * foot.distance
            && self.skin.ends_at(foot, TOUCH * self.size_m)
    }

    /// The certified closest point. `moved_m`: how far any control point moved since the last look.
    pub(super) fn closest(
        &mut self,
        query: &Point3,
        moved_m: f64,
        state: &mut ProxyState,
    ) -> ClosestPoint {
        let went_m = (query - state.queried).norm();
        state.queried = *query;
        self.solver
            .closest_warm_moved(self.skin, query, went_m, moved_m, &mut state.foot)
    }
}

/// +1, or −1 on the side that the normal points away from.
pub(super) fn side(state: &ProxyState) -> f64 {
    if state.below { -1.0 } else { 1.0 }
}
