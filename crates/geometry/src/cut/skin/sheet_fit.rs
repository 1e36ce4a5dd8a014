//! One open surface through rows of samples of a sheet.

use super::fit::{DEGREE, LINES, SAMPLES, places};
use crate::basis::KnotVector;
use crate::math::{Point3, Vector3};
use crate::surface::{ControlNet, LineFit, Surface, SurfaceError};

/// Knots and samples, in u and v.
pub(super) struct SheetLayout {
    knots: [KnotVector; 2],
    /// Parameters that are sampled; both ends included where they are apart.
    pub samples: [Vec<f64>; 2],
}

impl SheetLayout {
    /// Of a net, which goes round in u or does not.
    pub fn new(counts: [usize; 2], round: bool) -> Result<Self, SurfaceError> {
        let bad = |direction: usize| {
            move |source| SurfaceError::Knots {
                direction: ['u', 'v'][direction],
                source,
            }
        };
        let clamped = |d: usize| -> Result<_, SurfaceError> {
            let places = places(counts[d] - DEGREE);
            let mut knots = vec![0.0; DEGREE];
            knots.extend(&places);
            knots.extend([1.0; DEGREE]);
            Ok((
                KnotVector::new(DEGREE, knots).map_err(bad(d))?,
                within(&places),
            ))
        };
        let (knots_u, samples_u) = match round {
            true => {
                let count = LINES * counts[0];
                let knots = KnotVector::periodic_uniform(DEGREE, counts[0]).map_err(bad(0))?;
                let turns = (0..count).map(|k| k as f64 / count as f64);
                (knots, turns.collect())
            }
            false => clamped(0)?,
        };
        let (knots_v, samples_v) = clamped(1)?;
        Ok(Self {
            knots: [knots_u, knots_v],
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

/// Places within spans, and both ends.
fn within(spans: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0];
    for pair in spans.windows(2) {
        let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
        all.extend((0..SAMPLES).map(|k| pair[0] + (pair[1] - pair[0]) * at(k)));
    }
    all.push(1.0);
    all
}

/// Of rows that are so long.
fn transposed(rows: &[Vector3], long: usize) -> Vec<Vector3> {
    let count = rows.len() / long;
    let at = |k: usize| rows[k % count * long + k / count];
    (0..rows.len()).map(at).collect()
}
