//! The proxy of a ball-shaped tool: it goes where the coupling wants it, but not into the surface.
//!
//! A god-object (Zilles & Salisbury 1995; Ruspini et al. 1997 for balls) on the exact surface. Far
//! away it advances by its certified distance, so that no speed takes it through a thin body; once
//! it touches, it follows its foot by local Newton steps, so that it stays on the side it came from
//! even when the device is deep inside. A surface that moves over it in between touches it
//! ([`super::side`]).

use super::side::{Found, Sided, TOUCH, side};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestPoint, WarmFoot};

/// Where a proxy stands with one body. Part of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProxyState {
    /// The surface holds it.
    pub touching: bool,
    /// On an open sheet: the tool came from the side the normal points away from.
    pub below: bool,
    /// It has been looked at, so that `below` says where it came from.
    pub known: bool,
    /// Distance from an open sheet on that side when it was last looked at, m; 0 in touch. Until
    /// tool and sheet have moved by more, neither can have passed the other.
    pub clear_m: f64,
    /// Two bodies: they were looked at when they were last near, or were apart.
    pub met: bool,
    /// Two bodies: depth of the deepest contact of the last tick, m; 0 without one.
    pub deepest_m: f64,
    /// Foot on the surface and how far the answer is proven.
    pub foot: WarmFoot,
    /// Where the foot was last asked for, m.
    pub queried: Point3,
}

impl ProxyState {
    /// The tool, at a place, is out of the body's reach and at least so far from it: nothing that
    /// was proven near it holds when it comes back.
    pub fn leave(&mut self, place: &Point3, clear_m: f64) {
        debug_assert!(
            clear_m >= 0.0 || clear_m.is_nan(),
            "away by less than nothing"
        );
        self.touching = false;
        self.foot.budget_m = 0.0;
        (self.queried, self.clear_m) = (*place, clear_m);
        (self.met, self.deepest_m) = (true, 0.0);
    }

    /// The surface holds the tool: how far it was proven to be from it does not count any more.
    pub fn touch(&mut self) {
        self.touching = true;
        self.foot.budget_m = 0.0;
        self.clear_m = 0.0;
    }
}

/// Outcome of moving a proxy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constrained {
    /// Centre of the proxy, m.
    pub centre: Point3,
    /// Closest surface point.
    pub foot: ClosestPoint,
    /// Unit vector from the body to the tool: the direction the surface pushes.
    pub normal: Vector3,
    /// Gap between the surface and the ball at the target, m; negative: depth.
    pub gap_m: f64,
}

/// A ball-shaped tool against one surface as it stands.
#[derive(Debug)]
pub struct BallContact<'a> {
    /// The surface.
    pub sided: Sided<'a>,
    /// Radius of the tool, 0 for a point, m.
    pub radius_m: f64,
}

/// Sphere-tracing steps while free; each takes the whole certified clearance, so this many only lie
/// close to tangency.
const ADVANCES: usize = 32;
/// Sliding steps in touch. Each contracts the error by curvature times depth.
const SLIDES: usize = 16;

impl BallContact<'_> {
    /// Moves the proxy from `start` towards `target`. `moved_m`: how far any control point moved
    /// since the last call.
    pub fn constrain(
        &mut self,
        start: &Point3,
        target: &Point3,
        moved_m: f64,
        state: &mut ProxyState,
    ) -> Constrained {
        let mut centre = *start;
        let mut moved = moved_m;
        let tolerance = TOUCH * self.sided.size_m;
        if !state.touching {
            for _ in 0..ADVANCES {
                let foot = match self.sided.look(&centre, moved, state) {
                    Found::Free(foot) => foot,
                    Found::Swept(foot) => {
                        (state.foot.u, state.foot.v) = (foot.u, foot.v);
                        break;
                    }
                };
                moved = 0.0;
                let clearance = self.sided.clearance_m(&foot, &centre, state) - self.radius_m;
                let wish = target - centre;
                let length = wish.norm();
                if length <= clearance {
                    // Free all the way.
                    let foot = match self.sided.look(target, 0.0, state) {
                        Found::Free(foot) | Found::Swept(foot) => foot,
                    };
                    return self.outcome(*target, foot, target, state);
                }
                if clearance <= tolerance {
                    break;
                }
                centre += wish * (clearance / length);
            }
            state.touching = true;
        }
        self.slide(centre, target, state)
    }

    fn slide(&mut self, start: Point3, target: &Point3, state: &mut ProxyState) -> Constrained {
        let tolerance = TOUCH * self.sided.size_m;
        let mut centre = start;
        let mut foot = self.follow(&centre, state);
        for _ in 0..SLIDES {
            let normal = foot.normal * side(state);
            // The usual case: the target's own foot lies on the branch we stand on, and gives the
            // answer at once.
            if let Some(own) = self.local(target, state) {
                let reach = (target - centre).norm() + self.radius_m;
                let facing = own.normal.dot(&foot.normal) > 0.5;
                if facing && (own.point - foot.point).norm() <= 2.0 * reach {
                    (state.foot.u, state.foot.v) = (own.u, own.v);
                    self.sided.go_round(&own, target, state);
                    let clearance = self.sided.clearance_m(&own, target, state);
                    if clearance <= self.radius_m + tolerance {
                        return self.held(own, target, state);
                    }
                    // Clear of the branch it stood on; another may hold it.
                    let nearest = self.sided.closest(target, 0.0, state);
                    let clearance = self.sided.clearance_m(&nearest, target, state);
                    if clearance <= self.radius_m + tolerance {
                        return self.held(nearest, target, state);
                    }
                    release(state, target, clearance);
                    return self.outcome(*target, nearest, target, state);
                }
            }
            centre = foot.point + normal * self.radius_m;
            let wish = target - centre;
            let away = wish.dot(&normal);
            if away > tolerance {
                release(state, target, 0.0);
                let foot = self.sided.closest(target, 0.0, state);
                state.clear_m = self.sided.clearance_m(&foot, target, state).max(0.0);
                return self.outcome(*target, foot, target, state);
            }
            let tangent = wish - normal * away;
            let length = tangent.norm();
            if length <= tolerance {
                break;
            }
            // No further than half the ball, or the surface could bend away unseen.
            let stride = if self.radius_m > 0.0 {
                0.5 * self.radius_m
            } else {
                length
            };
            centre += tangent
                * (if length < stride {
                    1.0
                } else {
                    stride / length
                });
            foot = self.follow(&centre, state);
        }
        self.held(foot, target, state)
    }

    /// The foot that the last one leads to.
    fn local(&self, query: &Point3, state: &ProxyState) -> Option<ClosestPoint> {
        let Sided { solver, skin, .. } = &self.sided;
        solver.local(skin, query, state.foot.u, state.foot.v)
    }

    /// The foot of the centre on the branch it stands on; the global one where that branch ends.
    fn follow(&mut self, centre: &Point3, state: &mut ProxyState) -> ClosestPoint {
        let foot = self.local(centre, state).unwrap_or_else(|| {
            state.foot.budget_m = 0.0;
            self.sided.closest(centre, 0.0, state)
        });
        (state.foot.u, state.foot.v) = (foot.u, foot.v);
        foot
    }

    fn held(&self, foot: ClosestPoint, target: &Point3, state: &ProxyState) -> Constrained {
        let centre = foot.point + self.normal(&foot, target, state) * self.radius_m;
        self.outcome(centre, foot, target, state)
    }

    fn outcome(
        &self,
        centre: Point3,
        foot: ClosestPoint,
        target: &Point3,
        state: &ProxyState,
    ) -> Constrained {
        let normal = self.normal(&foot, target, state);
        let gap_m = (target - foot.point).dot(&normal) - self.radius_m;
        Constrained {
            centre,
            foot,
            normal,
            gap_m,
        }
    }

    /// Where the target lies outside, the direction to it: at an edge or a crease that is not the
    /// surface's normal.
    fn normal(&self, foot: &ClosestPoint, target: &Point3, state: &ProxyState) -> Vector3 {
        let away = target - foot.point;
        let distance = away.norm();
        let outside = self.sided.clearance_m(foot, target, state) > 0.0;
        if outside && distance > 1e-6 * self.sided.size_m {
            away / distance
        } else {
            foot.normal * side(state)
        }
    }
}

/// Free again, so far from the surface: what was proven in touch no longer holds.
fn release(state: &mut ProxyState, place: &Point3, clear_m: f64) {
    state.touching = false;
    state.foot.budget_m = 0.0;
    (state.queried, state.clear_m) = (*place, clear_m);
}
