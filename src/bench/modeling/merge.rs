//! Merging: the seven cases, by the source's method and by ours, at C² and C⁰, planned and from scratch.
//!
//! The error is the standard deviation of the distances of all points that show; the note holds the other statistics and
//! the seam. `planned` has knots, parameters and fits at hand and new nets; `from scratch` has two surfaces.

use crate::bench::measure::{clocked, time};
use crate::bench::{Effort, Row};
use crate::modeling::merge::cases::{Case, cases};
use crate::modeling::merge::{MergeSpec, Method, Report, merge as merge_patches};
use std::time::Duration;

/// Both continuities of the source's tables.
const CONTINUITIES: [usize; 2] = [2, 0];

pub(super) fn merge(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for case in cases() {
        let name = format!("merge/case{}", case.number);
        if wanted(&name) {
            rows(&name, &case, effort, out);
        }
    }
}

fn rows(name: &str, case: &Case, effort: Effort, out: &mut dyn FnMut(Row)) {
    for continuity in CONTINUITIES {
        for (label, method) in [("constrained", Method::Constrained), ("seed", Method::Seed)] {
            let spec = MergeSpec { continuity, method, ..case.spec.clone() };
            let Ok(merged) = merge_patches(&case.patches, &spec) else { continue };
            let report = merged.report(&case.patches);
            let counts = [merged.surface.net().rows(), merged.surface.net().columns()];
            let note = note(&report, counts);
            let plan = merged.plan.expect("fits have plans");
            let mut row = |way: &str, work: &mut dyn FnMut()| {
                let calls = if effort == Effort::Full { 2000 } else { 100 };
                let times = time(calls, Duration::from_secs(if effort == Effort::Full { 10 } else { 1 }), |_| {
                    clocked(&mut *work).0
                });
                out(Row {
                    suite: "modeling",
                    case: name.to_owned(),
                    method: format!("{label} C{continuity} {way}"),
                    peer: method == Method::Seed,
                    median_s: times.median_s,
                    p99_s: times.p99_s,
                    error: report.deviation.standard_m,
                    error_unit: "m",
                    n: times.n,
                    wrong: None,
                    note: note.clone(),
                });
            };
            row("planned", &mut || {
                std::hint::black_box(plan.merge(&case.patches).is_ok());
            });
            row("from scratch", &mut || {
                std::hint::black_box(merge_patches(&case.patches, &spec).is_ok());
            });
        }
    }
}

fn note(report: &Report, [rows, columns]: [usize; 2]) -> String {
    let d = &report.deviation;
    let mm = |x: f64| x * 1e3;
    let worst = |of: fn(&crate::modeling::merge::Continuity) -> f64| {
        report.seams.iter().map(|(_, c)| of(c)).fold(0.0, f64::max)
    };
    format!(
        "{rows}x{columns} net, {} points: {:.4} average, {:.4} median, {:.4} standard, {:.4} mm at most, {} close; seam {:.1e} mm, {:.1e} deg, curvature jump {:.1e} of {:.1} 1/m",
        d.points,
        mm(d.average_m),
        mm(d.median_m),
        mm(d.standard_m),
        mm(d.maximum_m),
        d.close,
        mm(worst(|c| c.gap_m)),
        worst(|c| c.tangent_deg),
        worst(|c| c.curvature_jump_per_m),
        worst(|c| c.curvature_per_m),
    )
}
