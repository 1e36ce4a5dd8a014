//! The closest point of a part, proved: the nearest of all edges, and of the feet on all faces that lie within their loops.
//!
//! A minimum of the distance to a trimmed face is either a minimum of the distance to its carrier, inside the loops, or on
//! an edge. So the certificate of the carriers carries over, and no bound has to know the loops.

use super::carrier::Carrier;
use super::part::Part;
use super::tree::Tree;
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestPoint, ClosestSolver};

/// Minima of a B-spline that are looked at.
const MOST_FEET: usize = 64;

/// On which the closest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Inside a face, by index.
    Face(u32),
    /// Between two faces, by index of the edge.
    Edge(u32),
    /// Where edges meet, or the apex of a cone, by index.
    Vertex(u32),
}

impl Support {
    /// `face`, `edge` or `vertex`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Face(_) => "face",
            Self::Edge(_) => "edge",
            Self::Vertex(_) => "vertex",
        }
    }

    /// Which one of them.
    pub fn index(self) -> u32 {
        match self {
            Self::Face(k) | Self::Edge(k) | Self::Vertex(k) => k,
        }
    }
}

/// The closest point of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartFoot {
    /// m.
    pub point: Point3,
    /// Unit normal of the face, out of the matter; the mean of those that meet at an edge or a vertex.
    pub normal: Vector3,
    /// From the query, m.
    pub distance: f64,
    /// Negative inside, m; `None` for parts without an inside. 0 at an edge or a vertex that is nearer than its own gap.
    pub signed_distance: Option<f64>,
    /// What it is on.
    pub support: Support,
    /// The face it is on, or one of those that meet there.
    pub face: u32,
    /// The same place in two numbers, as [`Part::point`] takes them.
    pub place: [f64; 2],
    /// No closer point can have been passed over.
    pub certified: bool,
}

/// Closest-point queries on a part. Scratch: its answers depend on the arguments only.
#[derive(Clone, Debug)]
pub struct PartSolver {
    /// By face: for those on B-splines.
    splines: Vec<Option<Box<ClosestSolver>>>,
    feet: Vec<ClosestPoint>,
}

/// The best so far.
#[derive(Clone, Copy)]
struct Best {
    point: Point3,
    support: Support,
    at: At,
}

/// Where on its support.
#[derive(Clone, Copy)]
enum At {
    Face([f64; 2]),
    /// The edge, its segment and the parameter there; of a vertex that it ends at as well.
    Edge(u32, (usize, f64)),
    Alone,
}

impl PartSolver {
    /// Scratch for a part.
    pub fn new(part: &Part) -> Self {
        let solver = |carrier: &Carrier| match carrier {
            Carrier::Spline(surface) => Some(Box::new(ClosestSolver::new(surface))),
            _ => None,
        };
        Self::with(
            (part.faces.iter())
                .map(|face| solver(&face.carrier))
                .collect(),
        )
    }

    /// With the scratch of its B-splines, by face.
    pub(super) fn with(splines: Vec<Option<Box<ClosestSolver>>>) -> Self {
        Self {
            splines,
            feet: Vec::with_capacity(MOST_FEET),
        }
    }

    /// The closest point of a part; `part` is that of which the scratch was made. `None` where the query is not finite.
    pub fn closest(&mut self, part: &Part, q: &Point3) -> Option<PartFoot> {
        self.closest_in(part, [&part.wires, &part.skin], &|_, item| item, q)
    }

    /// The closest point of some of a part's faces: trees over edges and lone vertices and over faces, and which one of the
    /// part's each item of a tree is (0: of the first tree, 1: of the second one).
    pub(super) fn closest_in(
        &mut self,
        part: &Part,
        [wires, skin]: [&Tree; 2],
        own: &impl Fn(usize, u32) -> u32,
        q: &Point3,
    ) -> Option<PartFoot> {
        if !q.iter().all(|x| x.is_finite()) {
            return None;
        }
        let mut best: Option<Best> = None;
        let mut ceiling = f64::INFINITY;
        wires.nearest(q, &mut ceiling, |item, ceiling| {
            let item = own(0, item);
            let Some(edge) = part.edges.get(item as usize) else {
                let v = part.lone[item as usize - part.edges.len()];
                let point = part.vertices[v as usize].point;
                let squared = (q - point).norm_squared();
                if squared < *ceiling {
                    *ceiling = squared;
                    best = Some(Best {
                        point,
                        support: Support::Vertex(v),
                        at: At::Alone,
                    });
                }
                return;
            };
            if edge.sides.is_empty() {
                return;
            }
            if let Some(on) = edge.curve.closest(q, *ceiling) {
                *ceiling = on.squared;
                let support = match edge.curve.end(on.at) {
                    Some(last) => Support::Vertex(edge.ends[usize::from(last)]),
                    None => Support::Edge(item),
                };
                best = Some(Best {
                    point: on.point,
                    support,
                    at: At::Edge(item, on.at),
                });
            }
        });
        if best.is_none() {
            // A part of whole spheres and tori has no edge to begin with.
            let (low, high) = part.bounds();
            ceiling = (q - low).sup(&(high - q)).norm_squared();
        }
        let mut certified = true;
        skin.nearest(q, &mut ceiling, |k, ceiling| {
            let k = own(1, k);
            let face = &part.faces[k as usize];
            let mut offer = |point: Point3, uv: [f64; 2], ceiling: &mut f64| {
                let squared = (q - point).norm_squared();
                let nearer = squared < *ceiling && face.trim.contains(uv);
                if nearer {
                    *ceiling = squared;
                    best = Some(Best {
                        point,
                        support: Support::Face(k),
                        at: At::Face(uv),
                    });
                }
                nearer
            };
            match (&face.carrier, &mut self.splines[k as usize]) {
                (Carrier::Spline(surface), Some(solver)) => {
                    let within = ceiling.sqrt();
                    certified &= solver.minima_within(surface, q, within, &mut self.feet);
                    // Where the B-spline ends, an edge is as near.
                    let inner = self
                        .feet
                        .iter()
                        .filter(|foot| !face.carrier.is_on_rim(&face.rims, [foot.u, foot.v]));
                    for foot in inner {
                        if offer(foot.point, [foot.u, foot.v], ceiling) {
                            break;
                        }
                    }
                }
                (carrier, _) => {
                    if let Some(uv) = carrier.foot(q) {
                        offer(carrier.point(uv), uv, ceiling);
                    }
                }
            }
        });
        best.map(|best| answer(part, q, &best, certified))
    }
}

fn answer(part: &Part, q: &Point3, best: &Best, certified: bool) -> PartFoot {
    let distance = (q - best.point).norm();
    let (face, uv) = match best.at {
        At::Face(uv) => (best.support.index(), uv),
        At::Edge(k, at) => part.beside_edge(k, at),
        At::Alone => part.beside_vertex(best.support.index()),
    };
    let (normal, gap_m) = match (best.support, best.at) {
        (Support::Edge(k), At::Edge(_, at)) => {
            let edge = &part.edges[k as usize];
            (edge.normal(&part.faces, at), edge.gap_m)
        }
        (Support::Vertex(k), _) => {
            let vertex = &part.vertices[k as usize];
            (vertex.normal, vertex.gap_m)
        }
        _ => (part.faces[face as usize].normal(uv), 0.0),
    };
    let side = normal.dot(&(q - best.point));
    let signed = match distance < gap_m {
        true => 0.0,
        false => distance.copysign(side),
    };
    PartFoot {
        point: best.point,
        normal: normal
            .try_normalize(f64::MIN_POSITIVE)
            .unwrap_or_else(Vector3::z),
        distance,
        signed_distance: part.is_closed().then_some(signed),
        support: best.support,
        face,
        place: part.place(face, uv),
        certified,
    }
}
