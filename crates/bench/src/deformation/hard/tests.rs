//! Every hard case by its name, as the table runs it.

use super::*;

/// Cases that take longer than all others together: with the first kind here, with all by `palpate-bench bars`.
const DEAR: [&str; 3] = ["cone", "corner", "hundred-bodies"];

/// Runs all kinds of a case; nothing may be wrong but what is known to be, and that still must be.
fn right(name: &str) {
    let mut rows = Vec::new();
    let kinds = if DEAR.contains(&name) {
        "lattice/implicit"
    } else {
        ""
    };
    let case = format!("hard/{name}/{kinds}");
    hard_cases(Cases::Containing(&case), &mut |row| rows.push(row));
    let table = hard_table(&rows);
    println!("{table}");
    assert!(!rows.is_empty(), "no case is called {name}");
    for row in &rows {
        let known = KNOWN.iter().any(|(case, _)| *case == row.case);
        assert_eq!(row.wrong.is_empty(), !known, "{}: {table}", row.case);
    }
}

macro_rules! cases {
    ($($test:ident: $name:literal,)*) => {
        $(#[test]
        fn $test() {
            right($name);
        })*

        #[test]
        fn every_case_of_the_table_is_a_test() {
            let tested = [$($name),*];
            for case in CASES {
                assert!(tested.contains(&case.name), "{} has no test", case.name);
            }
        }
    };
}

cases! {
    moduli_from_a_thousandth_to_a_million_in_one_body: "moduli",
    plasticine_gives_more_to_more_force_and_less_when_stiffer: "plasticine",
    ticks_from_a_tenth_to_fifty_milliseconds: "ticks",
    densities_in_a_ratio_of_a_million: "densities",
    collapsed_and_coincident_nodes_recover: "coincident",
    scrambled_and_inverted_cells_come_back: "scrambled",
    squeezed_to_a_tenth_between_planes_and_released: "squeezed",
    a_tool_that_jumps_a_metre_in_out_and_through: "jumps",
    two_tools_squeeze_and_share_a_control_point: "two-tools",
    a_sharp_cone: "cone",
    the_corner_of_a_cube: "corner",
    nearly_incompressible: "incompressible",
    a_single_layer_of_cells: "single-layer",
    jelly_under_its_own_weight: "own-weight",
    a_thousand_newtons_for_one_tick: "thousand-newtons",
    a_slide_at_a_metre_a_second: "slide",
    resting_contact_for_ten_minutes: "ten-minutes",
    a_hundred_bodies: "hundred-bodies",
}

#[test]
fn a_wrong_figure_is_said_and_counted() {
    let slab = slab::Slab::new(SPRINGS[0]);
    let mut run = slab.run().unwrap();
    run.near("force", 1.0, 2.0, 0.1, "N");
    run.between("place", f64::NAN, [0.0, 1.0], "m");
    let row = run.done().unwrap();
    // And there was no tick.
    assert_eq!(row.wrong.len(), 3, "{row:?}");
    let text = hard_table(&[row]);
    assert!(
        text.contains("1 wrong") && text.contains("error -5.0e-1"),
        "{text}"
    );
}

#[test]
fn energy_from_nowhere_is_said() {
    // A weight that the count does not know of.
    let slab = slab::Slab {
        scene: "[gravity]\nacceleration = [0.0, 0.0, -9.81]".to_owned(),
        ..slab::Slab::new(SPRINGS[0])
    };
    let mut run = slab.run().unwrap();
    run.stay([0.0, 0.0, 1.0], 100);
    let row = run.done().unwrap();
    let said = |words: &str| row.wrong.iter().any(|wrong| wrong.contains(words));
    assert!(said("came from nowhere"), "{row:?}");
}
