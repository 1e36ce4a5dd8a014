//! Branching surfaces: the time that a net takes, with its gap and angles beside it.

use crate::inputs::Random;
use crate::measure::{clocked, time};
use crate::{Effort, Row};
use palpate_modeling::branch::{Fork, GOAL_ANGLE_DEG, GOAL_GAP, Measures, Tree, grow, joints};
use std::time::Duration;

const CASES: [(&str, &str, &str); 2] = [
    (
        "branch/34x15",
        "y",
        include_str!("../../../modeling/src/branch/data/y.toml"),
    ),
    (
        "branch/68x27",
        "four",
        include_str!("../../../modeling/src/branch/data/four.toml"),
    ),
];

pub(super) fn branch(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for (case, name, text) in CASES.into_iter().filter(|(case, ..)| wanted(case)) {
        let tree: Tree = toml::from_str(text).expect("the tree is part of the program");
        generation(case, name, &tree, effort, out);
        measurement(case, name, &tree, effort, out);
        varied(case, name, &tree, effort, out);
    }
}

fn generation(case: &str, name: &str, tree: &Tree, effort: Effort, out: &mut dyn FnMut(Row)) {
    let grown = grow(tree).expect("the tree is part of the program");
    let (measures, _) = Measures::of(&grown.surface, &grown.patches);
    let n = if effort == Effort::Full { 10_000 } else { 300 };
    let times = time(n, Duration::from_secs(20), |_| clocked(|| grow(tree)).0);
    let row = Row::new("modeling", case, format!("grow {name}")).timed(times);
    out(Row {
        wrong: Some(measures.misses(GOAL_ANGLE_DEG).len()),
        ..row.off_by(measures.angle_deg, "deg")
    }
    .saying(format!(
        "gap {:.1e} m, least sine {:.3}, Euler number {}, {} folded, {} crossing, coverage {:.3}",
        measures.gap_m,
        measures.min_sine,
        measures.euler,
        measures.folded,
        measures.crossings,
        measures.coverage
    )));
}

fn measurement(case: &str, name: &str, tree: &Tree, effort: Effort, out: &mut dyn FnMut(Row)) {
    let grown = grow(tree).expect("the tree is part of the program");
    let n = if effort == Effort::Full { 50 } else { 3 };
    let times = time(n, Duration::from_secs(20), |_| {
        clocked(|| Measures::of(&grown.surface, &grown.patches).0).0
    });
    let (measures, _) = Measures::of(&grown.surface, &grown.patches);
    let row = Row::new("modeling", case, format!("measure {name}")).timed(times);
    out(row.off_by(measures.gap_m, "m").saying(format!(
        "{} joints, {} triangles",
        measures.joints.len(),
        measures.triangles
    )));
}

/// Trees of the same shape and any proportions within the rules: generation timed, joints measured.
fn varied(case: &str, name: &str, tree: &Tree, effort: Effort, out: &mut dyn FnMut(Row)) {
    let n = if effort == Effort::Full { 3_000 } else { 100 };
    let mut random = Random(68);
    let (mut angle_deg, mut gap, mut least_sine, mut wrong) = (0.0_f64, 0.0_f64, 1.0_f64, 0);
    let times = time(n, Duration::from_secs(60), |_| {
        let tree = variation(tree, &mut random);
        let (elapsed, grown) = clocked(|| grow(&tree));
        let Ok(grown) = grown else {
            wrong += 1;
            return elapsed;
        };
        let (mut worst_deg, mut worst_gap) = (0.0_f64, 0.0_f64);
        for joint in joints(&grown.surface, &grown.patches) {
            worst_deg = worst_deg.max(joint.angle_deg);
            worst_gap = worst_gap.max(joint.gap_m / grown.surface.size());
            least_sine = least_sine.min(joint.min_sine);
        }
        wrong += usize::from(worst_deg > GOAL_ANGLE_DEG || worst_gap > GOAL_GAP);
        (angle_deg, gap) = (angle_deg.max(worst_deg), gap.max(worst_gap));
        elapsed
    });
    let row = Row::new("modeling", case, format!("grow {name}, varied")).timed(times);
    out(Row {
        wrong: Some(wrong),
        ..row.off_by(angle_deg, "deg")
    }
    .saying(format!(
        "gap {gap:.1e} of the size, least sine {least_sine:.3}"
    )));
}

/// Every fork's height, shifts, tilts, turns and ends changed at random, R4 kept.
fn variation(tree: &Tree, random: &mut Random) -> Tree {
    let mut tree = tree.clone();
    let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
    tree.stem.half_depth_m *= between(0.7, 1.2);
    let mut layer_m = tree.stem.layer_m;
    let mut forks: Vec<(&mut Fork, f64)> = tree
        .stem
        .fork
        .as_deref_mut()
        .map(|fork| (fork, layer_m))
        .into_iter()
        .collect();
    while let Some((fork, below_m)) = forks.pop() {
        fork.arch_m *= between(0.9, 1.3);
        fork.raise *= between(0.5, 1.2);
        fork.neighbour_m = fork.raise * below_m * between(1.0, 1.6);
        for branch in [&mut fork.left, &mut fork.right] {
            branch.shift_m *= between(0.5, 1.3);
            branch.outer_m[1] *= between(0.9, 1.1);
            branch.inner_m[1] += between(0.0, 0.2) * branch.inner_m[1];
            branch.turn_deg += between(-15.0, 15.0);
            branch.twist_deg += between(-60.0, 60.0);
            branch.end.half_depth_m *= between(0.8, 1.1);
            layer_m = branch.layer_m();
            forks.extend(branch.fork.as_deref_mut().map(|fork| (fork, layer_m)));
        }
    }
    tree
}
