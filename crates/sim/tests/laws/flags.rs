//! What flags say of a tool, in each of its states: true in the tick in which it is said.

use crate::common::{Laws as _, World};
use palpate_sim::tick::flags::{GRABBING, PAUSED, RAMPING, REFUSED, SATURATED, STALE, WITHHELD};
use palpate_sim::tick::record::{Command, ToolOutput};
use palpate_sim::tick::{RunState, apply};

/// A ball on a rigid sheet whose device bears half a newton, within 5 ticks from none.
const SCENE: &str = r#"
[[body]]
id = "floor"
surface = { builtin = "sheet", size = 0.2 }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.05] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }
device = { force_max_n = 0.5, ramp_s = 0.005, stale_s = 0.02 }
grip = { force_max_n = 2.0 }
"#;
const ABOVE: [f64; 3] = [0.0, 0.0, 0.012];
/// 0.2 N.
const LIGHT: [f64; 3] = [0.0, 0.0, 0.0098];
/// 2 N: more than the device bears.
const HARD: [f64; 3] = [0.0, 0.0, 0.008];
const FAR: [f64; 3] = [0.05, 0.0, 0.0098];

/// What comes in during some ticks.
enum In {
    Pose([f64; 3]),
    Silence,
    Command(Command),
}
use In::{Command as Do, Pose, Silence};

/// The tool after as many ticks of it.
fn run(world: &mut World, input: &In, ticks: u32) -> ToolOutput {
    if let Do(command) = input {
        apply(&world.scene, &mut world.state, &mut world.scratch, *command);
    }
    let mut tool = ToolOutput::default();
    for _ in 0..ticks {
        tool = match input {
            Pose(position) => world.at(*position).tools[0],
            Silence | Do(_) => world.silent().tools[0],
        };
    }
    tool
}

#[test]
fn flags_are_true_in_every_state_of_a_tool_and_contacts_go_with_its_hand() {
    let mut world = World::new(SCENE);
    // What comes, for how many ticks, the flags after it, whether the tool touches, whether it pushes back.
    let steps = [
        ("nobody has come", Silence, 3, 0, false, false),
        ("a hand comes", Pose(ABOVE), 1, RAMPING, false, false),
        ("it is there", Pose(ABOVE), 9, 0, false, false),
        ("it touches", Pose(LIGHT), 1, 0, true, true),
        ("it presses too hard", Pose(HARD), 1, SATURATED, true, true),
        (
            "a pause begins",
            Do(Command::Pause),
            1,
            PAUSED | RAMPING,
            true,
            true,
        ),
        ("the pause", Pose(HARD), 9, PAUSED, true, false),
        (
            "the pause ends",
            Do(Command::Resume),
            1,
            RAMPING | SATURATED,
            true,
            true,
        ),
        ("all is as before", Pose(HARD), 9, SATURATED, true, true),
        ("another pause", Do(Command::Pause), 9, PAUSED, true, false),
        (
            "a reset in the pause",
            Do(Command::Reset),
            1,
            PAUSED,
            false,
            false,
        ),
        (
            "its hand is still there",
            Pose(HARD),
            9,
            PAUSED | WITHHELD,
            true,
            false,
        ),
        (
            "the pause ends",
            Do(Command::Resume),
            9,
            WITHHELD,
            true,
            false,
        ),
        ("it comes out", Pose(ABOVE), 1, RAMPING, false, false),
        ("and in again", Pose(HARD), 9, SATURATED, true, true),
        (
            "no pose for as long as it may be",
            Silence,
            20,
            SATURATED,
            true,
            true,
        ),
        ("one more", Silence, 1, STALE | RAMPING, true, true),
        ("the force has faded", Silence, 9, STALE, false, false),
        ("nobody comes", Silence, 500, STALE, false, false),
        (
            "a pause without a hand",
            Do(Command::Pause),
            9,
            STALE | PAUSED,
            false,
            false,
        ),
        ("and its end", Do(Command::Resume), 9, STALE, false, false),
        ("the hand is back", Pose(LIGHT), 9, WITHHELD, true, false),
        ("it comes out", Pose(ABOVE), 9, 0, false, false),
        ("and stays", Pose(LIGHT), 9, 0, true, true),
        ("it leaps", Pose(FAR), 1, REFUSED | RAMPING, true, true),
        (
            "and is never heard of again",
            Silence,
            3,
            RAMPING,
            true,
            true,
        ),
        ("its force has faded", Silence, 10, 0, false, false),
        ("its last pose is old", Silence, 10, STALE, false, false),
        (
            "a reset without a hand",
            Do(Command::Reset),
            1,
            0,
            false,
            false,
        ),
        ("nobody comes after it", Silence, 500, 0, false, false),
        ("a hand after the reset", Pose(ABOVE), 10, 0, false, false),
        ("it touches", Pose(LIGHT), 1, 0, true, true),
        (
            "the loop ends",
            Do(Command::Stop),
            1,
            PAUSED | RAMPING,
            true,
            true,
        ),
        (
            "a reset does not stop that",
            Do(Command::Reset),
            1,
            PAUSED,
            false,
            false,
        ),
        (
            "no force comes back",
            Pose(LIGHT),
            20,
            PAUSED | WITHHELD,
            true,
            false,
        ),
    ];
    for (what, input, ticks, flags, touches, pushes) in steps {
        let tool = run(&mut world, &input, ticks);
        assert_eq!(tool.flags, flags, "{what}: {:#b}", tool.flags);
        assert_eq!(tool.contact_count > 0, touches, "{what}");
        assert_eq!(tool.contact.is_some(), touches, "{what}");
        assert_eq!(tool.contact_force_n.norm() > 0.0, touches, "{what}");
        assert_eq!(tool.force_n.norm() > 0.0, pushes, "{what}");
        let listed = world.record.output.contacts.list().len();
        assert_eq!(listed > 0, touches, "{what}");
    }
    assert_eq!(world.state.run, RunState::Stopping);
}

#[test]
fn a_tool_whose_hand_left_grips_nothing() {
    let mut world = World::new(SCENE);
    for place in [ABOVE, LIGHT] {
        for _ in 0..10 {
            world.all(&[(place, 1)]);
        }
    }
    assert_eq!(world.all(&[(LIGHT, 1)]).tools[0].flags, GRABBING);
    assert_eq!(
        run(&mut world, &Silence, 21).flags,
        STALE | RAMPING | GRABBING
    );
    assert_eq!(run(&mut world, &Silence, 9).flags, STALE);
}
