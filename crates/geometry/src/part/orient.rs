//! On which side of the faces the matter is. Files may say it wrongly, and a sign of a distance depends on it.
//!
//! ```text
//! every edge: walked once each way ──▶ faces turned that differ from those beside ──▶ closed bodies: seen from far away
//! ```
//! A face that is turned keeps its region: its normal and the direction of its loops both change. Where no turning helps, the
//! part has no inside, so that no sign is given.
//!
//! On spheres, tori and closed B-splines both sides of a loop are bounded, so that a sense alone that is wrong in the file means
//! the rest of the surface. It is noticed only where the shell looks inside out from far away on some sides.

use super::brep::Brep;
use super::closest::PartSolver;
use super::part::{Edge, Part};
use super::senses::{SenseProblem, Senses};
use super::tree::{Corners, Tree};
use crate::math::Point3;
use crate::surface::ClosestSolver;
use std::collections::BTreeMap;

/// How far from the middle of a body it is looked at, in half diagonals of its box.
const FAR: f64 = 3.0;
/// A normal that is across the view but for so much says nothing.
const ACROSS: f64 = 1e-3;
/// Places of a body that are looked for in another one.
const PROBES: usize = 8;
/// Of the size: nearer than this to a body, a place is neither in it nor out of it.
const TOUCHING: f64 = 1e-9;
/// Faces that hang together by edges at which two meet.
#[derive(Default)]
struct Body {
    faces: Vec<u32>,
    /// Of the shell of its first face, if that is closed and bounds a solid.
    solid: Option<u32>,
    /// The file says that it is a void.
    void: bool,
    closed: bool,
}

/// The bodies of a part while their faces are turned.
pub(super) struct Bodies {
    all: Vec<Body>,
    of_face: Vec<u32>,
    /// By face: to be turned next.
    turns: Vec<bool>,
    /// By face: turned so far.
    turned: Vec<bool>,
    /// By face: its loops agree with the sense that the file does not say.
    other_sense: Vec<bool>,
    inside_out: usize,
    /// All are closed.
    closed: bool,
    problems: Vec<SenseProblem>,
}

/// Finds the bodies, and turns faces until those beside each other agree; of two ways to do so the one with fewer turns.
pub(super) fn agree(brep: &Brep, edges: &[Edge], other_sense: &[bool]) -> Bodies {
    let count = brep.faces.len();
    let mut beside: Vec<Vec<(u32, bool)>> = vec![Vec::new(); count];
    let mut of_two_sides = Vec::new();
    for edge in edges {
        let [a, b] = edge.sides.as_slice() else {
            continue;
        };
        let same_way = a.forward == b.forward;
        beside[a.face as usize].push((b.face, same_way));
        beside[b.face as usize].push((a.face, same_way));
        of_two_sides.push((a.face, b.face, same_way));
    }
    let none = u32::MAX;
    let mut of_face = vec![none; count];
    let mut turns = vec![false; count];
    let mut all: Vec<Body> = Vec::new();
    for first in 0..count {
        if of_face[first] != none {
            continue;
        }
        let body = all.len() as u32;
        of_face[first] = body;
        let mut faces = vec![first as u32];
        let mut next = 0;
        while let Some(&face) = faces.get(next) {
            next += 1;
            for &(other, same_way) in &beside[face as usize] {
                if of_face[other as usize] == none {
                    of_face[other as usize] = body;
                    turns[other as usize] = turns[face as usize] != same_way;
                    faces.push(other);
                }
            }
        }
        faces.sort_unstable();
        all.push(Body {
            faces,
            closed: true,
            ..Body::default()
        });
    }
    let mut sided = vec![true; all.len()];
    for (a, b, same_way) in of_two_sides {
        let agree = (turns[a as usize] != turns[b as usize]) == same_way;
        sided[of_face[a as usize] as usize] &= agree;
    }
    for (body, sided) in all.iter().zip(&sided) {
        let faces = || body.faces.iter().map(|&f| f as usize);
        // Faces of the other sense are turned in either case.
        let [turned, kept] = [true, false].map(|turn| {
            let same = faces().filter(|&f| turns[f] == turn && !other_sense[f]);
            same.count()
        });
        let fewer_the_other_way = turned > kept;
        for f in faces() {
            turns[f] = *sided && turns[f] != fewer_the_other_way;
        }
    }
    let mut bodies = Bodies {
        all,
        of_face,
        turns,
        turned: vec![false; count],
        other_sense: other_sense.to_vec(),
        inside_out: 0,
        closed: true,
        problems: Vec::new(),
    };
    bodies.find_solids(brep);
    bodies.find_open(edges);
    bodies
}

impl Bodies {
    /// Edges at which the faces do not go on into each other, turned as they will be. Sheets may be open.
    fn find_open(&mut self, edges: &[Edge]) {
        let (mut open, mut uneven) = (None, None);
        for edge in edges {
            let faces = edge.sides.len();
            let forward =
                |side: &&super::part::Side| side.forward != self.turns[side.face as usize];
            if 2 * edge.sides.iter().filter(forward).count() == faces {
                continue;
            }
            self.closed = false;
            let mut of_solid = false;
            for side in &edge.sides {
                let body = &mut self.all[self.of_face[side.face as usize] as usize];
                body.closed = false;
                of_solid |= body.solid.is_some();
            }
            let list = if faces == 1 { &mut open } else { &mut uneven };
            if of_solid || faces > 1 {
                list.get_or_insert((edge.id, faces, 0)).2 += 1;
            }
        }
        let open = open.map(|(edge, _, count)| SenseProblem::Open { edge, count });
        let uneven = uneven.map(|(edge, faces, count)| SenseProblem::Uneven { edge, faces, count });
        self.problems.extend(open.into_iter().chain(uneven));
    }

    /// The first shell of a solid is the outer one.
    fn find_solids(&mut self, brep: &Brep) {
        let mut seen = BTreeMap::new();
        for shell in &brep.shells {
            let Some(solid) = shell.solid.filter(|_| shell.closed) else {
                continue;
            };
            let void = seen.insert(solid, ()).is_some();
            for &face in &shell.faces {
                let body = &mut self.all[self.of_face[face as usize] as usize];
                if body.faces[0] == face {
                    body.solid = Some(solid);
                    body.void = void;
                }
            }
        }
    }

    /// The faces that are to be turned now.
    pub fn take_turns(&mut self) -> Vec<bool> {
        let turns = std::mem::replace(&mut self.turns, vec![false; self.turned.len()]);
        for (turned, turn) in self.turned.iter_mut().zip(&turns) {
            *turned ^= turn;
        }
        turns
    }

    /// Turns closed bodies of solids so that a point far away is outside of them, and inside of voids. `boxes` are those of
    /// the part's faces, `wires` those of its edges and lone vertices.
    pub fn face_outwards(
        &mut self,
        part: &Part,
        boxes: &[Corners],
        wires: &[Corners],
        solvers: Vec<Option<Box<ClosestSolver>>>,
    ) {
        let mut views: Vec<View> = Vec::with_capacity(self.all.len());
        views.resize_with(self.all.len(), View::default);
        for (f, &body) in self.of_face.iter().enumerate() {
            views[body as usize].faces.push(f as u32);
        }
        for (k, _) in wires.iter().enumerate() {
            let faces: Vec<u32> = match part.edges.get(k) {
                Some(edge) => edge.sides.iter().map(|side| side.face).collect(),
                None => (part.vertices[part.lone[k - part.edges.len()] as usize].face)
                    .into_iter()
                    .collect(),
            };
            for face in faces {
                let view = &mut views[self.of_face[face as usize] as usize];
                if view.wires.last() != Some(&(k as u32)) {
                    view.wires.push(k as u32);
                }
            }
        }
        let mut solids: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        let mut solver = PartSolver::with(solvers);
        for (k, body) in self.all.iter().enumerate() {
            let Some(solid) = body.solid.filter(|_| body.closed) else {
                continue;
            };
            let view = &mut views[k];
            view.grow_trees(boxes, wires);
            match view.looks_outwards(part, &mut solver) {
                Some(outwards) => view.outwards = outwards,
                None => {
                    let face = part.faces[body.faces[0] as usize].id;
                    self.problems.push(SenseProblem::Crossing { face });
                    continue;
                }
            }
            solids.entry(solid).or_default().push(k);
        }
        for bodies in solids.values() {
            for &k in bodies {
                let body = &self.all[k];
                let around = bodies.iter().filter(|&&other| other != k);
                let depth = around
                    .map(|&other| views[other].holds(&views[k], part, &mut solver))
                    .try_fold(0, |sum, holds| Some(sum + usize::from(holds?)));
                let void = depth.map_or(body.void, |depth| depth % 2 == 1);
                if body.void && !void {
                    let face = part.faces[body.faces[0] as usize].id;
                    self.problems.push(SenseProblem::Outside { face });
                } else if views[k].outwards == void {
                    self.inside_out += 1;
                    for &face in &body.faces {
                        self.turns[face as usize] = true;
                    }
                }
            }
        }
    }

    /// All are closed, and look to one side from everywhere.
    pub fn are_closed(&self) -> bool {
        self.closed && self.problems.is_empty()
    }

    /// What came of it.
    pub fn said(self, brep: &Brep) -> Senses {
        let both = self.turned.iter().zip(&self.other_sense);
        let mut changes: Vec<[bool; 2]> = both
            .map(|(turned, other)| [turned ^ other, *turned])
            .collect();
        let turned: Vec<u64> = (changes.iter().zip(&brep.faces))
            .filter(|(change, _)| change.contains(&true))
            .map(|(_, face)| face.id)
            .collect();
        if turned.is_empty() {
            changes.clear();
        }
        Senses {
            turned,
            changes,
            inside_out: self.inside_out,
            problems: self.problems,
        }
    }
}

/// A body as closest-point queries see it.
#[derive(Default)]
struct View {
    faces: Vec<u32>,
    /// Edges and lone vertices.
    wires: Vec<u32>,
    trees: [Tree; 2],
    corners: Option<Corners>,
    /// The normals point away from what it encloses.
    outwards: bool,
}

impl View {
    fn grow_trees(&mut self, boxes: &[Corners], wires: &[Corners]) {
        let skin = Tree::over(boxes, self.faces.clone());
        self.corners = skin.bounds();
        self.trees = [Tree::over(wires, self.wires.clone()), skin];
    }

    /// The cosine between the view from the closest point to `q` and the normal there, and how far it is; `None` where this
    /// says nothing.
    fn side(&self, part: &Part, solver: &mut PartSolver, q: &Point3) -> Option<(f64, f64)> {
        let [wires, skin] = &self.trees;
        let foot = solver.closest_in(part, [wires, skin], q)?;
        let cos = foot.normal.dot(&(q - foot.point)) / foot.distance;
        (foot.certified && cos.abs() > ACROSS).then_some((cos, foot.distance))
    }

    /// Whether points far away are on the side of the normals; `None` where they disagree. They are above the sides and the
    /// corners of a cube.
    fn looks_outwards(&self, part: &Part, solver: &mut PartSolver) -> Option<bool> {
        let (low, high) = self.corners?;
        let (middle, half) = (nalgebra::center(&low, &high), 0.5 * (high - low).norm());
        let mut seen = None;
        for k in (0..27).filter(|k| [1, 3].contains(&sides_of(*k).abs().sum())) {
            let q = middle + sides_of(k).cast::<f64>().normalize() * (FAR * half);
            if let Some((cos, _)) = self.side(part, solver, &q) {
                let outwards = cos > 0.0;
                if *seen.get_or_insert(outwards) != outwards {
                    return None;
                }
            }
        }
        seen
    }

    /// Whether another body is within this one; `None` where they touch.
    fn holds(&self, other: &Self, part: &Part, solver: &mut PartSolver) -> Option<bool> {
        let (Some(own), Some(its)) = (self.corners, other.corners) else {
            return None;
        };
        if (0..3).any(|k| its.1[k] < own.0[k] || its.0[k] > own.1[k]) {
            return Some(false);
        }
        let near_m = (TOUCHING * part.size_m()).max(2.0 * part.gap_m());
        let step = 1 + other.faces.len() / PROBES;
        other.faces.iter().step_by(step).find_map(|&face| {
            let q = place_on(part, face);
            let (cos, distance) = self.side(part, solver, &q)?;
            (distance > near_m).then_some((cos < 0.0) == self.outwards)
        })
    }
}

/// The middle of a cube, its sides, edges and corners, in coordinates of −1, 0 and 1.
fn sides_of(k: i32) -> nalgebra::Vector3<i32> {
    nalgebra::Vector3::new(k % 3, k / 3 % 3, k / 9).add_scalar(-1)
}

/// A place of a face: on one of its edges, or anywhere where it has none.
fn place_on(part: &Part, face: u32) -> Point3 {
    let on = |edge: &&Edge| edge.sides.iter().any(|side| side.face == face);
    let own = &part.faces[face as usize];
    match part.edges.iter().find(on) {
        Some(edge) => edge.curve.point((edge.curve.segments() / 2, 0.3)),
        None => own.carrier.point(own.trim.chart.confined([0.3, 0.4])),
    }
}
