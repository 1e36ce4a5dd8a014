//! What a tree must satisfy before anything is made of it: ranges of numbers, and rules R1 to R4 on
//! its parameters.

use super::error::{BranchError, Rule};
use super::section::arc_columns;
use super::tree::{Branch, End, Fork, Stem, Tree};
use palpate_geometry::basis::MAX_DEGREE;

/// Most leaves, forks on a way, free rows of a branch, and control points.
const MOST_LEAVES: usize = 1024;
const MOST_DEPTH: usize = 32;
const MOST_ROWS: usize = 4096;
const MOST_POINTS: usize = 1 << 21;

/// Columns before and after a joint may differ by this fraction of the width from lying opposite
/// each other.
const OPPOSITE: f64 = 1e-12;

type Checked = Result<(), BranchError>;

/// Refuses a tree that has no smooth surface.
pub(super) fn check(tree: &Tree) -> Checked {
    for (field, degree) in [("degree_u", tree.degree_u), ("degree_v", tree.degree_v)] {
        if !(2..=MAX_DEGREE).contains(&degree) {
            let place = "tree".to_owned();
            return Err(BranchError::Value {
                place,
                field,
                value: degree as f64,
                allowed: "2 to 15",
            });
        }
    }
    most("leaves", tree.leaves(), MOST_LEAVES)?;
    most("forks one above the other", tree.depth(), MOST_DEPTH)?;
    stem(tree, &tree.stem)?;
    let columns = tree.leaves() * (2 * arc_columns(tree.degree_u) + 1);
    let rows: usize = super::grow::row_counts(tree).iter().sum();
    most("control points", columns.saturating_mul(rows), MOST_POINTS)
}

fn most(what: &'static str, value: usize, most: usize) -> Checked {
    if value <= most {
        Ok(())
    } else {
        Err(BranchError::TooLarge { what, value, most })
    }
}

fn positive(place: &str, field: &'static str, value: f64) -> Checked {
    // Squares and cubes of lengths are taken: far within what a number holds.
    if value > 1e-30 && value < 1e30 {
        return Ok(());
    }
    Err(BranchError::Value {
        place: place.to_owned(),
        field,
        value,
        allowed: "above 0 and finite (1e-30 to 1e30)",
    })
}

fn finite(place: &str, field: &'static str, value: f64) -> Checked {
    if value.abs() < 1e30 {
        return Ok(());
    }
    Err(BranchError::Value {
        place: place.to_owned(),
        field,
        value,
        allowed: "finite (±1e30)",
    })
}

fn broken(rule: Rule, place: &str, what: String, fix: impl Into<String>) -> BranchError {
    BranchError::Rule {
        rule,
        place: place.to_owned(),
        what,
        fix: fix.into(),
    }
}

fn stem(tree: &Tree, stem: &Stem) -> Checked {
    positive("stem", "half_width_m", stem.half_width_m)?;
    positive("stem", "half_depth_m", stem.half_depth_m)?;
    positive("stem", "neighbour_m", stem.neighbour_m)?;
    positive("stem", "layer_m", stem.layer_m)?;
    positive("stem", "free_step_m", stem.free_step_m)?;
    most("free rows", stem.free_rows, MOST_ROWS)?;
    finite("stem", "free_widening", stem.free_widening)?;
    positive(
        "stem",
        "width of its end",
        1.0 + stem.free_widening * stem.free_rows as f64,
    )?;
    ordered("stem", stem.neighbour_m, stem.half_width_m)?;
    stem.fork
        .as_deref()
        .map_or(Ok(()), |f| fork(tree, f, "stem", &Below::of_stem(stem)))
}

/// The section that a fork stands on.
struct Below {
    neighbour_m: f64,
    layer_m: f64,
}

impl Below {
    fn of_stem(stem: &Stem) -> Self {
        Self {
            neighbour_m: stem.neighbour_m,
            layer_m: stem.layer_m,
        }
    }

    fn of_branch(branch: &Branch) -> Self {
        Self {
            neighbour_m: 2.0 * branch.end.half_width_m * branch.neighbour,
            layer_m: branch.layer_m(),
        }
    }
}

/// The neighbour of a joint lies before the corner.
fn ordered(place: &str, neighbour_m: f64, corner_m: f64) -> Checked {
    if neighbour_m < corner_m {
        return Ok(());
    }
    let what = format!(
        "the neighbour of the joint, {neighbour_m} m off, lies beyond the corner at {corner_m} m"
    );
    Err(broken(
        Rule::R4,
        place,
        what,
        format!("make neighbour_m less than {corner_m}"),
    ))
}

fn fork(tree: &Tree, fork: &Fork, place: &str, below: &Below) -> Checked {
    let at = format!("the fork of {place}");
    if fork.arch_m == 0.0 {
        let what = "arch_m is 0: the crotch is flat and the joints F and B are singular".to_owned();
        return Err(broken(Rule::R2, &at, what, "raise the arch, arch_m > 0"));
    }
    positive(&at, "arch_m", fork.arch_m)?;
    positive(&at, "neighbour_m", fork.neighbour_m)?;
    if fork.raise == 0.0 {
        let what =
            "raise is 0: the open book lies in the inverted T and the joint is singular".to_owned();
        return Err(broken(Rule::R3, &at, what, "make raise > 0"));
    }
    positive(&at, "raise", fork.raise)?;
    ordered(&at, fork.neighbour_m, fork.arch_m)?;
    let raise_m = fork.raise * below.layer_m;
    if fork.neighbour_m < raise_m {
        let what = format!(
            "ez = neighbour_m = {} m is less than d1 = raise × layer = {raise_m} m",
            fork.neighbour_m
        );
        return Err(broken(
            Rule::R4,
            &at,
            what,
            format!("make neighbour_m at least {raise_m} or raise less"),
        ));
    }
    for (hand, child) in fork.branches() {
        branch(tree, child, &super::grow::child_name(place, hand), below)?;
    }
    Ok(())
}

fn branch(tree: &Tree, branch: &Branch, place: &str, below: &Below) -> Checked {
    if branch.shift_m == 0.0 {
        let what = "shift_m is 0: the open book lies in the inverted T and the joint is singular"
            .to_owned();
        return Err(broken(Rule::R2, place, what, "make shift_m > 0"));
    }
    positive(place, "shift_m", branch.shift_m)?;
    if below.neighbour_m < branch.shift_m {
        let what = format!(
            "e = {} m below the fork is less than delta = shift_m = {} m",
            below.neighbour_m, branch.shift_m
        );
        return Err(broken(
            Rule::R4,
            place,
            what,
            format!("make shift_m at most {}", below.neighbour_m),
        ));
    }
    for (field, values) in [("outer_m", branch.outer_m), ("inner_m", branch.inner_m)] {
        values
            .iter()
            .try_for_each(|&value| finite(place, field, value))?;
    }
    let across = [
        branch.outer_m[0] - branch.inner_m[0],
        branch.outer_m[1] - branch.inner_m[1],
    ];
    positive(
        place,
        "distance of outer_m and inner_m",
        (across[0] * across[0] + across[1] * across[1]).sqrt(),
    )?;
    positive(place, "tilt_step_m", branch.tilt_step_m)?;
    positive(place, "free_step_m", branch.free_step_m)?;
    positive(place, "layer_m", branch.layer_m())?;
    finite(place, "turn_deg", branch.turn_deg)?;
    finite(place, "twist_deg", branch.twist_deg)?;
    most("free rows", branch.free_rows, MOST_ROWS)?;
    if branch.free_rows == 0 {
        let (place, value) = (place.to_owned(), 0.0);
        return Err(BranchError::Value {
            place,
            field: "free_rows",
            value,
            allowed: "at least 1: the last is the end",
        });
    }
    joints(tree, branch, place)?;
    end(tree, branch, place)?;
    branch
        .fork
        .as_deref()
        .map_or(Ok(()), |f| fork(tree, f, place, &Below::of_branch(branch)))
}

/// R1 on the tilted and free rows: as many as the degree wants, their joints within the section.
fn joints(tree: &Tree, branch: &Branch, place: &str) -> Checked {
    if branch.front.len() != tree.degree_v {
        let what = format!(
            "front names {} tilted rows; degree_v = {} needs as many",
            branch.front.len(),
            tree.degree_v
        );
        return Err(broken(
            Rule::R1,
            place,
            what,
            "give one number for each tilted row, from the fork up",
        ));
    }
    positive(place, "neighbour", branch.neighbour)?;
    for &front in branch.front.iter().chain([&branch.free_front]) {
        finite(place, "front", front)?;
        if front.abs() + branch.neighbour >= 0.5 {
            let what = format!(
                "front {front} and neighbour {} reach beyond the corner",
                branch.neighbour
            );
            return Err(broken(
                Rule::R1,
                place,
                what,
                "keep |front| + neighbour below 0.5",
            ));
        }
    }
    Ok(())
}

fn end(tree: &Tree, branch: &Branch, place: &str) -> Checked {
    positive(place, "end.half_width_m", branch.end.half_width_m)?;
    positive(place, "end.half_depth_m", branch.end.half_depth_m)?;
    let End {
        outline: Some(outline),
        ..
    } = &branch.end
    else {
        return Ok(());
    };
    if branch.fork.is_some() {
        let what = "its end has an outline of its own and a fork stands on it".to_owned();
        return Err(broken(
            Rule::R3,
            place,
            what,
            "leave the outline out: a fork needs a rectangle",
        ));
    }
    let n = arc_columns(tree.degree_u);
    if outline.len() != 2 * n {
        let what = format!(
            "the outline has {} points; degree_u = {} needs {}",
            outline.len(),
            tree.degree_u,
            2 * n
        );
        return Err(broken(
            Rule::R1,
            place,
            what,
            "give columns 0 to 4p + 3, the front joint first",
        ));
    }
    for value in outline.iter().flatten() {
        finite(place, "end.outline", *value)?;
    }
    for joint in [0, n] {
        let [before, at, after] =
            [(joint + 2 * n - 1) % (2 * n), joint, joint + 1].map(|k| outline[k]);
        let off = (0..2)
            .map(|c| (before[c] + after[c] - 2.0 * at[c]).abs())
            .fold(0.0, f64::max);
        if off > OPPOSITE {
            let what = format!(
                "the points beside column {joint} of the outline are {off} of a width off their line"
            );
            return Err(broken(
                Rule::R1,
                place,
                what,
                "place them opposite each other, as far from the joint",
            ));
        }
    }
    Ok(())
}
