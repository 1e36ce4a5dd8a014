//! The grab button: what a tool touches is held, pulled, and lost beyond the grip's force.

use crate::common::{Laws as _, World, teardrop};
use palpate_geometry::math::{SavedState, Vector3};
use palpate_geometry::surface::ClosestSolver;
use palpate_sim::solve::grip::GRAB;
use palpate_sim::solve::row_key::RowKey;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::TickOutput;
use palpate_sim::tick::restore;

/// A soft drop that a ball meets at about x = 27.8 mm, coming along −x.
fn soft(grip_n: f64) -> String {
    let text = teardrop(20e3, "[16, 17]").replace("layers = 4", "layers = 2");
    format!(
        "{}grip = {{ force_max_n = {grip_n:?} }}\n",
        text.replace("stiffness_n_m = inf", "stiffness_n_m = 1000.0")
    )
}

fn rigid(grip_n: f64) -> String {
    soft(grip_n).replace("\"lattice\"", "\"rigid\"")
}

fn at(x: f64) -> [f64; 3] {
    [x, 0.003, 0.045]
}

/// In from outside to a light touch, half a second of rest, then the button.
fn grab(world: &mut World) -> TickOutput {
    for k in 0..1_500 {
        let s = f64::from(k.min(1_000)) * 1e-3;
        world.all(&[(at(0.06 - 0.033 * s), 0)]);
    }
    // A few ticks for what the query of an edge leaves over: nanometres.
    (0..10)
        .map(|_| world.all(&[(at(0.027), GRAB)]))
        .last()
        .unwrap()
}

#[test]
fn a_grabbed_soft_body_is_pulled_out_and_springs_back_when_let_go() {
    let mut world = World::new(&soft(10.0));
    let touching = grab(&mut world).tools[0];
    assert!(
        touching.force_n.x > 0.0,
        "it still presses: {}",
        touching.force_n
    );
    assert_ne!(touching.flags & flags::GRABBING, 0);
    let farthest = |world: &World| {
        let mut net = world.scene.rest_surface(0).unwrap().net().points().to_vec();
        world.state.copy_net(&world.scene, 0, &mut net);
        net.iter().fold(f64::MIN, |most, p| most.max(p.x))
    };
    let before = farthest(&world);
    // Out by 5 mm, and rest.
    let mut out = touching;
    let mut last = touching.force_n;
    for k in 0..6_000 {
        let s = f64::from(k.min(1_000)) * 1e-3;
        out = world.all(&[(at(0.027 + 0.005 * s), GRAB)]).tools[0];
        assert!(
            (out.force_n - last).norm() < 5e-3,
            "a step at {k}: {last} to {}",
            out.force_n
        );
        last = out.force_n;
    }
    assert!(
        out.force_n.x < -0.05,
        "the body does not pull back: {}",
        out.force_n
    );
    assert!(
        farthest(&world) > before + 2e-3,
        "the surface did not come along"
    );
    let deformable = world.state.bodies[0].deformable.as_ref().unwrap();
    let reaction = world
        .scene
        .deformable(0)
        .unwrap()
        .base_reaction_n(deformable);
    let off = (reaction + out.force_n).norm();
    assert!(
        off < 1e-6 * out.force_n.norm(),
        "{reaction} at the base for {}",
        out.force_n
    );
    // The button up: free at once, and back to rest.
    let freed = world.all(&[(at(0.032), 0)]).tools[0];
    assert_eq!(
        (
            freed.force_n.norm(),
            freed.contact_count,
            freed.flags & flags::GRABBING
        ),
        (0.0, 0, 0)
    );
    for _ in 0..4_000 {
        world.all(&[(at(0.06), 0)]);
    }
    let rest = world
        .scene
        .rest_surface(0)
        .unwrap()
        .net()
        .points()
        .iter()
        .fold(f64::MIN, |most, p| most.max(p.x));
    assert!((farthest(&world) - rest).abs() < 1e-6);
}

// A ball on a rigid body stays where it was grabbed, whichever way the device goes, with the
// coupling's force.
#[test]
fn a_tool_that_grabs_a_rigid_body_is_held_in_place() {
    for shape in [
        "{ sphere = { radius_m = 0.01 } }",
        "{ box = { half_extents_m = [0.01, 0.01, 0.01] } }",
    ] {
        let mut world = World::new(&rigid(10.0).replace("{ sphere = { radius_m = 0.01 } }", shape));
        let start = grab(&mut world).tools[0];
        assert_ne!(start.flags & flags::GRABBING, 0, "{shape}");
        for k in 0..2_000 {
            let t = f64::from(k) * 1e-3;
            let off =
                Vector3::new(libm::sin(7.0 * t), libm::sin(9.0 * t), libm::sin(11.0 * t)) * 0.002;
            let device = Vector3::from(at(0.027)) + off;
            let tool = world.all(&[(device.into(), GRAB)]).tools[0];
            let drift = (tool.proxy_position - start.proxy_position).norm();
            assert!(drift < 1e-9, "{shape}, tick {k}: moved {drift} m");
            let expected = (start.proxy_position.coords - device) * 1000.0;
            assert!(
                (tool.force_n - expected).norm() < 1e-6,
                "{shape}: {} for {expected}",
                tool.force_n
            );
        }
        // The device back in place, then up with the button: the same force as if it had never
        // grabbed.
        world.all(&[(at(0.027), GRAB)]);
        let freed = world.all(&[(at(0.027), 0)]).tools[0];
        assert!(
            (freed.force_n - start.force_n).norm() < 1e-3 * start.force_n.norm(),
            "{}",
            freed.force_n
        );
    }
}

// Pulled away without end: the force rises to the grip's, stays, fades as it slips off, and does
// not come back.
#[test]
fn beyond_its_force_a_grip_slips_off_smoothly_and_stays_off() {
    for text in [soft(0.2), rigid(0.2)] {
        let mut world = World::new(&text);
        grab(&mut world);
        let (mut most, mut last, mut held, mut saturated) =
            (0.0f64, world.all(&[(at(0.027), GRAB)]), 0, 0);
        for k in 0..3_000 {
            let x = 0.027 + 0.03 * f64::from(k) / 3_000.0;
            let out = world.all(&[(at(x), GRAB)]);
            let (now, before) = (out.tools[0].force_n, last.tools[0].force_n);
            if now.x < 0.0 {
                most = most.max(now.norm());
                saturated += usize::from((now.norm() - 0.2).abs() < 1e-3);
            }
            assert!(
                (now - before).norm() < 0.02,
                "a step at {x} m: {before} to {now}"
            );
            held += usize::from(out.tools[0].flags & flags::GRABBING != 0);
            last = out;
        }
        assert!(
            (0.15..0.2 + 1e-9).contains(&most),
            "{most} N of a grip of 0.2 N"
        );
        assert!(saturated > 50, "at its limit for {saturated} ticks");
        assert!(held > 100 && held < 2_900, "held for {held} ticks");
        assert_eq!(
            (
                last.tools[0].force_n.norm(),
                last.tools[0].flags & flags::GRABBING
            ),
            (0.0, 0)
        );
        // Back in touch with the button still down: nothing is grabbed. Up and down again: it is.
        for k in 0..1_000 {
            let out = world.all(&[(at(0.057 - 0.03 * f64::from(k) / 1_000.0), GRAB)]);
            assert_eq!(out.tools[0].flags & flags::GRABBING, 0);
        }
        for buttons in [GRAB, 0, GRAB] {
            last = world.all(&[(at(0.027), buttons)]);
        }
        assert_ne!(last.tools[0].flags & flags::GRABBING, 0);
    }
}

#[test]
fn a_grip_of_no_force_is_no_grip() {
    let (mut with, mut without) = (World::new(&soft(0.0)), World::new(&soft(0.0)));
    for k in 0..1_500 {
        let place = at(0.0275 + 0.003 * libm::cos(0.01 * f64::from(k)));
        let (a, b) = (with.all(&[(place, GRAB)]), without.all(&[(place, 0)]));
        assert_eq!((a.tools, a.contacts), (b.tools, b.contacts));
    }
}

#[test]
fn a_world_restored_while_it_grabs_goes_on_to_the_bit() {
    for text in [rigid(0.5), soft(0.5)] {
        let mut world = World::new(&text);
        grab(&mut world);
        let place = |k: u32| {
            at(0.027
                + 0.0004 * f64::from(k) / 100.0
                + 0.004 * libm::sin(0.02 * f64::from(k)).max(0.0))
        };
        for k in 0..60 {
            world.all(&[(place(k), GRAB)]);
        }
        assert!(world.state.tools[0].grip.holds());
        let mut saved = SavedState::default();
        saved.save_from(&world.state);
        let mut again = World::new(&text);
        restore(&again.scene, &mut again.state, &mut again.scratch, &saved).unwrap();
        assert_eq!(again.state.tools, world.state.tools);
        again.seq = world.seq;
        for k in 60..1_500 {
            let buttons = if k % 400 > 380 { 0 } else { GRAB };
            assert_eq!(
                world.all(&[(place(k), buttons)]),
                again.all(&[(place(k), buttons)]),
                "tick {k}"
            );
        }
    }
}

// Ten thousand ticks of a hand that pulls, shakes and rubs a soft body with friction, at and beyond
// its grip.
#[test]
fn a_shaken_grip_stays_calm_and_within_its_force() {
    let mut world = World::new(&format!(
        "{}friction = {{ mu = 0.5 }}\n",
        soft(0.3).replace("[16, 17]", "\"none\"")
    ));
    grab(&mut world);
    let (mut held, mut energy) = (0, 0.0f64);
    for k in 0..10_000 {
        let t = f64::from(k) * 1e-3;
        let x = 0.0285 + 0.004 * libm::sin(3.0 * t) + 0.001 * libm::sin(60.0 * t);
        let place = [
            x,
            0.003 + 0.002 * libm::sin(17.0 * t),
            0.045 + 0.002 * libm::sin(23.0 * t),
        ];
        let out = world.all(&[(place, if k % 2_500 < 2_450 { GRAB } else { 0 })]);
        assert!(out.fault.is_none() && out.tools[0].force_n.iter().all(|f| f.is_finite()));
        held += usize::from(out.tools[0].flags & flags::GRABBING != 0);
        let gripped: f64 = world
            .state
            .warm
            .rows()
            .iter()
            .filter(|row| matches!(row.id.key, RowKey::Anchor(_)))
            .map(|row| (row.force_n * row.force_n + row.tangent_n.norm_squared()).sqrt())
            .sum();
        assert!(
            gripped <= 0.3 * (1.0 + 1e-9),
            "tick {k}: {gripped} N in the grip"
        );
        let deformable = world.state.bodies[0].deformable.as_ref().unwrap();
        energy = energy.max(world.scene.deformable(0).unwrap().energy_j(deformable));
    }
    assert!(held > 3_000, "held for {held} ticks");
    assert!(energy < 0.5 * 1000.0 * 0.01 * 0.01, "{energy} J");
}

/// A slab of jelly whose first samples lie 2.5 mm and 7.5 mm from its edges, with a thin tool above
/// the middle of the first four.
fn between_the_first_samples(shape: &str, grip_n: f64) -> String {
    format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [8, 8], size = 0.1 }}
model = "lattice"
material = {{ young_pa = 20e3 }}
lattice = {{ layers = 3, thickness_m = 0.03, refine = "none" }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "pen"
shape = {shape}
pose = {{ position = [{FIRST:?}, {FIRST:?}, 0.01] }}
coupling = {{ stiffness_n_m = 1000.0, damping_n_s_m = 1.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
grip = {{ force_max_n = {grip_n:?} }}
"#
    )
}

/// Between the first two samples of the slab, along either axis, m.
const FIRST: f64 = -0.045;

// What the tool holds on to is numbered from 0, and so are the samples: the row of the foot beside
// sample 0 must stay when anchor 0 joins it, or the tool sinks in.
#[test]
fn a_tool_that_grabs_between_the_first_samples_still_presses_there() {
    for (shape, radius) in [
        ("{ point = {} }", 0.0),
        ("{ sphere = { radius_m = 1.5e-3 } }", 1.5e-3),
    ] {
        let [grabbed, pressed] = [GRAB, 0].map(|buttons| {
            let mut world = World::new(&between_the_first_samples(shape, 0.01));
            let at = |z: f64| [FIRST, FIRST, radius + z];
            for k in 0..400 {
                world.all(&[(at(6e-4 - 1e-3 * f64::from(k) / 400.0), 0)]);
            }
            let mut last = None;
            for k in 0..1_000 {
                let depth = 4e-4 + 1e-3 * f64::from(k.min(600)) / 600.0;
                let out = world.all(&[(at(-depth), buttons)]);
                let held = out.tools[0].flags & flags::GRABBING != 0;
                assert_eq!(held, buttons == GRAB, "{shape}, tick {k}");
                last = Some(out.tools[0]);
            }
            let tool = last.unwrap();
            let mut net = world.scene.rest_surface(0).unwrap().net().points().to_vec();
            world.state.copy_net(&world.scene, 0, &mut net);
            let surface = world.scene.surface_with(0, &net).unwrap().unwrap();
            let foot = ClosestSolver::new(&surface).closest(&surface, &tool.proxy_position);
            let sunk_m = radius - foot.signed_distance;
            (tool.force_n, sunk_m)
        });
        // What the grip bears of the force, up to 0.01 N, does not bring a ball in beyond the net.
        assert!(
            (grabbed.1 - pressed.1).abs() < 5e-5,
            "{shape}: {} m inside the body while it is held, {} m without",
            grabbed.1,
            pressed.1
        );
        assert!(
            (grabbed.0 - pressed.0).norm() < 0.011,
            "{shape}: {} with a grip of 0.01 N, {} without",
            grabbed.0,
            pressed.0
        );
    }
}
