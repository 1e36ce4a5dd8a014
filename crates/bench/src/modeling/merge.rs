//! Merging: the seven cases, by the source's method and by ours, at C² and C⁰, planned and from
//! scratch.
//!
//! The error is the standard deviation of the distances of all points that show; the note holds the
//! other statistics and the seam. `planned` has knots, parameters and fits at hand and new nets;
//! `from scratch` has two surfaces.

use crate::inputs::Random;
use crate::measure::{clocked, time};
use crate::{Effort, Row};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ControlNet, Surface};
use palpate_modeling::merge::cases::{MergeCase, cases};
use palpate_modeling::merge::{MergeMethod, MergeSpec, Report, merge as merge_patches};
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
    if wanted("merge/random100") {
        random(if effort == Effort::Full { 100 } else { 10 }, out);
    }
}

/// Pairs that nobody chose: what the seven cases cannot say.
fn random(pairs: usize, out: &mut dyn FnMut(Row)) {
    for continuity in CONTINUITIES {
        let mut random = Random(7);
        let (mut ratios, mut refused) = (Vec::new(), 0);
        let times = time(pairs, Duration::MAX, |_| {
            let patches = random_pair(&mut random);
            let deviation = |method| {
                let spec = MergeSpec {
                    continuity,
                    method,
                    ..MergeSpec::default()
                };
                let (took, merged) = clocked(|| merge_patches(&patches, &spec));
                (
                    took,
                    merged
                        .ok()
                        .map(|merged| merged.report(&patches).deviation.standard_m),
                )
            };
            let ((took, ours), (_, seed)) = (
                deviation(MergeMethod::Constrained),
                deviation(MergeMethod::Seed),
            );
            match (ours, seed) {
                (Some(ours), Some(seed)) => ratios.push(ours / seed),
                _ => refused += 1,
            }
            took
        });
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = ratios.len().checked_sub(1)?;
            ratios.get(last * (share * 100.0) as usize / 100).copied()
        };
        let spread = [at(0.5), at(0.9), at(1.0)].map(|ratio| match ratio {
            Some(ratio) => format!("{ratio:.2}"),
            None => "none".to_owned(),
        });
        let method = format!("constrained C{continuity} from scratch");
        let row = Row::new("modeling", "merge/random100", method).timed(times);
        out(row
            .off_by(at(0.5), "of the seed's standard deviation")
            .saying(format!(
                "median {}, nine of ten below {}, largest {}; {} of {} above a half, {refused} refused",
                spread[0],
                spread[1],
                spread[2],
                ratios.iter().filter(|&&ratio| ratio > 0.5).count(),
                ratios.len(),
            )));
    }
}

/// Two bicubic patches of 50 × 100 mm side by side, with uneven knots and waves of some millimetres
/// each; their edges are up to 0.3 mm apart.
fn random_pair(random: &mut Random) -> [Surface; 2] {
    let columns = 4 + (5.0 * random.unit()) as usize;
    let mut height = || {
        let waves: [[f64; 4]; 3] = std::array::from_fn(|k| {
            let size = 4e-3 / (k + 1) as f64;
            [
                size * random.unit(),
                90.0 * random.unit(),
                60.0 * random.unit(),
                std::f64::consts::TAU * random.unit(),
            ]
        });
        move |x: f64, y: f64| {
            waves
                .iter()
                .map(|[size, a, b, phase]| size * libm::sin(a * x + b * y + phase))
                .sum::<f64>()
        }
    };
    let (left, right) = (height(), height());
    let mut knots = |count: usize| {
        let mut knots = vec![0.0; 4];
        let spans: Vec<f64> = (0..count - 3).map(|_| 0.3 + random.unit()).collect();
        let (whole, mut at) = (spans.iter().sum::<f64>(), 0.0);
        for span in &spans[..spans.len() - 1] {
            at += span / whole;
            knots.push(at);
        }
        knots.extend([1.0; 4]);
        KnotVector::new(3, knots).expect("ascending knots")
    };
    let rows = [4 + columns % 3, 5 + columns % 4];
    let (u, v) = ([knots(rows[0]), knots(rows[1])], knots(columns));
    let gap_m = 3e-4 * random.unit();
    let net = |start: f64, knots: &KnotVector, z: &dyn Fn(f64, f64) -> f64| {
        let places = knots.greville();
        let point = |x: f64, y: f64| Point3::new(start + 0.05 * x, 0.1 * y, z(0.05 * x, 0.1 * y));
        let points = places
            .iter()
            .flat_map(|&x| v.greville().into_iter().map(move |y| (x, y)))
            .map(|(x, y)| point(x, y));
        ControlNet::new(places.len(), columns, points.collect()).expect("a full net")
    };
    // The second begins as high as the first ends, and goes its own way from there.
    let follow = |x: f64, y: f64| left(0.05, y) + right(x, y) - right(0.0, y);
    let nets = [net(0.0, &u[0], &left), net(0.05 + gap_m, &u[1], &follow)];
    let [a, b] = nets;
    let [ua, ub] = u;
    let surface = |u, net| Surface::new(u, v.clone(), net, None).expect("knots and net fit");
    [surface(ua, a), surface(ub, b)]
}

fn rows(name: &str, case: &MergeCase, effort: Effort, out: &mut dyn FnMut(Row)) {
    for continuity in CONTINUITIES {
        for (label, method) in [
            ("constrained", MergeMethod::Constrained),
            ("seed", MergeMethod::Seed),
        ] {
            let spec = MergeSpec {
                continuity,
                method,
                ..case.spec.clone()
            };
            let Ok(merged) = merge_patches(&case.patches, &spec) else {
                continue;
            };
            let report = merged.report(&case.patches);
            let counts = [merged.surface.net().rows(), merged.surface.net().columns()];
            let note = note(&report, counts);
            let plan = merged.plan.expect("fits have plans");
            let mut row = |way: &str, work: &mut dyn FnMut()| {
                let calls = if effort == Effort::Full { 2000 } else { 100 };
                let times = time(
                    calls,
                    Duration::from_secs(if effort == Effort::Full { 10 } else { 1 }),
                    |_| clocked(&mut *work).0,
                );
                let of = format!("{label} C{continuity} {way}");
                let row = Row::new("modeling", name, of).timed(times);
                out(Row {
                    peer: method == MergeMethod::Seed,
                    ..row.off_by(report.deviation.standard_m, "m").saying(&note)
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
    let worst = |of: fn(&palpate_modeling::merge::Continuity) -> f64| {
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
