//! Two bodies that do not touch, each pressed by a ball, stepped one after the other and on two threads.

use super::indent::failed;
use super::world::World;
use super::{Effort, Row};
use palpate_drive::threads::Threads;
use palpate_geometry::math::state_hash;
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::Executor as _;

/// The case, in which only the method differs.
pub(super) const CASE: &str = "scaling/side-by-side";
/// A drop's place from the one before, m.
const APART_M: f64 = 0.15;
/// Ticks of a press by 3 mm, and those that are timed after it.
const PRESS: usize = 300;

/// A row for each number of threads; error of the second: hashes of states that differ.
pub(super) fn rows(effort: Effort, out: &mut dyn FnMut(Row)) {
    let ticks = match effort {
        Effort::Quick => 500,
        Effort::Full => 3_000,
    };
    let mut first = Vec::new();
    for (method, count) in [("one thread", 1), ("two threads", 2)] {
        out(pressed(method, count, ticks, &mut first));
    }
}

/// Ticks on so many threads; `first`: hashes of the states on one thread, filled by it.
fn pressed(method: &str, count: usize, ticks: usize, first: &mut Vec<u64>) -> Row {
    let mut world = match World::new(&scene()) {
        Ok(world) => world,
        Err(why) => return failed(CASE, &why),
    };
    let threads = match Threads::start(count, false) {
        Ok(threads) => threads,
        Err(why) => return failed(CASE, &why.to_string()),
    };
    let width = threads.as_ref().map_or(1, Threads::width);
    let scene = world.scene.clone();
    let executor = threads.map(|threads| Box::new(threads) as _);
    world.scratch.set_executor(&scene, executor);
    let mut force_n = 0.0;
    let mut differ = 0;
    for k in 0..PRESS + ticks {
        let t = k as f64;
        let deep = 0.003 * (t / PRESS as f64).min(1.0) + 1e-4 * libm::sin(0.02 * t);
        let hand = |y: f64| DevicePose::at_rest([0.023 - deep, y + 0.003, 0.045]);
        force_n = world.posed(&[hand(0.0), hand(APART_M)]).tools[0]
            .force_n
            .norm();
        let hash = state_hash(&world.state);
        match count {
            1 => first.push(hash),
            _ => differ += usize::from(first.get(k) != Some(&hash)),
        }
    }
    world.ticks_s.drain(..PRESS);
    let row = Row {
        suite: "scaling",
        ..world.row(
            CASE,
            method,
            format!("{width} threads; {force_n:.4} N on each ball"),
        )
    };
    match count {
        1 => row,
        _ => row.off_by(differ as f64, "states that differ"),
    }
}

/// Two drops of the default lattice, and a ball for each.
fn scene() -> String {
    let drop = |k: usize| {
        format!(
            "[[body]]\nid = \"drop{k}\"\nsurface = {{ builtin = \"teardrop\", net = [8, 8] }}\nmodel = \"continuum\"\n\
             material = {{ young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 2e-3 }}\n\
             fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]\npose = {{ position = [0.0, {y:?}, 0.0] }}\n\
             [[tool]]\nid = \"ball{k}\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = [0.06, {y:?}, 0.045] }}\n",
            y = APART_M * k as f64
        )
    };
    [drop(0), drop(1)].concat()
}
