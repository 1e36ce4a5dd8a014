//! All places where a part is deepest inside a solid that can only be asked for the depth of a point: within faces as on
//! surfaces, along edges and at corners where no face beside them leads on deeper.

use super::climb::Map;
use super::{DepthField, Ground, Tops};
use crate::contact::{ContactSet, ToolPoint};
use crate::math::{Point3, Pose, Vector3};
use crate::part::{CornerGround, EdgeGround, FaceGround, Part};
use crate::skin::PlacedPart;

/// Looks into a cell for a place that belongs to its face, in each direction.
const LOOKS: usize = 3;
/// Of a cell's radius: what is bent between its looks.
const BENT: f64 = 0.15;
/// Cells that steps of climbs are measured with.
const SPAN: f64 = 4.0;
/// Places of a segment of an edge.
const PLACES: usize = 12;
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
    cells: [usize; 2],
    first: usize,
    /// Around all of it, m.
    ball: (Point3, f64),
}

#[derive(Clone, Debug)]
struct Cell {
    /// A place in it that belongs to the face.
    at: Option<[f64; 2]>,
    /// Around it, m.
    ball: (Point3, f64),
}

#[derive(Clone, Debug)]
struct EdgePlaces {
    edge: u32,
    count: usize,
    /// Corners at its ends.
    ends: [Option<u32>; 2],
    /// Around it, m.
    ball: (Point3, f64),
}

/// Scratch against one part, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub(in crate::contact) struct PartDepths {
    faces: Vec<FaceCells>,
    cells: Vec<Cell>,
    edges: Vec<EdgePlaces>,
    corners: Vec<CornerGround>,
    /// (corners): it was looked at.
    seen: Vec<bool>,
    /// (most cells of a face, or places of an edge): rough depth, m.
    samples: Vec<f64>,
    tops: Tops,
    found: Vec<PartTop>,
}

/// A face where the part stands.
struct Placed<'a> {
    face: FaceGround<'a>,
    pose: &'a Pose,
}

impl Ground for Placed<'_> {
    fn point(&self, at: [f64; 2]) -> Point3 {
        self.pose * self.face.point(at)
    }
}

/// A ball around points, m.
fn ball(points: impl Iterator<Item = Point3> + Clone, grow: f64) -> (Point3, f64) {
    let far = Point3::from(Vector3::repeat(f64::INFINITY));
    let (low, high) = points
        .clone()
        .fold((far, -far), |(l, h), p| (l.inf(&p), h.sup(&p)));
    let centre = nalgebra::center(&low, &high);
    let radius_m = points.map(|p| (p - centre).norm()).fold(0.0, f64::max);
    (centre, radius_m * (1.0 + grow))
}

impl FaceCells {
    fn new(ground: &FaceGround<'_>, cells: &mut Vec<Cell>) -> Self {
        let [u, v] = ground.range();
        let count = ground.cells();
        let width = [
            (u[1] - u[0]) / count[0] as f64,
            (v[1] - v[0]) / count[1] as f64,
        ];
        let first = cells.len();
        for i in 0..count[0] {
            for j in 0..count[1] {
                let at = |a: f64, b: f64| {
                    [
                        u[0] + (i as f64 + a) * width[0],
                        v[0] + (j as f64 + b) * width[1],
                    ]
                };
                let look = |k: usize| (k as f64 + 0.5) / LOOKS as f64;
                // The middle comes first.
                let looks = (0..LOOKS * LOOKS)
                    .map(|k| (k + LOOKS * LOOKS / 2) % (LOOKS * LOOKS))
                    .map(|k| at(look(k / LOOKS), look(k % LOOKS)));
                let ends = (0..LOOKS * LOOKS)
                    .map(|k| at((k / LOOKS) as f64 / 2.0, (k % LOOKS) as f64 / 2.0));
                cells.push(Cell {
                    at: looks.clone().find(|uv| ground.has(*uv)),
                    ball: ball(ends.map(|uv| ground.point(uv)), BENT),
                });
            }
        }
        let own = &cells[first..];
        let (centre, _) = ball(own.iter().map(|cell| cell.ball.0), 0.0);
        let reach = |cell: &Cell| (cell.ball.0 - centre).norm() + cell.ball.1;
        Self {
            map: Map {
                domain: [(u[0], u[1]), (v[0], v[1])],
                wraps: ground.wraps(),
                poles: ground.poles(),
                spans: width.map(|w| SPAN * w),
            },
            spacing_m: own
                .iter()
                .map(|cell| cell.ball.1)
                .fold(f64::INFINITY, f64::min),
            cells: count,
            first,
            ball: (centre, own.iter().map(reach).fold(0.0, f64::max)),
        }
    }

    fn len(&self) -> usize {
        self.cells[0] * self.cells[1]
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
        let at = [k / self.cells[1], k % self.cells[1]];
        let mut to = [0; 2];
        for d in 0..2 {
            let (x, n) = (at[d] as i64 + step[d], self.cells[d] as i64);
            if !(0..n).contains(&x) && !self.map.wraps[d] {
                return None;
            }
            to[d] = x.rem_euclid(n) as usize;
        }
        Some(to[0] * self.cells[1] + to[1])
    }
}

impl PartDepths {
    /// Makes room for the faces, edges and corners of a part.
    pub fn new(part: &Part) -> Self {
        let mut cells = Vec::new();
        let faces: Vec<FaceCells> = (0..part.faces().len() as u32)
            .map(|k| FaceCells::new(&part.face_ground(k), &mut cells))
            .collect();
        let (corners, of_vertex) = part.corners();
        let places = |edge: u32| {
            let ground = part.edge_ground(edge);
            let count = PLACES
                * if ground.is_line() {
                    1
                } else {
                    ground.segments()
                };
            let at = (0..=count)
                .map(|k| ground.point(ground.segments() as f64 * k as f64 / count as f64));
            EdgePlaces {
                edge,
                count,
                ends: (ground.ends()).map_or([None; 2], |ends| ends.map(|v| of_vertex[v as usize])),
                ball: ball(at, BENT),
            }
        };
        let edges: Vec<EdgePlaces> = part.edges().map(places).collect();
        let most = faces.iter().map(FaceCells::len).max().unwrap_or(0);
        let most_places = edges.iter().map(|edge| edge.count + 1).max().unwrap_or(0);
        let map = faces.first().map_or(
            Map {
                domain: [(0.0, 1.0); 2],
                wraps: [false; 2],
                poles: [[false; 2]; 2],
                spans: [1.0; 2],
            },
            |face| face.map,
        );
        Self {
            tops: Tops::new(map, None, part.size_m(), 0.0),
            seen: vec![false; corners.len()],
            samples: Vec::with_capacity(most.max(most_places)),
            found: Vec::with_capacity(MOST),
            faces,
            cells,
            edges,
            corners,
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
        self.found.clear();
        self.seen.fill(false);
        let may_reach = |(centre, radius_m): &(Point3, f64)| {
            field.may_reach(&(placed.pose() * centre), &Vector3::repeat(*radius_m))
        };
        for k in 0..self.faces.len() {
            if may_reach(&self.faces[k].ball) {
                self.search_face(placed, k, field, margin_m, touched, out);
            }
        }
        for k in 0..self.edges.len() {
            if may_reach(&self.edges[k].ball) {
                self.search_edge(placed, k, field, margin_m, out);
            }
        }
        for k in 0..self.corners.len() {
            let corner = &self.corners[k];
            if !self.seen[k] && may_reach(&(corner.point, 0.0)) {
                self.look_at_corner(placed, k, field, margin_m, out);
            }
        }
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

    fn search_face(
        &mut self,
        placed: &PlacedPart,
        k: usize,
        field: &impl DepthField,
        margin_m: f64,
        touched: bool,
        out: &mut ContactSet,
    ) {
        let Self {
            faces,
            cells,
            samples,
            tops,
            ..
        } = self;
        let face = &faces[k];
        let own = &cells[face.first..face.first + face.len()];
        let ground = Placed {
            face: placed.part().face_ground(k as u32),
            pose: placed.pose(),
        };
        samples.clear();
        samples.extend(own.iter().map(|cell| {
            let (centre, radius_m) = cell.ball;
            let half = Vector3::repeat(radius_m);
            match cell
                .at
                .filter(|_| field.may_reach(&(placed.pose() * centre), &half))
            {
                Some(at) => field.rough(&ground.point(at)).0,
                None => f64::NEG_INFINITY,
            }
        }));
        tops.map = face.map;
        tops.spacing_m = face.spacing_m;
        tops.found.clear();
        tops.starts.clear();
        let mut complete = true;
        for (k, cell) in own.iter().enumerate() {
            let here = samples[k];
            let Some(at) = cell.at.filter(|_| here > f64::NEG_INFINITY) else {
                continue;
            };
            // Of equal cells, the first.
            let highest = (-1..=1)
                .flat_map(|a| (-1..=1).map(move |b| [a, b]))
                .filter_map(|step| face.beside(k, step))
                .all(|other| match other < k {
                    true => here > samples[other],
                    false => here >= samples[other],
                });
            if highest {
                complete &= tops.starts.offer(here, at);
            }
        }
        if !complete {
            out.note_dropped();
        }
        tops.climb_all(true, field, margin_m, &[], &ground);
        // Through the middle of the solid: there, no side is nearest, and none of its edges is in touch.
        let by_sides = touched || !tops.found.is_empty() || !samples.iter().any(|d| *d > 0.0);
        if !by_sides {
            tops.climb_all(false, field, margin_m, &[], &ground);
        }
        tops.finish(by_sides, field, &ground);
        for t in 0..self.tops.found.len() {
            let top = self.tops.found[t];
            // Climbs go on past the edges of a face, where its own tops are those of the edges.
            if self.faces[k].ends_at(top.at) || !ground.face.has(top.at) {
                continue;
            }
            let point = ground.point(top.at);
            self.hold(
                PartTop {
                    place: placed.part().place(k as u32, top.at),
                    point,
                    mark: ToolPoint::Found,
                },
                out,
            );
        }
    }

    fn search_edge(
        &mut self,
        placed: &PlacedPart,
        k: usize,
        field: &impl DepthField,
        margin_m: f64,
        out: &mut ContactSet,
    ) {
        let EdgePlaces {
            edge, count, ends, ..
        } = self.edges[k];
        let along = Along {
            ground: placed.part().edge_ground(edge),
            pose: placed.pose(),
            size_m: self.tops.size_m,
        };
        let last = along.ground.segments() as f64;
        let at = |k: usize| last * k as f64 / count as f64;
        self.samples.clear();
        (self.samples).extend((0..=count).map(|k| field.rough(&along.point(at(k))).0));
        for corner in ends.into_iter().flatten() {
            if !self.seen[corner as usize] {
                self.look_at_corner(placed, corner as usize, field, margin_m, out);
            }
        }
        let mut fixed_m = f64::NEG_INFINITY;
        for place in along.ground.round(ROUND) {
            let depth_m = field.depth_m(&along.point(place));
            fixed_m = fixed_m.max(depth_m);
            if depth_m >= -margin_m && along.is_top(place, depth_m, field) {
                self.hold(along.top(place, ToolPoint::Round), out);
            }
        }
        let closed = ends == [None; 2];
        if !closed {
            for place in [0.0, last] {
                fixed_m = fixed_m.max(field.depth_m(&along.point(place)));
            }
        }
        for k in 0..=count {
            let here = self.samples[k];
            let before = k.checked_sub(1).map(|k| self.samples[k]);
            let after = self.samples.get(k + 1).copied();
            let highest =
                before.is_none_or(|there| here > there) && after.is_none_or(|there| here >= there);
            // A rough depth may be above the true one by the way to the next place.
            if !highest || here < -margin_m - along.step_m(count) {
                continue;
            }
            let (low, high) = (at(k.saturating_sub(1)), at((k + 1).min(count)));
            let place = section(low, high, |place| field.depth_m(&along.point(place)));
            let depth_m = field.depth_m(&along.point(place));
            let by_m = depth_m - fixed_m;
            if by_m > SAME * self.tops.size_m
                && depth_m >= -margin_m
                && along.is_top(place, depth_m, field)
            {
                let mark = match fixed_m.is_finite() {
                    true => ToolPoint::Deepest { by_m },
                    false => ToolPoint::Found,
                };
                self.hold(along.top(place, mark), out);
            }
        }
    }

    fn look_at_corner(
        &mut self,
        placed: &PlacedPart,
        k: usize,
        field: &impl DepthField,
        margin_m: f64,
        out: &mut ContactSet,
    ) {
        self.seen[k] = true;
        let corner = &self.corners[k];
        let point = placed.pose() * corner.point;
        let depth_m = field.depth_m(&point);
        let leads = |step: &Vector3| {
            let beside = placed.pose() * (corner.point + step);
            field.depth_m(&beside) > depth_m + RESTING * step.norm()
        };
        if depth_m >= -margin_m && !corner.beside.iter().any(leads) {
            let place = corner.place;
            self.hold(
                PartTop {
                    place,
                    point,
                    mark: ToolPoint::Corner,
                },
                out,
            );
        }
    }
}

/// An edge where the part stands.
struct Along<'a> {
    ground: EdgeGround<'a>,
    pose: &'a Pose,
    size_m: f64,
}

impl Along<'_> {
    fn point(&self, place: f64) -> Point3 {
        self.pose * self.ground.point(place)
    }

    /// Between two of so many places, m, roughly.
    fn step_m(&self, count: usize) -> f64 {
        let last = self.ground.segments() as f64;
        let at = |k: usize| self.point(last * k as f64 / count as f64);
        let steps = (0..count).map(|k| (at(k + 1) - at(k)).norm());
        steps.fold(0.0, f64::max)
    }

    /// No face beside it leads on deeper.
    fn is_top(&self, place: f64, depth_m: f64, field: &impl DepthField) -> bool {
        let step_m = INTO * self.size_m;
        let point = self.point(place);
        let mut inward = self.ground.inward(place);
        inward.all(|inward| {
            let beside = point + self.pose * inward * step_m;
            field.depth_m(&beside) <= depth_m + RISES * step_m
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

/// The place of the greatest value between two, by golden section.
fn section(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..SECTIONS {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - GOLDEN * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + GOLDEN * (high - low);
            at_b = value(b);
        }
    }
    if at_a > at_b { a } else { b }
}
