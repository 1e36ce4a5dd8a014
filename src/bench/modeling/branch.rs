//! Branching surfaces: the time that a net takes, with its gap and angles beside it.

use crate::bench::measure::{clocked, time};
use crate::bench::{Effort, Row};
use crate::modeling::branch::{Measures, Tree, grow};
use std::time::Duration;

const CASES: [(&str, &str, &str); 2] = [
    ("branch/34x15", "y", include_str!("../../modeling/branch/data/y.toml")),
    ("branch/68x27", "four", include_str!("../../modeling/branch/data/four.toml")),
];

pub(super) fn branch(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for (case, name, text) in CASES.into_iter().filter(|(case, ..)| wanted(case)) {
        let tree: Tree = toml::from_str(text).expect("the tree is part of the program");
        generation(case, name, &tree, effort, out);
        measurement(case, name, &tree, effort, out);
    }
}

fn generation(case: &str, name: &str, tree: &Tree, effort: Effort, out: &mut dyn FnMut(Row)) {
    let grown = grow(tree).expect("the tree is part of the program");
    let (measures, _) = Measures::of(&grown.surface, &grown.patches);
    let n = if effort == Effort::Full { 10_000 } else { 300 };
    let times = time(n, Duration::from_secs(20), |_| clocked(|| grow(tree)).0);
    out(Row {
        suite: "modeling",
        case: case.to_owned(),
        method: format!("grow {name}"),
        peer: false,
        median_s: times.median_s,
        p99_s: times.p99_s,
        error: measures.angle_deg,
        error_unit: "deg",
        n: times.n,
        wrong: Some(measures.misses(crate::modeling::branch::GOAL_ANGLE_DEG).len()),
        note: format!(
            "gap {:.1e} m, least sine {:.3}, Euler number {}, {} folded, {} crossing, coverage {:.3}",
            measures.gap_m, measures.min_sine, measures.euler, measures.folded, measures.crossings, measures.coverage
        ),
    });
}

fn measurement(case: &str, name: &str, tree: &Tree, effort: Effort, out: &mut dyn FnMut(Row)) {
    let grown = grow(tree).expect("the tree is part of the program");
    let n = if effort == Effort::Full { 50 } else { 3 };
    let times = time(n, Duration::from_secs(20), |_| clocked(|| Measures::of(&grown.surface, &grown.patches).0).0);
    let (measures, _) = Measures::of(&grown.surface, &grown.patches);
    out(Row {
        suite: "modeling",
        case: case.to_owned(),
        method: format!("measure {name}"),
        peer: false,
        median_s: times.median_s,
        p99_s: times.p99_s,
        error: measures.gap_m,
        error_unit: "m",
        n: times.n,
        wrong: Some(0),
        note: format!("{} joints, {} triangles", measures.joints.len(), measures.triangles),
    });
}
