//! Both ways to merge patches that end on curves, measured alike: on all points that show.

use super::build::evenly;
use super::ground::Ground;
use super::report::{Deviation, deviation_of};
use super::sheet::Sheet;
use super::{BlockRows, HideBy, MergeError, MergeMethod, MergeSpec, Merged};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// One way to hide what lies beyond the curves, and what it came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Which way.
    pub hide_by: HideBy,
    /// What it misses; or why it cannot be gone.
    pub outcome: Result<Seen, MergeError>,
}

impl Reading {
    /// As JSON, lengths in metres: `hidden`, with `deviation` and `lost_share`, or with why it was `refused`.
    pub fn words(&self) -> serde_json::Value {
        let hidden = self.hide_by.name();
        match &self.outcome {
            Ok(seen) => serde_json::json!({
                "hidden": hidden, "deviation": seen.deviation, "lost_share": seen.lost_share(),
            }),
            Err(error) => serde_json::json!({ "hidden": hidden, "refused": error.to_string() }),
        }
    }
}

/// What a merged surface misses of what shows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Seen {
    /// Of all points that show of evenly divided patches, whether they were used or not.
    pub deviation: Deviation,
    /// How many of them lie in rows that were dropped.
    pub lost: usize,
}

impl Seen {
    /// Of all points that show, those that were lost.
    pub fn lost_share(&self) -> f64 {
        self.lost as f64 / self.deviation.points.max(1) as f64
    }
}

/// The way that is asked for; else the better one of both.
pub(super) fn taken(
    surfaces: &[Surface],
    ground: &Ground,
    spec: &MergeSpec,
    merge: impl Fn(HideBy) -> Result<Merged, MergeError>,
) -> Result<Merged, MergeError> {
    // The source drops rows: its method does unless it is asked otherwise.
    let source = (spec.method == MergeMethod::Seed).then_some(HideBy::Rows);
    let only = spec.hide_by.or(source);
    let mut readings = Vec::new();
    let mut best: Option<(Merged, HideBy, f64)> = None;
    for (_, hide_by) in HideBy::ALL {
        if only.is_some_and(|only| only != hide_by) {
            continue;
        }
        let tried = merge(hide_by).and_then(|merged| {
            let sheets = ground.sheets(surfaces, hide_by)?;
            let seen = seen(&merged, ground, &sheets, spec.points);
            Ok((merged, seen))
        });
        let outcome = tried.map(|(merged, seen)| {
            let standard_m = seen.deviation.standard_m;
            if best.as_ref().is_none_or(|(.., least)| standard_m < *least) {
                best = Some((merged, hide_by, standard_m));
            }
            seen
        });
        readings.push(Reading { hide_by, outcome });
    }
    let Some((merged, by, _)) = best else {
        // What lines want is more, so what they lack says more.
        let refused = readings.into_iter().rev().find_map(|r| r.outcome.err());
        return Err(refused.expect("a way that was tried and is not taken was refused"));
    };
    Ok(Merged {
        readings,
        hide_by: Some(by),
        ..merged
    })
}

/// Distances of all points that show of the patches, divided evenly. Where a row was dropped a point has no parameters: its
/// closest point is searched on all of the surface.
fn seen(merged: &Merged, ground: &Ground, sheets: &[Sheet], points: usize) -> Seen {
    let mut solver = ClosestSolver::new(&merged.surface);
    let even = evenly(points);
    let d = ground.across();
    let mut distances = Vec::new();
    let mut lost = 0;
    for (place, sheet) in sheets.iter().enumerate() {
        let blocks = [0, 1].map(|k| &merged.rows[k][if k == d { place } else { 0 }]);
        for (&f, &g) in even.iter().flat_map(|f| even.iter().map(move |g| (f, g))) {
            if !ground.shows(place, [f, g]) {
                continue;
            }
            let along = sheet.along_lines([f, g]);
            let [u, v] = [0, 1].map(|k| parameter(blocks[k], along[k]));
            let point = sheet.point(along);
            distances.push(match (u, v) {
                (Some(u), Some(v)) => merged.distance(&solver, &point, [u, v]),
                _ => {
                    lost += 1;
                    solver.closest(&merged.surface, &point).distance
                }
            });
        }
    }
    let deviation = deviation_of(&distances);
    Seen { deviation, lost }
}

/// The merged parameter of a fraction; none beyond the rows.
fn parameter(rows: &BlockRows, fraction: f64) -> Option<f64> {
    let ends = |x: &[f64]| [x[0], x[x.len() - 1]];
    let ([start, end], [from, to]) = (ends(&rows.fractions), ends(&rows.parameters));
    let share = (fraction - start) / (end - start);
    // A point on a curve may be rounded past the end of its line.
    let within = (-1e-9..=1.0 + 1e-9).contains(&share);
    within.then(|| from + share.clamp(0.0, 1.0) * (to - from))
}
