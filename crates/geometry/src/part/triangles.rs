//! Triangles of parts: edges divided once in space, faces between those points.
//!
//! ```text
//! edges ──▶ points within the tolerance of the curve, shared by both faces
//! face ──▶ laid out in a plane, in steps of its curvature; cut where it goes round ──▶ constrained Delaunay ──▶ what is inside
//! ```
//! Chords that cross each other in a face's plane, as those of loops close to each other may, are halved and all is done
//! again. Both sides of a cut have the same points, and the boundary of every face is compared with its edges' points at the
//! end, so that faces that do not meet are an error and never a hole.

mod corner;
mod patch;
mod ruler;
mod sheet;
#[cfg(test)]
mod tests;

use super::part::{Edge, Part};
use crate::math::Point3;
use crate::surface::Mesh;
use corner::Id;
pub use corner::TrianglesError;
use patch::{Patch, Problem};
pub use ruler::Fineness;
use sheet::Sheet;
use std::collections::BTreeMap;

/// Halvings of chords that cross, rounds.
const MOST_ROUNDS: usize = 40;
/// Rounds in which a face is given more steps.
const MOST_FINER: usize = 8;
/// Rounds in which all chords of a face are halved.
const MOST_SHAKEN: usize = 4;
/// Steps that a chord may go.
const MOST_STEPS: f64 = 1.5;
/// Of the size: vertices nearer to each other than this are one.
const SAME: f64 = 1e-9;

/// Triangles of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMesh {
    /// Points of edges are shared by their faces; normals are means over the triangles around a point.
    pub mesh: Mesh,
    /// The face of each triangle, as [`Part::faces`] counts them.
    pub faces: Vec<u32>,
    /// Parameters of each point on a B-spline face that has it; `None` where there is none.
    pub places: Vec<Option<[f64; 2]>>,
    /// The farthest that a middle of a triangle or of one of its sides is from the surface, or an edge from its chords, m.
    pub deviation_m: f64,
}

impl Part {
    /// Triangles within a distance (m) of the faces; closed where the part is, and counter-clockwise seen from outside.
    ///
    /// # Errors
    /// A tolerance that is not finite and above 0, more than `most` triangles, faces without bounds, loops that cross.
    pub fn triangles(&self, tolerance_m: f64, most: usize) -> Result<PartMesh, TrianglesError> {
        self.divided(&Fineness {
            tolerance_m,
            most,
            plane_step_m: None,
        })
    }

    /// [`Self::triangles`], with points within planes too if asked for.
    ///
    /// # Errors
    /// As [`Self::triangles`]; a step is refused like a tolerance.
    pub fn divided(&self, fineness: &Fineness) -> Result<PartMesh, TrianglesError> {
        let lengths = [Some(fineness.tolerance_m), fineness.plane_step_m];
        for length in lengths.into_iter().flatten() {
            if !(length.is_finite() && length > 0.0) {
                return Err(TrianglesError::Tolerance(length));
            }
        }
        let mut work = Work::new(self, fineness)?;
        for _ in 0..MOST_ROUNDS {
            work.divide_edges()?;
            if work.divide_faces()? {
                return work.assembled();
            }
        }
        Err(TrianglesError::Loops {
            face: work.first_open(),
        })
    }
}

/// An edge's points.
#[derive(Clone, Debug, Default)]
struct Division {
    /// Places that count segments, ascending.
    places: Vec<f64>,
    points: Vec<Point3>,
}

struct Work<'a> {
    part: &'a Part,
    fineness: Fineness,
    /// Of each vertex: the one at its place.
    same: Vec<u32>,
    divisions: Vec<Division>,
    sheets: Vec<Sheet<'a>>,
    patches: Vec<Option<Patch>>,
    finer: Vec<(usize, f64)>,
    shaken: Vec<usize>,
}

impl<'a> Work<'a> {
    fn new(part: &'a Part, fineness: &Fineness) -> Result<Self, TrianglesError> {
        let mut uses = vec![Vec::new(); part.faces.len()];
        for (e, edge) in part.edges.iter().enumerate() {
            for (side, at) in edge.sides.iter().enumerate() {
                uses[at.face as usize].push((e as u32, side));
            }
        }
        let sheets = uses.into_iter().enumerate();
        let same = same_places(part);
        let sheets = sheets.map(|(f, uses)| Sheet::new(part, f, uses, &same, fineness));
        let sheets = sheets.collect::<Result<Vec<_>, _>>()?;
        let mut work = Self {
            part,
            fineness: *fineness,
            same,
            divisions: vec![Division::default(); part.edges.len()],
            patches: vec![None; part.faces.len()],
            finer: vec![(0, 1.0); part.faces.len()],
            shaken: vec![0; part.faces.len()],
            sheets,
        };
        work.start();
        Ok(work)
    }

    /// Ends, thirds of closed edges, and where cuts cross.
    fn start(&mut self) {
        for (e, edge) in self.part.edges.iter().enumerate() {
            if edge.sides.is_empty() {
                continue;
            }
            let last = edge.curve.segments() as f64;
            let mut places = vec![0.0, last];
            if self.same[edge.ends[0] as usize] == self.same[edge.ends[1] as usize] {
                places.extend([1.0, 2.0].map(|k| split_at(edge, 0.0, last, k / 3.0)));
            }
            for (side, at) in edge.sides.iter().enumerate() {
                let sheet = &self.sheets[at.face as usize];
                places.extend(sheet.crossings(self.part, (e as u32, side)));
            }
            places.sort_unstable_by(f64::total_cmp);
            let mut kept: Vec<f64> = Vec::with_capacity(places.len());
            for place in places {
                if kept.last().is_none_or(|k| place - k > 1e-9) {
                    kept.push(place);
                }
            }
            // An end is what it is.
            if let Some(end) = kept.last_mut() {
                *end = last;
            }
            self.divisions[e].places = kept;
        }
    }

    /// Halves chords until all are near their curves and go no farther than steps allow.
    fn divide_edges(&mut self) -> Result<(), TrianglesError> {
        let mut total = 0;
        for e in 0..self.part.edges.len() {
            let edge = &self.part.edges[e];
            let before = self.divisions[e].points.len();
            let old = std::mem::take(&mut self.divisions[e].places);
            let mut places: Vec<f64> = old.first().copied().into_iter().collect();
            for pair in old.windows(2) {
                let mut ahead = vec![pair[1]];
                while let (Some(&b), Some(&a)) = (ahead.last(), places.last()) {
                    let room = b - a > 1e-9 * (1.0 + b);
                    if room && self.is_long(e as u32, a, b) {
                        ahead.push(split_at(edge, a, b, 0.5));
                    } else {
                        places.push(b);
                        ahead.pop();
                    }
                    if total + places.len() > self.fineness.most {
                        return Err(TrianglesError::TooMany {
                            most: self.fineness.most,
                        });
                    }
                }
            }
            total += places.len();
            if places.len() != before {
                for side in &edge.sides {
                    self.patches[side.face as usize] = None;
                }
                let last = places.len().saturating_sub(1);
                let point = |(k, &g): (usize, &f64)| match k {
                    0 => self.part.vertices[self.same[edge.ends[0] as usize] as usize].point,
                    _ if k == last => {
                        self.part.vertices[self.same[edge.ends[1] as usize] as usize].point
                    }
                    _ => sheet::point_at(edge, g),
                };
                self.divisions[e].points = places.iter().enumerate().map(point).collect();
            }
            self.divisions[e].places = places;
        }
        Ok(())
    }

    /// Whether a chord is too far from its curve, or goes too many steps on a face.
    fn is_long(&self, e: u32, a: f64, b: f64) -> bool {
        let edge = &self.part.edges[e as usize];
        if chord_off(edge, a, b) > self.fineness.tolerance_m {
            return true;
        }
        let ends = [a, b].map(|g| sheet::point_at(edge, g));
        edge.sides.iter().enumerate().any(|(side, at)| {
            let sheet = &self.sheets[at.face as usize];
            let uv = [a, b].map(|g| sheet.raw(self.part, (e, side), g));
            sheet.steps(uv, [&ends[0], &ends[1]]) > MOST_STEPS
        })
    }

    /// Divides the faces that are not; `true` when all are as they shall be.
    fn divide_faces(&mut self) -> Result<bool, TrianglesError> {
        let mut good = true;
        let mut halve: Vec<(u32, usize)> = Vec::new();
        for f in 0..self.sheets.len() {
            if self.patches[f].is_some() {
                continue;
            }
            match patch::divide(self, f) {
                Ok(patch) => {
                    let sheet = &self.sheets[f];
                    let gap_m = sheet.uses.iter().fold(0.0f64, |gap, &(e, _)| {
                        gap.max(self.part.edges[e as usize].gap_m)
                    });
                    let allowed = self.fineness.tolerance_m + 2.0 * gap_m;
                    let (count, finer) = self.finer[f];
                    if patch.off_m > allowed && count < MOST_FINER {
                        let more = (patch.off_m / allowed).sqrt().clamp(1.1, 2.0);
                        self.finer[f] = (count + 1, finer * more);
                        self.sheets[f].lay_out(self.part, &self.fineness, finer * more);
                        good = false;
                    } else {
                        self.patches[f] = Some(patch);
                    }
                }
                Err(Problem::Crossed(chords)) => {
                    halve.extend(chords);
                    good = false;
                }
                Err(Problem::Astray) => {
                    self.shaken[f] += 1;
                    if self.shaken[f] > MOST_SHAKEN || self.sheets[f].uses.is_empty() {
                        let face = self.sheets[f].face.id;
                        return Err(TrianglesError::Loops { face });
                    }
                    for &(e, _) in &self.sheets[f].uses {
                        let count = self.divisions[e as usize].places.len() - 1;
                        halve.extend((0..count).map(|k| (e, k)));
                    }
                    good = false;
                }
                Err(Problem::Error(error)) => return Err(error),
            }
        }
        halve.sort_unstable();
        halve.dedup();
        // From behind, so that the numbers before it stay.
        for &(e, k) in halve.iter().rev() {
            let edge = &self.part.edges[e as usize];
            let places = &mut self.divisions[e as usize].places;
            let middle = split_at(edge, places[k], places[k + 1], 0.5);
            if middle > places[k] && middle < places[k + 1] {
                places.insert(k + 1, middle);
            }
        }
        let triangles = self.patches.iter().flatten().map(|p| p.triangles.len());
        if triangles.sum::<usize>() > self.fineness.most {
            return Err(TrianglesError::TooMany {
                most: self.fineness.most,
            });
        }
        Ok(good)
    }

    fn first_open(&self) -> u64 {
        let open = self.patches.iter().position(Option::is_none);
        self.sheets[open.unwrap_or(0)].face.id
    }

    /// What a place of an edge's division is.
    fn id(&self, e: u32, k: usize) -> Id {
        let edge = &self.part.edges[e as usize];
        match k {
            0 => Id::Vertex(self.same[edge.ends[0] as usize]),
            _ if k + 1 == self.divisions[e as usize].places.len() => {
                Id::Vertex(self.same[edge.ends[1] as usize])
            }
            _ => Id::Edge(e, k as u32),
        }
    }

    /// One mesh of all faces.
    fn assembled(&self) -> Result<PartMesh, TrianglesError> {
        let mut points: Vec<Point3> = Vec::new();
        let mut places: Vec<Option<[f64; 2]>> = Vec::new();
        let mut shared: BTreeMap<Id, u32> = BTreeMap::new();
        let mut triangles = Vec::new();
        let mut faces = Vec::new();
        let mut deviation_m = 0.0f64;
        for (f, patch) in self.patches.iter().enumerate() {
            let Some(patch) = patch else { continue };
            deviation_m = deviation_m.max(patch.off_m);
            let mut own: BTreeMap<Id, u32> = BTreeMap::new();
            for ids in &patch.triangles {
                let corners = ids.map(|id| {
                    let known = match id {
                        Id::Vertex(_) | Id::Edge(..) => &mut shared,
                        Id::Pole(_) | Id::Inner(_) => &mut own,
                    };
                    let k = *known.entry(id).or_insert_with(|| {
                        points.push(self.point(f, id, patch));
                        places.push(None);
                        points.len() as u32 - 1
                    });
                    let place = &mut places[k as usize];
                    *place = place.or_else(|| patch.places.get(&id).copied());
                    k
                });
                triangles.push(corners);
                faces.push(f as u32);
            }
        }
        for (edge, division) in self.part.edges.iter().zip(&self.divisions) {
            for pair in division.places.windows(2) {
                deviation_m = deviation_m.max(chord_off(edge, pair[0], pair[1]));
            }
        }
        let mesh = Mesh::from_triangles(points, triangles).ok_or(TrianglesError::Range)?;
        Ok(PartMesh {
            mesh,
            faces,
            places,
            deviation_m,
        })
    }

    fn point(&self, f: usize, id: Id, patch: &Patch) -> Point3 {
        match id {
            Id::Vertex(v) => self.part.vertices[v as usize].point,
            Id::Edge(e, k) => self.divisions[e as usize].points[k as usize],
            Id::Inner(k) => patch.inner[k as usize],
            Id::Pole(k) => self.sheets[f].poles[k as usize].3,
        }
    }
}

/// The farthest that an edge is from a chord, m, at a few places.
fn chord_off(edge: &Edge, a: f64, b: f64) -> f64 {
    if edge.curve.is_line() {
        return 0.0;
    }
    let ends = [a, b].map(|g| sheet::point_at(edge, g));
    let count = (4.0 * (b - a)).ceil().clamp(4.0, 4096.0) as usize;
    (1..count).fold(0.0f64, |off, k| {
        let g = a + (b - a) * k as f64 / count as f64;
        off.max(ruler::off_chord(
            &sheet::point_at(edge, g),
            [&ends[0], &ends[1]],
        ))
    })
}

/// A place between two others, at a joint of segments where several lie between.
fn split_at(edge: &Edge, a: f64, b: f64, share: f64) -> f64 {
    let place = a + (b - a) * share;
    let joint = place.round();
    let may = edge.curve.segments() > 1 && b - a > 1.0 && joint > a && joint < b;
    if may { joint } else { place }
}

/// Of each vertex, the first one that is at its place.
fn same_places(part: &Part) -> Vec<u32> {
    let close = SAME * part.size_m();
    let at = |v: u32| part.vertices[v as usize].point;
    let mut order: Vec<u32> = (0..part.vertices.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| at(a).x.total_cmp(&at(b).x).then(a.cmp(&b)));
    let mut same: Vec<u32> = (0..order.len() as u32).collect();
    for (k, &a) in order.iter().enumerate() {
        if same[a as usize] != a {
            continue;
        }
        for &b in order[k + 1..]
            .iter()
            .take_while(|&&b| at(b).x - at(a).x <= close)
        {
            if same[b as usize] == b && (at(b) - at(a)).norm() <= close {
                same[b as usize] = a;
            }
        }
    }
    same
}
