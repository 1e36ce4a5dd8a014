//! All local minima of the distance to a part, or of the height above a plane: feet on carriers within the loops, places of
//! edges, and vertices, as far as no face beside them leads on to something nearer.
//!
//! ```text
//! boxes in reach ──▶ feet of faces │ stationary places of edges │ vertices ──▶ none beside leads down ──▶ nearest first, merged
//! ```
//! At a place x, a way d leads to the query: q − x, or straight down. A place of an edge is a minimum where d · b ≤ 0 for the
//! conormal b of each face: the unit vector in the face's tangent plane that leads from the edge into the face. A vertex is
//! one where d · t ≤ 0 for the tangents t of all its edges and where no face has the shadow of d in its corner. Edges of
//! files lie off their faces, so that a foot may be past the edge on both sides of a smooth one: each face therefore goes on
//! past its edges by twice their gap and a share of the size, and an edge that is a minimum only thanks to that is merged
//! with the foot beside it. The closest point of the part is always among the minima of the distance.

use super::carrier::Carrier;
use super::closest::PartSolver;
use super::curve::OnCurve;
use super::fan::{Fan, beside, fans, frame, ruling, same_places};
use super::foot::{At, Best, PartFoot, Support, answer};
use super::part::Part;
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestPoint, Summit};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Minima that are reported at most.
pub(crate) const MOST: usize = 64;
/// Minima that are held before they are merged.
const MOST_HELD: usize = 192;
/// Of the size: how far faces go on past their edges, beside twice the gap.
const PAD: f64 = 1e-8;
/// Of the size: how far from a place its neighbourhood is looked at.
const STEP: f64 = 1e-4;
/// Of the size: places nearer to each other than this, with normals as near as [`SAME_NORMAL`], are one.
const SAME: f64 = 1e-9;
const SAME_NORMAL: f64 = 1e-6;
/// Points of a round edge that lies on a plane.
const ROUND: usize = 8;
/// What is straight and tilted against a plane by less, rad, lies on it with all its corners.
const RESTING: f64 = 0.02;

/// What the minima are of.
#[derive(Clone, Copy, Debug)]
enum Aim {
    /// The distance to a point, m.
    To(Point3),
    /// The height above a plane, m, against a unit vector down; the plane's own place along it.
    Down(Vector3, f64),
}

/// Which point of its support a minimum is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A minimum.
    Least,
    /// One of eight fixed points of what is round and lies on a plane.
    Round,
}

/// A minimum before it is merged.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// Distance, or height above the plane, m.
    value: f64,
    point: Point3,
    normal: Vector3,
    support: Support,
    face: u32,
    uv: [f64; 2],
    gap_m: f64,
    /// A neighbour leads down, or nearly so.
    weak: bool,
    mark: Mark,
}

/// Scratch for all minima of one part.
#[derive(Clone, Debug)]
pub(crate) struct PartMinima {
    /// By vertex: the first one at its place.
    first: Vec<u32>,
    fans: Vec<Fan>,
    /// By vertex: the last search that looked at it.
    seen: Vec<u64>,
    search: u64,
    feet: Vec<ClosestPoint>,
    summits: Vec<Summit>,
    held: Vec<Held>,
    out: Vec<(PartFoot, Mark)>,
    size_m: f64,
    complete: bool,
    /// Searches that did not find the closest point themselves.
    #[cfg(test)]
    pub missed: u64,
}

impl PartMinima {
    /// Scratch for a part.
    pub fn new(part: &Part) -> Self {
        let size_m = part.size_m();
        let first = same_places(part, SAME * size_m);
        Self {
            fans: fans(part, &first, STEP * size_m),
            seen: vec![0; part.vertices.len()],
            first,
            search: 0,
            feet: Vec::with_capacity(MOST),
            summits: Vec::with_capacity(MOST),
            held: Vec::with_capacity(MOST_HELD + 1),
            out: Vec::with_capacity(MOST),
            size_m,
            complete: true,
            #[cfg(test)]
            missed: 0,
        }
    }

    /// Nearest first; distances in m, or heights above a plane, negative below it.
    pub fn found(&self) -> &[(PartFoot, Mark)] {
        &self.out
    }

    /// None was left out of the last search.
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// The face ends there, and none goes on.
    pub fn is_rim(&self, part: &Part, support: Support) -> bool {
        match support {
            Support::Face(_) => false,
            Support::Edge(k) => part.edges[k as usize].sides.len() == 1,
            Support::Vertex(k) => self.fans[self.first[k as usize] as usize].rim,
        }
    }

    /// All minima of the distance from `q` up to `within_m`, and the closest point, which is also given where it is farther if
    /// the query is in the box around the part. `None` where there is none, or the query is not finite.
    pub fn within(
        &mut self,
        part: &Part,
        solver: &mut PartSolver,
        q: &Point3,
        within_m: f64,
    ) -> Option<PartFoot> {
        self.begin();
        if !q.iter().all(|x| x.is_finite()) {
            return None;
        }
        let aim = Aim::To(*q);
        self.gather(part, solver, &aim, within_m);
        let seed = self.held.first().and_then(|held| match held.support {
            Support::Face(k) => {
                let best = Best {
                    point: held.point,
                    support: held.support,
                    at: At::Face(held.uv),
                    squared: (q - held.point).norm_squared(),
                };
                Some((best, part.faces[k as usize].carrier.axes().is_some()))
            }
            _ => None,
        });
        let (low, high) = part.bounds();
        let most = match (0..3).all(|k| q[k] >= low[k] && q[k] <= high[k]) {
            true => f64::INFINITY,
            false => within_m * within_m * (1.0 + 1e-15) + f64::MIN_POSITIVE,
        };
        let (best, certified) = solver.search_within(part, q, seed, most);
        self.complete &= certified;
        let closest = best.map(|best| answer(part, q, &best, certified));
        let Some(closest) = closest.filter(|closest| closest.distance <= within_m) else {
            // At the very end of the reach, rounding may tell the two apart.
            self.held.clear();
            return closest;
        };
        let nearest = self.held.first().map_or(f64::INFINITY, |held| held.value);
        if nearest > closest.distance + 1e-13 * self.size_m {
            #[cfg(test)]
            {
                // An edge may end off its vertex by the gap.
                let gap_m = self.gap_of(part, closest.support);
                let off_m = nearest - closest.distance;
                self.missed += u64::from(off_m > gap_m + SAME * self.size_m);
            }
            let (face, uv) = part.on_face(closest.place);
            self.hold(Held {
                value: closest.distance,
                point: closest.point,
                normal: closest.normal,
                support: closest.support,
                face,
                uv,
                gap_m: self.gap_of(part, closest.support),
                weak: true,
                mark: Mark::Least,
            });
        }
        self.merge(part, &aim);
        Some(closest)
    }

    /// All places that are lower than their neighbours, up to `within_m` above a plane: `down` is a unit vector and `level_m`
    /// the plane's place along it. Of what is straight or round and lies on the plane, all corners, or eight points.
    pub fn lowest(
        &mut self,
        part: &Part,
        solver: &mut PartSolver,
        down: &Vector3,
        level_m: f64,
        within_m: f64,
    ) {
        self.begin();
        let aim = Aim::Down(*down, level_m);
        self.gather(part, solver, &aim, within_m);
        self.merge(part, &aim);
    }

    fn begin(&mut self) {
        self.search += 1;
        self.held.clear();
        self.out.clear();
        self.complete = true;
    }

    fn gap_of(&self, part: &Part, support: Support) -> f64 {
        match support {
            Support::Face(_) => 0.0,
            Support::Edge(k) => part.edges[k as usize].gap_m,
            Support::Vertex(k) => self.fans[self.first[k as usize] as usize].gap_m,
        }
    }

    fn gather(&mut self, part: &Part, solver: &mut PartSolver, aim: &Aim, within_m: f64) {
        match aim {
            Aim::To(q) => {
                let mut ceiling = within_m * within_m * (1.0 + 1e-15) + f64::MIN_POSITIVE;
                (part.wires).nearest(q, &mut ceiling, |k, _| {
                    self.add_wire(part, aim, k, within_m);
                });
                (part.skin).nearest(q, &mut ceiling, |k, _| {
                    self.add_face(part, solver, aim, k, within_m);
                });
            }
            Aim::Down(down, level_m) => {
                let mut ceiling = within_m - level_m + 1e-12 * self.size_m;
                (part.wires).lowest(down, &mut ceiling, |k, _| {
                    self.add_wire(part, aim, k, within_m);
                });
                (part.skin).lowest(down, &mut ceiling, |k, _| {
                    self.add_face(part, solver, aim, k, within_m);
                });
            }
        }
    }

    /// Keeps a minimum, in order of value; when the list is full, the greatest is dropped and the search is not complete.
    fn hold(&mut self, held: Held) {
        let rank = |h: &Held| match h.support {
            Support::Face(k) => (0, k),
            Support::Edge(k) => (1, k),
            Support::Vertex(k) => (2, k),
        };
        let before = |h: &Held| (h.value.total_cmp(&held.value)).then(rank(h).cmp(&rank(&held)));
        let at = self.held.partition_point(|h| before(h).is_le());
        self.held.insert(at, held);
        if self.held.len() > MOST_HELD {
            self.held.pop();
            self.complete = false;
        }
    }

    /// Leaves out what is found twice.
    fn merge(&mut self, part: &Part, aim: &Aim) {
        let mut kept = 0;
        for j in 0..self.held.len() {
            let one = self.held[j];
            if !self.held[..kept].iter().any(|h| self.is_one(part, h, &one)) {
                self.held[kept] = one;
                kept += 1;
            }
        }
        self.complete &= kept <= MOST;
        for held in &self.held[..kept.min(MOST)] {
            self.out.push((held.foot(part, aim), held.mark));
        }
    }

    fn is_one(&self, part: &Part, a: &Held, b: &Held) -> bool {
        let away_m = (a.point - b.point).norm();
        if away_m <= SAME * self.size_m
            && (a.normal - b.normal).norm() <= SAME_NORMAL
            && (a.mark == b.mark || a.support != b.support)
        {
            return true;
        }
        let near_m = 16.0 * self.pad_m(a.gap_m.max(b.gap_m)) + 1e-6 * self.size_m;
        if away_m > near_m || a.mark != b.mark {
            return false;
        }
        if a.support == b.support {
            return away_m <= 100.0 * SAME * self.size_m;
        }
        let touches = |low: &Held, high: &Held| {
            low.weak
                && match (low.support, high.support) {
                    (Support::Edge(e), Support::Face(f)) => {
                        part.edges[e as usize].sides.iter().any(|s| s.face == f)
                    }
                    (Support::Vertex(v), Support::Face(f)) => {
                        let corners = &self.fans[self.first[v as usize] as usize].corners;
                        corners.iter().any(|c| c.face == f)
                    }
                    (Support::Vertex(v), Support::Edge(e)) => {
                        let v = self.first[v as usize];
                        (part.edges[e as usize].ends)
                            .iter()
                            .any(|&end| self.first[end as usize] == v)
                    }
                    _ => false,
                }
        };
        touches(a, b) || touches(b, a)
    }

    /// How far faces go on past an edge with a gap, m.
    fn pad_m(&self, gap_m: f64) -> f64 {
        2.0 * gap_m + PAD * self.size_m
    }

    /// [`PartMinima::pad_m`] as the component that the way to the query may have along a unit vector: m, or for a plane the
    /// sine of an angle.
    fn slack(&self, aim: &Aim, gap_m: f64) -> f64 {
        match aim {
            Aim::To(_) => self.pad_m(gap_m),
            Aim::Down(..) => (1e-7 + 8.0 * gap_m / self.size_m).min(RESTING),
        }
    }
}

impl Aim {
    fn way(&self, x: &Point3) -> Vector3 {
        match self {
            Self::To(q) => q - x,
            Self::Down(down, _) => *down,
        }
    }

    fn value(&self, x: &Point3) -> f64 {
        match self {
            Self::To(q) => (q - x).norm(),
            Self::Down(down, level_m) => level_m - down.dot(&x.coords),
        }
    }

    /// How much is gained by a step, in units of the way's length times the step's.
    fn gain(&self, way: &Vector3, step: &Vector3) -> f64 {
        match self {
            Self::To(_) => way.dot(step) - 0.5 * step.norm_squared(),
            Self::Down(..) => way.dot(step),
        }
    }

    /// The way of a plane, where a face with such a normal lies on it.
    fn rests(&self, normal: &Vector3) -> bool {
        match self {
            Self::To(_) => false,
            Self::Down(down, _) => normal.cross(down).norm_squared() <= RESTING * RESTING,
        }
    }

    fn is_plane(&self) -> bool {
        matches!(self, Self::Down(..))
    }
}

impl Held {
    fn foot(&self, part: &Part, aim: &Aim) -> PartFoot {
        let signed = match aim {
            Aim::To(_) if self.value < self.gap_m => Some(0.0),
            Aim::To(q) => Some(self.value.copysign(self.normal.dot(&(q - self.point)))),
            Aim::Down(..) => None,
        };
        PartFoot {
            point: self.point,
            normal: self.normal,
            distance: self.value,
            signed_distance: signed.filter(|_| part.is_closed()),
            support: self.support,
            face: self.face,
            place: part.place(self.face, self.uv),
            certified: true,
        }
    }
}

/// Feet on faces.
impl PartMinima {
    fn add_face(&mut self, part: &Part, solver: &mut PartSolver, aim: &Aim, k: u32, within_m: f64) {
        let face = &part.faces[k as usize];
        match (aim, &face.carrier) {
            (Aim::To(q), Carrier::Spline(_)) => {
                let mut feet = std::mem::take(&mut self.feet);
                self.complete &= solver.minima_of(part, k, q, within_m, &mut feet);
                for foot in &feet {
                    self.add_foot(part, aim, k, [foot.u, foot.v], within_m, Mark::Least);
                }
                self.feet = feet;
            }
            (Aim::Down(down, level_m), Carrier::Spline(surface)) => {
                let mut summits = std::mem::take(&mut self.summits);
                if let Some(solver) = &mut solver.splines[k as usize] {
                    let least_m = level_m - within_m;
                    self.complete &= solver.summits_along(surface, down, least_m, &mut summits);
                }
                for top in &summits {
                    self.add_foot(part, aim, k, [top.u, top.v], within_m, Mark::Least);
                }
                self.summits = summits;
            }
            (Aim::To(q), carrier) => {
                if let Some(uv) = carrier.foot(q) {
                    self.add_foot(part, aim, k, uv, within_m, Mark::Least);
                }
            }
            (Aim::Down(down, _), Carrier::Sphere { axes, .. } | Carrier::Torus { axes, .. }) => {
                let [x, y, z] = [&axes.x, &axes.y, &axes.z].map(|axis| axis.dot(down));
                let rho = libm::hypot(x, y);
                let uv = [libm::atan2(y, x), libm::atan2(z, rho)];
                self.add_foot(part, aim, k, uv, within_m, Mark::Least);
                if rho <= RESTING && matches!(face.carrier, Carrier::Torus { .. }) {
                    for turn in 0..ROUND {
                        let u = TAU * turn as f64 / ROUND as f64;
                        let uv = [u, FRAC_PI_2.copysign(z)];
                        self.add_foot(part, aim, k, uv, within_m, Mark::Round);
                    }
                }
            }
            // Straight in one direction: their lowest places are on edges.
            (
                Aim::Down(..),
                Carrier::Plane(_) | Carrier::Cylinder { .. } | Carrier::Cone { .. },
            ) => {}
        }
    }

    fn add_foot(
        &mut self,
        part: &Part,
        aim: &Aim,
        k: u32,
        uv: [f64; 2],
        within_m: f64,
        mark: Mark,
    ) {
        let face = &part.faces[k as usize];
        let point = face.carrier.point(uv);
        let value = aim.value(&point);
        // Where a B-spline ends, an edge is as near.
        if value <= within_m && !face.carrier.is_on_rim(&face.rims, uv) && face.trim.contains(uv) {
            self.hold(Held {
                value,
                point,
                normal: face.normal(uv),
                support: Support::Face(k),
                face: k,
                uv,
                gap_m: 0.0,
                weak: false,
                mark,
            });
        }
    }
}

/// Stationary places of edges, and what the trees of wires hold.
impl PartMinima {
    fn add_wire(&mut self, part: &Part, aim: &Aim, item: u32, within_m: f64) {
        let Some(edge) = part.edges.get(item as usize) else {
            let v = part.lone[item as usize - part.edges.len()];
            return self.add_vertex(part, aim, v, within_m);
        };
        if edge.sides.is_empty() {
            return;
        }
        for v in edge.ends {
            self.add_vertex(part, aim, v, within_m);
        }
        match aim {
            Aim::To(q) => {
                let ceiling = within_m * within_m * (1.0 + 1e-15) + f64::MIN_POSITIVE;
                edge.curve.minima_within(q, ceiling, |OnCurve { at, .. }| {
                    self.add_edge(part, aim, item, at, within_m, Mark::Least);
                });
            }
            Aim::Down(down, _) => {
                edge.curve.summits(down, |at| {
                    self.add_edge(part, aim, item, at, within_m, Mark::Least);
                });
                if edge.curve.axis().is_some_and(|axis| aim.rests(axis)) {
                    for at in edge.curve.round(ROUND) {
                        self.add_edge(part, aim, item, at, within_m, Mark::Round);
                    }
                }
            }
        }
    }

    fn add_edge(
        &mut self,
        part: &Part,
        aim: &Aim,
        k: u32,
        at: (usize, f64),
        within_m: f64,
        mark: Mark,
    ) {
        let edge = &part.edges[k as usize];
        let point = edge.curve.point(at);
        let value = aim.value(&point);
        let Some(tangent) = edge.curve.slope(at).try_normalize(f64::MIN_POSITIVE) else {
            return;
        };
        if value > within_m {
            return;
        }
        let way = aim.way(&point);
        let slack = self.slack(aim, edge.gap_m);
        let step_m = STEP * self.size_m + 8.0 * self.pad_m(edge.gap_m);
        let mut weak = false;
        let mut sum = Vector3::zeros();
        for side in &edge.sides {
            let face = &part.faces[side.face as usize];
            let Some((uv, normal, inward)) = frame(part, edge, side, at, &tangent) else {
                continue;
            };
            sum += normal;
            let into = way.dot(&inward);
            // What is straight and nearly level lies on a plane; so does all that is beside a level circle.
            let straight = match &face.carrier {
                Carrier::Plane(_) => true,
                Carrier::Cylinder { .. } | Carrier::Cone { .. } => {
                    ruling(face, uv).is_some_and(|r| r.dot(&inward).abs() > 1.0 - RESTING)
                }
                _ => false,
            };
            if (straight || mark == Mark::Round) && aim.is_plane() && aim.rests(&normal) {
                weak = true;
                continue;
            }
            if into > slack {
                return;
            }
            if into > -slack {
                weak = true;
                let step = beside(face, uv, &(inward * step_m));
                let rough = 2.0 * edge.gap_m * way.norm();
                if aim.gain(&way, &step) > slack * step.norm() + rough {
                    return;
                }
            }
        }
        let (face, uv) = part.beside_edge(k, at);
        self.hold(Held {
            value,
            point,
            normal: sum
                .try_normalize(f64::MIN_POSITIVE)
                .unwrap_or_else(Vector3::z),
            support: Support::Edge(k),
            face,
            uv,
            gap_m: edge.gap_m,
            weak,
            mark,
        });
    }
}

/// Vertices and apexes.
impl PartMinima {
    fn add_vertex(&mut self, part: &Part, aim: &Aim, v: u32, within_m: f64) {
        let v = self.first[v as usize];
        if std::mem::replace(&mut self.seen[v as usize], self.search) == self.search {
            return;
        }
        let point = part.vertices[v as usize].point;
        let value = aim.value(&point);
        if value > within_m {
            return;
        }
        let Some(weak) = self.judge(part, aim, v, &point) else {
            return;
        };
        let fan = &self.fans[v as usize];
        let (face, uv) = self.on_face(part, v);
        self.hold(Held {
            value,
            point,
            normal: fan.normal,
            support: Support::Vertex(v),
            face,
            uv,
            gap_m: fan.gap_m,
            weak,
            mark: Mark::Least,
        });
    }

    /// Whether a vertex is a minimum, and whether something beside it is nearly one as well.
    fn judge(&self, part: &Part, aim: &Aim, v: u32, point: &Point3) -> Option<bool> {
        let fan = &self.fans[v as usize];
        let way = aim.way(point);
        let slack = self.slack(aim, fan.gap_m);
        let (mut weak, mut resting) = (false, false);
        if let Some((axis, [sin, cos])) = &fan.apex {
            let up = axis.dot(&way);
            let out = (way - axis * up).norm();
            let into = out * sin + up * cos;
            return (into <= slack).then_some(into > -slack);
        }
        for tip in &fan.tips {
            let into = way.dot(&tip.tangent);
            let most = match tip.straight && aim.is_plane() {
                true => RESTING,
                false => slack,
            };
            if into > most {
                return None;
            }
            weak |= into > -slack;
            resting |= into > slack;
        }
        for corner in fan.corners.iter().filter(|corner| !corner.sharp) {
            let mut shadow = way - corner.normal * corner.normal.dot(&way);
            if aim.rests(&corner.normal) {
                match (&part.faces[corner.face as usize].carrier, &corner.ruling) {
                    (Carrier::Plane(_), _) => {
                        resting = true;
                        continue;
                    }
                    (_, Some(ruling)) => {
                        resting = true;
                        shadow -= ruling * ruling.dot(&shadow);
                    }
                    _ => {}
                }
            }
            let [a, b] = corner.inward.map(|inward| inward.dot(&shadow));
            let into = if corner.wide { a.max(b) } else { a.min(b) };
            if into > slack {
                return None;
            }
            weak |= into > -slack;
        }
        let most = if resting { RESTING } else { slack };
        // Faces may be off by the gap more or less where the step ends.
        let rough = 2.0 * fan.gap_m * way.norm();
        let leads = |step: &Vector3| aim.gain(&way, step) > most * step.norm() + rough;
        (!fan.beside.iter().any(leads)).then_some(weak)
    }

    fn on_face(&self, part: &Part, v: u32) -> (u32, [f64; 2]) {
        let fan = &self.fans[v as usize];
        match fan.corners.first() {
            Some(corner) => (corner.face, corner.uv),
            None => part.beside_vertex(v),
        }
    }
}
