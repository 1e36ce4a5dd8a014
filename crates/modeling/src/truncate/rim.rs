//! The curves in which the surfaces cross, by length, and B-splines through them.

use super::TruncateError;
use super::fields::Fields;
use palpate_geometry::basis::{Blending, BlendingInverse, KnotVector};
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Curve;

/// Of the size: how near chords stay to a curve.
const CHORD: f64 = 1e-6;
/// Control points of a curve at first and at most.
const COUNTS: [usize; 2] = [32, 256];
/// Samples for each control point.
const SAMPLES: usize = 4;

/// A closed curve in which the surfaces cross, along n_A × n_B.
#[derive(Clone, Debug)]
pub(super) struct Rim {
    /// Places on both surfaces, m; the last is followed by the first.
    points: Vec<Point3>,
    /// (points + 1): length up to each, m.
    lengths: Vec<f64>,
}

/// A cubic B-spline, closed, near a rim.
#[derive(Clone, Debug)]
pub(super) struct RimCurve {
    pub curve: Curve,
    /// How far it is from either surface, m.
    pub gap_m: f64,
}

/// All curves in which the surfaces cross.
pub(super) fn rims(fields: &mut Fields<'_>) -> Result<Vec<Rim>, TruncateError> {
    let [a, b] = fields.surfaces;
    let tolerance_m = CHORD * fields.size_m;
    let [of_a, of_b] = fields.solvers();
    let sides = [(a, of_a), (b, of_b)].map(|(surface, solver)| PairSide { surface, solver });
    let [body, tool] = sides;
    let curves = PairSolver::new(a, b).curves(body, tool, tolerance_m);
    let rim = |curve: palpate_geometry::contact::pair::IntersectionCurve| {
        let points: Vec<Point3> = curve.points.iter().map(|p| p.point).collect();
        match curve.closed {
            true => Ok(Rim::new(points)),
            false => Err(TruncateError::CurveEnds {
                at: points[0].into(),
            }),
        }
    };
    curves.into_iter().map(rim).collect()
}

impl Rim {
    fn new(points: Vec<Point3>) -> Self {
        let mut lengths = vec![0.0];
        for (k, p) in points.iter().enumerate() {
            let next = points[(k + 1) % points.len()];
            lengths.push(lengths[k] + (next - p).norm());
        }
        Self { points, lengths }
    }

    /// m.
    pub fn length_m(&self) -> f64 {
        self.lengths[self.points.len()]
    }

    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// The place at a share of the length, on the chords.
    pub fn point(&self, s: f64) -> Point3 {
        let along = (s - s.floor()) * self.length_m();
        let k = self.lengths.partition_point(|&l| l <= along).max(1) - 1;
        let k = k.min(self.points.len() - 1);
        let (from, to) = (self.points[k], self.points[(k + 1) % self.points.len()]);
        let chord = self.lengths[k + 1] - self.lengths[k];
        from + (to - from) * ((along - self.lengths[k]) / chord.max(f64::MIN_POSITIVE))
    }

    /// Share of the length at the nearest of its points, and the distance, m.
    pub fn nearest(&self, q: &Point3) -> (f64, f64) {
        let away = |k: &usize| (self.points[*k] - q).norm_squared();
        let nearest = (0..self.points.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
        let k = nearest.unwrap_or(0);
        (self.lengths[k] / self.length_m(), away(&k).sqrt())
    }

    /// A B-spline through it, `share` of whose length belongs to a parameter in [0, 1): no fewer control points than
    /// `least`, and as many as bring it within `tolerance_m` of both surfaces, if there are not too many.
    pub fn fitted(
        &self,
        fields: &mut Fields<'_>,
        share: impl Fn(f64) -> f64,
        least: usize,
        tolerance_m: f64,
    ) -> RimCurve {
        let mut count = COUNTS[0].max(least);
        loop {
            let found = self.with_count(fields, &share, count);
            if found.gap_m <= tolerance_m || count >= COUNTS[1] {
                return found;
            }
            count *= 2;
        }
    }

    fn with_count(
        &self,
        fields: &mut Fields<'_>,
        share: &impl Fn(f64) -> f64,
        count: usize,
    ) -> RimCurve {
        let knots = KnotVector::periodic_uniform(3, count).expect("more than the degree");
        let step = 1.0 / (SAMPLES * count) as f64;
        let us: Vec<f64> = (0..SAMPLES * count).map(|k| k as f64 * step).collect();
        // From a place of the curve, so that its coordinates cost no digits.
        let origin = self.points[0];
        let mut sample = |u: f64| fields.onto_rim(&self.point(share(u))) - origin;
        let samples: Vec<Vector3> = us.iter().map(|&u| sample(u)).collect();
        let inverse = BlendingInverse::new(Blending::new(&knots, &us));
        let mut net = vec![Vector3::zeros(); count];
        let mut scratch = vec![Vector3::zeros(); us.len() + count];
        inverse.fit(&samples, &mut net, &mut scratch);
        let points = net.iter().map(|x| origin + x).collect();
        let curve = Curve::new(knots, points, None).expect("as many points as knots ask for");
        let gap_m = us.iter().fold(0.0, |gap: f64, &u| {
            let depths = fields.at(&curve.point(u + 0.5 * step));
            gap.max(depths.phi[0].abs()).max(depths.phi[1].abs())
        });
        RimCurve { curve, gap_m }
    }
}
