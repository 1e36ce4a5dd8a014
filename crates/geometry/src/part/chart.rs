//! The parameter plane of a carrier, as loops see it: how a point of a curve is mapped, periods, where v is cut.

use super::bezier::{self, Homogeneous, Polynomial};
use super::carrier::{Axes, Carrier};
use crate::math::Point3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// How homogeneous points become parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Map {
    /// u = x / w, v = y / w.
    Flat,
    /// u about z; v along z.
    Cylinder,
    /// The sine and cosine of half the angle at the apex.
    Cone(f64, f64),
    /// v the latitude.
    Sphere,
    /// Radius of the tube's centre line, m, and v where the outer part of a self-crossing one ends.
    Torus(f64, Option<f64>),
}

/// The parameters of a carrier: u from 0 to its period, v from the cut to a period above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chart {
    pub map: Map,
    /// 0 where there is none.
    pub periods: [f64; 2],
    /// Where u and v begin, in the carrier's parameters.
    pub origin: [f64; 2],
    /// Of the carrier, if it is elementary.
    axes: Option<Axes>,
    /// Of a B-spline: low and high of u and of v.
    pub domain: Option<[[f64; 2]; 2]>,
}

impl Chart {
    pub fn new(carrier: &Carrier) -> Self {
        let map = match carrier {
            Carrier::Plane(_) | Carrier::Spline(_) => Map::Flat,
            Carrier::Cylinder { .. } => Map::Cylinder,
            Carrier::Cone { half_angle_rad, .. } => {
                let (sin, cos) = libm::sincos(*half_angle_rad);
                Map::Cone(sin, cos)
            }
            Carrier::Sphere { .. } => Map::Sphere,
            Carrier::Torus {
                major_m, minor_m, ..
            } => Map::Torus(
                *major_m,
                (minor_m > major_m).then(|| libm::acos(-major_m / minor_m)),
            ),
        };
        let origin = match carrier {
            Carrier::Spline(s) => [s.knots_u().domain().0, s.knots_v().domain().0],
            _ => [0.0, 0.0],
        };
        Self {
            map,
            periods: carrier.periods(),
            origin,
            axes: carrier.axes().copied(),
            domain: match carrier {
                Carrier::Spline(s) => Some([s.knots_u(), s.knots_v()].map(|k| {
                    let (low, high) = k.domain();
                    [low, high]
                })),
                _ => None,
            },
        }
    }

    /// The carrier has no edge and no end.
    pub fn is_bounded(&self) -> bool {
        match self.map {
            Map::Sphere | Map::Torus(..) => true,
            Map::Flat => self.periods[0] > 0.0,
            Map::Cylinder | Map::Cone(..) => false,
        }
    }

    pub fn is_flat(&self) -> bool {
        self.map == Map::Flat
    }

    /// Control points of a curve in space, along the carrier's axes.
    pub fn local(&self, points: &[Homogeneous]) -> Vec<Homogeneous> {
        let Some(axes) = &self.axes else {
            return points.to_vec();
        };
        let turned = |h: &Homogeneous| {
            let local = axes.to_local(&bezier::projected(h)) * h[3];
            [local.x, local.y, local.z, h[3]]
        };
        points.iter().map(turned).collect()
    }

    /// (u, v) of a point along the axes, before origin and periods.
    pub fn raw(&self, h: &Homogeneous) -> [f64; 2] {
        let Point3 { coords: p } = bezier::projected(h);
        let rho = || libm::hypot(p.x, p.y);
        let v = match self.map {
            Map::Flat => return [p.x, p.y],
            Map::Cylinder => p.z,
            Map::Cone(sin, cos) => (rho() * sin + p.z * cos) * cos,
            Map::Sphere => libm::atan2(p.z, rho()),
            Map::Torus(major, _) => libm::atan2(p.z, rho() - major),
        };
        [libm::atan2(p.y, p.x), v]
    }

    /// Parameters of the carrier as loops count them: within the periods.
    pub fn reduced(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [
            wrap(u - self.origin[0], self.periods[0]),
            wrap(v - self.origin[1], self.periods[1]),
        ]
    }

    /// Parameters of a B-spline within its domain, as near as they can be; others as they are.
    pub fn confined(&self, uv: [f64; 2]) -> [f64; 2] {
        let Some(domain) = self.domain else {
            return uv;
        };
        std::array::from_fn(|k| {
            let [low, high] = domain[k];
            match self.periods[k] {
                0.0 => uv[k].clamp(low, high),
                _ if (low..=high).contains(&uv[k]) => uv[k],
                period => low + wrap(uv[k] - low, period),
            }
        })
    }

    /// v where all the points of one u meet: below and above.
    pub fn poles(&self) -> [Option<f64>; 2] {
        match self.map {
            Map::Cone(..) => [Some(0.0), None],
            Map::Sphere => [Some(-FRAC_PI_2), Some(FRAC_PI_2)],
            Map::Torus(_, end) => [end.map(|v| -v), end],
            Map::Flat | Map::Cylinder => [None, None],
        }
    }

    /// The polynomial whose sign says on which side of a line u = const the curve is, positive above.
    pub fn beside(&self, points: &[Homogeneous], u: f64) -> Polynomial {
        let u = u + self.origin[0];
        let (sin, cos) = libm::sincos(u);
        let flat = self.is_flat();
        let side = |h: &Homogeneous| match flat {
            true => h[0] - u * h[3],
            false => cos * h[1] - sin * h[0],
        };
        points.iter().map(side).collect()
    }

    /// The polynomial whose sign is that of du/dt.
    pub fn progress(&self, points: &[Homogeneous]) -> Polynomial {
        let [a, b] = if self.is_flat() { [3, 0] } else { [0, 1] };
        let [a, b] = [a, b].map(|k| Polynomial::of(points, k));
        let mut forth = a.times(&b.derivative());
        forth.add(-1.0, &a.derivative().times(&b));
        forth
    }

    /// A whole turn of u, or what a step of u may be: where less is sure to be the shorter way round.
    pub fn step(&self, direction: usize) -> f64 {
        match self.periods[direction] {
            0.0 => f64::INFINITY,
            period => period * (1.0 / TAU),
        }
    }
}

/// `x` brought into [0, period); unchanged where the period is 0.
pub(super) fn wrap(x: f64, period: f64) -> f64 {
    if period == 0.0 || (0.0..period).contains(&x) {
        return x;
    }
    let y = x - period * (x / period).floor();
    if (0.0..period).contains(&y) { y } else { 0.0 }
}

/// The representative of x nearest to another value.
pub(super) fn lifted(x: f64, near: f64, period: f64) -> f64 {
    match period {
        0.0 => x,
        _ => x + period * ((near - x) / period).round(),
    }
}
