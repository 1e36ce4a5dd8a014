//! The greatest value of a function over a surface, slowly: samples, then ever smaller grids about
//! the best few.

use crate::inputs::spread;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{SampleGrid, Surface};

/// Promising samples that are closed in upon.
const STARTS: usize = 12;

pub(super) struct Sampled {
    points: Vec<Point3>,
    us: Vec<f64>,
    vs: Vec<f64>,
}

impl Sampled {
    pub fn new(surface: &Surface) -> Self {
        Self::of(surface, 400)
    }

    /// For functions that take long.
    pub fn coarse(surface: &Surface) -> Self {
        Self::of(surface, 120)
    }

    fn of(surface: &Surface, count: usize) -> Self {
        let (us, vs) = (
            spread(surface.knots_u().domain(), count),
            spread(surface.knots_v().domain(), count),
        );
        let grid = SampleGrid::new(surface, &us, &vs);
        let mut samples = grid.samples();
        grid.points_into(surface, &mut samples);
        Self {
            points: samples.points,
            us,
            vs,
        }
    }

    pub fn greatest(&mut self, surface: &Surface, f: impl Fn(&Point3) -> f64) -> f64 {
        let columns = self.vs.len();
        let values: Vec<f64> = self.points.iter().map(&f).collect();
        let best_around = |k: usize| {
            let (i, j) = (k / columns, k % columns);
            (i.saturating_sub(1)..(i + 2).min(self.us.len())).all(|a| {
                (j.saturating_sub(1)..(j + 2).min(columns))
                    .all(|b| values[a * columns + b] <= values[k])
            })
        };
        let mut starts: Vec<usize> = (0..values.len()).filter(|&k| best_around(k)).collect();
        starts.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        starts.truncate(STARTS);
        let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
        let mut greatest = f64::NEG_INFINITY;
        for k in starts {
            let (mut u, mut v, mut best) = (self.us[k / columns], self.vs[k % columns], values[k]);
            let (mut du, mut dv) = ((u1 - u0) / self.us.len() as f64, (v1 - v0) / columns as f64);
            for _ in 0..45 {
                let (at_u, at_v) = (u, v);
                for a in -2..=2 {
                    for b in -2..=2 {
                        let x = (at_u + 0.5 * du * f64::from(a)).clamp(u0, u1);
                        let y = (at_v + 0.5 * dv * f64::from(b)).clamp(v0, v1);
                        let value = f(&surface.point(x, y));
                        if value > best {
                            (u, v, best) = (x, y, value);
                        }
                    }
                }
                // Not at once by half: the best may be on the rim.
                (du, dv) = (0.6 * du, 0.6 * dv);
            }
            greatest = greatest.max(best);
        }
        greatest
    }
}
