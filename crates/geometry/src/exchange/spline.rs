//! What STEP and IGES call a B-spline surface, and how it becomes ours and back.
//!
//! Files close a direction in three ways. A clamped seam stays one. *Unclamped with repeated
//! points* (the letter of both standards) and *one period of knots with unrepeated points* (what
//! OpenCASCADE takes from STEP) become a periodic direction, whatever their flags say: both
//! standards call these flags information only. A period of fewer points than `degree + 1` is no
//! [`KnotVector::periodic`]; its points are repeated instead.

use crate::basis::{KnotError, KnotVector, MAX_DEGREE};
use crate::math::Point3;
use crate::part::bezier::{Homogeneous, elevated, projected};
use crate::surface::{ControlNet, Curve, CurveError, Loaded, SAME_POINT, Surface, SurfaceError};

/// Why values of a file make no surface, or a surface no file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Too few or too many knots for the net.
    #[error("{given} knots in {direction}, but degree {degree} with {count} control points needs {}", count + degree + 1)]
    KnotCount {
        /// `u` or `v`.
        direction: char,
        /// Knots of the file, with multiplicities.
        given: u64,
        /// Polynomial degree.
        degree: usize,
        /// Control points in this direction.
        count: usize,
    },
    /// Knots and multiplicities are two lists of one length.
    #[error("{knots} knots but {multiplicities} multiplicities in {direction}")]
    Multiplicities {
        /// `u` or `v`.
        direction: char,
        /// Number of knots given.
        knots: usize,
        /// Number of multiplicities given.
        multiplicities: usize,
    },
    /// A surface in several pieces, which other systems do not take.
    #[error(
        "the surface is separated at {direction} = {knot} (a knot of multiplicity degree + 1), which this format does \
         not support: export its pieces"
    )]
    Disjoined {
        /// `u` or `v`.
        direction: char,
        /// Knot value.
        knot: f64,
    },
    /// Values that make no surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// Values that make no curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

/// Distinct knots with their multiplicities: never more numbers than the file has.
pub(super) type Runs = Vec<(f64, u64)>;

/// A surface as a file has it; points in metres, u-major.
#[derive(Debug)]
pub(super) struct FileSurface {
    pub degrees: [usize; 2],
    pub knots: [Runs; 2],
    pub rows: usize,
    pub columns: usize,
    pub points: Vec<Point3>,
    pub weights: Option<Vec<f64>>,
}

/// A curve as a file has it; points in metres.
#[derive(Debug)]
pub(super) struct FileCurve {
    pub degree: usize,
    pub knots: Runs,
    pub points: Vec<Point3>,
    pub weights: Option<Vec<f64>>,
}

impl FileCurve {
    /// Rational Bézier segments end to start, in the highest of their degrees; `None` without any.
    pub fn of_segments(segments: &[Vec<Homogeneous>]) -> Option<Self> {
        let degree = segments.iter().map(|segment| segment.len() - 1).max()?;
        let mut points: Vec<Homogeneous> = Vec::with_capacity(segments.len() * degree + 1);
        for segment in segments {
            let segment = elevated(segment, degree);
            let factor = points.pop().map_or(1.0, |last| last[3] / segment[0][3]);
            points.extend(segment.iter().map(|h| h.map(|x| x * factor)));
        }
        let (last, times) = (segments.len(), degree as u64);
        let knots = (0..=last).map(|k| match k == 0 || k == last {
            true => (k as f64, times + 1),
            false => (k as f64, times),
        });
        let rational = points.iter().any(|h| h[3] != points[0][3]);
        let weights = points.iter().map(|h| h[3]).collect();
        Some(Self {
            degree,
            knots: knots.collect(),
            points: points.iter().map(projected).collect(),
            weights: rational.then_some(weights),
        })
    }

    /// Our curve: the same points at the same parameters.
    pub fn build(self) -> Result<Curve, SplineError> {
        let count = self.points.len();
        if let Some(weights) = self.weights.as_ref().filter(|w| w.len() != count) {
            return Err(CurveError::WeightCount {
                weights: weights.len(),
                points: count,
            }
            .into());
        }
        let far_m = |p: &Point3| (p - self.points[0]).norm();
        let tolerance = SAME_POINT * self.points.iter().map(far_m).fold(0.0, f64::max);
        let same = |a: usize, b: usize| {
            (self.points[a] - self.points[b]).norm() <= tolerance
                && (self.weights.as_ref())
                    .is_none_or(|w| (w[a] - w[b]).abs() <= SAME_POINT * w[a].abs())
        };
        let axis = axis('t', self.degree, count, &self.knots, same)?;
        let points = axis.rows.iter().map(|&k| self.points[k]).collect();
        let weights = (self.weights.as_ref()).map(|w| axis.rows.iter().map(|&k| w[k]).collect());
        Ok(Curve::new(axis.knots, points, weights)?)
    }
}

/// A direction of the net: its knots, and which row of the file each row of ours is.
struct SplineAxis {
    knots: KnotVector,
    rows: Vec<usize>,
}

impl FileSurface {
    /// Our surface: the same points at the same parameters.
    pub fn build(self) -> Result<Loaded, SplineError> {
        let (rows, columns) = (self.rows, self.columns);
        let needed = rows * columns;
        if let Some(weights) = self.weights.as_ref().filter(|w| w.len() != needed) {
            return Err(SurfaceError::WeightCount {
                given: weights.len(),
                needed,
            }
            .into());
        }
        // Counted before anything is picked from it.
        let net = ControlNet::new(rows, columns, self.points).map_err(SurfaceError::from)?;
        let points = net.points();
        let tolerance = SAME_POINT * net.size();
        let same = |a: usize, b: usize| {
            (points[a] - points[b]).norm() <= tolerance
                && (self.weights.as_ref())
                    .is_none_or(|w| (w[a] - w[b]).abs() <= SAME_POINT * w[a].abs())
        };
        let same_rows =
            |i: usize, k: usize| (0..columns).all(|j| same(i * columns + j, k * columns + j));
        let same_columns =
            |j: usize, k: usize| (0..rows).all(|i| same(i * columns + j, i * columns + k));
        let u = axis('u', self.degrees[0], rows, &self.knots[0], same_rows)?;
        let v = axis('v', self.degrees[1], columns, &self.knots[1], same_columns)?;
        let order: Vec<usize> = u
            .rows
            .iter()
            .flat_map(|i| v.rows.iter().map(move |j| i * columns + j))
            .collect();
        let picked = order.iter().map(|&k| points[k]).collect();
        let weights = self
            .weights
            .as_ref()
            .map(|w| order.iter().map(|&k| w[k]).collect());
        let net =
            ControlNet::new(u.rows.len(), v.rows.len(), picked).map_err(SurfaceError::from)?;
        Ok(Surface::new(u.knots, v.knots, net, weights)?.loaded()?)
    }
}

fn axis(
    direction: char,
    degree: usize,
    count: usize,
    runs: &[(f64, u64)],
    same: impl Fn(usize, usize) -> bool,
) -> Result<SplineAxis, SplineError> {
    let refuse = |source| SplineError::Surface(SurfaceError::Knots { direction, source });
    if degree == 0 || degree > MAX_DEGREE {
        return Err(refuse(KnotError::Degree(degree)));
    }
    let given = runs
        .iter()
        .fold(0, |sum: u64, run| sum.saturating_add(run.1));
    let ends = [runs.first(), runs.last()].map(|run| run.map_or(0, |run| run.1));
    let one_period = ends[0] == ends[1]
        && (1..=degree as u64).contains(&ends[0])
        && given == count as u64 + ends[0];
    if !one_period && given != (count + degree + 1) as u64 {
        return Err(SplineError::KnotCount {
            direction,
            given,
            degree,
            count,
        });
    }
    let full: Vec<f64> = runs
        .iter()
        .flat_map(|&(knot, times)| (0..times).map(move |_| knot))
        .collect();
    if one_period {
        let period = full[ends[0] as usize - 1..].to_vec();
        if count > degree {
            let knots = KnotVector::periodic(degree, period).map_err(refuse)?;
            return Ok(SplineAxis {
                knots,
                rows: (0..count).collect(),
            });
        }
        return few(degree, count, &period).map_err(refuse);
    }
    let knots = KnotVector::new(degree, full).map_err(refuse)?;
    if let Some(knots) = wrapped(&knots, same) {
        let count = knots.count();
        return Ok(SplineAxis {
            knots,
            rows: (0..count).collect(),
        });
    }
    Ok(SplineAxis {
        knots,
        rows: (0..count).collect(),
    })
}

/// A period of `degree` points or fewer, written out: the open vector over one period, its points
/// repeated.
fn few(degree: usize, count: usize, period: &[f64]) -> Result<SplineAxis, KnotError> {
    let last = period.len() - 1;
    let length = period[last] - period[0];
    if count == 0 || length.is_nan() || length <= 0.0 {
        return Err(KnotError::EmptyDomain(period[0]));
    }
    // Knot k of the endless vector, knot 0 being where the period starts. Copies of its end are
    // copies of the next one's start, and rounding may not part them.
    let knot = |k: isize| {
        let (turn, at) = (
            k.div_euclid(count as isize),
            period[k.rem_euclid(count as isize) as usize],
        );
        let (turn, at) = if at == period[last] {
            (turn + 1, period[0])
        } else {
            (turn, at)
        };
        at + length * turn as f64
    };
    let (p, n) = (degree as isize, count as isize);
    let knots = KnotVector::new(degree, (-p..=n + p).map(knot).collect())?;
    let rows = (0..knots.count()).map(|i| i % count).collect();
    Ok(SplineAxis { knots, rows })
}

/// The periodic vector of the same curve, if its knots and control points repeat after the domain.
///
/// The domain may end at any copy of its last knot: we write the vector out to the last one and
/// repeat `degree` points, OpenCASCADE to the first and repeats fewer.
fn wrapped(knots: &KnotVector, same: impl Fn(usize, usize) -> bool) -> Option<KnotVector> {
    let (p, n, t) = (knots.degree(), knots.count(), knots.knots());
    // Sums with the period round, and differently in other programs; and files have twelve
    // decimals, often, of thirds.
    let rounding = 2e-12 * t[0].abs().max(t[n + p].abs());
    (n..=n + p)
        .take_while(|&end| t[end] == t[n])
        .find_map(|end| {
            let count = end - p;
            let periodic = KnotVector::periodic(p, t[p..=end].to_vec()).ok()?;
            let alike = periodic
                .knots()
                .iter()
                .zip(t)
                .all(|(a, b)| (a - b).abs() <= rounding);
            // A clamped vector repeats no points; as a periodic one it would be open at its seam.
            let repeats = (0..n - count).all(|i| same(i, i + count));
            (alike && repeats && periodic.disjoined().is_empty()).then_some(periodic)
        })
}

/// A surface as both formats write it: full knots, points repeated where a direction is periodic.
#[derive(Debug)]
pub(super) struct Written {
    pub degrees: [usize; 2],
    pub knots: [Vec<f64>; 2],
    pub domains: [(f64, f64); 2],
    pub rows: usize,
    pub columns: usize,
    /// u-major, m.
    pub points: Vec<Point3>,
    pub weights: Option<Vec<f64>>,
    pub closed: [bool; 2],
    pub periodic: [bool; 2],
}

impl Written {
    /// Neither format says on its surface which side is out. A closed surface is turned outwards by
    /// who reads it; an open one whose outward side is -(S_u × S_v) is written with u and v
    /// exchanged.
    pub fn new(surface: &Surface) -> Result<Self, SplineError> {
        let topology = surface.topology();
        if surface.flip_normal() && !topology.is_closed() {
            return Self::new(&surface.swap_uv());
        }
        let (u, v) = (surface.knots_u(), surface.knots_v());
        for (direction, knots) in [('u', u), ('v', v)] {
            if let Some(&knot) = knots.disjoined().first() {
                return Err(SplineError::Disjoined { direction, knot });
            }
        }
        let (rows, columns) = (u.basis_count(), v.basis_count());
        let (net_rows, net_columns) = (u.count(), v.count());
        let order: Vec<usize> = (0..rows)
            .flat_map(|i| (0..columns).map(move |j| (i % net_rows) * net_columns + j % net_columns))
            .collect();
        Ok(Self {
            degrees: [u.degree(), v.degree()],
            knots: [u.knots().to_vec(), v.knots().to_vec()],
            domains: [u.domain(), v.domain()],
            rows,
            columns,
            points: order.iter().map(|&k| surface.net().points()[k]).collect(),
            weights: surface
                .weights()
                .map(|w| order.iter().map(|&k| w[k]).collect()),
            closed: topology
                .closing
                .map(|closing| closing != crate::surface::Closing::Open),
            periodic: [u.is_periodic(), v.is_periodic()],
        })
    }
}

/// Equal knots gathered.
pub(super) fn runs(knots: &[f64]) -> Runs {
    let mut runs: Runs = Vec::new();
    for &knot in knots {
        match runs.last_mut() {
            Some(run) if run.0 == knot => run.1 += 1,
            _ => runs.push((knot, 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::builtin;

    // Read as an open direction, it would come apart where it deforms.
    #[test]
    fn points_that_repeat_but_for_rounding_close_a_period() {
        let torus = builtin("torus", None, None).unwrap();
        let mut written = Written::new(&torus).unwrap();
        for point in written.points.iter_mut().rev().take(written.columns) {
            point.x += 1e-13;
        }
        let file = FileSurface {
            degrees: written.degrees,
            knots: written.knots.map(|knots| runs(&knots)),
            rows: written.rows,
            columns: written.columns,
            points: written.points,
            weights: None,
        };
        let read = file.build().unwrap().surface;
        assert!(read.knots_u().is_periodic() && read.knots_v().is_periodic());
        assert_eq!(read.net(), torus.net());
    }
}
