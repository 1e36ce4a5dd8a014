//! Cases on which solvers of deforming bodies are known to fail: every one runs ten thousand ticks
//! and more, must stay finite, and is checked by a force or a place that is known, not only by
//! surviving.

use crate::common::{World, pose};
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::body::DeformableState;
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::step;

/// A square slab of 0.1 m: net of `side` × `side`, `layers` deep, 0.03 m thick, its underside
/// fixed.
struct Slab {
    side: usize,
    layers: usize,
    model: &'static str,
    material: String,
    extra: String,
    rate_hz: u32,
    tools: String,
}

impl Slab {
    fn new() -> Self {
        Self {
            side: 6,
            layers: 3,
            model: "lattice",
            material: "young_pa = 20e3, damping_s = 2e-3".into(),
            extra: String::new(),
            rate_hz: 1_000,
            tools: ball("ball", "inf", 0.02),
        }
    }

    fn world(&self) -> World {
        let Self {
            side,
            layers,
            model,
            material,
            extra,
            rate_hz,
            tools,
        } = self;
        World::new(&format!(
            r#"
[loop]
rate_hz = {rate_hz}
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [{side}, {side}], size = 0.1 }}
model = "{model}"
material = {{ {material} }}
lattice = {{ layers = {layers}, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
{extra}
{tools}
"#
        ))
    }
}

fn ball(id: &str, stiffness: &str, radius_m: f64) -> String {
    format!(
        r#"
[[tool]]
id = "{id}"
shape = {{ sphere = {{ radius_m = {radius_m:?} }} }}
pose = {{ position = [0.0, 0.0, 0.05] }}
coupling = {{ stiffness_n_m = {stiffness}, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }}
"#
    )
}

fn body(world: &World) -> &DeformableState {
    world.state.bodies[0].deformable.as_ref().unwrap()
}

fn body_mut(world: &mut World) -> &mut DeformableState {
    world.state.bodies[0].deformable.as_mut().unwrap()
}

/// Energy of the body, J, and that it is a number.
fn energy(world: &World) -> f64 {
    let energy = world.scene.deformable(0).unwrap().energy_j(body(world));
    assert!(energy.is_finite(), "the energy is {energy}");
    energy
}

fn farthest_from_rest(world: &World) -> f64 {
    let rest = world.scene.deformable(0).unwrap().rest_state();
    let away = rest
        .positions
        .iter()
        .zip(&body(world).positions)
        .map(|(a, b)| (a - b).norm());
    let worst = away.fold(0.0, f64::max);
    assert!(worst.is_finite(), "a node is nowhere");
    worst
}

/// After a change of the state by hand: what the tick keeps of it must be made anew.
fn renew(world: &mut World) {
    world.scratch = world.scene.scratch(&world.state);
}

/// Poses for all tools at once.
fn all_at(world: &mut World, places: &[[f64; 3]]) -> TickOutput {
    world.seq += 1;
    let mut input = TickInput::default();
    for (tool, place) in places.iter().enumerate() {
        input.poses[tool] = Some(pose(world.seq, *place));
    }
    step(&world.scene, &mut world.state, &mut world.scratch, &input)
}

/// Lowers the ball from touch to a depth over `ticks`, then holds it for as many; force at the end.
fn press(world: &mut World, radius_m: f64, depth_m: f64, ticks: usize) -> f64 {
    let mut force = 0.0;
    for k in 0..2 * ticks {
        let share = (k as f64 / ticks as f64).min(1.0);
        force = world.at([0.0, 0.0, radius_m - depth_m * share]).tools[0]
            .force_n
            .z;
    }
    force
}

/// The base bears what the tool presses.
fn assert_base_bears(world: &World, force_n: f64, share: f64) {
    let base = world
        .scene
        .deformable(0)
        .unwrap()
        .base_reaction_n(body(world))
        .z;
    assert!(
        (base.abs() / force_n - 1.0).abs() < share,
        "base {base} N, tool {force_n} N"
    );
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    fn vector(&mut self) -> Vector3 {
        Vector3::new(self.next(), self.next(), self.next())
    }
}

/// Boxes of the slab's cells in turn, each of another modulus or density.
fn checkerboard(key: &str, values: &[f64]) -> String {
    let mut text = String::new();
    let h = 0.1 / 5.0;
    for i in 0..5 {
        for j in 0..5 {
            for layer in 0..2 {
                let value = values[(i + j + layer) % values.len()];
                let low = [
                    -0.05 + h * i as f64,
                    -0.05 + h * j as f64,
                    -0.015 * (layer + 1) as f64 - 1e-9,
                ];
                let high = [low[0] + h, low[1] + h, low[2] + 0.015 + 2e-9];
                text += &format!(
                    "[[body.region]]\nbox = {{ low = {low:?}, high = {high:?} }}\n{key} = {value:?}\n"
                );
            }
        }
    }
    text
}

// The force lies between those of slabs that are all of the softest and all of the stiffest kind
// (Voigt's and Reuss' bounds are of the same kind, and cruder), and the base bears it.
#[test]
fn moduli_from_a_thousandth_to_a_million_in_one_body() {
    for model in ["lattice", "continuum"] {
        let extra = checkerboard("young_pa", &[20.0, 20e3, 20e6, 20e9]);
        let mut world = Slab {
            model,
            extra,
            ..Slab::new()
        }
        .world();
        let force = press(&mut world, 0.02, 0.001, 5_000);
        energy(&world);
        let only = |young: f64| {
            let material = format!("young_pa = {young:?}, damping_s = 2e-3");
            press(
                &mut Slab {
                    model,
                    material,
                    ..Slab::new()
                }
                .world(),
                0.02,
                0.001,
                300,
            )
        };
        let (soft, stiff) = (only(20.0), only(20e9));
        assert!(
            force > soft && force < stiff,
            "{model}: {force} N, not between {soft} and {stiff}"
        );
        assert_base_bears(&world, force, 0.01);
    }
}

#[test]
fn densities_in_a_ratio_of_a_million() {
    let mut world = Slab {
        extra: checkerboard("density_kg_m3", &[1.0, 1e6]),
        ..Slab::new()
    }
    .world();
    // At rest inertia has no say.
    let rest = |world: &mut World, ticks: usize| {
        press(world, 0.02, 0.003, ticks);
        world.rest(|world| _ = world.at([0.0, 0.0, 0.017]), 20_000);
        world.at([0.0, 0.0, 0.017]).tools[0].force_n.z
    };
    let force = rest(&mut world, 5_000);
    let even = rest(&mut Slab::new().world(), 1_000);
    assert!(
        (force / even - 1.0).abs() < 1e-3,
        "{force} N, of even density {even} N"
    );
    energy(&world);
}

#[test]
fn ticks_from_a_tenth_to_fifty_milliseconds() {
    let reference = press(&mut Slab::new().world(), 0.02, 0.003, 1_000);
    for rate_hz in [10_000, 2_000, 500, 100, 20] {
        let mut world = Slab {
            rate_hz,
            ..Slab::new()
        }
        .world();
        let force = press(&mut world, 0.02, 0.003, 5_000);
        assert!(
            (force / reference - 1.0).abs() < 1e-3,
            "{rate_hz} Hz: {force} N, at 1 kHz {reference} N"
        );
        assert_base_bears(&world, force, 1e-3);
    }
}

#[test]
fn collapsed_and_coincident_nodes_recover() {
    for model in ["lattice", "continuum"] {
        let mut world = Slab {
            model,
            ..Slab::new()
        }
        .world();
        let free: Vec<usize> = (0..body(&world).positions.len())
            .filter(|&k| world.scene.deformable(0).unwrap().unknown(k).is_some())
            .collect();
        // A quarter of the free nodes in one place, with no length between them.
        let place = body(&world).positions[free[0]];
        for &node in free.iter().step_by(4) {
            body_mut(&mut world).positions[node] = place;
        }
        renew(&mut world);
        let before = energy(&world);
        for _ in 0..10_000 {
            world.at([0.0, 0.0, 0.05]);
        }
        assert!(energy(&world) <= before);
        let away = farthest_from_rest(&world);
        // Springs may be left in another equilibrium; a continuum has but one here.
        assert!(
            away < if model == "continuum" { 1e-6 } else { 0.05 },
            "{model}: {away} m from rest"
        );
    }
}

#[test]
fn scrambled_and_inverted_cells_come_back() {
    let mut world = Slab {
        model: "continuum",
        ..Slab::new()
    }
    .world();
    let mut random = Random(17);
    let deformable = world.scene.deformable(0).unwrap();
    let free: Vec<usize> = (0..deformable.coordinate_count())
        .filter(|&k| deformable.unknown(k).is_some())
        .collect();
    for &node in &free {
        // Twice the size of the body, all mixed.
        body_mut(&mut world).positions[node] = Point3::from(random.vector() * 0.2);
    }
    renew(&mut world);
    let before = energy(&world);
    for _ in 0..20_000 {
        world.at([0.0, 0.0, 0.5]);
    }
    assert!(
        energy(&world) < 1e-6 * before,
        "{} J left of {before} J",
        energy(&world)
    );
    let away = farthest_from_rest(&world);
    assert!(away < 1e-5, "{away} m from rest");
}

fn plane(id: &str, normal: [f64; 3]) -> String {
    format!(
        r#"
[[tool]]
id = "{id}"
shape = {{ plane = {{ normal = {normal:?} }} }}
pose = {{ position = [0.0, 0.0, {:?}] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
        0.02 * -normal[2]
    )
}

// The lower plane is the fixed underside. How far the force can grow with the squeeze is a matter
// of the law and of one iteration a tick: springs turn over at half of the thickness, the
// continuum's rim folds out at a third, 19.3 mm down.
#[test]
fn squeezed_to_a_tenth_between_planes_and_released() {
    for (model, sound_m) in [("lattice", 0.013), ("continuum", 0.019)] {
        let mut world = Slab {
            model,
            tools: plane("press", [0.0, 0.0, -1.0]),
            ..Slab::new()
        }
        .world();
        let mut last = 0.0;
        for k in 0..6_000 {
            let z = 0.001 - 0.028 * (k as f64 / 4_000.0).min(1.0);
            let force = world.at([0.0, 0.0, z]).tools[0].force_n.z;
            if k % 250 == 249 && -z < sound_m {
                assert!(
                    force >= last,
                    "{model} at {z} m: {force} N, before {last} N"
                );
                let top = body(&world)
                    .positions
                    .iter()
                    .map(|p| p.z)
                    .fold(f64::NEG_INFINITY, f64::max);
                assert!(
                    top < z + 1e-3,
                    "{model}: the top is at {top} m, the plane at {z} m"
                );
                if force > 0.0 {
                    assert_base_bears(&world, force, 0.05);
                }
                last = force;
            }
            assert!(force.is_finite());
        }
        assert!(last > 10.0 && energy(&world) < 10.0, "{model}: {last} N");
        for _ in 0..10_000 {
            world.at([0.0, 0.0, 0.05]);
        }
        let (away, left) = (farthest_from_rest(&world), energy(&world));
        // Springs may stay turned over, in an equilibrium of their own.
        assert!(
            away < if model == "continuum" { 1e-8 } else { 0.05 },
            "{model}: {away} m from rest, {left} J"
        );
    }
}

#[test]
fn a_tool_that_jumps_a_metre_in_out_and_through() {
    jumps("continuum", 1e6);
    // Springs have inverted equilibria, and a ball that appears a metre off throws them into one:
    // what a device may not do keeps them from it.
    jumps("lattice", 10.0);
}

/// Jumps about for ten seconds, and the slab is at rest again after the tool has left.
fn jumps(model: &'static str, speed_max_m_s: f64) {
    let tools = ball("ball", "inf", 0.02).replace(
        "speed_max_m_s = 1e6",
        &format!("speed_max_m_s = {speed_max_m_s:?}"),
    );
    let mut world = Slab {
        model,
        tools,
        ..Slab::new()
    }
    .world();
    let mut pressed: f64 = 0.0;
    let mut random = Random(23);
    for k in 0..10_000 {
        let place = match k % 4 {
            0 => [0.0, 0.0, 0.5],
            1 => [0.0, 0.0, -0.5],
            2 => [0.0, 0.0, 0.015],
            _ => [random.next(), random.next(), random.next()],
        };
        let force = world.at(place).tools[0].force_n;
        assert!(force.iter().all(|x| x.is_finite()));
        pressed = pressed.max(force.norm());
    }
    assert!(
        pressed > 10.0,
        "{model}: it never met the slab, {pressed} N"
    );
    energy(&world);
    for _ in 0..5_000 {
        world.at([0.0, 0.0, 0.3]);
    }
    let away = farthest_from_rest(&world);
    assert!(
        away < 1e-8,
        "{model}: {away} m from rest after the tool has left"
    );
}

#[test]
fn two_tools_squeeze_and_share_a_control_point() {
    let tools = ball("left", "inf", 0.01) + &ball("right", "inf", 0.01);
    let mut world = Slab {
        tools,
        ..Slab::new()
    }
    .world();
    // Beside each other, in mirrored places: equal forces.
    let mut out = TickOutput::default();
    for k in 0..10_000 {
        let depth = 0.003 * (k as f64 / 5_000.0).min(1.0);
        out = all_at(
            &mut world,
            &[[-0.012, 0.0, 0.01 - depth], [0.012, 0.0, 0.01 - depth]],
        );
    }
    let (left, right) = (out.tools[0].force_n, out.tools[1].force_n);
    assert!((left.z / right.z - 1.0).abs() < 1e-6, "{left} and {right}");
    assert!(
        (left.x + right.x).abs() < 1e-6 * left.z,
        "{left} and {right}"
    );
    assert_base_bears(&world, left.z + right.z, 1e-3);
    // In the same place: together they press as one.
    let mut one = Slab {
        tools: ball("ball", "inf", 0.01),
        ..Slab::new()
    }
    .world();
    let alone = press(&mut one, 0.01, 0.003, 2_000);
    for _ in 0..5_000 {
        out = all_at(&mut world, &[[0.0, 0.0, 0.007], [0.0, 0.0, 0.007]]);
    }
    let both = out.tools[0].force_n.z + out.tools[1].force_n.z;
    assert!(
        (both / alone - 1.0).abs() < 2e-3,
        "{both} N by two, {alone} N by one"
    );
}

#[test]
fn a_sharp_cone() {
    tip(
        "{ cone = { half_angle_rad = 0.5, height_m = 0.03 } }",
        Rotation::identity(),
        0.0,
    );
}

#[test]
fn the_corner_of_a_cube() {
    let corner = Rotation::rotation_between(&Vector3::new(-1.0, -1.0, -1.0), &-Vector3::z());
    // From its middle to a corner.
    let reach_m = 0.01 * 3.0_f64.sqrt();
    tip(
        "{ box = { half_extents_m = [0.01, 0.01, 0.01] } }",
        corner.unwrap_or(Rotation::identity()),
        reach_m,
    );
}

/// A tip pressed 3 mm deep, held, and drawn across the slab. It has no normal of its own: the force
/// is along the surface's.
fn tip(shape: &str, orientation: Rotation, reach_m: f64) {
    let tools = format!(
        "[[tool]]\nid = \"tip\"\nshape = {shape}\npose = {{ position = [0.0, 0.0, 0.04] }}\n\
         coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 1e9, ramp_s = 0.0 }}\n"
    );
    let mut world = Slab {
        tools,
        ..Slab::new()
    }
    .world();
    let (pressed, held, drawn) = (500_usize, 4_500, 5_000);
    let mut last = Vector3::zeros();
    let (mut ripple, mut step_n) = (0.0_f64, 0.0_f64);
    for k in 0..pressed + held + drawn {
        let depth = 0.003 * (k as f64 / pressed as f64).min(1.0);
        let way = 0.02 * (k.saturating_sub(pressed + held) as f64 / drawn as f64);
        world.seq += 1;
        let mut input = TickInput::default();
        let place = pose(world.seq, [0.001 + way, 0.002 - 0.3 * way, reach_m - depth]);
        input.poses[0] = Some(palpate_sim::haptics::DevicePose {
            orientation,
            ..place
        });
        let force =
            step(&world.scene, &mut world.state, &mut world.scratch, &input).tools[0].force_n;
        assert!(force.iter().all(|x| x.is_finite()));
        let change = (force - last).norm() / force.norm().max(1.0);
        if k >= pressed + held / 2 && k < pressed + held {
            ripple = ripple.max(change);
        } else if k > pressed + held {
            step_n = step_n.max(change);
        }
        last = force;
        if k + 1 == pressed + held {
            println!("{shape}: {force}");
            // The slab is the same all around but for its rim, from which the tip is a little off
            // the middle.
            assert!(force.x.hypot(force.y) < 5e-3 * force.z, "{shape}: {force}");
            assert_base_bears(&world, force.z, 1e-3);
        }
    }
    println!("{shape}: held, it changes by {ripple} of itself a tick, drawn by {step_n}");
    assert!(
        ripple < 1e-9,
        "{shape}: the force trembles by {ripple} of itself"
    );
    assert!(
        step_n < 0.02,
        "{shape}: drawn along, the force jumps by {step_n} of itself"
    );
    assert!(energy(&world) < 1.0);
}

#[test]
fn nearly_incompressible() {
    let material = "young_pa = 20e3, poisson = 0.499, damping_s = 2e-3";
    let mut world = Slab {
        model: "continuum",
        material: material.into(),
        ..Slab::new()
    }
    .world();
    let force = press(&mut world, 0.02, 0.003, 5_000);
    assert_base_bears(&world, force, 2e-2);
    // Held down by its underside it can neither yield nor flow: stiffer than at 0.45, by less than
    // locking would make it.
    let at = |poisson: f64| {
        let material = format!("young_pa = 20e3, poisson = {poisson:?}, damping_s = 2e-3");
        press(
            &mut Slab {
                model: "continuum",
                material,
                ..Slab::new()
            }
            .world(),
            0.02,
            0.003,
            1_000,
        )
    };
    let softer = at(0.45);
    assert!(
        force > softer && force < 2.0 * softer,
        "{force} N at 0.499, {softer} N at 0.45"
    );
    energy(&world);
}

#[test]
fn a_single_layer_of_cells() {
    for model in ["lattice", "continuum"] {
        let mut world = Slab {
            model,
            layers: 2,
            ..Slab::new()
        }
        .world();
        let force = press(&mut world, 0.02, 0.003, 5_000);
        assert!(force > 0.0);
        assert_base_bears(&world, force, 1e-3);
        energy(&world);
    }
}

// A block between walls of its own width, free to slide on them, would shrink by ρ g h² / 2 M; free
// sides give way, so it sinks by ρ g h² / 2 E times what the fixed underside holds back: between
// the two.
#[test]
fn jelly_under_its_own_weight() {
    let material = "preset = \"jelly\"";
    let extra = String::new();
    let mut world = {
        let slab = Slab {
            model: "continuum",
            side: 8,
            layers: 5,
            material: material.into(),
            extra,
            ..Slab::new()
        };
        let Slab {
            side,
            layers,
            model,
            material,
            tools,
            ..
        } = &slab;
        World::new(&format!(
            "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n[[body]]\nid = \"jelly\"\n\
             surface = {{ builtin = \"sheet\", net = [{side}, {side}], size = 0.1 }}\nmodel = \"{model}\"\n\
             material = {{ {material} }}\n\
             lattice = {{ layers = {layers}, refine = \"none\", thickness_m = 0.03 }}\n\
             fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]\n{tools}"
        ))
    };
    let middle = |world: &World| {
        let surface = world.scene.rest_surface(0);
        let mut net = surface.net().points().to_vec();
        world.state.copy_net(&world.scene, 0, &mut net);
        net[27].z.min(net[28].z)
    };
    for _ in 0..10_000 {
        world.at([0.0, 0.0, 0.05]);
    }
    let (young, nu, density, h) = (6e3, 0.45, 1_050.0, 0.03);
    let confined = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let (least, most) = (
        density * 9.81 * h * h / 2.0 / confined,
        density * 9.81 * h * h / 2.0 / young,
    );
    let sag = -middle(&world);
    assert!(
        sag > least && sag < most,
        "sinks by {sag} m, not between {least} and {most}"
    );
    let before = middle(&world);
    let mut jitter: f64 = 0.0;
    for _ in 0..1_000 {
        world.at([0.0, 0.0, 0.05]);
        jitter = jitter.max((middle(&world) - before).abs());
    }
    assert!(jitter < 1e-9, "at rest it moves by {jitter} m");
    // The base bears the weight.
    let deformable = world.scene.deformable(0).unwrap();
    let free: f64 = (0..deformable.coordinate_count())
        .filter(|&k| deformable.unknown(k).is_some())
        .map(|k| deformable.masses()[k])
        .sum();
    let base = deformable.base_reaction_n(body(&world)).z;
    assert!(
        (base.abs() / (free * 9.81) - 1.0).abs() < 1e-3,
        "base {base} N, weight {} N",
        free * 9.81
    );
}

#[test]
fn a_thousand_newtons_for_one_tick() {
    for model in ["lattice", "continuum"] {
        let mut world = Slab {
            model,
            tools: ball("ball", "1e6", 0.02),
            ..Slab::new()
        }
        .world();
        for _ in 0..100 {
            world.at([0.0, 0.0, 0.03]);
        }
        let hit = world.at([0.0, 0.0, 0.02 - 1e-3]).tools[0].force_n.z;
        for _ in 0..10_000 {
            world.at([0.0, 0.0, 0.05]);
        }
        assert!(hit > 1.0, "{model}: only {hit} N");
        let away = farthest_from_rest(&world);
        assert!(away < 1e-6, "{model}: {away} m from rest after {hit} N");
    }
}

// Ten minutes of a tool at rest: the force of the last second is that of the first to the last
// digits.
#[test]
fn resting_contact_for_ten_minutes() {
    let mut world = Slab {
        side: 4,
        layers: 2,
        rate_hz: 100,
        ..Slab::new()
    }
    .world();
    let first = press(&mut world, 0.02, 0.003, 2_000);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..60_000 {
        let force = world.at([0.0, 0.0, 0.017]).tools[0].force_n.z;
        (low, high) = (low.min(force), high.max(force));
    }
    assert!(
        high - low < 1e-3,
        "the force ripples between {low} and {high} N"
    );
    assert!(
        (high / first - 1.0).abs() < 1e-6,
        "{first} N became {high} N"
    );
}

#[test]
fn a_hundred_bodies() {
    let mut text = String::new();
    for k in 0..100 {
        let (x, y) = (0.15 * (k % 10) as f64, 0.15 * (k / 10) as f64);
        text += &format!(
            "[[body]]\nid = \"b{k}\"\nsurface = {{ builtin = \"sheet\", net = [4, 4], size = 0.1 }}\nmodel = \"lattice\"\n\
             lattice = {{ layers = 2, refine = \"none\", thickness_m = 0.03 }}\n\
             pose = {{ position = [{x:?}, {y:?}, 0.0] }}\n\
             fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]\n"
        );
    }
    let mut world = World::new(&(text + &ball("ball", "inf", 0.02)));
    // The ball calls on the bodies of a row; each gives the same force.
    let mut forces = Vec::new();
    for k in 0..10 {
        let x = 0.15 * k as f64;
        for _ in 0..100 {
            world.at([x, 0.0, 0.05]);
        }
        let mut force = 0.0;
        for j in 0..900 {
            let depth = 0.003 * (f64::from(j) / 500.0).min(1.0);
            force = world.at([x, 0.0, 0.02 - depth]).tools[0].force_n.z;
        }
        forces.push(force);
    }
    assert!(forces[0] > 0.0);
    for force in &forces {
        assert!((force / forces[0] - 1.0).abs() < 1e-9, "{forces:?}");
    }
    // What nobody touches sleeps.
    let asleep = (0..100)
        .filter(|&b| {
            world
                .scene
                .deformable(b)
                .unwrap()
                .asleep(world.state.bodies[b].deformable.as_ref().unwrap())
        })
        .count();
    assert!(asleep >= 98, "{asleep} of 100 sleep");
}
