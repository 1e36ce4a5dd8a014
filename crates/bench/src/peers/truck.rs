//! truck-geometry: 50 × 50 samples to start from, or the last parameters, then Newton.

use super::Peer;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use truck_geometry::prelude as tg;
use truck_geometry::prelude::{ParametricSurface, ParametricSurface3D, SearchNearestParameter};

/// Newton steps before it gives up.
const TRIALS: usize = 100;

pub(super) struct Truck {
    surface: tg::BSplineSurface<tg::Point3>,
    last: Option<(f64, f64)>,
}

fn convert(surface: &Surface) -> tg::BSplineSurface<tg::Point3> {
    let net = surface.net();
    let point = |p: &Point3| tg::Point3::new(p.x, p.y, p.z);
    let points = (0..net.rows())
        .map(|i| (0..net.columns()).map(|j| point(net.at(i, j))).collect())
        .collect();
    let knots =
        |knots: &palpate_geometry::basis::KnotVector| tg::KnotVec::from(knots.knots().to_vec());
    tg::BSplineSurface::new((knots(surface.knots_u()), knots(surface.knots_v())), points)
}

impl Truck {
    pub fn new(surface: &Surface) -> Self {
        Self {
            surface: convert(surface),
            last: None,
        }
    }
}

impl Peer for Truck {
    fn name(&self) -> &'static str {
        "truck-geometry"
    }

    fn closest(&mut self, q: &Point3, warm: bool) -> Option<Point3> {
        let query = tg::Point3::new(q.x, q.y, q.z);
        self.last = match self.last.filter(|_| warm) {
            Some(hint) => self.surface.search_nearest_parameter(query, hint, TRIALS),
            None => self.surface.search_nearest_parameter(query, None, TRIALS),
        };
        self.last.map(|(u, v)| {
            let p = self.surface.subs(u, v);
            Point3::new(p.x, p.y, p.z)
        })
    }

    fn moved(&mut self, surface: &Surface) {
        self.surface = convert(surface);
    }

    fn grid(
        &mut self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Point3],
        normals: &mut [Vector3],
    ) -> bool {
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let k = i * vs.len() + j;
                let p = self.surface.subs(u, v);
                points[k] = Point3::new(p.x, p.y, p.z);
                if let Some(normal) = normals.get_mut(k) {
                    let n = self.surface.normal(u, v);
                    *normal = Vector3::new(n.x, n.y, n.z);
                }
            }
        }
        true
    }
}
