//! One surface through the rows of samples of all sections.

use crate::basis::{Blending, BlendingInverse, KnotVector};
use crate::math::{Point3, Vector3};
use crate::surface::{ControlNet, LineFit, Surface, SurfaceError};
use std::f64::consts::TAU;

/// Spans beside poles and rims, in others: rows of control points crowd there, less so where spans are longer.
const END_SPAN: f64 = 1.5;
/// Samples of a span.
pub(super) const SAMPLES: usize = 3;
/// Lines of samples for each control point around.
pub(super) const LINES: usize = 2;
/// Places in each direction from which a foot is looked for, and how far apart in v the farthest are.
const AROUND: usize = 8;
const BESIDE: f64 = 0.2;
/// Of the cubics.
pub(super) const DEGREE: usize = 3;

/// Control points that a net has at least, around and from pole to pole: a disc on each side of a rim.
pub const LEAST_COUNTS: [usize; 2] = [4, 2 * LEAST_STEPS + 1];
/// Control points at most.
pub(super) const MOST_POINTS: usize = 1 << 16;
/// Steps from row to row of control points in a section: three spans' worth at least is one Bézier piece.
pub(super) const LEAST_STEPS: usize = DEGREE;

/// The rows of control points and of samples.
pub(super) struct Layout {
    around: usize,
    /// (sections)
    parts: Vec<Part>,
    knots_v: KnotVector,
}

struct Part {
    /// From 0 to 1.
    knots: KnotVector,
    /// Shares of the section's length that are sampled, both ends included.
    shares: Vec<f64>,
    /// v where it begins and ends.
    range: [f64; 2],
}

impl Layout {
    /// Of a net, for sections of some lengths.
    pub fn new([around, along]: [usize; 2], lengths: &[f64]) -> Result<Self, SurfaceError> {
        let bad = |source| SurfaceError::Knots {
            direction: 'v',
            source,
        };
        let steps = apportioned(along - 1, lengths);
        let whole: f64 = lengths.iter().sum();
        let (mut parts, mut passed) = (Vec::new(), 0.0);
        let mut knots = vec![0.0; DEGREE + 1];
        for (k, (&steps, length)) in steps.iter().zip(lengths).enumerate() {
            let places = places(steps + 1 - DEGREE);
            let start = passed / whole;
            passed += length;
            let end = match k + 1 == lengths.len() {
                true => 1.0,
                false => passed / whole,
            };
            let inner = &places[1..places.len() - 1];
            knots.extend(inner.iter().map(|t| start + (end - start) * t));
            let last = DEGREE + usize::from(k + 1 == lengths.len());
            knots.extend(std::iter::repeat_n(end, last));
            let mut own = vec![0.0; DEGREE + 1];
            own.extend(inner);
            own.extend([1.0; DEGREE + 1]);
            let mut shares = vec![0.0];
            for pair in places.windows(2) {
                let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
                shares.extend((0..SAMPLES).map(|k| pair[0] + (pair[1] - pair[0]) * at(k)));
            }
            shares.push(1.0);
            parts.push(Part {
                knots: KnotVector::new(DEGREE, own).map_err(bad)?,
                shares,
                range: [start, end],
            });
        }
        Ok(Self {
            around,
            parts,
            knots_v: KnotVector::new(DEGREE, knots).map_err(bad)?,
        })
    }

    /// Longitudes of the lines of samples, in turns.
    pub fn turns(&self) -> Vec<f64> {
        let count = LINES * self.around;
        (0..count).map(|k| k as f64 / count as f64).collect()
    }

    /// Shares of a section's length that are sampled.
    pub fn shares(&self, section: usize) -> &[f64] {
        &self.parts[section].shares
    }

    pub fn v(&self, section: usize, share: f64) -> f64 {
        let [a, b] = self.parts[section].range;
        a + (b - a) * share
    }

    /// The surface nearest to the samples: (sections) (turns × shares), whose ends are the same where sections meet, and one
    /// point at poles.
    pub fn fitted(&self, samples: &[Vec<Point3>]) -> Result<Surface, SurfaceError> {
        let turns = self.turns();
        let origin = samples[0][0];
        let columns = self.knots_v.count();
        let mut lines = vec![Vector3::zeros(); turns.len() * columns];
        let mut first = 0;
        for (part, samples) in self.parts.iter().zip(samples) {
            let offsets: Vec<Vector3> = samples.iter().map(|p| p - origin).collect();
            let rows = LineFit::new(&part.knots, &part.shares).apply(&offsets);
            let count = part.knots.count();
            for (k, row) in rows.chunks(count).enumerate() {
                lines[k * columns + first..][..count].copy_from_slice(row);
            }
            first += count - 1;
        }
        let bad = |source| SurfaceError::Knots {
            direction: 'u',
            source,
        };
        let knots_u = KnotVector::periodic_uniform(DEGREE, self.around).map_err(bad)?;
        let around = BlendingInverse::new(Blending::new(&knots_u, &turns));
        let mut net = vec![Point3::origin(); self.around * columns];
        let mut scratch = vec![Vector3::zeros(); turns.len() + self.around];
        let mut row = vec![Vector3::zeros(); self.around];
        for j in 0..columns {
            let column: Vec<Vector3> = (0..turns.len()).map(|k| lines[k * columns + j]).collect();
            match j == 0 || j + 1 == columns {
                true => row.fill(column[0]),
                false => around.fit(&column, &mut row, &mut scratch),
            }
            if let Some((ring, pole)) = self.ring(j) {
                smooth(&mut row, lines[pole], ring);
            }
            for (i, offset) in row.iter().enumerate() {
                net[i * columns + j] = origin + offset;
            }
        }
        let net = ControlNet::new(self.around, columns, net)?;
        let surface = Surface::new(knots_u, self.knots_v.clone(), net, None)?;
        Ok(surface.with_exact_seams().oriented_outward())
    }

    /// How many steps a row is from a pole, if it is to be smooth around it, and the pole's column.
    fn ring(&self, row: usize) -> Option<(usize, usize)> {
        let last = self.knots_v.count() - 1;
        let (ring, pole, part) = match 2 * row < last {
            true => (row, 0, self.parts.first()?),
            false => (last - row, last, self.parts.last()?),
        };
        let far = part.knots.count() > 2 * DEGREE;
        let is_smooth = ring == 1 || ring == 2 && far && 2 * ring < self.around;
        is_smooth.then_some((ring, pole))
    }
}

/// Gives a row of control points, `ring` steps from a pole, what rows of surfaces have that are smooth there, or pointed: one
/// wave around in the first row, and two more in the second.
fn smooth(row: &mut [Vector3], pole: Vector3, ring: usize) {
    let count = row.len();
    let angle = |i: usize, waves: usize| TAU * (i * waves % count) as f64 / count as f64;
    let offsets: Vec<Vector3> = row.iter().map(|p| p - pole).collect();
    let sum = |weight: &dyn Fn(usize) -> f64| -> Vector3 {
        let each = offsets.iter().enumerate();
        each.map(|(i, offset)| offset * weight(i)).sum::<Vector3>() / count as f64
    };
    row.fill(pole + sum(&|_| 1.0));
    for waves in 1..=ring {
        let cos = 2.0 * sum(&|i| libm::cos(angle(i, waves)));
        let sin = 2.0 * sum(&|i| libm::sin(angle(i, waves)));
        for (i, point) in row.iter_mut().enumerate() {
            let angle = angle(i, waves);
            *point += cos * libm::cos(angle) + sin * libm::sin(angle);
        }
    }
}

/// Steps for each section by its length, of all, each with the least at least.
fn apportioned(all: usize, lengths: &[f64]) -> Vec<usize> {
    let mut steps = vec![LEAST_STEPS; lengths.len()];
    // One after the other to where they are longest.
    for _ in LEAST_STEPS * lengths.len()..all {
        let long = |k: usize| lengths[k] / steps[k] as f64;
        let next = (0..steps.len()).max_by(|&a, &b| long(a).total_cmp(&long(b)));
        steps[next.unwrap_or(0)] += 1;
    }
    steps
}

/// Ends of spans from 0 to 1.
pub(super) fn places(spans: usize) -> Vec<f64> {
    let width = |k: usize| match spans > 2 && (k == 0 || k + 1 == spans) {
        true => END_SPAN,
        false => 1.0,
    };
    let whole: f64 = (0..spans).map(width).sum();
    let mut passed = 0.0;
    let mut places = vec![0.0];
    for k in 0..spans {
        passed += width(k);
        places.push(passed / whole);
    }
    places[spans] = 1.0;
    places
}

/// How far a point is from a surface near a place, unless that is no more than what is known: then about it.
pub(super) fn farther(surface: &Surface, at: [f64; 2], point: &Point3, known: f64) -> f64 {
    let mut best = distance(surface, at, point);
    // Steps may go astray at poles and creases: from places around it, most find the foot.
    for k in 0..AROUND * AROUND {
        if best <= known {
            break;
        }
        let (i, j) = (k / AROUND, k % AROUND);
        let shift = |k: usize| k as f64 / AROUND as f64 - 0.5;
        let from = [
            at[0] + shift(j),
            (at[1] + BESIDE * shift(i)).clamp(0.0, 1.0),
        ];
        best = best.min(distance(surface, from, point));
    }
    known.max(best)
}

/// How far a point is from a surface, by a few steps of Newton's method from a place: no less than the least distance.
fn distance(surface: &Surface, mut at: [f64; 2], point: &Point3) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..4 {
        let frame = surface.frame(surface.knots_u().confine(at[0]), at[1]);
        let off = point - frame.point;
        let length = off.norm();
        if length.is_nan() || length >= best {
            break;
        }
        best = length;
        let (a, b) = (frame.du, frame.dv);
        let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
        let det = aa * bb - ab * ab;
        if det <= 1e-10 * aa * bb {
            break;
        }
        let (x, y) = (a.dot(&off), b.dot(&off));
        at[0] += (bb * x - ab * y) / det;
        if !surface.knots_u().is_periodic() {
            at[0] = at[0].clamp(0.0, 1.0);
        }
        at[1] = (at[1] + (aa * y - ab * x) / det).clamp(0.0, 1.0);
    }
    best
}
