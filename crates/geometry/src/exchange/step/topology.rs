//! Solids and shells: faces with their bounds, edges and vertices, each read once. ISO 10303-42, §5.

use super::StepError;
use super::carriers::{self, Rim};
use super::curves;
use super::entity::{Entity, File};
use super::pick::PartLeftOut;
use super::units::Context;
use crate::math::{Point3, Vector3, direction_of};
use crate::part::{Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell};
use std::collections::BTreeMap;

/// Ends that should meet may be apart by this part of their loop's size, or by twice the file's uncertainty.
const SAME_VERTEX: f64 = 1e-3;

/// Items of a representation that are read.
pub(super) const SOLIDS: [&str; 7] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
];

/// Reads one of [`SOLIDS`]. What cannot be read is an error, or left out.
pub(super) fn read(
    file: &File<'_, '_>,
    id: u64,
    from: u64,
    context: &Context,
    partial: bool,
    left_out: &mut PartLeftOut,
) -> Result<Brep, StepError> {
    let mut reader = Reader {
        file,
        context,
        partial,
        left_out,
        brep: Brep {
            uncertainty_m: context.uncertainty_m,
            ..Brep::default()
        },
        vertices: BTreeMap::new(),
        vertex_ids: Vec::new(),
        edges: BTreeMap::new(),
        straight: BTreeMap::new(),
        welds: Vec::new(),
    };
    let entity = file.entity(id, from)?;
    match entity.kind() {
        "MANIFOLD_SOLID_BREP" | "FACETED_BREP" => {
            reader.shell(entity.reference(1)?, id, Some(0))?;
        }
        "BREP_WITH_VOIDS" => {
            reader.shell(entity.reference(1)?, id, Some(0))?;
            for void in entity.references(2)? {
                reader.shell(void, id, Some(0))?;
            }
        }
        "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
            for shell in entity.references(1)? {
                reader.shell(shell, id, None)?;
            }
        }
        "CLOSED_SHELL" | "OPEN_SHELL" => reader.shell(id, from, None)?,
        _ => return Err(entity.other("a solid or a model of shells")),
    }
    reader.weld();
    Ok(reader.brep)
}

struct Reader<'f, 'a, 'b> {
    file: &'f File<'a, 'b>,
    context: &'f Context,
    partial: bool,
    left_out: &'f mut PartLeftOut,
    brep: Brep,
    /// `VERTEX_POINT`, or `CARTESIAN_POINT` of polygons, to index.
    vertices: BTreeMap<u64, u32>,
    vertex_ids: Vec<u64>,
    edges: BTreeMap<u64, u32>,
    /// Sides of polygons by their vertices, the lesser first.
    straight: BTreeMap<[u32; 2], u32>,
    /// Vertices that are one.
    welds: Vec<[u32; 2]>,
}

impl Reader<'_, '_, '_> {
    fn shell(&mut self, id: u64, from: u64, solid: Option<u32>) -> Result<(), StepError> {
        let mut entity = self.file.entity(id, from)?;
        let mut reversed = false;
        if matches!(
            entity.kind(),
            "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL"
        ) {
            reversed = !entity.flag(3)?;
            entity = self.file.entity(entity.reference(2)?, id)?;
        }
        let closed = match entity.kind() {
            "CLOSED_SHELL" => true,
            "OPEN_SHELL" | "CONNECTED_FACE_SET" => false,
            _ => return Err(entity.other("a CLOSED_SHELL or OPEN_SHELL")),
        };
        if solid.is_some() && !closed {
            self.left_out.open_solids += 1;
        }
        let mut faces = Vec::new();
        for face in entity.references(1)? {
            let mark = self.mark();
            match self.face(face, entity.id, reversed) {
                Ok(face) => {
                    faces.push(self.brep.faces.len() as u32);
                    self.brep.faces.push(face);
                }
                Err(error) if self.partial && !matches!(error, StepError::TooOften { .. }) => {
                    self.back_to(mark);
                    let name = self.surface_name(face);
                    self.left_out.face(name, &error);
                }
                Err(error) => return Err(error),
            }
        }
        self.brep.shells.push(BrepShell {
            faces,
            closed,
            solid: solid.filter(|_| closed),
        });
        Ok(())
    }

    /// The entity that a face lies on, for the list of what is left out.
    fn surface_name(&self, face: u64) -> String {
        let face = self.file.entity(face, face);
        let on = face.and_then(|face| face.reference(2));
        on.map_or_else(|_| "a face", |on| self.file.name(on))
            .to_owned()
    }

    fn mark(&self) -> [usize; 3] {
        [
            self.brep.vertices.len(),
            self.brep.edges.len(),
            self.welds.len(),
        ]
    }

    /// Forgets what was read since.
    fn back_to(&mut self, [vertices, edges, welds]: [usize; 3]) {
        for id in self.vertex_ids.drain(vertices..) {
            self.vertices.remove(&id);
        }
        for edge in self.brep.edges.drain(edges..) {
            self.edges.remove(&edge.id);
            self.straight.remove(&pair(edge.ends));
        }
        self.brep.vertices.truncate(vertices);
        self.welds.truncate(welds);
    }

    fn face(&mut self, id: u64, from: u64, reversed: bool) -> Result<BrepFace, StepError> {
        let mut reversed = reversed;
        let mut entity = self.file.entity(id, from)?;
        if entity.kind() == "ORIENTED_FACE" {
            reversed ^= !entity.flag(3)?;
            entity = self.file.entity(entity.reference(2)?, id)?;
        }
        if !matches!(entity.kind(), "ADVANCED_FACE" | "FACE_SURFACE") {
            return Err(entity.unreadable("faces need a surface: ADVANCED_FACE or FACE_SURFACE"));
        }
        let mut bounds = Vec::new();
        for bound in entity.references(1)? {
            bounds.push(self.bound(bound, entity.id, reversed)?);
        }
        let rim = Rim {
            brep: &self.brep,
            bounds: &bounds,
        };
        let on = entity.reference(2)?;
        let found = carriers::read(self.file, on, entity.id, self.context, &rim)?;
        Ok(BrepFace {
            id: entity.id,
            carrier: found.carrier,
            same_sense: entity.flag(3)? ^ found.turned ^ reversed,
            bounds,
        })
    }

    /// A loop goes round as the face's normal wants it, or the other way where the bound or the shell says so.
    fn bound(&mut self, id: u64, from: u64, reversed: bool) -> Result<BrepBound, StepError> {
        let entity = self.file.entity(id, from)?;
        if !matches!(entity.kind(), "FACE_BOUND" | "FACE_OUTER_BOUND") {
            return Err(entity.other("a FACE_BOUND"));
        }
        let reversed = reversed == entity.flag(2)?;
        let walk = self.file.entity(entity.reference(1)?, id)?;
        let uses = match walk.kind() {
            "VERTEX_LOOP" => {
                let vertex = self.vertex(walk.reference(1)?, walk.id)?;
                return Ok(BrepBound::Vertex(vertex));
            }
            "EDGE_LOOP" => match self.edge_loop(&walk)? {
                Ok(uses) => uses,
                Err(vertex) => return Ok(BrepBound::Vertex(vertex)),
            },
            "POLY_LOOP" => self.polygon(&walk)?,
            _ => return Err(walk.unreadable("loops are EDGE_LOOP, VERTEX_LOOP or POLY_LOOP")),
        };
        let mut bound = BrepBound::Loop(uses);
        if reversed {
            bound.reverse();
        }
        Ok(bound)
    }

    /// The edges of a loop, or its vertex where none has a length.
    fn edge_loop(&mut self, walk: &Entity<'_>) -> Result<Result<Vec<(u32, bool)>, u32>, StepError> {
        let (mut uses, mut point) = (Vec::new(), None);
        for oriented in walk.references(1)? {
            let oriented = self.file.entity(oriented, walk.id)?;
            if !matches!(oriented.kind(), "ORIENTED_EDGE" | "SEAM_EDGE") {
                return Err(oriented.other("an ORIENTED_EDGE"));
            }
            match self.edge(oriented.reference(3)?, oriented.id)? {
                Ok(edge) => uses.push((edge, oriented.flag(4)?)),
                Err(vertex) => point = Some(vertex),
            }
        }
        if uses.is_empty() {
            let point = point.ok_or_else(|| walk.unreadable("a loop without edges"))?;
            return Ok(Err(point));
        }
        self.check_closed(walk.id, &uses)?;
        Ok(Ok(uses))
    }

    /// Each edge ends where the next one starts; vertices that are apart by rounding become one.
    fn check_closed(&mut self, id: u64, uses: &[(u32, bool)]) -> Result<(), StepError> {
        let vertices = &self.brep.vertices;
        let ends = |(edge, forward): (u32, bool)| {
            let [a, b] = self.brep.edges[edge as usize].ends;
            if forward { [a, b] } else { [b, a] }
        };
        for (k, one) in uses.iter().enumerate() {
            let (end, start) = (ends(*one)[1], ends(uses[(k + 1) % uses.len()])[0]);
            if end == start {
                continue;
            }
            let at = &vertices[end as usize];
            let gap_m = (at - vertices[start as usize]).norm();
            let far = uses
                .iter()
                .map(|&one| (vertices[ends(one)[0] as usize] - at).norm());
            let allowed_m = SAME_VERTEX * far.fold(0.0, f64::max);
            let allowed_m = allowed_m.max(2.0 * self.context.uncertainty_m);
            if gap_m > allowed_m {
                let edge = self.brep.edges[one.0 as usize].id;
                return Err(StepError::OpenLoop {
                    id,
                    edge,
                    gap_m,
                    allowed_m,
                });
            }
            self.welds.push([end, start]);
        }
        Ok(())
    }

    /// An edge; its vertex if it is a straight one from there to there, which has no length.
    fn edge(&mut self, id: u64, from: u64) -> Result<Result<u32, u32>, StepError> {
        if let Some(known) = self.edges.get(&id) {
            return Ok(Ok(*known));
        }
        let entity = self.file.entity(id, from)?;
        if entity.kind() != "EDGE_CURVE" {
            return Err(entity.unreadable("edges need a curve: EDGE_CURVE"));
        }
        let ends = [
            self.vertex(entity.reference(1)?, id)?,
            self.vertex(entity.reference(2)?, id)?,
        ];
        let whole = curves::read(self.file, entity.reference(3)?, id, self.context)?;
        if matches!(whole.curve, BrepCurve::Line { .. }) && ends[0] == ends[1] {
            return Ok(Err(ends[0]));
        }
        let edge = BrepEdge {
            id,
            curve: whole.curve,
            ends,
            along: entity.flag(4)? == whole.along,
        };
        let at = self.brep.edges.len() as u32;
        self.brep.edges.push(edge);
        self.edges.insert(id, at);
        Ok(Ok(at))
    }

    fn vertex(&mut self, id: u64, from: u64) -> Result<u32, StepError> {
        if let Some(known) = self.vertices.get(&id) {
            return Ok(*known);
        }
        let entity = self.file.entity(id, from)?;
        let point = match entity.kind() {
            "VERTEX_POINT" => self
                .file
                .point(entity.reference(1)?, id, &self.context.length)?,
            _ => return Err(entity.other("a VERTEX_POINT")),
        };
        Ok(self.add_vertex(id, point))
    }

    fn add_vertex(&mut self, id: u64, point: Point3) -> u32 {
        let at = self.brep.vertices.len() as u32;
        self.brep.vertices.push(point);
        self.vertex_ids.push(id);
        self.vertices.insert(id, at);
        at
    }

    /// Straight edges from point to point, shared with the polygons beside.
    fn polygon(&mut self, walk: &Entity<'_>) -> Result<Vec<(u32, bool)>, StepError> {
        let mut corners = Vec::new();
        for id in walk.references(1)? {
            let known = self.vertices.get(&id).copied();
            corners.push(match known {
                Some(known) => known,
                None => {
                    let point = self.file.point(id, walk.id, &self.context.length)?;
                    self.add_vertex(id, point)
                }
            });
        }
        if corners.len() < 3 {
            return Err(walk.unreadable("a polygon has three corners at least"));
        }
        let next = corners.iter().cycle().skip(1);
        let mut uses = Vec::new();
        for (&a, &b) in corners.iter().zip(next) {
            uses.push(self.side(walk, [a, b])?);
        }
        Ok(uses)
    }

    fn side(&mut self, walk: &Entity<'_>, ends: [u32; 2]) -> Result<(u32, bool), StepError> {
        if let Some(&known) = self.straight.get(&pair(ends)) {
            return Ok((known, self.brep.edges[known as usize].ends == ends));
        }
        let [origin, to] = ends.map(|vertex| self.brep.vertices[vertex as usize]);
        let along: Vector3 = to - origin;
        let direction = direction_of(&along);
        let direction =
            direction.ok_or_else(|| walk.unreadable("two corners of it are the same point"))?;
        let at = self.brep.edges.len() as u32;
        self.brep.edges.push(BrepEdge {
            id: walk.id,
            curve: BrepCurve::Line { origin, direction },
            ends,
            along: true,
        });
        self.straight.insert(pair(ends), at);
        Ok((at, true))
    }

    /// Makes one vertex of those that are one.
    fn weld(&mut self) {
        if self.welds.is_empty() {
            return;
        }
        let mut first: Vec<u32> = (0..self.brep.vertices.len() as u32).collect();
        for &[a, b] in &self.welds {
            let [a, b] = [a, b].map(|v| root(&mut first, v));
            first[a.max(b) as usize] = a.min(b);
        }
        let (mut index, mut kept) = (vec![0; first.len()], Vec::new());
        for k in 0..first.len() {
            let root = root(&mut first, k as u32) as usize;
            if root == k {
                index[k] = kept.len() as u32;
                kept.push(self.brep.vertices[k]);
            } else {
                index[k] = index[root];
            }
        }
        self.left_out.welded += first.len() - kept.len();
        self.brep.vertices = kept;
        let moved = |v: &mut u32| *v = index[*v as usize];
        self.brep
            .edges
            .iter_mut()
            .flat_map(|e| &mut e.ends)
            .for_each(moved);
        for bound in self.brep.faces.iter_mut().flat_map(|face| &mut face.bounds) {
            if let BrepBound::Vertex(vertex) = bound {
                moved(vertex);
            }
        }
    }
}

/// The first of the vertices that are one with this.
fn root(first: &mut [u32], mut v: u32) -> u32 {
    while first[v as usize] != v {
        first[v as usize] = first[first[v as usize] as usize];
        v = first[v as usize];
    }
    v
}

fn pair([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
