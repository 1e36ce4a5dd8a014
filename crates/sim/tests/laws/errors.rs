//! What a force may be off: nothing on rigid bodies and at rest, little where a step has converged, and much, with a
//! flag, in a tick that no few iterations can follow. How well it says so: `palpate-bench trust`.

use crate::common::{Laws as _, World};
use palpate_sim::tick::flags::DEGRADED;
use palpate_sim::tick::record::ToolOutput;

/// A ball of 10 mm: the point of it that touches rolls with the contact.
const BALL: &str = "sphere = { radius_m = 0.01 }";
/// As good as one, whose point that touches stays.
const CAPSULE: &str = "capsule = { radius_m = 0.01, half_length_m = 1e-7 }";

/// A slab of 20 kPa, 60 mm wide and 20 mm thick, that is held by its edges, or a rigid sheet; and a tool.
fn scene(body: &str, shape: &str) -> World {
    // The capsule is there to press hard at once: what it went in beyond the net would take that off.
    let near_field = shape == BALL;
    World::new(&format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [9, 9], size = 0.06 }}
{body}
[[tool]]
id = "tool"
shape = {{ {shape} }}
pose = {{ position = [0.0, 0.0, 0.02] }}
coupling = {{ stiffness_n_m = 2000.0, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e6, ramp_s = 0.0, speed_max_m_s = 1e6 }}
[[contact]]
pair = ["tool", "slab"]
near_field = {near_field}
"#
    ))
}

fn soft(iterations: usize, shape: &str) -> World {
    let body = format!(
        "model = \"continuum\"\nlattice = {{ layers = 3, refine = \"none\", thickness_m = 0.02 }}\n\
         material = {{ young_pa = 20e3, poisson = 0.45, damping_s = 2e-3 }}\n\
         integrator = {{ iterations = {iterations} }}\n\
         fixed = [{{ u = [0.0, 0.1], v = [0.0, 1.0] }}, {{ u = [0.9, 1.0], v = [0.0, 1.0] }}]"
    );
    scene(&body, shape)
}

/// Presses at a speed to a depth and holds; what the tool gets in each tick.
fn pressed(world: &mut World, speed_m_s: f64, depth_m: f64, hold: usize) -> Vec<ToolOutput> {
    let (from, to) = (0.0105, 0.01 - depth_m);
    let stride = speed_m_s * 1e-3;
    let ticks = ((from - to) / stride).ceil() as usize + hold;
    let place = |k: usize| [0.001, 0.002, (from - stride * k as f64).max(to)];
    (0..ticks).map(|k| world.at(place(k)).tools[0]).collect()
}

#[test]
fn forces_of_rigid_bodies_are_exact() {
    let tools = pressed(&mut scene("", CAPSULE), 0.05, 2e-3, 5);
    assert!(tools.last().unwrap().contact_force_n.norm() > 1.0);
    assert!(tools.iter().all(|tool| tool.error_n == 0.0));
}

#[test]
fn errors_are_there_while_a_body_is_pressed_and_gone_at_rest() {
    // Of a capsule what stays at rest is by how much its normal at the point that touches is not the body's.
    let mut world = soft(1, BALL);
    let tools = pressed(&mut world, 0.1, 3e-3, 400);
    let share = |tool: &ToolOutput| tool.error_n / tool.contact_force_n.norm();
    let pressing = &tools[..35];
    let most = pressing.iter().filter(|tool| tool.contact_count > 0);
    let most = most.map(share).fold(0.0, f64::max);
    assert!(most > 1e-4, "{most} of the force on the way");
    let last = tools.last().unwrap();
    assert!(last.contact_force_n.norm() > 0.1, "{last:?}");
    assert!(share(last) < 1e-5, "{} of the force at rest", share(last));
    // A body that is not touched has none.
    let away = world.at([0.0, 0.0, 0.1]).tools[0];
    assert_eq!(away.error_n, 0.0, "{away:?}");
}

#[test]
fn a_jump_is_far_off_and_flagged_and_a_slow_press_is_not() {
    let tools = pressed(&mut soft(1, CAPSULE), 10.0, 9e-3, 1);
    let worst = (0..tools.len()).max_by(|&a, &b| tools[a].error_n.total_cmp(&tools[b].error_n));
    let worst = worst.unwrap();
    // The same tick, its first one in touch, with its equations solved to the end: a tenth away.
    let solved = &pressed(&mut soft(30, CAPSULE), 10.0, 9e-3, 1)[worst];
    let worst = &tools[worst];
    let off_n = (worst.contact_force_n - solved.contact_force_n).norm();
    assert!(off_n > 0.05 * solved.contact_force_n.norm(), "{off_n} N");
    assert!(off_n < 2.0 * worst.error_n, "{off_n} N: {worst:?}");
    assert!(
        worst.error_n > 0.05 * worst.contact_force_n.norm(),
        "{worst:?}"
    );
    assert!(worst.flags & DEGRADED != 0, "{worst:?}");
    for tool in pressed(&mut soft(1, CAPSULE), 2e-3, 2e-3, 0) {
        assert!(tool.flags & DEGRADED == 0, "{tool:?}");
    }
}
