//! One open surface through rows of samples of a sheet.

use super::fit::{DEGREE, LINES, SAMPLES, places};
use crate::basis::{KnotError, KnotVector};
use crate::math::{Point3, Vector3};
use crate::surface::{ControlNet, LineFit, Surface, SurfaceError};

/// Of a span: edges that are less apart are one.
const LEAST_SPAN: f64 = 0.2;

/// Knots and samples, in u and v.
pub(super) struct SheetLayout {
    knots: [KnotVector; 2],
    /// Parameters that are sampled; both ends included where they are apart.
    pub samples: [Vec<f64>; 2],
}

impl SheetLayout {
    /// Of a net of about so many control points, which goes round in u or does not; `breaks` are the places in u and in v at
    /// which a rim has a sharp corner, where that of what goes round is 0.
    pub fn new(
        counts: [usize; 2],
        round: bool,
        breaks: &[Vec<f64>; 2],
    ) -> Result<Self, SurfaceError> {
        let bad = |direction: char| move |source| SurfaceError::Knots { direction, source };
        let clamped = |d: usize| {
            let spans = Spans::new(counts[d].saturating_sub(DEGREE).max(1), &breaks[d]);
            (spans.clamped(), spans.samples())
        };
        let (knots_u, samples_u) = match (round, breaks[0].is_empty()) {
            (true, true) => {
                let count = LINES * counts[0];
                let turns = (0..count).map(|k| k as f64 / count as f64);
                (
                    KnotVector::periodic_uniform(DEGREE, counts[0]),
                    turns.collect(),
                )
            }
            (true, false) => {
                let spans = Spans::new(counts[0].saturating_sub(DEGREE).max(2), &breaks[0]);
                let mut samples = spans.samples();
                samples.pop();
                (spans.periodic(), samples)
            }
            (false, _) => clamped(0),
        };
        let (knots_v, samples_v) = clamped(1);
        Ok(Self {
            knots: [knots_u.map_err(bad('u'))?, knots_v.map_err(bad('v'))?],
            samples: [samples_u, samples_v],
        })
    }

    /// The surface nearest to the samples (u × v), through those at the ends; those at the end of v are one point where it is a
    /// pole.
    pub fn fitted(&self, samples: &[Point3], pole: bool) -> Result<Surface, SurfaceError> {
        let [knots_u, knots_v] = &self.knots;
        let origin = samples[0];
        let offsets: Vec<Vector3> = samples.iter().map(|p| p - origin).collect();
        let along_v = LineFit::new(knots_v, &self.samples[1]).apply(&offsets);
        let (rows, columns) = (knots_u.count(), knots_v.count());
        let turned = transposed(&along_v, columns);
        let along_u = LineFit::new(knots_u, &self.samples[0]).apply(&turned);
        let net = transposed(&along_u, rows).into_iter();
        let mut net: Vec<Point3> = net.map(|offset| origin + offset).collect();
        if pole {
            let last = samples[samples.len() - 1];
            net.chunks_mut(columns)
                .for_each(|row| row[columns - 1] = last);
        }
        let net = ControlNet::new(rows, columns, net)?;
        Surface::new(knots_u.clone(), knots_v.clone(), net, None)
    }
}

/// Spans from 0 to 1, between places at which there is an edge.
struct Spans {
    /// Where spans end, and whether at an edge.
    ends: Vec<(f64, bool)>,
}

impl Spans {
    /// About so many; of edges that are much less than a span apart, some are left out.
    fn new(count: usize, breaks: &[f64]) -> Self {
        let least = LEAST_SPAN / count as f64;
        let mut sorted = breaks.to_vec();
        sorted.sort_by(f64::total_cmp);
        let mut edges = vec![0.0];
        for &edge in &sorted {
            if edge - edges[edges.len() - 1] >= least && 1.0 - edge >= least {
                edges.push(edge);
            }
        }
        edges.push(1.0);
        let mut ends = vec![(0.0, false)];
        for pair in edges.windows(2) {
            let width = pair[1] - pair[0];
            let inner = places(((width * count as f64).round() as usize).max(1));
            let at = |t: &f64| (pair[0] + width * t, false);
            ends.extend(inner[1..inner.len() - 1].iter().map(at));
            ends.push((pair[1], pair[1] < 1.0));
        }
        Self { ends }
    }

    /// Knots within: three at edges.
    fn inner(&self) -> Vec<f64> {
        let inner = &self.ends[1..self.ends.len() - 1];
        let knots =
            |&(t, edge): &(f64, bool)| std::iter::repeat_n(t, if edge { DEGREE } else { 1 });
        inner.iter().flat_map(knots).collect()
    }

    fn clamped(&self) -> Result<KnotVector, KnotError> {
        let mut knots = vec![0.0; DEGREE + 1];
        knots.extend(self.inner());
        knots.extend([1.0; DEGREE + 1]);
        KnotVector::new(DEGREE, knots)
    }

    /// With an edge at 0.
    fn periodic(&self) -> Result<KnotVector, KnotError> {
        let mut knots = vec![0.0; DEGREE];
        knots.extend(self.inner());
        knots.push(1.0);
        KnotVector::periodic(DEGREE, knots)
    }

    /// Places within spans, at edges and at both ends.
    fn samples(&self) -> Vec<f64> {
        let mut all = vec![0.0];
        for pair in self.ends.windows(2) {
            let [(start, _), (end, edge)] = [pair[0], pair[1]];
            let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
            all.extend((0..SAMPLES).map(|k| start + (end - start) * at(k)));
            all.extend(Some(end).filter(|_| edge));
        }
        all.push(1.0);
        all
    }
}

/// Of rows that are so long.
fn transposed(rows: &[Vector3], long: usize) -> Vec<Vector3> {
    let count = rows.len() / long;
    let at = |k: usize| rows[k % count * long + k / count];
    (0..rows.len()).map(at).collect()
}
