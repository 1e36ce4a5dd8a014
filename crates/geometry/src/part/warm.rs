//! Closest points of a part from one query to the next, and descent along its boundary.
//!
//! ```text
//! warm   last place ──▶ its face, what shares an edge or a vertex with it, the edges between ──▶ nearest of these,
//!                       while the query has moved less than half of what everything else was farther away; else all
//! local  place ──▶ foot inside the loops │ nearest edge ──▶ faces beyond it, as long as the distance falls
//! ```
//! The certificate: the distance to anything changes by no more than the query moves. With the foot at d and the nearest of
//! all that is not around its face at L, the foot stays around that face for (L − d) / 2, less the gaps of edges, by which
//! distances may jump where a foot passes over an edge.

use super::carrier::Carrier;
use super::closest::PartSolver;
use super::foot::{At, Best, PartFoot, Support, answer, nearest_wire, wire};
use super::part::{Face, Part};
use super::pcurve::solved;
use crate::math::Point3;
use crate::surface::WarmFoot;

/// Movements like the last one that a certificate is to last for.
const LASTS: f64 = 32.0;
/// Of the size: no certificate asks for less, or for more.
const REACH: [f64; 2] = [2e-3, 5e-2];
/// Of the size: distances within this are equal.
const EQUAL: f64 = 1e-13;
/// Of the size: a step that says whether a face goes on in a direction.
const STEP: f64 = 1e-6;
/// Steps within a face at most, and of the range of a parameter, how long they are.
const MOST_STEPS: usize = 200;
const CREEP: f64 = 0.02;
/// Supports that a descent passes over at most.
const MOST_HOPS: usize = 32;

impl PartSolver {
    /// [`PartSolver::closest`], from the last foot where that is proved to be enough. `moved_m` is how far the query moved
    /// relative to the part since the last call with this `warm`, whose u and v are a place of the part; a default one asks
    /// for a full search. `None` where the query is not finite.
    pub fn closest_warm_moved(
        &mut self,
        part: &Part,
        q: &Point3,
        moved_m: f64,
        warm: &mut WarmFoot,
    ) -> Option<PartFoot> {
        if !q.iter().all(|x| x.is_finite()) {
            warm.budget_m = 0.0;
            return None;
        }
        let known = warm.budget_m > 0.0 && warm.u.is_finite() && warm.v.is_finite();
        let last = known.then(|| part.on_face([warm.u, warm.v]));
        let left_m = if moved_m >= 0.0 {
            warm.budget_m - moved_m
        } else {
            0.0
        };
        let mut found = None;
        if let Some((face, uv)) = last
            && left_m > 0.0
        {
            let seed = self.begin(part, q, face, uv);
            if let (Some(best), true) = self.search(part, q, Some(face), seed) {
                if let Some(uv) = kept(part, face, &best) {
                    let [u, v] = part.place(face, uv);
                    *warm = WarmFoot {
                        u,
                        v,
                        budget_m: left_m,
                        net_cost: 1.0,
                    };
                    return Some(answer(part, q, &best, true));
                }
                found = Some((best, true));
            }
        }
        let (best, certified) = match found {
            Some(found) => found,
            None => {
                let seed = last.and_then(|(face, uv)| self.begin(part, q, face, uv));
                let (best, certified) = self.search(part, q, None, seed);
                let Some(best) = best else {
                    warm.budget_m = 0.0;
                    return None;
                };
                (best, certified)
            }
        };
        let foot = answer(part, q, &best, certified);
        let (face, uv) = last
            .and_then(|(face, _)| Some((face, kept(part, face, &best)?)))
            .or_else(|| plain(part, &best))
            .unwrap_or_else(|| part.on_face(foot.place));
        let budget_m = match certified {
            true => self.certificate(part, q, face, &best, moved_m),
            false => 0.0,
        };
        let [u, v] = part.place(face, uv);
        *warm = WarmFoot {
            u,
            v,
            budget_m,
            net_cost: 1.0,
        };
        Some(foot)
    }

    /// The foot on a face to begin a search with, and whether the face has no nearer place.
    fn begin(&self, part: &Part, q: &Point3, face: u32, uv: [f64; 2]) -> Option<(Best, bool)> {
        let elementary = self.splines[face as usize].is_none();
        Some((self.seed(part, q, face, uv)?, elementary))
    }

    /// The foot on a face that descent leads to, where it is inside the loops.
    fn seed(&self, part: &Part, q: &Point3, face: u32, uv: [f64; 2]) -> Option<Best> {
        let of = &part.faces[face as usize];
        let (point, uv) = match (&of.carrier, &self.splines[face as usize]) {
            (Carrier::Spline(surface), Some(solver)) => {
                let foot = solver.local(surface, q, uv[0], uv[1])?;
                (foot.point, [foot.u, foot.v])
            }
            (carrier, _) => {
                let uv = carrier.foot(q)?;
                (carrier.point(uv), uv)
            }
        };
        inside(of, face, q, point, uv)
    }

    /// How far the query may move, m, until something that is not around the face may be nearest; tiny where that is not
    /// known, so that the place is still begun with.
    fn certificate(&self, part: &Part, q: &Point3, face: u32, best: &Best, moved_m: f64) -> f64 {
        let size_m = part.size_m();
        let distance_m = best.squared.sqrt();
        let lost_m = 2.0 * part.gap_m() + EQUAL * (size_m + distance_m);
        let reach_m = (LASTS * moved_m)
            .max(REACH[0] * size_m)
            .min(REACH[1] * size_m);
        let most_m = distance_m + lost_m + 2.0 * reach_m;
        let mut ceiling = most_m * most_m;
        let around = &self.near.faces[face as usize];
        part.skin.nearest(q, &mut ceiling, |k, ceiling| {
            if around.skin_items.binary_search(&k).is_ok() {
                return;
            }
            let other = &part.faces[k as usize];
            if other.carrier.may_be_within(q, *ceiling)
                && let Some(uv) = other.carrier.foot(q)
            {
                let away = (q - other.carrier.point(uv)).norm_squared();
                if away < *ceiling && other.trim.contains(uv) {
                    *ceiling = away;
                }
            }
        });
        part.wires.nearest(q, &mut ceiling, |item, ceiling| {
            if around.wire_items.binary_search(&item).is_err()
                && let Some(found) = wire(part, q, item, *ceiling)
            {
                *ceiling = found.squared;
            }
        });
        let room_m = 0.5 * (ceiling.sqrt() - distance_m - lost_m);
        room_m.max(f64::MIN_POSITIVE)
    }

    /// The local minimum of the distance that descent from a place leads to, over edges from face to face: it stays on its
    /// branch where another is nearer, as the proxy of a tool inside the matter must. Each step is nearer than the one
    /// before. `None` where the query is not finite, or it does not arrive. Not certified.
    pub fn local(&self, part: &Part, q: &Point3, place: [f64; 2]) -> Option<PartFoot> {
        if !q.iter().chain(&place).all(|x| x.is_finite()) {
            return None;
        }
        let (face, uv) = part.on_face(place);
        let mut here = self.on(part, q, face, uv)?;
        let slack_m = 2.0 * part.gap_m() + 1e-9 * part.size_m();
        let is_farther =
            |best: &Best| best.squared.sqrt() > (q - part.point(place)).norm() + slack_m;
        if is_farther(&here) {
            // The descent went through what is outside the loops.
            here = self.creep(part, q, face, uv)?;
            if is_farther(&here) {
                return None;
            }
        }
        for _ in 0..MOST_HOPS {
            if matches!(here.support, Support::Face(_)) {
                return Some(answer(part, q, &here, false));
            }
            match self.beyond(part, q, &here) {
                Some(next) => here = next,
                None => return Some(answer(part, q, &here, false)),
            }
        }
        None
    }

    /// Descent over one face: its foot inside the loops, or the nearest of its edges.
    fn on(&self, part: &Part, q: &Point3, face: u32, uv: [f64; 2]) -> Option<Best> {
        if let Some(best) = self.seed(part, q, face, uv) {
            return Some(best);
        }
        let mut best = None;
        nearest_wire(part, q, self.near.own(face), &mut best);
        best
    }

    /// Descent over a B-spline in steps that stay within the loops: the foot it comes to, or the nearest edge from where it
    /// would leave.
    fn creep(&self, part: &Part, q: &Point3, face: u32, mut uv: [f64; 2]) -> Option<Best> {
        let of = &part.faces[face as usize];
        let Carrier::Spline(surface) = &of.carrier else {
            return None;
        };
        let chart = &of.trim.chart;
        let ranges = [surface.knots_u().domain(), surface.knots_v().domain()].map(|d| d.1 - d.0);
        let squared = |uv: [f64; 2]| (q - of.carrier.point(uv)).norm_squared();
        for _ in 0..MOST_STEPS {
            let here = squared(uv);
            let straight = self.seed(part, q, face, uv);
            if let Some(best) = straight.filter(|best| best.squared <= here) {
                return Some(best);
            }
            let frame = surface.frame(uv[0], uv[1]);
            let step = solved(&frame.du, &frame.dv, &(q - frame.point));
            let far = (step[0] / ranges[0]).abs().max((step[1] / ranges[1]).abs());
            let mut share = (CREEP / far.max(f64::MIN_POSITIVE)).min(1.0);
            let at =
                |share: f64| chart.confined([uv[0] + share * step[0], uv[1] + share * step[1]]);
            let goes_down = |share: f64| {
                (1..=4).all(|k| {
                    let [a, b] = [k - 1, k].map(|k| squared(at(share * f64::from(k) / 4.0)));
                    b < a
                })
            };
            while share * far > EQUAL && !goes_down(share) {
                share *= 0.5;
            }
            if share * far <= EQUAL || !of.trim.contains(at(share)) {
                break;
            }
            uv = at(share);
        }
        let mut best = None;
        nearest_wire(part, q, self.near.own(face), &mut best);
        best
    }

    /// A nearer place from that of an edge or a vertex: on the faces that go on from there towards the query, or the edges.
    fn beyond(&self, part: &Part, q: &Point3, here: &Best) -> Option<Best> {
        let equal_m = EQUAL * part.size_m();
        let less_m = here.squared.sqrt() - equal_m;
        let less = less_m.max(0.0) * less_m.max(0.0);
        let nearer = |best: &Best| best.squared < less;
        let count = match here.support {
            Support::Vertex(v) => self.near.vertices[v as usize].faces.len(),
            Support::Edge(k) => part.edges[k as usize].sides.len(),
            Support::Face(_) => 0,
        };
        for k in 0..count {
            let (face, uv) = match here.support {
                Support::Vertex(v) => {
                    let face = self.near.vertices[v as usize].faces[k];
                    (face, self.at_vertex(part, face, v))
                }
                Support::Edge(e) => {
                    let edge = &part.edges[e as usize];
                    let side = &edge.sides[k];
                    let At::Edge(_, at) = here.at else { continue };
                    (side.face, edge.on(side, &part.faces, at))
                }
                Support::Face(_) => continue,
            };
            // At an apex every direction goes on.
            let goes_on = uv.is_none_or(|uv| goes_on(part, q, face, here, uv));
            let start = uv.unwrap_or([0.0; 2]);
            if goes_on && let Some(next) = self.on(part, q, face, start).filter(nearer) {
                return Some(next);
            }
        }
        let Support::Vertex(v) = here.support else {
            return None;
        };
        let edges = &self.near.vertices[v as usize].edges;
        edges.iter().find_map(|&k| wire(part, q, k, less))
    }

    /// Where on a face a vertex of it is; `None` at an apex.
    fn at_vertex(&self, part: &Part, face: u32, vertex: u32) -> Option<[f64; 2]> {
        let edges = &self.near.vertices[vertex as usize].edges;
        edges.iter().find_map(|&k| {
            let edge = &part.edges[k as usize];
            let side = edge.sides.iter().find(|side| side.face == face)?;
            let last = edge.ends[1] == vertex;
            let at = match last {
                true => (edge.curve.segments() - 1, 1.0),
                false => (0, 0.0),
            };
            edge.on(side, &part.faces, at)
        })
    }
}

/// A foot on a face, where it is inside the loops.
fn inside(of: &Face, face: u32, q: &Point3, point: Point3, uv: [f64; 2]) -> Option<Best> {
    let within = !of.carrier.is_on_rim(&of.rims, uv) && of.trim.contains(uv);
    within.then_some(Best {
        point,
        support: Support::Face(face),
        at: At::Face(uv),
        squared: (q - point).norm_squared(),
    })
}

/// Whether a face goes on from a place at its loops in the direction along it that leads towards the query.
fn goes_on(part: &Part, q: &Point3, face: u32, here: &Best, uv: [f64; 2]) -> bool {
    let face = &part.faces[face as usize];
    let uv = face.trim.chart.confined(uv);
    let normal = face.carrier.normal(uv);
    let to_query = q - here.point;
    let along = to_query - normal * normal.dot(&to_query);
    let Some(along) = along.try_normalize(EQUAL * part.size_m()) else {
        return false;
    };
    let step = along * (STEP * part.size_m());
    match &face.carrier {
        Carrier::Spline(surface) => {
            let frame = surface.frame(uv[0], uv[1]);
            let [du, dv] = solved(&frame.du, &frame.dv, &step);
            let next = [uv[0] + du, uv[1] + dv];
            let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
            let periods = face.trim.chart.periods;
            let within =
                (0..2).all(|k| periods[k] > 0.0 || (domain[k].0..=domain[k].1).contains(&next[k]));
            within && face.trim.contains(next)
        }
        carrier => {
            let next = carrier.foot(&(here.point + step));
            next.is_none_or(|uv| face.trim.contains(uv))
        }
    }
}

/// Where on a face a place is that can be kept as one of this face's: inside it, or at an edge of it.
fn kept(part: &Part, face: u32, best: &Best) -> Option<[f64; 2]> {
    match best.at {
        At::Face(uv) => (best.support == Support::Face(face)).then_some(uv),
        At::Edge(k, at) => {
            let edge = &part.edges[k as usize];
            let side = edge.sides.iter().find(|side| side.face == face)?;
            let uv = edge.on(side, &part.faces, at)?;
            Some(part.faces[face as usize].trim.chart.confined(uv))
        }
        At::Alone => {
            let (own, uv) = part.beside_vertex(best.support.index());
            (own == face).then_some(uv)
        }
    }
}

/// The elementary face at an edge, if there is one.
fn plain(part: &Part, best: &Best) -> Option<(u32, [f64; 2])> {
    let At::Edge(k, _) = best.at else {
        return None;
    };
    let sides = part.edges[k as usize].sides.iter();
    sides
        .map(|side| side.face)
        .filter(|&face| part.faces[face as usize].carrier.axes().is_some())
        .find_map(|face| Some((face, kept(part, face, best)?)))
}

#[cfg(test)]
mod tests;
