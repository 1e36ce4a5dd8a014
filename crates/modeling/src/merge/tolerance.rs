//! Knots inserted until no point is farther off than a tolerance.
//!
//! Each round measures all points, and as many between them; when one is too far off, the direction
//! whose lines miss more gets a knot in the middle of the span where they miss most. Beside a
//! crease spans are halved again and again: the blend becomes sharper.

use super::axis::Axis;
use super::build::Job;
use super::fit::{Ends, LineFit};
use super::search::Data;
use super::sheet::Sheet;
use super::{MergeError, Merged};

/// Most knots inserted in one merge.
const MOST: usize = 96;
/// Inserted between two measurements of all points, at least.
const AT_ONCE: usize = 2;
/// A span is not halved below this share of the domain.
const LEAST_SPAN: f64 = 1e-5;
/// Rows of the patches for each control point, at least.
const ROWS_EACH: f64 = 1.5;

pub(super) fn merge(mut job: Job, tolerance_m: f64) -> Result<Merged, MergeError> {
    let mut merged = job.merged()?;
    let mut inserted = 0;
    loop {
        let worst_m = worst(&merged, &job.sheets, tolerance_m);
        if worst_m <= tolerance_m || inserted >= MOST {
            merged.within_tolerance = Some(worst_m <= tolerance_m);
            return Ok(merged);
        }
        let before = inserted;
        // A quarter more knots a round: measuring all points costs more than a knot too many.
        for _ in 0..AT_ONCE.max(inserted / 4) {
            inserted += usize::from(insert(&mut job));
        }
        if inserted == before {
            merged.within_tolerance = Some(false);
            return Ok(merged);
        }
        merged = job.merged()?;
    }
}

/// Largest distance of all points and of those between them, m; between them only once the points
/// themselves are near.
fn worst(merged: &Merged, sheets: &[Sheet], tolerance_m: f64) -> f64 {
    let largest = |distances: Vec<f64>| distances.into_iter().fold(0.0, f64::max);
    let at_points = largest(merged.distances(sheets));
    if at_points > tolerance_m {
        at_points
    } else {
        at_points.max(largest(merged.distances_between(sheets)))
    }
}

/// One knot where lines miss most; false when no span may be halved.
fn insert(job: &mut Job) -> bool {
    let mut best: Option<(f64, usize, f64)> = None;
    for d in [0, 1] {
        let choice = &job.choices[d];
        let rows: usize = job.fractions[d].iter().map(Vec::len).sum();
        let Ok(knots) = choice.knots.vector() else {
            continue;
        };
        if (knots.count() + 1) as f64 * ROWS_EACH > rows as f64 {
            continue;
        }
        for (start, end, miss) in span_misses(&job.axes[d], choice) {
            if end - start > LEAST_SPAN && best.is_none_or(|(most, ..)| miss > most) {
                best = Some((miss, d, 0.5 * (start + end)));
            }
        }
    }
    let Some((_, d, knot)) = best else {
        return false;
    };
    job.choices[d].knots.insert(knot);
    true
}

/// Spans and the largest miss of the lines in each, m²; spans without a sample have none.
fn span_misses(axis: &Axis, choice: &super::search::Choice) -> Vec<(f64, f64, f64)> {
    let data = Data::new(axis, &choice.at);
    let Ok(knots) = choice.knots.vector() else {
        return Vec::new();
    };
    let fit = LineFit::new(&knots, &data.parameters, Ends::Held);
    let misses = fit.misses(
        &data.samples,
        &fit.rough(&data.samples, data.width),
        data.width,
    );
    let largest = |row: &[f64]| {
        row.chunks_exact(3)
            .map(|x| x.iter().map(|x| x * x).sum::<f64>())
            .fold(0.0, f64::max)
    };
    let rows: Vec<(f64, f64)> = data
        .parameters
        .iter()
        .copied()
        .zip(misses.chunks_exact(data.width).map(largest))
        .collect();
    let t = knots.knots();
    let spans = knots.spans().map(|i| {
        let inside = rows.iter().filter(|(at, _)| *at >= t[i] && *at <= t[i + 1]);
        (
            t[i],
            t[i + 1],
            inside
                .map(|(_, miss)| *miss)
                .fold(f64::NEG_INFINITY, f64::max),
        )
    });
    spans.filter(|(.., miss)| miss.is_finite()).collect()
}
