//! Edges in space: pieces of curves as chains of rational Bézier segments, and their closest points.

use super::bezier::{self, Homogeneous, Polynomial};
use super::brep::BrepCurve;
use super::carrier::Axes;
use super::tree::{Corners, Tree, squared};
use crate::math::{Point3, Vector3};
use crate::surface::{Curve, extraction};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A piece of a curve, from its first vertex to its last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EdgeCurve {
    degree: usize,
    /// (segments × (degree + 1)).
    points: Vec<Homogeneous>,
    /// Around the control points of each segment, of free ones.
    boxes: Vec<Corners>,
    tree: Tree,
    shape: Shape,
}

/// What has a closest point in closed form.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Line,
    /// From x of the axes, by a positive angle (rad).
    Circle(Axes, f64, f64),
    Free,
}

/// The closest point of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnCurve {
    /// m.
    pub point: Point3,
    /// Segment and parameter within it.
    pub at: (usize, f64),
    /// m².
    pub squared: f64,
}

/// Why an edge cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CurveProblem {
    /// Two vertices at one place of an open curve.
    #[error("both its ends are at one place of a curve that is not closed")]
    Empty,
}

impl EdgeCurve {
    /// The piece of a curve between two vertices. Whole turns where both are one.
    pub fn new(
        curve: &BrepCurve,
        along: bool,
        ends: [&Point3; 2],
        closed: bool,
    ) -> Result<Self, CurveProblem> {
        let [first, last] = ends;
        match curve {
            BrepCurve::Line { origin, direction } => {
                let on = |p: &Point3| origin + direction * direction.dot(&(p - origin));
                let (a, b) = (on(first), on(last));
                if a == b {
                    return Err(CurveProblem::Empty);
                }
                Ok(Self::chain(
                    1,
                    vec![weighted(&a, 1.0), weighted(&b, 1.0)],
                    Shape::Line,
                ))
            }
            BrepCurve::Circle { axes, radius_m } => {
                let round = turned(axes, along);
                let angle = |p: &Point3| {
                    let local = round.to_local(p);
                    libm::atan2(local.y, local.x)
                };
                let from = angle(first);
                let sweep = sweep(
                    from,
                    angle(last),
                    closed || (first - last).norm() <= 1e-9 * radius_m,
                );
                let start = Axes {
                    x: round.direction(&Vector3::new(libm::cos(from), libm::sin(from), 0.0)),
                    y: round.direction(&Vector3::new(-libm::sin(from), libm::cos(from), 0.0)),
                    ..round
                };
                let points = arc(&start, [*radius_m; 2], 0.0, sweep);
                Ok(Self::chain(
                    2,
                    points,
                    Shape::Circle(start, *radius_m, sweep),
                ))
            }
            BrepCurve::Ellipse { axes, radii_m } => {
                let round = turned(axes, along);
                let [a, b] = *radii_m;
                let angle = |p: &Point3| {
                    let local = round.to_local(p);
                    libm::atan2(local.y / b, local.x / a)
                };
                let from = angle(first);
                let near = closed || (first - last).norm() <= 1e-9 * a.max(b);
                let points = arc(&round, [a, b], from, sweep(from, angle(last), near));
                Ok(Self::chain(2, points, Shape::Free))
            }
            BrepCurve::Hyperbola { axes, radii_m } => {
                let [a, b] = *radii_m;
                let t = |p: &Point3| libm::asinh(axes.to_local(p).y / b);
                let at = |t: f64| Vector3::new(a * libm::cosh(t), b * libm::sinh(t), 0.0);
                conic(
                    axes,
                    [t(first), t(last)],
                    at,
                    |t| Vector3::new(a * libm::sinh(t), b * libm::cosh(t), 0.0),
                    |d| libm::cosh(0.5 * d),
                )
            }
            BrepCurve::Parabola { axes, focal_m } => {
                let f = *focal_m;
                let t = |p: &Point3| axes.to_local(p).y / (2.0 * f);
                let at = |t: f64| Vector3::new(f * t * t, 2.0 * f * t, 0.0);
                conic(
                    axes,
                    [t(first), t(last)],
                    at,
                    |t| Vector3::new(2.0 * f * t, 2.0 * f, 0.0),
                    |_| 1.0,
                )
            }
            BrepCurve::Spline(curve) => Self::of_spline(curve, along, ends, closed),
        }
    }

    fn chain(degree: usize, points: Vec<Homogeneous>, shape: Shape) -> Self {
        let boxes: Vec<Corners> = match shape {
            Shape::Free => points.chunks(degree + 1).map(around).collect(),
            _ => Vec::new(),
        };
        Self {
            degree,
            tree: Tree::new(&boxes),
            boxes,
            points,
            shape,
        }
    }

    /// The part of a B-spline between two vertices; past the ends of a closed one where it must.
    fn of_spline(
        curve: &Curve,
        along: bool,
        [first, last]: [&Point3; 2],
        closed: bool,
    ) -> Result<Self, CurveProblem> {
        let (degree, mut points) = segments(curve);
        if !along {
            points.reverse();
        }
        let whole = Self::chain(degree, points, Shape::Free);
        let count = whole.segments();
        let (start, end) = (whole.point((0, 0.0)), whole.point((count - 1, 1.0)));
        let size = whole
            .points
            .iter()
            .map(|h| (bezier::projected(h) - start).norm())
            .fold(0.0, f64::max);
        let shut = (start - end).norm() <= 1e-7 * size;
        let place = |p: &Point3, at_end: bool| {
            let found = whole.closest(p, f64::INFINITY).map_or((0, 0.0), |on| on.at);
            let t = found.0 as f64 + found.1;
            let full = count as f64;
            // Both ends of a closed curve are one place.
            let edge = 1e-9 * full;
            match shut && (t <= edge || t >= full - edge) {
                true if at_end => full,
                true => 0.0,
                false => t,
            }
        };
        let (mut a, mut b) = (place(first, false), place(last, true));
        let full = count as f64;
        if closed {
            b = a + full;
        } else if b <= a && shut {
            b += full;
        } else if b < a {
            // The file's sense is the wrong one: an open curve has one piece between two points.
            let mut points = whole.points.clone();
            points.reverse();
            let back = Self::chain(degree, points, Shape::Free);
            (a, b) = (full - a, full - b);
            return back.part(a, b);
        }
        whole.part(a, b)
    }

    /// Between two parameters that count segments; beyond the last one it begins anew.
    pub fn part(&self, a: f64, b: f64) -> Result<Self, CurveProblem> {
        let count = self.segments();
        let mut points = Vec::new();
        let mut k = a.floor();
        while k < b {
            let within = [(a - k).clamp(0.0, 1.0), (b - k).clamp(0.0, 1.0)];
            if within[1] - within[0] > 1e-12 {
                let segment = self.segment(k as usize % count);
                points.extend(bezier::between(segment, within));
            }
            k += 1.0;
        }
        match points.is_empty() {
            true => Err(CurveProblem::Empty),
            false => Ok(Self::chain(self.degree, points, Shape::Free)),
        }
    }

    pub fn is_line(&self) -> bool {
        self.shape == Shape::Line
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    pub fn segments(&self) -> usize {
        self.points.len() / (self.degree + 1)
    }

    /// Control points by segments.
    pub fn chain_segments(&self) -> Vec<Vec<Homogeneous>> {
        let segments = self.points.chunks(self.degree + 1);
        segments.map(<[Homogeneous]>::to_vec).collect()
    }

    pub fn segment(&self, k: usize) -> &[Homogeneous] {
        let n = self.degree + 1;
        &self.points[k * n..(k + 1) * n]
    }

    pub fn point(&self, (segment, t): (usize, f64)) -> Point3 {
        bezier::point(self.segment(segment), t)
    }

    /// Derivative, not of unit length.
    pub fn slope(&self, (segment, t): (usize, f64)) -> Vector3 {
        bezier::slope(self.segment(segment), t)
    }

    /// Unit tangent at the first point, or at the last one.
    pub fn tangent_at_end(&self, last: bool) -> Vector3 {
        let inward = |t: f64| match last {
            true => (self.segments() - 1, 1.0 - t),
            false => (0, t),
        };
        let at = |t: f64| self.slope(inward(t)).try_normalize(f64::MIN_POSITIVE);
        at(0.0).or_else(|| at(1e-6)).unwrap_or_else(Vector3::x)
    }

    /// Corners of a box around it: the narrowest of lines and circles, that of the control points otherwise.
    pub fn bounds(&self) -> (Point3, Point3) {
        let far = Point3::from(Vector3::repeat(f64::INFINITY));
        let grown = |(low, high): (Point3, Point3), p: Point3| (low.inf(&p), high.sup(&p));
        let Shape::Circle(axes, radius, sweep) = &self.shape else {
            let points = self.points.iter().map(bezier::projected);
            return points.fold((far, -far), grown);
        };
        let at = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            axes.to_world(&Vector3::new(radius * cos, radius * sin, 0.0))
        };
        let mut all = grown(grown((far, -far), at(0.0)), at(*sweep));
        for k in 0..3 {
            // Where it goes farthest along an axis of the world, and opposite.
            let most = libm::atan2(axes.y[k], axes.x[k]);
            for angle in [most, most + TAU / 2.0].map(|angle| super::chart::wrap(angle, TAU)) {
                if angle < *sweep {
                    all = grown(all, at(angle));
                }
            }
        }
        all
    }

    /// Places along it, `count` in each segment and its last one.
    pub fn samples(&self, count: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let last = (self.segments() - 1, 1.0);
        (0..self.segments())
            .flat_map(move |k| (0..count).map(move |i| (k, i as f64 / count as f64)))
            .chain([last])
    }

    /// The closest point, where one is nearer than the root of `ceiling` (m²).
    pub fn closest(&self, q: &Point3, ceiling: f64) -> Option<OnCurve> {
        match &self.shape {
            Shape::Line => {
                let (a, b) = (
                    bezier::projected(&self.points[0]),
                    bezier::projected(&self.points[1]),
                );
                let along = b - a;
                let t = (along.dot(&(q - a)) / along.norm_squared()).clamp(0.0, 1.0);
                let point = if t < 1.0 { a + along * t } else { b };
                on(point, (0, t), q, ceiling)
            }
            Shape::Circle(axes, radius, sweep) => {
                let local = axes.to_local(q);
                let mut angle = libm::atan2(local.y, local.x);
                if angle < 0.0 {
                    angle += TAU;
                }
                if angle > *sweep {
                    angle = if angle - sweep < TAU - angle {
                        *sweep
                    } else {
                        0.0
                    };
                }
                let (sin, cos) = libm::sincos(angle);
                let point = axes.to_world(&Vector3::new(radius * cos, radius * sin, 0.0));
                on(
                    point,
                    circle_place(angle, *sweep, self.segments()),
                    q,
                    ceiling,
                )
            }
            Shape::Free => self.closest_free(q, ceiling),
        }
    }

    /// Segments whose boxes are near, each by [`closest_of_segment`].
    fn closest_free(&self, q: &Point3, mut ceiling: f64) -> Option<OnCurve> {
        let mut best: Option<OnCurve> = None;
        self.tree.nearest(q, &mut ceiling, |k, ceiling| {
            let k = k as usize;
            if let Some((t, squared)) = closest_of_segment(self.segment(k), q, *ceiling) {
                *ceiling = squared;
                best = Some(OnCurve {
                    point: self.point((k, t)),
                    at: (k, t),
                    squared,
                });
            }
        });
        best
    }

    /// Every local minimum of the distance between its ends that is nearer than the root of `ceiling` (m²). One may come twice.
    pub fn minima_within(&self, q: &Point3, ceiling: f64, mut offer: impl FnMut(OnCurve)) {
        match &self.shape {
            Shape::Line | Shape::Circle(..) => {
                let found = self.closest(q, ceiling);
                if let Some(found) = found.filter(|found| self.end(found.at).is_none()) {
                    offer(found);
                }
            }
            Shape::Free => self.rising(
                |k| (squared(&self.boxes[k], q) < ceiling).then(|| turning(self.segment(k), q)),
                |at| {
                    if let Some(found) = on(self.point(at), at, q, ceiling) {
                        offer(found);
                    }
                },
            ),
        }
    }

    /// Places between its ends that are farthest along a unit vector among their neighbours. One may come twice.
    pub fn summits(&self, along: &Vector3, mut offer: impl FnMut((usize, f64))) {
        match &self.shape {
            Shape::Line => {}
            Shape::Circle(axes, _, sweep) => {
                let mut angle = libm::atan2(axes.y.dot(along), axes.x.dot(along));
                if angle < 0.0 {
                    angle += TAU;
                }
                if angle > 0.0 && angle < *sweep {
                    offer(circle_place(angle, *sweep, self.segments()));
                }
            }
            Shape::Free => self.rising(|k| Some(falling(self.segment(k), along)), offer),
        }
    }

    /// The axis of a circle.
    pub fn axis(&self) -> Option<&Vector3> {
        match &self.shape {
            Shape::Circle(axes, ..) => Some(&axes.z),
            Shape::Line | Shape::Free => None,
        }
    }

    /// So many places of a circle, evenly over a whole turn from its first point on, where it has them.
    pub fn round(&self, count: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let sweep = match &self.shape {
            Shape::Circle(_, _, sweep) => *sweep,
            Shape::Line | Shape::Free => 0.0,
        };
        (0..count)
            .map(move |k| TAU * k as f64 / count as f64)
            .take_while(move |angle| *angle < sweep)
            .map(move |angle| circle_place(angle, sweep, self.segments()))
    }

    /// Places between the ends where a derivative, a polynomial for each segment that counts, turns from falling to rising.
    fn rising(
        &self,
        derivative: impl Fn(usize) -> Option<Polynomial>,
        mut offer: impl FnMut((usize, f64)),
    ) {
        let mut fell = false;
        for k in 0..self.segments() {
            let Some(turn) = derivative(k) else {
                fell = false;
                continue;
            };
            let noise = 1e-14 * turn.most();
            let [first, last] = turn.ends();
            // Segments may meet at a corner.
            if fell && first >= -noise {
                offer((k, 0.0));
            }
            rises(&turn, noise, |t| {
                if self.end((k, t)).is_none() {
                    offer((k, t));
                }
            });
            fell = last <= noise;
        }
    }

    /// Whether a place is one of the ends: `Some(true)` for the last.
    pub fn end(&self, (segment, t): (usize, f64)) -> Option<bool> {
        if segment == 0 && t <= 0.0 {
            return Some(false);
        }
        (segment + 1 == self.segments() && t >= 1.0).then_some(true)
    }
}

fn on(point: Point3, at: (usize, f64), q: &Point3, ceiling: f64) -> Option<OnCurve> {
    let squared = (q - point).norm_squared();
    (squared < ceiling).then_some(OnCurve { point, at, squared })
}

/// Where an angle is in a circle's segments, each of which is the same angle.
fn circle_place(angle: f64, sweep: f64, count: usize) -> (usize, f64) {
    if angle >= sweep {
        return (count - 1, 1.0);
    }
    let step = sweep / count as f64;
    let k = ((angle / step) as usize).min(count - 1);
    // tan of a quarter of the step and of the angle from the middle: the parameter of a rational quadratic.
    let half = 0.5 * step;
    let from_middle = angle - k as f64 * step - half;
    let t = 0.5 + 0.5 * libm::tan(0.5 * from_middle) / libm::tan(0.5 * half);
    (k, t.clamp(0.0, 1.0))
}

/// The nearest place of a segment that is nearer than the root of `ceiling`, and its squared distance.
///
/// The derivative of the squared distance is a polynomial over a positive one. Where its Bernstein coefficients change
/// sign once at most, there is one minimum at most; else the part is halved.
fn closest_of_segment(points: &[Homogeneous], q: &Point3, ceiling: f64) -> Option<(f64, f64)> {
    let turn = turning(points, q);
    let noise = 1e-14 * turn.most();
    let mut best = (None, ceiling);
    let offer = |t: f64, best: &mut (Option<f64>, f64)| {
        let squared = (bezier::point(points, t) - q).norm_squared();
        if squared < best.1 {
            *best = (Some(t), squared);
        }
    };
    offer(0.0, &mut best);
    offer(1.0, &mut best);
    rises(&turn, noise, |t| offer(t, &mut best));
    best.0.map(|t| (t, best.1))
}

/// Where a polynomial on [0, 1] turns from negative to positive, as far as its values exceed the noise.
fn rises(turn: &Polynomial, noise: f64, mut offer: impl FnMut(f64)) {
    let mut waiting = [(*turn, 0.0, 1.0); MOST_WAITING];
    let mut count = 1;
    while count > 0 {
        count -= 1;
        let (part, t0, t1) = waiting[count];
        let changes = part.variations(noise);
        if changes <= 1 || count + 2 > MOST_WAITING {
            let [first, last] = part.ends();
            if first <= noise && last >= -noise {
                offer(t0 + (t1 - t0) * part.root());
            }
            continue;
        }
        let middle = 0.5 * (t0 + t1);
        let [low, high] = part.halves();
        waiting[count] = (high, middle, t1);
        waiting[count + 1] = (low, t0, middle);
        count += 2;
    }
}

/// Parts of a segment that wait at once: each is half as long as the one before.
const MOST_WAITING: usize = 32;

/// Half the derivative of the squared distance to a point, times a power of the weight.
fn turning(points: &[Homogeneous], q: &Point3) -> Polynomial {
    let weight = Polynomial::of(points, 3);
    let rational = points.iter().any(|h| h[3] != 1.0);
    let mut all: Option<Polynomial> = None;
    for k in 0..3 {
        let mut away = Polynomial::of(points, k);
        away.add(-q[k], &weight);
        let mut term = away.times(&away.derivative());
        if rational {
            term = term.times(&weight);
            term.add(-1.0, &away.times(&away).times(&weight.derivative()));
        }
        match &mut all {
            Some(all) => all.add(1.0, &term),
            None => all = Some(term),
        }
    }
    all.unwrap_or(weight)
}

/// The derivative of the height against a direction, times a power of the weight.
fn falling(points: &[Homogeneous], along: &Vector3) -> Polynomial {
    let weight = Polynomial::of(points, 3);
    let far: Polynomial = points
        .iter()
        .map(|h| -(0..3).map(|k| along[k] * h[k]).sum::<f64>())
        .collect();
    if points.iter().all(|h| h[3] == 1.0) {
        return far.derivative();
    }
    let mut turn = far.derivative().times(&weight);
    turn.add(-1.0, &far.times(&weight.derivative()));
    turn
}

/// The box around control points.
fn around(points: &[Homogeneous]) -> Corners {
    let far = Point3::from(Vector3::repeat(f64::INFINITY));
    let grown = |(low, high): Corners, p: Point3| (low.inf(&p), high.sup(&p));
    points
        .iter()
        .map(bezier::projected)
        .fold((far, -far), grown)
}

fn weighted(p: &Point3, w: f64) -> Homogeneous {
    [p.x * w, p.y * w, p.z * w, w]
}

/// The axes of a circle, turned over where it is traversed backwards (`along` is false).
fn turned(axes: &Axes, along: bool) -> Axes {
    match along {
        true => *axes,
        false => Axes {
            y: -axes.y,
            z: -axes.z,
            ..*axes
        },
    }
}

/// From one angle on to another, within (0, 2π]; a whole turn where the ends are one place.
fn sweep(from: f64, to: f64, whole: bool) -> f64 {
    let mut sweep = to - from;
    while sweep <= 0.0 {
        sweep += TAU;
    }
    if whole { TAU } else { sweep }
}

/// An elliptic arc as rational quadratics of a quarter turn at most.
fn arc(axes: &Axes, [a, b]: [f64; 2], from: f64, sweep: f64) -> Vec<Homogeneous> {
    let count = (sweep / FRAC_PI_2 - 1e-9).ceil().max(1.0);
    let step = sweep / count;
    let w = libm::cos(0.5 * step);
    let mut points = Vec::new();
    for k in 0..count as usize {
        let t = from + step * k as f64;
        let at = |t: f64, over: f64| {
            let (sin, cos) = libm::sincos(t);
            axes.to_world(&Vector3::new(a * cos / over, b * sin / over, 0.0))
        };
        points.push(weighted(&at(t, 1.0), 1.0));
        points.push(weighted(&at(t + 0.5 * step, w), w));
        points.push(weighted(&at(t + step, 1.0), 1.0));
    }
    points
}

/// A hyperbola's or parabola's piece as one rational quadratic.
fn conic(
    axes: &Axes,
    [from, to]: [f64; 2],
    at: impl Fn(f64) -> Vector3,
    slope: impl Fn(f64) -> Vector3,
    weight: impl Fn(f64) -> f64,
) -> Result<EdgeCurve, CurveProblem> {
    if from == to {
        return Err(CurveProblem::Empty);
    }
    // Where the tangents at both ends cross.
    let (a, b, da, db) = (at(from), at(to), slope(from), slope(to));
    let across = da.x * db.y - da.y * db.x;
    let s = ((b.x - a.x) * db.y - (b.y - a.y) * db.x) / across;
    let w = weight(to - from);
    let [a, m, b] = [a, a + da * s, b].map(|p| axes.to_world(&p));
    let points = vec![weighted(&a, 1.0), weighted(&m, w), weighted(&b, 1.0)];
    Ok(EdgeCurve::chain(2, points, Shape::Free))
}

/// The piece of a curve between two of its points, as rational Bézier segments; see [`EdgeCurve::new`].
pub(crate) fn chain_of(
    curve: &BrepCurve,
    along: bool,
    ends: [&Point3; 2],
    closed: bool,
) -> Result<Vec<Vec<Homogeneous>>, CurveProblem> {
    let piece = EdgeCurve::new(curve, along, ends, closed)?;
    Ok(piece.chain_segments())
}

/// The piece of a B-spline from one parameter of its domain to another, against the curve if not `along`. Where they come in
/// the other order, it goes on past the end of a closed curve; of an open one it is what lies between them.
pub(crate) fn chain_between(
    curve: &Curve,
    along: bool,
    [from, to]: [f64; 2],
) -> Vec<Vec<Homogeneous>> {
    let (degree, points) = segments(curve);
    let whole = EdgeCurve::chain(degree, points, Shape::Free);
    let t = curve.knots().knots();
    let spans: Vec<[f64; 2]> = (curve.knots().spans())
        .map(|span| [t[span], t[span + 1]])
        .collect();
    let place = |x: f64| {
        let k = spans.partition_point(|span| span[1] < x);
        match spans.get(k) {
            Some([a, b]) => k as f64 + ((x - a) / (b - a)).clamp(0.0, 1.0),
            None => spans.len() as f64,
        }
    };
    let [mut a, mut b] = if along { [from, to] } else { [to, from] }.map(place);
    let full = whole.segments() as f64;
    if b <= a {
        let ends = [
            whole.point((0, 0.0)),
            whole.point((whole.segments() - 1, 1.0)),
        ];
        let size_m = (whole.points.iter())
            .map(|h| (bezier::projected(h) - ends[0]).norm())
            .fold(0.0, f64::max);
        match (ends[0] - ends[1]).norm() <= 1e-7 * size_m {
            true => b += full,
            false => (a, b) = (b, a),
        }
    }
    let mut pieces = whole
        .part(a, b)
        .map_or_else(|_| Vec::new(), |part| part.chain_segments());
    if !along {
        pieces.reverse();
        pieces.iter_mut().for_each(|piece| piece.reverse());
    }
    pieces
}

/// The Bézier segments of a B-spline, and their degree.
fn segments(curve: &Curve) -> (usize, Vec<Homogeneous>) {
    let knots = curve.knots();
    let degree = knots.degree();
    let count = curve.points().len();
    let at = |k: usize| {
        weighted(
            &curve.points()[k % count],
            curve.weights().map_or(1.0, |w| w[k % count]),
        )
    };
    let mut points = Vec::new();
    for span in knots.spans() {
        let t = knots.knots();
        let rows = extraction(t, degree, span, [t[span], t[span + 1]]);
        for row in rows.chunks(degree + 1) {
            let mut h = [0.0; 4];
            for (k, share) in row.iter().enumerate() {
                let p = at(span - degree + k);
                for (x, y) in h.iter_mut().zip(p) {
                    *x += share * y;
                }
            }
            points.push(h);
        }
    }
    (degree, points)
}
