//! How a face's parameters are measured when it is divided: in steps that its curvature allows.

use super::super::carrier::Carrier;
use super::super::chart::{lifted, wrap};
use crate::math::{Point3, Vector3};
use crate::surface::{BezierPieces, Surface};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How finely a part is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// How far triangles may be from their faces, m.
    pub tolerance_m: f64,
    /// Triangles at most.
    pub most: usize,
    /// Distance of points within planes, m; `None`: planes have points on their edges only.
    pub plane_step_m: Option<f64>,
}

/// A step, of the one whose sagitta is the tolerance.
const STEP: f64 = 0.7;
/// Of a period: how near to the line at which it is cut a place is on it.
const ON_CUT: f64 = 1e-9;
/// Least steps of a whole turn.
const LEAST_TURN: f64 = 8.0;

/// A parameter in steps: straight between stops.
#[derive(Clone, Debug)]
pub(super) struct Ruler {
    /// Parameters, ascending.
    stops: Vec<f64>,
    /// Steps at the stops, from 0.
    marks: Vec<f64>,
    /// 0 where the parameter is not cut; its stops are a period then.
    pub period: f64,
}

impl Ruler {
    /// Even steps.
    fn even([low, high]: [f64; 2], steps: f64, period: f64) -> Self {
        Self {
            stops: vec![low, high],
            marks: vec![0.0, steps],
            period,
        }
    }

    pub fn low(&self) -> f64 {
        self.stops[0]
    }

    pub fn high(&self) -> f64 {
        self.stops[self.stops.len() - 1]
    }

    /// Steps in all: a whole number, but on planes.
    pub fn steps(&self) -> f64 {
        self.marks[self.marks.len() - 1]
    }

    pub fn mark(&self, x: f64) -> f64 {
        interpolated(&self.stops, &self.marks, x)
    }

    pub fn parameter(&self, mark: f64) -> f64 {
        interpolated(&self.marks, &self.stops, mark)
    }

    /// The representative of x near a place within the stops, at a stop's very number where it is on the cut.
    pub fn near(&self, x: f64, near: f64) -> f64 {
        if self.period == 0.0 {
            return x;
        }
        let y = lifted(x, near, self.period);
        let ends = [self.low(), self.high()];
        let end = ends
            .into_iter()
            .find(|end| (y - end).abs() <= ON_CUT * self.period);
        end.unwrap_or(y)
    }

    /// The representative of x within the stops.
    pub fn within(&self, x: f64) -> f64 {
        match self.period {
            0.0 => x,
            period => self.low() + wrap(x - self.low(), period),
        }
    }

    /// Signed distance from the nearest cut, in periods.
    pub fn beside_cut(&self, x: f64) -> f64 {
        let y = (x - self.low()) / self.period;
        y - y.round()
    }

    /// Whether such a distance is none.
    pub fn is_on_cut(beside: f64) -> bool {
        beside.abs() <= ON_CUT
    }

    /// A place on the cut.
    pub fn is_end(&self, x: f64) -> bool {
        self.period > 0.0 && (x == self.low() || x == self.high())
    }
}

fn interpolated(from: &[f64], to: &[f64], x: f64) -> f64 {
    let k = from.partition_point(|&s| s <= x).clamp(1, from.len() - 1) - 1;
    let (a, b) = (from[k], from[k + 1]);
    if x == b {
        return to[k + 1];
    }
    match b > a {
        true => to[k] + (x - a) / (b - a) * (to[k + 1] - to[k]),
        false => to[k],
    }
}

/// Periods by which a carrier is cut: of a self-crossing torus, whose outer part alone is meant, none of v.
pub(super) fn periods(carrier: &Carrier) -> [f64; 2] {
    match carrier {
        Carrier::Torus {
            major_m, minor_m, ..
        } if major_m < minor_m => [TAU, 0.0],
        Carrier::Plane(_) | Carrier::Sphere { .. } => [0.0; 2],
        carrier => carrier.periods(),
    }
}

/// Values of v, or of u, along which all points are one: direction, value.
pub(super) fn poles(carrier: &Carrier) -> Vec<(usize, f64)> {
    match carrier {
        Carrier::Cone { .. } => vec![(1, 0.0)],
        Carrier::Torus {
            major_m, minor_m, ..
        } if major_m < minor_m => {
            let v = libm::acos(-major_m / minor_m);
            vec![(1, -v), (1, v)]
        }
        Carrier::Spline(surface) => spline_poles(surface),
        _ => Vec::new(),
    }
}

fn spline_poles(surface: &Surface) -> Vec<(usize, f64)> {
    let found = surface.topology().poles;
    let domains = [surface.knots_u().domain(), surface.knots_v().domain()];
    let mut out = Vec::new();
    for k in 0..2 {
        // topology().poles[k]: the edge at which parameter k is at an end is a point.
        let ends = [domains[k].0, domains[k].1];
        out.extend((0..2).filter(|&e| found[k][e]).map(|e| (k, ends[e])));
    }
    out
}

/// Rulers of both parameters over a range, fine enough for a tolerance; `finer` times as many steps.
pub(super) fn rulers(
    carrier: &Carrier,
    range: [[f64; 2]; 2],
    cut: [f64; 2],
    fineness: &Fineness,
    finer: f64,
) -> [Ruler; 2] {
    let tolerance_m = fineness.tolerance_m;
    let [u, v] = range;
    let turn = |radius: f64, width: f64| {
        let step = sagitta_step(radius, tolerance_m).min(TAU / LEAST_TURN);
        (finer * width / step).ceil().max(1.0)
    };
    match carrier {
        Carrier::Plane(_) | Carrier::Sphere { .. } => {
            let [a, b] = [u[1] - u[0], v[1] - v[0]];
            let most = a.max(b).max(f64::MIN_POSITIVE);
            let step = fineness.plane_step_m.map_or(most, |step| step.min(most));
            [
                Ruler::even(u, a / step, cut[0]),
                Ruler::even(v, b / step, cut[1]),
            ]
        }
        Carrier::Cylinder { radius_m, .. } => [
            Ruler::even(u, turn(*radius_m, u[1] - u[0]), cut[0]),
            Ruler::even(v, 1.0, cut[1]),
        ],
        Carrier::Cone { half_angle_rad, .. } => {
            let radius = v[1].max(v[0]) * libm::tan(*half_angle_rad);
            [
                Ruler::even(u, turn(radius, u[1] - u[0]), cut[0]),
                Ruler::even(v, 1.0, cut[1]),
            ]
        }
        Carrier::Torus {
            major_m, minor_m, ..
        } => [
            Ruler::even(u, turn(major_m + minor_m, u[1] - u[0]), cut[0]),
            Ruler::even(v, turn(*minor_m, v[1] - v[0]), cut[1]),
        ],
        Carrier::Spline(surface) => spline_rulers(surface, range, cut, tolerance_m, finer),
    }
}

/// The angle that such a chord spans.
pub(super) fn sagitta_step(radius_m: f64, tolerance_m: f64) -> f64 {
    STEP * (8.0 * tolerance_m / radius_m.max(tolerance_m)).sqrt()
}

/// Steps of each span by the second derivatives over it (Filip, Magedson & Markot 1986).
fn spline_rulers(
    surface: &Surface,
    range: [[f64; 2]; 2],
    cut: [f64; 2],
    tolerance_m: f64,
    finer: f64,
) -> [Ruler; 2] {
    let pieces = BezierPieces::new(surface);
    let knots = [surface.knots_u(), surface.knots_v()];
    let spans = knots.map(|knots| {
        let t = knots.knots();
        knots.spans().map(|k| [t[k], t[k + 1]]).collect::<Vec<_>>()
    });
    let mut steps = [vec![1.0f64; spans[0].len()], vec![1.0f64; spans[1].len()]];
    let meets = |k: usize, span: &[f64; 2]| {
        cut[k] > 0.0 || span[1] >= range[k][0] && span[0] <= range[k][1]
    };
    for (i, a) in spans[0].iter().enumerate() {
        for (j, b) in spans[1].iter().enumerate() {
            if meets(0, a) && meets(1, b) {
                let [uu, uv, vv] = pieces.second_derivative_bounds(i * spans[1].len() + j);
                steps[0][i] = steps[0][i].max(((uu + uv) / (4.0 * tolerance_m)).sqrt());
                steps[1][j] = steps[1][j].max(((vv + uv) / (4.0 * tolerance_m)).sqrt());
            }
        }
    }
    std::array::from_fn(|k| {
        let mut stops = vec![range[k][0]];
        let mut marks = vec![0.0];
        for (span, count) in spans[k].iter().zip(&steps[k]) {
            let [low, high] = [span[0].max(range[k][0]), span[1].min(range[k][1])];
            if high > low {
                let share = (high - low) / (span[1] - span[0]);
                let mark = marks[marks.len() - 1] + (finer * count * share).ceil();
                stops.push(high);
                marks.push(mark);
            }
        }
        if stops.len() == 1 {
            return Ruler::even(range[k], 1.0, cut[k]);
        }
        if cut[k] > 0.0 && marks[marks.len() - 1] < LEAST_TURN {
            let more = (LEAST_TURN / marks[marks.len() - 1]).ceil();
            marks.iter_mut().for_each(|mark| *mark *= more);
        }
        Ruler {
            stops,
            marks,
            period: cut[k],
        }
    })
}

/// Places of a sphere in a plane, from a point of it that is no place of the face: circles stay circles, so that
/// triangles of Delaunay's in the plane are those of the sphere, and poles are places like others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Unit vectors along the sphere's axes; the last one leads to the point.
    frame: [Vector3; 3],
}

impl Plane {
    pub fn from(point: Vector3) -> Self {
        let least = Vector3::ith(point.iamin(), 1.0);
        let x = (least - point * point.dot(&least)).normalize();
        // x × y is the way out of the sphere at the other end, so that turns keep their sense.
        Self {
            frame: [x, x.cross(&point), point],
        }
    }

    /// Of a direction from the centre.
    pub fn place(&self, to: &Vector3) -> [f64; 2] {
        let [x, y, z] = self.frame.map(|axis| axis.dot(to));
        let below = match z > 0.0 {
            true => (x * x + y * y) / (1.0 + z),
            false => 1.0 - z,
        };
        [x / below, y / below]
    }
}

/// Directions that cover a rectangle of longitudes and latitudes about evenly, poles included; `None` where there are
/// more than so many.
pub(super) fn lattice(extent: &[[f64; 2]; 2], step: f64, most: usize) -> Option<Vec<[f64; 2]>> {
    let [u, v] = *extent;
    let rows = ((v[1] - v[0]) / (0.9 * step)).ceil().max(2.0);
    let full = (u[1] - u[0]) / step;
    let count = rows * (1.0 + 0.6 * full);
    if count.is_nan() || count > 4.0 * most as f64 + 1e4 {
        return None;
    }
    let mut out = Vec::new();
    for j in 0..=rows as usize {
        let at = v[0] + (v[1] - v[0]) * j as f64 / rows;
        if FRAC_PI_2 - at.abs() < 1e-9 {
            out.push([0.0, FRAC_PI_2.copysign(at)]);
            continue;
        }
        let count = (full * libm::cos(at)).ceil().max(3.0);
        let shift = if j % 2 == 1 { 0.5 } else { 0.0 };
        out.extend((0..count as usize).map(|i| {
            let share = (i as f64 + shift) / count;
            [u[0] + (u[1] - u[0]) * share, at]
        }));
    }
    Some(out)
}

/// The direction of a longitude and a latitude.
pub(super) fn direction([u, v]: [f64; 2]) -> Vector3 {
    let ((sin, cos), (up, out)) = (libm::sincos(u), libm::sincos(v));
    Vector3::new(out * cos, out * sin, up)
}

/// The distance from a point to a chord, m.
pub(super) fn off_chord(p: &Point3, [a, b]: [&Point3; 2]) -> f64 {
    let along = b - a;
    let t = along.dot(&(p - a)) / along.norm_squared();
    let t = if t.is_finite() {
        t.clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + along * t - p).norm()
}
