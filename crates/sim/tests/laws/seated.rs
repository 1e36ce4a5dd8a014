//! A tool that is seated inside a body, as when its device is switched on there: no force until it has been small once.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Random, SavedState, Vector3};
use palpate_sim::tick::flags::WITHHELD;
use palpate_sim::tick::record::{Command, ToolOutput};
use palpate_sim::tick::{apply, restore};
use std::cell::Cell;

const SHAPES: [&str; 4] = [
    "{ sphere = { radius_m = 0.005 } }",
    "{ point = {} }",
    "{ box = { half_extents_m = [0.004, 0.006, 0.005] } }",
    "{ cylinder = { radius_m = 0.004, half_length_m = 0.008 } }",
];

/// A ball of 30 mm, soft or not, with a tool far above it.
fn world(soft: bool, shape: &str) -> World {
    let model = match soft {
        true => {
            "model = \"lattice\"\nmaterial = { young_pa = 20e3 }\nlattice = { layers = 2, refine = \"none\" }\n\
             fixed = [{ point = [0.0, 0.0, -0.025], normal = [0.0, 0.0, -1.0] }]"
        }
        false => "",
    };
    World::new(&format!(
        "[[body]]\nid = \"body\"\nsurface = {{ builtin = \"sphere\", size = 0.03 }}\n{model}\n\
         [[tool]]\nid = \"tool\"\nshape = {shape}\npose = {{ position = [0.0, 0.0, 0.1] }}\n\
         coupling = {{ stiffness_n_m = 1000.0, damping_n_s_m = 1.0 }}\n"
    ))
}

/// Everything above its upper half is outside of it.
const OUTSIDE: [f64; 3] = [0.0, 0.0, 0.06];

/// From there a hand is nowhere else within the time of a ramp.
const FAR: [f64; 3] = [0.0, 0.0, 0.6];

fn size(tool: &ToolOutput) -> f64 {
    tool.force_n.norm() + tool.torque_nm.norm()
}

/// Seats the tool at a place: as the first pose, as one that comes after a silence, or as a jump.
fn seat(world: &mut World, place: [f64; 3], how: usize) {
    if how == 0 {
        world.at(place);
        return;
    }
    for _ in 0..50 {
        world.at(FAR);
    }
    match how {
        1 => (0..120).for_each(|_| _ = world.silent()),
        // Refused until the force has faded.
        _ => (0..20).for_each(|_| _ = world.at(place)),
    }
    world.at(place);
    assert_eq!(world.state.tools[0].link.pose.position, place.into());
}

/// Goes somewhere at 0.2 m/s; gives the last output.
fn go(world: &mut World, to: [f64; 3], mut seen: impl FnMut(&ToolOutput)) -> ToolOutput {
    let from = world.state.tools[0].link.pose.position.coords;
    let way = Vector3::from(to) - from;
    let ticks = (way.norm() / 2e-4).ceil().max(1.0);
    let mut last = ToolOutput::default();
    for k in 1..=ticks as u32 {
        last = world.at((from + way * (f64::from(k) / ticks)).into()).tools[0];
        seen(&last);
    }
    last
}

#[test]
fn a_tool_that_is_seated_in_a_body_feels_nothing_until_its_force_has_been_small_once() {
    let mut random = Random(11);
    let mut withheld = [0; 2];
    for case in 0..96 {
        let (soft, shape) = (case % 4 > 2, SHAPES[case / 4 % 4]);
        let depth_m = 1e-4 * 200f64.powf(random.float(0.0, 1.0));
        let aside = Vector3::new(random.float(-0.6, 0.6), random.float(-0.6, 0.6), 1.0);
        let place: [f64; 3] = (aside.normalize() * (0.03 - depth_m)).into();
        let what = format!(
            "case {case}: {shape} {:.2} mm deep, soft: {soft}",
            depth_m * 1e3
        );
        let mut world = world(soft, shape);
        seat(&mut world, place, case % 3);
        let seated = world.record.output.tools[0];
        let is_withheld = Cell::new(seated.flags & WITHHELD != 0);
        assert!(
            is_withheld.get() || seated.contact_force_n.norm() <= 0.05,
            "{what}: {}",
            seated.contact_force_n
        );
        withheld[usize::from(soft)] += usize::from(is_withheld.get());
        let energy_j = seated.energy_j;
        let check = |tool: &ToolOutput| {
            if is_withheld.get() && tool.flags & WITHHELD == 0 {
                is_withheld.set(false);
                assert!(
                    tool.contact_force_n.norm() <= 0.05,
                    "{what}: {}",
                    tool.contact_force_n
                );
            }
            assert_eq!(
                tool.flags & WITHHELD != 0,
                is_withheld.get(),
                "{what}: withheld anew"
            );
            if is_withheld.get() {
                assert_eq!((size(tool), tool.energy_j), (0.0, energy_j), "{what}");
            }
        };
        check(&seated);
        // A hand that trembles there, and then draws the tool out.
        for _ in 0..40 {
            let by = Vector3::from_fn(|_, _| random.float(-1e-4, 1e-4));
            check(&world.at((Vector3::from(place) + by).into()).tools[0]);
        }
        if let Some(body) = &world.state.bodies[0].deformable
            && seated.flags & WITHHELD != 0
        {
            assert!(
                body.velocities.iter().all(|v| *v == Vector3::zeros()),
                "{what}: the body is pressed"
            );
        }
        go(&mut world, OUTSIDE, check);
        assert!(!is_withheld.get(), "{what}: outside");
        // In again: the force of a tool that was never inside.
        let inside = (aside.normalize() * 0.028).into();
        let mut other = self::world(soft, shape);
        go(&mut other, OUTSIDE, |_| ());
        let expected = go(&mut other, inside, |_| ());
        let felt = go(&mut world, inside, check);
        assert!(
            expected.force_n.norm() > 0.1,
            "{what}: {}",
            expected.force_n
        );
        let miss = (felt.force_n - expected.force_n).norm() / expected.force_n.norm();
        assert!(
            miss < 0.02,
            "{what}: {} instead of {}",
            felt.force_n,
            expected.force_n
        );
    }
    assert!(withheld[0] > 50 && withheld[1] > 10, "{withheld:?}");
}

// Through the body and out on any side. Where the surface then still holds the tool back on the side it was seated
// near, it is free when its hand has gone round.
#[test]
fn a_withheld_tool_is_not_kicked_wherever_its_hand_draws_it() {
    for to in [
        [0.0, 0.0, 0.06],
        [0.0, 0.0, -0.06],
        [0.06, 0.0, 0.0],
        [0.0, -0.06, 0.01],
    ] {
        for shape in SHAPES {
            let mut world = world(false, shape);
            world.at([0.002, 0.001, 0.02]);
            assert_eq!(world.record.output.tools[0].flags, WITHHELD, "{shape}");
            for place in [to, [0.1, 0.0, to[2]], [0.1, 0.0, 0.06], OUTSIDE] {
                go(&mut world, place, |tool| {
                    // Nothing while it is withheld; then what was small.
                    let most_n = if tool.flags & WITHHELD != 0 {
                        0.0
                    } else {
                        0.05
                    };
                    assert!(size(tool) <= most_n, "{shape} to {to:?}: {}", tool.force_n);
                });
            }
            let last = world.record.output.tools[0];
            assert_eq!(
                (last.flags, last.contact_count),
                (0, 0),
                "{shape} to {to:?}"
            );
        }
    }
}

#[test]
fn a_withheld_tool_goes_on_bit_for_bit_from_what_was_saved() {
    for soft in [false, true] {
        let place = |k: i32| {
            [
                0.001 * f64::from(k % 3),
                0.0,
                0.02 + 5e-4 * f64::from((k - 60).max(0)),
            ]
        };
        let mut world = world(soft, SHAPES[0]);
        let mut saved = SavedState::default();
        let mut outputs = Vec::new();
        for k in 0..160 {
            if k == 30 {
                saved.save_from(&world.state);
            }
            outputs.push(world.at(place(k)));
        }
        let flags = |k: usize| outputs[k].tools[0].flags & WITHHELD;
        assert_eq!((flags(30), flags(159)), (WITHHELD, 0));
        let mut again = self::world(soft, SHAPES[0]);
        again.seq = 30;
        restore(&again.scene, &mut again.state, &mut again.scratch, &saved).unwrap();
        for k in 30..160 {
            assert_eq!(again.at(place(k)), outputs[k as usize], "tick {k}");
        }
    }
}

// Its state begins anew, and so does that of its hand.
#[test]
fn a_reset_around_a_pressing_hand_gives_no_kick() {
    let mut world = world(false, SHAPES[0]);
    go(&mut world, OUTSIDE, |_| ());
    let pressed = go(&mut world, [0.0, 0.0, 0.033], |_| ());
    assert!((pressed.force_n.z - 2.0).abs() < 0.3, "{}", pressed.force_n);
    apply(
        &world.scene,
        &mut world.state,
        &mut world.scratch,
        Command::Reset,
    );
    for _ in 0..100 {
        let tool = world.at([0.0, 0.0, 0.033]).tools[0];
        assert_eq!((size(&tool), tool.flags), (0.0, WITHHELD));
    }
}
