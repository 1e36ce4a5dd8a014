//! Contacts of a mesh with a body.
//!
//! Two kinds: a vertex of the mesh inside the body, deeper than the vertices beside it; and a point
//! of the surface inside the mesh, deeper than the surface around it. A region of overlap has one
//! or the other or both; where a way inside the mesh leads from one to the other, the deeper one
//! stands for both. (The inside of an edge or face of the mesh is deepest only where the body is
//! hollowed out to its shape; there the second kind still finds the region.)

use super::tree::{MeshFoot, Near};
use super::{BLOCK, MeshTool};
use crate::contact::balls::Node;
use crate::contact::depth::{DepthField, SkinDepths};
use crate::contact::{Contact, ContactSet, MAX_CONTACTS, Reach, ToolPoint};
use crate::math::{Point3, Pose, Vector3};
use crate::part::{Part, PartFoot, PartSolver, Support};
use crate::skin::{Skin, SkinSide};
use crate::surface::{ClosestPoint, WarmFoot};
use std::cell::{Cell, RefCell};

/// Vertices asked for in one query.
const MOST_QUERIES: usize = 4_096;
/// Vertices of a block that may be known by two points around it; how far these are, of its radius, and at most, of the
/// size of the body.
const MOST_AROUND: usize = 256;
const AWAY: f64 = 16.0;
const DEEP: f64 = 0.125;
/// Of the size: a point this far from the body has a way out of its own.
const FAR: f64 = 1e-9;

/// Scratch for one mesh against one body, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct MeshSolver {
    search: SkinDepths,
    closed: bool,
    /// (vertices): depth in the body of those that were asked for, m; −∞ where it is outside by more than the margin.
    depths: Vec<f64>,
    asked: Vec<u32>,
    /// Blocks of vertices that are still to be looked at, and what is known around them.
    blocks: Vec<(Node, Option<Around>)>,
    pub(super) corners: Vec<Contact>,
    /// Of a tool that is a part.
    part: Option<Box<RefCell<Asked>>>,
}

/// What a part was asked last, from which the next answer is near.
#[derive(Clone, Debug)]
struct Asked {
    solver: PartSolver,
    warm: WarmFoot,
    at: Point3,
}

impl Asked {
    fn new(part: &Part) -> Self {
        Self {
            solver: PartSolver::new(part),
            warm: WarmFoot::default(),
            at: Point3::origin(),
        }
    }

    fn foot(&mut self, part: &Part, p: &Point3) -> Option<PartFoot> {
        let moved_m = (p - self.at).norm();
        self.at = *p;
        (self.solver).closest_warm_moved(part, p, moved_m, &mut self.warm)
    }
}

/// How far points are from a tool, m.
#[derive(Clone, Copy)]
struct Distance<'a> {
    tool: &'a MeshTool,
    /// What was near to the last point, from which the next is not far.
    near: &'a Cell<Near>,
    part: Option<&'a RefCell<Asked>>,
}

impl Distance<'_> {
    /// Signed distance of a point of the tool's frame, m, negative inside, and the unit way out there.
    fn signed(&self, p: &Point3) -> (f64, Vector3) {
        match (self.part, &self.tool.part) {
            (Some(asked), Some(part)) => {
                let foot = asked.borrow_mut().foot(part, p);
                of_foot(self.tool, p, foot)
            }
            _ => self.signed_roughly(p),
        }
    }

    fn signed_roughly(&self, p: &Point3) -> (f64, Vector3) {
        if !p.iter().all(|x| x.is_finite()) {
            return (f64::INFINITY, Vector3::z());
        }
        let foot = self.foot(p);
        (foot.gap_m, foot.out)
    }

    fn foot(&self, p: &Point3) -> MeshFoot {
        let mut near = self.near.get();
        let foot = self.tool.triangles.foot(p, &mut near);
        self.near.set(near);
        foot
    }

    /// The distance to the triangles is off by no more, m.
    fn off_m(&self) -> f64 {
        self.part.map_or(0.0, |_| self.tool.off_m)
    }
}

/// Signed distance of a point of a part's frame with its foot, m, negative inside, and the unit way out there.
fn of_foot(tool: &MeshTool, p: &Point3, foot: Option<PartFoot>) -> (f64, Vector3) {
    let Some(foot) = foot else {
        return (f64::INFINITY, Vector3::z());
    };
    let gap_m = foot.signed_distance.unwrap_or(foot.distance);
    let way = (p - foot.point) * gap_m.signum();
    let near_m = 1e-12 * tool.size_m;
    let out = (foot.distance > near_m).then(|| way / foot.distance);
    (gap_m, out.unwrap_or(foot.normal))
}

struct PlacedMesh<'a> {
    distance: Distance<'a>,
    pose: &'a Pose,
    margin_m: f64,
}

impl PlacedMesh<'_> {
    fn to_triangles(&self, p: &Point3) -> (f64, Vector3) {
        let p = self.pose.inverse_transform_point(p);
        self.distance.signed_roughly(&p)
    }

    fn signed(&self, p: &Point3) -> (f64, Vector3) {
        self.distance.signed(&self.pose.inverse_transform_point(p))
    }
}

impl DepthField for PlacedMesh<'_> {
    fn may_reach(&self, centre: &Point3, half: &Vector3) -> bool {
        // No point of the box is nearer than its centre less its radius.
        let most_m = half.norm() * (1.0 + 1e-9) + self.margin_m + self.distance.off_m();
        let p = self.pose.inverse_transform_point(centre);
        let (middle, radius_m) = self.distance.tool.ball();
        (p - middle).norm() <= radius_m + most_m
            && self.distance.near.get().least_gap_m(&p) <= most_m
            && self.distance.signed_roughly(&p).0 <= most_m
    }

    fn rough(&self, p: &Point3) -> (f64, Vector3) {
        let (gap_m, out) = self.to_triangles(p);
        (-gap_m, out)
    }

    fn rough_by_m(&self) -> Option<f64> {
        Some(self.distance.off_m() + 1e-9 * self.distance.tool.size_m)
    }

    fn depth_m(&self, p: &Point3) -> f64 {
        -self.signed(p).0
    }

    fn side(&self, p: &Point3, after: usize) -> Option<usize> {
        if after > 0 {
            return None;
        }
        let p = self.pose.inverse_transform_point(p);
        if !p.iter().all(|x| x.is_finite()) {
            return None;
        }
        let tool = self.distance.tool;
        if let (Some(asked), Some(part)) = (self.distance.part, &tool.part) {
            let Support::Face(face) = asked.borrow_mut().foot(part, &p)?.support else {
                return None;
            };
            let face = face as usize;
            return tool.planes[face].map(|_| face);
        }
        let triangle = self.distance.foot(&p).triangle;
        tool.planes[triangle].map(|_| triangle)
    }

    fn depth_below(&self, side: usize, p: &Point3) -> f64 {
        let p = self.pose.inverse_transform_point(p);
        let tool = self.distance.tool;
        tool.planes[side].map_or(f64::NEG_INFINITY, |(normal, offset_m)| {
            offset_m - normal.dot(&p.coords)
        })
    }

    fn edges_known(&self) -> bool {
        true
    }
}

impl MeshSolver {
    /// Makes room for the vertices of a mesh and the pieces of a surface, or the faces of a part.
    pub fn new(skin: &Skin, tool: &MeshTool) -> Self {
        Self {
            search: SkinDepths::new(skin),
            closed: skin.is_closed(),
            depths: vec![f64::NAN; tool.vertices.len()],
            asked: Vec::with_capacity(tool.vertices.len()),
            blocks: Vec::with_capacity(tool.blocks.len()),
            corners: Vec::with_capacity(MAX_CONTACTS),
            part: (tool.part.as_deref()).map(|part| Box::new(RefCell::new(Asked::new(part)))),
        }
    }

    /// Gap of a world point to the tool at a pose, m, and the unit vector towards the tool's matter.
    pub fn signed_gap(&self, tool: &MeshTool, pose: &Pose, point: &Point3) -> (f64, Vector3) {
        let p = pose.inverse_transform_point(point);
        let (gap_m, out) = match (self.part.as_deref(), &tool.part) {
            // What was asked before must not count.
            (Some(asked), Some(part)) => {
                let foot = asked.borrow_mut().solver.closest(part, &p);
                of_foot(tool, &p, foot)
            }
            _ => tool.signed_distance(&p),
        };
        (gap_m, -(pose.rotation * out))
    }

    /// The place of the part, if the tool is one, that is nearest to a world point.
    pub fn place(&mut self, tool: &MeshTool, pose: &Pose, point: &Point3) -> Option<[f64; 2]> {
        let asked = self.part.as_deref_mut()?.get_mut();
        let p = pose.inverse_transform_point(point);
        let foot = asked.solver.closest(tool.part.as_deref()?, &p)?;
        Some(foot.place)
    }

    /// Contacts with a mesh at a pose, deepest first; `out` is cleared first; `beside`: contacts of the tool's edges. A pose that is not
    /// finite touches nothing.
    pub fn contacts(
        &mut self,
        body: SkinSide<'_>,
        tool: &MeshTool,
        pose: &Pose,
        reach: &Reach,
        beside: &[Contact],
        out: &mut ContactSet,
    ) {
        let SkinSide { skin, solver } = body;
        out.clear();
        let finite = pose
            .translation
            .vector
            .iter()
            .chain(pose.rotation.coords.iter())
            .all(|x| x.is_finite());
        if !finite || !reach.margin_m.is_finite() || reach.margin_m < 0.0 {
            return;
        }
        debug_assert_eq!(
            self.depths.len(),
            tool.vertices.len(),
            "scratch of another mesh"
        );
        let part = self.part.take();
        if let Some(asked) = part.as_deref() {
            asked.borrow_mut().warm = WarmFoot::default();
        }
        let near = Cell::new(Near::default());
        let field = PlacedMesh {
            distance: Distance {
                tool,
                near: &near,
                part: part.as_deref(),
            },
            pose,
            margin_m: reach.margin_m,
        };
        self.search
            .search(skin, solver, &field, reach.margin_m, beside, out);
        self.vertices(SkinSide { skin, solver }, tool, pose, reach, out);
        let level_m = -1e-9 * self.search.size_m();
        let depth = |x: [f64; 2]| field.depth_m(&skin.point(x[0], x[1]));
        for corner in &self.corners {
            let (at, depth_m) = ([corner.u, corner.v], corner.depth_m);
            let level_m = level_m.min(depth_m - reach.margin_m);
            if self.search.keeps(at, depth_m, level_m, depth) {
                out.push(*corner);
            }
        }
        for top in self.search.found(skin) {
            let ([u, v], on_body) = (top.place, top.point);
            let (gap_m, way) = field.signed(&on_body);
            let normal = -(pose.rotation * way);
            let on_tool = on_body + normal * gap_m;
            out.push(Contact {
                u,
                v,
                on_body,
                on_tool,
                normal,
                depth_m: -gap_m,
                tool_uv: None,
                point: top.mark,
            });
        }
        if out.deepest().is_some() {
            self.search.report(out);
        }
        self.part = part;
    }

    /// Vertices that are deeper in the body than those beside them.
    fn vertices(
        &mut self,
        body: SkinSide<'_>,
        tool: &MeshTool,
        pose: &Pose,
        reach: &Reach,
        out: &mut ContactSet,
    ) {
        self.corners.clear();
        (self.asked.drain(..)).for_each(|k| self.depths[k as usize] = f64::NAN);
        // A sheet has no inside to be in the box of: a vertex may be as far behind it as the mesh
        // is large.
        let behind_m = if self.closed { 0.0 } else { tool.size_m };
        let mut below = Below {
            bounds: bounds(body.skin, reach.margin_m + behind_m),
            body,
            reach,
            size_m: self.search.size_m(),
        };
        self.blocks.clear();
        self.blocks
            .extend(tool.blocks.root().map(|root| (root, None)));
        let mut complete = true;
        while let Some((block, known)) = self.blocks.pop() {
            if self.asked.len() >= MOST_QUERIES {
                complete = false;
                break;
            }
            let ball = tool.blocks.ball(block);
            let (centre, radius_m) = (pose * ball.0, ball.1);
            let inside = tool.blocks.leaves(block);
            let first = inside.start * BLOCK;
            let last = tool.vertices.len().min(inside.end * BLOCK);
            let passed = |around: Option<Around>, k: usize| {
                around.is_some_and(|around| tool.is_passed(k, around, reach.margin_m))
            };
            if below.is_out(&centre, radius_m) || (first..last).all(|k| passed(known, k)) {
                continue;
            }
            let mut around = None;
            // Around more than the body a ball excludes nothing.
            if self.closed && radius_m < below.size_m {
                let foot = below.closest(&centre);
                if foot.signed_distance > radius_m + reach.margin_m {
                    continue;
                }
                if last - first <= MOST_AROUND {
                    let seen = below.around(&centre, &foot, radius_m);
                    around = Some(seen.map(|(p, gap_m)| (pose.inverse_transform_point(&p), gap_m)));
                }
            }
            if block.0 > 0 {
                let within = tool.blocks.within(block);
                self.blocks.extend(within.map(|block| (block, around)));
                continue;
            }
            for k in first..last {
                if !passed(around, k) && self.is_deepest(k, tool, pose, &mut below) {
                    complete &= self.keep_corner(&(pose * tool.vertices[k]), &mut below);
                }
            }
        }
        if !complete {
            out.note_dropped();
        }
    }

    /// Depth of a vertex, m; −∞ where it is outside by more than the margin.
    fn depth_of(&mut self, k: usize, tool: &MeshTool, pose: &Pose, below: &mut Below<'_>) -> f64 {
        if self.depths[k].is_nan() {
            self.asked.push(k as u32);
            let p = pose * tool.vertices[k];
            let gap_m = match below.is_out(&p, 0.0) {
                true => f64::INFINITY,
                false => below.reach.side() * below.closest(&p).signed_distance,
            };
            let within = gap_m <= below.reach.margin_m;
            self.depths[k] = if within { -gap_m } else { f64::NEG_INFINITY };
        }
        self.depths[k]
    }

    /// A vertex is in touch and none beside it is deeper; of equals the first.
    fn is_deepest(
        &mut self,
        k: usize,
        tool: &MeshTool,
        pose: &Pose,
        below: &mut Below<'_>,
    ) -> bool {
        let here = self.depth_of(k, tool, pose, below);
        here > f64::NEG_INFINITY
            && tool.neighbours(k).iter().all(|&other| {
                let other = other as usize;
                let there = self.depth_of(other, tool, pose, below);
                if other < k {
                    here > there
                } else {
                    here >= there
                }
            })
    }

    /// Keeps the contact of a vertex; false when something found no room.
    fn keep_corner(&mut self, p: &Point3, below: &mut Below<'_>) -> bool {
        let foot = below.closest(p);
        let Some(corner) = corner(&foot, p, below.reach.side(), self.closed) else {
            return true;
        };
        let at = self
            .corners
            .partition_point(|held| held.depth_m >= corner.depth_m);
        let full = self.corners.len() == MAX_CONTACTS;
        if full && at == MAX_CONTACTS {
            return false;
        }
        if full {
            self.corners.pop();
        }
        self.corners.insert(at, corner);
        !full
    }
}

/// Two points, one out of the body and one into it, in the tool's frame, and their gaps, m.
type Around = [(Point3, f64); 2];

/// The body as vertices see it.
struct Below<'a> {
    body: SkinSide<'a>,
    reach: &'a Reach,
    /// Box outside of which nothing counts, m.
    bounds: (Point3, Point3),
    /// Of the body, m.
    size_m: f64,
}

impl Below<'_> {
    fn closest(&mut self, p: &Point3) -> ClosestPoint {
        self.body.solver.closest(self.body.skin, p)
    }

    /// A ball is outside of the box.
    fn is_out(&self, p: &Point3, radius_m: f64) -> bool {
        let (low, high) = &self.bounds;
        (0..3).any(|c| p[c] + radius_m < low[c] || p[c] - radius_m > high[c])
    }

    /// Two points on both sides of a ball, one out of the body and one into it, and their gaps, m: between these the
    /// distance of all points of the ball is known well, as it changes by no more than the way.
    fn around(&mut self, p: &Point3, foot: &ClosestPoint, radius_m: f64) -> [(Point3, f64); 2] {
        let way = (p - foot.point) / foot.signed_distance;
        let out = if foot.distance > FAR * self.size_m {
            way
        } else {
            foot.normal
        };
        let far_m = (AWAY * radius_m).min(DEEP * self.size_m);
        [far_m, -far_m].map(|far_m| {
            let p = p + out * far_m;
            (p, self.closest(&p).signed_distance)
        })
    }
}

/// The contact of a vertex with its foot. Behind an open sheet it counts only straight above or
/// below a foot.
fn corner(foot: &ClosestPoint, p: &Point3, side: f64, closed: bool) -> Option<Contact> {
    let gap_m = side * foot.signed_distance;
    let sign = if gap_m < 0.0 { -1.0 } else { 1.0 };
    let own = foot.normal * side;
    let way = (p - foot.point) * sign;
    if !closed && gap_m < 0.0 && way.dot(&own) < (1.0 - 1e-6) * foot.distance {
        return None;
    }
    let normal = match way.try_normalize(0.0) {
        Some(n) if foot.distance > 1e-9 * foot.point.coords.amax() => n,
        _ => own,
    };
    Some(Contact {
        u: foot.u,
        v: foot.v,
        on_body: foot.point,
        on_tool: *p,
        normal,
        depth_m: -gap_m,
        tool_uv: None,
        point: ToolPoint::Found,
    })
}

/// Box of the points around it, grown.
fn bounds(skin: &Skin, grow_m: f64) -> (Point3, Point3) {
    let points = skin.points();
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let reach = Vector3::repeat(grow_m + 1e-9 * (high - low).norm());
    (low - reach, high + reach)
}
