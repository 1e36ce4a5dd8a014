//! One face's triangles: its edges' points and points within, in the plane.

use super::super::carrier::Carrier;
use super::corner::{Id, TrianglesError};
use super::sheet::{Layout, Sheet};
use super::{Work, ruler};
use crate::math::{Point3, Vector3};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::BTreeMap;

/// In steps: how near to a chord no point within may be.
const CLEAR: f64 = 0.4;
/// In steps: corners of one vertex that are one place of the plane.
const ONE_PLACE: f64 = 0.05;
/// Coordinates below are 0.
const LEAST: f64 = 1e-30;
/// Chords that cross which are looked at in one round.
const MOST_CROSSED: usize = 200;

/// A face's triangles.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub triangles: Vec<[Id; 3]>,
    /// Points of its own.
    pub inner: Vec<Point3>,
    /// Parameters of its corners, on B-splines.
    pub places: BTreeMap<Id, [f64; 2]>,
    /// The farthest from the surface, m.
    pub off_m: f64,
}

/// Why there are none yet.
#[derive(Clone, Debug)]
pub(super) enum Problem {
    /// Chords that cross others: edge and number.
    Crossed(Vec<(u32, usize)>),
    /// What is inside does not end at its edges.
    Astray,
    Error(TrianglesError),
}

#[derive(Clone, Copy, Debug)]
struct Corner {
    id: Id,
    uv: [f64; 2],
    at: [f64; 2],
    point: Point3,
}

struct Sketch<'a> {
    sheet: &'a Sheet<'a>,
    corners: Vec<Corner>,
    known: BTreeMap<Id, Vec<usize>>,
    /// Corners of each chord, its edge and number.
    chords: Vec<([usize; 2], (u32, usize))>,
    inner: Vec<Point3>,
    /// A plane without points within.
    bare: bool,
    taken: Taken,
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Triangles of a face with its edges' points.
pub(super) fn divide(work: &Work<'_>, f: usize) -> Result<Patch, Problem> {
    let sheet = &work.sheets[f];
    let mut sketch = Sketch {
        sheet,
        corners: Vec::new(),
        known: BTreeMap::new(),
        chords: Vec::new(),
        inner: Vec::new(),
        bare: matches!(sheet.face.carrier, Carrier::Plane(_))
            && work.fineness.plane_step_m.is_none(),
        taken: Taken::default(),
    };
    let mut boundary = Vec::new();
    for &user in &sheet.uses {
        boundary.extend(sketch.add_edge(work, user));
    }
    sketch.clear();
    match &sheet.layout {
        Layout::Flat(_) => sketch.fill_flat(work.fineness.most)?,
        Layout::Ball(..) => sketch.fill_ball(work.fineness.most)?,
    }
    let (cdt, numbers) = sketch.triangulated()?;
    let kept = sketch.inside(&cdt, &numbers);
    let mut triangles = Vec::with_capacity(kept.len());
    let mut off_m = 0.0f64;
    for corners in &kept {
        let ids = corners.map(|c| sketch.corners[c].id);
        if ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0] {
            off_m = off_m.max(sketch.off_m(corners));
            let turned = [ids[0], ids[2], ids[1]];
            triangles.push(if sheet.face.same_sense { ids } else { turned });
        }
    }
    let open_sheet = sheet.face.loops == 0;
    if triangles.is_empty() || !ends_at(&triangles, boundary) && !open_sheet {
        return Err(Problem::Astray);
    }
    let places = match &sheet.face.carrier {
        Carrier::Spline(_) => (kept.iter().flatten())
            .map(|&c| (sketch.corners[c].id, sheet.confined(sketch.corners[c].uv)))
            .collect(),
        _ => BTreeMap::new(),
    };
    Ok(Patch {
        triangles,
        places,
        inner: sketch.inner,
        off_m,
    })
}

/// Whether the sides that two triangles do not share are the given ones.
fn ends_at(triangles: &[[Id; 3]], mut boundary: Vec<[Id; 2]>) -> bool {
    let mut sides: Vec<([Id; 2], i32)> = Vec::with_capacity(3 * triangles.len());
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            sides.push(if a < b { ([a, b], 1) } else { ([b, a], -1) });
        }
    }
    sides.sort_unstable();
    let mut open = Vec::new();
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        match same.iter().map(|s| s.1).sum::<i32>() {
            0 if same.len() == 2 => {}
            1 | -1 if same.len() == 1 => open.push(same[0].0),
            _ => return false,
        }
    }
    boundary.iter_mut().for_each(|side| side.sort_unstable());
    boundary.sort_unstable();
    open == boundary
}

impl Sketch<'_> {
    /// An edge's points and chords; the ids of their ends.
    fn add_edge(&mut self, work: &Work<'_>, user: (u32, usize)) -> Vec<[Id; 2]> {
        let e = user.0;
        let division = &work.divisions[e as usize];
        let raw: Vec<[f64; 2]> = division
            .places
            .iter()
            .map(|&g| self.sheet.raw(work.part, user, g))
            .collect();
        let mut out = Vec::with_capacity(raw.len());
        for (k, pair) in division.places.windows(2).enumerate() {
            let ids = [work.id(e, k), work.id(e, k + 1)];
            let points = [division.points[k], division.points[k + 1]];
            let middle = self.sheet.raw(work.part, user, 0.5 * (pair[0] + pair[1]));
            let (ends, along_cut) = self.in_strip([raw[k], raw[k + 1]], middle);
            let corners: [usize; 2] =
                std::array::from_fn(|i| self.add_all(ids[i], ends[i], points[i]));
            if !along_cut {
                self.chords.push((corners, (e, k)));
            }
            out.push(ids);
        }
        out
    }

    /// The ends of a chord on the side of cuts on which its middle is, and whether it goes along one.
    fn in_strip(&self, ends: [[f64; 2]; 2], middle: [f64; 2]) -> ([[f64; 2]; 2], bool) {
        let Layout::Flat(rulers) = &self.sheet.layout else {
            return (ends, false);
        };
        let mut out = ends;
        let mut along = false;
        for (d, ruler) in rulers.iter().enumerate() {
            let base = ruler.within(middle[d]);
            for (to, from) in out.iter_mut().zip(ends) {
                to[d] = ruler.near(from[d], base);
            }
            along |= ruler.is_end(out[0][d])
                && out[0][d] == out[1][d]
                && ruler.is_end(ruler.near(base, base));
        }
        (out, along)
    }

    fn at(&self, uv: [f64; 2], point: &Point3) -> [f64; 2] {
        let place = match (&self.sheet.layout, self.sheet.face.carrier.axes()) {
            (Layout::Flat([u, v]), _) => [u.mark(uv[0]), v.mark(uv[1])],
            (Layout::Ball(plane, _), Some(axes)) => plane.place(&axes.to_local(point).normalize()),
            (Layout::Ball(..), None) => [f64::NAN; 2],
        };
        place.map(|x| if x.abs() < LEAST { 0.0 } else { x })
    }

    /// A corner, and its copies on other sides of cuts.
    fn add_all(&mut self, id: Id, uv: [f64; 2], point: Point3) -> usize {
        if let Layout::Flat(rulers) = &self.sheet.layout {
            let others: [Vec<f64>; 2] = std::array::from_fn(|d| match rulers[d].is_end(uv[d]) {
                true => vec![rulers[d].low(), rulers[d].high()],
                false => vec![uv[d]],
            });
            for &u in &others[0] {
                for &v in &others[1] {
                    self.add(id, [u, v], point);
                }
            }
        }
        self.add(id, uv, point)
    }

    fn add(&mut self, id: Id, uv: [f64; 2], point: Point3) -> usize {
        let at = self.at(uv, &point);
        let may_repeat = match &self.sheet.layout {
            Layout::Flat(rulers) => {
                !self.sheet.poles.is_empty() || rulers.iter().any(|r| r.period > 0.0)
            }
            Layout::Ball(..) => false,
        };
        let corners = &mut self.corners;
        let list = self.known.entry(id).or_default();
        let known = list.iter().copied().find(|&c| {
            let other: [f64; 2] = corners[c].at;
            !may_repeat || (0..2).all(|d| (other[d] - at[d]).abs() <= ONE_PLACE)
        });
        known.unwrap_or_else(|| {
            list.push(corners.len());
            corners.push(Corner { id, uv, at, point });
            corners.len() - 1
        })
    }

    /// A corner's place where distances are in steps.
    fn metric(&self, at: [f64; 2], point: &Point3) -> [f64; 3] {
        match (&self.sheet.layout, &self.sheet.face.carrier) {
            (Layout::Ball(_, step), Carrier::Sphere { axes, radius_m }) => {
                (axes.to_local(point) / (step * radius_m)).into()
            }
            _ => [at[0], at[1], 0.0],
        }
    }

    /// Enters chords and corners as what points within keep clear of.
    fn clear(&mut self) {
        if self.bare {
            return;
        }
        let mut places = Vec::new();
        for corner in &self.corners {
            places.push(self.metric(corner.at, &corner.point));
        }
        for ([a, b], _) in &self.chords {
            let [a, b] = [a, b].map(|&c| {
                let corner = &self.corners[c];
                self.metric(corner.at, &corner.point)
            });
            let far = (0..3).map(|k| (b[k] - a[k]).abs()).fold(0.0, f64::max);
            let count = (far / (0.5 * CLEAR)).ceil().min(1e4) as usize;
            for i in 1..count {
                let t = i as f64 / count as f64;
                places.push(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t));
            }
        }
        self.taken = Taken::new(places);
    }

    fn add_inner(&mut self, uv: [f64; 2], point: Point3) -> usize {
        let id = Id::Inner(self.inner.len() as u32);
        self.inner.push(point);
        self.add_all(id, uv, point)
    }

    /// Points at whole steps, on cuts and poles too.
    fn fill_flat(&mut self, most: usize) -> Result<(), Problem> {
        let sheet = self.sheet;
        let (Layout::Flat(rulers), false) = (&sheet.layout, self.bare) else {
            return Ok(());
        };
        let counts = [0, 1].map(|d| rulers[d].steps());
        let grid = (counts[0] + 1.0) * (counts[1] + 1.0);
        if grid.is_nan() || grid > 4.0 * most as f64 + 1e4 {
            return Err(Problem::Error(TrianglesError::TooMany { most }));
        }
        let last = counts.map(|c| c.round() as usize);
        for i in 0..=last[0] {
            for j in 0..=last[1] {
                let grid = [i, j];
                let uv: [f64; 2] = std::array::from_fn(|d| match grid[d] {
                    0 => rulers[d].low(),
                    k if k == last[d] => rulers[d].high(),
                    k => rulers[d].parameter(k as f64),
                });
                let pole = sheet.poles.iter().find(|pole| uv[pole.0] == pole.1);
                if let Some(&(_, _, id, point)) = pole {
                    if sheet.face.trim.contains(uv) {
                        self.add(id, uv, point);
                    }
                    continue;
                }
                let ends = |d: usize| grid[d] == 0 || grid[d] == last[d];
                let cut = [0, 1].map(|d| rulers[d].period > 0.0);
                let copy = (0..2).any(|d| cut[d] && grid[d] == last[d]);
                let border = (0..2).any(|d| !cut[d] && ends(d));
                if copy || border && sheet.face.loops > 0 || !sheet.face.trim.contains(uv) {
                    continue;
                }
                let twins = [0, 1].map(|d| match cut[d] && grid[d] == 0 {
                    true => vec![0.0, counts[d]],
                    false => vec![grid[d] as f64],
                });
                let free = twins[0]
                    .iter()
                    .all(|&x| twins[1].iter().all(|&y| self.taken.is_free([x, y, 0.0])));
                if free {
                    let carrier = &sheet.face.carrier;
                    self.add_inner(uv, carrier.point(sheet.confined(uv)));
                }
            }
        }
        Ok(())
    }

    fn fill_ball(&mut self, most: usize) -> Result<(), Problem> {
        let Layout::Ball(_, step) = self.sheet.layout else {
            return Ok(());
        };
        let Some(lattice) = ruler::lattice(&self.sheet.range, step, most) else {
            return Err(Problem::Error(TrianglesError::TooMany { most }));
        };
        for uv in lattice {
            let point = self.sheet.face.carrier.point(uv);
            let metric = self.metric([0.0; 2], &point);
            if self.sheet.face.trim.contains(uv) && self.taken.is_free(metric) {
                self.add_inner(uv, point);
            }
        }
        Ok(())
    }

    /// The centre from which a whole sphere is seen: its first point, which is no place of the plane.
    fn is_apart(&self, corner: usize) -> bool {
        let whole = self.sheet.face.loops == 0;
        whole && corner == 0 && matches!(self.sheet.layout, Layout::Ball(..))
    }

    /// All corners with the chords as constraints, and the corner of each vertex.
    fn triangulated(&self) -> Result<(Cdt, Vec<usize>), Problem> {
        let mut cdt = Cdt::new();
        let mut numbers: Vec<usize> = Vec::with_capacity(self.corners.len());
        let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; self.corners.len()];
        for (c, corner) in self.corners.iter().enumerate() {
            if self.is_apart(c) {
                continue;
            }
            let place = Point2::new(corner.at[0], corner.at[1]);
            let Ok(handle) = cdt.insert(place) else {
                return Err(Problem::Error(TrianglesError::Range));
            };
            if handle.index() < numbers.len() {
                let other = &self.corners[numbers[handle.index()]];
                if other.id != corner.id && !matches!(corner.id, Id::Inner(_)) {
                    return Err(Problem::Astray);
                }
            } else {
                numbers.push(c);
            }
            handles[c] = Some(handle);
        }
        let mut crossed = Vec::new();
        for (n, ([a, b], name)) in self.chords.iter().enumerate() {
            let (Some(from), Some(to)) = (handles[*a], handles[*b]) else {
                return Err(Problem::Astray);
            };
            if from == to {
                return Err(Problem::Astray);
            }
            let good = !cdt.exists_constraint(from, to)
                && cdt.can_add_constraint(from, to)
                && cdt.try_add_constraint(from, to).len() == 1;
            if !good {
                crossed.push(*name);
                crossed.extend(self.crossing(n));
                if crossed.len() > MOST_CROSSED {
                    break;
                }
            }
        }
        match crossed.is_empty() {
            true => Ok((cdt, numbers)),
            false => Err(Problem::Crossed(crossed)),
        }
    }

    /// The chords that one crosses.
    fn crossing(&self, n: usize) -> impl Iterator<Item = (u32, usize)> + '_ {
        let ends = |n: usize| self.chords[n].0.map(|c| self.corners[c].at);
        let [a, b] = ends(n);
        let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        (0..self.chords.len())
            .filter(move |&m| m != n)
            .filter_map(move |m| {
                let [c, d] = ends(m);
                let apart =
                    side(a, b, c) * side(a, b, d) > 0.0 || side(c, d, a) * side(c, d, b) > 0.0;
                let neighbours = self.chords[n]
                    .0
                    .iter()
                    .any(|c| self.chords[m].0.contains(c));
                let box_apart = (0..2)
                    .any(|k| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]));
                let same = self.chords[n]
                    .0
                    .iter()
                    .all(|c| self.chords[m].0.contains(c));
                (same || !apart && !neighbours && !box_apart).then_some(self.chords[m].1)
            })
    }

    /// The triangles of the face: on one side of the chords, that of most of the places that are inside.
    fn inside(&self, cdt: &Cdt, numbers: &[usize]) -> Vec<[usize; 3]> {
        let mut odd: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
        let mut faces = Vec::with_capacity(cdt.num_inner_faces());
        let mut votes = 0.0;
        let first = cdt.inner_faces().next();
        let mut waiting: Vec<_> = first.into_iter().map(|face| (face, false)).collect();
        while let Some((face, is_odd)) = waiting.pop() {
            if odd[face.fix().index()].is_some() {
                continue;
            }
            odd[face.fix().index()] = Some(is_odd);
            let corners = face.vertices().map(|v| numbers[v.fix().index()]);
            let vote = self.vote(&corners);
            votes += if is_odd { -vote } else { vote };
            faces.push((corners, is_odd));
            for edge in face.adjacent_edges() {
                if let Some(next) = edge.rev().face().as_inner() {
                    waiting.push((next, is_odd != edge.is_constraint_edge()));
                }
            }
        }
        let outside = votes < 0.0;
        let kept = faces.into_iter().filter(|(_, is_odd)| *is_odd == outside);
        let mut out: Vec<[usize; 3]> = kept.map(|(corners, _)| corners).collect();
        if !self.corners.is_empty() && self.is_apart(0) {
            out.extend(cdt.convex_hull().map(|edge| {
                let [a, b] = edge.vertices().map(|v| numbers[v.fix().index()]);
                [a, b, 0]
            }));
        }
        out
    }

    /// A triangle's area in the plane, negative where its middle is no place of the face.
    fn vote(&self, corners: &[usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|c| self.corners[c].at);
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        let face = self.sheet.face;
        let middle = self.middle(corners);
        let uv = match &self.sheet.layout {
            Layout::Flat([u, v]) => {
                let mean = |k: usize| (a[k] + b[k] + c[k]) / 3.0;
                Some([u.parameter(mean(0)), v.parameter(mean(1))])
            }
            Layout::Ball(..) => face.carrier.foot(&middle),
        };
        let area = match &self.sheet.layout {
            Layout::Flat(_) => area,
            Layout::Ball(..) => {
                let [a, b, c] = corners.map(|c| self.corners[c].point);
                (b - a).cross(&(c - a)).norm()
            }
        };
        match uv.is_some_and(|uv| face.trim.contains(uv)) {
            true => area,
            false => -area,
        }
    }

    fn middle(&self, corners: &[usize; 3]) -> Point3 {
        let sum: Vector3 = corners.iter().map(|&c| self.corners[c].point.coords).sum();
        Point3::from(sum / 3.0)
    }

    /// The farthest that the middles of a triangle and of its sides are from the surface, m.
    fn off_m(&self, corners: &[usize; 3]) -> f64 {
        if let Carrier::Plane(_) = self.sheet.face.carrier {
            return 0.0;
        }
        let [a, b, c] = corners.map(|c| self.corners[c]);
        let mean = |k: usize| (a.uv[k] + b.uv[k] + c.uv[k]) / 3.0;
        let mut off = self.sheet.off_m(&self.middle(corners), [mean(0), mean(1)]);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let uv = [0, 1].map(|k| 0.5 * (p.uv[k] + q.uv[k]));
            let middle = nalgebra::center(&p.point, &q.point);
            off = off.max(self.sheet.off_m(&middle, uv));
        }
        off
    }
}

/// Places in cells as wide as what is kept clear.
#[derive(Clone, Debug, Default)]
struct Taken {
    /// Ascending by cell.
    places: Vec<([i64; 3], [f64; 3])>,
}

impl Taken {
    fn new(places: Vec<[f64; 3]>) -> Self {
        let mut places: Vec<_> = places.into_iter().map(|p| (cell(p), p)).collect();
        places.sort_unstable_by_key(|place: &([i64; 3], [f64; 3])| place.0);
        Self { places }
    }

    fn is_free(&self, p: [f64; 3]) -> bool {
        let [x, y, z] = cell(p);
        for i in -1..=1 {
            for j in -1..=1 {
                // Cells of one row follow each other.
                let [low, high] = [-1, 1].map(|k| [x + i, y + j, z + k]);
                let from = self.places.partition_point(|(c, _)| *c < low);
                let near = self.places[from..].iter().take_while(|(c, _)| *c <= high);
                for (_, q) in near {
                    let squared: f64 = (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum();
                    if squared < CLEAR * CLEAR {
                        return false;
                    }
                }
            }
        }
        true
    }
}

fn cell(p: [f64; 3]) -> [i64; 3] {
    p.map(|x| (x / CLEAR).floor().clamp(-1e15, 1e15) as i64)
}
