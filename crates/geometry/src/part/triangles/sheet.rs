//! A face laid out in a plane: its parameters in steps, cut where they go round, or a sphere seen from one of its points.

use super::super::bezier;
use super::super::carrier::Carrier;
use super::super::chart::{lifted, wrap};
use super::super::part::{Edge, Face, Part};
use super::corner::{Id, TrianglesError};
use super::ruler::{self, Fineness, Plane, Ruler};
use crate::math::{Point3, Vector3};

/// Places at which each segment of an edge is looked at.
const LOOKS: usize = 16;
/// Of the range of a parameter: how near to a pole a place is at it.
const AT_POLE: f64 = 1e-7;
/// Of an edge's segment: where a parameter is read that has no value at a pole.
const BESIDE: f64 = 1e-5;

/// How a face's places become places in the plane.
#[derive(Clone, Debug)]
pub(super) enum Layout {
    /// Parameters in steps.
    Flat([Ruler; 2]),
    /// A sphere, and the angle of a step.
    Ball(Plane, f64),
}

/// A face to be divided.
#[derive(Clone, Debug)]
pub(super) struct Sheet<'a> {
    pub face: &'a Face,
    /// Edges, and which of their sides it is.
    pub uses: Vec<(u32, usize)>,
    pub layout: Layout,
    /// Parameter, its value, and what is there.
    pub poles: Vec<(usize, f64, Id, Point3)>,
    /// Low and high of both parameters.
    pub range: [[f64; 2]; 2],
    cut: [f64; 2],
}

impl<'a> Sheet<'a> {
    pub fn new(
        part: &'a Part,
        index: usize,
        uses: Vec<(u32, usize)>,
        same: &[u32],
        fineness: &Fineness,
    ) -> Result<Self, TrianglesError> {
        let face = &part.faces[index];
        let mut sheet = Self {
            face,
            uses,
            layout: Layout::Ball(Plane::from(Vector3::z()), 1.0),
            poles: Vec::new(),
            range: [[0.0, 1.0]; 2],
            cut: ruler::periods(&face.carrier),
        };
        for (k, (direction, value)) in ruler::poles(&face.carrier).into_iter().enumerate() {
            let mut uv = [0.0; 2];
            uv[direction] = value;
            let point = face.carrier.point(sheet.confined(uv));
            let near = 1e-6 * part.size_m();
            let vertex = part
                .vertices
                .iter()
                .position(|v| (v.point - point).norm() <= near);
            let (id, point) = match vertex {
                Some(v) => {
                    let v = same[v];
                    (Id::Vertex(v), part.vertices[v as usize].point)
                }
                None => (Id::Pole(k as u32), point),
            };
            sheet.poles.push((direction, value, id, point));
        }
        sheet.measure(part)?;
        sheet.lay_out(part, fineness, 1.0);
        Ok(sheet)
    }

    /// Parameters of an edge at a place, as the carrier gives them.
    pub fn raw(&self, part: &Part, (e, side): (u32, usize), g: f64) -> [f64; 2] {
        let edge = &part.edges[e as usize];
        let side = &edge.sides[side];
        let at = |g: f64| edge.on(side, &part.faces, place(edge, g));
        let mut uv = at(g).unwrap_or([0.0, self.poles.first().map_or(0.0, |pole| pole.1)]);
        for (direction, value, ..) in &self.poles {
            let [low, high] = self.range[*direction];
            if (uv[*direction] - value).abs() <= AT_POLE * (high - low).max(value.abs()) {
                let last = edge.curve.segments() as f64;
                let inside = if g < 0.5 * last {
                    g + BESIDE
                } else {
                    g - BESIDE
                };
                uv[1 - direction] = at(inside).map_or(0.0, |beside| beside[1 - direction]);
                uv[*direction] = *value;
            }
        }
        uv
    }

    /// Parameters along an edge, without jumps.
    fn looks(&self, part: &Part, user: (u32, usize)) -> Vec<(f64, [f64; 2])> {
        let segments = part.edges[user.0 as usize].curve.segments();
        let mut out: Vec<(f64, [f64; 2])> = Vec::with_capacity(segments * LOOKS + 1);
        for k in 0..=segments * LOOKS {
            let g = k as f64 / LOOKS as f64;
            let mut uv = self.raw(part, user, g);
            if let Some((_, before)) = out.last() {
                uv = std::array::from_fn(|d| lifted(uv[d], before[d], self.cut[d]));
            }
            out.push((g, uv));
        }
        out
    }

    /// The range of both parameters; where one goes round, it is cut in the middle of the widest range without an event.
    fn measure(&mut self, part: &Part) -> Result<(), TrianglesError> {
        let face = self.face;
        let unbounded = TrianglesError::Unbounded { face: face.id };
        let domain = match &face.carrier {
            Carrier::Spline(s) => {
                Some([s.knots_u(), s.knots_v()].map(|knots| <[f64; 2]>::from(knots.domain())))
            }
            _ => None,
        };
        // Poles are recognised by the range: a first guess of it.
        self.range = [[0.0; 2]; 2];
        let looks: Vec<Vec<(f64, [f64; 2])>> = self
            .uses
            .iter()
            .map(|&user| self.looks(part, user))
            .collect();
        for d in 0..2 {
            let period = self.cut[d];
            if period > 0.0 {
                let low = match domain {
                    Some(domain) => domain[d][0],
                    None => widest_gap(events(&looks, d), period),
                };
                self.range[d] = [low, low + period];
                continue;
            }
            let values = looks.iter().flatten().map(|(_, uv)| uv[d]);
            let mut range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
                [l.min(x), h.max(x)]
            });
            if face.loops == 0 {
                range = domain.map_or([f64::NEG_INFINITY, f64::INFINITY], |domain| domain[d]);
            }
            let [low, high] = domain.map_or(self.range[1 - d], |domain| domain[1 - d]);
            for (_, value, ..) in self.poles.iter().filter(|pole| pole.0 == d) {
                let reached = (0..LOOKS).any(|k| {
                    let mut uv = [*value; 2];
                    uv[1 - d] = low + (high - low) * (k as f64 + 0.5) / LOOKS as f64;
                    face.trim.contains(uv)
                });
                if reached {
                    range = [range[0].min(*value), range[1].max(*value)];
                }
            }
            if let Some(domain) = domain {
                range = [range[0].max(domain[d][0]), range[1].min(domain[d][1])];
            }
            self.range[d] = range;
        }
        if let Carrier::Sphere { .. } = face.carrier {
            self.range = face.trim.extent();
            if face.loops == 0 {
                let quarter = std::f64::consts::FRAC_PI_2;
                self.range = [[0.0, 4.0 * quarter], [-quarter, quarter]];
            }
        }
        if let (Carrier::Torus { .. }, [_, 0.0], 0) = (&face.carrier, self.cut, face.loops) {
            self.range[1] = [self.poles[0].1, self.poles[1].1];
        }
        let finite = self.range.iter().flatten().all(|x| x.is_finite());
        let wide = self.range.iter().any(|[low, high]| high > low);
        if finite && wide {
            Ok(())
        } else {
            Err(unbounded)
        }
    }

    /// With steps for a tolerance, `finer` times as many.
    pub fn lay_out(&mut self, part: &Part, fineness: &Fineness, finer: f64) {
        let tolerance_m = fineness.tolerance_m;
        let carrier = &self.face.carrier;
        self.layout = match carrier {
            Carrier::Sphere { radius_m, .. } => {
                let plane = match &self.layout {
                    Layout::Ball(plane, step) if *step < 1.0 => *plane,
                    _ => Plane::from(self.outside(part)),
                };
                let step = ruler::sagitta_step(*radius_m, tolerance_m) / finer;
                Layout::Ball(plane, step.min(0.7))
            }
            _ => {
                let rulers = ruler::rulers(carrier, self.range, self.cut, fineness, finer);
                Layout::Flat(rulers)
            }
        };
    }

    /// Where a direction along the sphere's axes is no part of the face, as far from its edges as is found.
    fn outside(&self, part: &Part) -> Vector3 {
        let below = -Vector3::z();
        let Some(axes) = self.face.carrier.axes() else {
            return below;
        };
        let direction = |p: &Point3| axes.to_local(p).try_normalize(f64::MIN_POSITIVE);
        let mut edge: Vec<Vector3> = Vec::new();
        for &(e, _) in &self.uses {
            let curve = &part.edges[e as usize].curve;
            edge.extend(
                curve
                    .samples(LOOKS)
                    .filter_map(|at| direction(&curve.point(at))),
            );
        }
        let quarter = std::f64::consts::FRAC_PI_2;
        let all = [[0.0, 4.0 * quarter], [-quarter, quarter]];
        let lattice = ruler::lattice(&all, 0.2, 1000).unwrap_or_default();
        let mut candidates: Vec<Vector3> = lattice.into_iter().map(ruler::direction).collect();
        for pair in edge.windows(2) {
            let side = pair[0].cross(&pair[1]).try_normalize(f64::MIN_POSITIVE);
            let middle = pair[0] + pair[1];
            for way in side
                .into_iter()
                .flat_map(|side| [0.05, 0.5].map(|far| side * far))
            {
                let way = way * (pair[1] - pair[0]).norm();
                candidates.extend([0.5 * middle + way, 0.5 * middle - way].map(|c| c.normalize()));
            }
        }
        let mut best = (0.0, below);
        for to in candidates {
            let (u, v) = (libm::atan2(to.y, to.x), libm::asin(to.z.clamp(-1.0, 1.0)));
            let far = edge
                .iter()
                .fold(4.0, |far: f64, e| far.min((e - to).norm()));
            if far > best.0 && !self.face.trim.contains([u, v]) {
                best = (far, to);
            }
        }
        best.1
    }

    /// The places of an edge at which it crosses a cut, or touches it.
    pub fn crossings(&self, part: &Part, user: (u32, usize)) -> Vec<f64> {
        let Layout::Flat(rulers) = &self.layout else {
            return Vec::new();
        };
        let mut out = Vec::new();
        for (d, ruler) in rulers.iter().enumerate().filter(|(_, r)| r.period > 0.0) {
            let beside = |g: f64| ruler.beside_cut(self.raw(part, user, g)[d]);
            let looks = self.looks(part, user);
            let besides: Vec<f64> = looks
                .iter()
                .map(|(_, uv)| ruler.beside_cut(uv[d]))
                .collect();
            for k in 1..looks.len() {
                let (a, b) = (besides[k - 1], besides[k]);
                match [a, b].map(Ruler::is_on_cut) {
                    [true, true] => {}
                    [true, false] => out.push(looks[k - 1].0),
                    [false, true] => out.push(looks[k].0),
                    [false, false] if a * b < 0.0 && (a - b).abs() < 0.25 => {
                        let (mut low, mut high) = (looks[k - 1].0, looks[k].0);
                        for _ in 0..60 {
                            let middle = 0.5 * (low + high);
                            if (beside(middle) < 0.0) == (a < 0.0) {
                                low = middle;
                            } else {
                                high = middle;
                            }
                        }
                        out.push(0.5 * (low + high));
                    }
                    [false, false] => {}
                }
            }
        }
        out
    }

    /// How many steps a piece of an edge goes, from its ends' parameters and points.
    pub fn steps(&self, uv: [[f64; 2]; 2], points: [&Point3; 2]) -> f64 {
        match (&self.layout, &self.face.carrier) {
            (_, Carrier::Plane(_)) => 0.0,
            (Layout::Ball(_, step), Carrier::Sphere { radius_m, .. }) => {
                (points[1] - points[0]).norm() / (step * radius_m)
            }
            (Layout::Flat(rulers), _) => {
                let [a, b] = uv;
                let along = |d: usize| {
                    let ruler = &rulers[d];
                    let from = ruler.within(a[d]);
                    let to = lifted(b[d], from, ruler.period);
                    // Past the cut steps go on as before it.
                    let mark = |x: f64| {
                        let y = ruler.within(x);
                        match ruler.period {
                            0.0 => ruler.mark(x),
                            period => ruler.mark(y) + (x - y) / period * ruler.steps(),
                        }
                    };
                    mark(to) - mark(from)
                };
                libm::hypot(along(0), along(1))
            }
            _ => 0.0,
        }
    }

    /// Parameters within the domain of a B-spline; others as they are.
    pub fn confined(&self, uv: [f64; 2]) -> [f64; 2] {
        self.face.trim.chart.confined(uv)
    }

    /// How far a point is from the carrier, m; `uv` is near it.
    pub fn off_m(&self, point: &Point3, uv: [f64; 2]) -> f64 {
        let carrier = &self.face.carrier;
        match (carrier, carrier.axes()) {
            (Carrier::Spline(_), _) => {
                let uv = self.confined(uv);
                (carrier.point(uv) - point).dot(&carrier.normal(uv)).abs()
            }
            (_, Some(axes)) => match carrier.foot(point) {
                Some(foot) => (carrier.point(foot) - point).norm(),
                None => (point - axes.origin).norm(),
            },
            _ => 0.0,
        }
    }
}

/// The segment and the parameter within it of a place that counts segments.
pub(super) fn place(edge: &Edge, g: f64) -> (usize, f64) {
    let last = edge.curve.segments() - 1;
    let k = (g.max(0.0) as usize).min(last);
    (k, (g - k as f64).clamp(0.0, 1.0))
}

/// The point of an edge at such a place.
pub(super) fn point_at(edge: &Edge, g: f64) -> Point3 {
    let (k, t) = place(edge, g);
    bezier::point(edge.curve.segment(k), t)
}

/// Values at which edges start, end and turn, or their segments do.
fn events(looks: &[Vec<(f64, [f64; 2])>], d: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for edge in looks {
        for (k, (g, uv)) in edge.iter().enumerate() {
            let around = k.checked_sub(1).zip(edge.get(k + 1));
            let turns = around.is_none_or(|(before, (_, after))| {
                (uv[d] - edge[before].1[d]) * (after[d] - uv[d]) <= 0.0
            });
            if turns || g.fract() == 0.0 {
                out.push(uv[d]);
            }
        }
    }
    out
}

/// The middle of the widest range without a value; 0 without values.
fn widest_gap(values: Vec<f64>, period: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().map(|x| wrap(x, period)).collect();
    values.sort_unstable_by(f64::total_cmp);
    let Some(&first) = values.first() else {
        return 0.0;
    };
    let mut best = (-1.0, 0.0);
    for (k, &x) in values.iter().enumerate() {
        let next = values.get(k + 1).copied().unwrap_or(first + period);
        if next - x > best.0 {
            best = (next - x, x);
        }
    }
    best.1 + 0.5 * best.0
}
