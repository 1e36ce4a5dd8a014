//! Contacts of a mesh with a surface.
//!
//! Two kinds: a vertex of the mesh inside the body, deeper than the vertices beside it; and a point
//! of the surface inside the mesh, deeper than the surface around it. A region of overlap has one
//! or the other or both; where a way inside the mesh leads from one to the other, the deeper one
//! stands for both. (The inside of an edge or face of the mesh is deepest only where the body is
//! hollowed out to its shape; there the second kind still finds the region.)

use super::{BLOCK, MeshTool};
use crate::contact::depth::{DepthField, DepthSearch};
use crate::contact::{Contact, ContactSet, MAX_CONTACTS, Reach, ToolPoint};
use crate::math::{Point3, Pose, Vector3};
use crate::part::PartSolver;
use crate::surface::{ClosestPoint, ClosestSolver, Surface};
use std::cell::RefCell;

/// Closest points asked for in one query.
const MOST_QUERIES: usize = 4_096;

/// Scratch for one mesh against one surface, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct MeshSolver {
    search: DepthSearch,
    closed: bool,
    /// (vertices): depth in the body, m; −∞ where it is outside by more than the margin.
    depths: Vec<f64>,
    corners: Vec<Contact>,
    /// Of a tool that is a part.
    part: Option<Box<RefCell<PartSolver>>>,
}

/// How far points are from a tool, m.
#[derive(Clone, Copy)]
struct Distance<'a> {
    tool: &'a MeshTool,
    part: Option<&'a RefCell<PartSolver>>,
}

impl Distance<'_> {
    /// Signed distance of a point of the tool's frame, m, negative inside, and the unit way out there.
    fn signed(&self, p: &Point3) -> (f64, Vector3) {
        match (self.part, &self.tool.part) {
            (Some(solver), Some(part)) => match solver.borrow_mut().closest(part, p) {
                Some(foot) => {
                    let gap_m = foot.signed_distance.unwrap_or(foot.distance);
                    let way = (p - foot.point) * gap_m.signum();
                    let near_m = 1e-12 * self.tool.size_m;
                    let out = (foot.distance > near_m).then(|| way / foot.distance);
                    (gap_m, out.unwrap_or(foot.normal))
                }
                None => (f64::INFINITY, Vector3::z()),
            },
            _ => self.tool.signed_distance(p),
        }
    }
}

struct PlacedMesh<'a> {
    distance: Distance<'a>,
    pose: &'a Pose,
    margin_m: f64,
}

impl PlacedMesh<'_> {
    fn signed(&self, p: &Point3) -> (f64, Vector3) {
        self.distance.signed(&self.pose.inverse_transform_point(p))
    }
}

impl DepthField for PlacedMesh<'_> {
    fn may_reach(&self, centre: &Point3, half: &Vector3) -> bool {
        // No point of the box is nearer than its centre less its radius.
        self.signed(centre).0 <= half.norm() * (1.0 + 1e-9) + self.margin_m
    }

    fn rough(&self, p: &Point3) -> (f64, Vector3) {
        let (gap_m, out) = self.signed(p);
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
        if let (Some(solver), Some(part)) = (self.distance.part, &tool.part) {
            let foot = solver.borrow_mut().closest(part, &p)?;
            return part.plane_at(foot.support).map(|(face, ..)| face as usize);
        }
        let triangle = tool.triangles.nearest(&p);
        tool.planes[triangle].map(|_| triangle)
    }

    fn depth_below(&self, side: usize, p: &Point3) -> f64 {
        let p = self.pose.inverse_transform_point(p);
        let tool = self.distance.tool;
        let plane = match &tool.part {
            Some(part) => part.plane_of(side as u32),
            None => tool.planes[side],
        };
        plane.map_or(f64::NEG_INFINITY, |(normal, offset_m)| {
            offset_m - normal.dot(&p.coords)
        })
    }

    fn edges_known(&self) -> bool {
        true
    }
}

impl MeshSolver {
    /// Makes room for the vertices of a mesh and the pieces of a surface.
    pub fn new(surface: &Surface, solver: &mut ClosestSolver, tool: &MeshTool) -> Self {
        Self {
            search: DepthSearch::new(surface, solver),
            closed: surface.topology().is_closed(),
            depths: vec![f64::NEG_INFINITY; tool.vertices.len()],
            corners: Vec::with_capacity(MAX_CONTACTS),
            part: (tool.part.as_deref()).map(|part| Box::new(RefCell::new(PartSolver::new(part)))),
        }
    }

    /// Gap of a world point to the tool at a pose, m, and the unit vector towards the tool's matter.
    pub fn signed_gap(&self, tool: &MeshTool, pose: &Pose, point: &Point3) -> (f64, Vector3) {
        let part = self.part.as_deref();
        let (gap_m, out) = Distance { tool, part }.signed(&pose.inverse_transform_point(point));
        (gap_m, -(pose.rotation * out))
    }

    /// Contacts with a mesh at a pose, deepest first; `out` is cleared first; `beside`: contacts of the tool's edges. A pose that is not
    /// finite touches nothing.
    pub fn contacts(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        tool: &MeshTool,
        pose: &Pose,
        reach: &Reach,
        beside: &[Contact],
        out: &mut ContactSet,
    ) {
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
            .search(surface, solver, &field, reach.margin_m, beside, out);
        self.vertices(surface, solver, tool, pose, reach, out);
        let level_m = -1e-9 * self.search.size_m;
        let depth = |x: [f64; 2]| field.depth_m(&surface.point(x[0], x[1]));
        for k in 0..self.corners.len() {
            let corner = self.corners[k];
            let (map, tops) = (&self.search.map, &mut self.search.tops);
            let level_m = level_m.min(corner.depth_m - reach.margin_m);
            let same = |at: [f64; 2]| map.joined([corner.u, corner.v], at, level_m, depth);
            if tops
                .iter()
                .any(|t| t.height_m > corner.depth_m && same(t.at))
            {
                continue;
            }
            tops.retain(|t| !same(t.at));
            out.push(corner);
        }
        for top in &self.search.tops {
            let [u, v] = top.at;
            let on_body = surface.point(u, v);
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
                point: ToolPoint::Found,
            });
        }
        if out.deepest().is_some() {
            self.search.patches.report(&self.search.reached, out);
        }
        self.part = part;
    }

    /// Vertices that are deeper in the body than those beside them.
    fn vertices(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
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
        let (low, high) = bounds(surface, reach.margin_m + behind_m);
        let gap = |solver: &mut ClosestSolver, p: &Point3| {
            reach.side() * solver.closest(surface, p).signed_distance
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
            let foot = solver.closest(surface, &p);
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

/// Box of the net, grown.
fn bounds(surface: &Surface, grow_m: f64) -> (Point3, Point3) {
    let points = surface.net().points();
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let reach = Vector3::repeat(grow_m + 1e-9 * (high - low).norm());
    (low - reach, high + reach)
}
