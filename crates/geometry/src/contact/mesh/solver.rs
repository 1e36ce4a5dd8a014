//! Contacts of a mesh with a body.
//!
//! Two kinds: a vertex of the mesh inside the body, deeper than the vertices beside it; and a point
//! of the surface inside the mesh, deeper than the surface around it. A region of overlap has one
//! or the other or both; where a way inside the mesh leads from one to the other, the deeper one
//! stands for both. (The inside of an edge or face of the mesh is deepest only where the body is
//! hollowed out to its shape; there the second kind still finds the region.)

use super::{BLOCK, MeshTool};
use crate::contact::depth::{DepthField, SkinDepths};
use crate::contact::{Contact, ContactSet, MAX_CONTACTS, Reach, ToolPoint};
use crate::math::{Point3, Pose, Vector3};
use crate::part::{Part, PartFoot, PartSolver, Support};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{ClosestPoint, WarmFoot};
use std::cell::RefCell;

/// Closest points asked for in one query.
const MOST_QUERIES: usize = 4_096;

/// Scratch for one mesh against one body, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct MeshSolver {
    search: SkinDepths,
    closed: bool,
    /// (vertices): depth in the body, m; −∞ where it is outside by more than the margin.
    depths: Vec<f64>,
    corners: Vec<Contact>,
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
            _ => self.tool.signed_distance(p),
        }
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
        self.distance.tool.signed_distance(&p)
    }

    fn signed(&self, p: &Point3) -> (f64, Vector3) {
        self.distance.signed(&self.pose.inverse_transform_point(p))
    }
}

impl DepthField for PlacedMesh<'_> {
    fn may_reach(&self, centre: &Point3, half: &Vector3) -> bool {
        // No point of the box is nearer than its centre less its radius.
        let most_m = half.norm() * (1.0 + 1e-9) + self.margin_m + self.distance.off_m();
        self.to_triangles(centre).0 <= most_m
    }

    fn rough(&self, p: &Point3) -> (f64, Vector3) {
        let (gap_m, out) = self.to_triangles(p);
        (-gap_m, out)
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
        let triangle = tool.triangles.nearest(&p);
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
            depths: vec![f64::NEG_INFINITY; tool.vertices.len()],
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
        let distance = Distance {
            tool,
            part: part.as_deref(),
        };
        let field = PlacedMesh {
            distance,
            pose,
            margin_m: reach.margin_m,
        };
        self.search
            .search(skin, solver, &field, reach.margin_m, beside, out);
        self.vertices(skin, solver, tool, pose, reach, out);
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
        skin: &Skin,
        solver: &mut SkinSolver,
        tool: &MeshTool,
        pose: &Pose,
        reach: &Reach,
        out: &mut ContactSet,
    ) {
        self.corners.clear();
        self.depths.fill(f64::NEG_INFINITY);
        // A sheet has no inside to be in the box of: a vertex may be as far behind it as the mesh
        // is large.
        let behind_m = if self.closed { 0.0 } else { tool.size_m };
        let (low, high) = bounds(skin, reach.margin_m + behind_m);
        let gap = |solver: &mut SkinSolver, p: &Point3| {
            reach.side() * solver.closest(skin, p).signed_distance
        };
        let mut queries = 0;
        let mut complete = true;
        for (block, (centre, radius_m)) in tool.blocks.iter().enumerate() {
            let centre = pose * centre;
            let far =
                (0..3).any(|c| centre[c] + radius_m < low[c] || centre[c] - radius_m > high[c]);
            if far {
                continue;
            }
            queries += 1;
            if queries > MOST_QUERIES {
                complete = false;
                break;
            }
            if self.closed && gap(solver, &centre) > radius_m + reach.margin_m {
                continue;
            }
            let first = block * BLOCK;
            for k in first..(first + BLOCK).min(tool.vertices.len()) {
                let p = pose * tool.vertices[k];
                if (0..3).any(|c| p[c] < low[c] || p[c] > high[c]) {
                    continue;
                }
                queries += 1;
                let gap_m = gap(solver, &p);
                if gap_m <= reach.margin_m {
                    self.depths[k] = -gap_m;
                }
            }
        }
        for k in 0..self.depths.len() {
            let here = self.depths[k];
            let deepest = here > f64::NEG_INFINITY
                && tool.neighbours(k).iter().all(|&other| {
                    let other = other as usize;
                    if other < k {
                        here > self.depths[other]
                    } else {
                        here >= self.depths[other]
                    }
                });
            if !deepest {
                continue;
            }
            let p = pose * tool.vertices[k];
            let foot = solver.closest(skin, &p);
            let Some(corner) = corner(&foot, &p, reach.side(), self.closed) else {
                continue;
            };
            let at = self
                .corners
                .partition_point(|held| held.depth_m >= corner.depth_m);
            if self.corners.len() == MAX_CONTACTS {
                complete = false;
                if at == MAX_CONTACTS {
                    continue;
                }
                self.corners.pop();
            }
            self.corners.insert(at, corner);
        }
        if !complete {
            out.note_dropped();
        }
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
