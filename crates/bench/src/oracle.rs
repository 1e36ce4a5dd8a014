//! The distance of a point from a surface, slowly: 400 × 400 samples, the promising ones polished
//! by Newton.
//!
//! Shares nothing with the certified closest point but the evaluation of the surface.

use super::inputs::spread;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{SampleGrid, Samples, Surface};

/// Samples in each direction.
const COUNT: usize = 400;
/// Promising samples that are polished.
const STARTS: usize = 16;

/// Samples of one surface.
pub(super) struct Oracle {
    grid: SampleGrid,
    samples: Samples,
    us: Vec<f64>,
    vs: Vec<f64>,
    x: [Vec<f64>; 3],
    squares: Vec<f64>,
}

impl Oracle {
    pub fn new(surface: &Surface) -> Self {
        let (us, vs) = (
            spread(surface.knots_u().domain(), COUNT),
            spread(surface.knots_v().domain(), COUNT),
        );
        let grid = SampleGrid::new(surface, &us, &vs);
        let zeros = || vec![0.0; COUNT * COUNT];
        let mut new = Self {
            samples: grid.samples(),
            grid,
            us,
            vs,
            x: [zeros(), zeros(), zeros()],
            squares: zeros(),
        };
        new.moved(surface);
        new
    }

    /// Samples a net that moved.
    pub fn moved(&mut self, surface: &Surface) {
        self.grid.points_into(surface, &mut self.samples);
        for (k, p) in self.samples.points.iter().enumerate() {
            for c in 0..3 {
                self.x[c][k] = p[c];
            }
        }
    }

    /// The distance, m.
    pub fn distance(&mut self, surface: &Surface, q: &Point3) -> f64 {
        let [x, y, z] = &self.x;
        let mut least = f64::INFINITY;
        for (k, square) in self.squares.iter_mut().enumerate() {
            let (a, b, c) = (x[k] - q.x, y[k] - q.y, z[k] - q.z);
            *square = a * a + b * b + c * c;
        }
        for &square in &self.squares {
            least = if square < least { square } else { least };
        }
        // A foot lies within about a cell of its best sample, and cells are about size / 400 wide.
        let reach = least.sqrt() + 3.0 * surface.size() / COUNT as f64;
        let mut starts: Vec<(f64, usize)> = Vec::new();
        for (k, &square) in self.squares.iter().enumerate() {
            if square <= reach * reach && self.is_lowest_around(k, square) {
                starts.push((square, k));
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        // All samples of a pole are one point, and from each another meridian leads away.
        let last = starts.get(STARTS).map_or(f64::INFINITY, |start| start.0);
        let kept = starts.iter().take_while(|start| start.0 <= last);
        kept.map(|&(_, k)| self.polish(surface, q, k))
            .fold(least, f64::min)
            .sqrt()
    }

    fn is_lowest_around(&self, k: usize, square: f64) -> bool {
        let (i, j) = (k / COUNT, k % COUNT);
        (i.saturating_sub(1)..(i + 2).min(COUNT)).all(|a| {
            (j.saturating_sub(1)..(j + 2).min(COUNT)).all(|b| self.squares[a * COUNT + b] >= square)
        })
    }

    /// Newton with damping (Levenberg and Marquardt's) from a sample; the squared distance where it
    /// ends.
    fn polish(&self, surface: &Surface, q: &Point3, sample: usize) -> f64 {
        let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
        let (mut u, mut v) = (self.us[sample / COUNT], self.vs[sample % COUNT]);
        let mut frame = surface.frame(u, v);
        let mut value = (frame.point - q).norm_squared();
        let mut damping = 1e-3;
        for _ in 0..200 {
            let r = frame.point - q;
            let (gu, gv) = (r.dot(&frame.du), r.dot(&frame.dv));
            let first = (
                frame.du.norm_squared(),
                frame.du.dot(&frame.dv),
                frame.dv.norm_squared(),
            );
            let full = (
                first.0 + r.dot(&frame.duu),
                first.1 + r.dot(&frame.duv),
                first.2 + r.dot(&frame.dvv),
            );
            // Second derivatives only where they help.
            let (e, f, g) = if full.0 > 0.0 && full.0 * full.2 > full.1 * full.1 {
                full
            } else {
                first
            };
            let (e, g) = (e * (1.0 + damping) + 1e-300, g * (1.0 + damping) + 1e-300);
            let held_u = (u <= u0 && gu > 0.0) || (u >= u1 && gu < 0.0);
            let held_v = (v <= v0 && gv > 0.0) || (v >= v1 && gv < 0.0);
            let (du, dv) = match (held_u, held_v) {
                (true, true) => break,
                (true, false) => (0.0, -gv / g),
                (false, true) => (-gu / e, 0.0),
                (false, false) => (
                    (f * gv - g * gu) / (e * g - f * f),
                    (f * gu - e * gv) / (e * g - f * f),
                ),
            };
            let (x, y) = ((u + du).clamp(u0, u1), (v + dv).clamp(v0, v1));
            let next = surface.frame(x, y);
            let better = (next.point - q).norm_squared();
            if better < value {
                let little = value - better <= 1e-15 * value;
                (u, v, frame, value) = (x, y, next, better);
                damping = (damping * 0.1_f64).max(1e-16);
                if little {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::inputs::scattered;
    use super::*;
    use palpate_geometry::surface::{ClosestSolver, builtin};

    #[test]
    fn oracle_and_certified_answer_agree() {
        let surface = builtin("teardrop", None, None).unwrap();
        let (mut oracle, mut solver) = (Oracle::new(&surface), ClosestSolver::new(&surface));
        for q in scattered(&surface, 40) {
            let (slow, fast) = (
                oracle.distance(&surface, &q),
                solver.closest(&surface, &q).distance,
            );
            assert!(
                (slow - fast).abs() < 1e-9 * surface.size(),
                "{q:?}: {slow} and {fast}"
            );
        }
    }
}
