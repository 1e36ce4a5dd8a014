//! Isolation on the given pairs: each method's time, its length over the best known one, turn, steps, tests.

use super::super::measure::time;
use super::super::{Effort, Row};
use crate::math::Vector3;
use crate::modeling::isolate::given::{self, GivenPair};
use crate::modeling::isolate::{IsolateSpec, Isolated, Method, Status, isolate_ready};
use std::time::{Duration, Instant};

/// Cases `isolate/<pair>/<method>`, where a pair is its number.
pub(super) fn isolate(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for pair in given::all() {
        let number = pair.name.split(' ').next().unwrap_or_default().to_owned();
        let case = |method: &str| format!("isolate/{number}/{method}");
        let cases: Vec<(Method, String)> =
            Method::ALL.into_iter().map(|method| (method, case(method.name()))).collect();
        if !cases.iter().any(|(_, case)| wanted(case)) && !wanted(&case("overlap")) {
            continue;
        }
        let bodies = pair.bodies();
        for (method, case) in cases {
            if wanted(&case) {
                out(method_row(effort, &pair, &bodies, method, case));
            }
        }
    }
}

fn method_row(
    effort: Effort,
    pair: &GivenPair,
    [moving, fixed]: &[crate::modeling::isolate::Body; 2],
    method: Method,
    case: String,
) -> Row {
    let spec = IsolateSpec { method, exact: false, fall_back: false, ..IsolateSpec::default() };
    let (calls, patience) = match effort {
        Effort::Quick => (3, Duration::from_millis(300)),
        Effort::Full => (50, Duration::from_secs(5)),
    };
    let mut answer: Option<Isolated> = None;
    let times = time(calls, patience, |_| {
        let start = Instant::now();
        let found = isolate_ready((&pair.moving, moving), (&pair.fixed, fixed), &Vector3::zeros(), &spec);
        let took = start.elapsed();
        answer = found.ok();
        took
    });
    let (error, note) = answer.as_ref().map_or((f64::NAN, String::new()), |answer| figures(pair, answer));
    Row {
        suite: "modeling",
        case,
        method: pair.name.clone(),
        peer: false,
        median_s: times.median_s,
        p99_s: times.p99_s,
        error,
        error_unit: "of the least length",
        n: times.n,
        wrong: None,
        note,
    }
}

/// By how much the length at contact is above the least one known, and the rest in words.
fn figures(pair: &GivenPair, answer: &Isolated) -> (f64, String) {
    if let Status::Failed(reason) = answer.status {
        return (f64::NAN, format!("no answer: {reason}"));
    }
    let ratio = answer.contact_m.norm() / pair.least_m;
    let turn = answer.turn_deg.map_or("undefined".to_owned(), |turn| format!("{turn:.1} deg"));
    let note = format!(
        "ratio {ratio:.4}, turn {turn}, {} steps, {} regions, {} overlap tests",
        answer.steps, answer.regions, answer.overlap_tests
    );
    (ratio - 1.0, note)
}
