//! An edge in the parameters of a B-spline that it bounds: cubics through feet and their slopes.

use super::bezier::Homogeneous;
use super::brep::{Brep, BrepBound};
use super::carrier::{Carrier, closed};
use super::chart::lifted;
use super::curve::EdgeCurve;
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Surface};

/// How far a cubic may be from the feet between its ends, of the size of the surface.
const FIT: f64 = 1e-10;
/// Halvings of a segment at most.
const MOST_HALVINGS: usize = 9;
/// How far the end of a cubic may be from the start of the next one, of its size.
const JOINED: f64 = 1e-6;
/// Below this, of the size, a derivative has no direction: a pole.
const POLE: f64 = 1e-7;

/// Cubics over parts of an edge's segments, in the sense of the edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PCurve {
    cubics: Vec<Cubic>,
}

#[derive(Clone, Debug, PartialEq)]
struct Cubic {
    segment: usize,
    t: [f64; 2],
    points: [[f64; 2]; 4],
}

/// A foot and how it moves with t.
#[derive(Clone, Copy, Debug)]
struct Place {
    uv: [f64; 2],
    /// From the curve, m.
    gap_m: f64,
    slope: [f64; 2],
}

struct Tracer<'a> {
    surface: &'a Surface,
    solver: &'a mut ClosestSolver,
    curve: &'a EdgeCurve,
    periods: [f64; 2],
    size_m: f64,
}

impl PCurve {
    /// By projection of the curve.
    pub fn new(surface: &Surface, solver: &mut ClosestSolver, curve: &EdgeCurve) -> Self {
        let points = surface.net().points();
        let far_m = points.iter().map(|p| (p - points[0]).norm());
        let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
        let shut = closed(surface);
        let mut tracer = Tracer {
            surface,
            solver,
            curve,
            periods: std::array::from_fn(|k| {
                if shut[k] {
                    domain[k].1 - domain[k].0
                } else {
                    0.0
                }
            }),
            size_m: far_m.fold(f64::MIN_POSITIVE, f64::max),
        };
        let mut cubics = Vec::new();
        let mut near = None;
        for segment in 0..curve.segments() {
            // Steps short enough that none goes half round a closed surface.
            let steps = 2 + curve.degree();
            let mut from = tracer.place((segment, 0.0), near);
            for k in 1..=steps {
                let t = [k - 1, k].map(|k| k as f64 / steps as f64);
                let to = tracer.place((segment, t[1]), Some(from.uv));
                tracer.fit(segment, t, [from, to], 0, &mut cubics);
                from = to;
            }
            near = Some(from.uv);
        }
        Self { cubics }
    }

    /// (u, v) at a place of the edge.
    pub fn at(&self, (segment, t): (usize, f64)) -> [f64; 2] {
        let after = self
            .cubics
            .partition_point(|c| (c.segment, c.t[0]) <= (segment, t));
        let cubic = &self.cubics[after.max(1) - 1];
        let s = (t - cubic.t[0]) / (cubic.t[1] - cubic.t[0]);
        value(&cubic.points, s)
    }

    /// As segments in (u, v), in the sense of the edge.
    pub fn segments(&self) -> impl DoubleEndedIterator<Item = Vec<Homogeneous>> + '_ {
        let flat = |c: &Cubic| c.points.iter().map(|p| [p[0], p[1], 0.0, 1.0]).collect();
        self.cubics.iter().map(flat)
    }
}

fn value(p: &[[f64; 2]; 4], s: f64) -> [f64; 2] {
    let r = 1.0 - s;
    std::array::from_fn(|k| {
        r * r * r * p[0][k]
            + 3.0 * r * r * s * p[1][k]
            + 3.0 * r * s * s * p[2][k]
            + s * s * s * p[3][k]
    })
}

/// A chain of cubics in (u, v) as one curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlatCurve {
    /// Where the cubics meet: one more than there are.
    pub breaks: Vec<f64>,
    /// Control points, those at breaks once.
    pub points: Vec<[f64; 2]>,
}

impl FlatCurve {
    /// From place to place, straight.
    pub fn line(a: [f64; 2], b: [f64; 2]) -> Self {
        let at = |s: f64| std::array::from_fn(|k| a[k] + s * (b[k] - a[k]));
        Self {
            breaks: vec![0.0, 1.0],
            points: vec![a, at(1.0 / 3.0), at(2.0 / 3.0), b],
        }
    }

    /// The last place.
    pub fn end(&self) -> [f64; 2] {
        self.points[self.points.len() - 1]
    }
}

/// Pictures of an edge in the parameters of the B-splines that it bounds, by their faces; in the sense of the edge's curve.
/// Where a face is on both sides of the edge, and where a picture has gaps (at poles), there is none.
pub(crate) fn pictures(brep: &Brep) -> Vec<Vec<(u32, FlatCurve)>> {
    let mut all = vec![Vec::new(); brep.edges.len()];
    for (f, face) in brep.faces.iter().enumerate() {
        let Carrier::Spline(surface) = &face.carrier else {
            continue;
        };
        let mut solver = ClosestSolver::new(surface);
        let loops = face.bounds.iter().filter_map(|bound| match bound {
            BrepBound::Loop(uses) => Some(uses),
            BrepBound::Vertex(_) => None,
        });
        let mut edges: Vec<u32> = loops.flatten().map(|&(e, _)| e).collect();
        edges.sort_unstable();
        for run in edges.chunk_by(|a, b| a == b) {
            let ([e], Some(edge)) = (run, brep.edges.get(run[0] as usize)) else {
                continue;
            };
            let ends = edge.ends.map(|v| &brep.vertices[v as usize]);
            let closed = edge.ends[0] == edge.ends[1];
            let curve = EdgeCurve::new(&edge.curve, edge.along, ends, closed);
            let picture = curve
                .ok()
                .and_then(|curve| PCurve::new(surface, &mut solver, &curve).joined(edge.along));
            all[*e as usize].extend(picture.map(|picture| (f as u32, picture)));
        }
    }
    all
}

impl PCurve {
    /// All cubics as one curve, the other way round if not `along`; `None` where they do not meet.
    pub fn joined(&self, along: bool) -> Option<FlatCurve> {
        let place = |c: &Cubic, t: f64| c.segment as f64 + t;
        let first = self.cubics.first()?;
        let mut breaks = vec![place(first, first.t[0])];
        let mut points = vec![first.points[0]];
        for cubic in &self.cubics {
            let (last, next) = (points[points.len() - 1], cubic.points[0]);
            let size = (0..2).map(|k| (cubic.points[3][k] - next[k]).abs());
            let apart = (0..2).map(|k| (last[k] - next[k]).abs());
            if apart.fold(0.0, f64::max) > JOINED * size.fold(0.0, f64::max) {
                return None;
            }
            breaks.push(place(cubic, cubic.t[1]));
            points.extend(&cubic.points[1..]);
        }
        if !along {
            let end = breaks[0] + breaks[breaks.len() - 1];
            breaks.reverse();
            breaks.iter_mut().for_each(|t| *t = end - *t);
            points.reverse();
        }
        let rising = breaks.windows(2).all(|pair| pair[0] < pair[1]);
        let finite = points.iter().flatten().all(|x| x.is_finite());
        (rising && finite).then_some(FlatCurve { breaks, points })
    }
}

impl Tracer<'_> {
    /// The foot of a place of the edge, near another foot where one is known.
    fn place(&mut self, at: (usize, f64), near: Option<[f64; 2]>) -> Place {
        let q = self.curve.point(at);
        let foot = self.foot(&q, near);
        let mut uv = foot;
        let mut frame = self.surface.frame(uv[0], uv[1]);
        let range: [f64; 2] = [
            self.surface.knots_u().domain(),
            self.surface.knots_v().domain(),
        ]
        .map(|d| d.1 - d.0);
        let flat = [frame.du, frame.dv]
            .iter()
            .zip(range)
            .position(|(d, range)| d.norm() * range < POLE * self.size_m);
        if let Some(k) = flat {
            // At a pole the parameter along it is what it tends to.
            let inside = (at.0, if at.1 < 0.5 { at.1 + 1e-5 } else { at.1 - 1e-5 });
            let beside = self.foot(&self.curve.point(inside), near);
            uv[k] = beside[k];
            frame = self.surface.frame(beside[0], beside[1]);
        }
        if let Some(near) = near {
            uv = std::array::from_fn(|k| lifted(uv[k], near[k], self.periods[k]));
        }
        let slope = self.curve.slope(at);
        Place {
            uv,
            gap_m: (self.surface.point(foot[0], foot[1]) - q).norm(),
            slope: solved(&frame.du, &frame.dv, &slope),
        }
    }

    fn foot(&mut self, q: &Point3, near: Option<[f64; 2]>) -> [f64; 2] {
        let close = near.and_then(|[u, v]| {
            let within = |x: f64, domain: (f64, f64), period: f64| {
                let y = lifted(x, 0.5 * (domain.0 + domain.1), period);
                y.clamp(domain.0, domain.1)
            };
            let u = within(u, self.surface.knots_u().domain(), self.periods[0]);
            let v = within(v, self.surface.knots_v().domain(), self.periods[1]);
            self.solver.local(self.surface, q, u, v)
        });
        let close = close.filter(|foot| foot.distance < 1e-4 * self.size_m);
        let foot = close.unwrap_or_else(|| self.solver.closest(self.surface, q));
        [foot.u, foot.v]
    }

    fn fit(
        &mut self,
        segment: usize,
        t: [f64; 2],
        [a, b]: [Place; 2],
        depth: usize,
        out: &mut Vec<Cubic>,
    ) {
        let h = (t[1] - t[0]) / 3.0;
        let points = [
            a.uv,
            std::array::from_fn(|k| a.uv[k] + h * a.slope[k]),
            std::array::from_fn(|k| b.uv[k] - h * b.slope[k]),
            b.uv,
        ];
        let middle = 0.5 * (t[0] + t[1]);
        let mid = self.place((segment, middle), Some(value(&points, 0.5)));
        let off = |p: [f64; 2], q: [f64; 2]| {
            let frame = self.surface.frame(q[0], q[1]);
            (frame.du * (p[0] - q[0]) + frame.dv * (p[1] - q[1])).norm()
        };
        // No nearer than a hundredth of what the edge is off by itself.
        let fit_m = (FIT * self.size_m).max(0.01 * mid.gap_m);
        let good = off(value(&points, 0.5), mid.uv) <= fit_m && {
            let at = 0.75 * t[0] + 0.25 * t[1];
            let quarter = self.place((segment, at), Some(value(&points, 0.25)));
            off(value(&points, 0.25), quarter.uv) <= fit_m
        };
        if good || depth >= MOST_HALVINGS {
            out.push(Cubic { segment, t, points });
        } else {
            self.fit(segment, [t[0], middle], [a, mid], depth + 1, out);
            self.fit(segment, [middle, t[1]], [mid, b], depth + 1, out);
        }
    }
}

/// a and b for which a du + b dv is nearest to a direction.
pub(super) fn solved(du: &Vector3, dv: &Vector3, to: &Vector3) -> [f64; 2] {
    let (uu, uv, vv) = (du.norm_squared(), du.dot(dv), dv.norm_squared());
    let (u, v) = (du.dot(to), dv.dot(to));
    let whole = uu * vv - uv * uv;
    if whole <= 1e-24 * uu * vv || whole == 0.0 {
        return [0.0; 2];
    }
    [(u * vv - v * uv) / whole, (v * uu - u * uv) / whole]
}
