//! The figures of `palpate bench haptics` that no clock decides, held to their bars.

use palpate_bench::Effort;
use palpate_bench::Figure;
use palpate_bench::haptics::{hands, haptics};

fn figures(only: &str) -> Vec<Figure> {
    let mut figures = Vec::new();
    haptics(Effort::Quick, Some(only), &mut |figure| {
        figures.push(figure)
    });
    assert!(!figures.is_empty(), "no case {only}");
    figures
}

fn all_met(only: &str) -> Vec<Figure> {
    let figures = figures(only);
    for figure in &figures {
        assert!(figure.bar.is_some() && figure.is_met(), "{figure:?}");
    }
    figures
}

#[test]
fn devices_hold_walls_as_stiff_as_theory_says() {
    for device in ["ideal", "touch-x", "falcon"] {
        for figure in all_met(&format!("zwidth/{device}")) {
            // Without anything that takes energy but its damping, not much more either.
            assert!(
                figure.method != "without dry friction" || figure.value < 1.1,
                "{figure:?}"
            );
        }
    }
}

#[test]
fn delays_make_energy_and_the_controller_takes_it() {
    for delay in ["1", "5", "20"] {
        all_met(&format!("energy/delay/{delay}/on"));
        let off = figures(&format!("energy/delay/{delay}/off"));
        assert!(
            off.iter().all(|figure| figure.value > 0.05),
            "{delay} ms hardly make energy: {off:?}"
        );
    }
}

// The bench itself has a thousand.
#[test]
fn five_hundred_hands_get_no_more_energy_than_they_gave() {
    let report = hands(500, 7);
    assert!(report.touched > 400, "{report:?}");
    assert!(report.worst_of_quantum <= 1.0, "{report:?}");
}

#[test]
fn forces_on_a_ball_a_plane_and_a_cylinder_are_the_analytic_ones() {
    assert_eq!(all_met("render/").len(), 3);
}

#[test]
fn friction_holds_to_its_threshold_and_does_not_creep() {
    for figure in all_met("friction/") {
        assert!(
            figure.unit != "1" || figure.value > 0.99 * figure.reference,
            "{figure:?}"
        );
    }
}

#[test]
fn no_tool_gives_more_energy_than_it_got_on_rigid_and_on_soft_bodies() {
    let figures = all_met("energy/tool/");
    assert_eq!(figures.len(), 10);
    assert!(
        figures
            .iter()
            .all(|figure| !figure.note.starts_with("0 ticks")),
        "{figures:?}"
    );
}
