//! curvo: a tessellation to start from, or the last parameters, then Newton.

use super::Peer;
use ::curvo::prelude::NurbsSurface3D;
use nalgebra::Point4;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

pub(super) struct Curvo {
    surface: NurbsSurface3D<f64>,
    last: Option<(f64, f64)>,
}

fn convert(surface: &Surface) -> NurbsSurface3D<f64> {
    let net = surface.net();
    let points = (0..net.rows())
        .map(|i| {
            (0..net.columns())
                .map(|j| {
                    let w = surface.weights().map_or(1.0, |w| w[i * net.columns() + j]);
                    let p = net.at(i, j) * w;
                    Point4::new(p.x, p.y, p.z, w)
                })
                .collect()
        })
        .collect();
    let (u, v) = (surface.knots_u(), surface.knots_v());
    NurbsSurface3D::new(
        u.degree(),
        v.degree(),
        u.knots().to_vec(),
        v.knots().to_vec(),
        points,
    )
}

impl Curvo {
    pub fn new(surface: &Surface) -> Self {
        Self {
            surface: convert(surface),
            last: None,
        }
    }
}

impl Peer for Curvo {
    fn name(&self) -> &'static str {
        "curvo"
    }

    fn closest(&mut self, query: &Point3, warm: bool) -> Option<Point3> {
        let hint = self.last.filter(|_| warm);
        // It panics where Newton leaves it without a number: that is an answer missing, not the end
        // of the run.
        let found = std::panic::catch_unwind(|| {
            let (u, v) = self.surface.find_closest_parameter(query, hint).ok()?;
            Some(((u, v), self.surface.point_at(u, v)))
        });
        let found = found.ok().flatten();
        self.last = found.map(|(parameters, _)| parameters);
        found.map(|(_, point)| point)
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
        if normals.is_empty() {
            // Its own way for equal steps, which are what it is asked for here.
            let rows = self
                .surface
                .regular_sample_points(us.len() - 1, vs.len() - 1);
            points
                .iter_mut()
                .zip(rows.iter().flatten())
                .for_each(|(to, point)| *to = *point);
            return true;
        }
        let mut evaluator = self.surface.evaluator();
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let derivatives = evaluator.rational_derivatives(u, v, 1);
                let k = i * vs.len() + j;
                points[k] = Point3::from(derivatives[0][0]);
                let cross = derivatives[1][0].cross(&derivatives[0][1]);
                normals[k] = cross.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            }
        }
        true
    }
}
