//! What runs beside the tick costs its thread no allocation: workers, the self-check.

use crate::common::{Laws as _, World, teardrop};
use crate::counting::allocations;
use palpate_sim::tick::record::Command;

/// A slab that a ball presses, slides on and leaves.
fn slab(model: &str, more: &str) -> String {
    format!(
        "[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [7, 7], size = 0.1 }}\nmodel = \"{model}\"\n\
         lattice = {{ layers = 3, refine = \"none\", thickness_m = 0.03 }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}, {{ u = [0.0, 0.1], v = [0.0, 1.0] }}]\n{more}\n\
         [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.02 }} }}\n\
         pose = {{ position = [0.0, 0.0, 0.03] }}\ncoupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0 }}\n"
    )
}

fn press_and_slide(world: &mut World) -> u64 {
    for _ in 0..8 {
        world.at_in_place([0.0, 0.0, 0.03]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..800 {
            let t = f64::from(k) * 1e-3;
            let out = world.at_in_place([
                0.01 * (9.0 * t).sin(),
                0.0,
                0.018 + 0.006 * (20.0 * t).cos(),
            ]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
        // Long enough to fall asleep.
        for _ in 0..400 {
            world.silent_in_place();
        }
    });
    assert!(touched > 200, "only {touched} ticks in touch");
    count
}

// On the thread of the tick; what a worker does is the same code.
#[test]
fn a_tick_with_a_worker_beside_it_allocates_nothing() {
    let mut world = World::new(&slab("continuum", "integrator = { every = 4 }"));
    let scene =
        std::sync::Arc::new(World::new(&slab("continuum", "integrator = { every = 4 }")).scene);
    let workers = palpate_drive::workers::Workers::start(&scene).unwrap();
    world
        .scratch
        .set_pipeline(Box::new(workers.expect("a body that steps apart")));
    assert_eq!(press_and_slide(&mut world), 0);
}

// The threads that step bodies side by side allocate nothing either, and a tick hands them their bodies as they are.
#[test]
fn ticks_that_step_bodies_side_by_side_allocate_nothing() {
    let one = slab("continuum", "");
    let other = one
        .replace(
            "id = \"slab\"",
            "id = \"other\"\npose = { position = [0.0, 0.3, 0.0] }",
        )
        .replace("id = \"ball\"", "id = \"second\"")
        .replace("position = [0.0, 0.0, 0.03]", "position = [0.0, 0.3, 0.03]");
    let mut world = World::new(&(one + &other));
    let threads = palpate_drive::threads::Threads::start(2, false).unwrap();
    let executor = threads.map(|threads| Box::new(threads) as _);
    world.scratch.set_executor(&world.scene, executor);
    assert_eq!(press_and_slide(&mut world), 0);
}

// A shadow that goes back now and then costs the tick copies into buffers that are there already,
// whatever contact rows come.
#[test]
fn handing_ticks_to_a_self_check_allocates_nothing() {
    use palpate_drive::journal::{Journal as _, NoJournal};
    use palpate_drive::nets::NetPool;
    use palpate_record::SelfCheck;
    use palpate_sim::tick::record::TickRecord;
    let soft = teardrop(20e3, "\"none\"").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    let text = format!("{soft}friction = {{ mu = 0.4 }}\ngrip = {{ force_max_n = 0.3 }}\n");
    let mut world = World::new(&text);
    let scene = std::sync::Arc::new(World::new(&text).scene);
    let (check, mut port) = SelfCheck::start(&scene, 20, Box::new(NoJournal)).unwrap();
    port.keyframe(
        &world.state,
        palpate_geometry::math::state_hash(&world.state),
    );
    let mut touched = 0;
    let mut nets = NetPool::new(&scene, port.nets_held());
    let mut record = TickRecord::for_tools(1);
    let count = allocations(|| {
        for k in 0..1_000u32 {
            if k % 50 == 0 {
                port.command(u64::from(k), Command::Quality(0));
            }
            let t = f64::from(k) * 1e-3;
            let place = [
                0.06 - 0.038 * (20.0 * t).sin().abs(),
                0.003 + 0.004 * (9.0 * t).sin(),
                0.045,
            ];
            let buttons = u32::from(k % 300 > 100);
            record.input.poses[0] = Some(palpate_sim::haptics::DevicePose {
                buttons,
                ..crate::common::pose(u64::from(k) + 1, place)
            });
            palpate_sim::tick::step_into(
                &world.scene,
                &mut world.state,
                &mut world.scratch,
                &record.input,
                &mut record.output,
            );
            touched += u32::from(record.output.tools[0].contact.is_some());
            nets.begin();
            port.tick(&world.scene, &world.state, &record, &mut nets);
            if k % 20 == 0 {
                std::thread::sleep(std::time::Duration::from_millis(5));
            }
        }
    });
    assert!(touched > 200, "only {touched} ticks in touch");
    assert_eq!(count, 0);
    drop(port);
    let report = check.finish();
    assert!(report.checks > 5 && report.differences == 0, "{report:?}");
}
