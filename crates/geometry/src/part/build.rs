//! From a boundary to a part: edges with their gaps, faces with their loops, corners.

use super::bezier;
use super::brep::{Brep, BrepBound, BrepEdge, BrepFace};
use super::carrier::Carrier;
use super::chart::Chart;
use super::curve::EdgeCurve;
use super::orient;
use super::part::{Edge, Face, Part, PartError, Side, Vertex};
use super::pcurve::PCurve;
use super::senses::Senses;
use super::tree::{Corners, Tree};
use super::trim::{Piece, Trim, TrimProblem};
use crate::math::{Point3, Vector3};
use crate::surface::ClosestSolver;
use std::f64::consts::TAU;

/// Places at which the gap of an edge is measured, in each of its segments.
const GAP_SAMPLES: usize = 64;
/// Of the size: gaps that are no error of the file, beside twice what it declares.
const MOST_GAP: f64 = 1e-3;
/// Faces that are no part are looked for so often: with each that goes, what an edge may be off gets less.
const MOST_ROUNDS: usize = 8;

impl Part {
    /// Of a boundary.
    ///
    /// # Errors
    /// Edges off their faces, loops that bound nothing; each names its `#id` in the file.
    pub fn new(brep: &Brep) -> Result<Self, PartError> {
        if brep.faces.is_empty() {
            return Err(PartError::Empty);
        }
        let mut build = Build::new(brep)?;
        for k in 0..brep.faces.len() {
            build.add_face(k as u32)?;
        }
        build.finish()
    }

    /// Of what a boundary has that makes a part: other faces are taken out of it, and returned by their former index with what
    /// is wrong with each.
    ///
    /// # Errors
    /// No face is left; or with each that goes others are lost, too often.
    pub fn partly(brep: &mut Brep) -> Result<(Self, Vec<(u32, PartError)>), PartError> {
        let mut indices: Vec<u32> = (0..brep.faces.len() as u32).collect();
        let mut left_out = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let bad = match problems(brep) {
                Ok(part) => {
                    left_out.sort_unstable_by_key(|(face, _)| *face);
                    return Ok((part?, left_out));
                }
                Err(bad) => bad,
            };
            let mut gone = vec![false; brep.faces.len()];
            for (face, problem) in bad {
                gone[face] = true;
                left_out.push((indices[face], problem));
            }
            brep.remove_faces(&gone);
            let mut all = gone.iter();
            indices.retain(|_| all.next() == Some(&false));
        }
        Self::new(brep).map(|part| (part, left_out))
    }
}

/// The part, or the faces that are none and why. The outer error is that of faces, without which there may be a part; the inner
/// one is of what no part can be without.
fn problems(brep: &Brep) -> Result<Result<Part, PartError>, Vec<(usize, PartError)>> {
    if brep.faces.is_empty() {
        return Ok(Err(PartError::Empty));
    }
    let edges: Vec<Result<Edge, PartError>> = brep.edges.iter().map(|e| made(brep, e)).collect();
    let mut bad = Vec::new();
    for (f, face) in brep.faces.iter().enumerate() {
        let loops = face.bounds.iter().filter_map(|bound| match bound {
            BrepBound::Loop(uses) => Some(uses),
            BrepBound::Vertex(_) => None,
        });
        let wrong = loops
            .flatten()
            .find_map(|(edge, _)| edges[*edge as usize].as_ref().err());
        bad.extend(wrong.map(|wrong| (f, wrong.clone())));
    }
    if !bad.is_empty() {
        return Err(bad);
    }
    let mut build = match Build::new(brep) {
        Ok(build) => build,
        Err(error) => return Ok(Err(error)),
    };
    for f in 0..brep.faces.len() {
        if let Err(problem) = build.add_face(f as u32) {
            bad.push((f, problem));
        }
    }
    match bad.is_empty() {
        true => Ok(build.finish()),
        false => Err(bad),
    }
}

/// An edge without faces yet.
fn made(brep: &Brep, edge: &BrepEdge) -> Result<Edge, PartError> {
    let ends = edge.ends.map(|v| &brep.vertices[v as usize]);
    let closed = edge.ends[0] == edge.ends[1];
    let curve = EdgeCurve::new(&edge.curve, edge.along, ends, closed).map_err(|source| {
        PartError::Edge {
            id: edge.id,
            source,
        }
    })?;
    let off = |last: bool| {
        let at = match last {
            true => (curve.segments() - 1, 1.0),
            false => (0, 0.0),
        };
        (curve.point(at) - ends[usize::from(last)]).norm()
    };
    let gap_m = off(false).max(off(true));
    Ok(Edge {
        id: edge.id,
        curve,
        ends: edge.ends,
        sides: Vec::new(),
        gap_m,
    })
}

struct Build<'a> {
    brep: &'a Brep,
    edges: Vec<Edge>,
    faces: Vec<Face>,
    vertices: Vec<Vertex>,
    boxes: Vec<Corners>,
    /// By face.
    chains: Vec<Chains>,
    /// By face: for those on B-splines.
    solvers: Vec<Option<Box<ClosestSolver>>>,
    /// By face: the loops bound something only on the other side of the carrier.
    other_sense: Vec<bool>,
    size_m: f64,
    most_gap_m: f64,
}

/// Closed chains of edges, and whether each edge goes from its first vertex to its last.
pub(super) type Chains = Vec<Vec<(u32, bool)>>;

impl<'a> Build<'a> {
    fn new(brep: &'a Brep) -> Result<Self, PartError> {
        let edges = brep.edges.iter().map(|edge| made(brep, edge));
        let edges = edges.collect::<Result<Vec<Edge>, _>>()?;
        let vertices = brep.vertices.iter().map(|&point| Vertex {
            point,
            normal: Vector3::zeros(),
            face: None,
            lone: true,
            gap_m: 0.0,
        });
        let boxes = edges.iter().map(|edge| edge.curve.bounds());
        let bounds = boxes.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
        let size_m = bounds.map_or(0.0, |(low, high)| (high - low).norm());
        Ok(Self {
            brep,
            vertices: vertices.collect(),
            edges,
            faces: Vec::with_capacity(brep.faces.len()),
            boxes: Vec::with_capacity(brep.faces.len()),
            chains: Vec::with_capacity(brep.faces.len()),
            solvers: Vec::with_capacity(brep.faces.len()),
            other_sense: Vec::with_capacity(brep.faces.len()),
            size_m,
            most_gap_m: (MOST_GAP * size_m).max(2.0 * brep.uncertainty_m),
        })
    }

    fn add_face(&mut self, index: u32) -> Result<(), PartError> {
        let face = &self.brep.faces[index as usize];
        let fail = |source| PartError::Face {
            id: face.id,
            source,
        };
        let chains = self.chains(face).map_err(fail)?;
        let carrier = match &face.carrier {
            Carrier::Spline(surface) => {
                Carrier::Spline(Box::new(surface.as_ref().clone().without_even_weights()))
            }
            carrier => carrier.clone(),
        };
        let mut solver = match &carrier {
            Carrier::Spline(surface) => Some(Box::new(ClosestSolver::new(surface))),
            _ => None,
        };
        let chart = Chart::new(&carrier);
        let mut walks = Vec::with_capacity(chains.len());
        for chain in &chains {
            let mut walk = Vec::new();
            for &(e, forward) in chain {
                self.add_side(
                    (index, &carrier),
                    (e, forward),
                    &chart,
                    solver.as_deref_mut(),
                )?;
                walk.extend(self.pieces(&chart, e, forward));
            }
            // On the carrier's own side the face is on the right where the senses differ.
            if !face.same_sense {
                turn(&mut walk);
            }
            walks.push(walk);
        }
        let mut same_sense = face.same_sense;
        let trim = match walks.is_empty() {
            true if chart.is_bounded() => Trim::whole(chart),
            true => return Err(fail(TrimProblem::Unbounded)),
            false => {
                let seams = self.seams(face, &carrier, solver.as_deref_mut());
                let on_seams =
                    |trim: &Trim| seams.iter().all(|&uv| trim.contains(chart.confined(uv)));
                match Trim::new(chart, &walks) {
                    Ok(trim) if on_seams(&trim) => trim,
                    first => {
                        // Either the sense or the loops are the wrong way: the faces beside tell which.
                        walks.iter_mut().for_each(|walk| turn(walk));
                        match (Trim::new(chart, &walks), first) {
                            (Ok(trim), Ok(first)) if !on_seams(&trim) => first,
                            (Err(_), Ok(first)) => first,
                            (Err(_), Err(problem)) => return Err(fail(problem)),
                            (Ok(trim), _) => {
                                same_sense = !same_sense;
                                trim
                            }
                        }
                    }
                }
            }
        };
        let built = Face {
            id: face.id,
            rims: carrier.rims(),
            carrier,
            same_sense,
            range_u: trim.extent()[0],
            trim,
            loops: chains.len(),
            chains: Vec::new(),
        };
        self.boxes.push(self.face_box(&built, &chains));
        self.faces.push(built);
        self.chains.push(chains);
        self.solvers.push(solver);
        self.other_sense.push(same_sense != face.same_sense);
        Ok(())
    }

    /// Closed chains of uses, seams dropped: edges that the face is on both sides of.
    fn chains(&self, face: &BrepFace) -> Result<Chains, TrimProblem> {
        let loops = || {
            face.bounds.iter().filter_map(|bound| match bound {
                BrepBound::Loop(uses) => Some(uses),
                BrepBound::Vertex(_) => None,
            })
        };
        let mut all: Vec<(u32, bool)> = loops().flatten().copied().collect();
        all.sort_unstable();
        let is_seam = |e: u32| {
            all.binary_search(&(e, true)).is_ok() && all.binary_search(&(e, false)).is_ok()
        };
        let mut out = Vec::new();
        for uses in loops() {
            let mut rest: Vec<(u32, bool)> =
                uses.iter().copied().filter(|&(e, _)| !is_seam(e)).collect();
            while !rest.is_empty() {
                let mut chain = vec![rest.remove(0)];
                let first = self.end(chain[0], false);
                while let Some(&last) = chain.last()
                    && !self.same_place(self.end(last, true), first)
                {
                    let here = self.end(last, true);
                    let next = (rest.iter()).position(|&next| self.end(next, false) == here);
                    let next = next.or_else(|| {
                        (rest.iter()).position(|&next| self.same_place(self.end(next, false), here))
                    });
                    let Some(next) = next else {
                        return Err(TrimProblem::Open(self.edges[last.0 as usize].id));
                    };
                    chain.push(rest.remove(next));
                }
                out.push(chain);
            }
        }
        Ok(out)
    }

    /// Places of the carrier in the middle of the face's seams, which lie in the face.
    fn seams(
        &self,
        face: &BrepFace,
        carrier: &Carrier,
        solver: Option<&mut ClosestSolver>,
    ) -> Vec<[f64; 2]> {
        let mut uses: Vec<(u32, bool)> = face.bounds.iter().fold(Vec::new(), |mut all, bound| {
            if let BrepBound::Loop(uses) = bound {
                all.extend(uses);
            }
            all
        });
        uses.sort_unstable();
        let both = uses
            .windows(2)
            .filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
        let middles = both.filter_map(|pair| {
            let curve = &self.edges[pair[0].0 as usize].curve;
            curve.samples(3).nth(1).map(|at| curve.point(at))
        });
        match (carrier, solver) {
            (Carrier::Spline(surface), Some(solver)) => middles
                .map(|point| {
                    let foot = solver.closest(surface, &point);
                    [foot.u, foot.v]
                })
                .collect(),
            (carrier, _) => middles.filter_map(|point| carrier.foot(&point)).collect(),
        }
    }

    /// The vertex at which a use starts, or at which it ends.
    fn end(&self, one: (u32, bool), last: bool) -> u32 {
        end(&self.edges, one, last)
    }

    fn same_place(&self, a: u32, b: u32) -> bool {
        let at = |v: u32| self.vertices[v as usize].point;
        a == b || (at(a) - at(b)).norm() <= 1e-9 * self.size_m
    }

    /// Enters a face at an edge, and how far the edge is from it.
    fn add_side(
        &mut self,
        (face, carrier): (u32, &Carrier),
        (e, forward): (u32, bool),
        chart: &Chart,
        solver: Option<&mut ClosestSolver>,
    ) -> Result<(), PartError> {
        let edge = &mut self.edges[e as usize];
        if edge.gap_m > self.most_gap_m || edge.gap_m.is_nan() {
            return Err(PartError::OffVertex {
                edge: edge.id,
                gap_m: edge.gap_m,
                most_m: self.most_gap_m,
            });
        }
        let pcurve = match (carrier, solver) {
            (Carrier::Spline(surface), Some(solver)) => {
                Some(PCurve::new(surface, solver, &edge.curve))
            }
            _ => None,
        };
        let mut gap_m = 0.0f64;
        for at in edge.curve.samples(GAP_SAMPLES) {
            let point = edge.curve.point(at);
            let uv = match &pcurve {
                Some(pcurve) => Some(pcurve.at(at)),
                None => carrier.foot(&point),
            };
            let foot = uv.map(|uv| carrier.point(chart.confined(uv)));
            let off = foot.map_or(0.0, |foot| (foot - point).norm());
            gap_m = gap_m.max(off);
        }
        if gap_m > self.most_gap_m || gap_m.is_nan() {
            return Err(PartError::OffSurface {
                edge: edge.id,
                face: self.brep.faces[face as usize].id,
                gap_m,
                most_m: self.most_gap_m,
            });
        }
        edge.gap_m = edge.gap_m.max(gap_m);
        edge.sides.push(Side {
            face,
            forward,
            pcurve,
        });
        Ok(())
    }

    /// The pieces of a use, in walking order, as the face's chart has them.
    fn pieces(&self, chart: &Chart, e: u32, forward: bool) -> Vec<Piece> {
        let edge = &self.edges[e as usize];
        let last = edge.sides.last();
        let segments: Vec<Vec<bezier::Homogeneous>> =
            match last.and_then(|side| side.pcurve.as_ref()) {
                Some(pcurve) => pcurve.segments().collect(),
                None => (0..edge.curve.segments())
                    .map(|k| chart.local(edge.curve.segment(k)))
                    .collect(),
            };
        let piece = |mut points: Vec<bezier::Homogeneous>| {
            if !forward {
                points.reverse();
            }
            Piece { points }
        };
        match forward {
            true => segments.into_iter().map(piece).collect(),
            false => segments.into_iter().rev().map(piece).collect(),
        }
    }

    /// A face lies between its edges, or bulges out of them where its normal is along an axis.
    fn face_box(&self, face: &Face, chains: &[Vec<(u32, bool)>]) -> Corners {
        let far = Point3::from(Vector3::repeat(f64::INFINITY));
        let grown = |(low, high): Corners, p: &Point3| (low.inf(p), high.sup(p));
        let mut all = (far, -far);
        let mut gap_m = 0.0f64;
        for &(e, _) in chains.iter().flatten() {
            let edge = &self.edges[e as usize];
            let (low, high) = edge.curve.bounds();
            all = grown(grown(all, &low), &high);
            gap_m = gap_m.max(edge.gap_m);
        }
        for uv in face.carrier.summits() {
            if face.trim.contains(uv) {
                all = grown(all, &face.carrier.point(uv));
            }
        }
        for (place, _, v) in face.carrier.apexes() {
            if face.trim.contains([0.0, v]) {
                all = grown(all, &place);
            }
        }
        if let Carrier::Spline(surface) = &face.carrier {
            all = surface.net().points().iter().fold(all, grown);
        }
        let slack = Vector3::repeat(gap_m);
        (all.0 - slack, all.1 + slack)
    }

    fn finish(self) -> Result<Part, PartError> {
        let Self {
            brep,
            mut edges,
            mut faces,
            mut vertices,
            boxes,
            mut chains,
            solvers,
            other_sense,
            size_m,
            ..
        } = self;
        add_apexes(&faces, &mut vertices, size_m);
        let mut bodies = orient::agree(brep, &edges, &other_sense);
        let turned = bodies.take_turns();
        turn_faces(&turned, &mut edges, &mut faces, &mut chains);
        set_corners(&edges, &faces, &mut vertices, &chains, size_m);
        let lone: Vec<u32> = (0..vertices.len() as u32)
            .filter(|&v| vertices[v as usize].lone)
            .collect();
        let mut wires: Vec<Corners> = edges.iter().map(|edge| edge.curve.bounds()).collect();
        wires.extend(
            lone.iter()
                .map(|&v| (vertices[v as usize].point, vertices[v as usize].point)),
        );
        let skin = Tree::new(&boxes);
        let bounds = skin.bounds().ok_or(PartError::Empty)?;
        let mut part = Part {
            gap_m: edges
                .iter()
                .filter(|edge| !edge.sides.is_empty())
                .fold(0.0, |m, e| m.max(e.gap_m)),
            wires: Tree::new(&wires),
            skin,
            edges,
            faces,
            vertices,
            lone,
            closed: false,
            bounds,
            senses: Senses::default(),
        };
        bodies.face_outwards(&part, &boxes, &wires, solvers);
        let turned = bodies.take_turns();
        if turned.contains(&true) {
            turn_faces(&turned, &mut part.edges, &mut part.faces, &mut chains);
            let Part {
                edges,
                faces,
                vertices,
                ..
            } = &mut part;
            set_corners(edges, faces, vertices, &chains, size_m);
        }
        part.closed = bodies.are_closed()
            && (brep.shells.iter()).all(|shell| shell.closed && shell.solid.is_some());
        part.senses = bodies.said(brep);
        for (face, chains) in part.faces.iter_mut().zip(chains) {
            face.chains = chains;
        }
        Ok(part)
    }
}

/// Walked the other way.
fn turn(walk: &mut [Piece]) {
    walk.reverse();
    walk.iter_mut().for_each(|piece| piece.points.reverse());
}

/// Turns the faces that are marked: their normals and their loops, so that they bound the same.
fn turn_faces(turned: &[bool], edges: &mut [Edge], faces: &mut [Face], chains: &mut [Chains]) {
    if !turned.contains(&true) {
        return;
    }
    for side in edges.iter_mut().flat_map(|edge| &mut edge.sides) {
        side.forward ^= turned[side.face as usize];
    }
    for ((face, chains), _) in faces
        .iter_mut()
        .zip(chains)
        .zip(turned)
        .filter(|(_, turned)| **turned)
    {
        face.same_sense = !face.same_sense;
        for chain in chains {
            chain.reverse();
            chain
                .iter_mut()
                .for_each(|(_, forward)| *forward = !*forward);
        }
    }
}

/// The vertex at which a use of an edge starts, or at which it ends.
fn end(edges: &[Edge], (e, forward): (u32, bool), last: bool) -> u32 {
    edges[e as usize].ends[usize::from(last == forward)]
}

/// Vertices at the apexes of faces that have none there in the file.
fn add_apexes(faces: &[Face], vertices: &mut Vec<Vertex>, size_m: f64) {
    for face in faces {
        for (point, _, v) in face.carrier.apexes() {
            let close_m = 1e-6 * apart(face, size_m);
            let has_one = (vertices.iter()).any(|vertex| (vertex.point - point).norm() <= close_m);
            if !has_one && face.trim.contains([0.0, v]) {
                vertices.push(Vertex {
                    point,
                    normal: Vector3::zeros(),
                    face: None,
                    lone: true,
                    gap_m: 0.0,
                });
            }
        }
    }
}

/// The size of the part as its edges show it, or of a face that has none, m.
fn apart(face: &Face, size_m: f64) -> f64 {
    match &face.carrier {
        Carrier::Torus { minor_m, .. } => size_m.max(*minor_m),
        _ => size_m,
    }
}

/// Normals of vertices, their faces and their gaps; vertices that no edge reaches are lone where a face ends there.
fn set_corners(
    edges: &[Edge],
    faces: &[Face],
    vertices: &mut [Vertex],
    chains: &[Chains],
    size_m: f64,
) {
    for vertex in vertices.iter_mut() {
        vertex.normal = Vector3::zeros();
        vertex.face = None;
        vertex.lone = true;
        vertex.gap_m = 0.0;
    }
    for (k, (face, chains)) in faces.iter().zip(chains).enumerate() {
        add_corners(edges, (k as u32, face), vertices, chains, size_m);
    }
    for vertex in vertices {
        vertex.lone &= vertex.face.is_some();
    }
}

/// A face's share of the normals of its corners: Σ αᵢ nᵢ (Bærentzen & Aanæs 2005).
fn add_corners(
    edges: &[Edge],
    (index, face): (u32, &Face),
    vertices: &mut [Vertex],
    chains: &Chains,
    size_m: f64,
) {
    for chain in chains {
        for (k, &before) in chain.iter().enumerate() {
            let after = chain[(k + 1) % chain.len()];
            let tangent = |(e, forward): (u32, bool), last: bool| {
                let t = edges[e as usize].curve.tangent_at_end(last == forward);
                if forward { t } else { -t }
            };
            let (into, out) = (tangent(before, true), tangent(after, false));
            let edge = &edges[before.0 as usize];
            let at = if before.1 {
                (edge.curve.segments() - 1, 1.0)
            } else {
                (0, 0.0)
            };
            let side = edge.sides.iter().find(|side| side.face == index);
            let Some(uv) = side.and_then(|side| match &side.pcurve {
                Some(pcurve) => Some(pcurve.at(at)),
                None => face.carrier.foot(&edge.curve.point(at)),
            }) else {
                continue;
            };
            let normal = face.normal(face.trim.chart.confined(uv));
            let back = -into;
            let mut angle = libm::atan2(normal.dot(&out.cross(&back)), out.dot(&back));
            if angle < 0.0 {
                angle += TAU;
            }
            let gap_m = edge.gap_m;
            let v = end(edges, before, true);
            let vertex = &mut vertices[v as usize];
            vertex.normal += normal * angle;
            vertex.face = Some(index);
            vertex.lone = false;
            vertex.gap_m = vertex.gap_m.max(gap_m);
        }
    }
    // Apexes that no edge reaches.
    for (place, normal, v) in face.carrier.apexes() {
        let on_face = face.trim.contains([0.0, v]);
        let near = |v: &Vertex| (v.point - place).norm() <= 1e-6 * apart(face, size_m);
        for vertex in vertices.iter_mut().filter(|v| v.lone && near(v)) {
            if on_face {
                vertex.normal = if face.same_sense { normal } else { -normal };
                vertex.face = Some(index);
            }
        }
    }
}
