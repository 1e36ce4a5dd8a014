//! Distances to triangles, by a tree of boxes.
//!
//! A search keeps the few triangles that are nearest. While a point has moved so little that no other can have come nearer than
//! one of these, they are all that is looked at; of equals the first is taken, so that the answer is the same whatever was
//! asked before. Signs come from angle-weighted normals of vertices and edges (Bærentzen & Aanæs 2005).

use crate::math::{Point3, Vector3};

/// Triangles of a leaf, at most.
const LEAF: usize = 4;
/// Triangles that are kept of a search; no mesh has fewer.
const NEAR: usize = 4;
/// Levels of the tree, at most: each halves what may be as many triangles as have numbers.
const DEPTH: usize = 33;
/// Of the size: what rounding leaves of a distance.
const ROUNDING: f64 = 1e-14;

/// A checked mesh.
#[derive(Clone)]
pub(super) struct Triangles {
    /// Corners of each triangle, by vertex.
    indices: Vec<[u32; 3]>,
    /// (triangles), in the order of the tree.
    faces: Vec<Face>,
    /// (triangles), by their numbers: mean normals at the edges; edge k goes out from corner k.
    edges: Vec<[Vector3; 3]>,
    /// Two children after each other have the boxes of one node.
    nodes: Vec<Node>,
    /// (vertices): angle-weighted normal.
    corners: Vec<Vector3>,
    rounding_m: f64,
}

/// A triangle as it is measured.
#[derive(Clone, Copy)]
struct Face {
    /// Which triangle of the mesh it is.
    triangle: u32,
    corners: [Point3; 3],
    /// Unit normal, outwards.
    normal: Vector3,
}

/// Two boxes, and where what is in them begins.
#[derive(Clone, Copy)]
struct Node {
    low: [Point3; 2],
    high: [Point3; 2],
    /// A node, or a leaf: its first triangle in the order of the tree, and how many.
    child: [(u32, u32); 2],
}

/// Which feature of a triangle is nearest.
#[derive(Clone, Copy)]
enum Nearest {
    Face,
    Edge(usize),
    Corner(usize),
}

/// The foot of a point on the triangles.
#[derive(Clone, Copy)]
pub(super) struct MeshFoot {
    /// Signed distance, m, negative inside.
    pub gap_m: f64,
    /// The unit way out.
    pub out: Vector3,
    /// The triangle that is nearest.
    pub triangle: usize,
}

/// The triangles that were nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    at: Point3,
    /// Signed distance there, m, negative inside.
    gap_m: f64,
    /// Squared distance, m², and place in the tree, nearest first.
    faces: [(f64, u32); NEAR],
    count: usize,
}

impl Default for Near {
    fn default() -> Self {
        Self {
            at: Point3::origin(),
            gap_m: 0.0,
            faces: [(f64::INFINITY, 0); NEAR],
            count: 0,
        }
    }
}

impl Near {
    fn keep(&mut self, square: f64, face: u32) {
        let mut at = self.count.min(NEAR - 1);
        while at > 0 && (square, face) < self.faces[at - 1] {
            self.faces[at] = self.faces[at - 1];
            at -= 1;
        }
        if at < self.count || self.count < NEAR {
            self.faces[at] = (square, face);
        }
        self.count = NEAR.min(self.count + 1);
    }

    /// Signed distances are at least this, m, as far as the last search knows: they change by no more than the way.
    pub fn least_gap_m(&self, p: &Point3) -> f64 {
        self.gap_m - (p - self.at).norm()
    }

    /// Squared distance beyond which no triangle is kept, m².
    fn most(&self) -> f64 {
        match self.count {
            NEAR => self.faces[NEAR - 1].0,
            _ => f64::INFINITY,
        }
    }
}

fn out_of_box(p: &Point3, low: &Point3, high: &Point3) -> f64 {
    let out = |k: usize| (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
    let [x, y, z] = [out(0), out(1), out(2)];
    x * x + y * y + z * z
}

impl Face {
    /// The nearest point, and of which feature.
    fn nearest(&self, p: &Point3) -> (Vector3, Nearest) {
        let away = p - self.corners[0];
        let mut best = (self.normal * away.dot(&self.normal), Nearest::Face);
        let mut least = f64::INFINITY;
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let (way, away) = (b - a, p - a);
            if self.normal.cross(&way).dot(&away) >= 0.0 {
                continue;
            }
            let t = away.dot(&way) / way.norm_squared();
            let (foot, nearest) = if t <= 0.0 {
                (a, Nearest::Corner(k))
            } else if t >= 1.0 {
                (b, Nearest::Corner((k + 1) % 3))
            } else {
                (a + way * t, Nearest::Edge(k))
            };
            let away = p - foot;
            let square = away.norm_squared();
            if square < least {
                (least, best) = (square, (away, nearest));
            }
        }
        best
    }
}

impl Triangles {
    /// Of a checked mesh.
    pub fn new(vertices: &[Point3], triangles: &[[u32; 3]], size_m: f64) -> Self {
        let at = |t: &[u32; 3]| t.map(|k| vertices[k as usize]);
        let mut corners = vec![Vector3::zeros(); vertices.len()];
        let mut sides = Vec::with_capacity(3 * triangles.len());
        let normals: Vec<Vector3> = (triangles.iter().map(at))
            .map(|[a, b, c]| (b - a).cross(&(c - a)).normalize())
            .collect();
        for (triangle, t) in triangles.iter().enumerate() {
            let places = at(t);
            for k in 0..3 {
                let [to, from] = [1, 2].map(|n| places[(k + n) % 3] - places[k]);
                let angle = libm::atan2(to.cross(&from).norm(), to.dot(&from));
                corners[t[k] as usize] += normals[triangle] * angle;
                let (a, b) = (t[k], t[(k + 1) % 3]);
                sides.push(([a.min(b), a.max(b)], triangle, k));
            }
        }
        let mut faces: Vec<Face> = (0..triangles.len())
            .map(|t| Face {
                triangle: t as u32,
                corners: at(&triangles[t]),
                normal: normals[t],
            })
            .collect();
        let mut edges = vec![[Vector3::zeros(); 3]; triangles.len()];
        sides.sort_unstable();
        for pair in sides.chunk_by(|a, b| a.0 == b.0) {
            let mean = pair.iter().map(|side| normals[side.1]).sum();
            for &(_, triangle, k) in pair {
                edges[triangle][k] = mean;
            }
        }
        let mut nodes = Vec::with_capacity(triangles.len());
        let count = faces.len();
        divide(&mut faces, 0, count, &mut nodes);
        Self {
            indices: triangles.to_vec(),
            faces,
            edges,
            nodes,
            corners,
            rounding_m: ROUNDING * size_m,
        }
    }

    /// Corners of each triangle.
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.indices
    }

    /// The foot of a finite point; `near`: what was near to the last.
    pub fn foot(&self, p: &Point3, near: &mut Near) -> MeshFoot {
        let known_m = near.most().sqrt() - (p - near.at).norm() - self.rounding_m;
        let mut best = (f64::INFINITY, 0, Vector3::zeros(), Nearest::Face);
        let mut farthest = 0.0_f64;
        for &(_, k) in &near.faces[..near.count] {
            let (way, feature) = self.faces[k as usize].nearest(p);
            let square = way.norm_squared();
            farthest = farthest.max(square);
            if (square, k) < (best.0, best.1) {
                best = (square, k, way, feature);
            }
        }
        if near.count < NEAR || best.0.sqrt() >= known_m {
            let reach = if near.count < NEAR {
                f64::INFINITY
            } else {
                farthest
            };
            self.search(p, reach, near);
            let k = near.faces[0].1;
            let (way, feature) = self.faces[k as usize].nearest(p);
            let foot = self.signed(k as usize, &way, feature);
            near.gap_m = foot.gap_m;
            return foot;
        }
        self.signed(best.1 as usize, &best.2, best.3)
    }

    /// Finds what is nearest, of which as much as is kept is within a squared distance, m².
    fn search(&self, p: &Point3, within: f64, near: &mut Near) {
        (near.at, near.count) = (*p, 0);
        let most = |square: f64| {
            let reach = square.sqrt() + self.rounding_m;
            reach * reach
        };
        let mut limit = most(within);
        let mut stack = [(0.0, (0, 0)); DEPTH];
        let mut held = 1;
        while held > 0 {
            held -= 1;
            let (square, (first, count)) = stack[held];
            if square > limit {
                continue;
            }
            if count == 0 {
                let node = &self.nodes[first as usize];
                let away = [0, 1].map(|k| out_of_box(p, &node.low[k], &node.high[k]));
                let nearer = usize::from(away[1] < away[0]);
                for k in [1 - nearer, nearer] {
                    if away[k] <= limit {
                        stack[held] = (away[k], node.child[k]);
                        held += 1;
                    }
                }
                continue;
            }
            for k in first..first + count {
                let face = &self.faces[k as usize];
                let above_m = (p - face.corners[0]).dot(&face.normal);
                if above_m * above_m > limit {
                    continue;
                }
                let square = face.nearest(p).0.norm_squared();
                if square <= limit {
                    near.keep(square, k);
                    limit = limit.min(most(near.most()));
                }
            }
        }
    }

    fn signed(&self, best: usize, way: &Vector3, feature: Nearest) -> MeshFoot {
        let face = &self.faces[best];
        let triangle = face.triangle as usize;
        let distance_m = way.norm();
        let normal = match feature {
            Nearest::Face => face.normal,
            Nearest::Edge(k) => self.edges[triangle][k],
            Nearest::Corner(k) => self.corners[self.indices[triangle][k] as usize],
        };
        let sign = if way.dot(&normal) < 0.0 { -1.0 } else { 1.0 };
        let on_face = matches!(feature, Nearest::Face) || distance_m <= 100.0 * self.rounding_m;
        MeshFoot {
            gap_m: sign * distance_m,
            out: if on_face {
                face.normal
            } else {
                way * (sign / distance_m)
            },
            triangle,
        }
    }
}

/// Halves what is of more than a leaf, along the side where middles are farthest apart; two boxes are added for each halving.
/// Returns what stands for it in the node above.
fn divide(faces: &mut [Face], first: usize, count: usize, nodes: &mut Vec<Node>) -> (u32, u32) {
    let here = &mut faces[first..first + count];
    let middle = |face: &Face| face.corners.iter().map(|p| p.coords).sum::<Vector3>();
    let one = middle(&here[0]);
    let (low, high) =
        (here.iter().map(middle)).fold((one, one), |(l, h), x| (l.inf(&x), h.sup(&x)));
    let along = (high - low).imax();
    let half = count / 2;
    here.select_nth_unstable_by(half, |a, b| {
        let [x, y] = [a, b].map(|face| middle(face)[along]);
        x.total_cmp(&y).then(a.triangle.cmp(&b.triangle))
    });
    let parts = [(first, half), (first + half, count - half)];
    let boxes = parts.map(|(first, count)| {
        let corners = || (faces[first..first + count].iter()).flat_map(|face| face.corners);
        let one = faces[first].corners[0];
        corners().fold((one, one), |(l, h), p| (l.inf(&p), h.sup(&p)))
    });
    let node = nodes.len();
    nodes.push(Node {
        low: boxes.map(|(low, _)| low),
        high: boxes.map(|(_, high)| high),
        child: [(0, 0); 2],
    });
    for (k, (first, count)) in parts.into_iter().enumerate() {
        nodes[node].child[k] = if count <= LEAF {
            (first as u32, count as u32)
        } else {
            divide(faces, first, count, nodes)
        };
    }
    (node as u32, 0)
}
