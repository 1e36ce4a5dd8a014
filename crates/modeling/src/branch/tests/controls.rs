//! Negative controls: each rule broken in a net, and what the measures say to it.

use super::*;
use palpate_geometry::math::Vector3;

fn y() -> Surface {
    grow(&trees()[0].1).unwrap().surface
}

/// The Y with some control points of both leaves moved: (leaf's column, row, side of the leaf) to a
/// displacement.
fn moved(of: impl Fn(usize, usize, f64) -> Vector3) -> Surface {
    let mut surface = y();
    let columns = surface.net().columns();
    for (k, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
        let (i, j) = (k / columns, k % columns);
        let (leaf, column) = (i / 17, i % 17);
        *point += of(column, j, if leaf == 0 { -1.0 } else { 1.0 });
    }
    surface
}

fn down(by_m: f64) -> Vector3 {
    Vector3::new(0.0, 0.0, -by_m)
}

/// The rules that a net breaks, each once.
fn rules_of(m: &Measures) -> Vec<Rule> {
    let mut rules: Vec<Rule> = m.rules.iter().map(|broken| broken.rule).collect();
    rules.sort_unstable();
    rules.dedup();
    rules
}

fn within(value: f64, low: f64, high: f64) -> bool {
    (low..high).contains(&value)
}

#[test]
fn a_neighbour_off_its_line_creases_the_joint() {
    for row in [4, 5] {
        let off = Vector3::new(0.0, -0.05, 0.0);
        let m = measured(&moved(|column, j, _| {
            if column == 1 && j == row {
                off
            } else {
                Vector3::zeros()
            }
        }));
        assert!(
            within(m.angle_deg, 19.0, 21.0),
            "row {row}: {}°",
            m.angle_deg
        );
        assert_eq!(rules_of(&m), [Rule::R1]);
        assert!(
            m.rules
                .iter()
                .any(|broken| broken.place == format!("L, front joint, row {row}")),
            "{:?}",
            m.rules
        );
    }
    // Both tilted rows: what the definition has 25.2° for.
    let off = Vector3::new(0.0, -0.05, 0.0);
    let m = measured(&moved(|column, j, _| {
        if column == 1 && (4..6).contains(&j) {
            off
        } else {
            Vector3::zeros()
        }
    }));
    assert!(within(m.angle_deg, 25.0, 26.0), "{}°", m.angle_deg);
}

// 39.8° by the definition: S_v turns from (delta, 0) to (delta, 0.1) in the section y = 0.
#[test]
fn an_open_book_that_is_lowered_creases_the_arch() {
    let m = measured(&moved(|column, j, side| {
        if side < 0.0 && (9..16).contains(&column) && j == 6 {
            down(0.1)
        } else {
            Vector3::zeros()
        }
    }));
    let wanted = libm::atan2(0.1, 0.12).to_degrees();
    assert!(
        (m.angle_deg - wanted).abs() < 1e-9,
        "{}°, not {wanted}°",
        m.angle_deg
    );
    assert_eq!(rules_of(&m), [Rule::R2]);
    assert!(m.rules[0].place.contains("L and R, arch"), "{:?}", m.rules);
}

// 26.6° by the definition, which widens the layer in x: 0.1 aside on 0.2 down.
#[test]
fn a_layer_that_is_wider_creases_the_outline() {
    let mut surface = y();
    for i in 0..34 {
        surface.net_mut().points_mut()[i * 15 + 9].x *= 1.1;
    }
    let m = measured(&surface);
    let wanted = libm::atan2(0.1, 0.2).to_degrees();
    assert!(
        (m.angle_deg - wanted).abs() < 1e-9,
        "{}°, not {wanted}°",
        m.angle_deg
    );
    assert_eq!(rules_of(&m), [Rule::R3]);
}

// Gap 0.05 and Euler number −2 by the definition, which lowers the left half. With both halves two
// closed rims are left: the Euler number is −1 again and only the open ends tell.
#[test]
fn an_overlap_layer_that_is_lowered_opens_a_gap() {
    for (arcs, euler, loops) in [(1..8, -2, 4), (0..17, -1, 5)] {
        let m = measured(&moved(|column, j, _| {
            if arcs.contains(&column) && j == 8 {
                down(0.05)
            } else {
                Vector3::zeros()
            }
        }));
        assert!((m.gap_m - 0.05).abs() < 1e-12, "gap {} m", m.gap_m);
        assert_eq!((m.euler, m.loops), (euler, loops));
        assert!(rules_of(&m).contains(&Rule::R3));
        assert!(m.misses(GOAL_EDITED_ANGLE_DEG).len() >= 2);
    }
}

fn unchecked(change: impl Fn(&mut Tree)) -> Measures {
    let mut tree = trees()[0].1.clone();
    change(&mut tree);
    measured(&grow::grow_unchecked(&tree).unwrap().surface)
}

fn fork(tree: &mut Tree) -> &mut Fork {
    tree.stem.fork.as_mut().unwrap()
}

// The normal is reversed at the joint. Just below the bound the rule is broken and the joint still
// smooth: the rule is sufficient, not necessary.
#[test]
fn neighbours_closer_than_the_rows_fold_the_joint() {
    type Change = fn(&mut Tree, f64);
    let changes: [Change; 2] = [
        |tree, e| tree.stem.neighbour_m = e,
        |tree, ez| fork(tree).neighbour_m = ez,
    ];
    for change in changes {
        let m = unchecked(|tree| change(tree, 0.05));
        assert_eq!((m.angle_deg, rules_of(&m)), (180.0, vec![Rule::R4]));
        let m = unchecked(|tree| change(tree, 0.1));
        assert!(
            m.angle_deg < 1e-11 && rules_of(&m) == [Rule::R4],
            "{}°",
            m.angle_deg
        );
        let m = unchecked(|tree| change(tree, 0.13));
        assert!(
            m.angle_deg < 1e-11 && m.rules.is_empty(),
            "{}°",
            m.angle_deg
        );
    }
}

#[test]
fn open_books_in_the_inverted_t_are_singular() {
    let m = unchecked(|tree| {
        fork(tree).left.shift_m = 0.0;
        fork(tree).right.shift_m = 0.0;
    });
    assert!(
        m.min_sine == 0.0 && m.angle_deg == 180.0 && rules_of(&m) == [Rule::R2],
        "{:?}",
        m.rules
    );
    let m = unchecked(|tree| fork(tree).raise = 0.0);
    assert!(
        m.min_sine == 0.0 && m.angle_deg == 180.0 && rules_of(&m) == [Rule::R3],
        "{:?}",
        m.rules
    );
    assert!(unchecked(|tree| fork(tree).arch_m = 0.0).folded > 0);
}

// Within the rules and smooth at every joint, but the branches run through each other, or bend
// tighter than they are wide.
#[test]
fn crossing_and_folded_branches_are_found() {
    let bent = |rows: usize, step_m: f64, turn_deg: f64| {
        let mut tree = trees()[0].1.clone();
        let Fork { left, right, .. } = fork(&mut tree);
        for branch in [left, right] {
            (branch.free_rows, branch.free_step_m, branch.turn_deg) = (rows, step_m, turn_deg);
        }
        let m = measured(&grow(&tree).unwrap().surface);
        assert!(
            m.angle_deg <= GOAL_ANGLE_DEG && m.rules.is_empty(),
            "{}°",
            m.angle_deg
        );
        m
    };
    let meeting = bent(12, 0.4, -120.0);
    assert!(
        meeting.crossings > 0,
        "{:?}",
        meeting.misses(GOAL_ANGLE_DEG)
    );
    let tight = bent(4, 0.1, 150.0);
    assert!(tight.folded > 0, "{:?}", tight.misses(GOAL_ANGLE_DEG));
}
