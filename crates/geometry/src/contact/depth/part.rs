//! All places where a part is deepest inside a solid that can only be asked for the depth of a point: within faces as on
//! surfaces, along edges and at corners where no face beside them leads on deeper.

use super::climb::Map;
use super::golden::greatest;
use super::{DepthField, Ground, Tops};
use crate::contact::{ContactSet, ToolPoint};
use crate::math::{Point3, Pose, Vector3};
use crate::part::{CornerGround, EdgeGround, FaceGround, Part, Wire};
use crate::skin::PlacedPart;
use std::ops::Range;

/// Looks into a cell for a place that belongs to its face, in each direction.
const LOOKS: usize = 3;
/// Of a cell's radius: how far the face between its looks may be outside.
const BENT: f64 = 0.15;
/// Cells that steps of climbs are measured with.
const SPAN: f64 = 4.0;
/// Places of a segment of an edge, and how many of them have one ball around them.
const PLACES: usize = 12;
const STRETCH: usize = 8;
/// Fixed places of a round edge.
const ROUND: usize = 8;
/// Steps of golden section along an edge: 0.62⁴⁰ of the way between three places is 4e-9 of it, which counts squared.
const SECTIONS: usize = 40;
/// Of the size: a step from an edge into a face.
const INTO: f64 = 1e-5;
/// Of a step: what is less is not deeper.
const RISES: f64 = 1e-6;
/// What is tilted against a side of the solid by less, rad, lies on it with all its corners.
const RESTING: f64 = 0.02;
/// Of the size: depths this near to each other are equal, and what is as near is one place.
const SAME: f64 = 1e-9;
const ONE_PLACE: f64 = 1e-6;
/// Tops that are held.
const MOST: usize = 128;

/// Around something, in the part's frame: centre and radius, m.
type Ball = (Point3, f64);

/// A place where the part is deepest.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct PartTop {
    /// Of the part.
    pub place: [f64; 2],
    /// In the world, m.
    pub point: Point3,
    /// Which point it is.
    pub mark: ToolPoint,
}

/// A face in cells.
#[derive(Clone, Debug)]
struct FaceCells {
    map: Map,
    spacing_m: f64,
    count: [usize; 2],
    cells: Vec<Cell>,
}

#[derive(Clone, Debug)]
struct Cell {
    /// A place in it that belongs to the face, and the point there, m.
    at: Option<([f64; 2], Point3)>,
    ball: Ball,
}

/// An edge in places.
#[derive(Clone, Debug)]
struct EdgePlaces {
    /// Of all edges' places.
    places: Range<usize>,
    /// The longest way from one place to the next, m.
    step_m: f64,
    /// Corners at its ends; none of an edge that comes back.
    ends: [Option<u32>; 2],
}

/// What is known of a part before any search.
#[derive(Clone, Debug)]
struct Plan {
    faces: Vec<FaceCells>,
    /// By edge of the part; seams are none.
    edges: Vec<Option<EdgePlaces>>,
    /// Of all edges, m, and around each stretch of them.
    places: Vec<Point3>,
    stretches: Vec<Ball>,
    corners: Vec<CornerGround>,
    /// By vertex of the part.
    of_vertex: Vec<Option<u32>>,
}

/// Scratch against one part, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub(in crate::contact) struct PartDepths {
    plan: Plan,
    /// What the solid may reach.
    faces: Vec<u32>,
    wires: Vec<Wire>,
    /// (corners): it was looked at.
    seen: Vec<bool>,
    /// (most cells of a face, or places of an edge): rough depth, m.
    samples: Vec<f64>,
    tops: Tops,
    found: Vec<PartTop>,
}

/// What is searched for: where a part that stands somewhere is in a solid, or within a margin, m, of it.
struct Aim<'a, F> {
    placed: &'a PlacedPart,
    field: &'a F,
    margin_m: f64,
    /// Something of the solid is known to be in touch.
    touched: bool,
}

/// A face where the part stands.
struct PlacedFace<'a> {
    face: FaceGround<'a>,
    pose: &'a Pose,
}

impl Ground for PlacedFace<'_> {
    fn point(&self, at: [f64; 2]) -> Point3 {
        self.pose * self.face.point(at)
    }
}

fn ball(points: impl Iterator<Item = Point3> + Clone, grow: f64) -> Ball {
    let far = Point3::from(Vector3::repeat(f64::INFINITY));
    let (low, high) = points
        .clone()
        .fold((far, -far), |(l, h), p| (l.inf(&p), h.sup(&p)));
    let centre = nalgebra::center(&low, &high);
    let radius_m = points.map(|p| (p - centre).norm()).fold(0.0, f64::max);
    (centre, radius_m * (1.0 + grow))
}

impl FaceCells {
    fn new(ground: &FaceGround<'_>) -> Self {
        let [u, v] = ground.range();
        let count = ground.cells();
        let width = [
            (u[1] - u[0]) / count[0] as f64,
            (v[1] - v[0]) / count[1] as f64,
        ];
        let cell = |k: usize| {
            let corner = [
                u[0] + (k / count[1]) as f64 * width[0],
                v[0] + (k % count[1]) as f64 * width[1],
            ];
            let at = |a: f64, b: f64| [corner[0] + a * width[0], corner[1] + b * width[1]];
            // The middle comes first.
            let order = (0..LOOKS * LOOKS).map(|k| (k + LOOKS * LOOKS / 2) % (LOOKS * LOOKS));
            let look = |k: usize| (k as f64 + 0.5) / LOOKS as f64;
            let mut looks = order.map(|k| at(look(k / LOOKS), look(k % LOOKS)));
            let ends = (0..9).map(|k| at((k / 3) as f64 / 2.0, (k % 3) as f64 / 2.0));
            Cell {
                at: looks
                    .find(|uv| ground.has(*uv))
                    .map(|uv| (uv, ground.point(uv))),
                ball: ball(ends.map(|uv| ground.point(uv)), BENT),
            }
        };
        let cells: Vec<Cell> = (0..count[0] * count[1]).map(cell).collect();
        Self {
            map: Map {
                domain: [(u[0], u[1]), (v[0], v[1])],
                wraps: ground.wraps(),
                poles: ground.poles(),
                spans: width.map(|w| SPAN * w),
            },
            spacing_m: (cells.iter()).fold(f64::INFINITY, |least, cell| least.min(cell.ball.1)),
            count,
            cells,
        }
    }

    /// A place is at an end of the rectangle, where edges are.
    fn ends_at(&self, at: [f64; 2]) -> bool {
        (0..2).any(|k| {
            let (low, high) = self.map.domain[k];
            let [pole_below, pole_above] = self.map.poles[k];
            !self.map.wraps[k] && (at[k] <= low && !pole_below || at[k] >= high && !pole_above)
        })
    }

    /// The cell beside one, over a seam where there is one.
    fn beside(&self, k: usize, step: [i64; 2]) -> Option<usize> {
        let at = [k / self.count[1], k % self.count[1]];
        let mut to = [0; 2];
        for d in 0..2 {
            let (x, n) = (at[d] as i64 + step[d], self.count[d] as i64);
            if !(0..n).contains(&x) && !self.map.wraps[d] {
                return None;
            }
            to[d] = x.rem_euclid(n) as usize;
        }
        Some(to[0] * self.count[1] + to[1])
    }

    /// It has a depth that no cell around it exceeds; of equal ones it is the first.
    fn is_highest(&self, k: usize, samples: &[f64]) -> bool {
        (-1..=1)
            .flat_map(|a| (-1..=1).map(move |b| [a, b]))
            .filter_map(|step| self.beside(k, step))
            .all(|other| match other < k {
                true => samples[k] > samples[other],
                false => samples[k] >= samples[other],
            })
    }
}

impl Plan {
    fn new(part: &Part) -> Self {
        let (corners, of_vertex) = part.corners();
        let (mut places, mut stretches) = (Vec::new(), Vec::new());
        let mut edge = |(edge, counts): (u32, bool)| {
            let ground = part.edge_ground(edge);
            let last = ground.segments() as f64;
            let count = match ground.is_line() {
                true => PLACES,
                false => PLACES * ground.segments(),
            };
            // A stretch holds places of one edge only: it is filled up.
            while places.len() % STRETCH > 0 {
                places.extend(places.last().copied());
            }
            let first = places.len();
            let own = (0..=count).map(|k| ground.point(last * k as f64 / count as f64));
            places.extend(own.take_while(|_| counts));
            let own = &places[first..];
            // From each stretch to the next one as well.
            let around = |k: usize| {
                let end = (k + STRETCH + 1).min(own.len());
                ball(own[k..end].iter().copied(), BENT)
            };
            stretches.extend((0..own.len()).step_by(STRETCH).map(around));
            let steps = own.windows(2).map(|pair| (pair[1] - pair[0]).norm());
            counts.then(|| EdgePlaces {
                places: first..first + count + 1,
                step_m: steps.fold(0.0, f64::max),
                ends: (ground.ends()).map_or([None; 2], |ends| ends.map(|v| of_vertex[v as usize])),
            })
        };
        let edges = (0..).zip(part.edges()).map(&mut edge).collect();
        Self {
            faces: (0..part.faces().len() as u32)
                .map(|k| FaceCells::new(&part.face_ground(k)))
                .collect(),
            edges,
            places,
            stretches,
            corners,
            of_vertex,
        }
    }
}

impl PartDepths {
    /// Makes room for the faces, edges and corners of a part.
    pub fn new(part: &Part) -> Self {
        let plan = Plan::new(part);
        let cells = plan.faces.iter().map(|face| face.cells.len());
        let places = plan.edges.iter().flatten().map(|edge| edge.places.len());
        let most = cells.chain(places).max().unwrap_or(0);
        // That of the face that is climbed on takes its place.
        let nowhere = Map {
            domain: [(0.0, 1.0); 2],
            wraps: [false; 2],
            poles: [[false; 2]; 2],
            spans: [1.0; 2],
        };
        Self {
            tops: Tops::new(nowhere, None, part.size_m(), 0.0),
            faces: Vec::with_capacity(plan.faces.len()),
            wires: Vec::with_capacity(plan.edges.len() + plan.of_vertex.len()),
            seen: vec![false; plan.corners.len()],
            samples: Vec::with_capacity(most),
            found: Vec::with_capacity(MOST),
            plan,
        }
    }

    /// What the last search found.
    pub fn found(&self) -> &[PartTop] {
        &self.found
    }

    /// Diagonal of the part's box, m.
    pub fn size_m(&self) -> f64 {
        self.tops.size_m
    }

    /// Finds the places that are deeper than those beside them and no farther outside than the margin, m; `touched`:
    /// something of the solid is known to be in touch.
    pub fn search(
        &mut self,
        placed: &PlacedPart,
        field: &impl DepthField,
        margin_m: f64,
        touched: bool,
        out: &mut ContactSet,
    ) {
        let aim = Aim {
            placed,
            field,
            margin_m,
            touched,
        };
        self.found.clear();
        self.seen.fill(false);
        self.reach(&aim);
        for k in 0..self.faces.len() {
            self.search_face(&aim, self.faces[k], out);
        }
        for k in 0..self.wires.len() {
            match self.wires[k] {
                Wire::Edge(edge) => self.search_edge(&aim, edge, out),
                Wire::Vertex(vertex) => {
                    self.look_at_corner(&aim, self.plan.of_vertex[vertex as usize], out);
                }
            }
        }
    }

    /// Gathers what the solid may reach.
    fn reach(&mut self, aim: &Aim<'_, impl DepthField>) {
        let pose = aim.placed.pose();
        let turn = pose.rotation.to_rotation_matrix().into_inner().abs();
        let passes = |low: &Point3, high: &Point3| {
            let half = turn * ((high - low) * 0.5) * (1.0 + 1e-12);
            aim.field
                .may_reach(&(pose * nalgebra::center(low, high)), &half)
        };
        let Self { faces, wires, .. } = self;
        faces.clear();
        wires.clear();
        let part = aim.placed.part();
        part.passing_faces(passes, |face| faces.push(face));
        part.passing_wires(passes, |wire| wires.push(wire));
    }

    fn hold(&mut self, top: PartTop, out: &mut ContactSet) {
        let near_m = ONE_PLACE * self.tops.size_m;
        let mut held = self.found.iter();
        if held.any(|other| (other.point - top.point).norm() <= near_m) {
            return;
        }
        if self.found.len() == MOST {
            out.note_dropped();
            return;
        }
        self.found.push(top);
    }

    fn search_face(&mut self, aim: &Aim<'_, impl DepthField>, k: u32, out: &mut ContactSet) {
        let Self {
            plan,
            samples,
            tops,
            ..
        } = self;
        let face = &plan.faces[k as usize];
        let part = aim.placed.part();
        let ground = PlacedFace {
            face: part.face_ground(k),
            pose: aim.placed.pose(),
        };
        samples.clear();
        samples.extend(face.cells.iter().map(|cell| match cell.at {
            Some((_, point)) if aim.may_reach(&cell.ball) => aim.rough(&point),
            _ => f64::NEG_INFINITY,
        }));
        tops.map = face.map;
        tops.spacing_m = face.spacing_m;
        tops.found.clear();
        tops.starts.clear();
        let mut complete = true;
        for (k, cell) in face.cells.iter().enumerate() {
            let here = samples[k];
            let at = cell.at.filter(|_| here > f64::NEG_INFINITY);
            if let Some((at, _)) = at.filter(|_| face.is_highest(k, samples)) {
                complete &= tops.starts.offer(here, at);
            }
        }
        if !complete {
            out.note_dropped();
        }
        tops.climb_all(true, aim.field, aim.margin_m, &[], &ground);
        // Through the middle of the solid: there, no side is nearest, and none of its edges is in touch.
        let by_sides = aim.touched || !tops.found.is_empty() || !samples.iter().any(|d| *d > 0.0);
        if !by_sides {
            tops.climb_all(false, aim.field, aim.margin_m, &[], &ground);
        }
        // Climbs go on past the edges of a face, where its own tops are those of the edges.
        (tops.found).retain(|top| !face.ends_at(top.at) && ground.face.has(top.at));
        tops.finish(by_sides, aim.field, &ground);
        for t in 0..self.tops.found.len() {
            let at = self.tops.found[t].at;
            let face = &self.plan.faces[k as usize];
            if !face.ends_at(at) && ground.face.has(at) {
                let top = PartTop {
                    place: part.place(k, at),
                    point: ground.point(at),
                    mark: ToolPoint::Found,
                };
                self.hold(top, out);
            }
        }
    }

    fn search_edge(&mut self, aim: &Aim<'_, impl DepthField>, k: u32, out: &mut ContactSet) {
        let Some(edge) = self.plan.edges[k as usize].clone() else {
            return;
        };
        for corner in edge.ends {
            self.look_at_corner(aim, corner, out);
        }
        debug_assert!(edge.places.start % STRETCH == 0, "a stretch is of one edge");
        let Plan {
            places, stretches, ..
        } = &self.plan;
        self.samples.clear();
        for k in edge.places.clone().step_by(STRETCH) {
            let own = &places[k..edge.places.end.min(k + STRETCH)];
            let reached = aim.may_reach(&stretches[k / STRETCH]);
            let rough = |p| {
                if reached {
                    aim.rough(p)
                } else {
                    f64::NEG_INFINITY
                }
            };
            self.samples.extend(own.iter().map(rough));
        }
        // A rough depth may be above the true one by the way to the next place.
        let least_m = -aim.margin_m - edge.step_m;
        if !self.samples.iter().any(|depth_m| *depth_m >= least_m) {
            return;
        }
        let along = Along {
            ground: aim.placed.part().edge_ground(k),
            pose: aim.placed.pose(),
            size_m: self.tops.size_m,
        };
        let fixed_m = self.fixed_places(aim, &edge, &along, out);
        let count = edge.places.len() - 1;
        let at = |k: usize| along.last() * k as f64 / count as f64;
        let level_m = SAME * self.tops.size_m;
        let mut next = 0;
        while next <= count {
            // Places that are level count as one.
            let (first, here) = (next, self.samples[next]);
            let rest = &self.samples[first..];
            let is_level =
                |depth_m: &&f64| **depth_m == here || (**depth_m - here).abs() <= level_m;
            next += rest.iter().take_while(is_level).count();
            let before = first.checked_sub(1).map(|k| self.samples[k]);
            let after = self.samples.get(next).copied();
            let mut beside = [before, after].into_iter().flatten();
            if here < least_m || beside.any(|there| there > here) {
                continue;
            }
            let depth = |place| aim.field.depth_m(&along.point(place));
            let ends = [first.saturating_sub(1), next.min(count)].map(at);
            let (place, depth_m) = greatest(ends[0], ends[1], SECTIONS, depth);
            let by_m = depth_m - fixed_m;
            if by_m > level_m && along.is_top(aim, place, depth_m) {
                let mark = match fixed_m.is_finite() {
                    true => ToolPoint::Deepest { by_m },
                    false => ToolPoint::Found,
                };
                self.hold(along.top(place, mark), out);
            }
        }
    }

    /// Holds the fixed places of a round edge; the depth of the deepest of these and of the ends, m.
    fn fixed_places(
        &mut self,
        aim: &Aim<'_, impl DepthField>,
        edge: &EdgePlaces,
        along: &Along<'_>,
        out: &mut ContactSet,
    ) -> f64 {
        let mut fixed_m = f64::NEG_INFINITY;
        for place in along.ground.round(ROUND) {
            let depth_m = aim.field.depth_m(&along.point(place));
            fixed_m = fixed_m.max(depth_m);
            if along.is_top(aim, place, depth_m) {
                self.hold(along.top(place, ToolPoint::Round), out);
            }
        }
        let ends = [0.0, along.last()];
        let ends = ends.into_iter().filter(|_| edge.ends != [None; 2]);
        let depths = ends.map(|place| aim.field.depth_m(&along.point(place)));
        depths.fold(fixed_m, f64::max)
    }

    fn look_at_corner(
        &mut self,
        aim: &Aim<'_, impl DepthField>,
        corner: Option<u32>,
        out: &mut ContactSet,
    ) {
        let Some(k) = corner.map(|k| k as usize) else {
            return;
        };
        if std::mem::replace(&mut self.seen[k], true) {
            return;
        }
        let corner = &self.plan.corners[k];
        let pose = aim.placed.pose();
        let point = pose * corner.point;
        let depth_m = aim.field.depth_m(&point);
        let leads = |step: &Vector3| {
            let beside = pose * (corner.point + step);
            aim.field.depth_m(&beside) > depth_m + RESTING * step.norm()
        };
        if depth_m >= -aim.margin_m && !corner.beside.iter().any(leads) {
            let top = PartTop {
                place: corner.place,
                point,
                mark: ToolPoint::Corner,
            };
            self.hold(top, out);
        }
    }
}

impl<F: DepthField> Aim<'_, F> {
    fn may_reach(&self, (centre, radius_m): &Ball) -> bool {
        let centre = self.placed.pose() * centre;
        self.field.may_reach(&centre, &Vector3::repeat(*radius_m))
    }

    /// Rough depth of a point of the part's frame, m.
    fn rough(&self, p: &Point3) -> f64 {
        self.field.rough(&(self.placed.pose() * p)).0
    }
}

/// An edge where the part stands.
struct Along<'a> {
    ground: EdgeGround<'a>,
    pose: &'a Pose,
    size_m: f64,
}

impl Along<'_> {
    fn last(&self) -> f64 {
        self.ground.segments() as f64
    }

    fn point(&self, place: f64) -> Point3 {
        self.pose * self.ground.point(place)
    }

    /// It is in reach, and no face beside it leads on deeper.
    fn is_top(&self, aim: &Aim<'_, impl DepthField>, place: f64, depth_m: f64) -> bool {
        let step_m = INTO * self.size_m;
        let point = self.point(place);
        let mut inward = self.ground.inward(place);
        depth_m >= -aim.margin_m
            && inward.all(|inward| {
                let beside = point + self.pose * inward * step_m;
                aim.field.depth_m(&beside) <= depth_m + RISES * step_m
            })
    }

    fn top(&self, place: f64, mark: ToolPoint) -> PartTop {
        PartTop {
            place: self.ground.place(place),
            point: self.point(place),
            mark,
        }
    }
}
