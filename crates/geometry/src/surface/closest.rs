//! Closest point on a B-spline surface: the global minimum of |S(u, v) − q|, proved by bounds.
//!
//! ```text
//! cold   samples ──▶ descent (Newton) ──▶ branch and bound over Bézier pieces ──▶ the foot, certified
//! warm   last foot ──▶ descent, while query and net have moved less than the last certificate allows; else cold
//! local  a given foot ──▶ descent; a local minimum, for following a contact
//! ```
//! The certificate: on a piece, squared distance less the best one is a polynomial whose Bernstein
//! coefficients bound it from below, ever more tightly under halving (Johnson & Cohen 1998 bound
//! distances the same way, by hulls). Minima at creases, seams, poles, open edges and disjoined
//! knots are found because bounds do not ask for a vanishing gradient. The distance is never worse
//! than the true minimum by more than 1e-9 of the surface's size (1e-12 unless whole curves are
//! nearly equally close), or by rounding of the coordinates when the query is far away. A piece that
//! needs too much work is given up, the query is not; [`ClosestSolver::pieces_given_up`] tells that
//! its answer is not certified.
//!
//! Nothing here allocates after [`ClosestSolver::new`].

mod basin;
mod bernstein;
#[cfg(test)]
mod extreme_tests;
mod field;
mod judge;
mod minima;
#[cfg(test)]
mod minima_tests;
mod newton;
mod objective;
mod search;
mod side;
mod stationary;
#[cfg(test)]
mod tests;
mod warm;

pub(crate) use self::basin::{Basin, Clip};
pub(crate) use self::bernstein::{halve_u, halve_v};
pub(crate) use self::field::{Bottom, Foot};
use self::minima::Minima;
pub use self::minima::Summit;
use self::newton::{Descent, NewtonPlace, OnPieces, OnSurface, descend, descend_over};
pub(crate) use self::objective::Jet;
use self::objective::{Along, Distance, Objective, Problem, Tables};
use self::search::Search;
use self::side::Site;
use super::bezier::{BezierPieces, Joint, PieceDirection};
use super::tensor::Surface;
use crate::math::{Point3, Vector3};

/// The foot of a query on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Parameter, inside the domain.
    pub u: f64,
    /// Parameter, inside the domain.
    pub v: f64,
    /// S(u, v), m.
    pub point: Point3,
    /// Outward unit normal; the mean of those that meet at a crease, seam or pole.
    pub normal: Vector3,
    /// |q − S|, m.
    pub distance: f64,
    /// Signed distance, m: negative on the inner side of the normal (inside a closed surface).
    pub signed_distance: f64,
}

/// What a warm query carries from one tick to the next; part of the simulation's state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmFoot {
    /// Last foot.
    pub u: f64,
    /// Last foot.
    pub v: f64,
    /// Movement left, m, before the next full search; 0 asks for one.
    pub budget_m: f64,
    /// What a metre of net movement takes from the budget, ≥ 1 (a metre of query movement takes 1).
    pub net_cost: f64,
}

/// Closest-point queries on one surface whose net may move. Scratch: its answers depend on the
/// arguments only, provided that [`ClosestSolver::net_changed`] is called after each movement of
/// the net, restored states included.
///
/// ```
/// use palpate_geometry::basis::KnotVector;
/// use palpate_geometry::math::Point3;
/// use palpate_geometry::surface::{ClosestSolver, ControlNet, Surface};
///
/// let knots = KnotVector::clamped_uniform(1, 2)?;
/// let square = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)].map(|(x, y)| Point3::new(x, y, 0.0));
/// let surface = Surface::new(knots.clone(), knots, ControlNet::new(2, 2, square.to_vec())?, None)?;
/// let foot = ClosestSolver::new(&surface).closest(&surface, &Point3::new(0.25, 3.0, 0.0));
/// assert_eq!((foot.u, foot.v, foot.distance), (0.25, 1.0, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClosestSolver {
    pieces: BezierPieces,
    tables: Tables,
    search: Search,
    minima: Minima,
    samples: ClosestSamples,
    /// Diagonal of the box of the first net, m: what tolerances are relative to.
    size_m: f64,
}

/// One point or two on each piece, to start from.
#[derive(Clone, Debug)]
struct ClosestSamples {
    /// Which boxes of the pieces they go with.
    stamp: u64,
    /// Bernstein products at the middle, ((p + 1)(q + 1)).
    middle: Vec<f64>,
    /// (2 × pieces): first corners, then middles.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl ClosestSamples {
    fn new(pieces: &BezierPieces) -> Self {
        let (p, q) = (pieces.u.degree, pieces.v.degree);
        let scale = 0.5_f64.powi((p + q) as i32);
        let middle = (0..=p)
            .flat_map(|i| {
                (0..=q).map(move |j| bernstein::binomial(p, i) * bernstein::binomial(q, j) * scale)
            })
            .collect();
        let zeros = || vec![0.0; 2 * pieces.len()];
        Self {
            stamp: 0,
            middle,
            x: zeros(),
            y: zeros(),
            z: zeros(),
        }
    }

    /// Samples all pieces; they must be fresh.
    fn refresh(&mut self, pieces: &BezierPieces) {
        let n = pieces.len();
        for k in 0..n {
            for (slot, x) in [(k, self.corner(pieces, k)), (n + k, self.centre(pieces, k))] {
                [self.x[slot], self.y[slot], self.z[slot]] = x;
            }
        }
        if let Some(joints) = pieces.joints() {
            // A duplicate is sampled as what it draws again: the first of equals is taken.
            for k in (0..n).filter(|&k| joints.hidden()[k]) {
                let first = joints.original(k);
                for (slot, from) in [(k, first), (n + k, n + first)] {
                    (self.x[slot], self.y[slot], self.z[slot]) =
                        (self.x[from], self.y[from], self.z[from]);
                }
            }
        }
        self.stamp = pieces.bounds_stamp();
    }

    fn corner(&self, pieces: &BezierPieces, piece: usize) -> [f64; 3] {
        let x = pieces.points(piece)[0];
        let scale = if pieces.is_rational() {
            1.0 / x[3]
        } else {
            1.0
        };
        [x[0] * scale, x[1] * scale, x[2] * scale]
    }

    fn centre(&self, pieces: &BezierPieces, piece: usize) -> [f64; 3] {
        let mut sum = [0.0; 4];
        for (x, share) in pieces.points(piece).iter().zip(&self.middle) {
            for c in 0..4 {
                sum[c] += share * x[c];
            }
        }
        let scale = if pieces.is_rational() {
            1.0 / sum[3]
        } else {
            1.0
        };
        [sum[0] * scale, sum[1] * scale, sum[2] * scale]
    }

    /// The best sample.
    fn best(&self, pieces: &BezierPieces, objective: &impl Objective) -> NewtonPlace {
        // Four running minima and a look for the first that has the least: one would wait for
        // itself.
        let n = self.x.len();
        let (x, y, z) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let mut lanes = [f64::INFINITY; 4];
        for k in 0..n / 4 {
            for c in 0..4 {
                let value = objective.value(x[4 * k + c], y[4 * k + c], z[4 * k + c]);
                lanes[c] = if value < lanes[c] { value } else { lanes[c] };
            }
        }
        let mut least = lanes
            .iter()
            .fold(f64::INFINITY, |m, &l| if l < m { l } else { m });
        for k in n / 4 * 4..n {
            let value = objective.value(x[k], y[k], z[k]);
            least = if value < least { value } else { least };
        }
        let at = (0..n)
            .find(|&k| objective.value(x[k], y[k], z[k]) == least)
            .unwrap_or(0);
        self.place(pieces, at)
    }

    /// [`ClosestSamples::best`] of the present net, from samples of one that has moved by less than the
    /// pieces' slack: only those that may be best now are computed anew.
    fn best_after_movement(
        &self,
        pieces: &mut BezierPieces,
        surface: &Surface,
        objective: &Distance,
    ) -> NewtonPlace {
        let old = |k: usize| objective.value(self.x[k], self.y[k], self.z[k]);
        let (n, mut least) = (pieces.len(), f64::INFINITY);
        for k in 0..2 * n {
            let value = old(k);
            least = if value < least { value } else { least };
        }
        // Each sample has moved by at most √3 of what a coordinate has, and so has the best one.
        let reach = least.sqrt() + 3.5 * pieces.slack_m();
        let reach = reach * reach * (1.0 + 1e-12);
        let (mut least, mut at) = (f64::INFINITY, 0);
        for k in 0..2 * n {
            let piece = if k < n { k } else { k - n };
            if old(k) <= reach && !pieces.is_duplicate(piece) {
                let columns = pieces.v.spans.len();
                pieces.refresh_piece(surface, piece / columns, piece % columns);
                let [x, y, z] = if k < n {
                    self.corner(pieces, piece)
                } else {
                    self.centre(pieces, piece)
                };
                let value = objective.value(x, y, z);
                if value < least {
                    (least, at) = (value, k);
                }
            }
        }
        self.place(pieces, at)
    }

    fn place(&self, pieces: &BezierPieces, sample: usize) -> NewtonPlace {
        let n = pieces.len();
        let (piece, local) = if sample < n {
            (sample, 0.0)
        } else {
            (sample - n, 0.5)
        };
        search::SearchPart::whole(pieces, piece).place(pieces, local, local)
    }
}

impl ClosestSolver {
    /// Precomputes what depends on the knots and sizes all scratch.
    pub fn new(surface: &Surface) -> Self {
        let pieces = BezierPieces::new(surface);
        let mut low = Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut high = -low;
        for p in surface.net().points() {
            low = low.inf(p);
            high = high.sup(p);
        }
        Self {
            tables: Tables::new(pieces.u.degree, pieces.v.degree),
            search: Search::new(&pieces),
            minima: Minima::new(&pieces),
            samples: ClosestSamples::new(&pieces),
            size_m: (high - low).norm(),
            pieces,
        }
    }

    /// Says that the net moved. Pieces and bounds are recomputed when next needed.
    pub fn net_changed(&mut self) {
        self.pieces.net_changed();
    }

    /// The pieces and their bounds, brought up to date.
    pub fn pieces(&mut self, surface: &Surface) -> &BezierPieces {
        self.refresh(surface);
        &self.pieces
    }

    /// How many parts of pieces the last full search looked at.
    pub fn parts_visited(&self) -> usize {
        self.search.visited
    }

    /// How many pieces all searches so far gave up because they needed too much work. An answer
    /// during which this has grown is not certified: something on such a piece may be nearer.
    pub fn pieces_given_up(&self) -> u64 {
        self.search.given_up
    }

    fn refresh(&mut self, surface: &Surface) {
        self.pieces.refresh_stale(surface);
        self.sample();
    }

    /// Boxes and samples that are good enough to find out what is near.
    fn follow(&mut self, surface: &Surface) {
        self.pieces.follow(surface);
        self.sample();
    }

    /// Samples go with boxes: new ones for new ones, which come with fresh pieces.
    fn sample(&mut self) {
        if self.samples.stamp != self.pieces.bounds_stamp() {
            self.samples.refresh(&self.pieces);
        }
    }

    /// The global closest point. A query that is not finite gets some point of the surface at
    /// distance infinity.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::math::Point3;
    /// use palpate_geometry::surface::{ClosestSolver, builtin};
    /// let sphere = builtin("sphere", None, Some(0.02))?; // radius 20 mm
    /// let mut solver = ClosestSolver::new(&sphere);
    /// let foot = solver.closest(&sphere, &Point3::new(0.0, 0.0, 0.05));
    /// assert!((foot.signed_distance - 0.03).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest(&mut self, surface: &Surface, query: &Point3) -> ClosestPoint {
        let best = self.nearest(surface, &Distance { q: *query });
        self.answer(surface, query, &best)
    }

    /// [`ClosestSolver::closest`], from the last foot where that is proved to be enough. `moved_m`
    /// is how far the query moved since the last call with this `warm`, plus the largest movement
    /// of a control point.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::math::Point3;
    /// use palpate_geometry::surface::{ClosestSolver, WarmFoot, builtin};
    /// let drop = builtin("teardrop", None, None)?;
    /// let mut solver = ClosestSolver::new(&drop);
    /// let mut warm = WarmFoot::default();
    /// for k in 0..100 {
    ///     let query = Point3::new(0.06, 0.003, 0.045 + 1e-5 * f64::from(k));
    ///     let foot = solver.closest_warm(&drop, &query, 1e-5, &mut warm);
    ///     assert!((foot.distance - solver.closest(&drop, &query).distance).abs() < 1e-12);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_warm(
        &mut self,
        surface: &Surface,
        query: &Point3,
        moved_m: f64,
        warm: &mut WarmFoot,
    ) -> ClosestPoint {
        self.closest_warm_moved(surface, query, 0.0, moved_m, warm)
    }

    /// [`ClosestSolver::closest_warm`] with the movements of query and net apart: the query's costs
    /// the certificate much less, so on a rigid surface it lasts much longer. Movements are
    /// relative: a surface and a query that move together have not moved.
    pub fn closest_warm_moved(
        &mut self,
        surface: &Surface,
        query: &Point3,
        query_moved_m: f64,
        net_moved_m: f64,
        warm: &mut WarmFoot,
    ) -> ClosestPoint {
        let objective = Distance { q: *query };
        let left_m = warm.budget_m - (query_moved_m + warm.net_cost.max(1.0) * net_moved_m);
        // A foot is worth following while the budget lasts (false for NaN too), and worth a new
        // certificate after that.
        if warm.budget_m > 0.0 {
            let start = self.place(warm.u, warm.v);
            let found = descend(
                &mut OnPieces {
                    pieces: &mut self.pieces,
                    surface,
                },
                &objective,
                start,
            );
            if self.settled(&found) {
                if left_m > 0.0 {
                    let answer = self.answer(surface, query, &found);
                    *warm = WarmFoot {
                        u: answer.u,
                        v: answer.v,
                        budget_m: left_m,
                        ..*warm
                    };
                    return answer;
                }
                self.follow(surface);
                if let Some(answer) = self.granted(surface, &objective, &found, warm) {
                    return answer;
                }
            }
        }
        let best = self.nearest(surface, &objective);
        if let Some(answer) = self.granted(surface, &objective, &best, warm) {
            return answer;
        }
        let answer = self.answer(surface, query, &best);
        *warm = WarmFoot {
            u: answer.u,
            v: answer.v,
            budget_m: 0.0,
            net_cost: 1.0,
        };
        answer
    }

    /// The answer at a foot with a new certificate, when one can be given: then the foot is global.
    fn granted(
        &mut self,
        surface: &Surface,
        objective: &Distance,
        found: &Descent,
        warm: &mut WarmFoot,
    ) -> Option<ClosestPoint> {
        if !self.settled(found) {
            return None;
        }
        let problem = Problem {
            surface,
            tables: &self.tables,
            objective,
            size_m: self.size_m,
        };
        let grant = warm::certificate(&mut self.search, &mut self.pieces, &problem, found);
        (grant.budget_m > 0.0).then(|| {
            let answer = self.answer(surface, &objective.q, found);
            *warm = WarmFoot {
                u: answer.u,
                v: answer.v,
                budget_m: grant.budget_m,
                net_cost: grant.net_cost,
            };
            answer
        })
    }

    /// The local minimum that descent from a foot leads to; `None` when it does not arrive (a
    /// saddle, or a query that is not finite). For following a contact over the surface.
    pub fn local(
        &self,
        surface: &Surface,
        query: &Point3,
        u0: f64,
        v0: f64,
    ) -> Option<ClosestPoint> {
        let objective = Distance { q: *query };
        let (u, v) = (surface.knots_u().confine(u0), surface.knots_v().confine(v0));
        if !(u.is_finite() && v.is_finite()) {
            return None;
        }
        let mut eval = OnSurface {
            pieces: &self.pieces,
            surface,
        };
        let mut found = descend_over(&mut eval, &objective, self.place(u, v));
        // At a closed end or a pole, the surface goes on where the parameters do not.
        for _ in 0..6 {
            let Some(start) = self.go_on(surface, query, &found) else {
                break;
            };
            let next = descend_over(&mut eval, &objective, start);
            if next.jet.f < found.jet.f - found.jet.noise {
                found = next;
            } else {
                break;
            }
        }
        self.settled(&found)
            .then(|| self.answer(surface, query, &found))
    }

    /// The point of the surface farthest along a direction: `(u, v, point)` of the greatest
    /// `direction · S`, certified like the closest point. A direction without length counts as +z.
    pub fn deepest_along(&mut self, surface: &Surface, direction: &Vector3) -> (f64, f64, Point3) {
        let d = direction
            .try_normalize(0.0)
            .filter(|d| d.iter().all(|x| x.is_finite()))
            .unwrap_or_else(Vector3::z);
        let objective = Along { d };
        self.refresh(surface);
        let start = self.samples.best(&self.pieces, &objective);
        let best = self.certified(surface, &objective, start);
        let (u, v) = self.parameters(&best.place);
        (u, v, best.frame.point)
    }

    fn nearest(&mut self, surface: &Surface, objective: &Distance) -> Descent {
        self.follow(surface);
        let start = if self.pieces.slack_m() > 0.0 {
            self.samples
                .best_after_movement(&mut self.pieces, surface, objective)
        } else {
            self.samples.best(&self.pieces, objective)
        };
        self.certified(surface, objective, start)
    }

    fn certified<O: Objective>(
        &mut self,
        surface: &Surface,
        objective: &O,
        start: NewtonPlace,
    ) -> Descent {
        let mut best = descend_over(
            &mut OnPieces {
                pieces: &mut self.pieces,
                surface,
            },
            objective,
            start,
        );
        let problem = Problem {
            surface,
            tables: &self.tables,
            objective,
            size_m: self.size_m,
        };
        (self.search).certify(&mut self.pieces, &problem, &mut best);
        best
    }

    fn place(&self, u: f64, v: f64) -> NewtonPlace {
        NewtonPlace {
            i: self.pieces.u.span_of(u),
            j: self.pieces.v.span_of(v),
            u,
            v,
        }
    }

    /// Arrived at a minimum: nothing left of the slope but rounding.
    fn settled(&self, found: &Descent) -> bool {
        let scale = self.size_m + found.jet.f.max(0.0).sqrt();
        found.slope <= 1e-11 * scale && found.is_minimum()
    }

    /// Where a foot that is held at an end of the domain can go on: across coinciding ends, or out
    /// of a pole along its steepest meridian.
    fn go_on(&self, surface: &Surface, query: &Point3, found: &Descent) -> Option<NewtonPlace> {
        let (du, dv) = (&self.pieces.u, &self.pieces.v);
        let site = Site {
            surface,
            u: du,
            v: dv,
            joints: self.pieces.joints(),
        };
        let (at, foot) = (found.place, found.frame.point);
        // Out of a pole: the variable along the collapsed edge has no length.
        for collapsed in 0..2 {
            let (held, ring, x) = if collapsed == 0 {
                (dv, du, at.v)
            } else {
                (du, dv, at.u)
            };
            let short = found.jet.metric[collapsed] <= 1e-24 * self.size_m * self.size_m;
            if side::other_end(held, x).is_none() || !short {
                continue;
            }
            let inward = if x <= held.domain.0 { 1.0 } else { -1.0 };
            let (mut steepest, mut start) = (-1e-12 * self.size_m, None);
            for (k, span) in ring.spans.iter().enumerate() {
                for m in 0..8 {
                    let y = span.start + (span.end - span.start) * (m as f64 + 0.5) / 8.0;
                    let place = if collapsed == 0 {
                        NewtonPlace { i: k, u: y, ..at }
                    } else {
                        NewtonPlace { j: k, v: y, ..at }
                    };
                    let frame = site.frame(place);
                    let out = if collapsed == 0 { frame.dv } else { frame.du };
                    // How the distance changes per metre along this meridian, times the distance.
                    let slope =
                        inward * (foot - query).dot(&out) / out.norm().max(f64::MIN_POSITIVE);
                    if slope < steepest {
                        (steepest, start) = (slope, Some(place));
                    }
                }
            }
            if start.is_some() {
                return start;
            }
        }
        if self.pieces.joints().is_some() {
            let over = |side: usize| {
                self.pieces
                    .over_joint(at.into(), side)
                    .map(NewtonPlace::from)
            };
            return (0..4).find_map(over);
        }
        let across_u = side::other_end(du, at.u).map(|(i, u)| NewtonPlace { i, u, ..at });
        let across_v = side::other_end(dv, at.v).map(|(j, v)| NewtonPlace { j, v, ..at });
        let same =
            |place: &NewtonPlace| (site.frame(*place).point - foot).norm() <= 1e-9 * self.size_m;
        across_u.filter(same).or_else(|| across_v.filter(same))
    }

    /// Parameters to report: at the upper side of a disjoined knot just below it, where evaluation
    /// sees the same side.
    fn parameters(&self, place: &NewtonPlace) -> (f64, f64) {
        let one = |d: &PieceDirection, k: usize, x: f64| {
            let torn = d.spans[k].after == Joint::Apart && (d.periodic || k + 1 < d.spans.len());
            if torn && x >= d.spans[k].end {
                x.next_down()
            } else {
                x
            }
        };
        (
            one(&self.pieces.u, place.i, place.u),
            one(&self.pieces.v, place.j, place.v),
        )
    }

    fn answer(&self, surface: &Surface, query: &Point3, found: &Descent) -> ClosestPoint {
        let point = found.frame.point;
        let to_query = query - point;
        let distance = to_query.norm();
        let distance = if distance.is_finite() {
            distance
        } else {
            f64::INFINITY
        };
        let site = Site {
            surface,
            u: &self.pieces.u,
            v: &self.pieces.v,
            joints: self.pieces.joints(),
        };
        let normal = site.normal(found.place, &found.frame, &to_query);
        let signed_distance = if to_query.dot(&normal) < 0.0 {
            -distance
        } else {
            distance
        };
        let (u, v) = self.parameters(&found.place);
        ClosestPoint {
            u,
            v,
            point,
            normal,
            distance,
            signed_distance,
        }
    }
}
