//! Pipes: the ten spines of the table, and random ones against dense sampling.

use crate::measure::{Times, clocked, time};
use crate::{Effort, Row};
use palpate_modeling::pipe::cases::{PipeCase, cases};
use palpate_modeling::pipe::oracle::{Comparison, compare, random_spine};
use palpate_modeling::pipe::{PipeLimits, Spine, body_to_body};
use std::time::Duration;

/// Cells in each direction of the twin's grid.
const SAMPLES: usize = 240;

pub(super) fn pipe(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for case in cases() {
        let name = format!("pipe/{}", case.name);
        if wanted(&name) {
            for row in table_case(&name, &case, effort) {
                out(row);
            }
        }
    }
    if wanted("pipe/random1000") {
        out(random(effort));
    }
}

fn row(
    case: &str,
    method: &str,
    times: Times,
    error: (f64, &'static str),
    wrong: usize,
    note: String,
) -> Row {
    Row {
        wrong: Some(wrong),
        ..Row::new("modeling", case, method)
            .timed(times)
            .off_by(error.0, error.1)
            .saying(note)
    }
}

/// All bounds, and the pairs alone.
fn table_case(name: &str, case: &PipeCase, effort: Effort) -> [Row; 2] {
    let curve = case.curve();
    let spine = Spine::new(&curve).expect("a spine of the table");
    let calls = if effort == Effort::Quick { 20 } else { 400 };
    let all = time(calls, Duration::from_secs(4), |_| {
        clocked(|| PipeLimits::of(&curve)).0
    });
    let pairs = time(calls, Duration::from_secs(4), |_| {
        clocked(|| body_to_body(&spine)).0
    });
    let limits = PipeLimits::of_spine(&spine);
    let (error, wrong) = radius_error(case, &limits);
    let found: Vec<[f64; 2]> = limits
        .body
        .pairs
        .iter()
        .map(|pair| pair.parameters)
        .collect();
    let comparison = if spine.is_closed() {
        known_pairs(case, &limits)
    } else {
        compare(&curve, &found, SAMPLES)
    };
    let r_max = limits
        .r_max_m()
        .map_or(f64::INFINITY, |(radius_m, _)| radius_m);
    let note = format!("r_max {r_max:.12}");
    let counted = format!(
        "{} pairs, {} missed, {} boxes",
        comparison.pairs, comparison.missed, limits.body.boxes
    );
    [
        row(name, "all bounds", all, (error, "of r"), wrong, note),
        row(
            name,
            "stationary pairs",
            pairs,
            (comparison.error, "of t"),
            comparison.missed + comparison.wrong,
            counted,
        ),
    ]
}

/// Largest relative error of the bounds that the table knows, and how many are off by more than
/// 1e-10.
fn radius_error(case: &PipeCase, limits: &PipeLimits) -> (f64, usize) {
    let wanted = [Some(case.r_local), case.r_bb, case.r_ee, case.r_eb];
    let (mut worst, mut wrong) = (0.0_f64, 0);
    for ((_, found), wanted) in limits.bounds_m().into_iter().zip(wanted) {
        // Distance 0 of a crossing is found to the rounding of coordinates of size 1.
        let error = match (found, wanted) {
            (Some(found), Some(wanted)) if wanted > 1e-15 => (found - wanted).abs() / wanted,
            (Some(found), Some(_)) if found < 1e-14 => 0.0,
            (_, None) => 0.0,
            _ => f64::INFINITY,
        };
        worst = worst.max(error);
        wrong += usize::from(error > 1e-10);
    }
    (worst, wrong)
}

/// A closed spine's pairs against the table: the twin samples open curves.
fn known_pairs(case: &PipeCase, limits: &PipeLimits) -> Comparison {
    let (start, end) = case.curve().knots().domain();
    let inside = |t: f64| if t < start { t + (end - start) } else { t };
    let mut comparison = Comparison {
        pairs: limits.body.pairs.len(),
        ..Comparison::default()
    };
    for wanted in &case.pairs {
        let mut at = [inside(wanted[0]), inside(wanted[1])];
        at.sort_by(f64::total_cmp);
        let difference =
            |pair: [f64; 2]| (pair[0] - at[0]).abs().max((pair[1] - at[1]).abs()) / (end - start);
        let nearest = limits
            .body
            .pairs
            .iter()
            .map(|pair| difference(pair.parameters))
            .fold(f64::INFINITY, f64::min);
        if nearest < 1e-7 {
            comparison.error = comparison.error.max(nearest);
        } else {
            comparison.missed += 1;
        }
    }
    comparison
}

/// A thousand random spines, a tenth of them when quick.
fn random(effort: Effort) -> Row {
    let spines = if effort == Effort::Quick { 100 } else { 1_000 };
    let mut sum = Comparison::default();
    let (mut most_boxes, mut doubtful) = (0, 0);
    let times = time(spines, Duration::MAX, |k| {
        let curve = random_spine(1 + k as u64);
        let (took, body) =
            clocked(|| body_to_body(&Spine::new(&curve).expect("a random spine is regular")));
        let found: Vec<[f64; 2]> = body.pairs.iter().map(|pair| pair.parameters).collect();
        let comparison = compare(&curve, &found, SAMPLES);
        sum = Comparison {
            pairs: sum.pairs + comparison.pairs,
            missed: sum.missed + comparison.missed,
            wrong: sum.wrong + comparison.wrong,
            unseen: sum.unseen + comparison.unseen,
            error: sum.error.max(comparison.error),
        };
        most_boxes = most_boxes.max(body.boxes);
        doubtful += usize::from(body.status != palpate_modeling::ipp::Status::Complete);
        took
    });
    let Comparison {
        pairs,
        missed,
        wrong,
        unseen,
        error,
    } = sum;
    let note = format!(
        "{pairs} pairs, {missed} missed, {wrong} extra, {unseen} unseen by sampling, {doubtful} incomplete, {most_boxes} boxes at most"
    );
    row(
        "pipe/random1000",
        "stationary pairs",
        times,
        (error, "of t"),
        missed + wrong,
        note,
    )
}
