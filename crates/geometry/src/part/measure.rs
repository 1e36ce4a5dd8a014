//! Area and volume of faces by integrals over their loops: Green's theorem in the parameters, then the divergence theorem.
//!
//! A face is where base + crossings is 1, so ∬ f du dv = ∫ base(u) F(u, top) du − Σ ∫ F(u, v) du over the arcs, with
//! F(u, v) = ∫ f dv from a fixed line. No triangle comes into it: the error is that of the quadrature and of the gaps.

use super::bezier;
use super::carrier::Carrier;
use super::part::{Face, Part};
use super::trim::{Trim, Walk};
use crate::basis::KnotVector;
use crate::math::{Matrix3, Point3, Vector3, gauss_legendre};
use std::f64::consts::FRAC_PI_4;

/// Points of the rule on a piece of an arc, and between two breaks on the way across.
const POINTS: usize = 16;
/// Points where the pieces, or the intervals between breaks, are many and short.
const FEW_POINTS: usize = 7;
const MANY_WALKS: usize = 200;
const MANY_BREAKS: usize = 8;

/// Both rules.
struct Rules([Vec<(f64, f64)>; 2]);

impl Rules {
    fn for_walks(&self, count: usize) -> &[(f64, f64)] {
        &self.0[usize::from(count > MANY_WALKS)]
    }

    fn for_breaks(&self, breaks: &Breaks) -> &[(f64, f64)] {
        let many = matches!(breaks, Breaks::Knots(_, spans) if *spans > MANY_BREAKS);
        &self.0[usize::from(many)]
    }
}

/// Areas and volume of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMeasure {
    /// By face, m².
    pub face_areas_m2: Vec<f64>,
    /// All of them, m².
    pub area_m2: f64,
    /// Within the faces, m³; `None` for parts without an inside.
    pub volume_m3: Option<f64>,
}

/// Moments of the space within the faces, about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartMoments {
    /// The middle of the box around the part, m.
    pub about: Point3,
    /// m³.
    pub volume_m3: f64,
    /// ∫ x dV, m⁴.
    pub first: Vector3,
    /// ∫ x xᵀ dV, m⁵.
    pub second: Matrix3,
}

impl Part {
    /// Volume, first and second moments by the divergence theorem: V = ⅓ ∮ x · n, ∫ xᵢ = ½ ∮ xᵢ² nᵢ, ∫ xᵢ² = ⅓ ∮ xᵢ³ nᵢ,
    /// ∫ xᵢ xⱼ = ½ ∮ xᵢ² xⱼ nᵢ. `None` for parts without an inside.
    pub fn moments(&self) -> Option<PartMoments> {
        if !self.is_closed() {
            return None;
        }
        let rules = Rules([POINTS, FEW_POINTS].map(gauss_legendre));
        let (low, high) = self.bounds();
        let about = nalgebra::center(&low, &high);
        let over = |f: &dyn Fn(&Vector3, &Vector3) -> f64| -> f64 {
            let faces = self.faces.iter().map(|face| {
                let sense = if face.same_sense { 1.0 } else { -1.0 };
                sense * face.integral(&rules, |point, across| f(&(point - about), across))
            });
            faces.sum()
        };
        let mixed = |i: usize, j: usize| match i == j {
            true => over(&|x, n| x[i] * x[i] * x[i] * n[i] / 3.0),
            // Both orders are exact: their mean is symmetric.
            false => over(&|x, n| 0.25 * x[i] * x[j] * (x[i] * n[i] + x[j] * n[j])),
        };
        let [xx, xy, xz, yy, yz, zz] =
            [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| mixed(i, j));
        Some(PartMoments {
            about,
            volume_m3: over(&|x, n| x.dot(n) / 3.0),
            first: Vector3::from([0, 1, 2].map(|i| over(&|x, n| 0.5 * x[i] * x[i] * n[i]))),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        })
    }

    /// Areas of the faces and the volume within.
    pub fn measure(&self) -> PartMeasure {
        let rules = Rules([POINTS, FEW_POINTS].map(gauss_legendre));
        let (low, high) = self.bounds();
        let middle = nalgebra::center(&low, &high);
        let areas: Vec<f64> = (self.faces.iter())
            .map(|face| face.integral(&rules, |_, across| across.norm()))
            .collect();
        let volumes = self.faces.iter().map(|face| {
            let sense = if face.same_sense { 1.0 } else { -1.0 };
            sense * face.integral(&rules, |point, across| (point - middle).dot(across) / 3.0)
        });
        PartMeasure {
            area_m2: areas.iter().sum(),
            volume_m3: self.is_closed().then(|| volumes.sum()),
            face_areas_m2: areas,
        }
    }
}

impl Face {
    /// The integral of a function of S and S_u × S_v over the face's parameters.
    fn integral(&self, rules: &Rules, f: impl Fn(&Point3, &Vector3) -> f64) -> f64 {
        let rule = rules.for_walks(self.trim.walks().count());
        let value = |u: f64, v: f64| {
            let uv = self.trim.chart.confined([u, v]);
            let (point, across) = self.carrier.element(uv);
            f(&point, &across)
        };
        let breaks = self.carrier.breaks();
        let chart = &self.trim.chart;
        let [ou, ov] = chart.origin;
        let low = self.trim.bottom();
        let inner = |u: f64, v: f64| {
            over(
                rules.for_breaks(&breaks[1]),
                &breaks[1],
                [low + ov, v + ov],
                |v| value(u + ou, v),
            )
        };
        let level = |walk: &Walk<'_>| {
            let ends = walk.u.map(|u| u + ou);
            let rule = rules.for_breaks(&breaks[0]);
            over(rule, &breaks[0], ends, |u| inner(u - ou, walk.v))
        };
        let arcs: f64 = (self.trim.walks())
            .map(|walk| match walk.points {
                Some(points) => walk.integral(points, rule, chart, &inner),
                None => level(&walk),
            })
            .sum();
        let mut base = 0.0;
        for ([from, to], count) in self.trim.bases() {
            if let (true, Some(top)) = (count != 0, self.carrier.top(&self.trim)) {
                let across = |u: f64| inner(u - ou, top);
                base += f64::from(count)
                    * over(
                        rules.for_breaks(&breaks[0]),
                        &breaks[0],
                        [from + ou, to + ou],
                        across,
                    );
            }
        }
        base - arcs
    }
}

/// An integral in pieces that end at breaks.
fn over(rule: &[(f64, f64)], breaks: &Breaks, [from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let (low, high, sign) = if from <= to {
        (from, to, 1.0)
    } else {
        (to, from, -1.0)
    };
    let mut total = 0.0;
    let mut a = low;
    while a < high {
        let b = breaks.after(a).min(high);
        let half = 0.5 * (b - a);
        total += half
            * rule
                .iter()
                .map(|(x, w)| w * f(a + half * (1.0 + x)))
                .sum::<f64>();
        a = b;
    }
    sign * total
}

/// Where a carrier is divided for quadrature.
enum Breaks {
    /// Nowhere.
    None,
    /// At multiples of an angle.
    Angle,
    /// At knots; how many spans the domain has.
    Knots(Vec<f64>, usize),
}

impl Breaks {
    fn after(&self, x: f64) -> f64 {
        match self {
            Self::None => f64::INFINITY,
            Self::Angle => x + FRAC_PI_4,
            Self::Knots(knots, _) => {
                let k = knots.partition_point(|&k| k <= x);
                knots.get(k).copied().unwrap_or(f64::INFINITY)
            }
        }
    }
}

impl Carrier {
    /// S and S_u × S_v.
    fn element(&self, [u, v]: [f64; 2]) -> (Point3, Vector3) {
        let uv = [u, v];
        if let Self::Spline(surface) = self {
            let frame = surface.frame(uv[0], uv[1]);
            return (frame.point, frame.du.cross(&frame.dv));
        }
        let stretch = match self {
            Self::Plane(_) | Self::Spline(_) => 1.0,
            Self::Cylinder { radius_m, .. } => *radius_m,
            Self::Cone { half_angle_rad, .. } => {
                v * libm::tan(*half_angle_rad) / libm::cos(*half_angle_rad)
            }
            Self::Sphere { radius_m, .. } => radius_m * radius_m * libm::cos(v),
            Self::Torus {
                major_m, minor_m, ..
            } => minor_m * (major_m + minor_m * libm::cos(v)),
        };
        (self.point(uv), self.normal(uv) * stretch)
    }

    fn breaks(&self) -> [Breaks; 2] {
        match self {
            Self::Plane(_) => [Breaks::None, Breaks::None],
            Self::Cylinder { .. } | Self::Cone { .. } => [Breaks::Angle, Breaks::None],
            Self::Sphere { .. } | Self::Torus { .. } => [Breaks::Angle, Breaks::Angle],
            Self::Spline(surface) => {
                let periods = self.periods();
                let breaks = |knots: &KnotVector, period: f64| {
                    let own: Vec<f64> = knots.spans().map(|i| knots.knots()[i]).collect();
                    let spans = own.len();
                    // Parameters go on past the ends of a period, from where the chart cuts it.
                    let turns = if period > 0.0 { -1..3 } else { 0..1 };
                    let all = turns.flat_map(|turn: i8| {
                        let shift = f64::from(turn) * period;
                        own.iter().map(move |knot| knot + shift)
                    });
                    Breaks::Knots(all.collect(), spans)
                };
                [
                    breaks(surface.knots_u(), periods[0]),
                    breaks(surface.knots_v(), periods[1]),
                ]
            }
        }
    }

    /// The v up to which the base counts, where there is an end; as the chart has it.
    fn top(&self, trim: &Trim) -> Option<f64> {
        let period = trim.chart.periods[1];
        match self {
            Self::Plane(_) | Self::Cylinder { .. } | Self::Cone { .. } => None,
            Self::Sphere { .. } => Some(std::f64::consts::FRAC_PI_2),
            Self::Torus { .. } => trim.chart.poles()[1].or(Some(period)),
            Self::Spline(surface) if period == 0.0 => {
                let (low, high) = surface.knots_v().domain();
                Some(high - low)
            }
            Self::Spline(_) => Some(period),
        }
    }
}

impl Walk<'_> {
    /// ∫ F(u, v) du along its segment.
    fn integral(
        &self,
        (points, [from, to]): (&[bezier::Homogeneous], [f64; 2]),
        rule: &[(f64, f64)],
        chart: &super::chart::Chart,
        f: &impl Fn(f64, f64) -> f64,
    ) -> f64 {
        if self.u[0] == self.u[1] || from == to {
            return 0.0;
        }
        let progress = chart.progress(points);
        let half = 0.5 * (to - from);
        let at = |x: f64| {
            let t = from + half * (1.0 + x);
            let h = bezier::evaluate(points, t).0;
            let [u, v] = chart.reduced(chart.raw(&h));
            let over = match chart.is_flat() {
                true => h[3] * h[3],
                false => h[0] * h[0] + h[1] * h[1],
            };
            let v = super::chart::lifted(v, self.v, chart.periods[1]);
            f(u, v) * progress.value(t) / over
        };
        half * rule.iter().map(|&(x, w)| w * at(x)).sum::<f64>()
    }
}
