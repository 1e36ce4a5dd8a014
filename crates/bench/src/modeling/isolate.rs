//! Isolation on the given pairs: each method's time, its length over the best known one, turn,
//! steps, tests. Triangles only, but for `surfaces`, which is `global` settled on the surfaces
//! themselves.

use super::super::measure::{clocked, time};
use super::super::{Effort, Row};
use palpate_geometry::math::Vector3;
use palpate_modeling::isolate::given::{self, GivenPair};
use palpate_modeling::isolate::{
    Body, IsolateMethod, IsolateSpec, IsolateStatus, Isolated, isolate_ready,
};
use std::time::Duration;

/// Cases `isolate/<pair>/<method>`, where a pair is its number.
pub(super) fn isolate(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for pair in given::all() {
        let number = pair.name.split(' ').next().unwrap_or_default().to_owned();
        let case = |method: &str| format!("isolate/{number}/{method}");
        let cases: Vec<(IsolateMethod, String)> = IsolateMethod::ALL
            .into_iter()
            .map(|method| (method, case(method.name())))
            .collect();
        if !cases.iter().any(|(_, case)| wanted(case))
            && !wanted(&case("overlap"))
            && !wanted(&case("surfaces"))
        {
            continue;
        }
        let bodies = pair.bodies();
        if wanted(&case("overlap")) {
            out(overlap_row(effort, &pair, &bodies, case("overlap")));
        }
        for (method, case) in cases {
            if wanted(&case) {
                let spec = IsolateSpec {
                    method,
                    exact: false,
                    fall_back: false,
                    ..IsolateSpec::default()
                };
                out(method_row(effort, &pair, &bodies, &spec, case));
            }
        }
        if wanted(&case("surfaces")) {
            out(method_row(
                effort,
                &pair,
                &bodies,
                &IsolateSpec::default(),
                case("surfaces"),
            ));
        }
    }
}

/// Overlap tests along the shortest translation, from the start past contact to twice its length;
/// and the gap beyond.
fn overlap_row(effort: Effort, pair: &GivenPair, [moving, fixed]: &[Body; 2], case: String) -> Row {
    let (calls, places) = (if effort == Effort::Quick { 200 } else { 10_000 }, 100);
    let least = pair.least_translation_m();
    let place = |k: usize| least * (2.0 * (k % places) as f64 / places as f64);
    let tests = time(calls, Duration::from_secs(5), |k| {
        clocked(|| moving.overlaps(&place(k), fixed)).0
    });
    let gaps = time(calls / 10, Duration::from_secs(5), |k| {
        let by = least * (1.0 + 0.02 * (k % 10 + 1) as f64);
        clocked(|| moving.gap_m(&by, fixed)).0
    });
    // Wrong: overlapping a thousandth beyond the end of the shortest translation, or apart a
    // hundredth before it.
    let wrong = usize::from(moving.overlaps(&(least * 1.001), fixed))
        + usize::from(!moving.overlaps(&(least * 0.99), fixed));
    Row {
        wrong: Some(wrong),
        ..Row::new("modeling", case, &pair.name).timed(tests)
    }
    .saying(format!(
        "one overlap test; the gap takes {:.1} us, at most {:.1}",
        gaps.median_s * 1e6,
        gaps.p99_s * 1e6
    ))
}

fn method_row(
    effort: Effort,
    pair: &GivenPair,
    [moving, fixed]: &[Body; 2],
    spec: &IsolateSpec,
    case: String,
) -> Row {
    let (calls, patience) = match effort {
        Effort::Quick => (3, Duration::from_millis(300)),
        Effort::Full => (50, Duration::from_secs(5)),
    };
    let mut answer: Option<Isolated> = None;
    let times = time(calls, patience, |_| {
        let (took, found) = clocked(|| {
            isolate_ready(
                (&pair.moving, moving),
                (&pair.fixed, fixed),
                &Vector3::zeros(),
                spec,
            )
        });
        answer = found.ok();
        took
    });
    let (error, note) = answer
        .as_ref()
        .map_or((None, String::new()), |answer| figures(pair, answer));
    let row = Row::new("modeling", case, &pair.name).timed(times);
    row.off_by(error, "of the least length").saying(note)
}

/// By how much the length at contact is above the least one known, and the rest in words.
fn figures(pair: &GivenPair, answer: &Isolated) -> (Option<f64>, String) {
    if let IsolateStatus::Failed(reason) = answer.status {
        return (None, format!("no answer: {reason}"));
    }
    let ratio = answer.contact_m.norm() / pair.least_m;
    let turn = answer
        .turn_deg
        .map_or("undefined".to_owned(), |turn| format!("{turn:.1} deg"));
    let note = format!(
        "ratio {ratio:.4}, turn {turn}, {} steps, {} regions, {} overlap tests",
        answer.steps, answer.regions, answer.overlap_tests
    );
    (Some(ratio - 1.0), note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_has_a_row_for_the_overlap_test_for_each_method_and_for_the_surfaces() {
        let mut rows = Vec::new();
        isolate(
            Effort::Quick,
            &|case| case.starts_with("isolate/01/"),
            &mut |row| rows.push(row),
        );
        assert_eq!(rows.len(), 2 + IsolateMethod::ALL.len());
        assert_eq!(rows[0].wrong, Some(0));
        let global = rows
            .iter()
            .find(|row| row.case == "isolate/01/global")
            .unwrap();
        assert!(global.error_size() < Some(0.05), "{global:?}");
    }
}
