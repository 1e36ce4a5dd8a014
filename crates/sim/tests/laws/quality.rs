//! Lower quality: what a tick leaves out is work, not balance.

use crate::common::{Laws as _, World};
use palpate_sim::tick::apply;
use palpate_sim::tick::quality;
use palpate_sim::tick::record::{Command, TickOutput};

/// A soft slab on a rigid floor that iterates four times a step, and a ball of 20 mm that presses many rows.
fn world() -> World {
    World::new(
        r#"
[[body]]
id = "sheet"
surface = { builtin = "sheet", net = [8, 8], size = 0.1 }
model = "lattice"
integrator = { iterations = 4, contact_sweeps = 60 }
material = { young_pa = 20e3, damping_s = 2e-3 }
lattice = { layers = 2, thickness_m = 0.01, refine = [16, 16] }
fixed = [{ point = [0.0, 0.0, -0.006], normal = [0.0, 0.0, 1.0] }]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.03] }
coupling = { stiffness_n_m = 2000.0, damping_n_s_m = 1.0 }
device = { force_max_n = 8.0 }
[[contact]]
pair = ["ball", "sheet"]
near_field = false
"#,
    )
}

/// Presses within a quarter of a second and holds as long as it takes to come to rest; the last
/// tick and the largest step of the force. `level`: quality by tick.
fn pressed(level: impl Fn(i32) -> u8) -> (TickOutput, f64) {
    let mut world = world();
    let mut jump: f64 = 0.0;
    let mut last = world.at([0.001, 0.002, 0.025]).tools[0].force_n;
    let mut output = TickOutput::default();
    for k in 0..2_000 {
        if world.state.quality != level(k) {
            apply(
                &world.scene,
                &mut world.state,
                &mut world.scratch,
                Command::Quality(level(k)),
            );
        }
        let share = (f64::from(k) / 250.0).min(1.0);
        output = world.at([0.001, 0.002, 0.025 - 0.008 * share]);
        jump = jump.max((output.tools[0].force_n - last).norm());
        last = output.tools[0].force_n;
    }
    (output, jump)
}

// A body that moves no more is at rest with its forces, however many iterations and sweeps brought
// it there.
#[test]
fn a_press_comes_to_the_same_rest_at_every_level_and_without_kicks() {
    let (full, smooth) = pressed(|_| 0);
    let force = full.tools[0].force_n;
    assert!(
        force.norm() > 0.1 && full.tools[0].contact_count >= 2,
        "{:?}",
        full.tools[0]
    );
    for level in 1..=quality::LOWEST {
        let (output, jump) = pressed(|_| level);
        assert_eq!(output.quality, level);
        let apart = (output.tools[0].force_n - force).norm() / force.norm();
        println!(
            "level {level}: {apart:e} apart at rest, largest step {jump:e} N against {smooth:e} N"
        );
        assert!(apart < 1e-9, "level {level}: {apart:e} of the force apart");
        assert!(
            jump < 1.5 * smooth,
            "level {level}: a step of {jump} N, {smooth} N at full quality"
        );
    }
}

// The levels differ in how fast a body follows, not in where: a change in the middle of a press is
// no kick.
#[test]
fn a_change_of_level_under_load_is_not_felt() {
    let (full, smooth) = pressed(|_| 0);
    // A level every 13 ticks, down and back, for as long as the press lasts and beyond.
    let (output, jump) = pressed(|k| {
        if k < 600 {
            [0, 1, 2, 3, 2, 1][(k / 13) as usize % 6]
        } else {
            0
        }
    });
    let apart =
        (output.tools[0].force_n - full.tools[0].force_n).norm() / full.tools[0].force_n.norm();
    println!("{apart:e} apart at rest, largest step {jump:e} N against {smooth:e} N");
    assert!(apart < 1e-9, "{apart:e} of the force apart");
    assert!(
        jump < 1.5 * smooth,
        "a step of {jump} N, {smooth} N at full quality"
    );
}

#[test]
fn a_level_below_the_last_is_the_last_and_a_reset_leaves_it() {
    let mut world = world();
    apply(
        &world.scene,
        &mut world.state,
        &mut world.scratch,
        Command::Quality(200),
    );
    assert_eq!(world.state.quality, quality::LOWEST);
    apply(
        &world.scene,
        &mut world.state,
        &mut world.scratch,
        Command::Reset,
    );
    assert_eq!(world.state.quality, quality::LOWEST);
    assert_eq!(world.silent().quality, quality::LOWEST);
}
